//! The stress of a block of particles, computed with SIMD: everything but the flow law.

use super::records::{extra, force};
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run};
use crate::model::Material;
use crate::neighbors::{BLOCK, PAD};
use sphorge_physics::hyperelastic::{composed, minus_identity, neo_hookean_deviator};
use sphorge_physics::pair::{PairForm, stress_scale};
use sphorge_physics::return_mapping::elastic_margin;
use sphorge_physics::viscosity::{
    FilteredDivergence, ViscosityParameters, bulk_viscosity, bulk_viscous_power, damping_rate, shock_share,
};
use sphorge_physics::{Dimension, SymmetricTensor, Tensor, artificial_stress, stress};

/// Input and output of the stress of a block of particles, a column for each quantity. Entries behind the last particle
/// are undefined.
pub(super) struct StressColumns {
    /// Deviator after the step, Pa.
    pub(super) deviator: [[f64; BLOCK]; 6],
    /// Of the velocity, 1/s.
    divergence: [f64; BLOCK],
    /// Of the elastic step and of the return, Pa.
    pub(super) shear_modulus: [f64; BLOCK],
    /// Yield stress of the last step, Pa, if a stress below it is known to be elastic, else zero.
    pub(super) known_yield_stress: [f64; BLOCK],
    pub(super) density: [f64; BLOCK],
    /// Specific internal energy, J/kg.
    pub(super) energy: [f64; BLOCK],
    /// Smoothing length, m; only with bulk viscosity.
    pub(super) smoothing_length: [f64; BLOCK],
    /// Part of the energy that is no energy of the metal, J/kg: work of the artificial stress, and what hourglass springs
    /// hold; zero unless temperatures follow from it.
    pub(super) numerical_energy: [f64; BLOCK],
    /// Coefficient of the artificial stress; only with one.
    pub(super) repulsion: [f64; BLOCK],
    /// At the start and at the end of the step; only where some material breaks.
    pub(super) integrity_before: [f64; BLOCK],
    pub(super) integrity: [f64; BLOCK],
    /// Of viscous pressure that is borne; only where some material breaks.
    pub(super) share: [f64; BLOCK],
    /// Of the linear bulk viscosity that acts.
    pub(super) linear_share: [f64; BLOCK],
    /// Of the viscosity of shocks that acts, if there is one.
    pub(super) shock_share: [f64; BLOCK],
    /// Density at rest, kg/m³; only where there is viscosity of shocks.
    pub(super) initial_density: [f64; BLOCK],
    pub(super) pressure: [f64; BLOCK],
    pub(super) sound_speed: [f64; BLOCK],
}

impl StressColumns {
    pub(super) fn new() -> Self {
        let zero = [0.0; BLOCK];
        Self {
            deviator: [zero; 6],
            divergence: zero,
            shear_modulus: zero,
            known_yield_stress: zero,
            density: zero,
            energy: zero,
            smoothing_length: zero,
            numerical_energy: zero,
            repulsion: zero,
            integrity_before: zero,
            integrity: zero,
            share: zero,
            linear_share: zero,
            shock_share: zero,
            initial_density: zero,
            pressure: zero,
            sound_speed: zero,
        }
    }

    /// Advances deviators by an elastic step with the shear moduli; pressure and sound speed follow from density and
    /// energy. Bit k of the result is set if this completes particle `k`; the others need the flow law.
    #[inline(always)]
    pub(super) fn take_elastic_step(
        &mut self,
        instructions: Instructions,
        materials: &[Material],
        particles: &ElasticInputs<'_>,
    ) -> u128 {
        let Some(&most) = particles.material.first() else { return 0 };
        let mut elastic = 0;
        let material = &materials[most as usize];
        run(instructions, ElasticStep { columns: self, particles, material, elastic: &mut elastic });
        // Particles of another material are few, where bodies meet.
        for (k, m) in particles.material.iter().enumerate() {
            if *m != most {
                let state = materials[*m as usize].pressure(self.density[k], self.energy[k]);
                (self.pressure[k], self.sound_speed[k]) = (state.pressure, state.sound_speed);
            }
        }
        elastic
    }

    /// Power of the bulk viscosity over the step, W, for particles of these masses (kg). A kick takes half of the step
    /// with the pressure before it and half with that after it, and the drift has the velocities of mid-step, which the
    /// divergence belongs to. `pressures`, Pa, are those before and become those after the step.
    pub(super) fn viscous_power(
        &self,
        parameters: ViscosityParameters<f64>,
        form: &StressForm,
        masses: &[f64],
        pressures: &mut [f64],
    ) -> f64 {
        let mut power = 0.0;
        for (k, (mass, pressure)) in masses.iter().zip(pressures).enumerate() {
            let (divergence, density) = (self.divergence[k], self.density[k]);
            let share = if form.breaks { self.share[k] } else { 1.0 };
            let parameters = ViscosityParameters { alpha: self.linear_share[k] * parameters.alpha, ..parameters };
            let q =
                share * bulk_viscosity(parameters, divergence, density, self.sound_speed[k], self.smoothing_length[k]);
            power += mass * bulk_viscous_power(0.5 * (*pressure + q), divergence, density);
            *pressure = q;
        }
        power
    }

