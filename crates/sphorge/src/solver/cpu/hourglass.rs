//! Hourglass control of the total Lagrangian form.
//!
//! A deformation gradient sees only the linear part of the motion around a particle; what is left over costs no energy and
//! can grow without bound. Ganzenmüller (2015, Eq 21 to 24) resists it with springs: where the linear motion puts neighbour `j` of
//! `i` `delta_i = (F_i X_ij - x_ij) . x_ij/|x_ij|` farther out than it is,
//!
//! `f_ij = alpha/2 E V_i V_j W(X_ij)/|X_ij|^2 (delta_i + delta_j) x_ij/|x_ij|`
//!
//! pushes `i` there, where `x_ij = x_i - x_j`. The work goes to the internal energy of both, half each.

use super::CpuEngine;
use super::kinematics::PairConstants;
use super::records::kinematic::{self, H, V, WEIGHT, X};
use super::sweeps::dispatch_dimension;
use crate::lanes::{Job, Lanes, PairScalar, run, splat_record};
use crate::model::Search;
use crate::neighbors::{BLOCK, Block};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::{Dimension, Real, Vector};

/// Entries of an hourglass record: position as it is, deformation gradient.
mod entry {
    pub(super) const X: usize = 0;
    pub(super) const F: usize = 3;
    pub(super) const LEN: usize = 16;
}

/// What the sum reads of a particle beside its kinematic record.
pub(super) type HourglassRecord<T> = [T; entry::LEN];

/// Sums of one particle, still without the factor `alpha E V_i / m_i`.
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
        for k in 0..self.block.len() {
            self.sums[k] = hourglass_row::<L, D>(&self, k);
        }
    }
}

#[inline(always)]
fn hourglass_row<L: Lanes, const D: usize>(
    job: &HourglassJob<'_, L::Element, D>,
    k: usize,
) -> HourglassSum<L::Element> {
    let own = job.first + k;
    let initial_i: [L; kinematic::LEN] = splat_record(&job.kinematic[own]);
    let record_i: [L; entry::LEN] = splat_record(&job.records[own]);
    let unit = L::splat(job.constants.unit);
    let kernel = job.constants.kernel;
    let mut acceleration = [L::zero(); 3];
    let mut energy_rate = L::zero();
    for indices in job.block.padded_row(k, L::WIDTH).chunks_exact(L::WIDTH) {
        let initial_j = L::gather(job.kinematic, indices);
        let record_j = L::gather(job.records, indices);
        let mut initial = [L::zero(); 3];
        let mut x = [L::zero(); 3];
        let mut initial2 = L::zero();
        let mut r2 = L::zero();
        for a in 0..D {
            initial[a] = L::difference(initial_i[X + a], initial_j[X + a], unit);
            x[a] = L::difference(record_i[entry::X + a], record_j[entry::X + a], unit);
            initial2 = initial[a].mul_add(initial[a], initial2);
            r2 = x[a].mul_add(x[a], r2);
        }
        let h = (initial_i[H] + initial_j[H]) * L::of(0.5);
        let inverse_h = L::one() / h;
        let w = kernel.w(initial2.sqrt() * inverse_h) * L::splat(job.constants.sigma) * inverse_h.powu(D as u32);
        // (F_i + F_j) X_ij - 2 x_ij, along x_ij.
        let mut error = L::zero();
        for a in 0..D {
            let mut linear = x[a] * L::of(-2.0);
            for b in 0..D {
                linear = (record_i[entry::F + 3 * a + b] + record_j[entry::F + 3 * a + b]).mul_add(initial[b], linear);
            }
            error = linear.mul_add(x[a], error);
        }
        // Padding is at no distance and has no error: only the division must not fail.
        let size = h * h * L::of(1e-6);
        let strength = L::of(0.5) * w * initial_j[WEIGHT] * error / (initial2.max(size) * r2.max(size));
        let mut power = L::zero();
        for a in 0..D {
            acceleration[a] = strength.mul_add(x[a], acceleration[a]);
            power = x[a].mul_add(initial_i[V + a] - initial_j[V + a], power);
        }
        energy_rate -= L::of(0.5) * strength * power;
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
        records[..count].par_iter_mut().enumerate().for_each(|(i, record)| {
            record[..3].copy_from_slice(&frame.encode::<T>(&position[i]));
            for c in 0..9 {
                record[entry::F + c] = T::of(deformation[i][c / 3][c % 3]);
            }
        });
        for (k, ghost) in self.halo.ghosts.iter().enumerate() {
            let source = ghost.source as usize;
            let record = &mut records[count + k];
            record[..3].copy_from_slice(&frame.encode::<T>(&ghost.position(&position[source])));
            for c in 0..9 {
                record[entry::F + c] = T::of(deformation[source][c / 3][c % 3] * ghost.sign[c / 3] * ghost.sign[c % 3]);
            }
        }

        let (list, instructions, constants) = (&self.lists.list, self.instructions, &self.constants);
        let (kinematic, model) = (&self.records.kinematic, &self.model);
        let Particles { acceleration, energy_rate, mass, material, .. } = &mut self.particles;
        let (mass, material, young) = (&*mass, &*material, &reference.young_modulus);
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
                        let factor = total.hourglass * young[material[i] as usize] * reference.volume[i] / mass[i];
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
