//! Second pair sum: momentum, energy, viscosity, artificial stress, XSPH.
//!
//! Momentum (Patiño et al. Eq 9, Fraser Eqs 6 and 15, with the sign of the viscosity put right):
//! `dv_i/dt = sum_j m_j (sigma_i/rho_i^2 + sigma_j/rho_j^2 + R_ij f^n - Pi_ij I) . grad_i W_ij`, or with
//! `(sigma_i + sigma_j)/(rho_i rho_j)`. Energy is the work of exactly these forces, so that the total is conserved.

use super::kinematics::{PairConstants, PairScale, reduced_distance};
use super::records::force::{C, H, RHO, S, V, WEIGHT, X};
use super::records::{CORRECTED_LEN, Records, extra, force};
use super::search::StoredBlock;
use crate::lanes::{Job, Lanes, PairScalar, splat_record};
use crate::neighbors::{BLOCK, Block};
use sphorge_physics::kernel::Kernel;
use sphorge_physics::viscosity::{ViscosityParameters, viscosity_mu, viscous_pressure};
use sphorge_physics::{Vector, artificial_stress};

/// What the sum does beside the stress divergence. Uniform over the sweep, so every test of it is predicted.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceTerms<T> {
    pub(super) viscosity: ViscosityParameters<T>,
    /// `1 / w(spacing/h)` of the pair factor of the artificial stress, and its exponent.
    pub(super) artificial_stress: Option<(T, u32)>,
    pub(super) balsara: bool,
    pub(super) xsph: bool,
    /// Stress enters as `(s_i + s_j)/(rho_i rho_j)`, else as `s_i/rho_i^2 + s_j/rho_j^2`.
    pub(super) volume_weighted: bool,
    /// Each particle takes the work of its own stress, else half of the pair's.
    pub(super) own_stress_work: bool,
}

impl<T: PairScalar> ForceTerms<T> {
    /// Whether these are the terms most decks ask for, those of both papers; sweeps of them are compiled on their own, without
    /// any of the questions.
    pub(super) fn usual(&self, kernel: Kernel) -> bool {
        kernel == Kernel::CubicSpline
            && self.artificial_stress.is_some()
            && self.xsph
            && !self.balsara
            && self.volume_weighted
            && self.own_stress_work
    }

    /// The same terms; if `USUAL`, in a form the compiler knows.
    #[inline(always)]
    fn known<const USUAL: bool>(self) -> Self {
        if !USUAL {
            return self;
        }
        Self {
            viscosity: self.viscosity,
            artificial_stress: Some(self.artificial_stress.unwrap_or((T::zero(), 1))),
            balsara: false,
            xsph: true,
            volume_weighted: true,
            own_stress_work: true,
        }
    }
}

/// Sums of one particle; acceleration and energy rate still lack the factor `1/rho_i` of the volume-weighted form.
#[derive(Clone, Copy)]
pub(super) struct ForceSum<T> {
    /// Acceleration, m/s².
    pub(super) acceleration: Vector<T>,
    /// Rate of the specific internal energy, W/kg.
    pub(super) energy_rate: T,
    /// `sum_j m_j/rho_mean (v_j - v_i) W_ij`, m/s.
    pub(super) xsph: Vector<T>,
    /// Largest `|mu_ij|` of approaching pairs, m/s.
    pub(super) mu: T,
}

/// `s . x` of a symmetric tensor stored from entry `at` on.
#[inline(always)]
fn symmetric_dot<L: Lanes, const D: usize, const F: usize>(s: &[L; F], at: usize, x: &Vector<L>) -> Vector<L> {
    let o = L::zero();
    if D == 1 {
        [s[at] * x[0], o, o]
    } else if D == 2 {
        [s[at].mul_add(x[0], s[at + 3] * x[1]), s[at + 3].mul_add(x[0], s[at + 1] * x[1]), o]
    } else {
        [
            s[at].mul_add(x[0], s[at + 3].mul_add(x[1], s[at + 5] * x[2])),
            s[at + 3].mul_add(x[0], s[at + 1].mul_add(x[1], s[at + 4] * x[2])),
            s[at + 5].mul_add(x[0], s[at + 4].mul_add(x[1], s[at + 2] * x[2])),
        ]
    }
}

