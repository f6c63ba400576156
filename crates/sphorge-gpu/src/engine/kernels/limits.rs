//! Limits of the next step, and changes by the last one.

use super::motion::Motions;
use super::reduce::{Together, carry, over_particles, rows};
use super::{contact, facets};
use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::engine::step_numbers::DT;
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
        let (place, velocity, density) =
            (bind.read(Group::Place), bind.read(Group::Velocity), bind.read(Group::Density));
        let (gradient, energy, rates) = (bind.read(Group::Gradient), bind.read(Group::Energy), bind.read(Group::Rates));
        let (pressure, constants, step) =
            (bind.read(Group::Pressure), bind.read(Group::Constants), bind.read(Group::Step));
        let (deviator, temperature) = (bind.read(Group::Deviator), bind.read(Group::Temperature));
        let limits = bind.write(Group::Limits);
        let (h, rho) = (constants.get(1, i), density.get(0, i));
        let stretch = model.is_total_lagrangian().then(|| bind.read(Group::Stretch));
        let shortest = stretch.map_or(h, |stretch| limiting_length(h, stretch.get(0, i)));
        let courant = Recorded::of(model.time.courant);
        let speed = longitudinal_speed(pressure.get(1, i), pressure.get(2, i), rho);
        let acceleration = rates.vector(0, i);
        let squared = dot(acceleration, acceleration);
        // Without acceleration there is no limit; the smallest of all limits is far below this one.
        let by_acceleration = acceleration_limit(shortest, squared.sqrt(), courant);
        let by_acceleration = Recorded::select_lt(Recorded::zero(), squared, by_acceleration, Recorded::of(BEYOND));
        let change = StepChange::of(
            &gradient.tensor(0, i),
            (energy.get(0, i), energy.get(2, i)),
            constants.get(4, i),
            // Forces on a driven particle do not move it.
            &Motions::of(bind, model, step).map_or(acceleration, |of| of.of_particle(i).undriven(acceleration)),
            h,
            step.get(0, Index::of(DT)),
        );
        let mut numbers = vec![pressure.get(0, i), energy.get(0, i), energy.get(2, i), temperature.get(0, i)];
        for vector in [place.vector(0, i), velocity.vector(0, i), acceleration, rates.vector(3, i)] {
            numbers.extend(vector);
        }
        numbers.extend(deviator.symmetric(0, i).to_array());
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let mut sound = Recorded::select_lt(zero, rho, one, zero);
        for number in numbers {
            sound = Recorded::select_lt(number.abs(), Recorded::of(BEYOND), sound, zero);
        }
        let variables = HistoryVariables::of(model).variables;
        if !variables.is_empty() {
            let history = bind.read(Group::History);
            for (k, variable) in variables.into_iter().enumerate() {
                sound = allowed(variable.bound, history.get(2 * k, i), sound);
            }
        }
        limits.set(0, i, sound_limit(shortest, speed, rates.get(6, i), courant));
        limits.set(1, i, by_acceleration);
        let mut by_contact = || bind.read(Group::Contact).get(contact::LIMIT, i);
        limits.set(2, i, if model.has_contact() { by_contact() } else { Recorded::of(BEYOND) });
        limits.set_all(LIMITS, i, &[change.density, change.stretch, change.energy, change.jump, one - sound]);
        limits.set(STRETCHED, i, stretch.map_or(zero, |stretch| stretch.get(2, i)));
        let mut reach = || bind.read(Group::FacetMotion).get(facets::REACH, i);
        limits.set(REACH, i, if model.has_facets() { reach() } else { zero });
        limits.set(NEIGHBORS, i, bind.read(Group::Weight).get(1, i));
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
