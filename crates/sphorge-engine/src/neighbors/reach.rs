//! The largest distance of neighbours.

use super::cells::CHUNK;
use rayon::prelude::*;

/// The largest distance of two neighbours: `factor (h_i + h_j) / 2`.
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
    /// For points with these smoothing lengths (m), with a kernel reach of `factor` smoothing lengths.
    pub fn new(smoothing_length: &'a [f64], factor: f64) -> Self {
        Self { smoothing_length, factor, range: range_of(smoothing_length) }
    }

    /// Largest distance of any pair, m.
    pub fn largest(&self) -> f64 {
        self.factor * self.range.1
    }

    /// Squared distance from which on `i` and `j` are not neighbours, m².
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
