//! Heat that flows.

use super::super::declare::tables;
use super::super::value::*;
use std::ops::Range;

tables! {
    /// Heat conduction between particles and through boundaries (Cleary & Monaghan 1999); between bodies where their faces are less than
    /// half a spacing apart.
    #[derive(Default)]
    RawThermal {
        /// Whether heat is conducted; `false` turns a table with boundaries off.
        conduction: Option<Flag>, default true;
        /// Whether bodies move; with `false` they stay at rest, and the time step is that of conduction.
        mechanics: Option<Flag>, default true;
        /// Boundaries where heat enters or leaves; all other surfaces are adiabatic.
        boundary: Vec<RawHeatBoundary>, or empty;
    }

    /// A heat boundary: `hold`, `surface-temperature`, `flux` or `convection`. All but `hold` act on free surfaces, which are
    /// detected as they form, in all directions: particles of a region at the end of a block also take heat through the sides of the block.
    /// With `normal` they act on the faces of that direction alone.
    RawHeatBoundary {
        /// Name of the boundary: column `heat.NAME` of `history.csv`.
        name: Word, example "hot-end";
        /// Only particles of this body.
        body: Option<Word>, example "bar", otherwise "all bodies";
        /// Only particles of this region.
        region: Option<Word>, example "left-end", otherwise "everywhere";
        /// Only the faces that look this way within 45 degrees, as they are at the start: whether other bodies cover them or not, and not those that
        /// form later. Their area is that of the shape, and follows the density. Not with `hold`.
        normal: Option<VectorOf<Number>>, example [-1, 0], otherwise "free surfaces in all directions, the side faces of a region among them";
        /// All its particles, not only those on a surface, are kept at this temperature.
        hold: Option<Given<Temperature>>, example "100 degC", otherwise "one of the four kinds is needed";
        /// Free surfaces, half a spacing outside of the outermost particles, have this temperature.
        surface_temperature: Option<Given<Temperature>>, example "100 degC", otherwise "one of the four kinds is needed";
        /// Heat into free surfaces; negative takes it out.
        flux: Option<Given<HeatFlux>>, example "5 kW/m^2", otherwise "one of the four kinds is needed";
        /// Newton's law of cooling on free surfaces.
        convection: Option<RawConvection>;
    }

    /// Surroundings of a surface.
    RawConvection {
        /// Heat transfer coefficient.
        coefficient: Given<HeatTransfer>, example "500 W/(m^2 K)";
        /// Temperature of the surroundings.
        ambient: Given<Temperature>, example "20 degC";
    }
}

impl RawThermal {
    /// Where the table stands: at one of its keys.
    pub(crate) fn span(&self) -> Range<usize> {
        let flag = self.conduction.as_ref().or(self.mechanics.as_ref()).map(|f| f.span());
        flag.or_else(|| self.boundary.first().map(|b| b.name.span())).unwrap_or(0..0)
    }
}
