//! Bounds of a pressure law: the tension a material bears before it spalls, and the energy of absolute zero.

use super::{EquationOfState, PressureState};
use crate::Real;

/// Share of `c_0^2` that stands for the energy of absolute zero where a material has no specific heat: metals hold about as much.
const ABSOLUTE_ZERO_SHARE: f64 = 0.01;

/// A pressure law, and what energy and pressure do not fall below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedPressure<T> {
    law: EquationOfState<T>,
    /// J/kg.
    least_energy: T,
    /// Pa.
    least_pressure: T,
}

impl<T: Real> BoundedPressure<T> {
    /// A law with a tension cut-off of `spall_pressure` (Pa, positive; infinite for none). Energies count as no less than that of
    /// absolute zero, `specific_heat` (J/(kg K), may be infinite) times `reference_temperature` (K) below that of the reference
    /// state: one below it is an error of the sums, and with it the pressure would pull ever harder, since tension at a negative energy
    /// works against itself.
    #[inline(always)]
    pub fn new(
        law: &EquationOfState<f64>,
        spall_pressure: f64,
        specific_heat: f64,
        reference_temperature: f64,
    ) -> Self {
        let c0 = law.reference_sound_speed();
        let least_energy = -(specific_heat * reference_temperature).min(ABSOLUTE_ZERO_SHARE * c0 * c0);
        Self { law: law.cast(), least_energy: T::of(least_energy), least_pressure: T::of(-spall_pressure) }
    }

    /// Pressure and sound speed at a density (kg/m³) and a specific internal energy (J/kg).
    #[inline(always)]
    pub fn at(&self, density: T, energy: T) -> PressureState<T> {
        let state = self.law.pressure(density, energy.max(self.least_energy));
        PressureState { pressure: state.pressure.max(self.least_pressure), ..state }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eos::Linear;

    /// K = 8000 4000^2 = 128 GPa, no heat in the pressure.
    fn steel(spall_pressure: f64, specific_heat: f64) -> BoundedPressure<f64> {
        let law = EquationOfState::Linear(Linear { density: 8000.0, sound_speed: 4000.0 });
        BoundedPressure::new(&law, spall_pressure, specific_heat, 300.0)
    }

    #[test]
    fn tension_is_cut_off_and_compression_is_not() {
        let law = steel(2e9, f64::INFINITY);
        // 1 % below the density at rest: -1.28 GPa; 2 %: -2.56 GPa, beyond the cut-off.
        assert!((law.at(7920.0, 0.0).pressure + 1.28e9).abs() < 1.0);
        assert_eq!(law.at(7840.0, 0.0).pressure, -2e9);
        assert!((law.at(8160.0, 0.0).pressure - 2.56e9).abs() < 1.0);
        assert!((steel(f64::INFINITY, 450.0).at(7840.0, 0.0).pressure + 2.56e9).abs() < 1.0);
    }

    #[test]
    fn energies_below_absolute_zero_count_as_it() {
        // 450 300 = 135 kJ/kg, less than 0.01 c0^2 = 160 kJ/kg.
        assert_eq!(steel(1e9, 450.0).least_energy, -135e3);
        assert_eq!(steel(1e9, f64::INFINITY).least_energy, -160e3);
    }
}
