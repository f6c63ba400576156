//! Second pair sum: momentum, energy, viscosity, artificial stress, XSPH.
//!
//! The formulas are in [`sphorge_physics::pair`]; this file gathers the neighbours and adds up the sums of a row.

use super::kinematics::{PairConstants, own_scale, scale_with};
use super::records::force::{C, H, RHO, S, V, WEIGHT, X};
use super::records::{CORRECTED_LEN, Records, extra, force};
use super::stored::StoredBlock;
use crate::lanes::{Job, Lanes, PairScalar, splat_record};
use crate::neighbors::{BLOCK, Block};
use sphorge_physics::kernel::{Kernel, PairScale};
use sphorge_physics::pair::{
    EnergySplit, ForceSums, PairForce, PairForm, closing_power, corrected_stress_vector, inverse_density_mean, mean,
    scaled_pressure, share_of_power, stress_vector,
};
use sphorge_physics::viscosity::{ViscosityParameters, switched, viscosity_mu, viscous_pressure};
use sphorge_physics::xsph::{add_xsph, xsph_weight};
use sphorge_physics::{SymmetricTensor, Tensor, Vector, artificial_stress};

/// Terms of the sum besides the stress divergence. They are the same for all pairs, so every branch on them is well
/// predicted.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceTerms<T> {
    /// Viscosity of pairs; none if it is a pressure of the particle.
    pub(super) viscosity: Option<ViscosityParameters<T>>,
    /// Exponent of the pair factor of the artificial stress.
    pub(super) artificial_stress: Option<u32>,
    pub(super) balsara: bool,
    pub(super) xsph: bool,
    pub(super) pair_form: PairForm,
    pub(super) energy_split: EnergySplit,
}

impl<T: PairScalar> ForceTerms<T> {
    /// Whether these are the terms most decks use, those of both papers. Pair loops with these terms are compiled
    /// separately, without branches on them.
    pub(super) fn are_default(&self, kernel: Kernel) -> bool {
        kernel == Kernel::CubicSpline
            && self.viscosity.is_some()
            && self.artificial_stress.is_some()
            && self.xsph
            && !self.balsara
            && self.pair_form == PairForm::VolumeWeighted
            && self.energy_split == EnergySplit::OwnStress
    }

