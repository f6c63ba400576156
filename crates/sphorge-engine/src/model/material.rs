//! Materials.

use sphorge_physics::conduction::effusivity;
use sphorge_physics::eos::{BoundedPressure, EquationOfState, PressureState};
use sphorge_physics::flow::{FlowLaw, FlowState};
use sphorge_physics::total_lagrangian::young_modulus;
use sphorge_physics::{Real, return_mapping::ReturnRule};

/// A material, all constants in SI.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name in the catalogue or the deck.
    pub name: String,
    /// Where the constants come from.
    pub reference: String,
    /// Density at rest, kg/m³.
    pub density: f64,
    /// Shear modulus G at rest, Pa (0 for a fluid).
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

    /// What the flow law may depend on, at a temperature (K), density (kg/m³) and pressure (Pa); the rate of plastic strain is not
    /// known, and zero.
    #[inline(always)]
    pub fn flow_state(&self, plastic_strain: f64, temperature: f64, density: f64, pressure: f64) -> FlowState<f64> {
        let compression = density / self.density;
        FlowState { plastic_strain, pressure, compression, ..FlowState::at_rest(temperature) }
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

    /// Effusivity at rest, W s^(1/2)/(m² K); zero or infinite where conductivity or specific heat is not given.
    pub fn effusivity(&self) -> f64 {
        effusivity(self.conductivity, self.density, self.specific_heat)
    }

    /// Specific energy of a density (kg/m³) on the isotherm of the reference temperature, J/kg, with the tension cut-off.
    pub fn cold_energy(&self, density: f64) -> f64 {
        self.bounded_pressure().cold_energy(density, self.reference_temperature, self.specific_heat)
    }

    /// Young's modulus at rest, Pa.
    pub fn young_modulus(&self) -> f64 {
        let c = self.equation_of_state.pressure(self.density, 0.0).sound_speed;
        young_modulus(self.density * c * c, self.shear_modulus)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphorge_physics::{eos::EQUATIONS_OF_STATE, flow::FLOW_LAWS};

    #[test]
    fn the_flow_law_sees_compression_against_the_density_at_rest() {
        let law = |key: &str| FLOW_LAWS.iter().find(|entry| entry.key == key).unwrap();
        let material = Material {
            name: String::new(),
            reference: String::new(),
            density: 8000.0,
            shear_modulus: 80e9,
            equation_of_state: (EQUATIONS_OF_STATE[0].build)(&[8000.0, 4000.0]),
            flow_law: (law("elastic").build)(&[]),
            return_rule: ReturnRule::RadialReturn,
            specific_heat: NO_HEATING,
            conductivity: 0.0,
            taylor_quinney: 0.9,
            spall_pressure: f64::INFINITY,
            reference_temperature: 293.15,
        };
        for (strain, temperature, density, pressure, compression) in
            [(0.2, 400.0, 8800.0, 1.28e10, 1.1), (0.0, 300.0, 7200.0, -1.28e10, 0.9)]
        {
            let state = material.flow_state(strain, temperature, density, pressure);
            assert_eq!((state.plastic_strain, state.plastic_strain_rate), (strain, 0.0));
            assert_eq!((state.temperature, state.pressure, state.compression), (temperature, pressure, compression));
        }
    }
}
