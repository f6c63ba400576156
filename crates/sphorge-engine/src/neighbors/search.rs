//! Cell search, for all particles or for some.
//!
//! Cells are a little larger than the reach, so that they serve as long as no particle has moved through half of the
//! difference; only coordinates are renewed in between. Distances are tested in single precision on fixed-point coordinates,
//! whatever the precision of the pair sums. Both rows of a pair come to the same verdict, bit for bit.

use super::candidates::Candidates;
use super::cells::bounds;
use super::{BLOCK, Block, CellGrid, Frame, NeighborList, Odometer, PAD};
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run};
use rayon::prelude::*;
use sphorge_physics::Vector;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How far two points may lie apart to be neighbours: `factor (h_i + h_j) / 2`.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a> {
    /// Smoothing length of every point, m.
    pub smoothing_length: &'a [f64],
    /// Kernel support in smoothing lengths, skin included.
    pub factor: f64,
    /// Smallest and largest smoothing length, m.
    pub(crate) range: (f64, f64),
}

impl<'a> Reach<'a> {
    /// Points with these smoothing lengths (m), `factor` of which the kernel reaches.
    pub fn new(smoothing_length: &'a [f64], factor: f64) -> Self {
        Self { smoothing_length, factor, range: range_of(smoothing_length) }
    }

    /// Largest distance of any pair, m.
    pub fn largest(&self) -> f64 {
        self.factor * self.range.1
    }

    /// Squared distance at which `i` and `j` cease to be neighbours, m².
    #[inline(always)]
    pub fn squared(&self, i: usize, j: usize) -> f64 {
        let r = 0.5 * self.factor * (self.smoothing_length[i] + self.smoothing_length[j]);
        r * r
    }
}

/// Smallest and largest smoothing length.
pub(crate) fn range_of(smoothing_length: &[f64]) -> (f64, f64) {
    let of = |h: &f64| (*h, *h);
    let widen = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
    smoothing_length.par_iter().with_min_len(CHUNK).map(of).reduce(|| (f64::INFINITY, 0.0), widen)
}

/// What a cell is larger than the reach, as a share of it: a few more points to leave out, and particles are sorted into cells
/// once in several steps.
const CELL_MARGIN: f64 = 0.1;

/// Points one thread takes at a time.
const CHUNK: usize = 1024;

/// Places whose coordinates a partial search renews together; a word of bits.
const PLACES: usize = 64;

/// Whether a partial search has coordinates of the places of a group.
mod need {
    pub(super) const NONE: u8 = 0;
    pub(super) const WANTED: u8 = 1;
    pub(super) const HERE: u8 = 2;
}

/// What a partial search does to a row.
pub(crate) mod mark {
    /// The row stays.
    pub(crate) const KEEP: u8 = 0;
    /// The row is made anew.
    pub(crate) const SEARCH: u8 = 1;
    /// A neighbour of one that is searched: entries that are searched are made anew, the others stay.
    pub(crate) const MEND: u8 = 2;
}

/// The searcher: a cell grid and the points in its order, kept between searches.
#[derive(Debug, Default)]
pub(crate) struct Searcher {
    pub(super) grid: CellGrid,
    /// Where the points were when they were sorted into cells, m, with the reading of the odometer then, m, and the reach they
    /// were sorted for, m.
    sorted_at: Vec<Vector<f64>>,
    sorted_when: Odometer,
    sorted_for: f64,
    bounds: (Vector<f64>, Vector<f64>),
    frame: Frame,
    /// Encoded coordinates and smoothing lengths, in units of the frame, in cell order, padded to whole bundles. A partial search
    /// renews those it may look at.
    pub(super) x: [Vec<f32>; 3],
    pub(super) h: Vec<f32>,
    /// Place of every point in the cell order.
    place: Vec<u32>,
    /// Point indices in cell order, padded like the coordinates.
    pub(super) order: Vec<u32>,
    /// Bit k: the point in place k is searched. Only for partial searches.
    searched: Vec<u64>,
    /// What a partial search needs of each [`PLACES`] places.
    needed: Vec<AtomicU8>,
    /// Squared reach where all smoothing lengths are equal, in units of the frame.
    uniform: Option<f32>,
    pub(super) half_factor: f32,
    /// One for each thread.
    scratch: Vec<Mutex<Scratch>>,
}

