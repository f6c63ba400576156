//! What the speed at which bodies meet decides where a deck does not.

use crate::raw::RawNumerics;
use crate::reach::{dot, minus};
use crate::value::ScalarOr;
use sphorge_engine::model::{Body, Model, WallSurface};

/// Share of the sound speed at which bodies approach each other, or something rigid, beyond which viscosity of shocks acts, and from which on all of it does. Bars
/// that strike walls at 300 m/s have 0.08, blocks of copper that strike each other at 400 m/s 0.10, plates of copper that meet at 500 m/s 0.127.
const FAST: [f64; 2] = [0.115, 0.125];

/// Viscosity of shocks of a model, of which the method has `usual` where impacts are fast, unless the deck gives any viscosity itself.
pub(crate) fn viscosity_of_shocks(raw: &RawNumerics, usual: f64, model: &Model) -> f64 {
    let is_given = match &raw.viscosity {
        // `viscosity = false` leaves no quadratic part.
        None | Some(ScalarOr::Scalar(_)) => model.numerics.viscosity_beta == 0.0,
        Some(ScalarOr::Composed(table, _)) => {
            [&table.alpha, &table.beta, &table.shocks].iter().any(|key| key.is_some())
        }
    };
    if is_given || usual == 0.0 {
        return model.numerics.viscosity_of_shocks;
    }
    let [from, all] = FAST;
    usual * ((speed_of_impact(model) - from) / (all - from)).clamp(0.0, 1.0)
}

/// Largest speed over that of sound at which a body approaches another one, a wall, a plane of symmetry or what is moved, at the start.
fn speed_of_impact(model: &Model) -> f64 {
    let sound = |body: &Body| model.materials[body.material].equation_of_state.reference_sound_speed();
    let mut most = 0.0_f64;
    for (k, body) in model.bodies.iter().enumerate() {
        for v in velocities(body) {
            for other in &model.bodies[k + 1..] {
                let slower = sound(body).min(sound(other));
                velocities(other).iter().for_each(|w| most = most.max(length(minus(v, *w)) / slower));
            }
            for wall in &model.walls {
                let relative = minus(v, [0, 1, 2].map(|a| wall.velocity[a].at(0.0)));
                let approach = match wall.surface {
                    WallSurface::Plane { normal, .. } => -dot(relative, normal),
                    WallSurface::Segment { .. } => length(relative),
                };
                most = most.max(approach / sound(body));
            }
            for plane in &model.symmetry {
                most = most.max(-v[plane.axis] * plane.side / sound(body));
            }
            for motion in &model.motions {
                let beside = [0, 1, 2].map(|a| motion.axes[a].velocity(0.0).map_or(0.0, |moved| moved - v[a]));
                most = most.max(length(beside) / sound(body));
            }
        }
    }
    most
}

/// Velocities that particles of a body have at the start, m/s: at the ends of its profile, if it has one.
fn velocities(body: &Body) -> [[f64; 3]; 2] {
    let Some(profile) = &body.velocity_profile else { return [body.velocity; 2] };
    let shares = profile.rows.iter().map(|row| row.1);
    let ends = [shares.clone().fold(f64::INFINITY, f64::min), shares.fold(f64::NEG_INFINITY, f64::max)];
    ends.map(|share| [0, 1, 2].map(|a| body.velocity[a] + share * profile.amplitude[a]))
}

fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}
