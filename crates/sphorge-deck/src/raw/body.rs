//! Bodies and regions.

use super::super::{choice::*, value::*};
use super::RawShape;
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
    /// Initial velocity linear in space, added to the velocity.
    pub(crate) velocity_gradient: Option<RawVelocityGradient>,
    /// Initial velocity by a table along an axis, added to the velocity.
    pub(crate) velocity_profile: Option<RawVelocityProfile>,
    /// Initial temperature.
    #[schemars(extend("examples" = ["20 degC"], "x-default" = "the material's `reference-temperature`"))]
    pub(crate) temperature: Option<Given<Temperature>>,
    /// Particle spacing of this body.
    #[schemars(extend("examples" = ["0.3 mm"], "x-default" = "that of `particles`"))]
    pub(crate) spacing: Option<Given<Length>>,
    /// Smoothing length over spacing of this body.
    #[schemars(extend("examples" = [1.2], "x-default" = "that of `particles`"))]
    pub(crate) smoothing: Option<Given<Number>>,
    /// How the particles of this body are arranged.
    #[schemars(extend("examples" = ["rings"], "x-default" = "that of `particles`"))]
    pub(crate) lattice: Option<Choice<ArrangementWord>>,
    /// Where the square or cubic lattice sits in this body.
    #[schemars(extend("examples" = ["on-faces"], "x-default" = "that of `particles`"))]
    pub(crate) placement: Option<Choice<PlacementWord>>,
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

/// Initial velocity linear in space.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawVelocityGradient {
    /// One row per component of the velocity: how it changes along each axis.
    #[schemars(extend("examples" = [[["0 /s", "1000 /s"], ["0 /s", "0 /s"]]]))]
    pub(crate) rows: Vec<VectorOf<Rate>>,
    /// Where this velocity is zero.
    #[schemars(extend("examples" = [["0 mm", "0 mm"]], "x-default" = "the origin"))]
    pub(crate) centre: Option<VectorOf<Length>>,
}

/// Initial velocity that varies along an axis, such as the shape of a mode of vibration.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawVelocityProfile {
    /// The axis.
    #[schemars(extend("examples" = ["x"]))]
    pub(crate) along: Choice<AxisWord>,
    /// Velocity where the table says 1.
    #[schemars(extend("examples" = [["0 m/s", "0.57 m/s"]]))]
    pub(crate) amplitude: VectorOf<Velocity>,
    /// Rows of place on the axis and share of the amplitude, places increasing: linear between rows, constant outside.
    #[schemars(extend("examples" = [[["0 mm", 0.0], ["200 mm", 1.0]]]))]
    pub(crate) rows: Vec<(Given<Length>, Given<Number>)>,
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
