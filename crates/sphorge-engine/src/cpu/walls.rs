//! Rigid walls: their positions, and how they repel particles.

use super::faces::WholeDeformation;
use crate::model::{Model, TimeTable, Wall, WallContact, WallSurface};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, persist_column, persist_each, persist_pieces};
use crate::report::WallLedger;
use sphorge_physics::tensor;
use sphorge_physics::total_lagrangian::MeetingPoint;
use sphorge_physics::wall::{
    FacePush, Gap, PenaltyParameters, WallPush, monaghan_kos, penalty_contact, penalty_energy,
};
use sphorge_physics::{Tensor, Vector};

/// Current position of a wall.
#[derive(Clone, Debug)]
pub(super) struct WallState {
    tables: [TimeTable; 3],
    /// Shift since time zero, m.
    displacement: Vector<f64>,
    /// Current velocity, m/s.
    velocity: Vector<f64>,
}

impl WallState {
    /// The wall at time zero.
    fn new(wall: &Wall) -> Self {
        Self {
            tables: wall.velocity.clone(),
            displacement: [0.0; 3],
            velocity: [0, 1, 2].map(|a| wall.velocity[a].at(0.0)),
        }
    }

    /// Moves the wall from its position at time `from` to that at time `to`, s.
    fn advance(&mut self, from: f64, to: f64) {
        for a in 0..3 {
            let table = &self.tables[a];
            self.displacement[a] += table.integral(from, to);
            self.velocity[a] = table.at(to);
        }
    }

    /// Where a point of the wall is now, m.
    pub(super) fn at(&self, point: Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| point[a] + self.displacement[a])
    }

    /// m/s.
    pub(super) fn velocity(&self) -> Vector<f64> {
        self.velocity
    }

    /// Gap from the wall at its current position to a point; `None` on the line of a segment itself.
    pub(super) fn gap(&self, surface: &WallSurface, x: Vector<f64>) -> Option<Gap<f64>> {
        let local = [0, 1, 2].map(|a| x[a] - self.displacement[a]);
        match *surface {
            WallSurface::Plane { point, normal } => Some(Gap::to_plane(local, point, normal)),
            WallSurface::Segment { from, to } => Gap::to_segment(local, from, to),
        }
    }
}

/// Positions of the walls.
#[derive(Clone, Debug, Default)]
pub(super) struct Walls {
    pub(super) states: Vec<WallState>,
    /// Time at which `states` were reached, s.
    time: f64,
    /// Work of each wall since the start.
    pub(super) done: Vec<WallLedger>,
    /// Powers of the last forces, W, by block of particles and wall, so that their sum does not depend on threads.
    pub(super) powers: Vec<WallLedger>,
    /// Power of the last forces minus that of the same forces on the centres of the particles, W, by block of
    /// particles.
    pub(super) at_faces: Vec<f64>,
    /// Largest stable step over the margin at facets, by block of particles, s.
    pub(super) limits: Vec<f64>,
}

impl Walls {
    pub(super) fn new(model: &Model, count: usize) -> Self {
        let walls = model.walls.len();
        Self {
            states: model.walls.iter().map(WallState::new).collect(),
            time: 0.0,
            done: vec![WallLedger::default(); walls],
            powers: vec![WallLedger::default(); count.div_ceil(BLOCK) * walls.max(1)],
            at_faces: vec![0.0; count.div_ceil(BLOCK)],
            limits: vec![f64::INFINITY; count.div_ceil(BLOCK)],
        }
    }

    /// Bytes held for blocks of particles.
    pub(super) fn bytes(&self) -> usize {
        size_of::<WallLedger>() * self.powers.capacity()
            + size_of::<f64>() * (self.at_faces.capacity() + self.limits.capacity())
    }

    /// Moves the walls to their positions at `time`.
    pub(super) fn move_to(&mut self, time: f64) {
        for state in &mut self.states {
            state.advance(self.time, time);
        }
        self.time = time;
    }
}

