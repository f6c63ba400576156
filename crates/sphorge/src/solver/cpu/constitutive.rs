//! Per-particle update: density is known, stress, temperature and what the force sum reads follow.

use super::records::{extra, force, kinematic};
use super::total_lagrangian::bulk_viscosity;
use super::{CpuEngine, Work};
use crate::lanes::{Job, Lanes, PairScalar, run};
use crate::model::{Integrator, Material, Model, TemperatureSource};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::pair::PairForm;
use sphorge_physics::return_mapping::{Returned, elastic_return, return_mapping_near};
use sphorge_physics::{Dimension, SymmetricTensor, Tensor, artificial_stress, heat, stress, tensor, viscosity};

/// Stress of a particle after a time `dt` with the velocity gradient `l`.
#[inline(always)]
fn returned(p: &Inputs<'_>, l: &Tensor<f64>, dt: f64) -> Returned<f64> {
    let m = p.material;
    let trial = stress::trial_deviator(p.deviator, l, m.shear_modulus, dt);
    let (rule, law, g) = (m.return_rule, &m.flow_law, m.shear_modulus);
    if let Some(yield_stress) = p.known_yield_stress
        && law.yields()
        && let Some(elastic) = elastic_return(trial, yield_stress)
    {
        return elastic;
    }
    return_mapping_near(rule, law, g, trial, p.plastic_strain, p.temperature, dt, p.last_increment)
}

struct Inputs<'a> {
    material: &'a Material,
    deviator: SymmetricTensor<f64>,
    plastic_strain: f64,
    /// Plastic strain increment of the last step.
    last_increment: f64,
    temperature: f64,
    /// Yield stress of the last step, Pa, if it was elastic and the temperature is still that one.
    known_yield_stress: Option<f64>,
}

/// What the update of a block writes: deviator, plastic strain and its increment, yield stress, plastic work, temperature;
/// pressure; sound speed; force records.
type BlockColumns<'a, T> = (
    (&'a mut [SymmetricTensor<f64>], &'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64]),
    &'a mut [f64],
    &'a mut [f64],
    &'a mut [[T; force::LEN]],
);

/// Columns a committed update writes.
struct Committed<'a> {
    deviator: &'a mut SymmetricTensor<f64>,
    plastic_strain: &'a mut f64,
    plastic_strain_increment: &'a mut f64,
    yield_stress: &'a mut f64,
    plastic_work: &'a mut f64,
    temperature: &'a mut f64,
}

