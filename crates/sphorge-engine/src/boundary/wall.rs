//! Planes and segments that push particles away.

use crate::model::{Model, TimeTable, Wall, WallContact, WallSurface};
use sphorge_physics::{Vector, tensor::dot, wall as law};

/// Present place of a wall.
#[derive(Clone, Debug)]
pub struct WallState {
    tables: [TimeTable; 3],
    /// Shift since time zero, m.
    pub displacement: Vector<f64>,
    /// Present velocity, m/s.
    pub velocity: Vector<f64>,
}

impl WallState {
    /// The wall at time zero.
    pub fn new(wall: &Wall) -> Self {
        Self {
            tables: wall.velocity.clone(),
            displacement: [0.0; 3],
            velocity: [0, 1, 2].map(|a| wall.velocity[a].at(0.0)),
        }
    }

    /// Moves the wall from where it stood at time `from` to where it stands at time `to`, s.
    pub fn advance(&mut self, from: f64, to: f64) {
        for a in 0..3 {
            // The table is piecewise linear: Simpson's rule is exact within a piece.
            let table = &self.tables[a];
            let mean = (table.at(from) + 4.0 * table.at(0.5 * (from + to)) + table.at(to)) / 6.0;
            self.displacement[a] += mean * (to - from);
            self.velocity[a] = table.at(to);
        }
    }
}

/// Acceleration a wall gives a particle of body `body` at `x` with velocity `v`, m/s². `dt` bounds friction: it can stop
/// the sliding within the step, never turn it.
pub fn wall_acceleration(
    model: &Model,
    wall: &Wall,
    state: &WallState,
    body: u32,
    x: Vector<f64>,
    v: Vector<f64>,
    dt: f64,
) -> Vector<f64> {
    let Some((distance, normal)) = gap(&wall.surface, &state.displacement, &x) else { return [0.0; 3] };
    let body = &model.bodies[body as usize];
    let sound_speed = model.materials[body.material].equation_of_state.reference_sound_speed();
    let relative = [0, 1, 2].map(|a| v[a] - state.velocity[a]);
    let approach = -dot(relative, normal);
    match wall.contact {
        WallContact::MonaghanKos { range } => {
            let a = law::monaghan_kos(distance, range, approach, sound_speed, body.smoothing_length);
            normal.map(|n| a * n)
        }
        WallContact::Penalty { stiffness, damping, friction } => {
            let omega = stiffness.sqrt() * sound_speed / body.spacing;
            // Surfaces touch when the particle, half a spacing in radius, does.
            let penetration = 0.5 * body.spacing - distance;
            let tangential = [0, 1, 2].map(|a| relative[a] + approach * normal[a]);
            let parameters =
                law::PenaltyParameters { stiffness: omega * omega, damping: 2.0 * damping * omega, friction };
            let contact = law::penalty_contact(parameters, penetration, approach, tangential, dt);
            [0, 1, 2].map(|a| contact.normal * normal[a] + contact.tangential[a])
        }
    }
}

/// Distance of a point from the surface and the unit normal towards it; `None` on the line of a segment itself.
fn gap(surface: &WallSurface, displacement: &Vector<f64>, x: &Vector<f64>) -> Option<(f64, Vector<f64>)> {
    let local = [0, 1, 2].map(|a| x[a] - displacement[a]);
    match *surface {
        WallSurface::Plane { point, normal } => {
            let to = [0, 1, 2].map(|a| local[a] - point[a]);
            Some((dot(to, normal), normal))
        }
        WallSurface::Segment { from, to } => {
            let along = [0, 1, 2].map(|a| to[a] - from[a]);
            let offset = [0, 1, 2].map(|a| local[a] - from[a]);
            let s = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
            let away = [0, 1, 2].map(|a| offset[a] - s * along[a]);
            let distance = dot(away, away).sqrt();
            (distance > 0.0).then(|| (distance, away.map(|c| c / distance)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gap_of_a_moved_plane_and_of_a_segment_end() {
        let plane = WallSurface::Plane { point: [0.0, 1.0, 0.0], normal: [0.0, 1.0, 0.0] };
        assert_eq!(gap(&plane, &[0.0, 0.5, 0.0], &[7.0, 4.0, 0.0]), Some((2.5, [0.0, 1.0, 0.0])));
        let segment = WallSurface::Segment { from: [0.0; 3], to: [2.0, 0.0, 0.0] };
        assert_eq!(gap(&segment, &[0.0; 3], &[1.0, -3.0, 0.0]), Some((3.0, [0.0, -1.0, 0.0])));
        assert_eq!(gap(&segment, &[0.0; 3], &[5.0, 4.0, 0.0]), Some((5.0, [0.6, 0.8, 0.0])));
        assert_eq!(gap(&segment, &[0.0; 3], &[1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn a_wall_moves_by_the_integral_of_its_velocity() {
        let ramp = TimeTable { points: vec![(0.0, 0.0), (2.0, 4.0)] };
        let zero = TimeTable::constant(0.0);
        let wall = Wall {
            name: String::new(),
            surface: WallSurface::Plane { point: [0.0; 3], normal: [1.0, 0.0, 0.0] },
            velocity: [ramp, zero.clone(), zero],
            contact: WallContact::MonaghanKos { range: 1.0 },
        };
        let mut state = WallState::new(&wall);
        state.advance(0.0, 1.0);
        state.advance(1.0, 2.0);
        assert_eq!((state.displacement[0], state.velocity[0]), (4.0, 4.0));
    }
}
