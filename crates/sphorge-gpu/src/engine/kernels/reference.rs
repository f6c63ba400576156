//! The reference configuration of the total Lagrangian form: its lists, built once, and the deformation from it.

use super::grid::Grid;
use super::images::Planes;
use super::neighbors::{now, over_list, over_own_body};
use crate::engine::columns::{Binder, Fields, Group, NOTHING, Reading, Recording, Writing, added, recording};
use crate::engine::step_numbers::DT;
use crate::record::{Double, Index, Indices, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_engine::particles::HistoryVariables;
use sphorge_physics::gradient_correction::{LARGEST_COMPONENT, corrected, gradient_correction};
use sphorge_physics::hourglass::is_fit;
use sphorge_physics::hyperelastic::composed;
use sphorge_physics::integrity::INTEGRITY;
use sphorge_physics::pair::GradientSums;
use sphorge_physics::tensor::{identity, multiply};
use sphorge_physics::thin::{Across, completed_rate, is_thin, reference_correction};
use sphorge_physics::total_lagrangian::{
    LARGEST_CORRECTION_APART, deformed_again, density, smallest_stretch, stretched, velocity_gradient,
};
use sphorge_physics::viscosity::bulk_mu;
use sphorge_physics::{Elementary, Real, SymmetricTensor, Tensor};

/// Kind of reference configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum References {
    Initial,
    /// At least one has been renewed.
    Renewed,
}

/// By body, whether it has come apart, and whether its reference configuration is to be renewed: one or zero.
#[derive(Clone, Copy)]
pub(super) struct Apart {
    flags: Reading,
    body: Indices,
    bodies: u32,
}

impl Apart {
    /// Nothing if none has.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Option<Self> {
        (references == References::Renewed).then(|| Self {
            flags: bind.read(Group::Apart),
            body: bind.indices(Group::Body),
            bodies: model.bodies.len() as u32,
        })
    }

    /// For the body of a particle.
    pub(super) fn has_come_apart(self, i: Index) -> Recorded {
        self.flags.get_at(self.body.at(i))
    }

    fn is_due(self, i: Index) -> Recorded {
        self.flags.get_at(Index::of(self.bodies) + self.body.at(i))
    }
}

/// Deformation gradients of particles.
#[derive(Clone, Copy)]
pub(super) struct Deformations {
    since: Reading,
    earlier: Option<Reading>,
}

impl Deformations {
    pub(super) fn of(bind: &mut Binder<'_>, references: References) -> Self {
        let since = bind.read(Group::Deformation);
        Self { since, earlier: (references == References::Renewed).then(|| bind.read(Group::Earlier)) }
    }

    /// Since the reference configuration.
    pub(super) fn since_reference(self, i: Index) -> Tensor<Recorded> {
        self.since.tensor(0, i)
    }

    /// That of the reference configuration, if it is not the initial one.
    pub(super) fn earlier(self, i: Index) -> Option<Tensor<Recorded>> {
        self.earlier.map(|earlier| earlier.tensor(0, i))
    }

    /// `F - 1` since the start.
    pub(super) fn displacement_gradient(self, i: Index) -> Tensor<Recorded> {
        let since = less_identity(self.since, i);
        self.earlier.map_or(since, |earlier| composed(&since, &less_identity(earlier, i)))
    }

    /// Since the start.
    pub(super) fn whole(self, i: Index) -> Tensor<Recorded> {
        let f = self.since_reference(i);
        self.earlier(i).map_or(f, |earlier| multiply(&f, &earlier))
    }
}

/// `F - 1` of deformation gradients with their rests, with the digits that single precision does not have of `F`.
pub(super) fn less_identity(deformation: Reading, i: Index) -> Tensor<Recorded> {
    [0, 1, 2].map(|a| {
        [0, 1, 2].map(|b| {
            let [high, low] = deformation.double(3 * a + b, 9 + 3 * a + b, i);
            if a == b { (high - Recorded::one()) + low } else { high + low }
        })
    })
}

