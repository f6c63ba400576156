//! The pair sums of both papers, as they are printed, and the stress between them.

use super::Oracle;
use super::pairs::{apply, minus, plus};
use sphorge_engine::model::{Formulation, GradientCorrection, Integrator, Material, TemperatureSource};
use sphorge_physics::damage::Before as DamageBefore;
use sphorge_physics::eos::PressureState;
use sphorge_physics::gradient_correction::{LARGEST_COMPONENT, gradient_correction};
use sphorge_physics::hourglass::{Counted, Spring, is_fit};
use sphorge_physics::hyperelastic::{minus_identity, neo_hookean_deviator};
use sphorge_physics::integrity::{Borne, smeared_width};
use sphorge_physics::moving_least_squares::Moments;
use sphorge_physics::pair::{
    EnergySplit, PairForm, gradient_factor, gradient_weight, inverse_density_mean, mean, momentum_weight,
    scaled_pressure, stress_scale,
};
use sphorge_physics::return_mapping::return_mapping;
use sphorge_physics::stress::{density_after, predicted_density, trial_deviator};
use sphorge_physics::tensor::{dot, identity, inverse, multiply, transpose};
use sphorge_physics::thin::{Across, completed_rate, correction_of_pieces, is_thin, reference_correction};
use sphorge_physics::total_lagrangian::{deform, density, first_piola, is_stretched, smallest_stretch};
use sphorge_physics::viscosity::{
    ViscosityParameters, balsara, bulk_mu, bulk_viscosity, viscosity_mu, viscous_pressure,
};
use sphorge_physics::{SymmetricTensor, Tensor, Vector, artificial_stress, heat, tensor};

/// `t += s a ⊗ b`.
fn add_dyad(t: &mut Tensor<f64>, s: f64, a: Vector<f64>, b: Vector<f64>) {
    for k in 0..3 {
        t[k] = plus(t[k], s * a[k], b);
    }
}

impl Oracle {
    /// Strength of the hourglass springs where the sums are those of the total Lagrangian form.
    pub(crate) fn total_lagrangian(&self) -> Option<f64> {
        match self.model.formulation {
            Formulation::UpdatedLagrangian => None,
            Formulation::TotalLagrangian { hourglass, .. } => Some(hourglass),
        }
    }

    fn is_corrected(&self) -> bool {
        self.total_lagrangian().is_some() || self.model.numerics.gradient_correction == GradientCorrection::Linear
    }

    /// Bodies with a particle that is stretched beyond the bound take their present configuration for the one of the sums, and from then on
    /// whenever one is stretched or pressed by a factor of two. Whether there was one.
    pub(crate) fn renew(&mut self) -> bool {
        let Formulation::TotalLagrangian { renewal: Some(bound), .. } = self.model.formulation else { return false };
        let body = |i: usize| self.p.body[i] as usize;
        let too_far = |i: usize| {
            let (f, m) = (&self.deformation[i], &self.model.materials[self.model.bodies[body(i)].material]);
            if self.has_come_apart[body(i)] {
                return is_stretched(f, 2.0) || smallest_stretch(f) < 0.5;
            }
            // A liquid comes apart at a stretch of four.
            let (rho, cp, t0) = (self.p.density[i], m.specific_heat, m.reference_temperature);
            let elastic = m.elastic_energy(self.p.deviator[i], m.shear_modulus, rho);
            let stored = (1.0 - m.taylor_quinney) * self.p.plastic_work[i];
            let cold = m.cold_energy(&m.cold_energies(), rho, self.integrity[i]);
            let of_energy = heat::temperature_from_energy(t0, self.p.energy[i], cold, elastic, stored, cp);
            let is_liquid = match m.flow_law.melting_temperature() {
                Some(melting) => self.p.temperature[i].max(if m.heats() { of_energy } else { t0 }) >= melting,
                None => !m.flow_law.has_shear(),
            };
            is_stretched(f, if is_liquid { bound.min(4.0) } else { bound })
        };
        let due = |b: usize| (0..self.p.len()).any(|i| body(i) == b && too_far(i));
        let due: Vec<bool> = (0..self.has_come_apart.len()).map(due).collect();
        if due.contains(&true) {
            self.wrap();
        }
        for i in (0..self.p.len()).filter(|&i| due[self.p.body[i] as usize]).collect::<Vec<_>>() {
            // Deformation is that of the start of the step, and so are these places.
            self.searched_at[i] = plus(self.p.position[i], -self.dt, self.p.velocity[i]);
            self.initial_volume[i] = self.p.mass[i] / self.p.density[i];
            self.earlier_deformation[i] = multiply(&self.deformation[i], &self.earlier_deformation[i]);
            self.deformation[i] = identity();
            (self.yielded_stretch[i], self.spring_misfit[i], self.spring_moment[i]) = (1.0, 0.0, tensor::zero());
            if let Some(excess) = self.faces.excess.get_mut(i) {
                *excess = tensor::zero();
            }
        }
        for (apart, due) in self.has_come_apart.iter_mut().zip(&due) {
            *apart |= due;
        }
        due.contains(&true)
    }

