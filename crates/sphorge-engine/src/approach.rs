//! How long a step may be where bodies approach each other: a contact acts from the step on in which surfaces have met, and what passes through a
//! particle in a step is not met at all.

use crate::model::{Body, Model, MotionAxis};
use crate::particles::Particles;
use sphorge_physics::time_step::{longitudinal_speed, sound_limit};

/// How far surfaces approach each other in a step, in spacings. Below some 3 km/s sound limits the steps more.
const LARGEST: f64 = 0.2;

/// Largest Courant number of waves where different bodies may meet, or walls meet facets. The step in which surfaces meet is chosen before anything presses: at
/// 0.45 the plates of an impact at 1 km/s book 7 % of their energy in it to the integration, at 0.3 less than 2 %; what slides on a wall heats it 3 % less.
const MOST_OF_MEETING: f64 = 0.3;

/// Longest step, s, with which bodies of this model can meet, whatever they do: that of waves in the smallest cells of those that may, at rest, at no more
/// than [`MOST_OF_MEETING`].
fn of_meeting(model: &Model) -> f64 {
    let meet = model.contact_pairs().iter().any(|(a, b)| a != b) || model.meets_walls_at_facets();
    if !meet || !model.thermal.mechanics || model.time.courant <= MOST_OF_MEETING {
        return f64::INFINITY;
    }
    let of = |body: &Body| {
        let material = &model.materials[body.material];
        let sound = material.equation_of_state.reference_sound_speed();
        let speed = longitudinal_speed(sound, material.shear_modulus, material.density);
        sound_limit(body.smoothing_length, speed, 0.0, MOST_OF_MEETING)
    };
    model.bodies.iter().map(of).fold(f64::INFINITY, f64::min)
}

/// Longest step, s, for bodies that approach each other as fast as any two particles do at the start, infinite where no bodies meet. It is
/// the same in every uniformly moving frame. What an impact throws out faster, a jet, is not looked for. A step that a deck fixes is not limited.
pub(crate) fn limit(model: &Model, particles: &Particles) -> f64 {
    let of_meeting = of_meeting(model);
    if model.contact_pairs().is_empty() {
        return of_meeting;
    }
    let spacing = model.bodies.iter().map(|body| body.spacing).fold(f64::INFINITY, f64::min);
    let fastest = diagonal(|a| range(particles.velocity.iter().map(|v| v[a])));
    (LARGEST * spacing / fastest).min(of_meeting)
}

/// How fast anything in a model can approach anything else, m/s: bodies at the start, what is held in motion and walls at any time.
pub(crate) fn fastest(model: &Model) -> f64 {
    let ends: Vec<[f64; 3]> = model.bodies.iter().flat_map(|body| body.velocity_bounds(model.dimensions)).collect();
    let tables = |a: usize| {
        let held = model.motions.iter().filter_map(move |motion| match &motion.axes[a] {
            MotionAxis::Free => None,
            MotionAxis::Velocity(table) => Some(table),
        });
        held.chain(model.walls.iter().map(move |wall| &wall.velocity[a]))
    };
    let driven = |a: usize| tables(a).flat_map(|table| table.points.iter().map(|point| point.1));
    diagonal(|a| range(ends.iter().map(|v| v[a]).chain(driven(a))))
}

/// Length of what has such components.
fn diagonal(component: impl Fn(usize) -> f64) -> f64 {
    (0..3).map(|a| component(a).powi(2)).sum::<f64>().sqrt()
}

/// From the least to the largest of some numbers.
fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (least.min(v), most.max(v)));
    most - least
}
