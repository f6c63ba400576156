//! Monaghan's predictor–corrector.

use super::kick::Kicks;
use super::motion::{Motions, When};
use crate::engine::columns::{Fields, Group, Recording, added, recording};
use crate::engine::step_numbers::{DT, HALF};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;

/// The state at mid-step, predicted with the last rates.
pub(in crate::engine) fn predict(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("predict", count, |bind, i| {
        let (place, velocity) = (bind.write(Group::Place), bind.write(Group::Velocity));
        let (base_place, base_velocity) = (bind.write(Group::BasePlace), bind.write(Group::BaseVelocity));
        let (density, base_density) = (bind.read(Group::Density), bind.write(Group::BaseDensity));
        let (rates, evaluated, step) = (bind.read(Group::Rates), bind.write(Group::Evaluated), bind.read(Group::Step));
        let held = Motions::of(bind, model, step).map(|motions| motions.of_particle(i));
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
            let (mut drifts, mut kicked) = (v[0], added(v, half * acceleration));
            if let Some(held) = held {
                let velocity = held.velocity(a, When::Middle);
                drifts = held.choose(a, velocity, drifts);
                kicked = [held.choose(a, velocity, kicked[0]), held.choose(a, Recorded::zero(), kicked[1])];
            }
            let moved = added(x, half * (drifts + xsph));
            for k in 0..2 {
                place.set(a + 3 * k, i, moved[k]);
                velocity.set(a + 3 * k, i, kicked[k]);
            }
            evaluated.set(a, i, kicked[0]);
        }
    })
}

/// The whole step with the rates of its middle. The work of pair forces was computed with the velocity of their
/// evaluation; its difference from the work at the mean velocity of the step goes to the internal energy.
pub(in crate::engine) fn correct(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("correct", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (place, velocity) = (bind.write(Group::Place), bind.write(Group::Velocity));
        let (base_place, base_velocity) = (bind.read(Group::BasePlace), bind.read(Group::BaseVelocity));
        let (dt, half) = (kicks.step.get(0, Index::of(DT)), kicks.step.get(0, Index::of(HALF)));
        let held = kicks.motions.map(|motions| motions.of_particle(i));
        let axes = [0, 1, 2].map(|a| {
            // Forces were evaluated with the velocity predicted from the acceleration of the previous step, or with the
            // prescribed one.
            let before = base_velocity.double(a, 3 + a, i);
            let mut ahead = -(half * base_velocity.get(6 + a, i));
            if let Some(held) = held {
                ahead = held.choose(a, (before[0] - held.velocity(a, When::Middle)) + before[1], ahead);
            }
            let (after, axis) = kicks.axis(a, i, before, ahead, (dt, When::End));
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