    /// `B_i`, the inverse of `g_i sum_j w_j (x_j - x_i) ⊗ grad_i W_ij`, and whether it is that.
    fn correction_of(&self, i: usize, g: f64, weight: &[f64], at: &[Vector<f64>]) -> (Tensor<f64>, bool) {
        let mut moment = tensor::zero();
        for n in self.pairs(i, at) {
            add_dyad(&mut moment, -g * weight[n.j] * n.f, n.x, n.x);
        }
        let is_apart = self.has_come_apart[self.p.body[i] as usize];
        let correction = if self.total_lagrangian().is_none() {
            gradient_correction(&moment, self.dimension, LARGEST_COMPONENT)
        } else if is_apart {
            correction_of_pieces(&moment, self.dimension)
        } else {
            reference_correction(&moment, self.dimension, LARGEST_COMPONENT)
        };
        (correction, is_fit(&moment, &correction, self.dimension) > 0.0)
    }

    /// `L_i = g_i sum_j w_j (v_j - v_i) ⊗ B_i grad_i W_ij` and `drho/dt = -rho tr L`, at the middle of the step.
    pub(crate) fn sum_gradients(&mut self) {
        let (numerics, half) = (self.model.numerics.clone(), 0.5 * self.dt);
        let form = numerics.pair_form;
        let drifted = |i: usize| plus(self.p.position[i], -half, self.drift_velocity(i, self.p.velocity[i]));
        let at = self.places(match numerics.integrator {
            Integrator::Leapfrog => (0..self.p.len()).map(drifted).collect(),
            Integrator::PredictorCorrector => self.p.position.clone(),
        });
        let rho: Vec<f64> = self.each(|i| predicted_density(self.p.density[i], &self.p.velocity_gradient[i], half));
        self.weight = match self.total_lagrangian() {
            Some(_) => self.initial_volume.clone(),
            None => self.each(|i| gradient_weight(form, self.p.mass[i], rho[i])),
        };
        if self.is_corrected() && (self.total_lagrangian().is_none() || std::mem::take(&mut self.is_renewed)) {
            let corrections = self.each(|i| self.correction_of(i, gradient_factor(form, rho[i]), &self.weight, &at));
            for (i, (correction, is_fit)) in corrections.into_iter().enumerate() {
                self.correction[i] = correction;
                if !is_fit {
                    self.yielded_stretch[i] = 0.0;
                }
            }
            self.find_faces_of_sums(&at);
        }
        let mut gradients = self.each(|i| {
            let mut sum = tensor::zero();
            for n in self.pairs(i, &at) {
                let v = minus(n.image.vector(self.p.velocity[n.j]), self.p.velocity[i]);
                add_dyad(&mut sum, gradient_factor(form, rho[i]) * self.weight[n.j] * n.f, v, n.x);
            }
            multiply(&sum, &transpose(&self.correction[i]))
        });
        let is_quadratic = self.model.formulation.is_quadratic_at_faces();
        if is_quadratic {
            (self.faces.taken, self.faces.linear) = (self.taken_at_faces(&gradients), gradients.clone());
            gradients = self.without_excess(gradients);
        }
        let support = numerics.kernel.support();
        self.p.neighbors = self.each(|i| self.pairs(i, &at).filter(|n| n.r < support * n.h).count() as u32);
        let step = self.dt_to_evaluation();
        for (i, mut gradient) in gradients.into_iter().enumerate() {
            if self.total_lagrangian().is_some() {
                if is_thin(&self.correction[i]) > 0.0 {
                    let p = &self.p;
                    let across = Across {
                        bulk_modulus: p.density[i] * p.sound_speed[i].powi(2),
                        shear_modulus: self.material(i).shear_modulus,
                        stress: p.deviator[i] - SymmetricTensor::isotropic(p.pressure[i]),
                    };
                    gradient = completed_rate(&self.deformation[i], &gradient, &self.correction[i], &across, self.dt);
                }
                if self.material(i).deletes() && self.integrity[i] == 0.0 {
                    // It keeps its deformation.
                    gradient = tensor::zero();
                    self.yielded_stretch[i] = 0.0;
                    if is_quadratic {
                        self.faces.taken[i] = tensor::zero();
                    }
                }
                if is_quadratic {
                    self.faces.excess[i] = tensor::plus(&self.faces.excess[i], self.dt, &self.faces.taken[i]);
                }
                if self.material(i).is_brittle() {
                    // Springs have the root of it.
                    self.yielded_stretch[i] = self.yielded_stretch[i].min(self.integrity[i].powi(64));
                }
                let l = deform(&mut self.deformation[i], &gradient, self.dt);
                self.p.velocity_gradient[i] = l;
                self.p.density[i] = density(self.p.mass[i], self.initial_volume[i], &self.deformation[i]);
                let stretch = smallest_stretch(&self.deformation[i]);
                self.mu[i] = bulk_mu(&l, self.p.smoothing_length[i] * stretch);
                if self.p.plastic_strain_increment[i] > 0.0 {
                    self.yielded_stretch[i] = self.yielded_stretch[i].min(stretch);
                }
            } else {
                self.p.velocity_gradient[i] = gradient;
                self.p.density[i] = density_after(self.p.density[i], &gradient, step);
            }
        }
    }

