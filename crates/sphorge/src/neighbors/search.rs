//! Cell search for all particles.

use super::cells::bounds;
use super::{BLOCK, Block, CellGrid, Frame, NeighborList};
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run};
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

/// The searcher: a cell grid and the points in its order, kept between searches for their memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Searcher<T> {
    grid: CellGrid,
    /// Encoded coordinates and smoothing lengths in cell order, padded to whole bundles.
    x: [Vec<T>; 3],
    h: Vec<T>,
    /// Place of every point in the cell order.
    place: Vec<u32>,
    /// Point indices in cell order, padded like the coordinates.
    order: Vec<u32>,
}

impl<T: PairScalar> Searcher<T> {
    /// Fills `list` with the neighbours of the first `count` of `points` and returns the frame their coordinates were encoded
    /// in. Rows come in the order of the cells, which depends on the positions alone, never on threads.
    pub(crate) fn search(
        &mut self,
        points: &[Vector<f64>],
        count: usize,
        reach: &Reach<'_>,
        instructions: Instructions,
        list: &mut NeighborList,
    ) -> Frame {
        let largest = reach.largest();
        let (low, high) = bounds(points);
        // Between two searches a particle moves by less than the kernel radius.
        let frame = Frame::around::<T>(low, high, largest);
        self.grid.sort(points, largest);
        self.sort_columns(points, reach, &frame);

        list.resize(count);
        let h = reach.smoothing_length;
        let uniform = h.iter().all(|&other| other == h[0]).then(|| T::of(largest * largest));
        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            block.clear();
            let rows = b * BLOCK..((b + 1) * BLOCK).min(count);
            let job = RowsJob {
                searcher: this,
                points,
                rows,
                block,
                unit: T::of(frame.unit),
                half_factor: T::of(0.5 * reach.factor),
                uniform,
            };
            run(instructions, job);
        });
        frame
    }

    /// Indices of the points in the order of cells of the given size, m.
    pub(crate) fn cell_order(&mut self, points: &[Vector<f64>], size: f64) -> &[u32] {
        self.grid.sort(points, size);
        self.grid.order()
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let columns: usize = self.x.iter().chain([&self.h]).map(|c| c.capacity() * size_of::<T>()).sum();
        self.grid.bytes() + columns + 4 * (self.place.capacity() + self.order.capacity())
    }

    fn sort_columns(&mut self, points: &[Vector<f64>], reach: &Reach<'_>, frame: &Frame) {
        let padded = points.len() + super::PAD;
        for column in self.x.iter_mut().chain([&mut self.h]) {
            column.resize(padded, T::zero());
        }
        self.place.resize(points.len(), 0);
        self.order.resize(padded, 0);
        for (k, &i) in self.grid.order().iter().enumerate() {
            let i = i as usize;
            let x = frame.encode::<T>(&points[i]);
            for a in 0..3 {
                self.x[a][k] = x[a];
            }
            self.h[k] = T::of(reach.smoothing_length[i]);
            self.place[i] = k as u32;
            self.order[k] = i as u32;
        }
    }
}

/// Neighbours found before they are handed to the block.
const BUFFER: usize = 512;

/// The rows of one block.
struct RowsJob<'a, T> {
    searcher: &'a Searcher<T>,
    points: &'a [Vector<f64>],
    rows: std::ops::Range<usize>,
    block: &'a mut Block,
    unit: T,
    half_factor: T,
    /// Squared reach where all smoothing lengths are equal.
    uniform: Option<T>,
}

impl<T: PairScalar> Job<T> for RowsJob<'_, T> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let Self { searcher, points, rows, block, unit, half_factor, uniform } = self;
        let Searcher { grid, x, h, place, order } = searcher;
        let unit = L::splat(unit);
        let half_factor = L::splat(half_factor);
        let mut found = [0u32; BUFFER];
        for i in rows {
            let own = place[i] as usize;
            let x_i = [L::splat(x[0][own]), L::splat(x[1][own]), L::splat(x[2][own])];
            let h_i = L::splat(h[own]);
            let mut count = 0;
            let runs = grid.runs_around(&points[i]);
            for (first, last) in runs {
                let mut k = first;
                while k < last {
                    let dx = L::difference(x_i[0], L::load(&x[0][k..]), unit);
                    let dy = L::difference(x_i[1], L::load(&x[1][k..]), unit);
                    let dz = L::difference(x_i[2], L::load(&x[2][k..]), unit);
                    let r2 = dx.mul_add(dx, dy.mul_add(dy, dz * dz));
                    let limit = match uniform {
                        Some(limit) => L::splat(limit),
                        None => {
                            let r = half_factor * (h_i + L::load(&h[k..]));
                            r * r
                        }
                    };
                    let mut mask = L::less(r2, limit);
                    let left = last - k;
                    if left < L::WIDTH {
                        mask &= (1 << left) - 1;
                    }
                    // Not its own neighbour.
                    let lane = own.wrapping_sub(k);
                    if lane < L::WIDTH {
                        mask &= !(1 << lane);
                    }
                    if count + L::WIDTH > BUFFER {
                        block.extend(&found[..count]);
                        count = 0;
                    }
                    count += L::compress(mask, &order[k..], &mut found[count..]);
                    k += L::WIDTH;
                }
            }
            block.extend(&found[..count]);
            block.end_row(i as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::brute_force;
    use super::*;

    /// A deterministic random cloud.
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

    fn agrees_with_brute_force<T: PairScalar + Default>(instructions: Instructions, uneven: bool) {
        for (dimensions, h) in [(1, 0.01), (2, 0.05), (3, 0.08)] {
            let points = cloud(700, 88172645463325252 + dimensions as u64, dimensions);
            // Only the first 600 points are owners, the rest play ghosts.
            let smoothing: Vec<f64> = (0..700).map(|i| if uneven && i % 3 == 0 { 1.5 * h } else { h }).collect();
            let reach = Reach { smoothing_length: &smoothing, factor: 2.0 };
            let mut list = NeighborList::default();
            Searcher::<T>::default().search(&points, 600, &reach, instructions, &mut list);
            list.blocks_mut().iter_mut().for_each(Block::sort_rows);
            let oracle = brute_force(&points, 600, &reach);
            assert!(oracle.pairs() > 600);
            for i in 0..600 {
                assert_eq!(list.row(i), oracle.row(i), "{instructions:?}, dimensions {dimensions}, particle {i}");
            }
        }
    }

    #[test]
    fn cell_search_finds_what_brute_force_finds_on_every_path() {
        for instructions in Instructions::available() {
            for uneven in [false, true] {
                agrees_with_brute_force::<f64>(instructions, uneven);
                agrees_with_brute_force::<f32>(instructions, uneven);
            }
        }
    }

    #[test]
    fn coincident_points_are_neighbours_and_a_crowd_overflows_the_buffer_safely() {
        let points = vec![[0.5; 3]; 1500];
        let smoothing = vec![0.1; 1500];
        let reach = Reach { smoothing_length: &smoothing, factor: 2.0 };
        let mut list = NeighborList::default();
        Searcher::<f32>::default().search(&points, 1500, &reach, Instructions::best(), &mut list);
        assert_eq!(list.row(7).len(), 1499);
        assert!(!list.row(7).contains(&7));
    }
}
