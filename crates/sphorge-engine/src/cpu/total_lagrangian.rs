//! The total Lagrangian form: sums over the initial neighbours at the initial positions `X`, whose formulas are those of
//! [`sphorge_physics::total_lagrangian`].
//!
//! The Cauchy stress follows from the velocity gradient by the same laws as in the other form. There is no tensile instability:
//! artificial stress, XSPH and density restoration are left out. Viscosity is a pressure of the particle: a viscosity of pairs at
//! initial positions would brake rigid rotation. Other bodies are not seen.

use super::kinematics::{GradientJob, GradientSum};
use super::records::kinematic;
use super::sweeps::dispatch_sweep;
use super::{CpuEngine, Work};
use crate::lanes::{PairScalar, run};
use crate::model::{Material, Model};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::pair::PairForm;
use sphorge_physics::total_lagrangian::{deform, density as density_of, first_piola, young_modulus};
use sphorge_physics::viscosity::bulk_mu;
use sphorge_physics::{Dimension, SymmetricTensor, Tensor, Vector, gradient_correction, tensor};
use std::sync::Arc;

/// The initial configuration, and how far the material is from it.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// Initial positions, m.
    pub(super) position: Vec<Vector<f64>>,
    /// Initial volumes, m³ (m² in plane strain, m in one dimension).
    pub(super) volume: Vec<f64>,
    /// Deformation gradient F.
    pub(super) deformation: Vec<Tensor<f64>>,
    /// Young's modulus of each material at rest, Pa.
    pub(super) young_modulus: Vec<f64>,
    /// Gradient correction B is known.
    pub(super) corrected: bool,
}

impl Reference {
    pub(super) fn new(particles: &Particles, model: &Model) -> Self {
        let young = |m: &Material| {
            let c = m.equation_of_state.pressure(m.density, 0.0).sound_speed;
            let (bulk, shear) = (m.density * c * c, m.shear_modulus);
            young_modulus(bulk, shear)
        };
        Self {
            position: particles.position.clone(),
            volume: particles.mass.iter().zip(&particles.density).map(|(m, rho)| m / rho).collect(),
            deformation: vec![tensor::identity(); particles.len()],
            young_modulus: model.materials.iter().map(young).collect(),
            corrected: false,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.position.len() * (size_of::<Vector<f64>>() + size_of::<f64>() + size_of::<Tensor<f64>>())
    }

    /// The stress whose sum at initial positions is the force, `P B`; `stress` is Cauchy's, Pa.
    #[inline(always)]
    pub(super) fn force_tensor(&self, i: usize, stress: SymmetricTensor<f64>, b: &Tensor<f64>) -> Tensor<f64> {
        tensor::multiply(&first_piola(stress, &self.deformation[i]), b)
    }
}

/// The model with what the form does without taken out.
pub(super) fn without_pair_terms(model: &Arc<Model>) -> Arc<Model> {
    let mut model = Model::clone(model);
    let numerics = &mut model.numerics;
    numerics.artificial_stress = None;
    numerics.xsph = 0.0;
    numerics.balsara = false;
    numerics.mls_interval = None;
    numerics.pair_form = PairForm::VolumeWeighted;
    Arc::new(model)
}

impl<T: PairScalar> CpuEngine<T> {
    /// Deformation gradient, velocity gradient and density.
    pub(super) fn sum_reference_gradients(&mut self) {
        let Some(mut reference) = self.reference.take() else { return };
        self.pack_reference(&reference);
        if !reference.corrected {
            self.correct_reference(&reference);
            reference.corrected = true;
        }
        let dimension = super::dimension(&self.model);
        let dt = self.step.dt;
        dispatch_sweep!(dimension, false, |D, CORRECTED| {
            let (records, constants) = (&self.records.kinematic, &self.constants);
            let (list, instructions) = (&self.lists.list, self.instructions);
            let Work { correction, mu, .. } = &mut self.work;
            let correction = &*correction;
            let Particles { velocity_gradient, neighbors, density, mass, smoothing_length, .. } = &mut self.particles;
            let (mass, volume, h) = (&*mass, &reference.volume, &*smoothing_length);
            (
                velocity_gradient.par_chunks_mut(BLOCK),
                neighbors.par_chunks_mut(BLOCK),
                density.par_chunks_mut(BLOCK),
                reference.deformation.par_chunks_mut(BLOCK),
                mu.par_chunks_mut(BLOCK),
            )
                .into_par_iter()
                .enumerate()
                .for_each(|(b, (l, n, rho, f, mu))| {
                    let mut sums = [GradientSum::zero(); BLOCK];
                    let block = &list.blocks()[b];
                    let job = GradientJob::<T, D, CORRECTED> {
                        records,
                        first: b * BLOCK,
                        block,
                        stored: None,
                        constants,
                        sums: &mut sums,
                    };
                    run(instructions, job);
                    for k in 0..l.len() {
                        let i = b * BLOCK + k;
                        let sum = sums[k].gradient.map(|row| row.map(|v| v.to_f64()));
                        let rate = tensor::multiply(&sum, &tensor::transpose(&correction[i]));
                        l[k] = deform(&mut f[k], &rate, dt);
                        rho[k] = density_of(mass[i], volume[i], &f[k]);
                        n[k] = sums[k].inside;
                        mu[k] = bulk_mu(&l[k], h[i]);
                    }
                });
        });
        self.reference = Some(reference);
        self.step.pairs = self.particles.neighbors.iter().map(|&n| u64::from(n)).sum();
    }

    /// Velocities at initial positions, with initial volumes for weights.
    fn pack_reference(&mut self, reference: &Reference) {
        let count = self.particles.len();
        self.records.resize(count + self.halo.ghosts.len(), false, true);
        let frame = self.records.frame;
        let Particles { velocity, smoothing_length, .. } = &self.particles;
        self.records.kinematic[..count].par_iter_mut().enumerate().for_each(|(i, record)| {
            let x = frame.encode::<T>(&reference.position[i]);
            for a in 0..3 {
                record[kinematic::X + a] = x[a];
                record[kinematic::V + a] = T::of(velocity[i][a]);
            }
            record[kinematic::WEIGHT] = T::of(reference.volume[i]);
            record[kinematic::H] = T::of(smoothing_length[i]);
        });
        self.halo.exchange_kinematics(count, |i| reference.position[i], &mut self.records);
    }

    /// The gradient correction of the initial configuration.
    fn correct_reference(&mut self, reference: &Reference) {
        let dimension: Dimension = super::dimension(&self.model);
        debug_assert_eq!(reference.position.len(), self.particles.len());
        dispatch_sweep!(dimension, true, |D, CORRECTED| {
            let (records, constants) = (&self.records.kinematic, &self.constants);
            let (list, instructions) = (&self.lists.list, self.instructions);
            self.work.correction.par_chunks_mut(BLOCK).enumerate().for_each(|(b, correction)| {
                let mut sums = [GradientSum::zero(); BLOCK];
                let block = &list.blocks()[b];
                let job = GradientJob::<T, D, CORRECTED> {
                    records,
                    first: b * BLOCK,
                    block,
                    stored: None,
                    constants,
                    sums: &mut sums,
                };
                run(instructions, job);
                for (k, b_i) in correction.iter_mut().enumerate() {
                    let moment = sums[k].moment.map(|row| row.map(|v| v.to_f64()));
                    *b_i = gradient_correction::gradient_correction(&moment, dimension);
                }
            });
        });
    }
}
