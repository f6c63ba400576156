//! Heat that flows.

use sphorge_physics::Real;
use sphorge_physics::conduction::surface_conductance;

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

impl Thermal {
    /// Whether heat is taken out whatever the temperature, so that particles could be cooled below absolute zero.
    pub fn is_cooled(&self) -> bool {
        let cools = |kind| matches!(kind, HeatBoundaryKind::Flux(flux) if flux < 0.0);
        self.conduction && self.boundaries.iter().any(|b| cools(b.kind))
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
    /// Only the faces that look along this unit vector within 45 degrees, as they are at the start; `None`: free surfaces, found as they form.
    pub normal: Option<[f64; 3]>,
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

impl HeatBoundaryKind {
    /// Power (W) and conductance (W/K) into a particle, with a temperature (K), a conductivity (W/(m K)) and the edge of its cell (m), that stands
    /// for an area of the surface (m^(d-1)).
    #[inline(always)]
    pub fn through_surface<T: Real>(self, area: T, temperature: T, conductivity: T, cell: T) -> (T, T) {
        let (film, outside) = match self {
            Self::HeldTemperature(_) => return (T::zero(), T::zero()),
            Self::Flux(flux) => return (area * T::of(flux), T::zero()),
            Self::SurfaceTemperature(temperature) => (None, temperature),
            Self::Convection { coefficient, ambient } => (Some(T::of(coefficient)), ambient),
        };
        let conductance = area * surface_conductance(film, conductivity, cell);
        (conductance * (T::of(outside) - temperature), conductance)
    }
}

impl HeatBoundary {
    /// Whether a particle of this body and these regions (bit k: region k) belongs to it.
    #[inline]
    pub fn claims(&self, body: u32, regions: u32) -> bool {
        self.body.is_none_or(|b| b == body as usize) && self.region.is_none_or(|r| regions >> r & 1 == 1)
    }
}
