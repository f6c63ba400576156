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
    /// Periodic axes: lower and upper end of the cell, m.
    pub(crate) periodic: [Option<(f64, f64)>; 3],
}

/// A particle of what hangs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Member {
    /// Which one.
    pub(crate) particle: usize,
    /// Who stands for what it hangs together with: the least particle of it.
    pub(crate) root: usize,
    /// Where it is, m: what hangs together over a periodic end is in one piece.
    pub(crate) position: [f64; 3],
    /// Along which axes it hangs together with an image of itself: it has no ends there, and places are those in the cell.
    pub(crate) is_endless: [bool; 3],
}

/// A way in periods along each axis.
type Way = [i32; 3];

/// Sets that grow together; the least member stands for a set. The image of a member that hangs together with the parent itself is so many periods
/// away from the member.
struct Sets {
    parent: Vec<u32>,
    way: Vec<Way>,
    is_endless: Vec<[bool; 3]>,
}

fn plus(a: Way, b: Way) -> Way {
    // Of what winds around a cell without end, the last place counts as well as any.
    [0, 1, 2].map(|k| a[k].wrapping_add(b[k]))
}

fn minus(a: Way, b: Way) -> Way {
    [0, 1, 2].map(|k| a[k].wrapping_sub(b[k]))
}

impl Sets {
    fn of(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), way: vec![[0; 3]; count], is_endless: vec![[false; 3]; count] }
    }

    /// Who stands for the set, and the way to the image that hangs together with it.
    fn root(&mut self, mut i: u32) -> (u32, Way) {
        let mut way = [0; 3];
        while self.parent[i as usize] != i {
            let parent = self.parent[i as usize] as usize;
            // What stands for itself has no way to itself.
            self.way[i as usize] = plus(self.way[i as usize], self.way[parent]);
            self.parent[i as usize] = self.parent[parent];
            way = plus(way, self.way[i as usize]);
            i = self.parent[i as usize];
        }
        (i, way)
    }

    /// Joins one with the image of another that is this far away.
    fn join(&mut self, a: u32, b: u32, away: Way) {
        let ((a, to_a), (b, to_b)) = (self.root(a), self.root(b));
        // The image of the root of `b` that hangs together with the root of `a` itself.
        let between = minus(plus(to_a, away), to_b);
        if a == b {
            for k in 0..3 {
                self.is_endless[a as usize][k] |= between[k] != 0;
            }
            return;
        }
        let (low, high, way) = if a < b { (a, b, between) } else { (b, a, minus([0; 3], between)) };
        (self.parent[high as usize], self.way[high as usize]) = (low, way);
        for k in 0..3 {
            self.is_endless[low as usize][k] |= self.is_endless[high as usize][k];
        }
    }
}

