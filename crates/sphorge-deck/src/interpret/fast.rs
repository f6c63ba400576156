//! What the speed at which bodies meet decides where a deck does not.

use crate::raw::RawNumerics;
use crate::reach::{Moving, dot, minus};
use crate::value::ScalarOr;
use sphorge_engine::model::{Body, Material, Model, WallSurface};
use sphorge_engine::reduction::extent_between_planes;

/// Share of the sound speed at which bodies meet each other, or something rigid, beyond which viscosity of shocks acts, and from which on all of it does. Bars
/// that strike walls at 300 m/s have 0.08, blocks of copper that strike each other at 400 m/s 0.10, plates of copper that meet at 500 m/s 0.127.
const FAST: [f64; 2] = [0.115, 0.125];
/// The same between plates ([`flatness`]), in which shocks of any strength arrive at the far side before the edges are heard of: of copper 39 and 59 m/s.
const FAST_PLATES: [f64; 2] = [0.01, 0.015];
/// Width over thickness up to which bodies are none, and from which on they are plates.
const WIDE: [f64; 2] = [1.5, 2.0];

/// Viscosity of shocks of a model, of which the method has `usual` where impacts are fast, unless the deck gives any viscosity itself; and a note where it
/// leaves this one out by giving another.
pub(crate) fn viscosity_of_shocks(raw: &RawNumerics, usual: f64, model: &Model) -> (f64, Option<String>) {
    let given = model.numerics.viscosity_of_shocks;
    let by_default = || usual * share_of_impacts(model);
    if usual == 0.0 {
        return (given, None);
    }
    match &raw.viscosity {
        // `viscosity = false` leaves no quadratic part.
        None | Some(ScalarOr::Scalar(_)) if model.numerics.viscosity_beta == 0.0 => (given, None),
        None | Some(ScalarOr::Scalar(_)) => (by_default(), None),
        Some(ScalarOr::Composed(table, _)) if table.shocks.is_some() => (given, None),
        Some(ScalarOr::Composed(table, _)) if table.alpha.is_none() && table.beta.is_none() => (by_default(), None),
        Some(ScalarOr::Composed(..)) => {
            let left_out = by_default();
            let has_some = model.numerics.viscosity_alpha > 0.0 || model.numerics.viscosity_beta > 0.0;
            let note = (left_out > 0.0 && has_some).then(|| {
                format!(
                    "`numerics.viscosity` gives `alpha` or `beta`, which leaves out the viscosity of shocks that bodies have by default where they meet so \
                     fast: particles behind the shocks will swing by a third of the pressure and more; add `shocks = {left_out}` to it, or `shocks = 0` if \
                     it is meant so"
                )
            });
            (given, note)
        }
    }
}

