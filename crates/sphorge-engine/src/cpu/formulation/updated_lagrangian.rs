//! The updated Lagrangian form of both papers: Cauchy stress over the current neighbours.

use super::Formulation;
use crate::cpu::CpuEngine;
use crate::cpu::inner::Rows;
use crate::cpu::kinematics::GradientSum;
use crate::cpu::records::kinematic;
use crate::cpu::sweeps::GradientSweep;
use crate::halo::FieldSet;
use crate::lanes::PairScalar;
use crate::model::{AdaptiveSearch, GradientCorrection, Integrator, Model, Search};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::gradient_correction::{self, LARGEST_COMPONENT};
use sphorge_physics::viscosity::ViscosityParameters;
use sphorge_physics::{SymmetricTensor, Tensor, Vector, kick, pair, stress, tensor};

pub(super) struct UpdatedLagrangian;

impl<T: PairScalar> Formulation<T> for UpdatedLagrangian {
    fn is_corrected(&self, model: &Model) -> bool {
        model.numerics.gradient_correction != GradientCorrection::None
    }

    fn start(&self, _: &mut CpuEngine<T>) {}

    fn is_initial(&self) -> bool {
        false
    }

    fn sees_other_bodies(&self) -> bool {
        true
    }

    fn pair_viscosity(&self, model: &Model) -> Option<ViscosityParameters<f64>> {
        Some(ViscosityParameters { alpha: model.numerics.viscosity_alpha, beta: model.numerics.viscosity_beta })
    }

    fn viscosity_of_shocks(&self, _: &Model) -> Option<f64> {
        None
    }

    fn bulk_viscosity(&self, _: &Model) -> Option<ViscosityParameters<f64>> {
        None
    }

    /// With leapfrog the gradient is computed at the positions of mid-step, to which its velocities belong. The step is
    /// then reversible in time, and the stress work in it is the work of the forces before and after it, to second
    /// order.
    fn pack_motion(&self, engine: &mut CpuEngine<T>) {
        pack(engine, FieldSet::Motion, 0.5 * engine.step.dt);
    }

    fn kinematics(&self, engine: &mut CpuEngine<T>, rows: Rows) {
        let step = engine.step.dt;
        let half = 0.5 * step;
        let model = &*engine.model;
        let dimension = crate::cpu::dimension(model);
        let form = model.numerics.pair_form;
        let dt = engine.step.dt_to_evaluation(model.numerics.integrator);
        let corrected = self.is_corrected_form(model);
        let sweep =
            GradientSweep::new(&engine.records, &engine.lists, &engine.constants, engine.instructions, dimension);
        let guarded = matches!(model.search, Search::Adaptive(AdaptiveSearch { guard: Some(_), .. }));
        let Particles {
            velocity_gradient, neighbors, density, correction, strain_since_search, strain_correction, ..
        } = &mut engine.particles;
        let room = || [GradientSum::zero(); BLOCK];
        let correction_of = |sum: &GradientSum<T>, scale: f64| {
            let moment = sum.moment.map(|row| row.map(|v| v.to_f64() * scale));
            gradient_correction::gradient_correction(&moment, dimension, LARGEST_COMPONENT)
        };
        // The gradient, and the factor by which its sum was multiplied.
        let plain = |sum: &GradientSum<T>, rho: f64, last: &Tensor<f64>| {
            let scale = pair::gradient_factor(form, stress::predicted_density(rho, last, half));
            (sum.gradient.map(|row| row.map(|v| v.to_f64() * scale)), scale)
        };
        let corrected_by = gradient_correction::corrected::<f64>;
        let inner = &engine.inner;
        let columns =
            (velocity_gradient.par_chunks_mut(BLOCK), neighbors.par_chunks_mut(BLOCK), density.par_chunks_mut(BLOCK));
        if corrected {
            (columns.0, columns.1, columns.2, correction.par_chunks_mut(BLOCK))
                .into_par_iter()
                .enumerate()
                .filter(|(b, _)| inner.is_summed_in(*b, rows))
                .for_each_init(room, |sums, (b, (l, n, rho, correction))| {
                    sweep.block(b, true, sums);
                    for k in 0..l.len() {
                        let (gradient, scale) = plain(&sums[k], rho[k], &l[k]);
                        correction[k] = correction_of(&sums[k], scale);
                        l[k] = corrected_by(&gradient, &correction[k]);
                        rho[k] = stress::density_after(rho[k], &l[k], dt);
                        n[k] = sums[k].inside;
                    }
                });
        } else if guarded {
            // The guard counts the corrected strain: at a free face plain sums give as little as half of it. Moments
            // change no more than the material strains, and are summed only every few steps.
            let is_due = engine.step.count.is_multiple_of(AdaptiveSearch::STRAIN_CORRECTION_STEPS);
            (
                columns.0,
                columns.1,
                columns.2,
                strain_since_search.par_chunks_mut(BLOCK),
                strain_correction.par_chunks_mut(BLOCK),
            )
                .into_par_iter()
                .enumerate()
                .filter(|(b, _)| inner.is_summed_in(*b, rows))
                .for_each_init(room, |sums, (b, (l, n, rho, strain, correction))| {
                    sweep.block(b, is_due, sums);
                    for k in 0..l.len() {
                        let scale;
                        (l[k], scale) = plain(&sums[k], rho[k], &l[k]);
                        if is_due {
                            correction[k] = correction_of(&sums[k], scale);
                        }
                        strain[k] += step * stress::strain_rate(&corrected_by(&l[k], &correction[k]));
                        rho[k] = stress::density_after(rho[k], &l[k], dt);
                        n[k] = sums[k].inside;
                    }
                });
        } else {
            let blocks = columns.into_par_iter().enumerate().filter(|(b, _)| inner.is_summed_in(*b, rows));
            blocks.for_each_init(room, |sums, (b, (l, n, rho))| {
                sweep.block(b, false, sums);
                for k in 0..l.len() {
                    (l[k], _) = plain(&sums[k], rho[k], &l[k]);
                    rho[k] = stress::density_after(rho[k], &l[k], dt);
                    n[k] = sums[k].inside;
                }
            });
        }
        if rows.is_last() {
            engine.count_pairs();
        }
    }

