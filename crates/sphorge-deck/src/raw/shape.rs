//! Shapes.

use super::super::value::*;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

/// One solid, or several put together by `union`, `difference` or `intersection`; turned and then shifted. Every part is a shape
/// like this one, with its own `rotate` and `shift`, so parts can be composed themselves.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawShape {
    /// Box along the axes; an interval in one dimension.
    #[serde(rename = "box")]
    pub(crate) cuboid: Option<RawBox>,
    /// Disc or ring, in plane strain.
    pub(crate) disc: Option<RawBall>,
    /// Sphere or hollow sphere, in three dimensions.
    pub(crate) sphere: Option<RawBall>,
    /// Round cylinder or tube, in three dimensions.
    pub(crate) cylinder: Option<RawCylinder>,
    /// Bar turned on a lathe: stepped, coned, waisted; in plane strain a plate of this outline.
    pub(crate) revolution: Option<RawRevolution>,
    /// Round bar with an ogive nose, as bullets have; in plane strain a plate of this outline.
    pub(crate) ogive: Option<RawOgive>,
    /// Area inside a closed line of corners, in plane strain.
    pub(crate) polygon: Option<RawPolygon>,
    /// Particles from a file; the whole shape of a body.
    pub(crate) table: Option<RawTable>,
    /// What is in any of these shapes.
    #[schemars(with = "Option<Vec<RawShape>>", extend("x-default" = "none"))]
    pub(crate) union: Option<Vec<Spanned<RawShape>>>,
    /// What is in the first of these shapes and in no other.
    #[schemars(with = "Option<Vec<RawShape>>", extend("x-default" = "none"))]
    pub(crate) difference: Option<Vec<Spanned<RawShape>>>,
    /// What is in all of these shapes.
    #[schemars(with = "Option<Vec<RawShape>>", extend("x-default" = "none"))]
    pub(crate) intersection: Option<Vec<Spanned<RawShape>>>,
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
    /// Radius of a hole.
    #[schemars(extend("examples" = ["3 mm"], "x-default" = "no hole"))]
    pub(crate) inner_radius: Option<Given<Length>>,
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
    /// Radius of a hole.
    #[schemars(extend("examples" = ["3 mm"], "x-default" = "no hole"))]
    pub(crate) inner_radius: Option<Given<Length>>,
}

/// What lies between an axis and a profile turned about it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawRevolution {
    /// Point of the axis from which axial distances count.
    #[schemars(extend("examples" = [["0 mm", "0 mm", "0 mm"]], "x-default" = "the origin"))]
    pub(crate) from: Option<VectorOf<Length>>,
    /// Direction of the axis, any length.
    #[schemars(extend("examples" = [[1, 0, 0]]))]
    pub(crate) axis: VectorOf<Number>,
    /// Axial distance and radius, point by point along the axis; straight between them. Two points at one axial distance are a step.
    #[schemars(extend("examples" = [[["0 mm", "75 mm"], ["200 mm", "75 mm"], ["225 mm", "50 mm"]]]))]
    pub(crate) profile: Vec<VectorOf<Length>>,
}

/// Round bar with a tangent ogive: the outline of the nose is an arc of a circle that leaves the bar without a kink.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawOgive {
    /// Centre of the flat end.
    #[schemars(extend("examples" = [["0 mm", "0 mm", "0 mm"]]))]
    pub(crate) from: VectorOf<Length>,
    /// Tip.
    #[schemars(extend("examples" = [["0 mm", "0 mm", "261 mm"]]))]
    pub(crate) to: VectorOf<Length>,
    /// Radius of the bar.
    #[schemars(extend("examples" = ["15 mm"]))]
    pub(crate) radius: Given<Length>,
    /// Length of the nose, at least the radius, which makes it a hemisphere; or `head-radius`.
    #[schemars(extend("examples" = ["75 mm"], "x-default" = "from `head-radius`"))]
    pub(crate) nose_length: Option<Given<Length>>,
    /// Radius of the arc of the nose; or `nose-length`. The length then is sqrt(radius (2 head-radius - radius)).
    #[schemars(extend("examples" = ["90 mm"], "x-default" = "from `nose-length`"))]
    pub(crate) head_radius: Option<Given<Length>>,
}

/// Area inside a closed line.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawPolygon {
    /// Corners in order, at least three; the last is joined to the first. The line must not cross itself.
    #[schemars(extend("examples" = [[["0 mm", "0 mm"], ["10 mm", "0 mm"], ["0 mm", "5 mm"]]]))]
    pub(crate) corners: Vec<VectorOf<Length>>,
}

/// Particles from a CSV file. The first line names the columns: `x`, and with the dimensions of the deck `y` and `z`; if given `mass`
/// or `volume` of each particle, otherwise it stands for spacing to the power of the dimensions; if given the velocity `vx`, `vy`,
/// `vz`, to which that of the body is added. Other columns are not read; lines that begin with `#` are comments.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawTable {
    /// The file, from the folder of the deck.
    #[schemars(extend("examples" = ["bar.csv"]))]
    pub(crate) file: Word,
    /// Unit of the coordinates.
    #[schemars(extend("examples" = ["mm"], "default" = "m"))]
    pub(crate) length_unit: Option<Word>,
    /// Unit of the velocities.
    #[schemars(extend("examples" = ["km/s"], "default" = "m/s"))]
    pub(crate) velocity_unit: Option<Word>,
    /// Unit of the masses; in plane strain per length, in one dimension per area.
    #[schemars(extend("examples" = ["mg"], "x-default" = "kg, kg/m, kg/m^2"))]
    pub(crate) mass_unit: Option<Word>,
    /// Unit of the volumes; of areas in plane strain, of lengths in one dimension.
    #[schemars(extend("examples" = ["mm^3"], "x-default" = "m^3, m^2, m"))]
    pub(crate) volume_unit: Option<Word>,
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