/// Adds the powers of the last forces, in blocks as in [`Walls`], over `dt` (s) to the works of the walls. Returns the
/// part of the work that is not done on the centres of particles, J.
pub(super) fn book(done: &mut [WallLedger], powers: &[WallLedger], at_faces: &[f64], dt: f64) -> f64 {
    for block in powers.chunks_exact(done.len().max(1)) {
        for (done, powers) in done.iter_mut().zip(block) {
            done.add(powers, dt);
        }
    }
    dt * at_faces.iter().sum::<f64>()
}

crate::persist_fields!(WallState { displacement, velocity });

impl Persist for Walls {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.time.persist(&format!("{name}.time"), archive)?;
        persist_column(&mut self.done, &format!("{name}.done"), archive)?;
        persist_pieces(&mut self.powers, &format!("{name}.powers"), archive)?;
        persist_pieces(&mut self.at_faces, &format!("{name}.at_faces"), archive)?;
        persist_each(&mut self.states, name, archive)
    }
}

/// Effect of a wall on particle `i` with the velocity at which forces are evaluated. `dt` (s) bounds friction: it can
/// stop the sliding within the step, but not reverse it. Particles are as thick as at rest, or as deformed by their
/// deformation gradient.
pub(super) fn push(
    model: &Model,
    wall: &Wall,
    state: &WallState,
    columns: &AtWall<'_>,
    i: usize,
    dt: f64,
) -> FacePush<f64> {
    let velocity = columns.velocity[i];
    let away = FacePush { velocity, ..FacePush::default() };
    let Some(gap) = state.gap(&wall.surface, columns.position[i]) else { return away };
    let body = &model.bodies[columns.body[i] as usize];
    let sound_speed = || model.materials[body.material].equation_of_state.reference_sound_speed();
    let relative = |v: Vector<f64>| [0, 1, 2].map(|a| v[a] - state.velocity[a]);
    match wall.contact {
        WallContact::MonaghanKos { range } => {
            let acceleration = monaghan_kos(&gap, relative(velocity), range, sound_speed(), body.smoothing_length);
            FacePush { acceleration, ..away }
        }
        WallContact::Penalty { stiffness, damping, friction, at_facets: _ } => {
            if gap.distance > columns.farthest(body.spacing, i) {
                return away;
            }
            let parameters =
                PenaltyParameters::from_sound_speed(sound_speed(), body.spacing, stiffness, damping, friction);
            let (radius, face, velocity) = columns.face(body.spacing, i, gap.normal);
            let WallPush { acceleration, heat, rubbed } =
                penalty_contact(parameters, &gap, radius, relative(velocity), dt);
            FacePush { acceleration, heat, rubbed, face, velocity }
        }
    }
}

/// What the spring of a wall holds against particle `i`, J/kg.
pub(super) fn stored(model: &Model, wall: &Wall, state: &WallState, columns: &AtWall<'_>, i: usize) -> f64 {
    let WallContact::Penalty { stiffness, .. } = wall.contact else { return 0.0 };
    let Some(gap) = state.gap(&wall.surface, columns.position[i]) else { return 0.0 };
    let body = &model.bodies[columns.body[i] as usize];
    if gap.distance > columns.farthest(body.spacing, i) {
        return 0.0;
    }
    let speed = model.materials[body.material].equation_of_state.reference_sound_speed();
    let parameters = PenaltyParameters::from_sound_speed(speed, body.spacing, stiffness, 0.0, 0.0);
    penalty_energy(parameters, &gap, columns.face(body.spacing, i, gap.normal).0)
}

