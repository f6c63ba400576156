//! The total Lagrangian form: sums over the neighbours in the reference configuration at the positions `X` in it. The
//! formulas are in [`sphorge_physics::total_lagrangian`]. The reference is the initial configuration until a body comes
//! apart ([`crate::cpu::renewal`]).
//!
//! The Cauchy stress follows from the velocity gradient by the same laws as in the other form. There is no tensile
//! instability: artificial stress, XSPH and density restoration are not part of the model. Viscosity is a pressure of
//! the particle, because a viscosity of pairs at initial positions would damp rigid rotation. The sums do not see other
//! bodies.

use super::Formulation;
use crate::cpu::CpuEngine;
use crate::cpu::inner::Rows;
use crate::cpu::kinematics::GradientSum;
use crate::cpu::records::kinematic;
use crate::cpu::sweeps::GradientSweep;
use crate::lanes::{Job, Lanes, PairScalar, run};
use crate::model::{Material, Model};
use crate::neighbors::{BLOCK, PAD};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::gradient_correction::{LARGEST_COMPONENT, corrected};
use sphorge_physics::hourglass::is_fit;
use sphorge_physics::integrity::share_of_springs;
use sphorge_physics::thin::{Across, completed_rate, correction_of_pieces, is_thin, reference_correction};
use sphorge_physics::total_lagrangian::{deform, density as density_of, force_tensor, smallest_stretch};
use sphorge_physics::viscosity::{ViscosityParameters, bulk_mu};
use sphorge_physics::{Dimension, SymmetricTensor, Tensor, tensor};

pub(super) struct TotalLagrangian;

/// What the deformation of a block changes: velocity gradients, densities, deformation gradients, smallest stretches, those at which it has
/// yielded, and the `mu` of the viscosity.
type Deformed<'a> =
    (&'a mut [Tensor<f64>], &'a mut [f64], &'a mut [Tensor<f64>], &'a mut [f64], &'a mut [f64], &'a mut [f64]);

/// The same of all particles, block by block.
fn in_blocks<'a>((l, rho, f, stretch, yielded, mu): Deformed<'a>) -> impl IndexedParallelIterator<Item = Deformed<'a>> {
    let tensors = (l.par_chunks_mut(BLOCK), f.par_chunks_mut(BLOCK));
    let numbers = (stretch.par_chunks_mut(BLOCK), yielded.par_chunks_mut(BLOCK), mu.par_chunks_mut(BLOCK));
    let all = (tensors.into_par_iter(), rho.par_chunks_mut(BLOCK), numbers.into_par_iter()).into_par_iter();
    all.map(|((l, f), rho, (stretch, yielded, mu))| (l, rho, f, stretch, yielded, mu))
}

impl<T: PairScalar> Formulation<T> for TotalLagrangian {
    fn is_corrected(&self, _: &Model) -> bool {
        true
    }

    fn start(&self, engine: &mut CpuEngine<T>) {
        let p = &mut engine.particles;
        p.reference_position.clone_from(&p.position);
        for (volume, (mass, density)) in p.reference_volume.iter_mut().zip(p.mass.iter().zip(&p.density)) {
            *volume = mass / density;
        }
    }

    fn is_initial(&self) -> bool {
        true
    }

    fn sees_other_bodies(&self) -> bool {
        false
    }

    fn pair_viscosity(&self, _: &Model) -> Option<ViscosityParameters<f64>> {
        None
    }

    fn bulk_viscosity(&self, model: &Model) -> Option<ViscosityParameters<f64>> {
        Some(ViscosityParameters { alpha: model.numerics.viscosity_alpha, beta: model.numerics.viscosity_beta })
    }

    fn viscosity_of_shocks(&self, model: &Model) -> Option<f64> {
        Some(model.numerics.viscosity_of_shocks).filter(|strength| *strength > 0.0)
    }

    /// Velocities at initial positions, with initial volumes as weights.
    fn pack_motion(&self, engine: &mut CpuEngine<T>) {
        engine.make_records();
        let count = engine.particles.len();
        let frame = engine.records.frame;
        let Particles { velocity, smoothing_length, reference_position, reference_volume, .. } = &engine.particles;
        engine.records.kinematic[..count].par_iter_mut().enumerate().for_each(|(i, record)| {
            let x = frame.encode::<T>(&reference_position[i]);
            for a in 0..3 {
                record[kinematic::X + a] = x[a];
                record[kinematic::V + a] = T::of_velocity(velocity[i][a]);
            }
            record[kinematic::WEIGHT] = T::of(reference_volume[i]);
            record[kinematic::H] = T::of(smoothing_length[i]);
        });
        if !engine.ghosts.halo.is_empty() {
            engine.records.places(count).copy_from_slice(reference_position);
        }
    }