impl Committed<'_> {
    /// Takes over a return mapping: plastic strain, heat.
    #[inline(always)]
    fn take(self, update: &Returned<f64>, material: &Material, source: TemperatureSource, density: f64, energy: f64) {
        *self.deviator = update.deviator;
        *self.plastic_strain += update.plastic_strain_increment;
        *self.plastic_strain_increment = update.plastic_strain_increment;
        *self.yield_stress = update.yield_stress;
        *self.plastic_work += update.plastic_work / density;
        match source {
            TemperatureSource::PlasticWork => {
                let (beta, cp) = (material.taylor_quinney, material.specific_heat);
                *self.temperature += heat::temperature_rise_from_plastic_work(beta, update.plastic_work, density, cp);
            }
            TemperatureSource::Energy => {
                let (t0, cp) = (material.reference_temperature, material.specific_heat);
                let cold = material.equation_of_state.cold_energy(density, t0, cp);
                let elastic = heat::elastic_energy(update.deviator, material.shear_modulus, density);
                let stored = (1.0 - material.taylor_quinney) * *self.plastic_work;
                *self.temperature = heat::temperature_from_energy(t0, energy, cold, elastic, stored, cp);
            }
        }
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Updates the stress to the configuration forces are evaluated in and packs it for the force sum. Leapfrog commits
    /// the return mapping here; the predictor–corrector looks half a step ahead and commits in [`Self::commit_stress`].
    pub(super) fn update_stress(&mut self) {
        let numerics = &self.model.numerics;
        let commit = numerics.integrator == Integrator::Leapfrog;
        let full = self.step.dt;
        let dt = self.step.dt_to_evaluation(numerics.integrator);
        let model: &Model = &self.model;
        let corrected = self.corrected();
        let only_flow_heats = self.only_flow_heats();
        let dimension = super::dimension(model);

        let Work { correction, evaluated_velocity, .. } = &self.work;
        let Particles {
            position,
            material,
            density,
            energy,
            energy_rate,
            velocity_gradient,
            smoothing_length,
            mass,
            deviator,
            plastic_strain,
            plastic_strain_increment,
            yield_stress,
            plastic_work,
            temperature,
            pressure,
            sound_speed,
            ..
        } = &mut self.particles;
        let (material, density, energy, energy_rate) = (&*material, &*density, &*energy, &*energy_rate);
        let (velocity_gradient, smoothing_length, mass) = (&*velocity_gradient, &*smoothing_length, &*mass);
        // Forces of the total Lagrangian form are summed at initial positions.
        let reference = self.reference.as_ref();
        let position = reference.map_or(&*position, |r| &r.position);
        let count = density.len();
        let (kinematic_records, frame, instructions) = (&self.records.kinematic, self.records.frame, self.instructions);
        let corrected_length = if corrected { count } else { 0 };

        let columns = (
            (
                deviator.par_chunks_mut(BLOCK),
                plastic_strain.par_chunks_mut(BLOCK),
                plastic_strain_increment.par_chunks_mut(BLOCK),
                yield_stress.par_chunks_mut(BLOCK),
                plastic_work.par_chunks_mut(BLOCK),
                temperature.par_chunks_mut(BLOCK),
            )
                .into_par_iter(),
            pressure.par_chunks_mut(BLOCK),
            sound_speed.par_chunks_mut(BLOCK),
            self.records.force[..count].par_chunks_mut(BLOCK),
        )
            .into_par_iter()
            .enumerate();
        let update_block = |(b, ((s, ep, dep, y, wp, t), p, c, records)): (usize, BlockColumns<'_, T>),
                            extras: &mut [[T; extra::LEN]]| {
            // Stress of the block by component, for the artificial stress.
            let mut stress = [[0.0; BLOCK]; 6];
            for k in 0..s.len() {
                let i = b * BLOCK + k;
                let material = &model.materials[material[i] as usize];
                let inputs = Inputs {
                    material,
                    deviator: s[k],
                    plastic_strain: ep[k],
                    last_increment: dep[k],
                    temperature: t[k],
                    known_yield_stress: (only_flow_heats && dep[k] == 0.0).then_some(y[k]),
                };
                let update = returned(&inputs, &velocity_gradient[i], dt);
                let energy_here = energy[i] + 0.5 * full * energy_rate[i];
                let state = material.pressure(density[i], energy_here);
                (p[k], c[k]) = (state.pressure, state.sound_speed);
                if commit {
                    let columns = Committed {
                        deviator: &mut s[k],
                        plastic_strain: &mut ep[k],
                        plastic_strain_increment: &mut dep[k],
                        yield_stress: &mut y[k],
                        plastic_work: &mut wp[k],
                        temperature: &mut t[k],
                    };
                    columns.take(&update, material, numerics.temperature, density[i], energy_here);
                }
                let record = &mut records[k];
                let scale = stress_scale(numerics.pair_form, density[i]);
                let mut pressure = state.pressure;
                if reference.is_some() {
                    let l = &velocity_gradient[i];
                    let (alpha, beta) = (numerics.viscosity_alpha, numerics.viscosity_beta);
                    let (divergence, c, h) = (l[0][0] + l[1][1] + l[2][2], state.sound_speed, smoothing_length[i]);
                    pressure += bulk_viscosity(alpha, beta, divergence, density[i], c, h);
                }
                let sigma = (update.deviator - SymmetricTensor::isotropic(pressure)) * scale;
                let components = sigma.to_array();
                let x = frame.encode::<T>(&position[i]);
                for a in 0..3 {
                    record[force::X + a] = x[a];
                    record[force::V + a] = T::of(evaluated_velocity[i][a]);
                }
                for (slot, value) in components.into_iter().enumerate() {
                    record[force::S + slot] = T::of(value);
                }
                record[force::WEIGHT] = match numerics.pair_form {
                    // Adjoint to the last digit: the volumes of the gradient correction, or of the gradient sum at the
                    // same positions.
                    PairForm::VolumeWeighted if corrected || !commit => kinematic_records[i][kinematic::WEIGHT],
                    PairForm::VolumeWeighted => T::of(mass[i] / density[i]),
                    PairForm::DensityWeighted | PairForm::Mixed => T::of(mass[i]),
                };
                record[force::C] = T::of(state.sound_speed);
                record[force::RHO] = T::of(density[i]);
                record[force::H] = T::of(smoothing_length[i]);
                if !extras.is_empty() {
                    for (column, value) in stress.iter_mut().zip(components) {
                        column[k] = value;
                    }
                    if numerics.balsara {
                        let (l, c, h) = (&velocity_gradient[i], state.sound_speed, smoothing_length[i]);
                        extras[k][extra::BALSARA] = T::of(balsara_factor(l, c, h));
                    }
                }
            }
            if let Some(artificial) = numerics.artificial_stress {
                run(instructions, ArtificialStressJob { stress: &mut stress, epsilon: artificial.epsilon, dimension });
                for (k, record) in extras.iter_mut().enumerate() {
                    for (slot, column) in stress.iter().enumerate() {
                        record[extra::R + slot] = T::of(column[k]);
                    }
                }
            }
        };
        if self.records.extra.is_empty() {
            columns.for_each(|block| update_block(block, &mut []));
        } else {
            let extras = self.records.extra[..count].par_chunks_mut(BLOCK);
            columns.zip(extras).for_each(|(block, extras)| update_block(block, extras));
        }

        let records = &self.records.force;
        self.records.corrected[..corrected_length].par_iter_mut().enumerate().for_each(|(i, record)| {
            let stress = stress_of(&records[i]);
            let product = match reference {
                None => tensor::multiply(&stress.to_tensor(), &correction[i]),
                Some(reference) => reference.force_tensor(i, &stress, &correction[i]),
            };
            for (slot, value) in product.iter().flatten().enumerate() {
                record[slot] = T::of(*value);
            }
        });
    }

    /// Takes the stress through the whole step with the gradient of mid-step, for good.
    pub(super) fn commit_stress(&mut self) {
        let dt = self.step.dt;
        let only_flow_heats = self.only_flow_heats();
        let model: &Model = &self.model;
        let base = &self.base;
        let Particles {
            material,
            density,
            energy,
            velocity_gradient,
            deviator,
            plastic_strain,
            plastic_strain_increment,
            yield_stress,
            plastic_work,
            temperature,
            pressure,
            sound_speed,
            ..
        } = &mut self.particles;
        let (material, energy, velocity_gradient) = (&*material, &*energy, &*velocity_gradient);
        (
            (
                deviator.par_chunks_mut(BLOCK),
                plastic_strain.par_chunks_mut(BLOCK),
                plastic_strain_increment.par_chunks_mut(BLOCK),
                yield_stress.par_chunks_mut(BLOCK),
                plastic_work.par_chunks_mut(BLOCK),
                temperature.par_chunks_mut(BLOCK),
            )
                .into_par_iter(),
            pressure.par_chunks_mut(BLOCK),
            sound_speed.par_chunks_mut(BLOCK),
            density.par_chunks_mut(BLOCK),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, ((s, ep, dep, y, wp, t), p, c, rho))| {
                for k in 0..s.len() {
                    let i = b * BLOCK + k;
                    let material = &model.materials[material[i] as usize];
                    let inputs = Inputs {
                        material,
                        deviator: s[k],
                        plastic_strain: ep[k],
                        last_increment: dep[k],
                        temperature: t[k],
                        known_yield_stress: (only_flow_heats && dep[k] == 0.0).then_some(y[k]),
                    };
                    let update = returned(&inputs, &velocity_gradient[i], dt);
                    rho[k] = stress::density_after(base.density[i], &velocity_gradient[i], dt);
                    let state = material.pressure(rho[k], energy[i]);
                    (p[k], c[k]) = (state.pressure, state.sound_speed);
                    let columns = Committed {
                        deviator: &mut s[k],
                        plastic_strain: &mut ep[k],
                        plastic_strain_increment: &mut dep[k],
                        yield_stress: &mut y[k],
                        plastic_work: &mut wp[k],
                        temperature: &mut t[k],
                    };
                    columns.take(&update, material, model.numerics.temperature, rho[k], energy[i]);
                }
            });
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Whether the temperature of a particle that stays elastic does not change.
    fn only_flow_heats(&self) -> bool {
        let by_flow = self.model.numerics.temperature == TemperatureSource::PlasticWork;
        by_flow && self.heat.is_none() && self.contacts.is_none()
    }

    /// Adds the strain of the step to what adaptive search looks at.
    pub(super) fn accumulate_strain(&mut self) {
        let dt = self.step.dt;
        let Particles { velocity_gradient, plastic_strain_increment, .. } = &self.particles;
        let Work { strain_since_search, plastic_since_search, .. } = &mut self.work;
        let columns = (
            strain_since_search.par_chunks_mut(BLOCK),
            plastic_since_search.par_chunks_mut(BLOCK),
            velocity_gradient.par_chunks(BLOCK),
            plastic_strain_increment.par_chunks(BLOCK),
        );
        columns.into_par_iter().for_each(|(strain, plastic, l, increment)| {
            for (((strain, plastic), l), increment) in strain.iter_mut().zip(plastic).zip(l).zip(increment) {
                let d = SymmetricTensor::symmetric_part(l);
                *strain += dt * d.double_dot(d).sqrt();
                *plastic += increment;
            }
        });
    }
}

/// Balsara factor of a particle.
fn balsara_factor(l: &Tensor<f64>, sound_speed: f64, h: f64) -> f64 {
    let divergence = l[0][0] + l[1][1] + l[2][2];
    let curl = [l[2][1] - l[1][2], l[0][2] - l[2][0], l[1][0] - l[0][1]];
    let norm = curl.iter().map(|w| w * w).sum::<f64>().sqrt();
    viscosity::balsara(divergence, norm, sound_speed, h)
}

/// Takes the stress of a block, component by component, to its artificial stress.
struct ArtificialStressJob<'a> {
    stress: &'a mut [[f64; BLOCK]; 6],
    epsilon: f64,
    dimension: Dimension,
}

impl Job<f64> for ArtificialStressJob<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let epsilon = L::splat(self.epsilon);
        for k in (0..BLOCK).step_by(L::WIDTH) {
            let mut sigma = [L::zero(); 6];
            for c in 0..6 {
                sigma[c] = L::load(&self.stress[c][k..]);
            }
            let sigma = SymmetricTensor::from_array(sigma);
            let r = artificial_stress::artificial_stress(sigma, epsilon, self.dimension).to_array();
            for c in 0..6 {
                r[c].store(&mut self.stress[c][k..]);
            }
        }
    }
}

/// Factor between Cauchy stress and what the force sum adds up.
#[inline(always)]
fn stress_scale(form: PairForm, density: f64) -> f64 {
    match form {
        PairForm::VolumeWeighted => 1.0,
        PairForm::DensityWeighted | PairForm::Mixed => 1.0 / (density * density),
    }
}

/// Scaled stress of a force record, in double precision.
#[inline(always)]
fn stress_of<T: PairScalar>(record: &[T; force::LEN]) -> SymmetricTensor<f64> {
    SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|c| record[force::S + c].to_f64()))
}
