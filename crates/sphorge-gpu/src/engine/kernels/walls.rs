//! Walls and gravity.

use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::engine::step_numbers::{DT, GRAVITY, WALL_LENGTH, WALLS};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{Model, Wall, WallContact, WallSurface};
use sphorge_physics::tensor::dot;
use sphorge_physics::wall::{Gap, PenaltyParameters, WallPush, monaghan_kos, penalty_contact};
use sphorge_physics::{Real, Vector};

/// Numbers kept of each wall and particle.
pub(in crate::engine) const FIELDS: usize = 2;

/// Adds what walls and gravity do to acceleration and energy rate.
pub(in crate::engine) fn push(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("push", count, |bind, i| {
        let (place, evaluated) = (bind.read(Group::Place), bind.read(Group::Evaluated));
        let (constants, step) = (bind.read(Group::Constants), bind.read(Group::Step));
        let (rates, energy) = (bind.write(Group::Rates), bind.write(Group::Energy));
        let (external, walls) = (bind.write(Group::External), bind.write(Group::Walls));
        let number = |k: u32| step.get(0, Index::of(k));
        let vector = |k: u32| [number(k), number(k + 1), number(k + 2)];
        let mut pushed = vector(GRAVITY);
        let (mut heat, mut rubbed) = (Recorded::zero(), Recorded::zero());
        let (mass, v) = (constants.get(0, i), evaluated.vector(0, i));
        for (k, wall) in model.walls.iter().enumerate() {
            let at = WALLS + k as u32 * WALL_LENGTH;
            let (shift, moving) = (vector(at), vector(at + 3));
            let x = [0, 1, 2].map(|a| place.get(a, i) - shift[a] + place.get(3 + a, i));
            let own = (constants.get(1, i), constants.get(3, i), constants.get(4, i));
            let of_wall = of_wall(wall, x, [0, 1, 2].map(|a| v[a] - moving[a]), own, number(DT));
            for a in 0..3 {
                pushed[a] += of_wall.acceleration[a];
            }
            heat += of_wall.heat;
            rubbed += of_wall.rubbed;
            let power = mass * (dot(of_wall.acceleration, v) + of_wall.heat);
            walls.add(FIELDS * k, FIELDS * k + 1, i, power * number(DT));
        }
        for a in 0..3 {
            rates.set(a, i, rates.get(a, i) + pushed[a]);
        }
        energy.set(2, i, energy.get(2, i) + heat);
        external.set_all(0, i, &[pushed[0], pushed[1], pushed[2], heat, rubbed]);
    })
}

/// What a wall does to a particle of that smoothing length (m), spacing (m) and sound speed at rest (m/s).
pub(in crate::engine) fn of_wall<T: Real>(
    wall: &Wall,
    x: Vector<T>,
    velocity: Vector<T>,
    (h, spacing, sound_speed): (T, T, T),
    dt: T,
) -> WallPush<T> {
    let zero = T::zero();
    let none = WallPush { acceleration: [zero; 3], heat: zero, rubbed: zero };
    // Others are refused before a run.
    let WallSurface::Plane { point, normal } = wall.surface else { return none };
    let gap = Gap::to_plane(x, point.map(T::of), normal.map(T::of));
    match wall.contact {
        WallContact::MonaghanKos { range } => {
            WallPush { acceleration: monaghan_kos(&gap, velocity, T::of(range), sound_speed, h), ..none }
        }
        WallContact::Penalty { stiffness, damping, friction } => {
            let [stiffness, damping, friction] = [stiffness, damping, friction].map(T::of);
            let parameters = PenaltyParameters::from_sound_speed(sound_speed, spacing, stiffness, damping, friction);
            penalty_contact(parameters, &gap, T::of(0.5) * spacing, velocity, dt)
        }
    }
}
