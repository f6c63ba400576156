//! The total Lagrangian form: sums over the initial neighbours at the initial positions `X`.
//!
//! With the kernel gradient `grad_0 W` of the initial positions, corrected by `B_i` so that it is exact for linear fields, and
//! initial volumes `V` (Bonet & Kulasegaram 2000; Ganzenmüller 2015):
//!
//! `dF_i/dt = sum_j V_j (v_j - v_i) ⊗ B_i grad_0 W_ij`,  `L = dF/dt F^-1`,  `rho = rho_0 / det F`,
//! `m_i dv_i/dt = sum_j V_i V_j (P_i B_i + P_j B_j) grad_0 W_ij`,  `P = det F sigma F^-T`.
//!
//! The Cauchy stress follows from `L` by the same laws as in the other form. Both sums are adjoint, so energy is conserved.
//! There is no tensile instability: artificial stress, XSPH and density restoration are left out. Viscosity is a pressure of
//! the particle, `q = rho (alpha c h |tr L| + beta (h tr L)^2) / 2` in compression (von Neumann & Richtmyer 1950): a viscosity of
//! pairs at initial positions would brake rigid rotation. Other bodies are not seen.

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
use sphorge_physics::{Dimension, Real, SymmetricTensor, Tensor, Vector, gradient_correction, tensor};
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
            9.0 * bulk * shear / (3.0 * bulk + shear)
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
    pub(super) fn force_tensor(&self, i: usize, stress: &SymmetricTensor<f64>, b: &Tensor<f64>) -> Tensor<f64> {
        let f = &self.deformation[i];
        let j = tensor::determinant(f);
        let first_piola = tensor::multiply(&stress.to_tensor(), &tensor::transpose(&tensor::inverse(f)));
        tensor::multiply(&first_piola.map(|row| row.map(|p| j * p)), b)
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

/// Bulk viscosity, Pa; zero in expansion.
#[inline(always)]
pub(super) fn bulk_viscosity<T: Real>(alpha: T, beta: T, divergence: T, density: T, sound_speed: T, h: T) -> T {
    let rate = h * (-divergence).max(T::zero());
    T::of(0.5) * density * (alpha * sound_speed * rate + beta * rate * rate)
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
                        let middle = plus(&f[k], 0.5 * dt, &rate);
                        l[k] = tensor::multiply(&rate, &tensor::inverse(&middle));
                        f[k] = plus(&f[k], dt, &rate);
                        rho[k] = mass[i] / (volume[i] * tensor::determinant(&f[k]));
                        n[k] = sums[k].inside;
                        mu[k] = h[i] * (l[k][0][0] + l[k][1][1] + l[k][2][2]).abs();
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

/// `a + s b`.
#[inline(always)]
fn plus(a: &Tensor<f64>, s: f64, b: &Tensor<f64>) -> Tensor<f64> {
    let mut sum = *a;
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += s * b[i][j];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bulk_viscosity_by_hand_and_none_in_expansion() {
        // 0.5 8000 (0.5 4000 0.01 100 + 2 (0.01 100)^2) = 4000 (2000 + 2).
        assert!((bulk_viscosity(0.5, 2.0, -100.0, 8000.0, 4000.0, 0.01) - 8.008e6).abs() < 1e-6);
        assert_eq!(bulk_viscosity(0.5, 2.0, 100.0, 8000.0, 4000.0, 0.01), 0.0);
    }

    #[test]
    fn the_first_piola_stress_of_uniaxial_tension_is_force_over_initial_area() {
        let particles = Particles::new(1);
        let mut reference = Reference {
            position: particles.position.clone(),
            volume: vec![0.5],
            deformation: vec![tensor::identity()],
            young_modulus: Vec::new(),
            corrected: true,
        };
        // Stretched by 1.2 along x, thinned to 0.9 and 0.8 across: the area is 0.72 of the initial one.
        reference.deformation[0] = [[1.2, 0.0, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 0.8]];
        let stress = SymmetricTensor { xx: 500.0, ..SymmetricTensor::zero() };
        let p = reference.force_tensor(0, &stress, &tensor::identity());
        assert!((p[0][0] - 360.0).abs() < 1e-9, "{p:?}");
        // A simple shear moves no normal force but tilts the face it acts on: P = J sigma F^-T.
        reference.deformation[0] = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let p =
            reference.force_tensor(0, &SymmetricTensor { xy: 100.0, ..SymmetricTensor::zero() }, &tensor::identity());
        assert!((p[0][0] + 50.0).abs() < 1e-9 && (p[0][1] - 100.0).abs() < 1e-9 && (p[1][0] - 100.0).abs() < 1e-9);
    }
}
