//! The pair sums over the list of each particle.

use super::kept;
use super::motion::Motions;
use super::neighbors::{Pair, over_neighbors};
use super::section::{Crossing, Through};
use crate::engine::columns::{Fields, Group, Recording, added, recording};
use crate::engine::step_numbers::{DT, HALF};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{Integrator, Model};
use sphorge_physics::gradient_correction::{LARGEST_COMPONENT, corrected, gradient_correction};
use sphorge_physics::kick::earlier;
use sphorge_physics::pair::{
    ForceSums, GradientSums, PairForce, PairForm, closing_power, corrected_stress_vector, gradient_factor,
    gradient_weight, inverse_density_mean, mean, momentum_factor, momentum_weight, scaled_pressure, share_of_power,
    stress_vector,
};
use sphorge_physics::stress::{predicted_density, relative_density_change, strain_rate};
use sphorge_physics::tensor::multiply;
use sphorge_physics::viscosity::{ViscosityParameters, switched, viscosity_mu, viscous_pressure};
use sphorge_physics::xsph::{add_xsph, xsph_weight};
use sphorge_physics::{Numbers, Real, Tensor, Vector, artificial_stress};

/// The weight of every particle in the gradient sum, from the density half a step ahead.
pub(in crate::engine) fn weigh(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let form = model.numerics.pair_form;
    recording("weigh", count, |bind, i| {
        let (density, gradient, constants) =
            (bind.read(Group::Density), bind.read(Group::Gradient), bind.read(Group::Constants));
        let (weight, step) = (bind.write(Group::Weight), bind.read(Group::Step));
        let half = step.get(0, Index::of(HALF));
        let ahead = predicted_density(density.get(0, i), &gradient.tensor(0, i), half);
        weight.set(0, i, gradient_weight(form, constants.get(0, i), ahead));
        weight.set(2, i, gradient_factor(form, ahead));
    })
}

/// Sums of a particle: velocity gradient, moment of the gradient correction if requested, and neighbours within the
/// support.
#[derive(Clone, Copy)]
struct Gradients {
    gradient: Tensor<Recorded>,
    moment: Option<Tensor<Recorded>>,
    inside: Recorded,
}

impl Numbers<Recorded> for Gradients {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.gradient.as_flattened_mut().iter_mut().for_each(&mut *visit);
        if let Some(moment) = &mut self.moment {
            moment.as_flattened_mut().iter_mut().for_each(&mut *visit);
        }
        visit(&mut self.inside);
    }
}

