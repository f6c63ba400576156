//! Which bodies run into each other, or into something rigid, by their velocities at the start.

use crate::reach::{Moving, dot, minus};
use sphorge_engine::model::{Body, Model, WallSurface};

/// A body that meets another, or something rigid.
pub(crate) struct Impact {
    pub(crate) body: usize,
    /// The other body, of a higher index; none where it is a wall, a plane of symmetry or what is moved.
    pub(crate) other: Option<usize>,
    /// Along which they meet.
    pub(crate) axis: usize,
    /// Relative speed, and that along the normal, m/s.
    pub(crate) speed: f64,
    pub(crate) normal: f64,
}

/// Calls a function with every impact up to the end of the run.
pub(crate) fn each_impact(model: &Model, each: &mut dyn FnMut(Impact)) {
    for (k, body) in model.bodies.iter().enumerate() {
        // What is as near as half a spacing touches.
        let near = 0.5 * body.spacing;
        for own in courses(body, model) {
            let mut meet = |axis: usize, speed: f64, normal: f64, other: Option<usize>| {
                each(Impact { body: k, other, axis, speed, normal });
            };
            let mut meet_box = |other: &Moving, near: f64, body: Option<usize>| {
                let relative = minus(own.velocity, other.velocity);
                let Some(entry) = own.enters(other, near) else { return };
                // What touches and moves apart has left.
                let stays = entry.until > 2.0 * near / length(relative);
                if let Some(axis) = entry.axis.filter(|_| stays && entry.from <= model.time.end) {
                    meet(axis, length(relative), relative[axis].abs(), body);
                }
            };
            for (index, other) in model.bodies.iter().enumerate().skip(k + 1) {
                let near = near.max(0.5 * other.spacing);
                courses(other, model).iter().for_each(|course| meet_box(course, near, Some(index)));
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
