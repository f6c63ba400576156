//! Hourglass control of the total Lagrangian form.
//!
//! A deformation gradient sees only the linear part of the motion around a particle; what is left over costs no energy and
//! can grow without bound. Ganzenmüller (2015, Eq 21 to 24) resists it with springs: where the linear motion puts neighbour `j` of
//! `i` `delta_i = (F_i X_ij - x_ij) . x_ij/|x_ij|` farther out than it is,
//!
//! `f_ij = V_i V_j W(X_ij)/|X_ij| s_ij x_ij/|x_ij|`,  `s_ij = alpha E (delta_i + delta_j)/(2 |X_ij|)`
//!
//! pushes `i` there, where `x_ij = x_i - x_j`. The work goes to the internal energy of both, half each.
//!
//! `s_ij` is a stress, and a metal bears no more than its flow stress `Y`. Springs as stiff as the metal at rest would hold up its
//! flow, in which the motion is linear nowhere; springs weak enough for the flow let elastic bodies rattle. So they yield too:
//!
//! `s_ij -> s_ij/(1 + |s_ij|/(Y/2))`
//!
//! has the stiffness `alpha E` of Ganzenmüller for small errors, where elastic bodies stay, and never exceeds half the flow stress;
//! its tangent `alpha E/(1 + 2 |s_ij|/Y)^2` falls with that of the metal. Stiffness and flow stress are the means of the two
//! particles, so momentum is conserved.

use super::CpuEngine;
use super::kinematics::{PairConstants, PairScale, reduced_distance};
use super::records::kinematic::{self, H, V, WEIGHT, X};
use super::sweeps::dispatch_dimension;
use crate::lanes::{Job, Lanes, PairScalar, run, splat_record};
use crate::model::Search;
use crate::neighbors::{BLOCK, Block};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::{Dimension, Real, Vector};

/// Entries of an hourglass record: position as it is, deformation gradient, stiffness `alpha E`, largest stress.
mod entry {
    pub(super) const X: usize = 0;
    pub(super) const F: usize = 3;
    pub(super) const STIFFNESS: usize = 12;
    pub(super) const BOUND: usize = 13;
    pub(super) const LEN: usize = 16;
}

/// What the sum reads of a particle beside its kinematic record.
pub(super) type HourglassRecord<T> = [T; entry::LEN];

/// Share of the flow stress that springs bear at most.
const SHARE: f64 = 0.5;

/// What they bear of a metal without strength, such as a melt, as a share of Young's modulus.
const LEAST: f64 = 1e-4;

/// Stress of a spring, Pa: `stiffness` (Pa) times its strain where that is small, never beyond `bound` (Pa, positive).
#[inline(always)]
fn spring_stress<R: Real>(stiffness: R, strain: R, bound: R) -> R {
    let stress = stiffness * strain;
    stress / (R::one() + stress.max(-stress) / bound)
}

/// Stiffness and bound of the springs of a particle, Pa.
fn spring(strength: f64, young: f64, yield_stress: f64) -> [f64; 2] {
    // A fluid has no springs; its bound only must not be zero.
    [strength * young, (SHARE * yield_stress).max(LEAST * young).max(1.0)]
}

/// Sums of one particle, still without the factor `V_i / m_i`.
#[derive(Clone, Copy)]
struct HourglassSum<T> {
    acceleration: Vector<T>,
    energy_rate: T,
}

struct HourglassJob<'a, T, const D: usize> {
    kinematic: &'a [[T; kinematic::LEN]],
    records: &'a [HourglassRecord<T>],
    first: usize,
    block: &'a Block,
    constants: &'a PairConstants<T>,
    sums: &'a mut [HourglassSum<T>; BLOCK],
}

impl<T: PairScalar, const D: usize> Job<T> for HourglassJob<'_, T, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let mut springs = [Springs::zero(); BATCH];
        for k in 0..self.block.len() {
            self.sums[k] = hourglass_row::<L, D>(&self, k, &mut springs);
        }
    }
}

/// Bundles of a row worked on together.
const BATCH: usize = 8;

/// A bundle of springs, between the passes over a row.
#[derive(Clone, Copy)]
struct Springs<L> {
    /// `x_i - x_j`, m.
    x: Vector<L>,
    /// `|x_ij|^2` and `|X_ij|^2`, m².
    r2: L,
    initial2: L,
    /// `((F_i + F_j) X_ij - 2 x_ij) . x_ij`, m².
    error: L,
    /// `v_ij . x_ij`, m²/s.
    v_dot_x: L,
    /// Smoothing length of the neighbour, m, and its volume.
    h: L,
    volume: L,
    /// Stiffness and bound of the neighbour, Pa.
    stiffness: L,
    bound: L,
}

