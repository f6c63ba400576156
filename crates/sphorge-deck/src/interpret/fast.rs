//! What the speed at which bodies meet decides where a deck does not.

use crate::raw::RawNumerics;
use crate::reach::{dot, minus};
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
    usual * share_of_impacts(model)
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
        let own = Extent::of(body, model);
        for v in velocities(body) {
            // Plates hear of the velocity along the normal alone.
            let mut meet = |axis: usize, speed: f64, normal: f64, other: Option<&Body>| {
                let slower = other.map_or(f64::INFINITY, sound).min(sound(body));
                let flatness = flatness(model, [Some(body), other], axis);
                most = most.max(between(FAST, speed / slower)).max(flatness * between(FAST_PLATES, normal / slower));
            };
            for other in &model.bodies[k + 1..] {
                for w in velocities(other) {
                    let relative = minus(v, w);
                    if let Some(axis) = own.meets(&Extent::of(other, model), relative, model) {
                        meet(axis, length(relative), relative[axis].abs(), Some(other));
                    }
                }
            }
            for wall in &model.walls {
                let relative = minus(v, [0, 1, 2].map(|a| wall.velocity[a].at(0.0)));
                match wall.surface {
                    WallSurface::Plane { point, normal } => {
                        let approach = -dot(relative, normal);
                        if own.depth(point, normal) <= approach * model.time.end {
                            meet(dominant(normal), approach, approach, None);
                        }
                    }
                    WallSurface::Segment { from, to } => {
                        let ends = |pick: fn(f64, f64) -> f64| std::array::from_fn(|a| pick(from[a], to[a]));
                        let segment = Extent { low: ends(f64::min), high: ends(f64::max), near: own.near };
                        if let Some(axis) = own.meets(&segment, relative, model) {
                            meet(axis, length(relative), relative[axis].abs(), None);
                        }
                    }
                }
            }
            for plane in &model.symmetry {
                let along = |value: f64| [0, 1, 2].map(|a| if a == plane.axis { value } else { 0.0 });
                let approach = -v[plane.axis] * plane.side;
                if own.depth(along(plane.position), along(plane.side)) <= approach * model.time.end {
                    meet(plane.axis, approach, approach, None);
                }
            }
            for motion in &model.motions {
                let beside = [0, 1, 2].map(|a| motion.axes[a].velocity(0.0).map_or(0.0, |moved| moved - v[a]));
                meet(dominant(beside), length(beside), length(beside), None);
            }
        }
    }
    most
}

/// The box around a body, m.
#[derive(Clone, Copy)]
struct Extent {
    low: [f64; 3],
    high: [f64; 3],
    /// Half a spacing: what is as near as that touches.
    near: f64,
}

impl Extent {
    fn of(body: &Body, model: &Model) -> Self {
        let (low, high) = body.shape.bounds(model.dimensions);
        Self { low, high, near: 0.5 * body.spacing }
    }

    /// Distance from a plane, m, on the side of its normal.
    fn depth(&self, point: [f64; 3], normal: [f64; 3]) -> f64 {
        let nearest = |a: usize| if normal[a] > 0.0 { self.low[a] } else { self.high[a] };
        (0..3).map(|a| normal[a] * (nearest(a) - point[a])).sum()
    }

    /// The axis along which this box meets another one at a relative velocity (m/s), if it does before the end: that along which they overlap last.
    fn meets(&self, other: &Self, relative: [f64; 3], model: &Model) -> Option<usize> {
        let near = self.near.max(other.near);
        let (mut entry, mut exit, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, dominant(relative));
        for a in (0..model.dimensions.count()).filter(|a| model.periodic[*a].is_none()) {
            let (before, behind) = (other.low[a] - self.high[a], other.high[a] - self.low[a]);
            if relative[a] == 0.0 {
                if before > near || behind < -near {
                    return None;
                }
                continue;
            }
            let (first, last) = if relative[a] > 0.0 { (before, behind) } else { (behind, before) };
            if first / relative[a] > entry {
                (entry, axis) = (first / relative[a], a);
            }
            exit = exit.min(last / relative[a]);
        }
        // What touches and moves apart has left.
        let touch = near / length(relative);
        (entry <= exit && exit > touch && entry <= model.time.end + touch).then_some(axis)
    }
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
