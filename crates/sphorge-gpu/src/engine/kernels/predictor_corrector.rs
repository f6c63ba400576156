//! Monaghan's predictor–corrector.

use super::kick::Kicks;
use crate::engine::columns::{Fields, Group, Recording, added, recording};
use crate::engine::step_numbers::{DT, HALF};
use crate::record::{Index, KernelFault};
use sphorge_engine::model::Model;

/// The state at the middle of the step, predicted with the rates of the last one.
pub(in crate::engine) fn predict(count: usize) -> Result<Recording, KernelFault> {
    recording("predict", count, |bind, i| {
        let (place, velocity) = (bind.write(Group::Place), bind.write(Group::Velocity));
        let (base_place, base_velocity) = (bind.write(Group::BasePlace), bind.write(Group::BaseVelocity));
        let (density, base_density) = (bind.read(Group::Density), bind.write(Group::BaseDensity));
        let (rates, evaluated, step) = (bind.read(Group::Rates), bind.write(Group::Evaluated), bind.read(Group::Step));
        let half = step.get(0, Index::of(HALF));
        base_density.set_all(0, i, &density.double(0, 1, i));
        for a in 0..3 {
            let (x, v) = (place.double(a, 3 + a, i), velocity.double(a, 3 + a, i));
            let (acceleration, xsph) = (rates.get(a, i), rates.get(3 + a, i));
            for k in 0..2 {
                base_place.set(a + 3 * k, i, x[k]);
                base_velocity.set(a + 3 * k, i, v[k]);
            }
            base_velocity.set(6 + a, i, acceleration);
            let moved = added(x, half * (v[0] + xsph));
            let kicked = added(v, half * acceleration);
            for k in 0..2 {
                place.set(a + 3 * k, i, moved[k]);
                velocity.set(a + 3 * k, i, kicked[k]);
            }
            evaluated.set(a, i, kicked[0]);
        }
    })
}

/// The whole step with the rates of its middle. Pair forces have worked at the velocity they were evaluated with: what the mean velocity
/// of the step differs from that goes to the internal energy.
pub(in crate::engine) fn correct(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("correct", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (place, velocity) = (bind.write(Group::Place), bind.write(Group::Velocity));
        let (base_place, base_velocity) = (bind.read(Group::BasePlace), bind.read(Group::BaseVelocity));
        let step = bind.read(Group::Step);
        let (dt, half) = (step.get(0, Index::of(DT)), step.get(0, Index::of(HALF)));
        let axes = [0, 1, 2].map(|a| {
            // Evaluated was what the acceleration of the step before predicted.
            let ahead = -(half * base_velocity.get(6 + a, i));
            let (after, axis) = kicks.axis(a, i, base_velocity.double(a, 3 + a, i), ahead, dt);
            let moved = added(base_place.double(a, 3 + a, i), dt * (axis.mean + kicks.rates.get(3 + a, i)));
            for k in 0..2 {
                velocity.set(a + 3 * k, i, after[k]);
                place.set(a + 3 * k, i, moved[k]);
            }
            axis
        });
        kicks.book(i, &axes, dt);
    })
}