    /// Deformation gradient, velocity gradient and density.
    fn kinematics(&self, engine: &mut CpuEngine<T>, rows: Rows) {
        if !engine.reference_corrected {
            correct_reference(engine);
            engine.reference_corrected = true;
        }
        engine.know_faces();
        let dimension = crate::cpu::dimension(&engine.model);
        let (dt, instructions) = (engine.step.dt, engine.instructions);
        let sweep =
            GradientSweep::new(&engine.records, &engine.lists, &engine.constants, engine.instructions, dimension);
        let Particles {
            velocity_gradient,
            neighbors,
            density,
            deformation,
            smallest_stretch: stretch,
            yielded_stretch,
            plastic_strain_increment: flow,
            mu,
            mass,
            smoothing_length,
            reference_volume,
            correction,
            history,
            material,
            deviator,
            pressure,
            sound_speed,
            face_excess,
            ..
        } = &mut engine.particles;
        let inner = &engine.inner;
        let (mass, volume, h, correction, flow) =
            (&*mass, &*reference_volume, &*smoothing_length, &*correction, &*flow);
        let (materials, has_thin_parts) = (&engine.model.materials, engine.has_thin_parts);
        let state = (&*material, &*deviator, &*pressure, &*sound_speed);
        let (history, deletes) = (&*history, materials.iter().any(Material::deletes));
        let has_brittle = materials.iter().any(Material::is_brittle);
        // Deforms a block with these sums; `taken` is what those at faces have less than the plain ones.
        let deform_block =
            |b: usize, columns: Deformed<'_>, sums: &mut [Tensor<f64>; BLOCK], taken: &mut [Tensor<f64>]| {
                let (l, rho, f, stretch, yielded, mu) = columns;
                for k in 0..l.len() {
                    let i = b * BLOCK + k;
                    let mut rate = sums[k];
                    if has_thin_parts && is_thin(&correction[i]) > 0.0 {
                        let (material, deviator, pressure, sound_speed) = state;
                        let across = Across {
                            bulk_modulus: rho[k] * sound_speed[i] * sound_speed[i],
                            shear_modulus: materials[material[i] as usize].shear_modulus,
                            stress: deviator[i] - SymmetricTensor::isotropic(pressure[i]),
                        };
                        rate = completed_rate(&f[k], &rate, &correction[i], &across, dt);
                    }
                    if deletes && materials[material[i] as usize].deletes() && history.integrity_of(i) == 0.0 {
                        // What is deleted keeps its deformation and has no springs: nothing resists what its neighbours do, and it must
                        // not limit the step.
                        (rate, yielded[k]) = (tensor::zero(), 0.0);
                        taken.iter_mut().skip(k).take(1).for_each(|taken| *taken = tensor::zero());
                    }
                    if has_brittle && materials[material[i] as usize].is_brittle() {
                        // Springs have the root of it.
                        yielded[k] = yielded[k].min(share_of_springs(history.integrity_of(i)).powi(2));
                    }
                    l[k] = deform(&mut f[k], &rate, dt);
                    rho[k] = density_of(mass[i], volume[i], &f[k]);
                }
                run(instructions, SmallestStretches { deformation: f, stretch });
                for k in 0..l.len() {
                    if flow[b * BLOCK + k] > 0.0 {
                        yielded[k] = stretch[k].min(yielded[k]);
                    }
                    mu[k] = bulk_mu(&l[k], h[b * BLOCK + k] * stretch[k]);
                }
            };
        let sum_block = |b: usize, n: &mut [u32]| {
            let mut sums = [GradientSum::zero(); BLOCK];
            let mut rates = [tensor::zero(); BLOCK];
            sweep.block(b, false, &mut sums);
            for k in 0..n.len() {
                let sum = sums[k].gradient.map(|row| row.map(|v| v.to_f64()));
                rates[k] = corrected(&sum, &correction[b * BLOCK + k]);
                n[k] = sums[k].inside;
            }
            rates
        };
        let (l, rho, f, yielded) = (velocity_gradient, density, deformation, yielded_stretch);
        let blocks = in_blocks((&mut *l, &mut *rho, &mut *f, &mut *stretch, &mut *yielded, &mut *mu));
        let blocks = blocks.zip(neighbors.par_chunks_mut(BLOCK)).enumerate();
        match &mut engine.face_sums {
            None => blocks.filter(|(b, _)| inner.is_summed_in(*b, rows)).for_each(|(b, (columns, n))| {
                let mut rates = sum_block(b, n);
                deform_block(b, columns, &mut rates, &mut []);
            }),
            Some(face_sums) => {
                blocks.zip(face_sums.linear_chunks()).filter(|((b, _), _)| inner.is_summed_in(*b, rows)).for_each(
                    |((b, (columns, n)), (is_near, waits, linear))| {
                        let mut rates = sum_block(b, n);
                        if *is_near {
                            linear.copy_from_slice(&rates[..linear.len()]);
                        }
                        if !waits {
                            deform_block(b, columns, &mut rates, &mut []);
                        }
                    },
                );
                if rows.is_last() {
                    face_sums.find_excess(instructions, dimension);
                    let face_sums = &*face_sums;
                    let columns = in_blocks((l, rho, f, stretch, yielded, mu));
                    let blocks = columns.zip(face_excess.par_chunks_mut(BLOCK)).enumerate();
                    blocks.filter(|(b, _)| face_sums.waits(*b)).for_each(|(b, (columns, excess))| {
                        let (mut rates, mut taken) = ([tensor::zero(); BLOCK], [tensor::zero(); BLOCK]);
                        face_sums.rates(b, &mut rates, &mut taken);
                        deform_block(b, columns, &mut rates, &mut taken);
                        for (excess, taken) in excess.iter_mut().zip(&taken) {
                            *excess = tensor::plus(excess, dt, taken);
                        }
                    });
                }
            }
        }
        if rows.is_last() {
            engine.count_pairs();
        }
    }

    fn corrects_forces(&self, _: &CpuEngine<T>) -> bool {
        false
    }

    fn pack_volumes(&self, _: &mut CpuEngine<T>) {}

    fn correct_gradients(&self, _: &mut CpuEngine<T>) {}

    fn force_tensor(
        &self,
        particles: &Particles,
        i: usize,
        stress: SymmetricTensor<f64>,
        correction: &Tensor<f64>,
    ) -> Tensor<f64> {
        let more = tensor::plus(&particles.face_stress[i], 1.0, &particles.spring_moment[i]);
        force_tensor(stress, &particles.deformation[i], &more, correction)
    }

    fn add_forces(&self, engine: &mut CpuEngine<T>, rows: Rows) {
        engine.resist_hourglass(rows);
        engine.resist_shocks(rows);
        if let (true, Some(sums)) = (rows.is_last(), &engine.face_sums) {
            sums.share_power(&mut engine.particles.energy_rate);
        }
    }
}