    /// `rho_i = sum_j m_j (beta_0 + beta . x_ij) W_ij` over the body of the particle.
    pub(crate) fn restore(&mut self) {
        let p = &self.p;
        let restored = self.each(|i| {
            let own = self.model.numerics.kernel.value(self.dimension, 0.0, p.smoothing_length[i]);
            let neighbours = || {
                let same = self.pairs(i, &p.position).filter(|n| p.body[n.j] == p.body[i]);
                same.map(|n| (n.j, n.x, n.w)).chain([(i, [0.0; 3], own)])
            };
            let mut moments = Moments::default();
            neighbours().for_each(|(j, x, w)| moments.add(x, p.mass[j] / p.density[j] * w));
            let Some(beta) = moments.solve(p.smoothing_length[i], self.dimension) else { return p.density[i] };
            let sum: f64 = neighbours().map(|(j, x, w)| p.mass[j] * beta.factor(x) * w).sum();
            if sum > 0.0 { sum } else { p.density[i] }
        });
        for (i, rho) in restored.into_iter().enumerate() {
            let old = std::mem::replace(&mut self.p.density[i], rho);
            self.ledger.mls_energy += self.p.mass[i] * self.p.pressure[i] * (rho - old) / (rho * old);
            self.base_density[i] = density_after(rho, &self.p.velocity_gradient[i], -0.5 * self.dt);
        }
    }

    /// Velocity gradients in the total Lagrangian form at the velocities at which forces are evaluated; of thin parts, which lack that across
    /// them, those of the middle of the step.
    pub(crate) fn evaluated_gradients(&self) -> Vec<Tensor<f64>> {
        let at = self.places(self.p.position.clone());
        let mut sums = self.each(|i| {
            let mut sum = tensor::zero();
            for n in self.pairs(i, &at) {
                let v = minus(n.image.vector(self.evaluated[n.j]), self.evaluated[i]);
                add_dyad(&mut sum, self.weight[n.j] * n.f, v, n.x);
            }
            multiply(&sum, &transpose(&self.correction[i]))
        });
        if self.model.formulation.is_quadratic_at_faces() {
            sums = self.without_excess(sums);
        }
        self.each(|i| match is_thin(&self.correction[i]) > 0.0 {
            true => self.p.velocity_gradient[i],
            false => multiply(&sums[i], &inverse(&self.deformation[i])),
        })
    }

    /// The correction where forces are evaluated, if that is not where the velocity gradient was.
    pub(crate) fn correct_forces(&mut self) {
        let numerics = &self.model.numerics;
        let moved = numerics.integrator == Integrator::Leapfrog && self.dt > 0.0;
        if moved && self.is_corrected() && self.total_lagrangian().is_none() {
            let (form, p) = (numerics.pair_form, &self.p);
            let weight = self.each(|i| gradient_weight(form, p.mass[i], p.density[i]));
            let at = self.places(p.position.clone());
            self.correction = self.each(|i| self.correction_of(i, gradient_factor(form, p.density[i]), &weight, &at).0);
        }
    }

    pub(crate) fn material(&self, i: usize) -> &Material {
        &self.model.materials[self.p.material[i] as usize]
    }

