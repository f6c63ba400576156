//! The reference configuration of the total Lagrangian form: its lists, built once, and the deformation from it.

use super::face_sums::{Near, linear};
use super::grid::Grid;
use super::images::Planes;
use super::neighbors::{now, over_list, over_own_body};
use crate::engine::columns::{
    Binder, CompensatedTensor, Group, Member, NOTHING, Number, Read, ReadColumns, ReadShared, Reading, Recording,
    WriteColumns, added, groups, recording,
};
use crate::record::{Double, Index, Indices, KernelFault, Recorded};
use sphorge_engine::model::{Material, Model};
use sphorge_engine::particles::HistoryVariables;
use sphorge_physics::gradient_correction::LARGEST_COMPONENT;
use sphorge_physics::hourglass::is_fit;
use sphorge_physics::hyperelastic::composed;
use sphorge_physics::integrity::share_of_springs;
use sphorge_physics::pair::GradientSums;
use sphorge_physics::tensor::{identity, multiply, plus};
use sphorge_physics::thin::{Across, completed_rate, correction_of_pieces, is_thin, reference_correction};
use sphorge_physics::total_lagrangian::{deformed_again, density, smallest_stretch, stretched, velocity_gradient};
use sphorge_physics::viscosity::bulk_mu;
use sphorge_physics::{Elementary, Real, SymmetricTensor, Tensor};

/// Kind of reference configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum References {
    Initial,
    /// At least one has been renewed.
    Renewed,
}

/// By body, whether it has separated, and whether its reference configuration is to be renewed: one or zero.
#[derive(Clone, Copy)]
pub(super) struct Separated {
    flags: Reading,
    body: Indices,
    bodies: u32,
}

impl Separated {
    /// Nothing if none has.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Option<Self> {
        (references == References::Renewed).then(|| Self {
            flags: bind.read(Group::Apart),
            body: bind.indices(Group::Body),
            bodies: model.bodies.len() as u32,
        })
    }

    /// For the body of a particle.
    pub(super) fn has_separated(self, i: Index) -> Recorded {
        self.flags.get_at(self.body.at(i))
    }

    fn is_due(self, i: Index) -> Recorded {
        self.flags.get_at(Index::of(self.bodies) + self.body.at(i))
    }
}

/// Deformation gradients of particles.
#[derive(Clone, Copy)]
pub(super) struct Deformations {
    since: CompensatedTensor<Read>,
    earlier: Option<CompensatedTensor<Read>>,
}

impl Deformations {
    pub(super) fn of(bind: &mut Binder<'_>, references: References) -> Self {
        let since = groups::Deformation::read(bind).deformation;
        Self { since, earlier: (references == References::Renewed).then(|| groups::Earlier::read(bind).deformation) }
    }

    /// Since the reference configuration.
    pub(super) fn since_reference(self, i: Index) -> Tensor<Recorded> {
        self.since.high().get(i)
    }