impl<L: Lanes> Springs<L> {
    #[inline(always)]
    fn zero() -> Self {
        let o = L::zero();
        Self { x: [o; 3], r2: o, initial2: o, error: o, v_dot_x: o, h: o, volume: o, stiffness: o, bound: o }
    }
}

/// Row `k` of a block, in two short passes, so that many pairs are in the processor at a time.
#[inline(always)]
fn hourglass_row<L: Lanes, const D: usize>(
    job: &HourglassJob<'_, L::Element, D>,
    k: usize,
    springs: &mut [Springs<L>; BATCH],
) -> HourglassSum<L::Element> {
    let own = job.first + k;
    let initial_i: [L; kinematic::LEN] = splat_record(&job.kinematic[own]);
    let record_i: [L; entry::LEN] = splat_record(&job.records[own]);
    let own_scale = PairScale::<L>::own::<D>(job.constants, job.kinematic[own][H]);
    let unit = L::splat(job.constants.unit);
    let kernel = job.constants.kernel;
    let half = L::of(0.5);
    let mut acceleration = [L::zero(); 3];
    let mut energy_rate = L::zero();
    for indices in job.block.padded_row(k, L::WIDTH).chunks(BATCH * L::WIDTH) {
        for (spring, indices) in springs.iter_mut().zip(indices.chunks_exact(L::WIDTH)) {
            let initial_j = L::gather(job.kinematic, indices);
            let record_j = L::gather(job.records, indices);
            let mut initial = [L::zero(); 3];
            let [mut initial2, mut r2, mut v_dot_x, mut error] = [L::zero(); 4];
            for a in 0..D {
                initial[a] = L::difference(initial_i[X + a], initial_j[X + a], unit);
                initial2 = initial[a].mul_add(initial[a], initial2);
            }
            for a in 0..D {
                let x = L::difference(record_i[entry::X + a], record_j[entry::X + a], unit);
                let mut linear = x * L::of(-2.0);
                for b in 0..D {
                    linear =
                        (record_i[entry::F + 3 * a + b] + record_j[entry::F + 3 * a + b]).mul_add(initial[b], linear);
                }
                r2 = x.mul_add(x, r2);
                error = linear.mul_add(x, error);
                v_dot_x = x.mul_add(initial_i[V + a] - initial_j[V + a], v_dot_x);
                spring.x[a] = x;
            }
            (spring.r2, spring.initial2, spring.error, spring.v_dot_x) = (r2, initial2, error, v_dot_x);
            (spring.h, spring.volume) = (initial_j[H], initial_j[WEIGHT]);
            (spring.stiffness, spring.bound) = (record_j[entry::STIFFNESS], record_j[entry::BOUND]);
        }
        for spring in &springs[..indices.len() / L::WIDTH] {
            let PairScale { h, inverse_h, gradient } = own_scale.with::<D>(job.constants, spring.h);
            let (q, _) = reduced_distance(spring.initial2, h, inverse_h);
            let w = kernel.w(q) * (h * h) * gradient;
            // Padding is at no distance and has no error: only the division must not fail.
            let size = h * h * L::of(1e-6);
            let inverse = (spring.initial2.max(size) * spring.r2.max(size)).inverse_sqrt();
            let stiffness = (record_i[entry::STIFFNESS] + spring.stiffness) * half;
            let bound = (record_i[entry::BOUND] + spring.bound) * half;
            let strength = w * spring.volume * spring_stress(stiffness, spring.error * inverse * half, bound) * inverse;
            for a in 0..D {
                acceleration[a] = strength.mul_add(spring.x[a], acceleration[a]);
            }
            energy_rate -= half * strength * spring.v_dot_x;
        }
    }
    let mut sum = HourglassSum { acceleration: [L::Element::zero(); 3], energy_rate: energy_rate.sum() };
    for a in 0..D {
        sum.acceleration[a] = acceleration[a].sum();
    }
    sum
}