    /// Shear modulus in the state of the particle at a density and a pressure.
    pub(crate) fn shear_modulus(&self, i: usize, density: f64, pressure: f64) -> f64 {
        let (m, p) = (self.material(i), &self.p);
        m.flow_law
            .shear_modulus(m.shear_modulus, m.flow_state(p.plastic_strain[i], p.temperature[i], density, pressure))
    }

    /// Trial stress, equation of state, return mapping over a time `dt`; what flows counts only if `commit`. The deviator.
    fn flow(&mut self, i: usize, (energy, artificial): (f64, f64), dt: f64, commit: bool) -> SymmetricTensor<f64> {
        let (model, source) = (self.model.clone(), self.model.numerics.temperature);
        let m = &model.materials[self.p.material[i] as usize];
        let rho = self.p.density[i];
        let whole = m.pressure(rho, energy);
        let shear = self.shear_modulus(i, rho, whole.pressure.max(-m.spall_pressure));
        let before = self.integrity[i];
        let size = smeared_width(model.numerics.kernel.support(), self.p.smoothing_length[i]);
        let mut borne = m.borne(rho, whole.pressure, before, size);
        if m.damage.is_some() {
            // Whole until the end of the step.
            let spalls = whole.pressure < -m.spall_pressure;
            let integrity = if spalls { borne.integrity } else { before };
            borne = Borne { pressure: whole.pressure.max(-m.spall_pressure), integrity, share: 1.0 };
        }
        let state = PressureState { pressure: borne.pressure, ..whole };
        self.share[i] = borne.share;
        let p = &mut self.p;
        (p.pressure[i], p.sound_speed[i]) = (state.pressure, state.sound_speed);
        // A particle of that integrity bears the stress of whole material times it.
        let of_whole = if before > 0.0 { p.deviator[i] * (1.0 / before) } else { SymmetricTensor::zero() };
        let trial = if m.flow_law.is_hyperelastic() {
            let f = multiply(&self.deformation[i], &self.earlier_deformation[i]);
            neo_hookean_deviator(&minus_identity(&f), shear)
        } else {
            trial_deviator(of_whole, &p.velocity_gradient[i], shear, dt)
        };
        let state = m.flow_state(p.plastic_strain[i], p.temperature[i], rho, state.pressure);
        let history = &mut self.history[i];
        let sound_speed = whole.sound_speed;
        let bear = |p: &mut f64, share: &mut f64, integrity: f64| {
            if let Some(damage) = m.damage {
                [*p, *share] = damage.after.bears(*p, integrity);
            }
        };
        if before == 0.0 {
            bear(&mut p.pressure[i], &mut self.share[i], 0.0);
            if commit {
                p.deviator[i] = SymmetricTensor::zero();
                (p.plastic_strain_increment[i], p.yield_stress[i]) = (0.0, 0.0);
                if source == TemperatureSource::Energy {
                    let stored = (1.0 - m.taylor_quinney) * p.plastic_work[i];
                    let (cold, heat) = (m.cold_energy(&m.cold_energies(), rho, 0.0), energy - artificial);
                    let (t0, cp) = (m.reference_temperature, m.specific_heat);
                    p.temperature[i] = heat::temperature_from_energy(t0, heat, cold, 0.0, stored, cp);
                }
            }
            return SymmetricTensor::zero();
        }
        let after = return_mapping(m.return_rule, &m.flow_law, shear, trial, state, history, dt);
        // While a crack opens the solid is not sheared more than before.
        let opened = match m.opens_without_shear() && borne.integrity < before {
            true => {
                (of_whole.double_dot(of_whole) / after.deviator.double_dot(after.deviator).max(1e-38)).sqrt().min(1.0)
            }
            false => 1.0,
        };
        if !commit {
            bear(&mut p.pressure[i], &mut self.share[i], borne.integrity);
            return after.deviator * (borne.integrity * opened);
        }
        let step = after.step(state, dt);
        m.flow_law.evolve(&step, history);
        if let Some(damage) = m.damage {
            let [kept, failed_at, fracture_energy] = &mut self.damage[i];
            let broken =
                damage.after_step(&step, m.moduli(shear), size, DamageBefore { damage: *kept, integrity: before });
            *kept = broken.damage;
            borne.integrity = borne.integrity.min(broken.integrity);
            let elastic = m.elastic_energy_of_breaking(after.deviator, shear, rho, state.pressure, sound_speed);
            *fracture_energy += broken.share * before * after.plastic_work / rho + (before - borne.integrity) * elastic;
            if borne.integrity == 0.0 {
                *failed_at = self.time + self.dt;
            }
            bear(&mut p.pressure[i], &mut self.share[i], borne.integrity);
        }
        let deviator = after.deviator * (borne.integrity * opened);
        p.deviator[i] = deviator;
        self.integrity[i] = borne.integrity;
        let plastic_work = before * after.plastic_work;
        p.plastic_strain[i] += after.plastic_strain_increment;
        p.plastic_strain_increment[i] = after.plastic_strain_increment;
        p.yield_stress[i] = if borne.integrity > 0.0 { borne.integrity * after.yield_stress } else { 0.0 };
        p.plastic_work[i] += plastic_work / rho;
        let (beta, cp, t0) = (m.taylor_quinney, m.specific_heat, m.reference_temperature);
        match source {
            TemperatureSource::PlasticWork => {
                p.temperature[i] += heat::temperature_rise_from_plastic_work(beta, plastic_work, rho, cp);
            }
            TemperatureSource::Energy => {
                let cold = m.cold_energy(&m.cold_energies(), rho, borne.integrity);
                let elastic = borne.integrity * m.elastic_energy(after.deviator, shear, rho);
                let stored = (1.0 - beta) * p.plastic_work[i];
                p.temperature[i] = heat::temperature_from_energy(t0, energy - artificial, cold, elastic, stored, cp);
            }
        }
        deviator
    }

