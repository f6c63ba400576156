//! Forces of the pairs in the current configuration.

use super::motion::Motions;
use super::neighbors::{Pair, over_neighbors};
use super::section::{Crossing, Through};
use crate::engine::columns::{
    Binder, Compensated, CompensatedVector, Read, ReadColumns, ReadShared, Recording, TensorColumns, VectorColumns,
    WriteColumns, groups, recording,
};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{Integrator, Model};
use sphorge_physics::pair::{
    ForceSums, PairForce, PairForm, closing_power, corrected_stress_vector, inverse_density_mean, mean,
    momentum_factor, momentum_weight, scaled_pressure, share_of_power, stress_vector,
};
use sphorge_physics::viscosity::{ViscosityParameters, switched, viscosity_mu, viscous_pressure};
use sphorge_physics::xsph::{add_xsph, xsph_weight};
use sphorge_physics::{Numbers, Real, SymmetricTensor, Vector, artificial_stress};

/// Sums of a particle over its pairs.
#[derive(Clone, Copy)]
struct Forces {
    acceleration: Vector<Recorded>,
    stress_power: Recorded,
    /// XSPH velocity before its factor, m/s.
    smoothing: Vector<Recorded>,
    largest_mu: Recorded,
    viscous_power: Recorded,
    repulsive_power: Recorded,
}

impl Forces {
    fn zero() -> Self {
        let zero = Recorded::zero();
        Self {
            acceleration: [zero; 3],
            stress_power: zero,
            smoothing: [zero; 3],
            largest_mu: zero,
            viscous_power: zero,
            repulsive_power: zero,
        }
    }
}

impl Numbers<Recorded> for Forces {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.acceleration.each(visit);
        visit(&mut self.stress_power);
        self.smoothing.each(visit);
        visit(&mut self.largest_mu);
        visit(&mut self.viscous_power);
        visit(&mut self.repulsive_power);
    }
}

/// What the forces of a particle are made of.
struct ForcePairs<'a> {
    model: &'a Model,
    viscosity: ViscosityParameters<Recorded>,
    near: (CompensatedVector<Read>, groups::Constants<Read>),
    evaluated: VectorColumns<Read>,
    weight: groups::Weight<Read>,
    density: Compensated<Read>,
    packed: groups::Packed<Read>,
    /// Scaled stress times the gradient correction, if gradients are corrected.
    products: Option<TensorColumns<Read>>,
    i: Index,
    own: Vector<Recorded>,
    rho: Recorded,
    stress: SymmetricTensor<Recorded>,
    repulsion: SymmetricTensor<Recorded>,
    switch: Recorded,
    sound_speed: Recorded,
}

impl<'a> ForcePairs<'a> {
    fn of(bind: &mut Binder<'_>, model: &'a Model, i: Index) -> Self {
        let numerics = &model.numerics;
        let viscosity = ViscosityParameters {
            alpha: Recorded::of(numerics.viscosity_alpha),
            beta: Recorded::of(numerics.viscosity_beta),
        };
        let near = (groups::Place::read(bind).position, groups::Constants::read(bind));
        let (evaluated, weight) = (groups::Evaluated::read(bind).velocity, groups::Weight::read(bind));
        let (density, packed) = (groups::Density::read(bind).density, groups::Packed::read(bind));
        let (own, rho) = (evaluated.get(i), density.high().get(i));
        let (stress, repulsion) = (packed.stress.get(i), packed.artificial_stress.get(i));
        let (switch, sound_speed) = (packed.balsara.get(i), packed.sound_speed.get(i));
        let products = model.corrects_current_gradients().then(|| groups::CorrectedStress::read(bind).stress);
        Self {
            model,
            viscosity,
            near,
            evaluated,
            weight,
            density,
            packed,
            products,
            i,
            own,
            rho,
            stress,
            repulsion,
            switch,
            sound_speed,
        }
    }

    fn weight_of(&self, j: Index) -> Recorded {
        let numerics = &self.model.numerics;
        match (numerics.pair_form, numerics.integrator) {
            // The volumes of the gradient sum, at the same positions: both sums are adjoint to the bit.
            (PairForm::VolumeWeighted, Integrator::PredictorCorrector) => self.weight.weight.get(j),
            (PairForm::VolumeWeighted, Integrator::Leapfrog) | (PairForm::DensityWeighted | PairForm::Mixed, _) => {
                momentum_weight(numerics.pair_form, self.near.1.mass.get(j), self.density.high().get(j))
            }
        }
    }