/// Share of the way between two numbers, from zero to one.
fn between([from, to]: [f64; 2], value: f64) -> f64 {
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// Largest share for the speed over that of sound at which bodies meet each other, walls, planes of symmetry or what is moved, by the velocities of the start.
fn share_of_impacts(model: &Model) -> f64 {
    let sound = |body: &Body| model.materials[body.material].equation_of_state.reference_sound_speed();
    let mut most = 0.0_f64;
    for (k, body) in model.bodies.iter().enumerate() {
        // What is as near as half a spacing touches.
        let near = 0.5 * body.spacing;
        for own in courses(body, model) {
            // Plates hear of the velocity along the normal alone.
            let mut meet = |axis: usize, speed: f64, normal: f64, other: Option<&Body>| {
                let slower = other.map_or(f64::INFINITY, sound).min(sound(body));
                let flatness = flatness(model, [Some(body), other], axis);
                most = most.max(between(FAST, speed / slower)).max(flatness * between(FAST_PLATES, normal / slower));
            };
            let mut meet_box = |other: &Moving, near: f64, body: Option<&Body>| {
                let relative = minus(own.velocity, other.velocity);
                let Some(entry) = own.enters(other, near) else { return };
                // What touches and moves apart has left.
                let stays = entry.until > 2.0 * near / length(relative);
                if let Some(axis) = entry.axis.filter(|_| stays && entry.from <= model.time.end) {
                    meet(axis, length(relative), relative[axis].abs(), body);
                }
            };
            for other in &model.bodies[k + 1..] {
                let near = near.max(0.5 * other.spacing);
                courses(other, model).iter().for_each(|course| meet_box(course, near, Some(other)));
            }
            for wall in &model.walls {
                let velocity = [0, 1, 2].map(|a| wall.velocity[a].at(0.0));
                if let WallSurface::Segment { from, to } = wall.surface {
                    let ends = |pick: fn(f64, f64) -> f64| std::array::from_fn(|a| pick(from[a], to[a]));
                    meet_box(&Moving { low: ends(f64::min), high: ends(f64::max), velocity }, near, None);
                }
            }
            let mut meet_plane = |point: [f64; 3], normal: [f64; 3], velocity: [f64; 3]| {
                let approach = dot(minus(velocity, own.velocity), normal);
                let meeting = own.meets_plane(point, normal, velocity, near);
                if meeting.is_some_and(|meeting| meeting.feels <= model.time.end) {
                    meet(dominant(normal), approach, approach, None);
                }
            };
            for wall in &model.walls {
                if let WallSurface::Plane { point, normal } = wall.surface {
                    meet_plane(point, normal, [0, 1, 2].map(|a| wall.velocity[a].at(0.0)));
                }
            }
            for plane in &model.symmetry {
                let along = |value: f64| [0, 1, 2].map(|a| if a == plane.axis { value } else { 0.0 });
                meet_plane(along(plane.position), along(plane.side), [0.0; 3]);
            }
            for motion in &model.motions {
                // Of velocities that differ from place to place that of the part that is moved is not known: what is held where it rests meets nothing.
                let beside = velocities(body).map(|velocity| {
                    [0, 1, 2].map(|a| motion.axes[a].velocity(0.0).map_or(0.0, |moved| moved - velocity[a]))
                });
                let beside = if length(beside[0]) < length(beside[1]) { beside[0] } else { beside[1] };
                meet(dominant(beside), length(beside), length(beside), None);
            }
        }
    }
    most
}

/// An end of what has none, m: nothing times it is nothing.
const ENDLESS: f64 = 1e300;

/// The box around a body with the [velocities] of its particles; without ends along periodic axes.
fn courses(body: &Body, model: &Model) -> [Moving; 2] {
    let (mut low, mut high) = body.shape.bounds(model.dimensions);
    for a in (0..3).filter(|a| model.periodic[*a].is_some()) {
        (low[a], high[a]) = (-ENDLESS, ENDLESS);
    }
    velocities(body).map(|velocity| Moving { low, high, velocity })
}

/// The axis along which a vector has its largest component.
fn dominant(v: [f64; 3]) -> usize {
    (0..3).fold(0, |most, a| if v[a].abs() > v[most].abs() { a } else { most })
}

/// How far bodies that meet along an axis are plates that do not break, from zero to one: the narrower of them is much wider than the thinner of them is
/// thick.
fn flatness(model: &Model, bodies: [Option<&Body>; 2], along: usize) -> f64 {
    // In what breaks more layers would tear at once, side by side: fronts are smoother.
    if model.materials.iter().any(Material::breaks) {
        return 0.0;
    }
    let (mut thickness, mut width) = (f64::INFINITY, f64::INFINITY);
    for body in bodies.into_iter().flatten() {
        let (low, high) = body.shape.bounds(model.dimensions);
        thickness = thickness.min(high[along] - low[along]);
        for axis in (0..model.dimensions.count()).filter(|axis| *axis != along && model.periodic[*axis].is_none()) {
            // Of a body at a plane of symmetry the other half is behind it; between two there is no end.
            let planes = model.symmetry.iter().filter(|plane| plane.axis == axis).count();
            let own = extent_between_planes(model, axis, low[axis], high[axis]);
            width = width.min(if planes > 1 { f64::INFINITY } else { (1 + planes) as f64 * own });
        }
    }
    between(WIDE, width / thickness)
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
