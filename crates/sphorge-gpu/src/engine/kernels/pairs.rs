//! The pair sums over the list of each particle.

use super::motion::Motions;
use super::neighbors::{Pair, over_neighbors};
use super::section::{Crossing, Through};
use crate::engine::columns::{ReadColumns, ReadShared, Recording, WriteColumns, added, groups, recording};
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
        let (density, gradient, constants) = (
            groups::Density::read(bind).density,
            groups::Gradient::read(bind).velocity_gradient,
            groups::Constants::read(bind),
        );
        let (weight, step) = (groups::Weight::write(bind), groups::Step::shared(bind));
        let half = step.half.value();
        let ahead = predicted_density(density.high().get(i), &gradient.get(i), half);
        weight.weight.set(i, gradient_weight(form, constants.mass.get(i), ahead));
        weight.factor.set(i, gradient_factor(form, ahead));
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
        let near = (groups::Place::read(bind).position, groups::Constants::read(bind));
        let (velocity, weight) = (groups::Velocity::read(bind).velocity, groups::Weight::write(bind));
        let (gradient, density, step) = (
            groups::Gradient::write(bind).velocity_gradient,
            groups::Density::write(bind).density,
            groups::Step::shared(bind),
        );
        let rates = (numerics.xsph != 0.0).then(|| groups::Rates::read(bind));
        let half = step.half.value();
        let own = velocity.high().get(i);
        // Drift in addition to the velocity.
        let smoothed = |of: Index| rates.map_or([Recorded::zero(); 3], |rates| rates.smoothing_velocity.get(of));
        let own_smoothed = smoothed(i);
        let zero = Recorded::zero();
        let has_moment = corrects_strain || model.corrects_current_gradients();
        let start = Gradients { gradient: [[zero; 3]; 3], moment: has_moment.then_some([[zero; 3]; 3]), inside: zero };
        let sums = over_neighbors::<_, D>(bind, model, i, near, start, |mut state: Gradients, pair, j| {
            let other = pair.image.vector(velocity.high().get(j));
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
            let f = pair.scale.weighted(weight.weight.get(j)).f(kernel.dw_over_q_by(q, inverse_q));
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
        let factor = weight.factor.get(i);
        let scaled = |t: Tensor<Recorded>| t.map(|row| row.map(|c| c * factor));
        let correction_of = |moment: Tensor<Recorded>| {
            gradient_correction(&scaled(moment), model.dimensions.into(), Recorded::of(LARGEST_COMPONENT))
        };
        let mut l = scaled(sums.gradient);
        if let Some(moment) = sums.moment.filter(|_| model.corrects_current_gradients()) {
            let b = correction_of(moment);
            groups::Correction::write(bind).correction.set(i, &b);
            l = corrected(&l, &b);
        }
        gradient.set(i, &l);
        weight.neighbors.set(i, sums.inside);
        if is_guarded && model.corrects_current_gradients() {
            let strain = step.dt.value() * strain_rate(&l);
            groups::StrainCorrection::write(bind).strain.set(i, strain);
        } else if is_guarded {
            // The guard counts the corrected strain: at a free face plain sums give as little as half of it.
            let of_strain = groups::StrainCorrection::write(bind);
            let b = match sums.moment {
                None => of_strain.correction.get(i),
                Some(moment) => {
                    let b = correction_of(moment);
                    of_strain.correction.set(i, &b);
                    b
                }
            };
            of_strain.strain.set(i, step.dt.value() * strain_rate(&corrected(&l, &b)));
        }
        // The committed end of the step, or its middle.
        let ahead = match numerics.integrator {
            Integrator::Leapfrog => step.dt.value(),
            Integrator::PredictorCorrector => half,
        };
        density.set(i, compressed(density.get(i), &l, ahead));
    })
}

/// The gradient correction at the positions and densities of the force evaluation of leapfrog. Torques cancel only if
/// force and correction use the same.
pub(in crate::engine) fn correct<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    let (kernel, form) = (numerics.kernel, numerics.pair_form);
    recording("correct_gradients", count, |bind, i| {
        let near = (groups::Place::read(bind).position, groups::Constants::read(bind));
        let (density, correction) = (groups::Density::read(bind).density, groups::Correction::write(bind).correction);
        let zero = Recorded::zero();
        let start = [[zero; 3]; 3];
        let moment = over_neighbors::<_, D>(bind, model, i, near, start, |moment: Tensor<Recorded>, pair, j| {
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let weight = gradient_weight(form, near.1.mass.get(j), density.high().get(j));
            let f = pair.scale.weighted(weight).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { moment, ..GradientSums::zero() };
            sums.add::<D, true>(&pair.x, &[zero; 3], f);
            sums.moment
        });
        let factor = gradient_factor(form, density.high().get(i));
        let moment = moment.map(|row| row.map(|c| c * factor));
        let b = gradient_correction(&moment, model.dimensions.into(), Recorded::of(LARGEST_COMPONENT));
        correction.set(i, &b);
    })
}

