//! Walls, symmetry, periodic axes, prescribed motion.

use super::super::{choice::*, value::*};
use schemars::JsonSchema;
use serde::Deserialize;

/// Values over time: rows of time and value, times increasing.
pub(crate) type Rows<K> = Vec<(Given<Time>, Given<K>)>;

/// A rigid wall; `plane` or `segment`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawWall {
    /// Name of the wall.
    #[schemars(extend("examples" = ["anvil"]))]
    pub(crate) name: Word,
    /// Half space: material is on the side the normal points to.
    pub(crate) plane: Option<RawPlane>,
    /// Straight two-sided segment, in plane strain.
    pub(crate) segment: Option<RawSegment>,
    /// Velocity of the wall, by axis: a constant, or rows of time and velocity (linear between rows, constant outside).
    #[schemars(extend("examples" = [["0 m/s", [["0 s", "0 m/s"], ["5 ms", "1 m/s"]]]], "x-default" = "at rest"))]
    pub(crate) velocity: Option<Vec<ScalarOr<Given<Velocity>, Rows<Velocity>>>>,
    /// How the wall pushes.
    #[schemars(extend("examples" = [{ "penalty": { "friction": 0.2 } }], "default" = "monaghan-kos"))]
    pub(crate) contact: Option<ScalarOr<Choice<ContactWord>, RawContact>>,
}

/// Point and normal.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawPlane {
    /// A point on the plane.
    #[schemars(extend("examples" = [["0 mm", "0 mm"]]))]
    pub(crate) point: VectorOf<Length>,
    /// Direction from the wall towards the material, any length.
    #[schemars(extend("examples" = [[0, 1]]))]
    pub(crate) normal: VectorOf<Number>,
}

/// Two ends.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSegment {
    /// One end.
    #[schemars(extend("examples" = [["-5 mm", "0 mm"]]))]
    pub(crate) from: VectorOf<Length>,
    /// The other end.
    #[schemars(extend("examples" = [["5 mm", "0 mm"]]))]
    pub(crate) to: VectorOf<Length>,
}

/// A contact law with constants of its own; one of them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawContact {
    /// Repulsion of Monaghan & Kos (1999).
    pub(crate) monaghan_kos: Option<RawMonaghanKos>,
    /// Linear penalty with damping and Coulomb friction; pushes only.
    pub(crate) penalty: Option<RawPenalty>,
}

/// Constants of the Monaghan–Kos repulsion.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawMonaghanKos {
    /// Distance at which the repulsion begins.
    #[schemars(extend("examples" = ["0.3 mm"], "x-default" = "`particles.spacing`"))]
    pub(crate) range: Option<Given<Length>>,
}

/// Constants of the penalty contact.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawPenalty {
    /// Stiffness over m c0² / spacing² of the particle.
    #[schemars(extend("examples" = [1.0], "default" = 1.0))]
    pub(crate) stiffness: Option<Given<Number>>,
    /// Damping as a share of critical, 0 to 1.
    #[schemars(extend("examples" = [0.1], "default" = 0.1))]
    pub(crate) damping: Option<Given<Number>>,
    /// Coulomb coefficient.
    #[schemars(extend("examples" = [0.2], "default" = 0.0))]
    pub(crate) friction: Option<Given<Number>>,
}

/// A plane of symmetry, held by ghost particles.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSymmetry {
    /// Axis the plane is normal to.
    #[schemars(extend("examples" = ["x"]))]
    pub(crate) axis: Choice<AxisWord>,
    /// Position of the plane on that axis.
    #[schemars(extend("examples" = ["0 mm"], "default" = 0.0))]
    pub(crate) at: Option<Given<Length>>,
    /// Side of the plane the material is on.
    #[schemars(extend("examples" = ["positive"], "default" = "positive"))]
    pub(crate) side: Option<Choice<SideWord>>,
}

/// Periodic axes: both ends of the cell.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawPeriodic {
    /// Ends along x.
    #[schemars(extend("examples" = [["0 mm", "5 mm"]], "x-default" = "not periodic"))]
    pub(crate) x: Option<VectorOf<Length>>,
    /// Ends along y.
    #[schemars(extend("examples" = [["0 mm", "5 mm"]], "x-default" = "not periodic"))]
    pub(crate) y: Option<VectorOf<Length>>,
    /// Ends along z.
    #[schemars(extend("examples" = [["0 mm", "5 mm"]], "x-default" = "not periodic"))]
    pub(crate) z: Option<VectorOf<Length>>,
}

/// Held or driven particles.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawMotion {
    /// The particles.
    #[schemars(extend("examples" = ["left-end"]))]
    pub(crate) region: Word,
    /// Velocity, by axis: a constant (zero holds), rows of time and velocity (linear between rows, constant outside), or
    /// `"free"`.
    #[schemars(extend("examples" = [["0 m/s", "free", [["0 s", "0 m/s"], ["5 ms", "1 m/s"]]]]))]
    pub(crate) velocity: Vec<ScalarOr<VelocityOrFree, Rows<Velocity>>>,
}