    /// Adds a pair.
    fn add<const D: usize>(&self, mut state: Forces, pair: &Pair, j: Index) -> Forces {
        let (numerics, packed, rho) = (&self.model.numerics, self.packed, self.rho);
        let other = pair.image.vector(self.evaluated.get(j));
        let v = [0, 1, 2].map(|a| self.own[a] - other[a]);
        let mut v_dot_x = Recorded::zero();
        for a in 0..D {
            v_dot_x = v[a].mul_add(pair.x[a], v_dot_x);
        }
        let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
        let w_j = self.weight_of(j);
        let weighted = pair.scale.weighted(w_j);
        let mu = viscosity_mu(v_dot_x, pair.r2, pair.scale.h);
        let rho_j = self.density.high().get(j);
        let inverse_density = inverse_density_mean(rho, rho_j);
        let sound_speed = mean(self.sound_speed, packed.sound_speed.get(j));
        let pi = viscous_pressure(self.viscosity, mu, sound_speed, inverse_density);
        let mut pi = scaled_pressure(numerics.pair_form, pi, rho, rho_j);
        if numerics.balsara {
            pi = switched(pi, self.switch, packed.balsara.get(j));
        }
        let w = numerics.kernel.w(q);
        let artificial = self.artificial_stress::<D>(w, pair, j);
        let weighted_f = weighted.f(numerics.kernel.dw_over_q_by(q, inverse_q));
        let (own_stress, other_stress) = self.stresses::<D>(pair, j);
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
            acceleration: state.acceleration,
            stress_power: state.stress_power,
            viscous_power: state.viscous_power,
            repulsive_power: state.repulsive_power,
        };
        sums.add::<D>(numerics.energy_split, &force);
        (state.acceleration, state.stress_power) = (sums.acceleration, sums.stress_power);
        (state.viscous_power, state.repulsive_power) = (sums.viscous_power, sums.repulsive_power);
        if numerics.xsph != 0.0 {
            let mass_per_weight = self.near.1.mass.get(j) / w_j;
            let weight = xsph_weight(weighted.value(w), mass_per_weight, inverse_density);
            add_xsph::<_, D>(&mut state.smoothing, &v, weight);
        }
        state.largest_mu = state.largest_mu.max(mu.abs());
        state
    }

    /// The vector of the artificial stress of a pair, if there is one.
    fn artificial_stress<const D: usize>(&self, w: Recorded, pair: &Pair, j: Index) -> Vector<Recorded> {
        let none = [Recorded::zero(); 3];
        let Some(terms) = self.model.numerics.artificial_stress else { return none };
        let factor = artificial_stress::pair_factor(w, terms.exponent);
        let other = pair.image.symmetric(self.packed.artificial_stress.get(j));
        artificial_stress::pair_vector::<_, D>(self.repulsion, other, factor, &pair.x)
    }

    /// The stress vectors of both particles of a pair.
    fn stresses<const D: usize>(&self, pair: &Pair, j: Index) -> (Vector<Recorded>, Vector<Recorded>) {
        match self.products {
            None => (
                stress_vector::<_, D>(&self.stress, &pair.x),
                stress_vector::<_, D>(&pair.image.symmetric(self.packed.stress.get(j)), &pair.x),
            ),
            Some(products) => (
                corrected_stress_vector::<_, D>(&products.get(self.i), &pair.x),
                corrected_stress_vector::<_, D>(&pair.image.tensor(&products.get(j)), &pair.x),
            ),
        }
    }
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
    recording(&Through::name(through, "forces"), count, |bind, i| {
        let pairs = ForcePairs::of(bind, model, i);
        let (near, mass) = (pairs.near, pairs.near.1.mass);
        let start = Forces::zero();
        let factor = momentum_factor(numerics.pair_form, mass.get(i), pairs.weight_of(i));
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, near.0);
            let none = [Recorded::zero(); 3];
            let sum = over_neighbors::<_, D>(bind, model, i, near, none, |sum: Vector<Recorded>, pair, j| {
                crossing.add(sum, &pair.image, j, || pairs.add::<D>(start, pair, j), |sums| sums.acceleration)
            });
            crossing.set(sum.map(|of| of * factor * mass.get(i)), false);
            return;
        }
        let sums = over_neighbors::<_, D>(bind, model, i, near, start, |state, pair, j| pairs.add::<D>(state, pair, j));
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        let mut smoothed = sums.smoothing.map(|c| c * Recorded::of(numerics.xsph));
        if numerics.xsph != 0.0 {
            // Prescribed components drift only with their velocity.
            let step = groups::Step::shared(bind);
            smoothed = Motions::of(bind, model, step).map_or(smoothed, |of| of.of_particle(i).free(smoothed));
        }
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, sums.acceleration[a] * factor);
            rates.smoothing_velocity.axis(a).set(i, smoothed[a]);
        }
        rates.largest_mu.set(i, sums.largest_mu);
        let [viscous, repulsive] = [share_of_power(sums.viscous_power), share_of_power(sums.repulsive_power)];
        energy.rate.set(i, (sums.stress_power + viscous + repulsive) * factor);
        energy.viscous_rate.set(i, viscous * factor);
        energy.artificial_stress_rate.set(i, repulsive * factor);
    })
}
