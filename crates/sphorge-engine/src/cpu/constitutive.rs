//! Update of each particle from the density: stress, temperature, and the data that the force sum reads.

use super::CpuEngine;
use super::flow::{FlowChunks, FlowColumns, StressStep};
use super::hourglass::SpringLaw;
use super::prefetch::prefetch_behind;
use super::records::{extra, force, kinematic};
use super::stress_columns::{ElasticInputs, PackStress, StressColumns, StressForm};
use crate::lanes::{PairScalar, run};
use crate::model::{Integrator, Material, Model, TemperatureSource};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::pair::{PairForm, momentum_weight};
use sphorge_physics::total_lagrangian::total_first_piola;
use sphorge_physics::{SymmetricTensor, Tensor, stress, tensor, viscosity};

/// Data that the update of a block of particles writes: deviator, flow, pressure, sound speed, force records; with bulk
/// viscosity also its pressure and its work, J.
type Chunks<'a, T> = (
    &'a mut [SymmetricTensor<f64>],
    FlowChunks<'a>,
    &'a mut [f64],
    &'a mut [f64],
    &'a mut [[T; force::LEN]],
    Viscous<'a>,
);

/// Bulk viscosity of a block of particles, how fast it damps them, and the divergence of their velocities, filtered once and twice, if there is one,
/// and its work so far, J.
type Viscous<'a> = (Option<((&'a mut [f64], &'a mut [f64]), (&'a mut [f64], &'a mut [f64]))>, &'a mut f64);

