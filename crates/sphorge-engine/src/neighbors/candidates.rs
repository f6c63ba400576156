//! Candidates of a cell: points that may be neighbours of its members, from which rows are selected.
//!
//! The 27 cells around a cell are nine contiguous runs of points, most of which are out of reach of every member. One
//! pass over the runs with the bounding box of the members leaves about half, stored contiguously.

use super::PAD;
use super::cell_points::CellPoints;
use crate::lanes::Lanes;

/// Points within reach of the box around the members of a cell, in the order of the cells.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    /// The cell for which they were collected.
    cell: Option<usize>,
    /// Encoded coordinates and smoothing lengths; only the first `count` entries are valid, the rest is capacity.
    pub(super) x: [Vec<f32>; 3],
    pub(super) h: Vec<f32>,
    /// Indices of the points.
    pub(super) index: Vec<u32>,
    pub(super) count: usize,
}

impl Candidates {
    /// Discards the candidates.
    pub(super) fn clear(&mut self) {
        self.cell = None;
    }

    /// Capacity in points.
    pub(super) fn room(&self) -> usize {
        self.index.len()
    }

    /// Allocates memory for `most` points.
    #[inline(always)]
    pub(super) fn make_room(&mut self, most: usize) {
        if self.index.len() < most {
            self.x.iter_mut().chain([&mut self.h]).for_each(|column| column.resize(most, 0.0));
            self.index.resize(most, 0);
        }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        4 * (self.x.iter().chain([&self.h]).map(Vec::capacity).sum::<usize>() + self.index.capacity())
    }

    /// Collects the candidates of `cell` unless they are already collected; if `ONLY_REBUILT`, only points whose rows
    /// are rebuilt.
    #[inline(always)]
    pub(super) fn collect<L: Lanes<Element = f32>, const ONLY_REBUILT: bool>(
        &mut self,
        points: &CellPoints,
        cell: usize,
    ) {
        if self.cell == Some(cell) {
            return;
        }
        self.cell = Some(cell);
        let runs = points.grid.runs_around_cell(cell);
        let most = runs.iter().map(|(first, last)| last - first).sum::<usize>() + PAD;
        self.make_room(most);

        // The bounding box of the members, as a centre and half its size, in units.
        let mut centre = [L::zero(); 3];
        let mut half = [L::zero(); 3];
        let members = points.grid.members_run(cell);
        for a in 0..3 {
            let (mut low, mut high) = (i32::MAX, i32::MIN);
            for x in &points.x[a][members.clone()] {
                let x = x.to_bits() as i32;
                (low, high) = (low.min(x), high.max(x));
            }
            let middle = low + (high - low) / 2;
            centre[a] = L::splat(f32::from_bits(middle as u32));
            // One unit for the rounding of the centre.
            half[a] = L::splat((high - middle) as f32 + 1.0);
        }
        let widest = points.h[members].iter().fold(0.0f32, |m, &h| m.max(h));
        // A little more, so that rounding excludes no neighbour.
        let factor = L::splat(points.half_factor * 1.00001);
        let widest = L::splat(widest);

        let mut count = 0;
        let [out_x, out_y, out_z] = &mut self.x;
        for (first, last) in runs {
            let mut k = first;
            while k < last {
                let x = [L::load(&points.x[0][k..]), L::load(&points.x[1][k..]), L::load(&points.x[2][k..])];
                let h = L::load(&points.h[k..]);
                let mut r2 = L::zero();
                for a in 0..3 {
                    let outside = (L::coordinate_difference(x[a], centre[a]).abs() - half[a]).max(L::zero());
                    r2 = outside.mul_add(outside, r2);
                }
                let r = factor * (widest + h);
                let mut mask = L::less(r2, r * r);
                let left = last - k;
                if left < L::WIDTH {
                    mask &= (1 << left) - 1;
                }
                if ONLY_REBUILT {
                    mask &= points.rebuilt_from(k);
                }
                x[0].compress_values(mask, &mut out_x[count..]);
                x[1].compress_values(mask, &mut out_y[count..]);
                x[2].compress_values(mask, &mut out_z[count..]);
                h.compress_values(mask, &mut self.h[count..]);
                // No point has this index.
                count += L::compress_others(mask, &points.order[k..], u32::MAX, &mut self.index[count..]);
                k += L::WIDTH;
            }
        }
        self.count = count;
    }
}