/// What a thread needs beside the list.
#[derive(Debug, Default)]
struct Scratch {
    /// A block being rebuilt.
    spare: Block,
    /// A row being made.
    row: Block,
    candidates: Candidates,
}

impl Searcher {
    /// Fills `list` with the neighbours of the first `count` of `points`. Rows come in the order of the cells, which depends on
    /// positions alone, never on threads. The `odometer` is that of the points.
    pub(crate) fn search(
        &mut self,
        points: &[Vector<f64>],
        count: usize,
        reach: &Reach<'_>,
        odometer: Odometer,
        instructions: Instructions,
        list: &mut NeighborList,
    ) {
        self.prepare(points, reach, odometer);
        self.encode_all(points, reach);
        list.resize(count);
        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            block.clear();
            let rows = b * BLOCK..((b + 1) * BLOCK).min(count);
            let candidates = &mut this.scratch().candidates;
            candidates.clear();
            run(instructions, RowsJob { searcher: this, rows, candidates, block });
        });
    }

    /// Searches the points `searched`. Where a row gains or loses a neighbour, that neighbour's row is mended, so that a symmetric
    /// list stays so: of every pair either both rows know or none. A ghost (a point from `count` on, image of `source[ghost]`) is
    /// searched if its source is. `marks` says [`mark::SEARCH`] of these points and [`mark::KEEP`] of the others; rows to be mended
    /// get [`mark::MEND`]. With `one_sided` nothing is mended.
    pub(crate) fn renew(
        &mut self,
        points: &[Vector<f64>],
        sources: &[u32],
        reach: &Reach<'_>,
        odometer: Odometer,
        instructions: Instructions,
        list: &mut NeighborList,
        searched: &[u32],
        marks: &[AtomicU8],
        one_sided: bool,
    ) {
        let count = points.len() - sources.len();
        self.prepare(points, reach, odometer);
        self.note_searched(searched);
        self.encode_wanted(points, reach);
        let mark_of = |i: usize| marks[i].load(Ordering::Relaxed);
        let source = |j: u32| if (j as usize) < count { j as usize } else { sources[j as usize - count] as usize };
        let mend = |j: u32| {
            if mark_of(source(j)) == mark::KEEP {
                // Every thread writes the same value.
                marks[source(j)].store(mark::MEND, Ordering::Relaxed);
            }
        };
        let rows = |b: usize, what: u8| {
            (b * BLOCK..((b + 1) * BLOCK).min(count)).filter(move |&i| marks[i].load(Ordering::Relaxed) == what)
        };

        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            let mut to_search = rows(b, mark::SEARCH).peekable();
            if to_search.peek().is_none() {
                return;
            }
            let Scratch { spare, row, candidates } = &mut *this.scratch();
            candidates.clear();
            for i in to_search {
                row.clear();
                run(instructions, RowsJob { searcher: this, rows: i..i + 1, candidates, block: row });
                if !one_sided {
                    differences(block.row(i % BLOCK), row.row(0), mend);
                }
                block.set_row(i % BLOCK, i as u32, row.row(0), spare);
            }
        });
        if one_sided {
            return;
        }
        // A former neighbour may be anywhere.
        (0..list.blocks().len()).into_par_iter().for_each(|b| rows(b, mark::MEND).for_each(|i| this.want_cell_of(i)));
        self.encode_wanted(points, reach);
        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            let mut to_mend = rows(b, mark::MEND).peekable();
            if to_mend.peek().is_none() {
                return;
            }
            let Scratch { spare, row, candidates } = &mut *this.scratch();
            candidates.clear();
            for i in to_mend {
                row.clear();
                for &j in block.row(i % BLOCK).iter().filter(|&&j| mark_of(j as usize) != mark::SEARCH) {
                    row.push(j);
                }
                run(instructions, MendJob { searcher: this, row: i, candidates, block: row });
                block.set_row(i % BLOCK, i as u32, row.row(0), spare);
            }
        });
    }

    /// Indices of the points in the order of the cells of a search with the given reach, m: points of one cell are then served
    /// one after the other.
    pub(crate) fn cell_order(&mut self, points: &[Vector<f64>], reach: f64) -> &[u32] {
        self.grid.sort(points, reach * (1.0 + CELL_MARGIN));
        self.forget();
        self.grid.order()
    }

    /// Makes the next search sort points into cells anew: they have been put elsewhere, or into another order.
    pub(crate) fn forget(&mut self) {
        self.sorted_at.clear();
    }

    /// The frame in which coordinates of the points are encoded for pair sums; it holds them until they have moved through
    /// the reach.
    pub(crate) fn frame<T: PairScalar>(&self) -> Frame {
        Frame::around::<T>(self.bounds.0, self.bounds.1, 2.0 * self.sorted_for)
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let columns: usize = self.x.iter().chain([&self.h]).map(|c| 4 * c.capacity()).sum();
        self.grid.bytes()
            + columns
            + 4 * (self.place.capacity() + self.order.capacity())
            + 24 * self.sorted_at.capacity()
            + 8 * self.searched.capacity()
            + self.needed.capacity()
            + self.scratch.iter().filter_map(|s| s.lock().ok()).map(|s| s.candidates.bytes()).sum::<usize>()
    }

    /// What the calling thread keeps for itself.
    fn scratch(&self) -> MutexGuard<'_, Scratch> {
        // Only a panic in a row poisons the lock; all of it is cleared before use.
        self.scratch[rayon::current_thread_index().unwrap_or(0)].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sorts `points` into cells anew if they have moved too far.
    fn prepare(&mut self, points: &[Vector<f64>], reach: &Reach<'_>, odometer: Odometer) {
        self.prepare_scratch();
        let largest = reach.largest();
        self.half_factor = (0.5 * reach.factor) as f32;
        if self.serves(points, largest, odometer) {
            return;
        }
        self.grid.sort(points, largest * (1.0 + CELL_MARGIN));
        self.sorted_at.clear();
        self.sorted_at.extend_from_slice(points);
        (self.sorted_for, self.sorted_when) = (largest, odometer);
        self.bounds = bounds(points);
        self.frame = self.frame::<f32>();
        let padded = points.len() + PAD;
        for column in self.x.iter_mut().chain([&mut self.h]) {
            column.resize(padded, 0.0);
        }
        self.order.resize(padded, 0);
        self.order[..points.len()].copy_from_slice(self.grid.order());
        self.place.resize(points.len(), 0);
        for (k, &i) in self.grid.order().iter().enumerate() {
            self.place[i as usize] = k as u32;
        }
    }

    /// One scratch for each thread, each as large as the largest: who gets the densest cells next is chance.
    fn prepare_scratch(&mut self) {
        self.scratch.resize_with(rayon::current_num_threads(), Mutex::default);
        let room = |s: &mut Mutex<Scratch>| s.get_mut().unwrap_or_else(PoisonError::into_inner).candidates.room();
        let most = self.scratch.iter_mut().map(room).max().unwrap_or(0);
        for scratch in &mut self.scratch {
            scratch.get_mut().unwrap_or_else(PoisonError::into_inner).candidates.make_room(most);
        }
    }

    /// Whether the cells serve points that are where `points` are.
    fn serves(&self, points: &[Vector<f64>], largest: f64, odometer: Odometer) -> bool {
        let allowed = 0.5 * CELL_MARGIN * largest;
        self.sorted_at.len() == points.len()
            && self.sorted_for == largest
            && (odometer.is_within(self.sorted_when, allowed)
                || points.par_chunks(CHUNK).zip(self.sorted_at.par_chunks(CHUNK)).all(|(now, then)| {
                    now.iter().zip(then).all(|(now, then)| {
                        let d = [now[0] - then[0], now[1] - then[1], now[2] - then[2]];
                        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= allowed * allowed
                    })
                }))
    }

    /// Brings all columns to the positions of `points`.
    fn encode_all(&mut self, points: &[Vector<f64>], reach: &Reach<'_>) {
        self.encode(points, reach, CHUNK, |_| true);
    }

    /// Brings the columns of the groups that are wanted to the positions of `points`.
    fn encode_wanted(&mut self, points: &[Vector<f64>], reach: &Reach<'_>) {
        let needed = std::mem::take(&mut self.needed);
        let is_wanted = |group: usize| needed[group].load(Ordering::Relaxed) == need::WANTED;
        self.encode(points, reach, PLACES, is_wanted);
        needed.par_iter().with_min_len(CHUNK).for_each(|need| {
            if need.load(Ordering::Relaxed) == need::WANTED {
                need.store(need::HERE, Ordering::Relaxed);
            }
        });
        self.needed = needed;
    }

    /// Brings columns to the positions of `points`, in groups of `size` places, those that are `wanted`.
    fn encode(
        &mut self,
        points: &[Vector<f64>],
        reach: &Reach<'_>,
        size: usize,
        wanted: impl Fn(usize) -> bool + Sync,
    ) {
        let inverse_unit = 1.0 / self.frame.unit;
        let limit = reach.largest() * inverse_unit;
        self.uniform = (reach.range.0 == reach.range.1).then_some((limit * limit) as f32);
        let (frame, grid) = (self.frame, &self.grid);
        let [x, y, z] = &mut self.x;
        (x.par_chunks_mut(size), y.par_chunks_mut(size), z.par_chunks_mut(size), self.h.par_chunks_mut(size))
            .into_par_iter()
            .zip(grid.order().par_chunks(size))
            .with_min_len(CHUNK / size)
            .enumerate()
            .filter(|(group, _)| wanted(*group))
            .for_each(|(_, ((x, y, z, h), order))| {
                for (k, &i) in order.iter().enumerate() {
                    [x[k], y[k], z[k]] = frame.encode::<f32>(&points[i as usize]);
                    h[k] = (reach.smoothing_length[i as usize] * inverse_unit) as f32;
                }
            });
    }

    /// Notes who is searched, and that all around them is needed.
    fn note_searched(&mut self, searched: &[u32]) {
        // One word more than needed: bundles may start anywhere.
        self.searched.resize(self.order.len() / 64 + 2, 0);
        self.searched.fill(0);
        self.needed.resize_with(self.order.len().div_ceil(PLACES), AtomicU8::default);
        self.needed.par_iter_mut().with_min_len(CHUNK).for_each(|need| *need.get_mut() = need::NONE);
        let mut last = None;
        for &i in searched {
            let k = self.place[i as usize] as usize;
            self.searched[k / 64] |= 1 << (k % 64);
            let cell = self.grid.cell_of(i as usize);
            // Points of one cell come one after the other.
            if last != Some(cell) {
                last = Some(cell);
                for (first, last) in self.grid.runs_around_cell(cell) {
                    self.want(first..last);
                }
            }
        }
    }

    fn want_cell_of(&self, i: usize) {
        self.want(self.grid.members_run(self.grid.cell_of(i)));
    }

    /// Asks for the coordinates of places.
    fn want(&self, places: std::ops::Range<usize>) {
        if places.is_empty() {
            return;
        }
        for need in &self.needed[places.start / PLACES..=(places.end - 1) / PLACES] {
            if need.load(Ordering::Relaxed) == need::NONE {
                need.store(need::WANTED, Ordering::Relaxed);
            }
        }
    }

    /// Bits of the `WIDTH` points from place `k` on.
    #[inline(always)]
    pub(super) fn searched_from(&self, k: usize) -> u32 {
        let low = self.searched[k / 64] >> (k % 64);
        let high = (self.searched[k / 64 + 1] << 1) << (63 - k % 64);
        (low | high) as u32
    }

    /// Adds the neighbours of point `i` to the row being written; if `ONLY_SEARCHED`, those among the searched points.
    #[inline(always)]
    fn row<L: Lanes<Element = f32>, const ONLY_SEARCHED: bool>(
        &self,
        i: usize,
        candidates: &mut Candidates,
        block: &mut Block,
    ) {
        candidates.collect::<L, ONLY_SEARCHED>(self, self.grid.cell_of(i));
        match self.uniform {
            Some(limit) => self.row_within::<L, true>(i, limit, candidates, block),
            None => self.row_within::<L, false>(i, 0.0, candidates, block),
        }
    }

    #[inline(always)]
    fn row_within<L: Lanes<Element = f32>, const UNIFORM: bool>(
        &self,
        i: usize,
        limit: f32,
        candidates: &Candidates,
        block: &mut Block,
    ) {
        let own = self.place[i] as usize;
        let x_i = [L::splat(self.x[0][own]), L::splat(self.x[1][own]), L::splat(self.x[2][own])];
        let h_i = L::splat(self.h[own]);
        let half_factor = L::splat(self.half_factor);
        let uniform = L::splat(limit);
        // Whole bundles, the last of which may reach past what was collected. All of a bundle is written, of which what is not
        // kept is overwritten.
        let end = candidates.count.next_multiple_of(L::WIDTH);
        let found = block.room(end + PAD);
        let mut count = 0;
        let bundles = candidates.x[0][..end]
            .chunks_exact(L::WIDTH)
            .zip(candidates.x[1][..end].chunks_exact(L::WIDTH))
            .zip(candidates.x[2][..end].chunks_exact(L::WIDTH))
            .zip(candidates.h[..end].chunks_exact(L::WIDTH))
            .zip(candidates.index[..end].chunks_exact(L::WIDTH));
        let mut left = candidates.count;
        for ((((x, y), z), h), index) in bundles {
            let dx = L::coordinate_difference(x_i[0], L::load(x));
            let dy = L::coordinate_difference(x_i[1], L::load(y));
            let dz = L::coordinate_difference(x_i[2], L::load(z));
            let r2 = dx.mul_add(dx, dy.mul_add(dy, dz * dz));
            let mut mask = if UNIFORM {
                L::less(r2, uniform)
            } else {
                let r = half_factor * (h_i + L::load(h));
                L::less(r2, r * r)
            };
            if left < L::WIDTH {
                mask &= (1 << left) - 1;
            }
            left = left.saturating_sub(L::WIDTH);
            // Not its own neighbour.
            count += L::compress_others(mask, index, i as u32, &mut found[count..]);
        }
        block.advance(count);
        block.end_row(i as u32);
    }
}