    /// Finds the shares of the linear bulk viscosity that act, and filters the divergences on, once and twice. It acts on `all` waves of some particles.
    pub(super) fn find_short_waves(
        &mut self,
        dt: f64,
        filtered: (&mut [f64], &mut [f64]),
        all: impl Fn(usize) -> bool,
    ) {
        for (k, (once, twice)) in filtered.0.iter_mut().zip(filtered.1).enumerate() {
            let tau = self.smoothing_length[k] / self.sound_speed[k];
            let (after, share) = FilteredDivergence { once: *once, twice: *twice }.after(self.divergence[k], dt, tau);
            (*once, *twice) = (after.once, after.twice);
            self.linear_share[k] = if all(k) { 1.0 } else { share };
        }
    }

    /// Finds the shares of the viscosity of shocks that act, and how fast all viscosity damps particles, 1/s. `inputs` have smoothing lengths at rest, the columns
    /// compressed ones.
    pub(super) fn find_shocks(
        &mut self,
        form: &StressForm,
        parameters: ViscosityParameters<f64>,
        inputs: &ElasticInputs<'_>,
        rates: &mut [f64],
    ) {
        for (k, rate) in rates.iter_mut().enumerate() {
            let (c, h, initial) = (self.sound_speed[k], self.smoothing_length[k], inputs.smoothing_length[k]);
            let share = form.shocks.map_or(1.0, |_| shock_share(&inputs.velocity_gradient[k], c, h));
            self.shock_share[k] = share;
            let mu = h * (-self.divergence[k]).max(0.0);
            *rate = damping_rate(parameters, form.shocks.unwrap_or(0.0), share, c, mu, h, initial);
        }
    }

    /// Deviator of particle `k`.
    #[inline(always)]
    pub(super) fn deviator_of(&self, k: usize) -> SymmetricTensor<f64> {
        let c = &self.deviator;
        SymmetricTensor::from_array([c[0][k], c[1][k], c[2][k], c[3][k], c[4][k], c[5][k]])
    }

    #[inline(always)]
    pub(super) fn set_deviator(&mut self, k: usize, deviator: SymmetricTensor<f64>) {
        for (column, value) in self.deviator.iter_mut().zip(deviator.to_array()) {
            column[k] = value;
        }
    }
}

/// Input of an elastic step from the columns of the particles.
pub(super) struct ElasticInputs<'a> {
    pub(super) material: &'a [u32],
    pub(super) deviator: &'a [SymmetricTensor<f64>],
    pub(super) velocity_gradient: &'a [Tensor<f64>],
    /// m.
    pub(super) smoothing_length: &'a [f64],
    /// Deformation gradients of the reference configuration and of the one before a renewal; empty where there is none.
    pub(super) deformation: &'a [Tensor<f64>],
    pub(super) earlier_deformation: &'a [Tensor<f64>],
    /// Length of the step, s.
    pub(super) dt: f64,
}

impl ElasticInputs<'_> {
    /// Replaces the deviators of particles whose material has them from the deformation, not from a rate.
    #[inline(always)]
    pub(super) fn set_hyperelastic(&self, materials: &[Material], columns: &mut StressColumns) {
        if !materials.iter().any(|material| material.flow_law.is_hyperelastic()) {
            return;
        }
        for (k, (material, f)) in self.material.iter().zip(self.deformation).enumerate() {
            if materials[*material as usize].flow_law.is_hyperelastic() {
                let since = minus_identity(f);
                let earlier = self.earlier_deformation.get(k).map(minus_identity);
                let h = earlier.map_or(since, |earlier| composed(&since, &earlier));
                columns.set_deviator(k, neo_hookean_deviator(&h, columns.shear_modulus[k]));
            }
        }
    }

    /// Deviators and velocity gradients from particle `k` on; lanes beyond the last particle repeat it.
    #[inline(always)]
    fn lanes<L: Lanes<Element = f64>>(&self, k: usize) -> (SymmetricTensor<L>, Tensor<L>) {
        let last = self.deviator.len() - 1;
        let mut indices = [0; PAD];
        let mut s = [[0.0; PAD]; 6];
        for lane in 0..L::WIDTH {
            let i = (k + lane).min(last);
            indices[lane] = i as u32;
            let deviator = self.deviator[i].to_array();
            for c in 0..6 {
                s[c][lane] = deviator[c];
            }
        }
        let mut deviator = [L::zero(); 6];
        for c in 0..6 {
            deviator[c] = L::load(&s[c]);
        }
        let (gradients, _) = self.velocity_gradient.as_flattened().as_flattened().as_chunks::<9>();
        // Eight at a time are transposed by shuffles.
        let [xx, xy, xz, yx, yy, yz, zx, zy]: [L; 8] = L::gather_part(gradients, &indices, 0);
        let [zz]: [L; 1] = L::gather_part(gradients, &indices, 8);
        (SymmetricTensor::from_array(deviator), [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]])
    }
}