    /// Share of the linear viscosity that acts on a wave, by its frequency times `tau`: the second derivative of the filtered divergence over itself.
    fn share_of_short_waves(&mut self, i: usize, divergence: f64, tau: f64) -> f64 {
        let [once, twice] = self.filtered[i];
        // Implicit steps of `tau D_1' = D - D_1` and `tau D_2' = D_1 - D_2`.
        let next = (tau * once + self.dt * divergence) / (tau + self.dt);
        let after = (tau * twice + self.dt * next) / (tau + self.dt);
        self.filtered[i] = [next, after];
        let lets_go = self.has_come_apart[self.p.body[i] as usize] || self.material(i).breaks();
        if self.model.numerics.viscosity_of_all_waves || lets_go {
            return 1.0;
        }
        let frequency = (divergence - 2.0 * next + after).abs() / twice.abs();
        if frequency.is_nan() { 0.0 } else { ((frequency - 0.3) / 0.3).clamp(0.0, 1.0) }
    }

    /// Stress where forces are evaluated, as the momentum sum wants it: `a_i sigma_i B_i`, or `P_i B_i`.
    pub(crate) fn update_stress(&mut self) {
        let numerics = self.model.numerics.clone();
        let commit = numerics.integrator == Integrator::Leapfrog;
        for i in 0..self.p.len() {
            let energy = self.p.energy[i] + 0.5 * self.dt * self.p.energy_rate[i];
            let artificial = self.artificial_energy[i] + 0.5 * self.dt * self.artificial_power[i];
            let held = self.initial_volume[i] / self.p.mass[i] * self.held_by_springs(i);
            let deviator = self.flow(i, (energy, artificial + held), self.dt_to_evaluation(), commit);
            let (rho, c, h) = (self.p.density[i], self.p.sound_speed[i], self.p.smoothing_length[i]);
            let l = self.p.velocity_gradient[i];
            let mut pressure = self.p.pressure[i];
            if self.total_lagrangian().is_some() {
                let h = h * smallest_stretch(&self.deformation[i]);
                let divergence = l[0][0] + l[1][1] + l[2][2];
                let in_shocks = if numerics.viscosity_of_shocks > 0.0 { self.share_in_shocks(i, h) } else { 1.0 };
                let ViscosityParameters { alpha, beta } = self.viscosity();
                let short = self.share_of_short_waves(i, divergence, h / c);
                let acting = ViscosityParameters { alpha: short * alpha, beta };
                let q = self.share[i] * bulk_viscosity(acting, divergence, rho, c, h);
                self.impedance[i] = self.share[i] * in_shocks * c * self.p.mass[i] / self.initial_volume[i];
                let (linear, quadratic) =
                    (numerics.viscosity_alpha * c, numerics.viscosity_beta * h * (-divergence).max(0.0));
                let pairs = 3.6 * numerics.viscosity_of_shocks * c / self.p.smoothing_length[i];
                self.damping_rate[i] = 0.6 * (linear + 2.0 * quadratic) / h + in_shocks * pairs;
                pressure += q;
                // The kicks of the step take half of it with the pressure before and half with the one after.
                let mean = 0.5 * (std::mem::replace(&mut self.viscous_pressure[i], q) + q);
                self.ledger.viscous_energy -= self.dt * self.p.mass[i] / rho * mean * divergence;
            }
            let sigma = (deviator - SymmetricTensor::isotropic(pressure)) * stress_scale(numerics.pair_form, rho);
            self.stress[i] = match self.total_lagrangian() {
                Some(_) => {
                    let piola = first_piola(sigma, &self.deformation[i]);
                    tensor::plus(&piola, 1.0, &self.face_stress[i])
                }
                None => multiply(&sigma.to_tensor(), &self.correction[i]),
            };
            if let Some(a) = numerics.artificial_stress {
                let body = &self.model.bodies[self.p.body[i] as usize];
                let at_spacing = numerics.kernel.w(body.spacing / body.smoothing_length);
                let of_body = artificial_stress::coefficient(a.epsilon, at_spacing, a.exponent);
                let material = &self.model.materials[self.p.material[i] as usize];
                let left = material.bounded_pressure().energy_left(energy);
                let tensor = artificial_stress::artificial_stress(sigma, of_body * left, self.dimension);
                self.repulsion[i] = tensor.to_tensor();
            }
            self.switch[i] = if numerics.balsara { balsara(&l, c, h) } else { 1.0 };
        }
        if self.model.formulation.is_quadratic_at_faces() {
            let stress = std::mem::take(&mut self.stress);
            self.stress = self.transposed_at_faces(stress);
        }
        if self.total_lagrangian().is_some() {
            for i in 0..self.p.len() {
                let with_moment = tensor::plus(&self.stress[i], 1.0, &self.spring_moment[i]);
                self.stress[i] = multiply(&with_moment, &self.correction[i]);
            }
        }
    }

