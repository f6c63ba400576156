//! Brute-force search over all pairs: the reference for all searches in tests.

use super::{BLOCK, NeighborList, Reach};
use sphorge_physics::Vector;
use std::ops::Range;

/// Neighbours of the first `count` points among all `points`, rows sorted by index, by testing every pair.
pub fn brute_force(points: &[Vector<f64>], count: usize, reach: &Reach<'_>) -> NeighborList {
    brute_force_rows(points, 0..count, reach)
}

/// The same for some of the points.
pub(crate) fn brute_force_rows(points: &[Vector<f64>], wanted: Range<usize>, reach: &Reach<'_>) -> NeighborList {
    let mut list = NeighborList::default();
    list.resize(wanted.len());
    for (b, block) in list.blocks_mut().iter_mut().enumerate() {
        block.clear();
        let first = wanted.start + b * BLOCK;
        for i in first..(first + BLOCK).min(wanted.end) {
            for j in (0..points.len()).filter(|&j| j != i) {
                let distance2: f64 = (0..3).map(|a| (points[i][a] - points[j][a]).powi(2)).sum();
                if distance2 < reach.squared(i, j) {
                    block.push(j as u32);
                }
            }
            block.end_row(i as u32);
        }
    }
    list
}
