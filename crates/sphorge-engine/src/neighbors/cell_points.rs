//! Points sorted into cells, with their coordinates encoded for the distance test.
//!
//! Cells are a little larger than the reach, so that they serve as long as no particle has moved through half of the
//! difference; only coordinates are updated in between.

use super::cells::{CHUNK, are_places, bounds};
use super::{CellGrid, DisplacementBound, Frame, PAD, Reach};
use crate::lanes::PairScalar;
use crate::persist::{Archive, ArchiveError, Persist, require};
use rayon::prelude::*;
use sphorge_physics::Vector;
use std::sync::atomic::{AtomicU8, Ordering};

/// What a cell is larger than the reach, as a share of it: a few more points to leave out, and particles are sorted into cells
/// once in several steps.
const CELL_MARGIN: f64 = 0.1;

/// Places whose coordinates a partial search updates together; a word of bits.
const PLACES: usize = 64;

/// Whether a partial search has coordinates of the places of a group.
mod need {
    pub(super) const NONE: u8 = 0;
    pub(super) const WANTED: u8 = 1;
    pub(super) const HERE: u8 = 2;
}

/// Cells along an axis, at most, of a state that is loaded: particles of one run are never so many reaches apart.
const MOST_CELLS: f64 = 1e12;

/// Points in the order of their cells.
#[derive(Debug, Default)]
pub(super) struct CellPoints {
    pub(super) grid: CellGrid,
    /// Where the points were when they were sorted into cells, m, with the displacement bound then, m, and the reach they
    /// were sorted for, m.
    sorted_at: Vec<Vector<f64>>,
    sorted_when: DisplacementBound,
    sorted_for: f64,
    bounds: (Vector<f64>, Vector<f64>),
    frame: Frame,
    /// Encoded coordinates and smoothing lengths, in units of the frame, in cell order, padded to whole SIMD vectors. A partial
    /// search updates those it may read.
    pub(super) x: [Vec<f32>; 3],
    pub(super) h: Vec<f32>,
    /// Place of every point in the cell order.
    pub(super) place: Vec<u32>,
    /// Point indices in cell order, padded like the coordinates.
    pub(super) order: Vec<u32>,
    /// Bit k: the row of the point in place k is rebuilt. Only for partial searches.
    rebuilt: Vec<u64>,
    /// What a partial search needs of each [`PLACES`] places.
    needed: Vec<AtomicU8>,
    /// Squared reach where all smoothing lengths are equal, in units of the frame.
    pub(super) uniform: Option<f32>,
    pub(super) half_factor: f32,
}

impl CellPoints {
    /// Sorts `points` into cells again if they have moved too far.
    pub(super) fn prepare(&mut self, points: &[Vector<f64>], reach: &Reach<'_>, displacement: DisplacementBound) {
        let largest = reach.largest();
        self.half_factor = (0.5 * reach.factor) as f32;
        if self.serves(points, largest, displacement) {
            return;
        }
        self.sort(points, largest, displacement);
    }

