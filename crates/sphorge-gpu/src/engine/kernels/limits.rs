//! Limits of the next step, and changes by the last one.

use super::motion::Motions;
use super::reduce::{Together, carry, over_particles, rows};
use crate::engine::columns::{Group, Member, ReadColumns, ReadShared, Recording, WriteColumns, groups, recording};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_engine::particles::HistoryVariables;
use sphorge_physics::Real;
use sphorge_physics::parameter::Bound;
use sphorge_physics::step_control::StepChange;
use sphorge_physics::tensor::dot;
use sphorge_physics::time_step::{acceleration_limit, longitudinal_speed, sound_limit};
use sphorge_physics::total_lagrangian::limiting_length;

/// Columns have the length of whole chunks of this number of particles.
pub(in crate::engine) const CHUNK: usize = 256;

/// Numbers of a particle: the limits, four changes, one if a value is not a number, one if it is stretched beyond a
/// bound, how far its facets reach, m, and its neighbours.
pub(in crate::engine) const FIELDS: usize = 11;

/// Limits among them: by sound, by acceleration and by the contact.
pub(in crate::engine) const LIMITS: usize = 3;

/// The last of them.
pub(in crate::engine) const STRETCHED: usize = 8;
pub(in crate::engine) const REACH: usize = 9;
pub(in crate::engine) const NEIGHBORS: usize = 10;

/// Numbers of [`Group::Extremes`]: the same, followed by the [units](super::reduce::UNITS) of the neighbours.
pub(in crate::engine) const EXTREMES: usize = FIELDS + 1;

/// Values beyond this count as not a number: no state of a metal comes near.
const BEYOND: f64 = 1e30;

/// For each particle.
pub(in crate::engine) fn of_particles(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("limits", count, |bind, i| {
        let (place, velocity, density) = (
            groups::Place::read(bind).position,
            groups::Velocity::read(bind).velocity,
            groups::Density::read(bind).density,
        );
        let (gradient, energy, rates) =
            (groups::Gradient::read(bind).velocity_gradient, groups::Energy::read(bind), groups::Rates::read(bind));
        let (pressure, constants, step) =
            (groups::Pressure::read(bind), groups::Constants::read(bind), groups::Step::shared(bind));
        let (deviator, temperature) =
            (groups::Deviator::read(bind).deviator, groups::Temperature::read(bind).temperature);
        let limits = groups::Limits::write(bind);
        let (h, rho) = (constants.smoothing_length.get(i), density.high().get(i));
        let stretch = model.is_total_lagrangian().then(|| groups::Stretch::read(bind));
        let shortest = stretch.map_or(h, |stretch| limiting_length(h, stretch.smallest.get(i)));
        let courant = Recorded::of(model.time.courant);
        let speed = longitudinal_speed(pressure.sound_speed.get(i), pressure.shear_modulus.get(i), rho);
        let acceleration = rates.acceleration.get(i);
        let squared = dot(acceleration, acceleration);
        // Without acceleration there is no limit; the smallest of all limits is far below this one.
        let by_acceleration = acceleration_limit(shortest, squared.sqrt(), courant);
        let by_acceleration = Recorded::select_lt(Recorded::zero(), squared, by_acceleration, Recorded::of(BEYOND));
        let change = StepChange::of(
            &gradient.get(i),
            (energy.energy.high().get(i), energy.rate.get(i)),
            constants.sound_speed.get(i),
            // Forces on a driven particle do not move it.
            &Motions::of(bind, model, step).map_or(acceleration, |of| of.of_particle(i).undriven(acceleration)),
            h,
            step.dt.value(),
        );
        let mut numbers =
            vec![pressure.pressure.get(i), energy.energy.high().get(i), energy.rate.get(i), temperature.high().get(i)];
        for vector in [place.high().get(i), velocity.high().get(i), acceleration, rates.smoothing_velocity.get(i)] {
            numbers.extend(vector);
        }
        numbers.extend(deviator.get(i).to_array());
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let mut sound = Recorded::select_lt(zero, rho, one, zero);
        for number in numbers {
            sound = Recorded::select_lt(number.abs(), Recorded::of(BEYOND), sound, zero);
        }
        let variables = HistoryVariables::of(model).variables;
        if !variables.is_empty() {
            let history = groups::History::read(bind);
            for (k, variable) in variables.into_iter().enumerate() {
                sound = allowed(variable.bound, history.of(k).value.high().get(i), sound);
            }
        }
        let by_sound = sound_limit(shortest, speed, rates.largest_mu.get(i), courant);
        // Without viscosity there is no other limit; that of sound is far below this one.
        let damped = stretch.map_or(zero, |stretch| stretch.damping_rate.get(i)).max(Recorded::of(1.0 / BEYOND));
        limits.by_sound.set(i, by_sound.min(Recorded::of(model.time.share_of_damping()) / damped));
        limits.by_acceleration.set(i, by_acceleration);
        let mut by_contact = || groups::Contact::read(bind).limit.get(i);
        limits.by_contact.set(i, if model.has_contact() { by_contact() } else { Recorded::of(BEYOND) });
        let is_broken = one - sound;
        limits.changes.set(i, [change.density, change.stretch, change.energy, change.jump]);
        limits.is_broken.set(i, is_broken);
        limits.is_stretched.set(i, stretch.map_or(zero, |stretch| stretch.is_beyond.get(i)));
        let mut reach = || groups::FacetMotion::read(bind).reach.get(i);
        limits.facet_reach.set(i, if model.has_facets() { reach() } else { zero });
        limits.neighbors.set(i, groups::Weight::read(bind).neighbors.get(i));
    })
}

/// A number if a bound allows a value, else zero.
fn allowed(bound: Bound, value: Recorded, then: Recorded) -> Recorded {
    let zero = Recorded::zero();
    let is_finite = Recorded::select_lt(value.abs(), Recorded::of(BEYOND), then, zero);
    match bound {
        Bound::Any => is_finite,
        Bound::Positive => Recorded::select_lt(zero, value, is_finite, zero),
        Bound::NonNegative => Recorded::select_lt(value, zero, zero, is_finite),
        Bound::Between(low, high) => {
            let below = Recorded::select_lt(value, Recorded::of(low), zero, is_finite);
            Recorded::select_lt(Recorded::of(high), value, zero, below)
        }
    }
}

/// Reduction of the numbers of particles.
pub(in crate::engine) fn together() -> [Together; EXTREMES] {
    core::array::from_fn(|k| match k {
        _ if k < LIMITS => Together::Least,
        NEIGHBORS => Together::Ones,
        FIELDS => Together::Units,
        _ => Together::Largest,
    })
}

/// For parts of the particles: the smallest limits, the largest changes.
pub(in crate::engine) fn extremes(count: usize) -> Result<Recording, KernelFault> {
    let rows = rows(count);
    recording("extremes", count, |bind, row| {
        let (limits, extremes) = (bind.read(Group::Limits), bind.write(Group::Extremes));
        let start = {
            let mut start = [Recorded::zero(); EXTREMES];
            start[..LIMITS].fill(Recorded::of(BEYOND));
            start
        };
        // Columns are padded to whole chunks with values that limit nothing.
        let mut least = over_particles(bind, (count, row), start, |mut least, i| {
            for (k, number) in least[..FIELDS].iter_mut().enumerate() {
                *number = together()[k].of(*number, limits.get(k, i));
            }
            least
        });
        carry(&mut least, &together());
        for (k, number) in least.into_iter().enumerate() {
            extremes.set_at(Index::of((k * rows) as u32) + row, number);
        }
    })
}
