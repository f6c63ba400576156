//! The neighbours of one point: the distance test over its candidates.
//!
//! Distances are tested in single precision on fixed-point coordinates, whatever the precision of the pair sums. Both rows of a
//! pair come to the same result, bit for bit.

use super::candidates::Candidates;
use super::cell_points::CellPoints;
use super::{Block, PAD};
use crate::lanes::{Job, Lanes};

/// Rows to rebuild.
pub(super) struct RowsJob<'a> {
    pub(super) points: &'a CellPoints,
    pub(super) rows: std::ops::Range<usize>,
    pub(super) candidates: &'a mut Candidates,
    pub(super) block: &'a mut Block,
}

impl Job<f32> for RowsJob<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f32>>(self) {
        for i in self.rows {
            row::<L, false>(self.points, i, self.candidates, self.block);
        }
    }
}

/// A row to patch: its entries of points whose rows are rebuilt; they follow those that are kept.
pub(super) struct PatchJob<'a> {
    pub(super) points: &'a CellPoints,
    pub(super) row: usize,
    pub(super) candidates: &'a mut Candidates,
    pub(super) block: &'a mut Block,
}

impl Job<f32> for PatchJob<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f32>>(self) {
        row::<L, true>(self.points, self.row, self.candidates, self.block);
    }
}

/// Adds the neighbours of point `i` to the row being written; if `ONLY_REBUILT`, only those whose rows are rebuilt.
#[inline(always)]
fn row<L: Lanes<Element = f32>, const ONLY_REBUILT: bool>(
    points: &CellPoints,
    i: usize,
    candidates: &mut Candidates,
    block: &mut Block,
) {
    candidates.collect::<L, ONLY_REBUILT>(points, points.grid.cell_of(i));
    match points.uniform {
        Some(limit) => row_within::<L, true>(points, i, limit, candidates, block),
        None => row_within::<L, false>(points, i, 0.0, candidates, block),
    }
}

#[inline(always)]
fn row_within<L: Lanes<Element = f32>, const UNIFORM: bool>(
    points: &CellPoints,
    i: usize,
    limit: f32,
    candidates: &Candidates,
    block: &mut Block,
) {
    let own = points.place[i] as usize;
    let x_i = [L::splat(points.x[0][own]), L::splat(points.x[1][own]), L::splat(points.x[2][own])];
    let h_i = L::splat(points.h[own]);
    let half_factor = L::splat(points.half_factor);
    let uniform = L::splat(limit);
    // Whole SIMD vectors, the last of which may extend past the collected points. All lanes are written, and those that
    // are not kept are overwritten.
    let end = candidates.count.next_multiple_of(L::WIDTH);
    let found = block.room(end + PAD);
    let mut count = 0;
    let vectors = candidates.x[0][..end]
        .chunks_exact(L::WIDTH)
        .zip(candidates.x[1][..end].chunks_exact(L::WIDTH))
        .zip(candidates.x[2][..end].chunks_exact(L::WIDTH))
        .zip(candidates.h[..end].chunks_exact(L::WIDTH))
        .zip(candidates.index[..end].chunks_exact(L::WIDTH));
    let mut left = candidates.count;
    for ((((x, y), z), h), index) in vectors {
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