/// Makes the current configuration of bodies that are due their reference: positions, volumes, and deformation
/// gradients that start at one. Deformation is that of the start of the step, and so are the positions: without the
/// drift of the step.
pub(in crate::engine) fn renew(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("renew_reference", count, |bind, i| {
        let Some(apart) = Apart::of(bind, model, References::Renewed) else { return };
        let (place, density, constants) =
            (bind.read(Group::Place), bind.read(Group::Density), bind.read(Group::Constants));
        let (velocity, step) = (bind.read(Group::Velocity), bind.read(Group::Step));
        let (reference, stretch) = (bind.write(Group::Reference), bind.write(Group::Stretch));
        let (since, earlier) = (bind.write(Group::Deformation), bind.write(Group::Earlier));
        let springs = bind.write(Group::Springs);
        let renew = || {
            let dt = step.get(0, Index::of(DT));
            for a in 0..3 {
                let start = added(place.double(a, 3 + a, i), -(dt * velocity.get(a, i)));
                reference.set(a, i, start[0]);
                reference.set(3 + a, i, start[1]);
            }
            let volume = Double::from(constants.get(0, i)) / Double::new(density.double(0, 1, i));
            reference.set_all(6, i, &[volume.high, volume.low]);
            let tensor =
                |of: Writing| [0, 1, 2].map(|a| [0, 1, 2].map(|b| Double::new(of.double(3 * a + b, 9 + 3 * a + b, i))));
            let whole = multiply(&tensor(since), &tensor(earlier));
            for (k, component) in whole.into_iter().flatten().enumerate() {
                earlier.set(k, i, component.high);
                earlier.set(9 + k, i, component.low);
            }
            for (k, one) in identity::<Recorded>().into_iter().flatten().enumerate() {
                since.set(k, i, one);
                since.set(9 + k, i, Recorded::zero());
            }
            stretch.set(0, i, Recorded::one());
            springs.set(0, i, Recorded::one());
            springs.set_all(1, i, &[Recorded::zero(); 10]);
            NOTHING
        };
        Recorded::if_lt(Recorded::of(0.5), apart.is_due(i), renew, || NOTHING);
    })
}

/// Number of neighbours of every particle.
pub(in crate::engine) fn count<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("count_neighbors", count, |bind, i| {
        let near = (bind.read(Group::Reference), now(bind.read(Group::Constants)));
        let weight = bind.write(Group::Weight);
        let zero = Recorded::zero();
        let sum = over_own_body::<_, D>(bind, model, grid, i, near, zero, |sum: Recorded, _, _| sum + Recorded::one());
        weight.set(1, i, sum);
    })
}

/// The list of every particle, from its start on.
pub(in crate::engine) fn list<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("list_neighbors", count, |bind, i| {
        let near = (bind.read(Group::Reference), now(bind.read(Group::Constants)));
        let (starts, list) = (bind.indices(Group::ListStarts), bind.index_output(Group::List));
        let first = starts.at(i);
        over_own_body::<_, D>(bind, model, grid, i, near, Recorded::zero(), |before: Recorded, pair, j| {
            list.set(first + Index::floor(before), Planes::entry_of(pair.bits, j));
            before + Recorded::one()
        });
    })
}

/// The gradient correction of every particle. Where it is left out, springs are too.
pub(in crate::engine) fn correct<const D: usize>(
    model: &Model,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    let kernel = model.numerics.kernel;
    recording("correct_reference", count, |bind, i| {
        let apart = Apart::of(bind, model, references);
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (correction, springs) = (bind.write(Group::Correction), bind.write(Group::Springs));
        let zero = [[Recorded::zero(); 3]; 3];
        let moment = over_list::<_, D>(bind, model, i, near, zero, |moment: [[Recorded; 3]; 3], pair, j| {
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { moment, ..GradientSums::zero() };
            sums.add::<D, true>(&pair.x, &[Recorded::zero(); 3], f);
            sums.moment
        });
        let dimension = model.dimensions.into();
        let usual = || reference_correction(&moment, dimension, Recorded::of(LARGEST_COMPONENT));
        let of_pieces = || gradient_correction(&moment, dimension, Recorded::of(LARGEST_CORRECTION_APART));
        let b = match apart {
            None => usual(),
            Some(apart) => Recorded::if_lt(Recorded::of(0.5), apart.has_come_apart(i), of_pieces, usual),
        };
        correction.set_all(0, i, b.as_flattened());
        springs.set(0, i, springs.get(0, i) * is_fit(&moment, &b, model.dimensions.into()));
    })
}

