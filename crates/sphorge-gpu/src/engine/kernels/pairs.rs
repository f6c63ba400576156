//! Gradients of the pair sums over the list of each particle.

use super::neighbors::{Pair, over_neighbors};
use crate::engine::columns::{
    Binder, Compensated, CompensatedVector, Read, ReadColumns, ReadShared, Recording, Shared, TensorColumns, Write,
    WriteColumns, added, groups, recording,
};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{Integrator, Model};
use sphorge_physics::gradient_correction::{LARGEST_COMPONENT, corrected, gradient_correction};
use sphorge_physics::kick::earlier;
use sphorge_physics::pair::{GradientSums, gradient_factor, gradient_weight};
use sphorge_physics::stress::{predicted_density, relative_density_change, strain_rate};
use sphorge_physics::tensor::multiply;
use sphorge_physics::{Numbers, Real, Tensor, Vector};

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
    let is_guarded = model.adaptive_search().is_some_and(|rule| rule.guard.is_some());
    recording(if corrects_strain { "gradients_and_moments" } else { "gradients" }, count, |bind, i| {
        let pairs = GradientPairs::of(bind, model, i);
        let GradientPairs { weight, half, step, .. } = pairs;
        let zero = Recorded::zero();
        let has_moment = corrects_strain || model.corrects_current_gradients();
        let start = Gradients { gradient: [[zero; 3]; 3], moment: has_moment.then_some([[zero; 3]; 3]), inside: zero };
        let add = |state: Gradients, pair: &Pair, j: Index| pairs.add::<D>(state, pair, j);
        let sums = over_neighbors::<_, D>(bind, model, i, pairs.near, start, add);
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
        pairs.gradient.set(i, &l);
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
        let ahead = match model.numerics.integrator {
            Integrator::Leapfrog => step.dt.value(),
            Integrator::PredictorCorrector => half,
        };
        pairs.density.set(i, compressed(pairs.density.get(i), &l, ahead));
    })
}

/// What the velocity gradient of a particle is made of.
struct GradientPairs<'a> {
    model: &'a Model,
    near: (CompensatedVector<Read>, groups::Constants<Read>),
    velocity: CompensatedVector<Read>,
    weight: groups::Weight<Write>,
    gradient: TensorColumns<Write>,
    density: Compensated<Write>,
    step: groups::Step<Shared>,
    /// Drift in addition to the velocity.
    rates: Option<groups::Rates<Read>>,
    half: Recorded,
    own: Vector<Recorded>,
    own_smoothed: Vector<Recorded>,
}

impl<'a> GradientPairs<'a> {
    fn of(bind: &mut Binder<'_>, model: &'a Model, i: Index) -> Self {
        let near = (groups::Place::read(bind).position, groups::Constants::read(bind));
        let (velocity, weight) = (groups::Velocity::read(bind).velocity, groups::Weight::write(bind));
        let gradient = groups::Gradient::write(bind).velocity_gradient;
        let (density, step) = (groups::Density::write(bind).density, groups::Step::shared(bind));
        let rates = (model.numerics.xsph != 0.0).then(|| groups::Rates::read(bind));
        let half = step.half.value();
        let own = velocity.high().get(i);
        let none = [Recorded::zero(); 3];
        let mut pairs =
            Self { model, near, velocity, weight, gradient, density, step, rates, half, own, own_smoothed: none };
        pairs.own_smoothed = pairs.smoothed(i);
        pairs
    }

    fn smoothed(&self, of: Index) -> Vector<Recorded> {
        self.rates.map_or([Recorded::zero(); 3], |rates| rates.smoothing_velocity.get(of))
    }

    fn add<const D: usize>(&self, mut state: Gradients, pair: &Pair, j: Index) -> Gradients {
        let (numerics, kernel) = (&self.model.numerics, self.model.numerics.kernel);
        let other = pair.image.vector(self.velocity.high().get(j));
        let v = [0, 1, 2].map(|a| other[a] - self.own[a]);
        let (mut x, mut r2) = (pair.x, pair.r2);
        if numerics.integrator == Integrator::Leapfrog && !self.model.keeps_distances() {
            let other_smoothed = pair.image.vector(self.smoothed(j));
            r2 = Recorded::zero();
            for a in 0..D {
                x[a] = earlier(x[a], (self.own_smoothed[a] - other_smoothed[a]) - v[a], self.half);
                r2 = x[a].mul_add(x[a], r2);
            }
        }
        let (q, inverse_q) = pair.scale.reduced_distance(r2);
        let f = pair.scale.weighted(self.weight.weight.get(j)).f(kernel.dw_over_q_by(q, inverse_q));
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
        state.inside += Recorded::select_lt(q, support, Recorded::one(), Recorded::zero());
        state
    }
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

/// A density with its low part, kg/m³, after a step.
pub(super) fn compressed(density: [Recorded; 2], l: &Tensor<Recorded>, dt: Recorded) -> [Recorded; 2] {
    added(density, density[0] * relative_density_change(l, dt))
}
