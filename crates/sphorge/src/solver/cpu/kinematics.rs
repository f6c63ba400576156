//! First pair sum: velocity gradient, and the moment matrix of the gradient correction.
//!
//! `L_i = sum_j w_j (v_j - v_i) ⊗ grad_i W_ij` with `w_j = m_j/rho_j` or `m_j/rho_i` (Patiño et al. Eqs 22, 23 give its
//! symmetric and skew parts; Eq 8 its trace).

use super::records::kinematic::{H, LEN, V, WEIGHT, X};
use super::search::StoredBlock;
use crate::lanes::{Job, Lanes, PairScalar, splat_record};
use crate::neighbors::{BLOCK, Block};
use sphorge_physics::kernel::Kernel;
use sphorge_physics::{Real, Scalar, Tensor};

/// Constants of a pair sum.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairConstants<T> {
    /// Size of a coordinate unit, m.
    pub(super) unit: T,
    /// The kernel: chosen by a branch within the sweep that always goes the same way, which costs nothing beside the gathers.
    pub(super) kernel: Kernel,
    /// Normalisation `sigma_d` of the kernel.
    pub(super) sigma: T,
    /// The smoothing length all particles share, if they do.
    pub(super) uniform_h: Option<T>,
}

/// Inverse smoothing length of a pair and the factor of its kernel gradient, `sigma / h^(d+2)`.
#[inline(always)]
pub(super) fn pair_scale<L: Lanes, const D: usize>(constants: &PairConstants<L::Element>, h_i: L, h_j: L) -> (L, L, L) {
    let (h, inverse_h) = match constants.uniform_h {
        Some(h) => (L::splat(h), L::splat(L::Element::one() / h)),
        None => {
            let h = (h_i + h_j) * L::of(0.5);
            (h, L::one() / h)
        }
    };
    (h, inverse_h, L::splat(constants.sigma) * inverse_h.powu(D as u32 + 2))
}

/// `q = r/h` and its inverse, both finite at `r = 0`.
#[inline(always)]
pub(super) fn reduced_distance<L: Lanes>(r2: L, h: L, inverse_h: L) -> (L, L) {
    let inverse_r = r2.max(h * h * L::of(1e-12)).inverse_sqrt();
    (r2 * inverse_r * inverse_h, inverse_r * h)
}

/// Sums of one particle.
#[derive(Clone, Copy)]
pub(super) struct GradientSum<T> {
    /// `sum_j w_j (v_j - v_i) ⊗ grad_i W_ij`, row: velocity component.
    pub(super) gradient: Tensor<T>,
    /// `sum_j w_j (x_j - x_i) ⊗ grad_i W_ij`; zero unless asked for.
    pub(super) moment: Tensor<T>,
    /// Neighbours inside the kernel support.
    pub(super) inside: u32,
}

/// Row `k` of a block, particle `own`.
#[inline(always)]
fn gradient_row<L: Lanes, const D: usize, const CORRECTED: bool>(
    records: &[[L::Element; LEN]],
    own: usize,
    block: &Block,
    k: usize,
    stored: Option<&StoredBlock<L::Element>>,
    constants: &PairConstants<L::Element>,
) -> GradientSum<L::Element> {
    let record_i: [L; LEN] = splat_record(&records[own]);
    let unit = L::splat(constants.unit);
    let support = L::of(constants.kernel.support());
    let mut gradient = [[L::zero(); 3]; 3];
    let mut moment = [[L::zero(); 3]; 3];
    let mut inside = L::zero();
    let row = block.padded_row(k, L::WIDTH);
    for (bundle, indices) in row.chunks_exact(L::WIDTH).enumerate() {
        let record_j = L::gather(records, indices);
        let mut x = [L::zero(); 3];
        let mut r2 = L::zero();
        for a in 0..D {
            x[a] = match stored {
                None => L::difference(record_i[X + a], record_j[X + a], unit),
                Some(stored) => stored.bundle(block.start(k) + bundle * L::WIDTH, a),
            };
            r2 = x[a].mul_add(x[a], r2);
        }
        let (h, inverse_h, scale) = pair_scale::<L, D>(constants, record_i[H], record_j[H]);
        let (q, inverse_q) = reduced_distance(r2, h, inverse_h);
        // grad_i W_ij = F x_ij, times the weight of the neighbour.
        let weighted_f = constants.kernel.dw_over_q_by(q, inverse_q) * scale * record_j[WEIGHT];
        inside += L::select_lt(q, support, L::one(), L::zero());
        for a in 0..D {
            let v = (record_j[V + a] - record_i[V + a]) * weighted_f;
            let y = x[a] * weighted_f;
            for b in 0..D {
                gradient[a][b] = v.mul_add(x[b], gradient[a][b]);
                if CORRECTED {
                    moment[a][b] -= y * x[b];
                }
            }
        }
    }
    // Padding is the particle itself, at distance zero: inside the support.
    let padding = row.len() - block.row(k).len();
    let mut sum = GradientSum::zero();
    for a in 0..D {
        for b in 0..D {
            sum.gradient[a][b] = gradient[a][b].sum();
            if CORRECTED {
                sum.moment[a][b] = moment[a][b].sum();
            }
        }
    }
    sum.inside = inside.sum().to_f64() as u32 - padding as u32;
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
    /// Distances to take in place of those of the records.
    pub(super) stored: Option<&'a StoredBlock<T>>,
    pub(super) constants: &'a PairConstants<T>,
    pub(super) sums: &'a mut [GradientSum<T>; BLOCK],
}

impl<T: PairScalar, const D: usize, const CORRECTED: bool> Job<T> for GradientJob<'_, T, D, CORRECTED> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        for k in 0..self.block.len() {
            self.sums[k] = gradient_row::<L, D, CORRECTED>(
                self.records,
                self.first + k,
                self.block,
                k,
                self.stored,
                self.constants,
            );
        }
    }
}