/// One for a particle that has failed and bears nothing any more, else zero.
fn is_deleted(bind: &mut Binder<'_>, model: &Model, i: Index) -> Recorded {
    let deletes = |b: &usize| model.materials[model.bodies[*b].material].deletes();
    let deleting: Vec<usize> = (0..model.bodies.len()).filter(deletes).collect();
    let variables = HistoryVariables::of(model).variables;
    let place = variables.iter().position(|variable| variable.name == INTEGRITY.name);
    let Some(place) = place.filter(|_| !deleting.is_empty()) else { return Recorded::zero() };
    let (body, integrity) = (bind.indices(Group::Body).at(i).number(), bind.read(Group::History).get(2 * place, i));
    let severed = Recorded::select_lt(Recorded::zero(), integrity, Recorded::zero(), Recorded::one());
    deleting.into_iter().fold(Recorded::zero(), |one, b| {
        let other = (body - Recorded::of(b as f64)).abs();
        Recorded::select_lt(other, Recorded::of(0.5), severed, one)
    })
}

/// Deformation gradient, velocity gradient and density. What is deleted keeps its deformation and has no springs: nothing resists what its
/// neighbours do, and it must not limit the step.
pub(in crate::engine) fn deform<const D: usize>(
    model: &Model,
    (renewal, references): (Option<f64>, References),
    count: usize,
) -> Result<Recording, KernelFault> {
    let kernel = model.numerics.kernel;
    recording("deform", count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (velocity, correction) = (bind.read(Group::Velocity), bind.read(Group::Correction));
        let (gradient, of_density) = (bind.write(Group::Gradient), bind.write(Group::Density));
        let (deformation, stretch) = (bind.write(Group::Deformation), bind.write(Group::Stretch));
        let (rates, step) = (bind.write(Group::Rates), bind.read(Group::Step));
        let (springs, plastic) = (bind.write(Group::Springs), bind.read(Group::Plastic));
        let (deviator, pressures) = (bind.read(Group::Deviator), bind.read(Group::Pressure));
        let apart = Apart::of(bind, model, references);
        let own = velocity.vector(0, i);
        let zero = [[Recorded::zero(); 3]; 3];
        let sum = over_list::<_, D>(bind, model, i, near, zero, |gradient: [[Recorded; 3]; 3], pair, j| {
            let other = pair.image.vector(velocity.vector(0, j));
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { gradient, ..GradientSums::zero() };
            sums.add::<D, false>(&pair.x, &[0, 1, 2].map(|a| other[a] - own[a]), f);
            sums.gradient
        });
        let dt = step.get(0, Index::of(DT));
        let correction = correction.tensor(0, i);
        let rate = corrected(&sum, &correction);
        let complete = || {
            let ([pressure, sound_speed], rho) = ([0, 1].map(|field| pressures.get(field, i)), of_density.get(0, i));
            let across = Across {
                bulk_modulus: rho * sound_speed * sound_speed,
                shear_modulus: pressures.get(2, i),
                stress: deviator.symmetric(0, i) - SymmetricTensor::isotropic(pressure),
            };
            completed_rate(&deformation.tensor(0, i), &rate, &correction, &across, dt)
        };
        let rate = Recorded::if_lt(Recorded::zero(), is_thin(&correction), complete, || rate);
        let left = Recorded::one() - is_deleted(bind, model, i);
        let rate = rate.map(|row| row.map(|c| left * c));
        let l = velocity_gradient(&deformation.tensor(0, i), &rate, dt);
        for (k, rate) in rate.into_iter().flatten().enumerate() {
            deformation.add(k, 9 + k, i, dt * rate);
        }
        let f = deformation.tensor(0, i);
        let smallest = smallest_stretch(&f);
        gradient.set_all(0, i, l.as_flattened());
        let double = |a: usize, b: usize| Double::new(deformation.double(3 * a + b, 9 + 3 * a + b, i));
        let whole = [0, 1, 2].map(|a| [0, 1, 2].map(|b| double(a, b)));
        let rho = density(Double::from(near.1.get(0, i)), Double::new(near.0.double(6, 7, i)), &whole);
        of_density.set_all(0, i, &[rho.high, rho.low]);
        stretch.set(0, i, smallest);
        let least = springs.get(0, i);
        springs.set(0, i, left * Recorded::select_lt(Recorded::zero(), plastic.get(2, i), least.min(smallest), least));
        let too_far = |bound: f64| {
            let once = || stretched(&f, Recorded::of(bound));
            apart.map_or_else(once, |apart| {
                let again = || deformed_again(&f, smallest);
                Recorded::if_lt(Recorded::of(0.5), apart.has_come_apart(i), again, once)
            })
        };
        stretch.set(2, i, renewal.map_or_else(Recorded::zero, too_far));
        rates.set(6, i, bulk_mu(&l, near.1.get(1, i) * smallest));
    })
}