/// Visits what two rows without repetitions do not share.
fn differences(old: &[u32], new: &[u32], mut visit: impl FnMut(u32)) {
    // Rows come in the order of the cells and mostly stay as they are.
    let same = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let (old, new) = (&old[same..], &new[same..]);
    let same = old.iter().rev().zip(new.iter().rev()).take_while(|(a, b)| a == b).count();
    let (old, new) = (&old[..old.len() - same], &new[..new.len() - same]);
    old.iter().filter(|j| !new.contains(j)).for_each(|&j| visit(j));
    new.iter().filter(|j| !old.contains(j)).for_each(|&j| visit(j));
}

/// Rows made anew.
struct RowsJob<'a> {
    searcher: &'a Searcher,
    rows: std::ops::Range<usize>,
    candidates: &'a mut Candidates,
    block: &'a mut Block,
}

impl Job<f32> for RowsJob<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f32>>(self) {
        for i in self.rows {
            self.searcher.row::<L, false>(i, self.candidates, self.block);
        }
    }
}

/// The searched entries of a row, behind those that stay.
struct MendJob<'a> {
    searcher: &'a Searcher,
    row: usize,
    candidates: &'a mut Candidates,
    block: &'a mut Block,
}

impl Job<f32> for MendJob<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f32>>(self) {
        self.searcher.row::<L, true>(self.row, self.candidates, self.block);
    }
}

#[cfg(test)]
mod tests;
