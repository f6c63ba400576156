//! Walls, symmetry planes, prescribed motion.

/// A piecewise linear function of time; constant before the first and after the last point.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeTable {
    /// `(time in s, value)`, times strictly increasing, never empty.
    pub points: Vec<(f64, f64)>,
}

impl TimeTable {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self { points: vec![(0.0, value)] }
    }

    /// Value at time `t`.
    pub fn at(&self, t: f64) -> f64 {
        linear(&self.points, t)
    }

    /// Integral over the times from `from` to a later `to`: trapezoids between the points, which is exact.
    pub fn integral(&self, from: f64, to: f64) -> f64 {
        let first = self.points.partition_point(|point| point.0 <= from);
        let inside = self.points[first..].iter().map(|point| point.0).take_while(|&corner| corner < to);
        let (mut sum, mut start) = (0.0, from);
        for end in inside.chain([to]) {
            sum += 0.5 * (self.at(start) + self.at(end)) * (end - start);
            start = end;
        }
        sum
    }
}

/// Value of a table at `x`: linear between rows, constant outside.
pub(super) fn linear(rows: &[(f64, f64)], x: f64) -> f64 {
    let next = rows.partition_point(|row| row.0 <= x);
    match (next.checked_sub(1).and_then(|k| rows.get(k)), rows.get(next)) {
        (Some(&(x0, v0)), Some(&(x1, v1))) => v0 + (v1 - v0) * (x - x0) / (x1 - x0),
        (Some(&(_, v)), None) | (None, Some(&(_, v))) => v,
        (None, None) => 0.0,
    }
}

/// A rigid wall.
#[derive(Clone, Debug)]
pub struct Wall {
    /// Name in the deck.
    pub name: String,
    /// Where the wall stands at time zero.
    pub surface: WallSurface,
    /// Velocity of the wall by axis, m/s.
    pub velocity: [TimeTable; 3],
    /// How it pushes.
    pub contact: WallContact,
}

impl Wall {
    /// Whether its friction heats what slides along it.
    pub fn rubs(&self) -> bool {
        match self.contact {
            WallContact::MonaghanKos { .. } => false,
            WallContact::Penalty { friction, .. } => friction > 0.0,
        }
    }

    /// Whether it pushes bodies that have facets there.
    pub fn is_at_facets(&self) -> bool {
        match self.contact {
            WallContact::MonaghanKos { .. } => false,
            WallContact::Penalty { at_facets, .. } => at_facets,
        }
    }
}

/// Geometry of a wall.
#[derive(Clone, Copy, Debug)]
pub enum WallSurface {
    /// Half space: material is on the side the unit normal points to.
    Plane {
        /// A point on the plane, m.
        point: [f64; 3],
        /// Unit normal towards the material.
        normal: [f64; 3],
    },
    /// Straight segment in plane strain, two-sided: pushes away from the line, its ends act like points.
    Segment {
        /// One end, m.
        from: [f64; 3],
        /// Other end, m.
        to: [f64; 3],
    },
}

/// Force law of a wall.
#[derive(Clone, Copy, Debug)]
pub enum WallContact {
    /// Repulsion of Monaghan & Kos (1999).
    MonaghanKos {
        /// Distance at which the repulsion begins, m.
        range: f64,
    },
    /// Linear penalty with damping and Coulomb friction; it never pulls.
    Penalty {
        /// Stiffness as a multiple of the particle's `m c0² / spacing²`.
        stiffness: f64,
        /// Damping as a share of critical.
        damping: f64,
        /// Coulomb coefficient.
        friction: f64,
        /// Whether it pushes bodies at the facets of their particles, which only the total Lagrangian form has, else at the points of
        /// the particles that are nearest to it.
        at_facets: bool,
    },
}

/// A plane of symmetry, held by ghost particles. Axis-aligned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryPlane {
    /// Axis the plane is normal to (0, 1, 2).
    pub axis: usize,
    /// Position of the plane on that axis, m.
    pub position: f64,
    /// +1 if material is on the positive side, -1 if on the negative side.
    pub side: f64,
}

/// Fixed or driven particles.
#[derive(Clone, Debug)]
pub struct PrescribedMotion {
    /// Index into [`super::Model::regions`].
    pub region: usize,
    /// What is prescribed along each axis.
    pub axes: [MotionAxis; 3],
}

/// Motion along one axis.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionAxis {
    /// Not prescribed.
    Free,
    /// Velocity by a time table, m/s (a constant zero holds the particles).
    Velocity(TimeTable),
}

impl MotionAxis {
    /// Velocity at a time (s), m/s, where it is prescribed.
    pub fn velocity(&self, time: f64) -> Option<f64> {
        match self {
            Self::Free => None,
            Self::Velocity(table) => Some(table.at(time)),
        }
    }

    /// Mean acceleration over the time `dt` (s) before a time (s), m/s², where the velocity is prescribed; zero over no time.
    pub fn acceleration(&self, time: f64, dt: f64) -> Option<f64> {
        match self {
            Self::Free => None,
            Self::Velocity(_) if dt == 0.0 => Some(0.0),
            Self::Velocity(table) => Some((table.at(time) - table.at(time - dt)) / dt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_is_linear_between_points_and_constant_outside() {
        let ramp = TimeTable { points: vec![(1.0, 2.0), (3.0, 6.0)] };
        assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|t| ramp.at(t)), [2.0, 2.0, 4.0, 6.0, 6.0]);
        assert_eq!(TimeTable::constant(5.0).at(-1.0), 5.0);
    }

    #[test]
    fn velocity_and_acceleration_of_a_motion_by_hand() {
        let ramp = MotionAxis::Velocity(TimeTable { points: vec![(1.0, 2.0), (3.0, 6.0)] });
        assert_eq!([ramp.velocity(2.0), MotionAxis::Free.velocity(2.0)], [Some(4.0), None]);
        // 2 per second on the ramp, half of that where half of the time is before it.
        let over = [(3.0, 1.0), (1.5, 1.0), (2.0, 0.0)].map(|(time, dt)| ramp.acceleration(time, dt));
        assert_eq!(over, [Some(2.0), Some(1.0), Some(0.0)]);
        assert_eq!(MotionAxis::Free.acceleration(3.0, 1.0), None);
    }

    #[test]
    fn integrals_of_tables_by_hand() {
        let ramp = TimeTable { points: vec![(1.0, 2.0), (3.0, 6.0)] };
        // 2 before the ramp, 8 under it, 6 per second behind it.
        let spans = [(0.0, 1.0), (1.0, 3.0), (0.0, 3.0), (0.0, 4.0), (2.0, 5.0), (4.0, 5.0), (2.0, 2.0)];
        assert_eq!(spans.map(|(from, to)| ramp.integral(from, to)), [2.0, 8.0, 10.0, 16.0, 17.0, 6.0, 0.0]);
        assert_eq!(TimeTable::constant(5.0).integral(-1.0, 2.0), 15.0);
    }
}
