//! Boxes that can be sought by a point without going through all of them.

/// Lower and upper corner.
pub(crate) type Bounds = ([f64; 3], [f64; 3]);

/// Boxes in a leaf of the tree.
const LEAF: usize = 4;

/// Boxes in boxes: each node holds those of two halves.
#[derive(Clone, Debug)]
pub(crate) struct BoxTree {
    nodes: Vec<Node>,
    /// Boxes in the order of the leaves.
    order: Vec<u32>,
    /// Axes that count.
    axes: usize,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Part of the order.
    Leaf(u32, u32),
    /// Nodes.
    Halves(u32, u32),
}

impl BoxTree {
    /// Of boxes, in this many axes.
    pub(crate) fn new(boxes: &[Bounds], axes: usize) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..boxes.len() as u32).collect(), axes };
        if !boxes.is_empty() {
            tree.split(boxes, 0, boxes.len());
        }
        tree
    }

    /// Makes the node of a part of the order, which is halved along its longest axis.
    fn split(&mut self, boxes: &[Bounds], start: usize, end: usize) -> u32 {
        let part = &mut self.order[start..end];
        let bounds = part.iter().map(|&k| boxes[k as usize]).fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), both);
        let node = self.nodes.len() as u32;
        self.nodes.push(Node { bounds, kind: Kind::Leaf(start as u32, end as u32) });
        if end - start > LEAF {
            let length = |axis: usize| bounds.1[axis] - bounds.0[axis];
            let longest = (0..self.axes).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
            let middle = |k: u32| boxes[k as usize].0[longest] + boxes[k as usize].1[longest];
            let half = part.len() / 2;
            part.select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)));
            let first = self.split(boxes, start, start + half);
            let second = self.split(boxes, start + half, end);
            self.nodes[node as usize].kind = Kind::Halves(first, second);
        }
        node
    }

    /// The least of `value` over the boxes, where it is no less than `floor` of the distance from the box along the axis where that is
    /// largest; what is so far that it is above `limit` is left out.
    pub(crate) fn least(
        &self,
        point: [f64; 3],
        limit: f64,
        floor: impl Fn(f64) -> f64,
        value: impl Fn(usize) -> f64,
    ) -> f64 {
        let mut least = f64::INFINITY;
        let mut open: Vec<(f64, u32)> = Vec::with_capacity(64);
        let reach = |node: u32| floor(self.distance(&self.nodes[node as usize].bounds, point));
        if !self.nodes.is_empty() {
            open.push((reach(0), 0));
        }
        while let Some((reached, node)) = open.pop() {
            if reached > limit || reached >= least {
                continue;
            }
            match self.nodes[node as usize].kind {
                Kind::Leaf(start, end) => {
                    for &k in &self.order[start as usize..end as usize] {
                        least = least.min(value(k as usize));
                    }
                }
                Kind::Halves(a, b) => {
                    let (a, b) = ((reach(a), a), (reach(b), b));
                    // The nearer one first, so that it rules out more.
                    let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
                    open.extend([far, near]);
                }
            }
        }
        least
    }

    /// Distance of a point from a box along the axis where it is largest, m; negative inside.
    fn distance(&self, bounds: &Bounds, point: [f64; 3]) -> f64 {
        let along = |k: usize| (bounds.0[k] - point[k]).max(point[k] - bounds.1[k]);
        (0..self.axes).map(along).fold(f64::NEG_INFINITY, f64::max)
    }
}

fn both(a: Bounds, b: Bounds) -> Bounds {
    (std::array::from_fn(|k| a.0[k].min(b.0[k])), std::array::from_fn(|k| a.1[k].max(b.1[k])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// Cubes in a row, of edge 1 and 2 apart.
    fn row(count: usize) -> Vec<Bounds> {
        (0..count).map(|k| ([2.0 * k as f64, 0.0, 0.0], [2.0 * k as f64 + 1.0, 1.0, 1.0])).collect()
    }

    #[test]
    fn the_nearest_box_is_found_and_few_are_looked_at() {
        let boxes = row(1000);
        let tree = BoxTree::new(&boxes, 3);
        for (x, expected) in [(501.25, 0.25), (501.9, 0.1), (-3.0, 3.0), (2002.0, 3.0), (500.5, -0.5)] {
            let looked = Cell::new(0);
            let value = |k: usize| {
                looked.set(looked.get() + 1);
                (boxes[k].0[0] - x).max(x - boxes[k].1[0])
            };
            let found = tree.least([x, 0.5, 0.5], f64::INFINITY, |d| d, value);
            assert!((found - expected).abs() < 1e-12, "{x}: {found}");
            assert!(looked.get() <= 8, "{x}: {} looked at", looked.get());
        }
        assert_eq!(tree.least([501.5, 3.0, 0.5], 0.1, |d| d, |_| panic!("none is in question")), f64::INFINITY);
        assert_eq!(BoxTree::new(&[], 3).least([0.0; 3], 0.0, |d| d, |_| 0.0), f64::INFINITY);
    }
}