/// Velocity gradient and density. With leapfrog the gradient is computed at the positions of mid-step, to which its
/// velocities belong, over the pairs at the end of the step.
pub(in crate::engine) fn gradients<const D: usize>(
    model: &Model,
    corrects_strain: bool,
    count: usize,
) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    let kernel = numerics.kernel;
    let is_guarded = model.adaptive_search().is_some_and(|rule| rule.guard.is_some());
    recording(if corrects_strain { "gradients_and_moments" } else { "gradients" }, count, |bind, i| {
        let near = (bind.read(Group::Place), bind.read(Group::Constants));
        let (velocity, weight) = (bind.read(Group::Velocity), bind.write(Group::Weight));
        let (gradient, density, step) =
            (bind.write(Group::Gradient), bind.write(Group::Density), bind.read(Group::Step));
        let rates = (numerics.xsph != 0.0).then(|| bind.read(Group::Rates));
        let half = step.get(0, Index::of(HALF));
        let own = velocity.vector(0, i);
        // Drift in addition to the velocity.
        let smoothed = |of: Index| rates.map_or([Recorded::zero(); 3], |rates| rates.vector(3, of));
        let own_smoothed = smoothed(i);
        let zero = Recorded::zero();
        let has_moment = corrects_strain || model.corrects_current_gradients();
        let start = Gradients { gradient: [[zero; 3]; 3], moment: has_moment.then_some([[zero; 3]; 3]), inside: zero };
        let sums = over_neighbors::<_, D>(bind, model, i, near, start, |mut state: Gradients, pair, j| {
            let other = pair.image.vector(velocity.vector(0, j));
            let v = [0, 1, 2].map(|a| other[a] - own[a]);
            let (mut x, mut r2) = (pair.x, pair.r2);
            if numerics.integrator == Integrator::Leapfrog && !model.keeps_distances() {
                let other_smoothed = pair.image.vector(smoothed(j));
                r2 = Recorded::zero();
                for a in 0..D {
                    x[a] = earlier(x[a], (own_smoothed[a] - other_smoothed[a]) - v[a], half);
                    r2 = x[a].mul_add(x[a], r2);
                }
            }
            let (q, inverse_q) = pair.scale.reduced_distance(r2);
            let f = pair.scale.weighted(weight.get(0, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { gradient: state.gradient, ..GradientSums::zero() };
            match &mut state.moment {
                None => sums.add::<D, false>(&x, &v, f),
                Some(moment) => {
                    sums.moment = *moment;
                    sums.add::<D, true>(&x, &v, f);
                    *moment = sums.moment;
                }
            }
            state.gradient = sums.gradient;
            let support = Recorded::of(kernel.support());
            state.inside += Recorded::select_lt(q, support, Recorded::one(), zero);
            state
        });
        let factor = weight.get(2, i);
        let scaled = |t: Tensor<Recorded>| t.map(|row| row.map(|c| c * factor));
        let correction_of = |moment: Tensor<Recorded>| {
            gradient_correction(&scaled(moment), model.dimensions.into(), Recorded::of(LARGEST_COMPONENT))
        };
        let mut l = scaled(sums.gradient);
        if let Some(moment) = sums.moment.filter(|_| model.corrects_current_gradients()) {
            let b = correction_of(moment);
            bind.write(Group::Correction).set_all(0, i, b.as_flattened());
            l = corrected(&l, &b);
        }
        gradient.set_all(0, i, l.as_flattened());
        weight.set(1, i, sums.inside);
        if is_guarded && model.corrects_current_gradients() {
            let strain = step.get(0, Index::of(DT)) * strain_rate(&l);
            bind.write(Group::StrainCorrection).set(kept::STRAINED, i, strain);
        } else if is_guarded {
            // The guard counts the corrected strain: at a free face plain sums give as little as half of it.
            let correction = bind.write(Group::StrainCorrection);
            let b = match sums.moment {
                None => correction.tensor(0, i),
                Some(moment) => {
                    let b = correction_of(moment);
                    correction.set_all(0, i, b.as_flattened());
                    b
                }
            };
            correction.set(kept::STRAINED, i, step.get(0, Index::of(DT)) * strain_rate(&corrected(&l, &b)));
        }
        // The committed end of the step, or its middle.
        let ahead = match numerics.integrator {
            Integrator::Leapfrog => step.get(0, Index::of(DT)),
            Integrator::PredictorCorrector => half,
        };
        density.set_all(0, i, &compressed(density.double(0, 1, i), &l, ahead));
    })
}

/// The gradient correction at the positions and densities of the force evaluation of leapfrog. Torques cancel only if
/// force and correction use the same.
pub(in crate::engine) fn correct<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    let (kernel, form) = (numerics.kernel, numerics.pair_form);
    recording("correct_gradients", count, |bind, i| {
        let near = (bind.read(Group::Place), bind.read(Group::Constants));
        let (density, correction) = (bind.read(Group::Density), bind.write(Group::Correction));
        let zero = Recorded::zero();
        let start = [[zero; 3]; 3];
        let moment = over_neighbors::<_, D>(bind, model, i, near, start, |moment: Tensor<Recorded>, pair, j| {
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let weight = gradient_weight(form, near.1.get(0, j), density.get(0, j));
            let f = pair.scale.weighted(weight).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { moment, ..GradientSums::zero() };
            sums.add::<D, true>(&pair.x, &[zero; 3], f);
            sums.moment
        });
        let factor = gradient_factor(form, density.get(0, i));
        let moment = moment.map(|row| row.map(|c| c * factor));
        let b = gradient_correction(&moment, model.dimensions.into(), Recorded::of(LARGEST_COMPONENT));
        correction.set_all(0, i, b.as_flattened());
    })
}

/// Data of a neighbour that corrected forces read: the scaled stress times the correction.
pub(in crate::engine) fn correct_stress(count: usize) -> Result<Recording, KernelFault> {
    recording("correct_stress", count, |bind, i| {
        let (packed, correction) = (bind.read(Group::Packed), bind.read(Group::Correction));
        let product = multiply(&packed.symmetric(0, i).to_tensor(), &correction.tensor(0, i));
        bind.write(Group::CorrectedStress).set_all(0, i, product.as_flattened());
    })
}

/// A density with its rest, kg/m³, after a step.
pub(super) fn compressed(density: [Recorded; 2], l: &Tensor<Recorded>, dt: Recorded) -> [Recorded; 2] {
    added(density, density[0] * relative_density_change(l, dt))
}