    /// The stress of the end of the step where forces were those of its middle.
    pub(crate) fn commit_stress(&mut self) {
        for i in 0..self.p.len() {
            self.p.density[i] = density_after(self.base_density[i], &self.p.velocity_gradient[i], self.dt);
            self.flow(i, (self.p.energy[i], self.artificial_energy[i]), self.dt, true);
        }
    }

    fn viscosity(&self) -> ViscosityParameters<f64> {
        ViscosityParameters { alpha: self.model.numerics.viscosity_alpha, beta: self.model.numerics.viscosity_beta }
    }

    /// `dv_i/dt = f_i sum_j w'_j (a_i sigma_i + a_j sigma_j + R_ij f^n - Pi_ij I) . grad_i W_ij`, the energy that goes with it, and
    /// `eps sum_j m_j/rho_ij (v_j - v_i) W_ij`.
    pub(crate) fn sum_forces(&mut self) {
        self.exerted.clear();
        let numerics = self.model.numerics.clone();
        let form = numerics.pair_form;
        let p = &self.p;
        let by_volume = form == PairForm::VolumeWeighted;
        let of_gradient = self.total_lagrangian().is_some() || numerics.integrator == Integrator::PredictorCorrector;
        // The volumes of the gradient sum, where that was taken at the same places: the sums are adjoint then.
        let weight = self.each(|i| match by_volume && of_gradient {
            true => self.weight[i],
            false => momentum_weight(form, p.mass[i], p.density[i]),
        });
        let at = self.places(p.position.clone());
        let support = numerics.kernel.support();
        let sums = self.each(|i| {
            let mut exerted = Vec::new();
            let f = if by_volume { weight[i] / p.mass[i] } else { 1.0 };
            let (mut a, mut power, mut xsph, mut mu_max) = ([0.0; 3], 0.0, [0.0; 3], 0.0f64);
            let (mut viscous, mut artificial) = (0.0, 0.0);
            for n in self.pairs(i, &at) {
                let j = n.j;
                let v = minus(self.evaluated[i], n.image.vector(self.evaluated[j]));
                let (mut t_star, mut repulsion, mut drag) = ([0.0; 3], [0.0; 3], [0.0; 3]);
                if self.total_lagrangian().is_none() {
                    let mu = viscosity_mu(dot(v, n.x), n.r * n.r, n.h);
                    let inverse_rho = inverse_density_mean(p.density[i], p.density[j]);
                    let c = mean(p.sound_speed[i], p.sound_speed[j]);
                    let pi =
                        viscous_pressure(self.viscosity(), mu, c, inverse_rho) * mean(self.switch[i], self.switch[j]);
                    drag = n.x.map(|x| -scaled_pressure(form, pi, p.density[i], p.density[j]) * x);
                    t_star = plus(t_star, 1.0, drag);
                    if let Some(stress) = numerics.artificial_stress {
                        let w = numerics.kernel.w(n.r / n.h);
                        let f = artificial_stress::pair_factor(w, stress.exponent);
                        repulsion = plus(repulsion, f, apply(&self.repulsion[i], n.x));
                        repulsion = plus(repulsion, f, apply(&n.image.tensor(&self.repulsion[j]), n.x));
                        t_star = plus(t_star, 1.0, repulsion);
                    }
                    xsph = plus(xsph, -numerics.xsph * p.mass[j] * inverse_rho * n.w, v);
                    if n.r < support * n.h {
                        mu_max = mu_max.max(-mu);
                    }
                }
                let own = apply(&self.stress[i], n.x);
                let total = plus(plus(own, 1.0, apply(&n.image.tensor(&self.stress[j]), n.x)), 1.0, t_star);
                let work = match numerics.energy_split {
                    EnergySplit::OwnStress => plus(own, 0.5, t_star),
                    EnergySplit::Symmetric => total.map(|t| 0.5 * t),
                };
                a = plus(a, weight[j] * n.f, total);
                exerted.push((i, j, n.image, total.map(|t| p.mass[i] * f * weight[j] * n.f * t)));
                power -= weight[j] * n.f * dot(work, v);
                artificial -= 0.5 * weight[j] * n.f * dot(repulsion, v);
                viscous -= 0.5 * weight[j] * n.f * dot(drag, v);
            }
            (a.map(|a| f * a), [power, artificial, viscous].map(|power| f * power), xsph, mu_max, exerted)
        });
        self.viscous_power = 0.0;
        for (i, (a, [power, artificial, viscous], xsph, mu, exerted)) in sums.into_iter().enumerate() {
            self.artificial_power[i] = artificial;
            self.viscous_power += self.p.mass[i] * viscous;
            (self.p.acceleration[i], self.p.energy_rate[i], self.xsph[i]) = (a, power, xsph);
            self.exerted.extend(exerted);
            if self.total_lagrangian().is_none() {
                self.mu[i] = mu;
            }
        }
    }