/// Corrected records, the first eight of their nine entries at a time: records of eight are taken apart by shuffles.
#[inline(always)]
fn gather_corrected<L: Lanes>(records: &[[L::Element; CORRECTED_LEN]], indices: &[u32]) -> [L; CORRECTED_LEN] {
    let [a, b, c, d, e, f, g, h]: [L; 8] = L::gather_part(records, indices, 0);
    let [i]: [L; 1] = L::gather_part(records, indices, 8);
    [a, b, c, d, e, f, g, h, i]
}

/// `g . x` of a general tensor.
#[inline(always)]
fn tensor_dot<L: Lanes, const D: usize>(g: &[L; CORRECTED_LEN], x: &Vector<L>) -> Vector<L> {
    let mut t = [L::zero(); 3];
    for a in 0..D {
        for b in 0..D {
            t[a] = g[3 * a + b].mul_add(x[b], t[a]);
        }
    }
    t
}

/// Bundles of a row worked on together.
const BATCH: usize = 8;

/// Geometry of a bundle of pairs, between the passes over a row.
#[derive(Clone, Copy)]
struct Pairs<L> {
    /// `x_i - x_j`, m.
    x: Vector<L>,
    /// `v_i - v_j`, m/s.
    v: Vector<L>,
    /// Weight of the neighbour.
    weight: L,
    /// Smoothing length of the neighbour, m.
    h: L,
    /// Distance squared, m²; then the weighted `F` of `grad_i W_ij = F x_ij`.
    r2: L,
    /// `v_ij . x_ij`, m²/s; then `mu_ij`, m/s.
    v_dot_x: L,
    /// Shape `w` of the kernel.
    w: L,
    /// `W_ij` times the weight.
    kernel: L,
}

impl<L: Lanes> Pairs<L> {
    #[inline(always)]
    fn zero() -> Self {
        let o = L::zero();
        Self { x: [o; 3], v: [o; 3], weight: o, h: o, r2: o, v_dot_x: o, w: o, kernel: o }
    }
}

/// What a row knows of its own particle, in every lane, and of the sum.
#[derive(Clone, Copy)]
struct Own<L: Lanes> {
    record: [L; force::LEN],
    extra: [L; extra::LEN],
    corrected: [L; CORRECTED_LEN],
    scale: PairScale<L>,
    viscosity: ViscosityParameters<L>,
    kernel: Kernel,
}

impl<L: Lanes> Own<L> {
    #[inline(always)]
    fn of<const D: usize, const CORRECTED: bool, const USUAL: bool>(
        records: &Records<L::Element>,
        own: usize,
        constants: &PairConstants<L::Element>,
        terms: &ForceTerms<L::Element>,
    ) -> Self {
        let zero = L::zero();
        Self {
            record: splat_record(&records.force[own]),
            extra: if records.extra.is_empty() { [zero; extra::LEN] } else { splat_record(&records.extra[own]) },
            corrected: if CORRECTED { splat_record(&records.corrected[own]) } else { [zero; CORRECTED_LEN] },
            scale: PairScale::own::<D>(constants, records.force[own][H]),
            viscosity: ViscosityParameters {
                alpha: L::splat(terms.viscosity.alpha),
                beta: L::splat(terms.viscosity.beta),
            },
            kernel: if USUAL { Kernel::CubicSpline } else { constants.kernel },
        }
    }
}

/// First pass over a bundle: who the neighbours are. `stored` gives the distances and where in it those of the bundle start.
#[inline(always)]
fn locate<L: Lanes, const D: usize>(
    own: &Own<L>,
    records: &Records<L::Element>,
    indices: &[u32],
    stored: Option<(&StoredBlock<L::Element>, usize)>,
    constants: &PairConstants<L::Element>,
    pair: &mut Pairs<L>,
) {
    let unit = L::splat(constants.unit);
    let record_j: [L; 8] = L::gather_part(&records.force, indices, 0);
    let mut r2 = L::zero();
    let mut v_dot_x = L::zero();
    for a in 0..D {
        let x = match stored {
            None => L::difference(own.record[X + a], record_j[X + a], unit),
            Some((stored, at)) => stored.bundle(at, a),
        };
        let v = own.record[V + a] - record_j[V + a];
        r2 = x.mul_add(x, r2);
        v_dot_x = v.mul_add(x, v_dot_x);
        pair.x[a] = x;
        pair.v[a] = v;
    }
    pair.r2 = r2;
    pair.v_dot_x = v_dot_x;
    pair.weight = record_j[WEIGHT];
    pair.h = record_j[H];
}