/// Acceleration, energy rate and its parts due to viscosity and artificial stress, XSPH velocity and the largest
/// `|mu|`.
///
/// If a section is given, only the force of the pairs that cross it.
pub(in crate::engine) fn forces<const D: usize>(
    model: &Model,
    through: Option<Through<'_>>,
    count: usize,
) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    let (kernel, form) = (numerics.kernel, numerics.pair_form);
    recording(&Through::name(through, "forces"), count, |bind, i| {
        let viscosity = ViscosityParameters {
            alpha: Recorded::of(numerics.viscosity_alpha),
            beta: Recorded::of(numerics.viscosity_beta),
        };
        let near = (bind.read(Group::Place), bind.read(Group::Constants));
        let (evaluated, weight, density) =
            (bind.read(Group::Evaluated), bind.read(Group::Weight), bind.read(Group::Density));
        let packed = bind.read(Group::Packed);
        let weight_of = |j: Index| match (form, numerics.integrator) {
            // The volumes of the gradient sum, at the same positions: both sums are adjoint to the bit.
            (PairForm::VolumeWeighted, Integrator::PredictorCorrector) => weight.get(0, j),
            (PairForm::VolumeWeighted, Integrator::Leapfrog) | (PairForm::DensityWeighted | PairForm::Mixed, _) => {
                momentum_weight(form, near.1.get(0, j), density.get(0, j))
            }
        };
        let (own, rho) = (evaluated.vector(0, i), density.get(0, i));
        let (stress, repulsion) = (packed.symmetric(0, i), packed.symmetric(6, i));
        let (switch, sound_speed) = (packed.get(12, i), packed.get(13, i));
        let products = model.corrects_current_gradients().then(|| bind.read(Group::CorrectedStress));
        let start = [Recorded::zero(); 10];
        let add = |mut state: [Recorded; 10], pair: &Pair, j: Index| {
            let other = pair.image.vector(evaluated.vector(0, j));
            let v = [0, 1, 2].map(|a| own[a] - other[a]);
            let mut v_dot_x = Recorded::zero();
            for a in 0..D {
                v_dot_x = v[a].mul_add(pair.x[a], v_dot_x);
            }
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let w_j = weight_of(j);
            let weighted = pair.scale.weighted(w_j);
            let mu = viscosity_mu(v_dot_x, pair.r2, pair.scale.h);
            let rho_j = density.get(0, j);
            let inverse_density = inverse_density_mean(rho, rho_j);
            let pi = viscous_pressure(viscosity, mu, mean(sound_speed, packed.get(13, j)), inverse_density);
            let mut pi = scaled_pressure(form, pi, rho, rho_j);
            if numerics.balsara {
                pi = switched(pi, switch, packed.get(12, j));
            }
            let w = kernel.w(q);
            let mut artificial = [Recorded::zero(); 3];
            if let Some(terms) = numerics.artificial_stress {
                let factor = artificial_stress::pair_factor(w, terms.exponent);
                artificial = artificial_stress::pair_vector::<_, D>(
                    repulsion,
                    pair.image.symmetric(packed.symmetric(6, j)),
                    factor,
                    &pair.x,
                );
            }
            let weighted_f = weighted.f(kernel.dw_over_q_by(q, inverse_q));
            let (own_stress, other_stress) = match products {
                None => (
                    stress_vector::<_, D>(&stress, &pair.x),
                    stress_vector::<_, D>(&pair.image.symmetric(packed.symmetric(0, j)), &pair.x),
                ),
                Some(products) => (
                    corrected_stress_vector::<_, D>(&products.tensor(0, i), &pair.x),
                    corrected_stress_vector::<_, D>(&pair.image.tensor(&products.tensor(0, j)), &pair.x),
                ),
            };
            let force = PairForce {
                x: pair.x,
                v,
                own_stress,
                other_stress,
                artificial_stress: artificial,
                pi,
                weighted_f,
                closing_power: closing_power(v_dot_x, weighted_f),
            };
            let mut sums = ForceSums {
                acceleration: [state[0], state[1], state[2]],
                stress_power: state[3],
                viscous_power: state[8],
                repulsive_power: state[9],
            };
            sums.add::<D>(numerics.energy_split, &force);
            state[..3].copy_from_slice(&sums.acceleration);
            [state[3], state[8], state[9]] = [sums.stress_power, sums.viscous_power, sums.repulsive_power];
            if numerics.xsph != 0.0 {
                let mut smoothing = [state[4], state[5], state[6]];
                let mass_per_weight = near.1.get(0, j) / w_j;
                let weight = xsph_weight(weighted.value(w), mass_per_weight, inverse_density);
                add_xsph::<_, D>(&mut smoothing, &v, weight);
                state[4..7].copy_from_slice(&smoothing);
            }
            state[7] = state[7].max(mu.abs());
            state
        };
        let factor = momentum_factor(form, near.1.get(0, i), weight_of(i));
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, near.0);
            let none = [Recorded::zero(); 3];
            let sum = over_neighbors::<_, D>(bind, model, i, near, none, |sum: Vector<Recorded>, pair, j| {
                crossing.add(sum, &pair.image, j, || add(start, pair, j), |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.get(0, i)), false);
            return;
        }
        let sums = over_neighbors::<_, D>(bind, model, i, near, start, add);
        let (rates, energy) = (bind.write(Group::Rates), bind.write(Group::Energy));
        let mut smoothed = [4, 5, 6].map(|k| sums[k] * Recorded::of(numerics.xsph));
        if numerics.xsph != 0.0 {
            // Prescribed components drift only with their velocity.
            let step = bind.read(Group::Step);
            smoothed = Motions::of(bind, model, step).map_or(smoothed, |of| of.of_particle(i).free(smoothed));
        }
        for a in 0..3 {
            rates.set(a, i, sums[a] * factor);
            rates.set(3 + a, i, smoothed[a]);
        }
        rates.set(6, i, sums[7]);
        let [viscous, repulsive] = [share_of_power(sums[8]), share_of_power(sums[9])];
        energy.set(2, i, (sums[3] + viscous + repulsive) * factor);
        energy.set(3, i, viscous * factor);
        energy.set(4, i, repulsive * factor);
    })
}
