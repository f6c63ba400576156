//! Heat that flows.

/// Conduction and what crosses the surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Thermal {
    /// Whether heat flows between particles, and through boundaries.
    pub conduction: bool,
    /// Whether bodies move; if not, heat alone decides the time step.
    pub mechanics: bool,
    /// Where heat comes in or goes out.
    pub boundaries: Vec<HeatBoundary>,
}

impl Default for Thermal {
    fn default() -> Self {
        Self { conduction: false, mechanics: true, boundaries: Vec::new() }
    }
}

/// A boundary heat flows through.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatBoundary {
    /// Name in the deck.
    pub name: String,
    /// Only particles of this body.
    pub body: Option<usize>,
    /// Only particles of this region (by initial position).
    pub region: Option<usize>,
    /// What flows.
    pub kind: HeatBoundaryKind,
}

/// What flows through a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeatBoundaryKind {
    /// All its particles, not only those on a surface, are kept at this temperature, K.
    HeldTemperature(f64),
    /// Free surfaces have this temperature, K.
    SurfaceTemperature(f64),
    /// Heat into free surfaces, W/m².
    Flux(f64),
    /// Newton's law of cooling on free surfaces.
    Convection {
        /// Heat transfer coefficient, W/(m² K).
        coefficient: f64,
        /// Temperature of what surrounds, K.
        ambient: f64,
    },
}

impl HeatBoundary {
    /// Whether a particle of this body and these regions (bit k: region k) belongs to it.
    #[inline]
    pub fn claims(&self, body: u32, regions: u32) -> bool {
        self.body.is_none_or(|b| b == body as usize) && self.region.is_none_or(|r| regions >> r & 1 == 1)
    }
}