impl<T: PairScalar> CpuEngine<T> {
    /// Adds the hourglass forces to acceleration and energy rate.
    pub(super) fn resist_hourglass(&mut self) {
        let (Search::TotalLagrangian(total), Some(reference)) = (self.model.search, &self.reference) else { return };
        if total.hourglass == 0.0 {
            return;
        }
        let count = self.particles.len();
        let frame = self.records.frame;
        let (evaluated, position) = (&self.work.evaluated_velocity, &self.particles.position);
        self.records.kinematic[..count].par_iter_mut().zip(evaluated).for_each(|(record, v)| {
            for a in 0..3 {
                record[V + a] = T::of(v[a]);
            }
        });
        self.halo.exchange_kinematics(count, |i| reference.position[i], &mut self.records);

        let mut records = std::mem::take(&mut self.records.hourglass);
        records.resize(count + self.halo.ghosts.len(), [T::zero(); entry::LEN]);
        let deformation = &reference.deformation;
        let (material, yield_stress) = (&self.particles.material, &self.particles.yield_stress);
        let set = |record: &mut HourglassRecord<T>, i: usize| {
            let young = reference.young_modulus[material[i] as usize];
            [record[entry::STIFFNESS], record[entry::BOUND]] =
                spring(total.hourglass, young, yield_stress[i]).map(T::of);
        };
        records[..count].par_iter_mut().enumerate().for_each(|(i, record)| {
            record[..3].copy_from_slice(&frame.encode::<T>(&position[i]));
            for c in 0..9 {
                record[entry::F + c] = T::of(deformation[i][c / 3][c % 3]);
            }
            set(record, i);
        });
        for (k, ghost) in self.halo.ghosts.iter().enumerate() {
            let source = ghost.source as usize;
            let record = &mut records[count + k];
            record[..3].copy_from_slice(&frame.encode::<T>(&ghost.position(&position[source])));
            for c in 0..9 {
                record[entry::F + c] = T::of(deformation[source][c / 3][c % 3] * ghost.sign[c / 3] * ghost.sign[c % 3]);
            }
            set(record, source);
        }

        let (list, instructions, constants) = (&self.lists.list, self.instructions, &self.constants);
        let (kinematic, model) = (&self.records.kinematic, &self.model);
        let Particles { acceleration, energy_rate, mass, .. } = &mut self.particles;
        let mass = &*mass;
        let records_of = &records;
        dispatch_dimension!(super::dimension(model), |D| {
            (acceleration.par_chunks_mut(BLOCK), energy_rate.par_chunks_mut(BLOCK))
                .into_par_iter()
                .enumerate()
                .for_each(|(b, (acceleration, energy_rate))| {
                    let nothing = HourglassSum { acceleration: [T::zero(); 3], energy_rate: T::zero() };
                    let mut sums = [nothing; BLOCK];
                    let job = HourglassJob::<T, D> {
                        kinematic,
                        records: records_of,
                        first: b * BLOCK,
                        block: &list.blocks()[b],
                        constants,
                        sums: &mut sums,
                    };
                    run(instructions, job);
                    for k in 0..acceleration.len() {
                        let i = b * BLOCK + k;
                        let factor = reference.volume[i] / mass[i];
                        for a in 0..3 {
                            acceleration[k][a] += factor * sums[k].acceleration[a].to_f64();
                        }
                        energy_rate[k] += factor * sums[k].energy_rate.to_f64();
                    }
                });
        });
        self.records.hourglass = records;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn springs_are_those_of_the_metal_at_rest_and_yield_with_it() {
        // E 200 GPa, strength 10, flow stress 800 MPa: 400 MPa at most.
        let [stiffness, bound] = spring(10.0, 200e9, 800e6);
        assert_eq!((stiffness, bound), (2e12, 400e6));
        let stress = |strain: f64| spring_stress(stiffness, strain, bound);
        assert!((stress(1e-8) / 2e4 - 1.0).abs() < 1e-4);
        // As much again as the bound: half of it. Ten times: 10/11.
        assert!((stress(2e-4) / 200e6 - 1.0).abs() < 1e-12);
        assert!((stress(-2e-3) / -363.636_363_6e6 - 1.0).abs() < 1e-9);
        // The tangent, k/(1 + r)^2: a quarter at the bound, 1/121 at ten times.
        let tangent = |strain: f64| (stress(strain + 1e-9) - stress(strain - 1e-9)) / 2e-9;
        assert!((tangent(2e-4) / 5e11 - 1.0).abs() < 1e-4 && (tangent(2e-3) / (2e12 / 121.0) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn springs_of_what_never_yields_are_linear_and_a_melt_keeps_a_little() {
        let [stiffness, bound] = spring(10.0, 2e6, f64::INFINITY);
        assert_eq!(spring_stress(stiffness, 0.3, bound), 6e6);
        assert_eq!(spring(10.0, 200e9, 0.0)[1], 20e6);
        let [stiffness, bound] = spring(10.0, 0.0, 0.0);
        assert_eq!(spring_stress(stiffness, 0.3, bound), 0.0);
    }
}
