//! Walls and gravity.

use super::reference::{Deformations, References};
use crate::engine::columns::{Member, ReadColumns, ReadShared, Recording, WriteColumns, groups, recording};
use crate::engine::step_numbers::of_wall as numbers_of_wall;
use crate::record::{KernelFault, Recorded};
use sphorge_engine::model::{Model, Wall, WallContact, WallSurface};
use sphorge_physics::tensor::apply;
use sphorge_physics::total_lagrangian::MeetingPoint;
use sphorge_physics::wall::{FacePush, FacePushes, Gap, PenaltyParameters, WallPush, monaghan_kos, penalty_contact};
use sphorge_physics::{Real, Tensor, Vector};

/// Sums for each wall and particle: work, heat of friction and heat of damping, J.
pub(in crate::engine) const SUMS: usize = 3;

/// Computes the effect of walls and gravity, to which self-contact adds. A wall acts on a particle of the total
/// Lagrangian form at its face.
pub(in crate::engine) fn push(model: &Model, references: References, count: usize) -> Result<Recording, KernelFault> {
    recording("push", count, |bind, i| {
        let (place, evaluated) = (groups::Place::read(bind).position, groups::Evaluated::read(bind).velocity);
        let (constants, step) = (groups::Constants::read(bind), groups::Step::shared(bind));
        let external = groups::External::write(bind);
        let walls = (!model.walls.is_empty()).then(|| groups::Walls::write(bind));
        let is_deformed = model.is_total_lagrangian() && walls.is_some();
        let has_faces = model.is_total_lagrangian() && (walls.is_some() || model.has_contact());
        let deformed = is_deformed.then(|| {
            let (f, l) = (Deformations::of(bind, references), groups::Gradient::read(bind).velocity_gradient);
            Deformed { whole: f.whole(i), earlier: f.earlier(i), velocity_gradient: l.get(i) }
        });
        let mut pushes = FacePushes::of_gravity(step.gravity.value());
        let mut rubbed = Recorded::zero();
        let (mass, v) = (constants.mass.get(i), evaluated.get(i));
        for (k, wall) in model.walls.iter().enumerate() {
            let of_step = numbers_of_wall(step, k);
            let (shift, moving) = (of_step.displacement.value(), of_step.velocity.value());
            let body = AtWall {
                h: constants.initial_smoothing_length.get(i),
                spacing: constants.spacing.get(i),
                sound_speed: constants.sound_speed.get(i),
                deformed,
            };
            let x = [0, 1, 2].map(|a| place.axis(a).high().get(i) - shift[a] + place.axis(a).low().get(i));
            let push = of_wall(wall, &body, x, v, moving, step.dt.value());
            rubbed += push.rubbed;
            let power = pushes.add(&push, v);
            if let Some(walls) = walls {
                for (sum, power) in [power, push.rubbed, push.heat - push.rubbed].into_iter().enumerate() {
                    walls.of(k).powers.number(sum).set(i, mass * power);
                }
            }
        }
        external.acceleration.set(i, pushes.acceleration);
        external.power.set(i, pushes.beyond);
        external.friction_heat.set(i, rubbed);
        if has_faces {
            let (face_stress, reference) = (groups::FaceStress::write(bind).stress, groups::Reference::read(bind));
            face_stress.set(i, &pushes.stress(mass, reference.volume.high().get(i)));
        }
    })
}

/// Adds these to acceleration and energy rate.
pub(in crate::engine) fn add(count: usize) -> Result<Recording, KernelFault> {
    recording("add_external", count, |bind, i| {
        let external = groups::External::read(bind);
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, rates.acceleration.axis(a).get(i) + external.acceleration.axis(a).get(i));
        }
        energy.rate.set(i, energy.rate.get(i) + external.power.get(i));
    })
}

/// A particle at a wall.
pub(in crate::engine) struct AtWall<T> {
    /// Smoothing length, m, spacing, m, sound speed at rest, m/s.
    pub(in crate::engine) h: T,
    pub(in crate::engine) spacing: T,
    pub(in crate::engine) sound_speed: T,
    /// If the form has particles that deform.
    pub(in crate::engine) deformed: Option<Deformed<T>>,
}

/// Deformation of a particle at a wall.
#[derive(Clone, Copy)]
pub(in crate::engine) struct Deformed<T> {
    /// Deformation gradient since the start.
    pub(in crate::engine) whole: Tensor<T>,
    /// That of the reference configuration, if it is not the initial one.
    pub(in crate::engine) earlier: Option<Tensor<T>>,
    /// 1/s.
    pub(in crate::engine) velocity_gradient: Tensor<T>,
}

/// Effect of a wall, which moves with a velocity (m/s), on a particle at this distance from the initial position of the
/// wall (m) with a velocity (m/s).
pub(in crate::engine) fn of_wall<T: Real>(
    wall: &Wall,
    body: &AtWall<T>,
    x: Vector<T>,
    velocity: Vector<T>,
    moving: Vector<T>,
    dt: T,
) -> FacePush<T> {
    let zero = T::zero();
    let away = FacePush { acceleration: [zero; 3], heat: zero, rubbed: zero, face: [zero; 3], velocity };
    let gap = match wall.surface {
        WallSurface::Plane { point, normal } => Gap::to_plane(x, point.map(T::of), normal.map(T::of)),
        WallSurface::Segment { from, to } => Gap::beside_segment(x, from.map(T::of), to.map(T::of)),
    };
    let relative = |v: Vector<T>| [0, 1, 2].map(|a| v[a] - moving[a]);
    match wall.contact {
        WallContact::MonaghanKos { range } => {
            let acceleration = monaghan_kos(&gap, relative(velocity), T::of(range), body.sound_speed, body.h);
            FacePush { acceleration, ..away }
        }
        WallContact::Penalty { stiffness, damping, friction, at_facets: _ } => {
            let [stiffness, damping, friction] = [stiffness, damping, friction].map(T::of);
            let parameters =
                PenaltyParameters::from_sound_speed(body.sound_speed, body.spacing, stiffness, damping, friction);
            let at = match &body.deformed {
                None => MeetingPoint { radius: T::of(0.5) * body.spacing, place: [zero; 3], velocity },
                Some(Deformed { whole, earlier, velocity_gradient }) => {
                    let at = MeetingPoint::new(body.spacing, whole, velocity_gradient, velocity, gap.normal);
                    MeetingPoint { place: earlier.map_or(at.place, |earlier| apply(&earlier, at.place)), ..at }
                }
            };
            let WallPush { acceleration, heat, rubbed } =
                penalty_contact(parameters, &gap, at.radius, relative(at.velocity), dt);
            FacePush { acceleration, heat, rubbed, face: at.place, velocity: at.velocity }
        }
    }
}