    /// For forces that are evaluated at other positions than the velocity gradient.
    fn corrects_forces(&self, engine: &CpuEngine<T>) -> bool {
        let moved = engine.model.numerics.integrator == Integrator::Leapfrog && engine.step.dt > 0.0;
        self.is_corrected_form(&engine.model) && moved
    }

    fn pack_volumes(&self, engine: &mut CpuEngine<T>) {
        pack(engine, FieldSet::Volume, 0.0);
    }

    /// Gradient correction at the positions and densities of the force evaluation. Torques cancel only if force and
    /// correction use the same.
    fn correct_gradients(&self, engine: &mut CpuEngine<T>) {
        if !Formulation::<T>::corrects_forces(self, engine) {
            return;
        }
        let model = &*engine.model;
        let dimension = crate::cpu::dimension(model);
        let form = model.numerics.pair_form;
        let sweep =
            GradientSweep::new(&engine.records, &engine.lists, &engine.constants, engine.instructions, dimension);
        let Particles { density, correction, .. } = &mut engine.particles;
        correction.par_chunks_mut(BLOCK).enumerate().for_each(|(b, correction)| {
            let mut sums = [GradientSum::zero(); BLOCK];
            sweep.block(b, true, &mut sums);
            for (k, b_i) in correction.iter_mut().enumerate() {
                let scale = pair::gradient_factor(form, density[b * BLOCK + k]);
                let moment = sums[k].moment.map(|row| row.map(|v| v.to_f64() * scale));
                *b_i = gradient_correction::gradient_correction(&moment, dimension, LARGEST_COMPONENT);
            }
        });
    }

    fn force_tensor(
        &self,
        _: &Particles,
        _: usize,
        stress: SymmetricTensor<f64>,
        correction: &Tensor<f64>,
    ) -> Tensor<f64> {
        tensor::multiply(&stress.to_tensor(), correction)
    }

    fn add_forces(&self, _: &mut CpuEngine<T>, _: Rows) {}
}

impl UpdatedLagrangian {
    fn is_corrected_form(&self, model: &Model) -> bool {
        <Self as Formulation<f64>>::is_corrected(self, model)
    }
}

/// Writes velocity, smoothing length, the position for a set of fields and the weight expected a time `ahead` (s) of
/// the current density, for every particle, to its kinematic record.
fn pack<T: PairScalar>(engine: &mut CpuEngine<T>, fields: FieldSet, ahead: f64) {
    engine.make_records();
    let form = engine.model.numerics.pair_form;
    let count = engine.particles.len();
    let frame = engine.records.frame;
    let CpuEngine { model, particles, motions, records, step, ghosts, .. } = engine;
    let Particles { position, velocity, velocity_gradient, mass, density, smoothing_length, xsph, motion, .. } =
        &*particles;
    // The predictor has its positions at mid-step already.
    let is_back = fields == FieldSet::Motion && model.numerics.integrator == Integrator::Leapfrog;
    let back = if is_back { 0.5 * step.dt } else { 0.0 };
    let place = |i: usize| match back {
        0.0 => position[i],
        _ => earlier(position[i], velocity[i], xsph[i], motions.of(motion[i]), back),
    };
    if !ghosts.halo.is_empty() {
        records.places(count).par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, x)| *x = place(i));
    }
    records.kinematic[..count].par_chunks_mut(BLOCK).enumerate().for_each(|(b, records)| {
        for (k, record) in records.iter_mut().enumerate() {
            let i = b * BLOCK + k;
            let x = frame.encode::<T>(&place(i));
            for a in 0..3 {
                record[kinematic::X + a] = x[a];
                record[kinematic::V + a] = T::of_velocity(velocity[i][a]);
            }
            let density = stress::predicted_density(density[i], &velocity_gradient[i], ahead);
            record[kinematic::WEIGHT] = T::of(pair::gradient_weight(form, mass[i], density));
            record[kinematic::H] = T::of(smoothing_length[i]);
        }
    });
}

/// Position of a particle, which drifts with its velocity and XSPH correction, a time `back` (s) ago.
#[inline(always)]
fn earlier(x: Vector<f64>, v: Vector<f64>, xsph: Vector<f64>, prescribed: [Option<f64>; 3], back: f64) -> Vector<f64> {
    // A prescribed axis has no XSPH; its velocity is the one it drifted with.
    [0, 1, 2].map(|a| kick::earlier(x[a], if prescribed[a].is_some() { v[a] } else { v[a] + xsph[a] }, back))
}