    /// Springs of particle `i`.
    fn spring(&self, strength: f64, i: usize) -> Spring<f64> {
        let (young, p) = (self.material(i).young_modulus(), &self.p);
        let (flow, least) = (p.yield_stress[i], self.yielded_stretch[i]);
        let counted = match self.model.formulation {
            Formulation::TotalLagrangian { faces, .. } => faces.counted(),
            Formulation::UpdatedLagrangian => Counted::LINEAR,
        };
        Spring::new(counted, strength, young, flow, p.plastic_strain[i], least)
    }

    /// Energy that the springs hold, J.
    pub(crate) fn energy_of_springs(&self) -> f64 {
        (0..self.p.len()).map(|i| self.initial_volume[i] * self.held_by_springs(i)).sum()
    }

    /// That of a particle per initial volume, J/m^d.
    fn held_by_springs(&self, i: usize) -> f64 {
        let Some(strength) = self.total_lagrangian() else { return 0.0 };
        self.spring(strength, i).energy(self.spring_misfit[i], self.dimension)
    }

    /// Springs, `V_i V_j w_ij (k_i z_i(j) + k_j z_j)/2` with the weight of the gradient, to each the work of its own. The stiffness is that
    /// of the misfit at the last evaluation.
    pub(crate) fn resist_hourglass(&mut self) {
        let Some(strength) = self.total_lagrangian() else { return };
        let p = &self.p;
        let stiffness = self.each(|i| self.spring(strength, i).at(self.spring_misfit[i]));
        // Of the plain sums.
        let fit = self.each(|i| match self.faces.excess.get(i) {
            Some(excess) => tensor::plus(&self.deformation[i], 1.0, excess),
            None => self.deformation[i],
        });
        let sums = self.each(|i| {
            let (mut a, mut power, mut misfit, mut exerted) = ([0.0; 3], 0.0, 0.0, Vec::new());
            let mut moment = tensor::zero();
            for n in self.pairs(i, &self.searched_at) {
                let x = minus(p.position[i], n.image.point(p.position[n.j]));
                let v = minus(self.evaluated[i], n.image.vector(self.evaluated[n.j]));
                let miss = |f: &Tensor<f64>| minus(apply(f, n.x), x);
                let own = miss(&fit[i]);
                let other = miss(&n.image.tensor(&fit[n.j]));
                let weight = -self.initial_volume[n.j] * n.f;
                let both = plus(own.map(|z| 0.5 * stiffness[i] * z), 0.5 * stiffness[n.j], other);
                let push = both.map(|push| self.initial_volume[i] / p.mass[i] * weight * push);
                a = plus(a, 1.0, push);
                exerted.push((i, n.j, n.image, push.map(|push| p.mass[i] * push)));
                power -= 0.5 * self.initial_volume[i] / p.mass[i] * stiffness[i] * weight * dot(own, v);
                misfit += weight * dot(own, own) / self.dimension.count() as f64;
                add_dyad(&mut moment, weight, own, n.x);
            }
            (a, power, misfit, moment, exerted)
        });
        self.hourglass_power = 0.0;
        for (i, (a, power, misfit, moment, exerted)) in sums.into_iter().enumerate() {
            // The deformation gradient is the fit to the neighbours, so springs have no moment.
            let is_balanced = moment.as_flattened().iter().all(|m| m.abs() < 1e-9);
            debug_assert!(is_balanced || self.yielded_stretch[i] == 0.0, "{i}: {moment:?}");
            let rate = multiply(&self.p.velocity_gradient[i], &self.deformation[i]);
            let worked = rate.as_flattened().iter().zip(self.spring_moment[i].as_flattened()).map(|(f, m)| f * m);
            self.hourglass_power += self.initial_volume[i] * worked.sum::<f64>();
            self.spring_moment[i] = moment.map(|row| row.map(|m| 0.5 * stiffness[i] * m));
            self.spring_misfit[i] = misfit;
            self.p.energy_rate[i] += self.faces.power.get(i).copied().unwrap_or_default();
            self.p.acceleration[i] = plus(self.p.acceleration[i], 1.0, a);
            self.p.energy_rate[i] += power;
            self.hourglass_power += self.p.mass[i] * power;
            self.exerted.extend(exerted);
        }
    }

