//! Kick-drift-kick leapfrog.

use super::kick::Kicks;
use crate::engine::columns::{Fields, Group, Recording, added, recording};
use crate::engine::step_numbers::{DT, HALF};
use crate::record::{Index, KernelFault};
use sphorge_engine::model::Model;

/// First half kick, drift, and the velocity forces are evaluated with: that of the end of the step, predicted with the last acceleration.
pub(in crate::engine) fn begin(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("kick_and_drift", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (place, velocity, ahead) =
            (bind.write(Group::Place), bind.write(Group::Velocity), bind.write(Group::Ahead));
        let (evaluated, step) = (bind.write(Group::Evaluated), bind.read(Group::Step));
        let (dt, half) = (step.get(0, Index::of(DT)), step.get(0, Index::of(HALF)));
        let axes = [0, 1, 2].map(|a| {
            let (after, axis) = kicks.axis(a, i, velocity.double(a, 3 + a, i), ahead.get(a, i), half);
            let moved = added(place.double(a, 3 + a, i), dt * (after[0] + kicks.rates.get(3 + a, i)));
            for k in 0..2 {
                velocity.set(a + 3 * k, i, after[k]);
                place.set(a + 3 * k, i, moved[k]);
            }
            let predicted = (after[0] + half * kicks.rates.get(a, i)).rounded();
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
        let (velocity, ahead, step) = (bind.write(Group::Velocity), bind.write(Group::Ahead), bind.read(Group::Step));
        let half = step.get(0, Index::of(HALF));
        let axes = [0, 1, 2].map(|a| {
            let before = ahead.get(a, i);
            let (after, axis) = kicks.axis(a, i, velocity.double(a, 3 + a, i), before, half);
            for k in 0..2 {
                velocity.set(a + 3 * k, i, after[k]);
            }
            ahead.set(a, i, before + half * kicks.rates.get(a, i));
            axis
        });
        kicks.book(i, &axes, half);
    })
}