    /// That of the reference configuration, if it is not the initial one.
    pub(super) fn earlier(self, i: Index) -> Option<Tensor<Recorded>> {
        self.earlier.map(|earlier| earlier.high().get(i))
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

/// `F - 1` of deformation gradients with their low parts, with the digits that single precision does not have of `F`.
pub(super) fn less_identity(deformation: CompensatedTensor<Read>, i: Index) -> Tensor<Recorded> {
    [0, 1, 2].map(|a| {
        [0, 1, 2].map(|b| {
            let [high, low] = deformation.component(3 * a + b).get(i);
            if a == b { (high - Recorded::one()) + low } else { high + low }
        })
    })
}

/// Makes the current configuration of bodies that are due their reference: positions, volumes, and deformation
/// gradients that start at one. Deformation is that of the start of the step, and so are the positions: without the
/// drift of the step.
pub(in crate::engine) fn renew(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("renew_reference", count, |bind, i| {
        let Some(apart) = Separated::of(bind, model, References::Renewed) else { return };
        let (place, density, constants) =
            (groups::Place::read(bind).position, groups::Density::read(bind).density, groups::Constants::read(bind));
        let (velocity, step) = (groups::Velocity::read(bind).velocity, groups::Step::shared(bind));
        let (reference, stretch) = (groups::Reference::write(bind), groups::Stretch::write(bind));
        let (since, earlier) = (groups::Deformation::write(bind).deformation, groups::Earlier::write(bind).deformation);
        let springs = groups::Springs::write(bind);
        let excess = model.formulation.is_quadratic_at_faces().then(|| groups::FaceExcess::write(bind).excess);
        let renew = || {
            let dt = step.dt.value();
            for a in 0..3 {
                let start = added(place.axis(a).get(i), -(dt * velocity.high().axis(a).get(i)));
                reference.position.axis(a).set(i, start);
            }
            let volume = Double::from(constants.mass.get(i)) / Double::new(density.get(i));
            reference.volume.set(i, [volume.high, volume.low]);
            let whole = multiply(&since.doubles(i), &earlier.doubles(i));
            for (k, component) in whole.into_iter().flatten().enumerate() {
                earlier.component(k).set(i, [component.high, component.low]);
            }
            for (k, one) in identity::<Recorded>().into_iter().flatten().enumerate() {
                since.component(k).set(i, [one, Recorded::zero()]);
            }
            stretch.smallest.set(i, Recorded::one());
            springs.least_stretch.set(i, Recorded::one());
            springs.misfit.set(i, Recorded::zero());
            springs.moment.set(i, &[[Recorded::zero(); 3]; 3]);
            if let Some(excess) = excess {
                (0..9).for_each(|k| excess.component(k).set(i, [Recorded::zero(); 2]));
            }
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
        let near = (groups::Reference::read(bind).position, now(groups::Constants::read(bind)));
        let weight = groups::Weight::write(bind);
        let zero = Recorded::zero();
        let sum = over_own_body::<_, D>(bind, model, grid, i, near, zero, |sum: Recorded, _, _| sum + Recorded::one());
        weight.neighbors.set(i, sum);
    })
}

/// The list of every particle, from its start on.
pub(in crate::engine) fn list<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("list_neighbors", count, |bind, i| {
        let near = (groups::Reference::read(bind).position, now(groups::Constants::read(bind)));
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
        let apart = Separated::of(bind, model, references);
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (correction, springs) = (groups::Correction::write(bind).correction, groups::Springs::write(bind));
        let zero = [[Recorded::zero(); 3]; 3];
        let moment = over_list::<_, D>(bind, model, i, near, zero, |moment: [[Recorded; 3]; 3], pair, j| {
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.volume.high().get(j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { moment, ..GradientSums::zero() };
            sums.add::<D, true>(&pair.x, &[Recorded::zero(); 3], f);
            sums.moment
        });
        let dimension = model.dimensions.into();
        let usual = || reference_correction(&moment, dimension, Recorded::of(LARGEST_COMPONENT));
        let of_pieces = || correction_of_pieces(&moment, dimension);
        let b = match apart {
            None => usual(),
            Some(apart) => Recorded::if_lt(Recorded::of(0.5), apart.has_separated(i), of_pieces, usual),
        };
        correction.set(i, &b);
        springs.least_stretch.set(i, springs.least_stretch.get(i) * is_fit(&moment, &b, model.dimensions.into()));
    })
}

/// Integrities of particles, if some material breaks.
pub(super) fn integrities(bind: &mut Binder<'_>, model: &Model) -> Option<Number<Read>> {
    let place = HistoryVariables::of(model).integrity()?;
    Some(groups::History::read(bind).of(place).value.high())
}

/// The integrity of a particle, and of bodies for whose material that is so whether it is part of one, as one or zero; nothing where there is no such
/// body.
fn integrity_within(
    bind: &mut Binder<'_>,
    model: &Model,
    is_so: fn(&Material) -> bool,
    i: Index,
) -> Option<(Recorded, Recorded)> {
    let bodies: Vec<usize> =
        (0..model.bodies.len()).filter(|b| is_so(&model.materials[model.bodies[*b].material])).collect();
    if bodies.is_empty() {
        return None;
    }
    let (integrity, body) = (integrities(bind, model)?.get(i), bind.indices(Group::Body).at(i).number());
    let within = bodies.into_iter().fold(Recorded::zero(), |within, b| {
        let other = (body - Recorded::of(b as f64)).abs();
        Recorded::select_lt(other, Recorded::of(0.5), Recorded::one(), within)
    });
    Some((integrity, within))
}

/// One for a particle that has failed and bears nothing any more, else zero.
pub(super) fn is_deleted(bind: &mut Binder<'_>, model: &Model, i: Index) -> Recorded {
    let Some((integrity, within)) = integrity_within(bind, model, Material::deletes, i) else {
        return Recorded::zero();
    };
    Recorded::select_lt(Recorded::zero(), integrity, Recorded::zero(), within)
}

/// Deformation gradient, velocity gradient and density. What is deleted keeps its deformation and has no springs: nothing resists what its
/// neighbours do, and it must not limit the step.
pub(in crate::engine) fn deform<const D: usize>(
    model: &Model,
    (renewal, references): (Option<f64>, References),
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("deform", count, |bind, i| {
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (velocity, correction) = (groups::Velocity::read(bind).velocity, groups::Correction::read(bind).correction);
        let (gradient, of_density) =
            (groups::Gradient::write(bind).velocity_gradient, groups::Density::write(bind).density);
        let (deformation, stretch) = (groups::Deformation::write(bind).deformation, groups::Stretch::write(bind));
        let (rates, step) = (groups::Rates::write(bind), groups::Step::shared(bind));
        let (springs, plastic) = (groups::Springs::write(bind), groups::Plastic::read(bind));
        let (deviator, pressures) = (groups::Deviator::read(bind).deviator, groups::Pressure::read(bind));
        let apart = Separated::of(bind, model, references);
        let rate = if model.formulation.is_quadratic_at_faces() {
            let (linear, taken) = (groups::FaceLinear::read(bind).gradient, groups::FaceTaken::read(bind).rate);
            plus(&linear.get(i), -Recorded::one(), &taken.get(i))
        } else {
            let of = Near { reference: near.0, constants: near.1, correction };
            linear::<D>(bind, model, i, of, |j| velocity.high().get(j))
        };
        let dt = step.dt.value();
        let correction = correction.get(i);
        let complete = || {
            let ([pressure, sound_speed], rho) =
                ([pressures.pressure, pressures.sound_speed].map(|of| of.get(i)), of_density.high().get(i));
            let across = Across {
                bulk_modulus: rho * sound_speed * sound_speed,
                shear_modulus: pressures.shear_modulus.get(i),
                stress: deviator.get(i) - SymmetricTensor::isotropic(pressure),
            };
            completed_rate(&deformation.high().get(i), &rate, &correction, &across, dt)
        };
        let rate = Recorded::if_lt(Recorded::zero(), is_thin(&correction), complete, || rate);
        let left = Recorded::one() - is_deleted(bind, model, i);
        let rate = rate.map(|row| row.map(|c| left * c));
        let l = velocity_gradient(&deformation.high().get(i), &rate, dt);
        for (k, rate) in rate.into_iter().flatten().enumerate() {
            deformation.component(k).add(i, dt * rate);
        }
        let f = deformation.high().get(i);
        let smallest = smallest_stretch(&f);
        gradient.set(i, &l);
        let whole = deformation.doubles(i);
        let rho = density(Double::from(near.1.mass.get(i)), near.0.volume.double(i), &whole);
        of_density.set(i, [rho.high, rho.low]);
        stretch.smallest.set(i, smallest);
        let least = springs.least_stretch.get(i);
        let least = Recorded::select_lt(Recorded::zero(), plastic.increment.get(i), least.min(smallest), least);
        let brittle = integrity_within(bind, model, Material::is_brittle, i);
        // Springs have the root of it.
        let least = brittle.map_or(least, |(integrity, within)| {
            let share = share_of_springs(integrity);
            least.min(Recorded::select_lt(Recorded::zero(), within, share * share, Recorded::one()))
        });
        springs.least_stretch.set(i, left * least);
        let too_far = |bound: f64| {
            let once = || stretched(&f, Recorded::of(bound));
            apart.map_or_else(once, |apart| {
                let again = || deformed_again(&f, smallest);
                Recorded::if_lt(Recorded::of(0.5), apart.has_separated(i), again, once)
            })
        };
        stretch.is_beyond.set(i, renewal.map_or_else(Recorded::zero, too_far));
        rates.largest_mu.set(i, bulk_mu(&l, near.1.smoothing_length.get(i) * smallest));
    })
}
