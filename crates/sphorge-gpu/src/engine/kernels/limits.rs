//! How large the next step may be, and what the last has changed.

use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::engine::step_numbers::DT;
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;
use sphorge_physics::step_control::StepChange;
use sphorge_physics::tensor::dot;
use sphorge_physics::time_step::{acceleration_limit, longitudinal_speed, sound_limit};

/// Particles that one thread looks through.
pub(in crate::engine) const CHUNK: usize = 256;

/// Numbers of a particle: the two limits, four changes, and one where a number is none.
pub(in crate::engine) const FIELDS: usize = 7;

/// Numbers beyond this are none: no state of a metal comes near.
const BEYOND: f64 = 1e30;

/// Of each particle.
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
        let courant = Recorded::of(model.time.courant);
        let speed = longitudinal_speed(pressure.get(1, i), pressure.get(2, i), rho);
        let acceleration = rates.vector(0, i);
        let squared = dot(acceleration, acceleration);
        // Where nothing pushes there is no limit; the least of all is far below this one.
        let by_acceleration = acceleration_limit(h, squared.sqrt(), courant);
        let by_acceleration = Recorded::select_lt(Recorded::zero(), squared, by_acceleration, Recorded::of(BEYOND));
        let change = StepChange::of(
            &gradient.tensor(0, i),
            (energy.get(0, i), energy.get(2, i)),
            constants.get(4, i),
            &acceleration,
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
        limits.set(0, i, sound_limit(h, speed, rates.get(6, i), courant));
        limits.set(1, i, by_acceleration);
        limits.set_all(2, i, &[change.density, change.stretch, change.energy, change.jump, one - sound]);
    })
}

/// Of each chunk of particles: the least limits, the largest changes.
pub(in crate::engine) fn of_chunks(count: usize) -> Result<Recording, KernelFault> {
    let chunks = count.div_ceil(CHUNK);
    recording("extremes", count, |bind, chunk| {
        let (limits, extremes) = (bind.read(Group::Limits), bind.write(Group::Extremes));
        let first = chunk * Index::of(CHUNK as u32);
        let start = {
            let mut start = [Recorded::zero(); FIELDS];
            start[0] = Recorded::of(BEYOND);
            start[1] = Recorded::of(BEYOND);
            start
        };
        // Columns are padded to whole chunks with what limits nothing.
        let end = first + Index::of(CHUNK as u32);
        let least = bind.scope.fold(first, end, start, |_, mut least, i| {
            for (k, number) in least.iter_mut().enumerate() {
                let here = limits.get(k, i);
                *number = if k < 2 { number.min(here) } else { number.max(here) };
            }
            least
        });
        for (k, number) in least.into_iter().enumerate() {
            extremes.set(0, Index::of((k * chunks) as u32) + chunk, number);
        }
    })
}
