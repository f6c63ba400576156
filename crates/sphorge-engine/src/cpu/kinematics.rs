//! First pair sum: velocity gradient, and the moment matrix of the gradient correction.
//!
//! `L_i = sum_j w_j (v_j - v_i) ⊗ grad_i W_ij` with `w_j = m_j/rho_j` or `m_j/rho_i` (Patiño et al. Eqs 22, 23 give its
//! symmetric and skew parts; Eq 8 its trace).

use super::records::kinematic::{H, LEN, V, WEIGHT, X};
use super::stored::StoredBlock;
use crate::lanes::{Job, Lanes, PairScalar, splat_record};
use crate::neighbors::{BLOCK, Block};
use sphorge_physics::kernel::{Kernel, PairScale, pair_smoothing_length};
use sphorge_physics::pair::GradientSums;
use sphorge_physics::{Tensor, Vector};

/// Constants of a pair sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairConstants<T> {
    /// Size of a coordinate unit, m.
    pub(super) unit: T,
    /// The kernel: chosen by a well-predicted branch within the loop, whose cost is negligible compared with the
    /// gathers.
    pub(super) kernel: Kernel,
    /// Normalisation `sigma_d` of the kernel.
    pub(super) sigma: T,
}

/// The scale of pairs of a particle with those of its own smoothing length, in every lane.
#[inline(always)]
pub(super) fn own_scale<L: Lanes, const D: usize>(
    constants: &PairConstants<L::Element>,
    h_i: L::Element,
) -> PairScale<L> {
    let scale = PairScale::<L::Element>::new::<D>(constants.sigma, h_i);
    PairScale { h: L::splat(scale.h), inverse_h: L::splat(scale.inverse_h), gradient: L::splat(scale.gradient) }
}

/// The scale of a SIMD vector of pairs. If all smoothing lengths are that of the particle, as they are except where
/// bodies meet, this is its `own`, without a division.
#[inline(always)]
pub(super) fn scale_with<L: Lanes, const D: usize>(
    own: PairScale<L>,
    constants: &PairConstants<L::Element>,
    h_j: L,
) -> PairScale<L> {
    if L::less(own.h, h_j) | L::less(h_j, own.h) == 0 {
        own
    } else {
        PairScale::new::<D>(L::splat(constants.sigma), pair_smoothing_length(own.h, h_j))
    }
}

/// Sums of one particle.
#[derive(Clone, Copy)]
pub(super) struct GradientSum<T> {
    /// `sum_j w_j (v_j - v_i) ⊗ grad_i W_ij`, row: velocity component.
    pub(super) gradient: Tensor<T>,
    /// `sum_j w_j (x_j - x_i) ⊗ grad_i W_ij`; zero unless requested.
    pub(super) moment: Tensor<T>,
    /// Neighbours inside the kernel support.
    pub(super) inside: u32,
}

/// SIMD vectors of a row that are processed together.
const BATCH: usize = 8;

/// A SIMD vector of pairs, between the passes over a row.
#[derive(Clone, Copy)]
struct Pairs<L> {
    /// `x_i - x_j`, m.
    x: Vector<L>,
    /// `v_j - v_i`, m/s.
    v: Vector<L>,
    /// Weight of the neighbour.
    weight: L,
    /// Smoothing length of the neighbour, m.
    h: L,
    /// Distance squared, m².
    r2: L,
}

impl<L: Lanes> Pairs<L> {
    #[inline(always)]
    fn zero() -> Self {
        let o = L::zero();
        Self { x: [o; 3], v: [o; 3], weight: o, h: o, r2: o }
    }
}

/// Data of the particle of a row, in every lane.
#[derive(Clone, Copy)]
struct Own<L: Lanes> {
    record: [L; LEN],
    scale: PairScale<L>,
}

impl<L: Lanes> Own<L> {
    #[inline(always)]
    fn of<const D: usize>(constants: &PairConstants<L::Element>, record: &[L::Element; LEN]) -> Self {
        Self { record: splat_record(record), scale: own_scale::<L, D>(constants, record[H]) }
    }
}

/// First pass over a SIMD vector of pairs: gathers the neighbours. `stored` has the distances and the index at which
/// those of the vector start.
#[inline(always)]
fn locate<L: Lanes, const D: usize>(
    own: &Own<L>,
    records: &[[L::Element; LEN]],
    indices: &[u32],
    stored: Option<(&StoredBlock<L::Element>, usize)>,
    constants: &PairConstants<L::Element>,
    pair: &mut Pairs<L>,
) {
    let unit = L::splat(constants.unit);
    let record_j = L::gather(records, indices);
    let mut r2 = L::zero();
    for a in 0..D {
        let x = match stored {
            None => L::difference(own.record[X + a], record_j[X + a], unit),
            Some((stored, at)) => stored.vector(at, a),
        };
        r2 = x.mul_add(x, r2);
        pair.x[a] = x;
        pair.v[a] = record_j[V + a] - own.record[V + a];
    }
    pair.r2 = r2;
    pair.weight = record_j[WEIGHT];
    pair.h = record_j[H];
}

/// Sums of a row, lane by lane.
#[derive(Clone, Copy)]
struct Sums<L> {
    pairs: GradientSums<L>,
    /// Pairs inside the kernel support.
    inside: u32,
}