/// Second pass over a bundle: kernel, its gradient, and `mu`, the largest of which so far is `mu_max`.
#[inline(always)]
fn weigh<L: Lanes, const D: usize>(
    own: &Own<L>,
    constants: &PairConstants<L::Element>,
    terms: &ForceTerms<L::Element>,
    pair: &mut Pairs<L>,
    mu_max: L,
) -> L {
    let PairScale { h, inverse_h, gradient } = own.scale.with::<D>(constants, pair.h);
    let (q, inverse_q) = reduced_distance(pair.r2, h, inverse_h);
    let mu = viscosity_mu(pair.v_dot_x, pair.r2, h);
    let weighted = gradient * pair.weight;
    pair.r2 = own.kernel.dw_over_q_by(q, inverse_q) * weighted;
    pair.v_dot_x = mu;
    if terms.xsph || terms.artificial_stress.is_some() {
        let w = own.kernel.w(q);
        pair.w = w;
        pair.kernel = w * (h * h) * weighted;
    }
    // Pairs of a skin count for nothing, nor do they for the time step.
    mu_max.max(L::select_lt(q, L::of(own.kernel.support()), mu.abs(), L::zero()))
}

/// What a row adds up, lane by lane.
#[derive(Clone, Copy)]
struct Sums<L> {
    acceleration: Vector<L>,
    energy_rate: L,
    xsph: Vector<L>,
}

impl<L: Lanes> Sums<L> {
    #[inline(always)]
    fn zero() -> Self {
        Self { acceleration: [L::zero(); 3], energy_rate: L::zero(), xsph: [L::zero(); 3] }
    }

    /// Third pass over a bundle: the forces.
    #[inline(always)]
    fn add<const D: usize, const CORRECTED: bool>(
        &mut self,
        own: &Own<L>,
        records: &Records<L::Element>,
        indices: &[u32],
        terms: &ForceTerms<L::Element>,
        pair: &Pairs<L>,
    ) {
        let half = L::of(0.5);
        let (x, v) = (&pair.x, &pair.v);
        let state_j: [L; 8] = L::gather_part(&records.force, indices, S);
        let density_j = state_j[RHO - S];
        let inverse_density_mean = L::of(2.0) / (own.record[RHO] + density_j);
        let sound_mean = (own.record[C] + state_j[C - S]) * half;
        let mut pi = viscous_pressure(own.viscosity, pair.v_dot_x, sound_mean, inverse_density_mean);
        if terms.volume_weighted {
            // The outer factor of the sum is 1/rho_i and the weight m_j/rho_j.
            pi = pi * own.record[RHO] * density_j;
        }

        // Traction-like vectors: own stress, other stress, artificial terms, each dotted with x_ij.
        let (own_stress, other_stress) = if CORRECTED {
            let corrected_j = gather_corrected(&records.corrected, indices);
            (tensor_dot::<L, D>(&own.corrected, x), tensor_dot::<L, D>(&corrected_j, x))
        } else {
            (symmetric_dot::<L, D, 16>(&own.record, S, x), symmetric_dot::<L, D, 8>(&state_j, 0, x))
        };
        let mut artificial = [L::zero(); 3];
        if terms.balsara || terms.artificial_stress.is_some() {
            let extra_j: [L; extra::LEN] = L::gather(&records.extra, indices);
            if terms.balsara {
                pi = pi * (own.extra[extra::BALSARA] + extra_j[extra::BALSARA]) * half;
            }
            if let Some((inverse_w_spacing, exponent)) = terms.artificial_stress {
                let factor = artificial_stress::pair_factor(pair.w, L::splat(inverse_w_spacing), exponent);
                let mut r = [L::zero(); 6];
                for c in 0..6 {
                    r[c] = own.extra[extra::R + c] + extra_j[extra::R + c];
                }
                artificial = symmetric_dot::<L, D, 6>(&r, 0, x);
                for a in 0..D {
                    artificial[a] = artificial[a] * factor;
                }
            }
        }
        let weighted_f = pair.r2;
        let mut work = L::zero();
        for a in 0..D {
            artificial[a] -= pi * x[a];
            let total = own_stress[a] + other_stress[a] + artificial[a];
            self.acceleration[a] = total.mul_add(weighted_f, self.acceleration[a]);
            let share = if terms.own_stress_work { artificial[a].mul_add(half, own_stress[a]) } else { total * half };
            work = share.mul_add(v[a], work);
        }
        // (v_j - v_i) . (...) . grad W: the sign of v_ij is turned.
        self.energy_rate -= work * weighted_f;
        if terms.xsph {
            let mut weight = pair.kernel * inverse_density_mean;
            if terms.volume_weighted {
                weight = weight * density_j;
            }
            for a in 0..D {
                self.xsph[a] -= v[a] * weight;
            }
        }
    }