    /// The same terms; if `DEFAULT`, in a form the compiler knows.
    #[inline(always)]
    fn known<const DEFAULT: bool>(self) -> Self {
        if !DEFAULT {
            return self;
        }
        Self {
            viscosity: Some(self.viscosity.unwrap_or_default()),
            artificial_stress: Some(self.artificial_stress.unwrap_or(1)),
            balsara: false,
            xsph: true,
            pair_form: PairForm::VolumeWeighted,
            energy_split: EnergySplit::OwnStress,
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
    /// The part of it due to the viscosity of pairs.
    pub(super) viscous_power: T,
    /// The part of it due to the artificial stress.
    pub(super) artificial_power: T,
    /// `sum_j m_j/rho_mean (v_j - v_i) W_ij`, m/s.
    pub(super) xsph: Vector<T>,
    /// Largest `|mu_ij|` of approaching pairs, m/s.
    pub(super) mu: T,
}

/// The symmetric tensor a record holds from entry `at` on.
#[inline(always)]
fn symmetric<L: Lanes, const F: usize>(record: &[L; F], at: usize) -> SymmetricTensor<L> {
    let [xx, yy, zz, xy, yz, xz] =
        [record[at], record[at + 1], record[at + 2], record[at + 3], record[at + 4], record[at + 5]];
    SymmetricTensor { xx, yy, zz, xy, yz, xz }
}

/// Corrected records, the first eight of their nine entries at a time: records of eight entries are transposed by
/// shuffles.
#[inline(always)]
pub(super) fn gather_corrected<L: Lanes>(records: &[[L::Element; CORRECTED_LEN]], indices: &[u32]) -> Tensor<L> {
    let [a, b, c, d, e, f, g, h]: [L; 8] = L::gather_part(records, indices, 0);
    let [i]: [L; 1] = L::gather_part(records, indices, 8);
    [[a, b, c], [d, e, f], [g, h, i]]
}

/// A corrected record in every lane.
#[inline(always)]
pub(super) fn splat_corrected<L: Lanes>(record: &[L::Element; CORRECTED_LEN]) -> Tensor<L> {
    let [a, b, c, d, e, f, g, h, i] = splat_record(record);
    [[a, b, c], [d, e, f], [g, h, i]]
}

/// SIMD vectors of a row that are processed together.
const BATCH: usize = 8;

/// Geometry of a SIMD vector of pairs, between the passes over a row.
#[derive(Clone, Copy)]
struct Pairs<L> {
    /// `x_i - x_j`, m.
    x: Vector<L>,
    /// `v_i - v_j`, m/s.
    v: Vector<L>,
    /// Weight of the neighbour.
    weight: L,
    /// Smoothing length of the neighbour, m; then the power of a unit of `Pi_ij`, [`closing_power`].
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

/// Data of the particle of a row, in every lane, and of the sum.
#[derive(Clone, Copy)]
struct Own<L: Lanes> {
    record: [L; force::LEN],
    extra: [L; extra::LEN],
    corrected: Tensor<L>,
    scale: PairScale<L>,
    viscosity: Option<ViscosityParameters<L>>,
    kernel: Kernel,
}

impl<L: Lanes> Own<L> {
    #[inline(always)]
    fn of<const D: usize, const CORRECTED: bool, const DEFAULT: bool>(
        records: &Records<L::Element>,
        own: usize,
        constants: &PairConstants<L::Element>,
        terms: &ForceTerms<L::Element>,
    ) -> Self {
        let zero = L::zero();
        Self {
            record: splat_record(&records.force[own]),
            extra: if records.extra.is_empty() { [zero; extra::LEN] } else { splat_record(&records.extra[own]) },
            corrected: if CORRECTED { splat_corrected(&records.corrected[own]) } else { [[zero; 3]; 3] },
            scale: own_scale::<L, D>(constants, records.force[own][H]),
            viscosity: terms
                .viscosity
                .map(|of| ViscosityParameters { alpha: L::splat(of.alpha), beta: L::splat(of.beta) }),
            kernel: if DEFAULT { Kernel::CubicSpline } else { constants.kernel },
        }
    }
}

/// First pass over a SIMD vector of pairs: gathers the neighbours. `stored` has the distances and the index at which
/// those of the vector start.
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
            Some((stored, at)) => stored.vector(at, a),
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

/// Second pass over a SIMD vector of pairs: kernel, its gradient, and `mu`, the largest of which so far is `mu_max`.
#[inline(always)]
fn weigh<L: Lanes, const D: usize>(
    own: &Own<L>,
    constants: &PairConstants<L::Element>,
    terms: &ForceTerms<L::Element>,
    pair: &mut Pairs<L>,
    mu_max: L,
) -> L {
    let scale = scale_with::<L, D>(own.scale, constants, pair.h);
    let (q, inverse_q) = scale.reduced_distance(pair.r2);
    let (r2, mut mu) = (pair.r2, L::zero());
    let weighted = scale.weighted(pair.weight);
    pair.r2 = weighted.f(own.kernel.dw_over_q_by(q, inverse_q));
    if own.viscosity.is_some() {
        mu = viscosity_mu(pair.v_dot_x, r2, scale.h);
        pair.h = closing_power(pair.v_dot_x, pair.r2);
        pair.v_dot_x = mu;
    }
    if terms.xsph || terms.artificial_stress.is_some() {
        let w = own.kernel.w(q);
        pair.w = w;
        pair.kernel = weighted.value(w);
    }
    // Pairs in the skin do not contribute, nor do they limit the time step.
    mu_max.max(L::select_lt(q, L::of(own.kernel.support()), mu.abs(), L::zero()))
}

/// Sums of a row, lane by lane.
#[derive(Clone, Copy)]
struct Sums<L> {
    forces: ForceSums<L>,
    xsph: Vector<L>,
}

impl<L: Lanes> Sums<L> {
    #[inline(always)]
    fn zero() -> Self {
        Self { forces: ForceSums::zero(), xsph: [L::zero(); 3] }
    }

    /// Third pass over a SIMD vector of pairs: the forces.
    #[inline(always)]
    fn add<const D: usize, const CORRECTED: bool>(
        &mut self,
        own: &Own<L>,
        records: &Records<L::Element>,
        indices: &[u32],
        terms: &ForceTerms<L::Element>,
        pair: &Pairs<L>,
    ) {
        let x = &pair.x;
        let state_j: [L; 8] = L::gather_part(&records.force, indices, S);
        let density_j = state_j[RHO - S];
        let inverse_density = inverse_density_mean(own.record[RHO], density_j);
        let mut pi = L::zero();
        if let Some(viscosity) = own.viscosity {
            let sound_speed = mean(own.record[C], state_j[C - S]);
            pi = viscous_pressure(viscosity, pair.v_dot_x, sound_speed, inverse_density);
            pi = scaled_pressure(terms.pair_form, pi, own.record[RHO], density_j);
        }
        let (own_stress, other_stress) = if CORRECTED {
            let corrected_j = gather_corrected(&records.corrected, indices);
            (corrected_stress_vector::<L, D>(&own.corrected, x), corrected_stress_vector::<L, D>(&corrected_j, x))
        } else {
            (stress_vector::<L, D>(&symmetric(&own.record, S), x), stress_vector::<L, D>(&symmetric(&state_j, 0), x))
        };
        let mut artificial_stress = [L::zero(); 3];
        if terms.balsara || terms.artificial_stress.is_some() || terms.xsph {
            let extra_j: [L; extra::LEN] = L::gather(&records.extra, indices);
            if terms.balsara {
                pi = switched(pi, own.extra[extra::BALSARA], extra_j[extra::BALSARA]);
            }
            if let Some(exponent) = terms.artificial_stress {
                let factor = artificial_stress::pair_factor(pair.w, exponent);
                let (r_i, r_j) = (symmetric(&own.extra, extra::R), symmetric(&extra_j, extra::R));
                artificial_stress = artificial_stress::pair_vector::<L, D>(r_i, r_j, factor, x);
            }
            if terms.xsph {
                let weight = xsph_weight(pair.kernel, extra_j[extra::MASS_PER_WEIGHT], inverse_density);
                add_xsph::<L, D>(&mut self.xsph, &pair.v, weight);
            }
        }
        let (weighted_f, closing_power) = (pair.r2, pair.h);
        let force =
            PairForce { x: *x, v: pair.v, own_stress, other_stress, artificial_stress, pi, weighted_f, closing_power };
        self.forces.add::<D>(terms.energy_split, &force);
    }

    /// All lanes together.
    #[inline(always)]
    fn total(&self, terms: &ForceTerms<L::Element>) -> ForceSum<L::Element> {
        let ([ax, ay, az], [x, y, z]) = (self.forces.acceleration, self.xsph);
        let (rate, viscous) = (self.forces.energy_rate(), share_of_power(self.forces.viscous_power));
        let [ax, ay, az, x, y, z, energy_rate, viscous_power] = L::sums([ax, ay, az, x, y, z, rate, viscous]);
        let zero = ForceSum::zero();
        let repels = terms.artificial_stress.is_some();
        let artificial_power =
            if repels { share_of_power(self.forces.repulsive_power).sum() } else { zero.artificial_power };
        ForceSum { acceleration: [ax, ay, az], energy_rate, viscous_power, artificial_power, xsph: [x, y, z], ..zero }
    }
}

/// Row `k` of a block, particle `own`.
///
/// The arithmetic of a pair is one long dependency chain. With three short passes over the row, the processor works on
/// many pairs at a time.
#[inline(always)]
fn force_row<L: Lanes, const D: usize, const CORRECTED: bool, const DEFAULT: bool>(
    records: &Records<L::Element>,
    own: usize,
    block: &Block,
    k: usize,
    stored: Option<&StoredBlock<L::Element>>,
    constants: &PairConstants<L::Element>,
    terms: &ForceTerms<L::Element>,
    pairs: &mut [Pairs<L>; BATCH],
) -> ForceSum<L::Element> {
    let terms = &terms.known::<DEFAULT>();
    let own = Own::<L>::of::<D, CORRECTED, DEFAULT>(records, own, constants, terms);
    let mut sums = Sums::<L>::zero();
    let mut mu = L::zero();
    let mut at = block.start(k);
    for indices in block.padded_row(k, L::WIDTH).chunks(BATCH * L::WIDTH) {
        let vectors = indices.chunks_exact(L::WIDTH);
        let count = vectors.len();
        for (pair, indices) in pairs.iter_mut().zip(vectors.clone()) {
            locate::<L, D>(&own, records, indices, stored.map(|s| (s, at)), constants, pair);
            at += L::WIDTH;
        }
        for pair in &mut pairs[..count] {
            mu = weigh::<L, D>(&own, constants, terms, pair, mu);
        }
        for (pair, indices) in pairs.iter().zip(vectors) {
            sums.add::<D, CORRECTED>(&own, records, indices, terms, pair);
        }
    }
    ForceSum { mu: mu.largest(), ..sums.total(terms) }
}

impl<T: PairScalar> ForceSum<T> {
    /// Nothing summed.
    #[inline(always)]
    pub(super) fn zero() -> Self {
        let o = T::zero();
        Self { acceleration: [o; 3], energy_rate: o, viscous_power: o, artificial_power: o, xsph: [o; 3], mu: o }
    }
}

/// The sums of a block of particles; `DEFAULT` if the terms are [`ForceTerms::are_default`].
pub(super) struct ForceJob<'a, T, const D: usize, const CORRECTED: bool, const DEFAULT: bool> {
    pub(super) records: &'a Records<T>,
    /// First particle of the block.
    pub(super) first: usize,
    pub(super) block: &'a Block,
    /// Distances to use instead of those of the records.
    pub(super) stored: Option<&'a StoredBlock<T>>,
    pub(super) constants: &'a PairConstants<T>,
    pub(super) terms: &'a ForceTerms<T>,
    pub(super) sums: &'a mut [ForceSum<T>; BLOCK],
}

impl<T: PairScalar, const D: usize, const CORRECTED: bool, const DEFAULT: bool> Job<T>
    for ForceJob<'_, T, D, CORRECTED, DEFAULT>
{
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let mut pairs = [Pairs::zero(); BATCH];
        for k in 0..self.block.len() {
            self.sums[k] = force_row::<L, D, CORRECTED, DEFAULT>(
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
