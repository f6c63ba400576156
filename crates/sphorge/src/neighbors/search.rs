//! Cell search for all particles.

use super::{BLOCK, CellGrid, NeighborList};
use rayon::prelude::*;
use sphorge_physics::Vector;

/// How far two points may lie apart to be neighbours: `factor (h_i + h_j) / 2`.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a> {
    /// Smoothing length of every point, m.
    pub smoothing_length: &'a [f64],
    /// Kernel support in smoothing lengths, skin included.
    pub factor: f64,
}

impl Reach<'_> {
    /// Largest distance of any pair, m.
    pub fn largest(&self) -> f64 {
        self.factor * self.smoothing_length.iter().fold(0.0, |m: f64, &h| m.max(h))
    }

    /// Squared distance at which `i` and `j` cease to be neighbours, m².
    #[inline(always)]
    pub fn squared(&self, i: usize, j: usize) -> f64 {
        let r = 0.5 * self.factor * (self.smoothing_length[i] + self.smoothing_length[j]);
        r * r
    }
}

/// Fills `list` with the neighbours of the first `count` of `points`. Rows come in the order of the cells, which depends on
/// the positions alone, never on threads. `sorted` is scratch: the points in cell order.
pub fn search(
    points: &[Vector<f64>],
    count: usize,
    reach: &Reach<'_>,
    grid: &mut CellGrid,
    sorted: &mut Vec<Vector<f64>>,
    list: &mut NeighborList,
) {
    grid.sort(points, reach.largest());
    sorted.clear();
    sorted.extend(grid.order().iter().map(|&i| points[i as usize]));
    list.resize(count);
    let (grid, sorted) = (&*grid, &*sorted);
    list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
        block.clear();
        for i in b * BLOCK..((b + 1) * BLOCK).min(count) {
            let p = &points[i];
            grid.for_runs_around(p, |first, last| {
                for (q, &j) in sorted[first..last].iter().zip(&grid.order()[first..last]) {
                    let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
                    let distance2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                    if distance2 < reach.squared(i, j as usize) && j as usize != i {
                        block.push(j);
                    }
                }
            });
            block.end_row(i as u32);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::brute_force;
    use super::*;

    /// A deterministic jittered cloud.
    fn cloud(n: usize, seed: u64, dimensions: usize) -> Vec<Vector<f64>> {
        let mut s = seed;
        let mut random = || {
            s ^= s << 13;
            s ^= s >> 7;
            s ^= s << 17;
            (s >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..n).map(|_| [0, 1, 2].map(|a| if a < dimensions { random() } else { 0.0 })).collect()
    }

    #[test]
    fn cell_search_finds_what_brute_force_finds() {
        for (dimensions, h) in [(1, 0.01), (2, 0.05), (3, 0.08)] {
            let points = cloud(700, 88172645463325252 + dimensions as u64, dimensions);
            // Two smoothing lengths, and only the first 600 points are owners (the rest play ghosts).
            let smoothing: Vec<f64> = (0..700).map(|i| if i % 3 == 0 { h } else { 1.5 * h }).collect();
            let reach = Reach { smoothing_length: &smoothing, factor: 2.0 };
            let (mut grid, mut sorted, mut list) = Default::default();
            search(&points, 600, &reach, &mut grid, &mut sorted, &mut list);
            list.blocks_mut().iter_mut().for_each(|b| b.sort_rows());
            let oracle = brute_force(&points, 600, &reach);
            assert!(oracle.pairs() > 600);
            for i in 0..600 {
                assert_eq!(list.row(i), oracle.row(i), "dimensions {dimensions}, particle {i}");
            }
        }
    }
}