/// Smallest principal stretches of particles, with SIMD.
struct SmallestStretches<'a> {
    deformation: &'a [Tensor<f64>],
    stretch: &'a mut [f64],
}

impl Job<f64> for SmallestStretches<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let (deformation, _) = self.deformation.as_flattened().as_flattened().as_chunks::<9>();
        let last = self.stretch.len().saturating_sub(1);
        let mut computed = [0.0; PAD];
        for (v, stretch) in self.stretch.chunks_mut(L::WIDTH).enumerate() {
            // Lanes beyond the last particle repeat it.
            let indices: [u32; PAD] = std::array::from_fn(|lane| (v * L::WIDTH + lane).min(last) as u32);
            // Eight at a time are transposed by shuffles.
            let [xx, xy, xz, yx, yy, yz, zx, zy]: [L; 8] = L::gather_part(deformation, &indices, 0);
            let [zz]: [L; 1] = L::gather_part(deformation, &indices, 8);
            smallest_stretch(&[[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]).store(&mut computed);
            stretch.copy_from_slice(&computed[..stretch.len()]);
        }
    }
}

/// The gradient correction of the reference configuration. Where it is left out, springs are too.
fn correct_reference<T: PairScalar>(engine: &mut CpuEngine<T>) {
    let dimension: Dimension = crate::cpu::dimension(&engine.model);
    let sweep = GradientSweep::new(&engine.records, &engine.lists, &engine.constants, engine.instructions, dimension);
    let Particles { correction, body, yielded_stretch, .. } = &mut engine.particles;
    let (body, has_come_apart) = (&*body, &engine.has_come_apart);
    let chunks = (correction.par_chunks_mut(BLOCK), yielded_stretch.par_chunks_mut(BLOCK));
    chunks.into_par_iter().enumerate().for_each(|(b, (correction, yielded))| {
        let mut sums = [GradientSum::zero(); BLOCK];
        sweep.block(b, true, &mut sums);
        for (k, b_i) in correction.iter_mut().enumerate() {
            let moment = sums[k].moment.map(|row| row.map(|v| v.to_f64()));
            *b_i = if has_come_apart[body[b * BLOCK + k] as usize] {
                correction_of_pieces(&moment, dimension)
            } else {
                reference_correction(&moment, dimension, LARGEST_COMPONENT)
            };
            if is_fit(&moment, b_i, dimension) == 0.0 {
                yielded[k] = 0.0;
            }
        }
    });
    engine.has_thin_parts = correction.par_iter().any(|b| is_thin(b) > 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Instructions;

    #[test]
    fn stretches_side_by_side_are_those_of_one_at_a_time() {
        let deformation: Vec<Tensor<f64>> = (0..BLOCK)
            .map(|k| {
                let s = |a: usize| 0.3 * ((k * 7 + a * 13) as f64).sin();
                [[1.0 + s(0), s(1), s(2)], [s(3), 0.7 + s(4), s(5)], [s(6), s(7), 1.5 + s(8)]]
            })
            .collect();
        let one_by_one: Vec<f64> = deformation.iter().map(smallest_stretch).collect();
        for instructions in Instructions::available() {
            for count in [0, 1, 3, 7, 8, 9, 17, BLOCK] {
                let mut stretch = vec![f64::NAN; count];
                run(instructions, SmallestStretches { deformation: &deformation[..count], stretch: &mut stretch });
                for (found, expected) in stretch.iter().zip(&one_by_one) {
                    // Lanes may fuse a product and a sum.
                    assert!((found - expected).abs() < 1e-14, "{instructions:?}, {count}: {found} {expected}");
                }
            }
        }
    }
}