    /// `chi`, with the smoothing length as compressed, m.
    fn share_in_shocks(&self, i: usize, h: f64) -> f64 {
        let (l, c) = (&self.p.velocity_gradient[i], self.p.sound_speed[i]);
        let rate = SymmetricTensor::symmetric_part(l).to_tensor();
        let trace: f64 = (0..3).map(|a| rate[a][a]).sum();
        let square: f64 = rate.as_flattened().iter().map(|d| d * d).sum();
        if trace >= 0.0 {
            return 0.0;
        }
        ((-h * trace / c - 0.0004) / 0.0008).clamp(0.0, 1.0) * ((trace * trace / square - 0.5) / 0.4).clamp(0.0, 1.0)
    }

    /// Viscosity of shocks along pairs at their places now, `V_i V_j w_ij alpha max(z_i, z_j) h max(0, -v.x)/x^2 x`; half of the heat to each.
    pub(crate) fn resist_shocks(&mut self) {
        let strength = self.model.numerics.viscosity_of_shocks;
        if self.total_lagrangian().is_none() || strength == 0.0 {
            return;
        }
        let p = &self.p;
        let sums = self.each(|i| {
            let (mut a, mut power, mut exerted) = ([0.0; 3], 0.0, Vec::new());
            for n in self.pairs(i, &self.searched_at) {
                let x = minus(p.position[i], n.image.point(p.position[n.j]));
                let v = minus(self.evaluated[i], n.image.vector(self.evaluated[n.j]));
                let closes = (-dot(v, x)).max(0.0) / (dot(x, x) + 1e-9 * n.h * n.h);
                let push = strength * self.impedance[i].max(self.impedance[n.j]) * n.h * closes;
                let force = x.map(|x| -self.initial_volume[i] * self.initial_volume[n.j] * n.f * push * x);
                a = plus(a, 1.0 / p.mass[i], force);
                power -= 0.5 * dot(force, v);
                exerted.push((i, n.j, n.image, force));
            }
            (a, power, exerted)
        });
        for (i, (a, power, exerted)) in sums.into_iter().enumerate() {
            self.p.acceleration[i] = plus(self.p.acceleration[i], 1.0, a);
            self.p.energy_rate[i] += power / self.p.mass[i];
            self.viscous_power += power;
            self.exerted.extend(exerted);
        }
    }

    /// A value of every particle.
    pub(crate) fn each<V>(&self, of: impl Fn(usize) -> V) -> Vec<V> {
        (0..self.p.len()).map(of).collect()
    }
}

/// No correction.
pub(crate) fn uncorrected(count: usize) -> Vec<Tensor<f64>> {
    vec![identity(); count]
}