/// Columns of the particles that a wall reads.
pub(super) struct AtWall<'a> {
    pub(super) position: &'a [Vector<f64>],
    /// The velocity at which forces are evaluated, m/s.
    pub(super) velocity: &'a [Vector<f64>],
    pub(super) body: &'a [u32],
    pub(super) velocity_gradient: &'a [Tensor<f64>],
    /// Empty if the formulation has none.
    pub(super) deformation: &'a [Tensor<f64>],
    /// That of the reference configuration; empty where that is the initial one.
    earlier_deformation: &'a [Tensor<f64>],
}

impl<'a> AtWall<'a> {
    pub(super) fn new(p: &'a Particles) -> Self {
        Self {
            position: &p.position,
            velocity: &p.evaluated_velocity,
            body: &p.body,
            velocity_gradient: &p.velocity_gradient,
            deformation: &p.deformation,
            earlier_deformation: &p.earlier_deformation,
        }
    }

    /// An upper bound of the distance of the surface of particle `i` from its centre, m.
    fn farthest(&self, spacing: f64, i: usize) -> f64 {
        let stretch = |f: Tensor<f64>| f.as_flattened().iter().map(|c| c * c).sum::<f64>().sqrt();
        0.5 * spacing * self.whole_deformation(i).map_or(1.0, stretch)
    }

    /// Deformation gradient of particle `i` since the start, if the formulation has one.
    pub(super) fn whole_deformation(&self, i: usize) -> Option<Tensor<f64>> {
        let whole = WholeDeformation { since: self.deformation, earlier: self.earlier_deformation };
        (!self.deformation.is_empty()).then(|| whole.at(i))
    }

    /// Half the extent of particle `i` along a normal (m), the point of the particle farthest against the normal in the
    /// reference configuration, relative to the centre (m) and with the sign reversed, and the velocity of that point
    /// (m/s).
    fn face(&self, spacing: f64, i: usize, normal: Vector<f64>) -> (f64, Vector<f64>, Vector<f64>) {
        let velocity = self.velocity[i];
        let Some(f) = self.whole_deformation(i) else { return (0.5 * spacing, [0.0; 3], velocity) };
        let MeetingPoint { radius, place, velocity } =
            MeetingPoint::new(spacing, &f, &self.velocity_gradient[i], velocity, normal);
        let face = self.earlier_deformation.get(i).map_or(place, |earlier| tensor::apply(earlier, place));
        (radius, face, velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_may_span_corners_of_a_velocity_table() {
        // Up to 6 m/s within 1 s, down to 2 m/s within 2 s more, then constant.
        let rows = TimeTable { points: vec![(1.0, 0.0), (2.0, 6.0), (4.0, 2.0)] };
        let zero = TimeTable::constant(0.0);
        let wall = Wall {
            name: String::new(),
            surface: WallSurface::Plane { point: [0.0; 3], normal: [1.0, 0.0, 0.0] },
            velocity: [zero.clone(), rows, zero],
            contact: WallContact::MonaghanKos { range: 1.0 },
        };
        let reach = |times: &[f64]| {
            let mut walls = Walls { states: vec![WallState::new(&wall)], ..Walls::default() };
            times.iter().for_each(|&time| walls.move_to(time));
            walls.states[0].displacement[1]
        };
        // To 1.5 s: 0.75. To 3 s: 3 + (6 + 4)/2 = 8. To 6 s: 3 + 8 + 4 = 15.
        assert_eq!([1.5, 3.0, 6.0].map(|time| reach(&[time])), [0.75, 8.0, 15.0]);
        assert_eq!(reach(&[0.5, 1.5, 3.0, 5.0, 6.0]), 15.0);
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
        // The gap is that to its new position.
        let gap = state.gap(&wall.surface, [7.0, 4.0, 0.0]);
        assert_eq!(gap, Some(Gap { distance: 3.0, normal: [1.0, 0.0, 0.0] }));
        let segment = WallSurface::Segment { from: [0.0; 3], to: [0.0, 2.0, 0.0] };
        assert_eq!(state.gap(&segment, [4.0, 1.0, 0.0]), None);
    }
}
