//! What hangs together of a cloud of particles.

use sphorge_physics::tensor::{self, Tensor};

/// Stretches above this one are not followed: what is drawn out so far hangs by a thread.
const LONGEST: f64 = 4.0;

/// Particles, and when two of them hang together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cloud<'a> {
    /// Number of space dimensions.
    pub(crate) dimensions: usize,
    /// Where they are, m.
    pub(crate) position: &'a [[f64; 3]],
    /// Deformation gradients, where they are known: two particles that the material has drawn apart are as near as they were at the start. Without
    /// them distances are those of now.
    pub(crate) deformation: Option<&'a [Tensor<f64>]>,
    /// Distance up to which two hang together, m.
    pub(crate) link: f64,
}

/// Sets that grow together; the least member stands for a set.
struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let above = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = above;
            i = above;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

impl Cloud<'_> {
    /// What of some particles hangs together: the particles, and of each who stands for what it hangs together with.
    pub(crate) fn joined(&self, is_part: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
        let (count, link) = (self.dimensions, self.link);
        let (inverse, reach) = self.inverse(&is_part);
        let cell = |p: &[f64; 3]| -> [i64; 3] {
            std::array::from_fn(|a| if a < count { (p[a] / reach).floor() as i64 } else { 0 })
        };
        let parts = (0..self.position.len()).filter(|&i| is_part(i));
        let mut sorted: Vec<([i64; 3], u32)> = parts.map(|i| (cell(&self.position[i]), i as u32)).collect();
        sorted.sort_unstable();
        let distance = |i: usize, j: usize| {
            let (x, y) = (self.position[i], self.position[j]);
            let way = std::array::from_fn(|a| if a < count { x[a] - y[a] } else { 0.0 });
            let squared = |way: [f64; 3]| way.iter().map(|x| x * x).sum::<f64>();
            if inverse.is_empty() {
                return squared(way);
            }
            let (a, b) = (tensor::apply(&inverse[i], way), tensor::apply(&inverse[j], way));
            squared([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])))
        };
        let mut sets = Sets { parent: (0..self.position.len() as u32).collect() };
        // Rows of cells along the last axis are runs of the list: of every row beside or after its own, those within reach.
        let last = count - 1;
        for (place, &(home, i)) in sorted.iter().enumerate() {
            for step in 0..3usize.pow(last as u32) {
                let mut row = home;
                for (a, cell) in row.iter_mut().enumerate().take(last) {
                    *cell = cell.saturating_add((step / 3usize.pow(a as u32) % 3) as i64 - 1);
                }
                if row[..last] < home[..last] {
                    continue;
                }
                let (mut low, mut high) = (row, row);
                low[last] = home[last].saturating_sub(1);
                high[last] = home[last].saturating_add(1);
                let start = if row == home { place + 1 } else { sorted.partition_point(|(c, _)| *c < low) };
                for &(_, j) in sorted[start..].iter().take_while(|(c, _)| *c <= high) {
                    if distance(i as usize, j as usize) <= link * link {
                        sets.join(i, j);
                    }
                }
            }
        }
        sorted.into_iter().map(|(_, i)| (i as usize, sets.root(i) as usize)).collect()
    }

    /// Inverse deformation gradients, and how far apart two can be that hang together.
    fn inverse(&self, is_part: impl Fn(usize) -> bool) -> (Vec<Tensor<f64>>, f64) {
        let Some(deformation) = self.deformation else { return (Vec::new(), self.link) };
        let mut longest: f64 = 1.0;
        let inverse = deformation.iter().enumerate().map(|(i, f)| {
            let inverse = tensor::inverse(f);
            if !inverse.iter().flatten().all(|x| x.is_finite()) || tensor::determinant(f) <= 0.0 {
                return tensor::identity();
            }
            if is_part(i) {
                let squared = tensor::multiply(&tensor::transpose(f), f);
                let rows = squared.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
                longest = longest.max(rows.fold(0.0, f64::max).sqrt());
            }
            inverse
        });
        let inverse = inverse.collect();
        (inverse, self.link * longest.min(LONGEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes of what hangs together, the largest first.
    fn sizes(position: &[[f64; 3]], deformation: Option<&[Tensor<f64>]>, link: f64) -> Vec<usize> {
        let cloud = Cloud { dimensions: 3, position, deformation, link };
        let mut size = vec![0; position.len()];
        cloud.joined(|_| true).into_iter().for_each(|(_, root)| size[root] += 1);
        let mut sizes: Vec<usize> = size.into_iter().filter(|size| *size > 0).collect();
        sizes.sort_unstable_by(|a, b| b.cmp(a));
        sizes
    }

    /// A bar of 8 by 2 by 2 that is drawn out by `stretch` along x and turned by a right angle about z; from the fifth layer on `gap` farther.
    fn bar(stretch: f64, gap: f64) -> (Vec<[f64; 3]>, Vec<Tensor<f64>>) {
        let narrow = 1.0 / stretch.sqrt();
        let at = |i: usize| {
            let x = stretch * (i / 4) as f64 + if i >= 16 { gap } else { 0.0 };
            [-narrow * (i % 2) as f64, x, narrow * (i / 2 % 2) as f64]
        };
        let gradient = [[0.0, -narrow, 0.0], [stretch, 0.0, 0.0], [0.0, 0.0, narrow]];
        ((0..32).map(at).collect(), vec![gradient; 32])
    }

    #[test]
    fn what_is_drawn_out_hangs_together_and_what_has_parted_does_not() {
        let (position, gradient) = bar(2.0, 0.0);
        assert_eq!(sizes(&position, Some(&gradient), 1.5), [32]);
        // By distances alone each layer is a fragment.
        assert_eq!(sizes(&position, None, 1.5), [4; 8]);
        let (position, gradient) = bar(2.0, 1.1);
        assert_eq!(sizes(&position, Some(&gradient), 1.5), [16, 16]);
        // A gradient that cannot be inverted says nothing.
        let (position, _) = bar(1.0, 1.0);
        assert_eq!(sizes(&position, Some(&vec![tensor::zero(); 32]), 1.5), [16, 16]);
    }

    #[test]
    fn compressed_layers_that_have_parted_do_not_hang_together() {
        // A third of a spacing apart, and a gap of two of these.
        let (mut position, _) = bar(1.0, 0.0);
        position
            .iter_mut()
            .enumerate()
            .for_each(|(i, x)| x[1] = (i / 4) as f64 / 3.0 + if i >= 16 { 2.0 / 3.0 } else { 0.0 });
        let gradient = vec![[[0.0, -1.0, 0.0], [1.0 / 3.0, 0.0, 0.0], [0.0, 0.0, 1.0]]; 32];
        assert_eq!(sizes(&position, Some(&gradient), 1.5), [16, 16]);
        assert_eq!(sizes(&position, None, 1.5), [32]);
    }
}
