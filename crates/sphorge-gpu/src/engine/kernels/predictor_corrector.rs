//! Monaghan's predictor–corrector.

use super::kick::Kicks;
use super::motion::{Motions, When};
use crate::engine::columns::{ReadColumns, ReadShared, Recording, WriteColumns, added, groups, recording};
use crate::record::{KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;

/// The state at mid-step, predicted with the last rates.
pub(in crate::engine) fn predict(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("predict", count, |bind, i| {
        let (place, velocity) = (groups::Place::write(bind).position, groups::Velocity::write(bind).velocity);
        let (base_place, base_velocity) = (groups::BasePlace::write(bind).position, groups::BaseVelocity::write(bind));
        let (density, base_density) = (groups::Density::read(bind).density, groups::BaseDensity::write(bind).density);
        let (rates, evaluated, step) =
            (groups::Rates::read(bind), groups::Evaluated::write(bind).velocity, groups::Step::shared(bind));
        let held = Motions::of(bind, model, step).map(|motions| motions.of_particle(i));
        let half = step.half.value();
        base_density.set(i, density.get(i));
        for a in 0..3 {
            let (x, v) = (place.axis(a).get(i), velocity.axis(a).get(i));
            let (acceleration, xsph) = (rates.acceleration.axis(a).get(i), rates.smoothing_velocity.axis(a).get(i));
            for k in 0..2 {
                base_place.axis(a).part(k).set(i, x[k]);
                base_velocity.velocity.axis(a).part(k).set(i, v[k]);
            }
            base_velocity.acceleration.axis(a).set(i, acceleration);
            let (mut drifts, mut kicked) = (v[0], added(v, half * acceleration));
            if let Some(held) = held {
                let velocity = held.velocity(a, When::Middle);
                drifts = held.choose(a, velocity, drifts);
                kicked = [held.choose(a, velocity, kicked[0]), held.choose(a, Recorded::zero(), kicked[1])];
            }
            let moved = added(x, half * (drifts + xsph));
            for k in 0..2 {
                place.axis(a).part(k).set(i, moved[k]);
                velocity.axis(a).part(k).set(i, kicked[k]);
            }
            evaluated.axis(a).set(i, kicked[0]);
        }
    })
}

/// The whole step with the rates of its middle. The work of pair forces was computed with the velocity of their
/// evaluation; its difference from the work at the mean velocity of the step goes to the internal energy.
pub(in crate::engine) fn correct(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("correct", count, |bind, i| {
        let kicks = Kicks::of(bind, model);
        let (place, velocity) = (groups::Place::write(bind).position, groups::Velocity::write(bind).velocity);
        let (base_place, base_velocity) = (groups::BasePlace::read(bind).position, groups::BaseVelocity::read(bind));
        let (dt, half) = (kicks.step.dt.value(), kicks.step.half.value());
        let held = kicks.motions.map(|motions| motions.of_particle(i));
        let axes = [0, 1, 2].map(|a| {
            // Forces were evaluated with the velocity predicted from the acceleration of the previous step, or with the
            // prescribed one.
            let before = base_velocity.velocity.axis(a).get(i);
            let mut ahead = -(half * base_velocity.acceleration.axis(a).get(i));
            if let Some(held) = held {
                ahead = held.choose(a, (before[0] - held.velocity(a, When::Middle)) + before[1], ahead);
            }
            let (after, axis) = kicks.axis(a, i, before, ahead, (dt, When::End));
            let moved =
                added(base_place.axis(a).get(i), dt * (axis.mean + kicks.rates.smoothing_velocity.axis(a).get(i)));
            for k in 0..2 {
                velocity.axis(a).part(k).set(i, after[k]);
                place.axis(a).part(k).set(i, moved[k]);
            }
            axis
        });
        kicks.book(i, &axes, dt);
    })
}
