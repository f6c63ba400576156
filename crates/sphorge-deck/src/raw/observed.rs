//! Tracers and sections.

use super::super::{choice::*, value::*};
use schemars::JsonSchema;
use serde::Deserialize;

/// A particle to follow, or a point to watch: columns `tracer.NAME.FIELD` of `history.csv`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawTracer {
    /// Name of the tracer.
    #[schemars(extend("examples" = ["tail"]))]
    pub(crate) name: Word,
    /// The particle nearest to this point of the initial configuration is followed.
    #[schemars(extend("examples" = [["0 mm", "25 mm"]]))]
    pub(crate) point: VectorOf<Length>,
    /// Only particles of this body.
    #[schemars(extend("examples" = ["bar"], "x-default" = "all"))]
    pub(crate) body: Option<Word>,
    /// Stay at the point and interpolate with the kernel (Shepard) instead of following a particle; the cell is empty while no
    /// particle is near.
    #[schemars(extend("examples" = [true], "default" = false))]
    pub(crate) fixed: Option<Flag>,
    /// Fields to write, with all their components.
    #[schemars(extend("examples" = [["velocity", "stress"]], "x-default" = "position (not if `fixed`), velocity, pressure, von_mises_stress, plastic_strain, temperature"))]
    pub(crate) fields: Option<Vec<Choice<FieldWord>>>,
}

/// A plane fixed in space, the force through which is written: columns `section.NAME.normal_force` and `section.NAME.force_x` to
/// `_z` of `history.csv`. The force is the sum over particles of volume times stress times normal, weighted across the plane by
/// the cubic B-spline with the spacing as smoothing length: stress integrated over the plane, smoothed over two spacings either
/// side. It is what the material ahead of the plane (where the normal points) does to that behind; along the normal positive in
/// tension. With planes of symmetry it is that of the part that is there.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawSection {
    /// Name of the section.
    #[schemars(extend("examples" = ["waist"]))]
    pub(crate) name: Word,
    /// A point of the plane.
    #[schemars(extend("examples" = [["250 mm", "0 mm", "0 mm"]]))]
    pub(crate) point: VectorOf<Length>,
    /// Normal of the plane, any length.
    #[schemars(extend("examples" = [[1, 0, 0]]))]
    pub(crate) normal: VectorOf<Number>,
    /// Only particles of this body.
    #[schemars(extend("examples" = ["bar"], "x-default" = "all"))]
    pub(crate) body: Option<Word>,
}