impl Cloud<'_> {
    /// What of some particles hangs together.
    pub(crate) fn joined(&self, is_part: impl Fn(usize) -> bool) -> Vec<Member> {
        let (count, link) = (self.dimensions, self.link);
        let (inverse, reach) = self.inverse(&is_part);
        let parts = || (0..self.position.len()).filter(|&i| is_part(i));
        let home = |i: usize| self.in_cell(self.position[i]);
        let images = self.images(parts().map(|i| (i as u32, home(i))), reach);
        // Each particle, then its images: place, particle and way.
        let own = parts().map(|i| (home(i), i as u32, [0; 3]));
        let all: Vec<([f64; 3], u32, Way)> = own.chain(images).collect();
        let cell = |p: &[f64; 3]| -> [i64; 3] {
            std::array::from_fn(|a| if a < count { (p[a] / reach).floor() as i64 } else { 0 })
        };
        let mut sorted: Vec<([i64; 3], u32)> =
            all.iter().enumerate().map(|(k, (position, ..))| (cell(position), k as u32)).collect();
        sorted.sort_unstable();
        let distance = |(x, i, _): ([f64; 3], u32, Way), (y, j, _): ([f64; 3], u32, Way)| {
            let (i, j) = (i as usize, j as usize);
            let way = std::array::from_fn(|a| if a < count { x[a] - y[a] } else { 0.0 });
            let squared = |way: [f64; 3]| way.iter().map(|x| x * x).sum::<f64>();
            if inverse.is_empty() {
                return squared(way);
            }
            let (a, b) = (tensor::apply(&inverse[i], way), tensor::apply(&inverse[j], way));
            squared([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])))
        };
        let mut sets = Sets::of(self.position.len());
        // Rows of cells along the last axis are runs of the list: of every row beside or after its own, those within reach.
        let last = count - 1;
        for (place, &(home, own)) in sorted.iter().enumerate() {
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
                for &(_, other) in sorted[start..].iter().take_while(|(c, _)| *c <= high) {
                    let (a, b) = (all[own as usize], all[other as usize]);
                    // Two images are as far apart as what they are images of, or as it and another image.
                    let is_pair = a.2 == [0; 3] || b.2 == [0; 3];
                    if is_pair && distance(a, b) <= link * link {
                        sets.join(a.1, b.1, minus(b.2, a.2));
                    }
                }
            }
        }
        let own = sorted.into_iter().map(|(_, k)| all[k as usize]).filter(|(.., way)| *way == [0; 3]);
        let member = |(position, i, _): ([f64; 3], u32, Way)| {
            let (root, way) = sets.root(i);
            let is_endless = sets.is_endless[root as usize];
            let position = [0, 1, 2].map(|k| match self.periodic[k] {
                Some((low, high)) if !is_endless[k] => position[k] + f64::from(way[k]) * (high - low),
                _ => position[k],
            });
            Member { particle: i as usize, root: root as usize, position, is_endless }
        };
        own.map(member).collect()
    }

    /// A place in the periodic cell.
    pub(crate) fn in_cell(&self, position: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| match self.periodic[k] {
            Some((low, high)) if high > low && position[k].is_finite() => {
                let inside = low + (position[k] - low).rem_euclid(high - low);
                if inside < high { inside } else { low }
            }
            _ => position[k],
        })
    }

    /// Images within reach of the periodic cell: each pair of a particle and an image of another is there once, seen from one of both.
    fn images(&self, own: impl Iterator<Item = (u32, [f64; 3])>, reach: f64) -> Vec<([f64; 3], u32, Way)> {
        let axes: Vec<usize> = (0..self.dimensions).filter(|&k| self.periodic[k].is_some()).collect();
        let mut images = Vec::new();
        if axes.is_empty() {
            return images;
        }
        let ways: Vec<Way> = (0..3i32.pow(axes.len() as u32))
            .map(|n| {
                let mut way = [0; 3];
                axes.iter().enumerate().for_each(|(place, &k)| way[k] = n / 3i32.pow(place as u32) % 3 - 1);
                way
            })
            // Half of them: the first that is not zero points upwards.
            .filter(|way| way.iter().find(|step| **step != 0).is_some_and(|step| *step > 0))
            .collect();
        for (i, position) in own {
            for &way in &ways {
                let mut is_near = true;
                let image = [0, 1, 2].map(|k| {
                    let Some((low, high)) = self.periodic[k] else { return position[k] };
                    let x = position[k] + f64::from(way[k]) * (high - low);
                    is_near &= x >= low - reach && x <= high + reach;
                    x
                });
                if is_near {
                    images.push((image, i, way));
                }
            }
        }
        images
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
        let cloud = Cloud { dimensions: 3, position, deformation, link, periodic: [None; 3] };
        let mut size = vec![0; position.len()];
        cloud.joined(|_| true).into_iter().for_each(|of| size[of.root] += 1);
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

    /// Members of what hangs together in a cell from 0 to 10 along x and y, by the least of each.
    fn around(position: &[[f64; 3]]) -> std::collections::BTreeMap<usize, Vec<Member>> {
        let periodic = [Some((0.0, 10.0)), Some((0.0, 10.0)), None];
        let cloud = Cloud { dimensions: 2, position, deformation: None, link: 1.5, periodic };
        let mut sets = std::collections::BTreeMap::<usize, Vec<Member>>::new();
        cloud.joined(|_| true).into_iter().for_each(|of| sets.entry(of.root).or_default().push(of));
        sets.values_mut().for_each(|members| members.sort_by_key(|of| of.particle));
        sets
    }

    #[test]
    fn what_lies_over_a_periodic_end_is_in_one_piece() {
        // A block of 4 by 4 over a corner of the cell, of which each quarter is at another corner; one by itself; one that has left the cell.
        let mut position: Vec<[f64; 3]> = (0..16)
            .map(|i| [8.5 + (i % 4) as f64, 8.5 + (i / 4) as f64, 0.0].map(|x| if x > 10.0 { x - 10.0 } else { x }))
            .collect();
        position.push([5.0, 5.0, 0.0]);
        position.push([16.0, 5.0, 0.0]);
        let sets = around(&position);
        assert_eq!(sets.keys().copied().collect::<Vec<_>>(), [0, 16]);
        assert_eq!((sets[&0].len(), sets[&16].len()), (16, 2));
        for of in &sets[&0] {
            let (i, first) = (of.particle, sets[&0][0].position);
            let way = [0, 1].map(|k| of.position[k] - first[k]);
            assert!((way[0] - (i % 4) as f64).abs() < 1e-9 && (way[1] - (i / 4) as f64).abs() < 1e-9, "{of:?}");
            assert_eq!(of.is_endless, [false; 3]);
        }
        assert_eq!(sets[&16][1].position, [6.0, 5.0, 0.0]);
    }

    #[test]
    fn a_row_around_the_cell_has_no_ends_along_it() {
        let row: Vec<[f64; 3]> = (0..10).map(|i| [(7 * i % 10) as f64, 4.0, 0.0]).collect();
        let sets = around(&row);
        assert_eq!(sets.len(), 1);
        assert!(sets[&0].iter().all(|of| of.is_endless == [true, false, false] && of.position == row[of.particle]));
        // Along a diagonal in both directions, over the corner.
        let diagonal: Vec<[f64; 3]> = (0..10).map(|i| [i as f64, 9.0 - i as f64, 0.0]).collect();
        let sets = around(&diagonal);
        assert!(sets.len() == 1 && sets[&0].iter().all(|of| of.is_endless == [true, true, false]), "{sets:?}");
    }
}
