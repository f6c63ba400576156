//! Heat that flows.

use super::super::value::*;
use schemars::JsonSchema;
use serde::Deserialize;
use std::ops::Range;

/// Heat that flows between particles and through boundaries (Cleary & Monaghan 1999).
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawThermal {
    /// Whether heat flows; `false` turns a table with boundaries off.
    #[schemars(extend("default" = true))]
    pub(crate) conduction: Option<Flag>,
    /// Whether bodies move; with `false` they stay where they are, and the time step is that of conduction.
    #[schemars(extend("default" = true))]
    pub(crate) mechanics: Option<Flag>,
    /// Where heat comes in or goes out; no heat crosses other surfaces.
    #[serde(default)]
    pub(crate) boundary: Vec<RawHeatBoundary>,
}

/// A boundary heat flows through: `hold`, `surface-temperature`, `flux` or `convection`. All but `hold` act on free surfaces, which are
/// found as they form.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawHeatBoundary {
    /// Name of the boundary: column `heat.NAME` of `history.csv`.
    #[schemars(extend("examples" = ["hot-end"]))]
    pub(crate) name: Word,
    /// Only particles of this body.
    #[schemars(extend("examples" = ["bar"], "x-default" = "all bodies"))]
    pub(crate) body: Option<Word>,
    /// Only particles of this region.
    #[schemars(extend("examples" = ["left-end"], "x-default" = "everywhere"))]
    pub(crate) region: Option<Word>,
    /// All its particles, not only those on a surface, are kept at this temperature.
    #[schemars(extend("examples" = ["100 degC"], "x-default" = "another kind"))]
    pub(crate) hold: Option<Given<Temperature>>,
    /// Free surfaces, half a spacing outside of the outermost particles, have this temperature.
    #[schemars(extend("examples" = ["100 degC"], "x-default" = "another kind"))]
    pub(crate) surface_temperature: Option<Given<Temperature>>,
    /// Heat into free surfaces; negative takes it out.
    #[schemars(extend("examples" = ["5 kW/m^2"], "x-default" = "another kind"))]
    pub(crate) flux: Option<Given<HeatFlux>>,
    /// Newton's law of cooling on free surfaces.
    pub(crate) convection: Option<RawConvection>,
}

/// What surrounds a surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawConvection {
    /// Heat transfer coefficient.
    #[schemars(extend("examples" = ["500 W/(m^2 K)"]))]
    pub(crate) coefficient: Given<HeatTransfer>,
    /// Temperature of the surroundings.
    #[schemars(extend("examples" = ["20 degC"]))]
    pub(crate) ambient: Given<Temperature>,
}

impl RawThermal {
    /// Where the table stands: at one of its keys.
    pub(crate) fn span(&self) -> Range<usize> {
        let flag = self.conduction.as_ref().or(self.mechanics.as_ref()).map(|f| f.0.span.clone());
        flag.or_else(|| self.boundary.first().map(|b| b.name.span())).unwrap_or(0..0)
    }
}
