//! Bodies, shapes, regions.

use super::super::{choice::*, value::*};
use schemars::JsonSchema;
use serde::Deserialize;

/// A body of particles.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawBody {
    /// Name of the body: letters, digits, `-` and `_`.
    #[schemars(extend("examples" = ["bar"]))]
    pub(crate) name: Word,
    /// A material of the deck or of the catalogue.
    #[schemars(extend("examples" = ["armco-iron"]))]
    pub(crate) material: Word,
    /// Shape in the initial configuration.
    pub(crate) shape: RawShape,
    /// Initial velocity.
    #[schemars(extend("examples" = [["0 m/s", "-200 m/s"]], "x-default" = "at rest"))]
    pub(crate) velocity: Option<VectorOf<Velocity>>,
    /// Initial rotation, added to the velocity.
    pub(crate) spin: Option<RawSpin>,
    /// Initial temperature.
    #[schemars(extend("examples" = ["20 degC"], "x-default" = "the material's `reference-temperature`"))]
    pub(crate) temperature: Option<Given<Temperature>>,
    /// Particle spacing of this body.
    #[schemars(extend("examples" = ["0.3 mm"], "x-default" = "that of `particles`"))]
    pub(crate) spacing: Option<Given<Length>>,
    /// Smoothing length over spacing of this body.
    #[schemars(extend("examples" = [1.2], "x-default" = "that of `particles`"))]
    pub(crate) smoothing: Option<Given<Number>>,
    /// Where the lattice sits in this body.
    #[schemars(extend("examples" = ["on-faces"], "x-default" = "that of `particles`"))]
    pub(crate) placement: Option<Choice<PlacementWord>>,
}

/// One solid (`box`, `disc`, `sphere` or `cylinder`), turned and then shifted.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawShape {
    /// Box along the axes; an interval in one dimension.
    #[serde(rename = "box")]
    pub(crate) cuboid: Option<RawBox>,
    /// Disc, in plane strain.
    pub(crate) disc: Option<RawBall>,
    /// Sphere, in three dimensions.
    pub(crate) sphere: Option<RawBall>,
    /// Round solid cylinder, in three dimensions.
    pub(crate) cylinder: Option<RawCylinder>,
    /// Rotation, done before the shift.
    pub(crate) rotate: Option<RawRotate>,
    /// Translation.
    #[schemars(extend("examples" = [["5 mm", "0 mm"]], "x-default" = "none"))]
    pub(crate) shift: Option<VectorOf<Length>>,
}

/// Two opposite corners.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawBox {
    /// Corner with the smallest coordinates.
    #[schemars(extend("examples" = [["-3.8 mm", "0 mm"]]))]
    pub(crate) min: VectorOf<Length>,
    /// Corner with the largest coordinates.
    #[schemars(extend("examples" = [["3.8 mm", "25.46 mm"]]))]
    pub(crate) max: VectorOf<Length>,
}

/// Centre and radius.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawBall {
    /// Centre.
    #[schemars(extend("examples" = [["0 mm", "10 mm"]]))]
    pub(crate) centre: VectorOf<Length>,
    /// Radius.
    #[schemars(extend("examples" = ["5 mm"]))]
    pub(crate) radius: Given<Length>,
}

/// Axis and radius.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawCylinder {
    /// Centre of one end.
    #[schemars(extend("examples" = [["0 mm", "0 mm", "0 mm"]]))]
    pub(crate) from: VectorOf<Length>,
    /// Centre of the other end.
    #[schemars(extend("examples" = [["0 mm", "0 mm", "25.46 mm"]]))]
    pub(crate) to: VectorOf<Length>,
    /// Radius.
    #[schemars(extend("examples" = ["3.8 mm"]))]
    pub(crate) radius: Given<Length>,
}

/// Rotation by the right-hand rule.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawRotate {
    /// Direction of the axis, any length; three components. In plane strain it is z and may be left out.
    #[schemars(extend("examples" = [[0, 0, 1]], "x-default" = "z in plane strain"))]
    pub(crate) axis: Option<VectorOf<Number>>,
    /// Angle.
    #[schemars(extend("examples" = ["30 deg"]))]
    pub(crate) angle: Given<Angle>,
    /// A point on the axis.
    #[schemars(extend("examples" = [["0 mm", "10 mm"]], "x-default" = "the origin"))]
    pub(crate) about: Option<VectorOf<Length>>,
}

/// Rigid rotation of the initial velocity.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSpin {
    /// Angular velocity: three components, or in plane strain the one about z.
    #[schemars(extend("examples" = ["1200 rpm"]))]
    pub(crate) rate: ScalarOr<Given<AngularVelocity>, Vec<Given<AngularVelocity>>>,
    /// Centre of the rotation.
    #[schemars(extend("examples" = [["0 mm", "0 mm"]], "x-default" = "the origin"))]
    pub(crate) centre: Option<VectorOf<Length>>,
}

/// A named set of particles, chosen in the initial configuration; `body`, `shape` or both.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawRegion {
    /// Name of the region.
    #[schemars(extend("examples" = ["left-end"]))]
    pub(crate) name: Word,
    /// Only particles of this body.
    #[schemars(extend("examples" = ["bar"], "x-default" = "all bodies"))]
    pub(crate) body: Option<Word>,
    /// Only particles inside this shape or on its surface.
    pub(crate) shape: Option<RawShape>,
}
