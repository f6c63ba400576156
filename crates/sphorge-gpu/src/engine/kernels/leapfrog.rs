//! Kick-drift-kick leapfrog.

use super::kick::Kicks;
use super::motion::When;
use crate::engine::columns::{Fields, Group, Recording, added, recording};
use crate::engine::step_numbers::{DT, HALF};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;

/// First half kick, drift, and the velocity at which forces are evaluated: that of the end of the step, predicted with
/// the last acceleration.
pub(in crate::engine) fn begin(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("kick_and_drift", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (place, velocity, ahead) =
            (bind.write(Group::Place), bind.write(Group::Velocity), bind.write(Group::Ahead));
        let evaluated = bind.write(Group::Evaluated);
        let (dt, half) = (kicks.step.get(0, Index::of(DT)), kicks.step.get(0, Index::of(HALF)));
        let held = kicks.motions.map(|motions| motions.of_particle(i));
        let axes = [0, 1, 2].map(|a| {
            let (after, axis) = kicks.axis(a, i, velocity.double(a, 3 + a, i), ahead.get(a, i), (half, When::Middle));
            let moved = added(place.double(a, 3 + a, i), dt * (after[0] + kicks.rates.get(3 + a, i)));
            for k in 0..2 {
                velocity.set(a + 3 * k, i, after[k]);
                place.set(a + 3 * k, i, moved[k]);
            }
            let mut predicted = (after[0] + half * kicks.rates.get(a, i)).rounded();
            if let Some(held) = held {
                predicted = held.choose(a, held.velocity(a, When::End), predicted);
            }
            evaluated.set(a, i, predicted);
            ahead.set(a, i, (after[0] - predicted).rounded() + after[1]);
            axis
        });
        kicks.book(i, &axes, half);
    })
}

/// Second half kick.
pub(in crate::engine) fn finish(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("kick", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (velocity, ahead) = (bind.write(Group::Velocity), bind.write(Group::Ahead));
        let half = kicks.step.get(0, Index::of(HALF));
        let held = kicks.motions.map(|motions| motions.of_particle(i));
        let axes = [0, 1, 2].map(|a| {
            let before = ahead.get(a, i);
            let (after, axis) = kicks.axis(a, i, velocity.double(a, 3 + a, i), before, (half, When::End));
            for k in 0..2 {
                velocity.set(a + 3 * k, i, after[k]);
            }
            let further = before + half * kicks.rates.get(a, i);
            ahead.set(a, i, held.map_or(further, |held| held.choose(a, Recorded::zero(), further)));
            axis
        });
        kicks.book(i, &axes, half);
    })
}
