//! Materials.

use sphorge_physics::eos::{BoundedPressure, EquationOfState, PressureState};
use sphorge_physics::{Real, flow::FlowLaw, return_mapping::ReturnRule};

/// A material, all constants in SI.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name in the catalogue or the deck.
    pub name: String,
    /// Where the constants come from.
    pub reference: String,
    /// Density at rest, kg/m³.
    pub density: f64,
    /// Shear modulus G, Pa (0 for a fluid).
    pub shear_modulus: f64,
    /// Pressure law.
    pub equation_of_state: EquationOfState<f64>,
    /// Flow law.
    pub flow_law: FlowLaw<f64>,
    /// How the trial stress returns to the yield surface.
    pub return_rule: ReturnRule,
    /// Specific heat Cp, J/(kg K); [`NO_HEATING`] where the deck gives none: work does not change the temperature.
    pub specific_heat: f64,
    /// Thermal conductivity k, W/(m K).
    pub conductivity: f64,
    /// Share of plastic work that heats (Taylor–Quinney).
    pub taylor_quinney: f64,
    /// Tension the material bears before it spalls, Pa, positive: the pressure never falls below its negative. Infinite where the
    /// deck gives none.
    pub spall_pressure: f64,
    /// Temperature at which the internal energy is zero, and at which bodies start unless they say otherwise, K.
    pub reference_temperature: f64,
}

/// Specific heat of a material that gives none: plastic work and energy do not change its temperature.
pub const NO_HEATING: f64 = f64::INFINITY;

impl Material {
    /// Whether the material has a specific heat, so that work changes its temperature.
    pub fn heats(&self) -> bool {
        self.specific_heat < NO_HEATING
    }

    /// Pressure (Pa) and sound speed at a density (kg/m³) and a specific internal energy (J/kg), tension cut off where the
    /// material spalls. Energies below that of absolute zero count as that.
    #[inline(always)]
    pub fn pressure(&self, density: f64, energy: f64) -> PressureState<f64> {
        self.bounded_pressure().at(density, energy)
    }

    /// The same, to be computed one by one or on SIMD lanes.
    #[inline(always)]
    pub fn bounded_pressure<T: Real>(&self) -> BoundedPressure<T> {
        BoundedPressure::new(
            &self.equation_of_state,
            self.spall_pressure,
            self.specific_heat,
            self.reference_temperature,
        )
    }
}
