//! Walls, symmetry, periodic axes, prescribed motion.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

/// Values over time: rows of time and value, times increasing.
pub(crate) type Rows<K> = Vec<(Given<Time>, Given<K>)>;

tables! {
    /// A rigid wall; `plane` or `segment`.
    RawWall {
        /// Name of the wall.
        name: Word, example "anvil";
        /// Half space: material is on the side the normal points to.
        plane: Option<RawPlane>;
        /// Straight two-sided segment, in plane strain.
        segment: Option<RawSegment>;
        /// Velocity of the wall, by axis: a constant, or rows of time and velocity (linear between rows, constant outside).
        velocity: Option<Vec<ScalarOr<Given<Velocity>, Rows<Velocity>>>>, example ["0 m/s", [["0 s", "0 m/s"], ["5 ms", "1 m/s"]]], otherwise "at rest";
        /// Contact law of the wall.
        contact: Option<ScalarOr<Choice<ContactWord>, RawContact>>, example { "penalty": { "friction": 0.2 } }, otherwise "`penalty` in the total Lagrangian form, else `monaghan-kos`";
    }

    /// Point and normal.
    RawPlane {
        /// A point on the plane.
        point: VectorOf<Length>, example ["0 mm", "0 mm"];
        /// Direction from the wall towards the material, any length.
        normal: VectorOf<Number>, example [0, 1];
    }

    /// Two ends.
    RawSegment {
        /// One end.
        from: VectorOf<Length>, example ["-5 mm", "0 mm"];
        /// The other end.
        to: VectorOf<Length>, example ["5 mm", "0 mm"];
    }

    /// A contact law with its constants; exactly one.
    RawContact {
        /// Repulsion of Monaghan & Kos (1999).
        monaghan_kos: Option<RawMonaghanKos>;
        /// Linear penalty with damping and Coulomb friction; it never pulls.
        penalty: Option<RawPenalty>;
    }

    /// Constants of the Monaghan–Kos repulsion.
    RawMonaghanKos {
        /// Distance at which the repulsion begins.
        range: Option<Given<Length>>, example "0.3 mm", otherwise "`particles.spacing`";
    }

    /// Constants of the penalty contact.
    RawPenalty {
        /// Where the wall pushes bodies of the total Lagrangian form.
        surfaces: Option<Choice<WallSurfacesWord>>, otherwise "`\"facets\"` of segments, of planes that a round surface of a body with strength looks at at the start, and of planes where all bodies have strength, do not break and approach at the start slower than they yield (yield stress over `sqrt(density x Young's modulus)`), but not in 1D; else `\"particles\"`";
        /// Pressure for a closure of one spacing, over the bulk modulus; relative to m c0² / spacing² of a particle.
        stiffness: Option<Given<Number>>, example 1.0, otherwise "2.0 at facets, 1.0 at particles";
        /// Damping as a share of critical, 0 to 1.
        damping: Option<Given<Number>>, example 0.1, otherwise "0.05 at facets, 0.1 at particles";
        /// Coulomb friction coefficient. The wall is adiabatic: all heat of friction goes into the body.
        friction: Option<Given<Number>>, example 0.2, default 0.0;
    }

    /// A plane of symmetry, held by ghost particles.
    RawSymmetry {
        /// Axis the plane is normal to.
        axis: Choice<AxisWord>, example "x";
        /// Position of the plane on that axis.
        at: Option<Given<Length>>, example "0 mm", default 0.0;
        /// Side of the plane the material is on.
        side: Option<Choice<SideWord>>, example "positive", default "positive";
    }

    /// Periodic axes: both ends of the cell.
    #[derive(Default)]
    RawPeriodic {
        /// Ends along x.
        x: Option<VectorOf<Length>>, example ["0 mm", "5 mm"], otherwise "not periodic";
        /// Ends along y.
        y: Option<VectorOf<Length>>, example ["0 mm", "5 mm"], otherwise "not periodic";
        /// Ends along z.
        z: Option<VectorOf<Length>>, example ["0 mm", "5 mm"], otherwise "not periodic";
    }

    /// Fixed or driven particles.
    RawMotion {
        /// The particles.
        region: Word, example "left-end";
        /// Velocity, by axis: a constant (zero for fixed), rows of time and velocity (linear between rows, constant outside), or
        /// `"free"`.
        velocity: Vec<ScalarOr<VelocityOrFree, Rows<Velocity>>>, example ["0 m/s", "free", [["0 s", "0 m/s"], ["5 ms", "1 m/s"]]];
    }
}