/// Data of a neighbour that corrected forces read: the scaled stress times the correction.
pub(in crate::engine) fn correct_stress(count: usize) -> Result<Recording, KernelFault> {
    recording("correct_stress", count, |bind, i| {
        let (packed, correction) = (groups::Packed::read(bind), groups::Correction::read(bind).correction);
        let product = multiply(&packed.stress.get(i).to_tensor(), &correction.get(i));
        groups::CorrectedStress::write(bind).stress.set(i, &product);
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
        let near = (groups::Place::read(bind).position, groups::Constants::read(bind));
        let (evaluated, weight, density) =
            (groups::Evaluated::read(bind).velocity, groups::Weight::read(bind), groups::Density::read(bind).density);
        let packed = groups::Packed::read(bind);
        let weight_of = |j: Index| match (form, numerics.integrator) {
            // The volumes of the gradient sum, at the same positions: both sums are adjoint to the bit.
            (PairForm::VolumeWeighted, Integrator::PredictorCorrector) => weight.weight.get(j),
            (PairForm::VolumeWeighted, Integrator::Leapfrog) | (PairForm::DensityWeighted | PairForm::Mixed, _) => {
                momentum_weight(form, near.1.mass.get(j), density.high().get(j))
            }
        };
        let (own, rho) = (evaluated.get(i), density.high().get(i));
        let (stress, repulsion) = (packed.stress.get(i), packed.artificial_stress.get(i));
        let (switch, sound_speed) = (packed.balsara.get(i), packed.sound_speed.get(i));
        let products = model.corrects_current_gradients().then(|| groups::CorrectedStress::read(bind).stress);
        let start = [Recorded::zero(); 10];
        let add = |mut state: [Recorded; 10], pair: &Pair, j: Index| {
            let other = pair.image.vector(evaluated.get(j));
            let v = [0, 1, 2].map(|a| own[a] - other[a]);
            let mut v_dot_x = Recorded::zero();
            for a in 0..D {
                v_dot_x = v[a].mul_add(pair.x[a], v_dot_x);
            }
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let w_j = weight_of(j);
            let weighted = pair.scale.weighted(w_j);
            let mu = viscosity_mu(v_dot_x, pair.r2, pair.scale.h);
            let rho_j = density.high().get(j);
            let inverse_density = inverse_density_mean(rho, rho_j);
            let pi = viscous_pressure(viscosity, mu, mean(sound_speed, packed.sound_speed.get(j)), inverse_density);
            let mut pi = scaled_pressure(form, pi, rho, rho_j);
            if numerics.balsara {
                pi = switched(pi, switch, packed.balsara.get(j));
            }
            let w = kernel.w(q);
            let mut artificial = [Recorded::zero(); 3];
            if let Some(terms) = numerics.artificial_stress {
                let factor = artificial_stress::pair_factor(w, terms.exponent);
                artificial = artificial_stress::pair_vector::<_, D>(
                    repulsion,
                    pair.image.symmetric(packed.artificial_stress.get(j)),
                    factor,
                    &pair.x,
                );
            }
            let weighted_f = weighted.f(kernel.dw_over_q_by(q, inverse_q));
            let (own_stress, other_stress) = match products {
                None => (
                    stress_vector::<_, D>(&stress, &pair.x),
                    stress_vector::<_, D>(&pair.image.symmetric(packed.stress.get(j)), &pair.x),
                ),
                Some(products) => (
                    corrected_stress_vector::<_, D>(&products.get(i), &pair.x),
                    corrected_stress_vector::<_, D>(&pair.image.tensor(&products.get(j)), &pair.x),
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
                let mass_per_weight = near.1.mass.get(j) / w_j;
                let weight = xsph_weight(weighted.value(w), mass_per_weight, inverse_density);
                add_xsph::<_, D>(&mut smoothing, &v, weight);
                state[4..7].copy_from_slice(&smoothing);
            }
            state[7] = state[7].max(mu.abs());
            state
        };
        let factor = momentum_factor(form, near.1.mass.get(i), weight_of(i));
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, near.0);
            let none = [Recorded::zero(); 3];
            let sum = over_neighbors::<_, D>(bind, model, i, near, none, |sum: Vector<Recorded>, pair, j| {
                crossing.add(sum, &pair.image, j, || add(start, pair, j), |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.mass.get(i)), false);
            return;
        }
        let sums = over_neighbors::<_, D>(bind, model, i, near, start, add);
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        let mut smoothed = [4, 5, 6].map(|k| sums[k] * Recorded::of(numerics.xsph));
        if numerics.xsph != 0.0 {
            // Prescribed components drift only with their velocity.
            let step = groups::Step::shared(bind);
            smoothed = Motions::of(bind, model, step).map_or(smoothed, |of| of.of_particle(i).free(smoothed));
        }
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, sums[a] * factor);
            rates.smoothing_velocity.axis(a).set(i, smoothed[a]);
        }
        rates.largest_mu.set(i, sums[7]);
        let [viscous, repulsive] = [share_of_power(sums[8]), share_of_power(sums[9])];
        energy.rate.set(i, (sums[3] + viscous + repulsive) * factor);
        energy.viscous_rate.set(i, viscous * factor);
        energy.artificial_stress_rate.set(i, repulsive * factor);
    })
}