/// The elastic step of particles of one material.
struct ElasticStep<'a> {
    columns: &'a mut StressColumns,
    particles: &'a ElasticInputs<'a>,
    material: &'a Material,
    elastic: &'a mut u128,
}

impl Job<f64> for ElasticStep<'_> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let columns = self.columns;
        let dt = L::splat(self.particles.dt);
        let law = self.material.bounded_pressure::<L>();
        let mut elastic = 0;
        for k in (0..self.particles.deviator.len()).step_by(L::WIDTH) {
            let (last, l) = self.particles.lanes::<L>(k);
            let trial = stress::trial_deviator(last, &l, L::load(&columns.shear_modulus[k..]), dt);
            let components = trial.to_array();
            for c in 0..6 {
                components[c].store(&mut columns.deviator[c][k..]);
            }
            (l[0][0] + l[1][1] + l[2][2]).store(&mut columns.divergence[k..]);
            let margin = elastic_margin(trial, L::load(&columns.known_yield_stress[k..]));
            elastic |= u128::from(L::less(L::zero(), margin)) << k;
            let state = law.at(L::load(&columns.density[k..]), L::load(&columns.energy[k..]));
            state.pressure.store(&mut columns.pressure[k..]);
            state.sound_speed.store(&mut columns.sound_speed[k..]);
        }
        *self.elastic = elastic;
    }
}

/// Options of the stress data for the force sum.
#[derive(Clone, Copy)]
pub(super) struct StressForm {
    pub(super) pair_form: PairForm,
    /// If viscosity is a pressure of the particle.
    pub(super) bulk_viscosity: Option<ViscosityParameters<f64>>,
    /// Strength of the viscosity of shocks, if there is one.
    pub(super) shocks: Option<f64>,
    /// Whether there is artificial stress.
    pub(super) artificial_stress: bool,
    /// Whether some material loses its integrity.
    pub(super) breaks: bool,
    pub(super) dimension: Dimension,
}

/// Scaled Cauchy stress from deviator and pressure, and its artificial stress, written to the records of the force sum.
pub(super) struct PackStress<'a, T> {
    pub(super) columns: &'a StressColumns,
    pub(super) form: StressForm,
    pub(super) records: &'a mut [[T; force::LEN]],
    pub(super) extras: &'a mut [[T; extra::LEN]],
}

impl<T: PairScalar> Job<f64> for PackStress<'_, T> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let Self { columns, form, records, extras } = self;
        for k in (0..records.len()).step_by(L::WIDTH) {
            let (density, sound_speed) = (L::load(&columns.density[k..]), L::load(&columns.sound_speed[k..]));
            let mut pressure = L::load(&columns.pressure[k..]);
            if let Some(p) = form.bulk_viscosity {
                let alpha = L::load(&columns.linear_share[k..]) * L::splat(p.alpha);
                let p = ViscosityParameters { alpha, beta: L::splat(p.beta) };
                let (divergence, h) = (L::load(&columns.divergence[k..]), L::load(&columns.smoothing_length[k..]));
                let viscous = bulk_viscosity(p, divergence, density, sound_speed, h);
                pressure += if form.breaks { viscous * L::load(&columns.share[k..]) } else { viscous };
            }
            let mut deviator = [L::zero(); 6];
            for c in 0..6 {
                deviator[c] = L::load(&columns.deviator[c][k..]);
            }
            let cauchy = SymmetricTensor::from_array(deviator) - SymmetricTensor::isotropic(pressure);
            let sigma = cauchy * stress_scale(form.pair_form, density);
            let [xx, yy, zz, xy, yz, xz] = sigma.to_array();
            // Of the sound speed only viscosity of pairs has use, and of shocks as much as acts.
            let last = match form.shocks {
                None => sound_speed,
                Some(_) => {
                    let acts =
                        sound_speed * L::load(&columns.initial_density[k..]) * L::load(&columns.shock_share[k..]);
                    if form.breaks { acts * L::load(&columns.share[k..]) } else { acts }
                }
            };
            // In the order of the record from its stress on.
            L::store_part([xx, yy, zz, xy, yz, xz, density, last], &mut records[k..], force::S);
            if form.artificial_stress {
                let r = artificial_stress::artificial_stress(sigma, L::load(&columns.repulsion[k..]), form.dimension);
                let [xx, yy, zz, xy, yz, xz] = r.to_array();
                L::store_part([xx, yy, zz, xy, yz, xz, L::zero(), L::zero()], &mut extras[k..], extra::R);
            }
        }
    }
}

// Eight entries are written at a time.
const _: () = assert!(force::S + 6 == force::RHO && force::RHO + 1 == force::C && force::LEN == force::S + 8);
const _: () = assert!(extra::R == 0 && extra::LEN == 8);