    /// Sorts `points` into cells for a search with the reach `largest`, m.
    fn sort(&mut self, points: &[Vector<f64>], largest: f64, displacement: DisplacementBound) {
        self.grid.sort(points, largest * (1.0 + CELL_MARGIN));
        self.sorted_at.clear();
        self.sorted_at.extend_from_slice(points);
        (self.sorted_for, self.sorted_when) = (largest, displacement);
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

    /// Whether the cells serve points that are where `points` are.
    fn serves(&self, points: &[Vector<f64>], largest: f64, displacement: DisplacementBound) -> bool {
        let allowed = 0.5 * CELL_MARGIN * largest;
        self.sorted_at.len() == points.len()
            && self.sorted_for == largest
            && (displacement.is_within(self.sorted_when, allowed)
                || points.par_chunks(CHUNK).zip(self.sorted_at.par_chunks(CHUNK)).all(|(now, then)| {
                    now.iter().zip(then).all(|(now, then)| {
                        let d = [now[0] - then[0], now[1] - then[1], now[2] - then[2]];
                        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= allowed * allowed
                    })
                }))
    }

    /// Indices of the points in the order of tiles of cells of a search with the given reach, m, along a Hilbert curve.
    pub(super) fn tiled_order(&mut self, points: &[Vector<f64>], reach: f64) -> &[u32] {
        self.grid.sort(points, reach * (1.0 + CELL_MARGIN));
        self.forget();
        self.grid.tiled_order()
    }

    /// Makes the next search sort points into cells again: they have been put elsewhere, or into another order.
    pub(super) fn forget(&mut self) {
        self.sorted_at.clear();
    }

    /// The frame in which coordinates of the points are encoded for pair sums; it holds them until they have moved through
    /// the reach.
    pub(super) fn frame<T: PairScalar>(&self) -> Frame {
        Frame::around::<T>(self.bounds.0, self.bounds.1, 2.0 * self.sorted_for)
    }

    /// Whether `count` points are sorted into the cells, or none.
    pub(super) fn fits(&self, count: usize) -> bool {
        self.sorted_at.is_empty() || self.sorted_at.len() == count
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let columns: usize = self.x.iter().chain([&self.h]).map(|c| 4 * c.capacity()).sum();
        self.grid.bytes()
            + columns
            + 4 * (self.place.capacity() + self.order.capacity())
            + 24 * self.sorted_at.capacity()
            + 8 * self.rebuilt.capacity()
            + self.needed.capacity()
    }

    /// Brings all columns to the positions of `points`.
    pub(super) fn encode_all(&mut self, points: &[Vector<f64>], reach: &Reach<'_>) {
        self.encode(points, reach, CHUNK, |_| true);
    }

    /// Brings the columns of the groups that are wanted to the positions of `points`.
    pub(super) fn encode_wanted(&mut self, points: &[Vector<f64>], reach: &Reach<'_>) {
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

    /// Notes whose rows are rebuilt, and that the coordinates around those of these points that are `wanted` are needed.
    pub(super) fn note_rebuilt(&mut self, rebuilt: &[u32], wanted: impl Fn(u32) -> bool) {
        // One word more than needed: SIMD vectors may start anywhere.
        self.rebuilt.resize(self.order.len() / 64 + 2, 0);
        self.rebuilt.fill(0);
        self.needed.resize_with(self.order.len().div_ceil(PLACES), AtomicU8::default);
        self.needed.par_iter_mut().with_min_len(CHUNK).for_each(|need| *need.get_mut() = need::NONE);
        let mut last = None;
        for &i in rebuilt {
            let k = self.place[i as usize] as usize;
            self.rebuilt[k / 64] |= 1 << (k % 64);
            let cell = self.grid.cell_of(i as usize);
            // Points of one cell come one after the other.
            if last != Some(cell) && wanted(i) {
                last = Some(cell);
                for (first, last) in self.grid.runs_around_cell(cell) {
                    self.want(first..last);
                }
            }
        }
    }

    /// Asks for the coordinates of all points around one.
    pub(super) fn want_around(&self, i: usize) {
        for (first, last) in self.grid.runs_around_cell(self.grid.cell_of(i)) {
            self.want(first..last);
        }
    }

    pub(super) fn want_cell_of(&self, i: usize) {
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
    pub(super) fn rebuilt_from(&self, k: usize) -> u32 {
        let low = self.rebuilt[k / 64] >> (k % 64);
        let high = (self.rebuilt[k / 64 + 1] << 1) << (63 - k % 64);
        (low | high) as u32
    }
}

impl Persist for CellPoints {
    /// The order of the points, and with it that of the rows, follows from where they were sorted.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.sorted_at.persist(&format!("{name}.sorted_at"), archive)?;
        self.sorted_when.persist(&format!("{name}.sorted_when"), archive)?;
        self.sorted_for.persist(&format!("{name}.sorted_for"), archive)?;
        if !archive.is_saving() && !self.sorted_at.is_empty() {
            // Cells of no size, or as many as reach to infinity, cannot be made.
            let points = std::mem::take(&mut self.sorted_at);
            require(are_places(&points), &format!("{name}.sorted_at"))?;
            let (low, high) = bounds(&points);
            let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
            let is_a_reach =
                self.sorted_for.is_normal() && self.sorted_for > 0.0 && extent < MOST_CELLS * self.sorted_for;
            require(is_a_reach, &format!("{name}.sorted_for"))?;
            self.sort(&points, self.sorted_for, self.sorted_when);
        }
        Ok(())
    }
}
