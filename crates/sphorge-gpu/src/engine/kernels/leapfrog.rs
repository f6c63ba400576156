//! Kick-drift-kick leapfrog.

use super::kick::Kicks;
use super::motion::When;
use crate::engine::columns::{Recording, WriteColumns, added, groups, recording};
use crate::record::{KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;

/// First half kick, drift, and the velocity at which forces are evaluated: that of the end of the step, predicted with
/// the last acceleration.
pub(in crate::engine) fn begin(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("kick_and_drift", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (place, velocity, ahead) = (
            groups::Place::write(bind).position,
            groups::Velocity::write(bind).velocity,
            groups::Ahead::write(bind).velocity,
        );
        let evaluated = groups::Evaluated::write(bind).velocity;
        let (dt, half) = (kicks.step.dt.value(), kicks.step.half.value());
        let held = kicks.motions.map(|motions| motions.of_particle(i));
        let axes = [0, 1, 2].map(|a| {
            let (after, axis) = kicks.axis(a, i, velocity.axis(a).get(i), ahead.axis(a).get(i), (half, When::Middle));
            let moved = added(place.axis(a).get(i), dt * (after[0] + kicks.rates.smoothing_velocity.axis(a).get(i)));
            for k in 0..2 {
                velocity.axis(a).part(k).set(i, after[k]);
                place.axis(a).part(k).set(i, moved[k]);
            }
            let mut predicted = (after[0] + half * kicks.rates.acceleration.axis(a).get(i)).rounded();
            if let Some(held) = held {
                predicted = held.choose(a, held.velocity(a, When::End), predicted);
            }
            evaluated.axis(a).set(i, predicted);
            ahead.axis(a).set(i, (after[0] - predicted).rounded() + after[1]);
            axis
        });
        kicks.book(i, &axes, half);
    })
}

/// Second half kick.
pub(in crate::engine) fn finish(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("kick", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (velocity, ahead) = (groups::Velocity::write(bind).velocity, groups::Ahead::write(bind).velocity);
        let half = kicks.step.half.value();
        let held = kicks.motions.map(|motions| motions.of_particle(i));
        let axes = [0, 1, 2].map(|a| {
            let before = ahead.axis(a).get(i);
            let (after, axis) = kicks.axis(a, i, velocity.axis(a).get(i), before, (half, When::End));
            velocity.axis(a).set(i, after);
            let further = before + half * kicks.rates.acceleration.axis(a).get(i);
            ahead.axis(a).set(i, held.map_or(further, |held| held.choose(a, Recorded::zero(), further)));
            axis
        });
        kicks.book(i, &axes, half);
    })
}