    /// All lanes together.
    #[inline(always)]
    fn total(&self) -> ForceSum<L::Element> {
        let ([ax, ay, az], [x, y, z]) = (self.acceleration, self.xsph);
        let [ax, ay, az, x, y, z, energy_rate] = L::sums([ax, ay, az, x, y, z, self.energy_rate]);
        ForceSum { acceleration: [ax, ay, az], energy_rate, xsph: [x, y, z], ..ForceSum::zero() }
    }
}

/// Row `k` of a block, particle `own`.
///
/// A pair's arithmetic is one long chain. In three short passes over the row, many pairs are in the processor at a time.
#[inline(always)]
fn force_row<L: Lanes, const D: usize, const CORRECTED: bool, const USUAL: bool>(
    records: &Records<L::Element>,
    own: usize,
    block: &Block,
    k: usize,
    stored: Option<&StoredBlock<L::Element>>,
    constants: &PairConstants<L::Element>,
    terms: &ForceTerms<L::Element>,
    pairs: &mut [Pairs<L>; BATCH],
) -> ForceSum<L::Element> {
    let terms = &terms.known::<USUAL>();
    let own = Own::<L>::of::<D, CORRECTED, USUAL>(records, own, constants, terms);
    let mut sums = Sums::<L>::zero();
    let mut mu = L::zero();
    let mut at = block.start(k);
    for indices in block.padded_row(k, L::WIDTH).chunks(BATCH * L::WIDTH) {
        let bundles = indices.chunks_exact(L::WIDTH);
        let count = bundles.len();
        for (pair, indices) in pairs.iter_mut().zip(bundles.clone()) {
            locate::<L, D>(&own, records, indices, stored.map(|s| (s, at)), constants, pair);
            at += L::WIDTH;
        }
        for pair in &mut pairs[..count] {
            mu = weigh::<L, D>(&own, constants, terms, pair, mu);
        }
        for (pair, indices) in pairs.iter().zip(bundles) {
            sums.add::<D, CORRECTED>(&own, records, indices, terms, pair);
        }
    }
    ForceSum { mu: mu.largest(), ..sums.total() }
}

impl<T: PairScalar> ForceSum<T> {
    /// Nothing summed.
    #[inline(always)]
    pub(super) fn zero() -> Self {
        Self { acceleration: [T::zero(); 3], energy_rate: T::zero(), xsph: [T::zero(); 3], mu: T::zero() }
    }
}

/// The sums of a block of particles; `USUAL` where the terms are [`ForceTerms::usual`].
pub(super) struct ForceJob<'a, T, const D: usize, const CORRECTED: bool, const USUAL: bool> {
    pub(super) records: &'a Records<T>,
    /// First particle of the block.
    pub(super) first: usize,
    pub(super) block: &'a Block,
    /// Distances to take in place of those of the records.
    pub(super) stored: Option<&'a StoredBlock<T>>,
    pub(super) constants: &'a PairConstants<T>,
    pub(super) terms: &'a ForceTerms<T>,
    pub(super) sums: &'a mut [ForceSum<T>; BLOCK],
}

impl<T: PairScalar, const D: usize, const CORRECTED: bool, const USUAL: bool> Job<T>
    for ForceJob<'_, T, D, CORRECTED, USUAL>
{
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let mut pairs = [Pairs::zero(); BATCH];
        for k in 0..self.block.len() {
            self.sums[k] = force_row::<L, D, CORRECTED, USUAL>(
                self.records,
                self.first + k,
                self.block,
                k,
                self.stored,
                self.constants,
                self.terms,
                &mut pairs,
            );
        }
    }
}