impl<L: Lanes> Sums<L> {
    #[inline(always)]
    fn zero() -> Self {
        Self { pairs: GradientSums::zero(), inside: 0 }
    }

    /// Second pass over a SIMD vector of pairs.
    #[inline(always)]
    fn add<const D: usize, const CORRECTED: bool>(
        &mut self,
        own: &Own<L>,
        constants: &PairConstants<L::Element>,
        pair: &Pairs<L>,
    ) {
        let scale = scale_with::<L, D>(own.scale, constants, pair.h);
        let (q, inverse_q) = scale.reduced_distance(pair.r2);
        let weighted_f = scale.weighted(pair.weight).f(constants.kernel.dw_over_q_by(q, inverse_q));
        self.inside += L::less(q, L::of(constants.kernel.support())).count_ones();
        self.pairs.add::<D, CORRECTED>(&pair.x, &pair.v, weighted_f);
    }

    /// All lanes together.
    #[inline(always)]
    fn total<const CORRECTED: bool>(&self) -> GradientSum<L::Element> {
        let mut sum = GradientSum::zero();
        sum.gradient = total_of(&self.pairs.gradient);
        if CORRECTED {
            sum.moment = total_of(&self.pairs.moment);
        }
        sum.inside = self.inside;
        sum
    }
}

#[inline(always)]
fn total_of<L: Lanes>(t: &Tensor<L>) -> Tensor<L::Element> {
    let [a, b, c, d, e, f, g, h, i] =
        L::sums([t[0][0], t[0][1], t[0][2], t[1][0], t[1][1], t[1][2], t[2][0], t[2][1], t[2][2]]);
    [[a, b, c], [d, e, f], [g, h, i]]
}

/// Row `k` of a block, particle `own`.
///
/// The arithmetic of a pair is one long dependency chain. With two short passes over the row, the processor works on
/// many pairs at a time.
#[inline(always)]
fn gradient_row<L: Lanes, const D: usize, const CORRECTED: bool>(
    records: &[[L::Element; LEN]],
    own: usize,
    block: &Block,
    k: usize,
    stored: Option<&StoredBlock<L::Element>>,
    constants: &PairConstants<L::Element>,
    pairs: &mut [Pairs<L>; BATCH],
) -> GradientSum<L::Element> {
    let own = Own::<L>::of::<D>(constants, &records[own]);
    let mut sums = Sums::<L>::zero();
    let row = block.padded_row(k, L::WIDTH);
    let mut at = block.start(k);
    for indices in row.chunks(BATCH * L::WIDTH) {
        let vectors = indices.chunks_exact(L::WIDTH);
        let count = vectors.len();
        for (pair, indices) in pairs.iter_mut().zip(vectors) {
            locate::<L, D>(&own, records, indices, stored.map(|s| (s, at)), constants, pair);
            at += L::WIDTH;
        }
        for pair in &pairs[..count] {
            sums.add::<D, CORRECTED>(&own, constants, pair);
        }
    }
    let mut sum = sums.total::<CORRECTED>();
    // Padding is the particle itself, at distance zero: inside the support.
    sum.inside -= (row.len() - block.row(k).len()) as u32;
    sum
}

impl<T: PairScalar> GradientSum<T> {
    /// Nothing summed.
    #[inline(always)]
    pub(super) fn zero() -> Self {
        Self { gradient: [[T::zero(); 3]; 3], moment: [[T::zero(); 3]; 3], inside: 0 }
    }
}

/// The sums of a block of particles.
pub(super) struct GradientJob<'a, T, const D: usize, const CORRECTED: bool> {
    pub(super) records: &'a [[T; LEN]],
    /// First particle of the block.
    pub(super) first: usize,
    pub(super) block: &'a Block,
    /// Distances to use instead of those of the records.
    pub(super) stored: Option<&'a StoredBlock<T>>,
    pub(super) constants: &'a PairConstants<T>,
    pub(super) sums: &'a mut [GradientSum<T>; BLOCK],
}

impl<T: PairScalar, const D: usize, const CORRECTED: bool> Job<T> for GradientJob<'_, T, D, CORRECTED> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let mut pairs = [Pairs::zero(); BATCH];
        for k in 0..self.block.len() {
            self.sums[k] = gradient_row::<L, D, CORRECTED>(
                self.records,
                self.first + k,
                self.block,
                k,
                self.stored,
                self.constants,
                &mut pairs,
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_of_a_pair_is_that_of_the_mean_smoothing_length() {
        let constants = PairConstants { unit: 1.0, kernel: Kernel::CubicSpline, sigma: 3.0f64 };
        let own = own_scale::<f64, 3>(&constants, 2.0);
        assert_eq!((own.h, own.inverse_h, own.gradient), (2.0, 0.5, 3.0 / 32.0));
        let same = scale_with::<f64, 3>(own, &constants, 2.0);
        assert_eq!((same.h, same.inverse_h, same.gradient), (2.0, 0.5, 3.0 / 32.0));
        for (h_j, h) in [(6.0, 4.0), (1.0, 1.5)] {
            let other = scale_with::<f64, 2>(own, &constants, h_j);
            assert_eq!((other.h, other.inverse_h), (h, 1.0 / h));
            assert!((other.gradient - 3.0 / (h * h * h * h)).abs() < 1e-15);
        }
    }
}