impl<T: PairScalar> CpuEngine<T> {
    /// Updates the stress to the configuration in which forces are evaluated, and packs it for the force sum. With
    /// leapfrog this commits the return mapping. The predictor–corrector looks half a step ahead and commits in
    /// [`Self::commit_stress`].
    pub(super) fn update_stress(&mut self) {
        let numerics = &self.model.numerics;
        let commit = numerics.integrator == Integrator::Leapfrog;
        let half = 0.5 * self.step.dt;
        let model: &Model = &self.model;
        let only_flow_heats = self.only_flow_heats();
        let instructions = self.instructions;
        let (dt, step_size) = (self.step.dt_to_evaluation(numerics.integrator), self.step.dt);
        let corrected = self.corrected();
        let formulation = self.formulation;
        let form = StressForm {
            pair_form: numerics.pair_form,
            bulk_viscosity: formulation.bulk_viscosity(model),
            shocks: formulation.viscosity_of_shocks(model),
            artificial_stress: numerics.artificial_stress.is_some(),
            breaks: model.materials.iter().any(Material::breaks),
            dimension: super::dimension(model),
        };

        let Particles {
            position,
            reference_position,
            evaluated_velocity,
            body,
            material,
            density,
            energy,
            energy_rate,
            velocity_gradient,
            deformation,
            earlier_deformation,
            smoothing_length,
            smallest_stretch: stretch,
            viscous_pressure,
            damping_rate,
            divergence_once,
            divergence_twice,
            mass,
            deviator,
            plastic_strain,
            plastic_strain_increment,
            yield_stress,
            plastic_work,
            temperature,
            pressure,
            sound_speed,
            history,
            artificial_energy,
            artificial_power,
            reference_volume,
            yielded_stretch,
            spring_misfit,
            ..
        } = &mut self.particles;
        // What springs hold is neither strain of the metal nor heat.
        let law = SpringLaw::of(model).filter(|_| numerics.temperature == TemperatureSource::Energy);
        let reference_volume = &*reference_volume;
        let springs = (reference_volume, &*yielded_stretch, &*spring_misfit);
        let (artificial_energy, artificial_power) = (&*artificial_energy, &*artificial_power);
        let (history, slots, history_width) = history.parts();
        let step = StressStep {
            materials: &model.materials,
            temperature: numerics.temperature,
            only_flow_heats,
            instructions,
            commit,
            slots,
            history_width,
            cold_energies: &self.cold_energies,
            breaks: form.breaks,
            support: numerics.kernel.support(),
            end: self.step.time + step_size,
        };
        let (material, density, energy, energy_rate) = (&*material, &*density, &*energy, &*energy_rate);
        let (velocity_gradient, smoothing_length, mass) = (&*velocity_gradient, &*smoothing_length, &*mass);
        let (deformation, earlier_deformation) = (&*deformation, &*earlier_deformation);
        let stretch = &*stretch;
        let (body, repulsion) = (&*body, &self.repulsion);
        let (has_come_apart, acts_on_all) = (&*self.has_come_apart, numerics.viscosity_of_all_waves);
        let evaluated_velocity = &*evaluated_velocity;
        // Forces of the total Lagrangian form are summed at the reference positions.
        let position = if formulation.is_initial() { &*reference_position } else { &*position };
        let count = density.len();
        let (kinematic_records, frame) = (&self.records.kinematic, self.records.frame);
        let corrected_length = if corrected { count } else { 0 };
        let viscous = &mut self.numerical_work.viscous;
        let without = if viscous_pressure.is_empty() { viscous.work.len() } else { 0 };
        let filtered = divergence_once.par_chunks_mut(BLOCK).zip(divergence_twice.par_chunks_mut(BLOCK));
        let viscous_pressure = viscous_pressure.par_chunks_mut(BLOCK).zip(damping_rate.par_chunks_mut(BLOCK));
        let viscous_pressure = viscous_pressure.zip(filtered).map(Some);

        let chunks = (
            deviator.par_chunks_mut(BLOCK),
            (
                plastic_strain.par_chunks_mut(BLOCK),
                plastic_strain_increment.par_chunks_mut(BLOCK),
                yield_stress.par_chunks_mut(BLOCK),
                plastic_work.par_chunks_mut(BLOCK),
                temperature.par_chunks_mut(BLOCK),
                history.par_iter_mut(),
            )
                .into_par_iter(),
            pressure.par_chunks_mut(BLOCK),
            sound_speed.par_chunks_mut(BLOCK),
            self.records.force[..count].par_chunks_mut(BLOCK),
            (viscous_pressure.chain((0..without).into_par_iter().map(|_| None)), viscous.work.par_iter_mut())
                .into_par_iter(),
        )
            .into_par_iter()
            .enumerate();
        let update = |columns: &mut StressColumns,
                      (b, (s, flow, p, c, records, viscous)): (usize, Chunks<'_, T>),
                      extras: &mut [[T; extra::LEN]]| {
            let first = b * BLOCK;
            let particles = first..first + s.len();
            prefetch_behind(s);
            prefetch_behind(records);
            prefetch_behind(extras);
            prefetch_behind(&velocity_gradient[particles.clone()]);
            prefetch_behind(&position[particles.clone()]);
            prefetch_behind(&evaluated_velocity[particles.clone()]);
            columns.density[..s.len()].copy_from_slice(&density[particles.clone()]);
            let energies = energy[particles.clone()].iter().zip(&energy_rate[particles.clone()]);
            for (here, (energy, rate)) in columns.energy.iter_mut().zip(energies) {
                *here = energy + half * rate;
            }
            let works = artificial_energy.iter().zip(artificial_power).skip(first);
            for (here, (energy, power)) in columns.numerical_energy.iter_mut().zip(works) {
                *here = energy + half * power;
            }
            if let Some(law) = &law {
                let (volume, stretch, misfit) = springs;
                for (k, here) in columns.numerical_energy[..s.len()].iter_mut().enumerate() {
                    let i = first + k;
                    let material = &model.materials[material[i] as usize];
                    let spring = law.spring(material, flow.2[k], flow.0[k], stretch[i]);
                    *here = volume[i] / mass[i] * spring.energy(misfit[i], form.dimension);
                }
            }
            if form.artificial_stress {
                let owners = body[particles.clone()].iter().zip(&material[particles.clone()]);
                for (k, (body, material)) in owners.enumerate() {
                    let left = model.materials[*material as usize].bounded_pressure().energy_left(columns.energy[k]);
                    columns.repulsion[k] = repulsion[*body as usize] * left;
                }
            }
            if form.bulk_viscosity.is_some() {
                let lengths = smoothing_length[particles.clone()].iter().zip(&stretch[particles.clone()]);
                for (here, (h, stretch)) in columns.smoothing_length.iter_mut().zip(lengths) {
                    *here = h * stretch;
                }
            }
            let inputs = ElasticInputs {
                material: &material[particles.clone()],
                deviator: s,
                velocity_gradient: &velocity_gradient[particles.clone()],
                smoothing_length: &smoothing_length[particles.clone()],
                deformation: deformation.get(particles.clone()).unwrap_or_default(),
                earlier_deformation: earlier_deformation.get(particles.clone()).unwrap_or_default(),
                dt,
            };
            FlowColumns::new(flow).take_step(&step, columns, &inputs);
            if let (Some(parameters), (Some(((pressure, rates), filtered)), work)) = (form.bulk_viscosity, viscous) {
                let masses = &mass[particles.clone()];
                // What cracks, or has come apart, lets go at once: all waves are damped.
                let lets_go = |i: usize| {
                    has_come_apart[body[i] as usize] || form.breaks && model.materials[material[i] as usize].breaks()
                };
                columns.find_short_waves(step_size, filtered, |k| acts_on_all || lets_go(first + k));
                columns.find_shocks(&form, parameters, &inputs, rates);
                *work += step_size * columns.viscous_power(parameters, &form, masses, pressure);
                if form.shocks.is_some() {
                    let volumes = &reference_volume[particles.clone()];
                    for (here, (mass, volume)) in columns.initial_density.iter_mut().zip(masses.iter().zip(volumes)) {
                        *here = mass / volume;
                    }
                }
            }
            run(step.instructions, PackStress { columns, form, records, extras });

            if commit {
                for (k, s) in s.iter_mut().enumerate() {
                    *s = columns.deviator_of(k);
                }
            }
            p.copy_from_slice(&columns.pressure[..p.len()]);
            c.copy_from_slice(&columns.sound_speed[..c.len()]);
            for (k, record) in records.iter_mut().enumerate() {
                let i = first + k;
                let x = frame.encode::<T>(&position[i]);
                for a in 0..3 {
                    record[force::X + a] = x[a];
                    record[force::V + a] = T::of_velocity(evaluated_velocity[i][a]);
                }
                record[force::WEIGHT] = if numerics.pair_form == PairForm::VolumeWeighted && (corrected || !commit) {
                    // Adjoint to the last digit: the volumes of the gradient correction, or of the gradient sum at the
                    // same positions.
                    kinematic_records[i][kinematic::WEIGHT]
                } else {
                    T::of(momentum_weight(numerics.pair_form, mass[i], columns.density[k]))
                };
                record[force::H] = T::of(smoothing_length[i]);
            }
            if numerics.xsph != 0.0 {
                for (k, (extra, record)) in extras.iter_mut().zip(&*records).enumerate() {
                    extra[extra::MASS_PER_WEIGHT] = T::of(mass[first + k] / record[force::WEIGHT].to_f64());
                }
            }
            if numerics.balsara {
                for (k, record) in extras.iter_mut().enumerate() {
                    let (l, h) = (&velocity_gradient[first + k], smoothing_length[first + k]);
                    record[extra::BALSARA] = T::of(viscosity::balsara(l, columns.sound_speed[k], h));
                }
            }
        };
        if self.records.extra.is_empty() {
            chunks.for_each_init(StressColumns::new, |columns, chunk| update(columns, chunk, &mut []));
        } else {
            let extras = self.records.extra[..count].par_chunks_mut(BLOCK);
            chunks
                .zip(extras)
                .for_each_init(StressColumns::new, |columns, (chunk, extras)| update(columns, chunk, extras));
        }

        if self.face_sums.is_some() {
            return self.correct_at_faces();
        }
        let records = &self.records.force;
        let particles = &self.particles;
        self.records.corrected[..corrected_length].par_iter_mut().enumerate().for_each(|(i, record)| {
            let stress = stress_of(&records[i]);
            let product = formulation.force_tensor(particles, i, stress, &particles.correction[i]);
            for (slot, value) in product.iter().flatten().enumerate() {
                record[slot] = T::of(*value);
            }
        });
    }

    /// Packs the tensors of the force sum where gradients are exact for quadratic fields at faces.
    fn correct_at_faces(&mut self) {
        let Some(face_sums) = &mut self.face_sums else { return };
        let (p, records) = (&self.particles, &self.records.force);
        let stress = |i: usize| total_first_piola(stress_of(&records[i]), &p.deformation[i], &p.face_stress[i]);
        let how = (self.instructions, super::dimension(&self.model));
        face_sums.transpose(stress, how, |i| p.mass[i] / p.reference_volume[i]);
        let stresses = face_sums.stresses();
        self.records.corrected[..p.len()].par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, record)| {
            let own = tensor::plus(&stresses[i], 1.0, &p.spring_moment[i]);
            let product = tensor::multiply(&own, &p.correction[i]);
            for (slot, value) in product.iter().flatten().enumerate() {
                record[slot] = T::of(*value);
            }
        });
    }

    /// Advances the stress by the whole step with the gradient of mid-step, and commits it.
    pub(super) fn commit_stress(&mut self) {
        let model: &Model = &self.model;
        let only_flow_heats = self.only_flow_heats();
        let dt = self.step.dt;
        let Particles {
            material,
            base_density,
            density,
            energy,
            velocity_gradient,
            smoothing_length,
            deviator,
            plastic_strain,
            plastic_strain_increment,
            yield_stress,
            plastic_work,
            temperature,
            pressure,
            sound_speed,
            history,
            artificial_energy,
            ..
        } = &mut self.particles;
        let artificial_energy = &*artificial_energy;
        let (history, slots, history_width) = history.parts();
        let step = StressStep {
            materials: &model.materials,
            temperature: model.numerics.temperature,
            only_flow_heats,
            instructions: self.instructions,
            commit: true,
            slots,
            history_width,
            cold_energies: &self.cold_energies,
            breaks: model.materials.iter().any(Material::breaks),
            support: model.numerics.kernel.support(),
            end: self.step.time + dt,
        };
        let (material, energy, velocity_gradient) = (&*material, &*energy, &*velocity_gradient);
        let (base_density, smoothing_length) = (&*base_density, &*smoothing_length);
        (
            deviator.par_chunks_mut(BLOCK),
            (
                plastic_strain.par_chunks_mut(BLOCK),
                plastic_strain_increment.par_chunks_mut(BLOCK),
                yield_stress.par_chunks_mut(BLOCK),
                plastic_work.par_chunks_mut(BLOCK),
                temperature.par_chunks_mut(BLOCK),
                history.par_iter_mut(),
            )
                .into_par_iter(),
            pressure.par_chunks_mut(BLOCK),
            sound_speed.par_chunks_mut(BLOCK),
            density.par_chunks_mut(BLOCK),
        )
            .into_par_iter()
            .enumerate()
            .for_each_init(StressColumns::new, |columns, (b, (s, flow, p, c, rho))| {
                let particles = b * BLOCK..b * BLOCK + s.len();
                let material = &material[particles.clone()];
                let l = &velocity_gradient[particles.clone()];
                for ((rho, l), base) in rho.iter_mut().zip(l).zip(&base_density[particles.clone()]) {
                    *rho = stress::density_after(*base, l, dt);
                }
                columns.density[..s.len()].copy_from_slice(rho);
                columns.energy[..s.len()].copy_from_slice(&energy[particles.clone()]);
                for (here, energy) in
                    columns.numerical_energy.iter_mut().zip(artificial_energy.iter().skip(particles.start))
                {
                    *here = *energy;
                }
                let smoothing_length = &smoothing_length[particles];
                // Only forms without deformation gradients have this integrator.
                let none: &[Tensor<f64>] = &[];
                let inputs = ElasticInputs {
                    material,
                    deviator: s,
                    velocity_gradient: l,
                    smoothing_length,
                    deformation: none,
                    earlier_deformation: none,
                    dt,
                };
                FlowColumns::new(flow).take_step(&step, columns, &inputs);
                for (k, s) in s.iter_mut().enumerate() {
                    *s = columns.deviator_of(k);
                }
                p.copy_from_slice(&columns.pressure[..p.len()]);
                c.copy_from_slice(&columns.sound_speed[..c.len()]);
            });
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Whether the temperature of a particle that stays elastic does not change.
    fn only_flow_heats(&self) -> bool {
        let by_flow = self.model.numerics.temperature == TemperatureSource::PlasticWork;
        by_flow && self.heat.is_none() && self.particles.friction_heat.is_empty()
    }

    /// Sets the rates of plastic strain of the step.
    pub(super) fn know_flow_rates(&mut self) {
        let dt = self.step.dt;
        if dt > 0.0 {
            let Particles { plastic_strain_rate, plastic_strain_increment, .. } = &mut self.particles;
            let particles = plastic_strain_rate.par_iter_mut().zip(&*plastic_strain_increment);
            particles.with_min_len(BLOCK).for_each(|(rate, increment)| *rate = increment / dt);
        }
    }

    /// Adds the strain of the step to the strain that the adaptive search looks at: with plain gradients only the
    /// plastic strain, since the first pair sum adds the corrected strain.
    pub(super) fn accumulate_strain(&mut self) {
        let (dt, corrected) = (self.step.dt, self.formulation.is_corrected(&self.model));
        let Particles {
            velocity_gradient, plastic_strain_increment, strain_since_search, plastic_since_search, ..
        } = &mut self.particles;
        let columns = (plastic_since_search.par_chunks_mut(BLOCK), plastic_strain_increment.par_chunks(BLOCK));
        columns.into_par_iter().for_each(|(plastic, increment)| {
            plastic.iter_mut().zip(increment).for_each(|(plastic, increment)| *plastic += increment);
        });
        if corrected {
            let columns = (strain_since_search.par_chunks_mut(BLOCK), velocity_gradient.par_chunks(BLOCK));
            columns.into_par_iter().for_each(|(strain, l)| {
                strain.iter_mut().zip(l).for_each(|(strain, l)| *strain += dt * stress::strain_rate(l));
            });
        }
    }
}

/// Shear modulus of a particle in its current state, Pa.
#[inline(always)]
pub(super) fn shear_modulus_of(material: &Material, p: &Particles, i: usize) -> f64 {
    if !material.flow_law.shear_modulus_varies() {
        return material.shear_modulus;
    }
    let state = material.flow_state(p.plastic_strain[i], p.temperature[i], p.density[i], p.pressure[i]);
    material.flow_law.shear_modulus(material.shear_modulus, state)
}

/// Scaled stress of a force record, in double precision.
#[inline(always)]
fn stress_of<T: PairScalar>(record: &[T; force::LEN]) -> SymmetricTensor<f64> {
    SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|c| record[force::S + c].to_f64()))
}

#[cfg(test)]
mod tests;
