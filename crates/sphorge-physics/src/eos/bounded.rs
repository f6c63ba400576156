//! The bound of a pressure law, the energy of absolute zero, the energy of its isotherm up to where the material spalls, and the state of
//! zero pressure at a temperature.

use super::{EquationOfState, PressureState};
use crate::{Elementary, Real};

/// Share of `c_0^2` that stands for the energy of absolute zero where a material has no specific heat: metals hold about as much.
const ABSOLUTE_ZERO_SHARE: f64 = 0.01;

/// A pressure law, and what the energy does not fall below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedPressure<T> {
    law: EquationOfState<T>,
    /// J/kg.
    least_energy: T,
}

impl<T: Real> BoundedPressure<T> {
    /// Energies count as no less than that of absolute zero, `specific_heat` (J/(kg K), may be infinite) times `reference_temperature` (K) below that of the reference
    /// state: one below it is an error of the sums, and with it the pressure would pull ever harder, since tension at a negative energy
    /// works against itself.
    #[inline(always)]
    pub fn new(law: &EquationOfState<f64>, specific_heat: f64, reference_temperature: f64) -> Self {
        let c0 = law.reference_sound_speed();
        let least_energy = -(specific_heat * reference_temperature).min(ABSOLUTE_ZERO_SHARE * c0 * c0);
        Self { law: law.cast(), least_energy: T::of(least_energy) }
    }

    /// Pressure and sound speed at a density (kg/m³) and a specific internal energy (J/kg).
    #[inline(always)]
    pub fn at(&self, density: T, energy: T) -> PressureState<T> {
        self.law.pressure(density, energy.max(self.least_energy))
    }

    /// What is left of the energy that the reference state has above absolute zero: one at an energy (J/kg) of zero and above, zero from that of absolute
    /// zero down. What takes work from the internal energy and is no stress of the material, as the artificial stress does, has that much of it to take.
    #[inline(always)]
    pub fn energy_left(&self, energy: T) -> T {
        // A reference state at absolute zero has nothing: any lack is all of it.
        let held = (-self.least_energy).max(T::of(f64::from(f32::MIN_POSITIVE)));
        (T::one() + energy.min(T::zero()) / held).max(T::zero())
    }
}

/// Steps to the density of the cut-off; each halves what is left of the distance or does better.
const STEPS_TO_CUT_OFF: u32 = 60;

/// Share of the density at rest where every metal is beyond its cut-off.
const FAR_EXPANDED: f64 = 1e-3;

/// Specific energy of a density on the isotherm of a reference temperature, and where on it a material spalls: what is the same for all of
/// its particles.
///
/// What opens does not strain: below the density at which the solid bears the tension it still bears, the energy is that of this density.
/// Integrity takes it in proportion from the one where whole material pulls with the spall pressure to the density at rest. The work of
/// the opening is heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColdEnergy<T> {
    law: EquationOfState<T>,
    /// K.
    reference_temperature: T,
    /// J/(kg K).
    specific_heat: T,
    /// Density at rest, kg/m³.
    rest: T,
    /// What the density falls below it until the material spalls, kg/m³, if it does.
    to_cut_off: Option<T>,
}

impl<T: Real> ColdEnergy<T> {
    /// Of a law on the isotherm of a reference temperature (K), with a specific heat (J/(kg K)) and a spall pressure (Pa; infinite for
    /// none).
    pub fn new(
        law: &EquationOfState<f64>,
        spall_pressure: f64,
        reference_temperature: f64,
        specific_heat: f64,
    ) -> Self {
        let rest = law.reference_density();
        let to_cut_off = spall_pressure
            .is_finite()
            .then(|| rest - cut_off(law, spall_pressure, reference_temperature, specific_heat));
        Self {
            law: law.cast(),
            reference_temperature: T::of(reference_temperature),
            specific_heat: T::of(specific_heat),
            rest: T::of(rest),
            to_cut_off: to_cut_off.map(T::of),
        }
    }
}

/// Most times the density is doubled or halved in search of that of zero pressure.
const FARTHEST_DOUBLINGS: u32 = 8;

impl ColdEnergy<f64> {
    /// The same in another precision, or with every constant in all lanes of a SIMD vector.
    #[expect(clippy::manual_map, reason = "a closure is not compiled for the instructions in use")]
    #[inline(always)]
    pub fn cast<U: Real>(&self) -> ColdEnergy<U> {
        ColdEnergy {
            law: self.law.cast(),
            reference_temperature: U::of(self.reference_temperature),
            specific_heat: U::of(self.specific_heat),
            rest: U::of(self.rest),
            to_cut_off: match self.to_cut_off {
                Some(fall) => Some(U::of(fall)),
                None => None,
            },
        }
    }

    /// Specific internal energy, J/kg, of whole material without stored plastic work at a density (kg/m³) and a temperature (K).
    pub fn of_temperature(&self, density: f64, temperature: f64) -> f64 {
        self.at(density, 1.0) + self.specific_heat * (temperature - self.reference_temperature)
    }

    /// Density of zero pressure at a temperature (K), kg/m³: warmer material is less dense. Where the pressure does not depend on the energy, that
    /// of the reference state. `None` where there is none from half to twice that, as far beyond boiling.
    pub fn density_at_rest(&self, temperature: f64) -> Option<f64> {
        let pressure_at = |density: f64| self.law.pressure(density, self.of_temperature(density, temperature)).pressure;
        let start = (self.rest, pressure_at(self.rest));
        let factor = match start.1 {
            0.0 => return Some(self.rest),
            pressed if pressed > 0.0 => 0.5,
            _ => 2.0,
        };
        // Small steps first: where the law is stretched far its pressure may rise again.
        let near = (1..=FARTHEST_DOUBLINGS).map(|k| 1.0 + (factor - 1.0) / f64::from(1u32 << (FARTHEST_DOUBLINGS - k)));
        let mut inner = start;
        let outer = near.map(|share| (share * self.rest, pressure_at(share * self.rest))).find(|at| {
            let is_beyond = at.1 * start.1 <= 0.0;
            if !is_beyond {
                inner = *at;
            }
            is_beyond
        })?;
        let (mut a, mut b) = (inner, outer);
        let stiffness = self.rest * self.law.reference_sound_speed().powi(2);
        for _ in 0..STEPS_TO_CUT_OFF {
            if a.1 == b.1 || (a.0 - b.0).abs() <= 1e-15 * self.rest {
                break;
            }
            let share = (a.1 / (a.1 - b.1)).clamp(0.0, 1.0);
            let density = a.0 + (b.0 - a.0) * if (0.05..0.95).contains(&share) { share } else { 0.5 };
            let middle = (density, pressure_at(density));
            if middle.1.abs() <= 1e-15 * stiffness {
                return Some(density);
            }
            if middle.1 * a.1 > 0.0 { a = middle } else { b = middle }
        }
        Some(if a.1.abs() < b.1.abs() { a.0 } else { b.0 })
    }
}

impl<T: Elementary> ColdEnergy<T> {
    /// Of a density, kg/m³, and an integrity; J/kg.
    #[inline(always)]
    pub fn at(&self, density: T, integrity: T) -> T {
        let solid = match self.to_cut_off {
            Some(fall) => density.max(self.rest - integrity * fall),
            None => density,
        };
        self.law.cold_energy(solid, self.reference_temperature, self.specific_heat)
    }
}

/// Density, kg/m³, at which a law pulls with a pressure (Pa) on the isotherm of a temperature (K); a small one where it never does.
fn cut_off(law: &EquationOfState<f64>, spall_pressure: f64, reference_temperature: f64, specific_heat: f64) -> f64 {
    let rest = law.reference_density();
    // What the pressure is above the cut-off, Pa.
    let margin_at = |density: f64| {
        let energy = law.cold_energy(density, reference_temperature, specific_heat);
        law.pressure(density, energy).pressure + spall_pressure
    };
    let mut low = (FAR_EXPANDED * rest, margin_at(FAR_EXPANDED * rest));
    let mut high = (rest, spall_pressure);
    if low.1 >= 0.0 {
        return low.0;
    }
    // The secant where it stays well inside, else the middle.
    for _ in 0..STEPS_TO_CUT_OFF {
        let width = high.0 - low.0;
        if width <= 1e-12 * rest {
            break;
        }
        let share = (low.1 / (low.1 - high.1)).clamp(0.0, 1.0);
        let at = low.0 + width * if (0.05..0.95).contains(&share) { share } else { 0.5 };
        let margin = margin_at(at);
        if margin < 0.0 {
            low = (at, margin)
        } else {
            high = (at, margin)
        }
        if margin.abs() <= 1e-12 * spall_pressure {
            return at;
        }
    }
    high.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eos::{EquationConstants, Linear, MieGruneisenHugoniot};

    /// K = 8000 4000^2 = 128 GPa, no heat in the pressure.
    fn steel() -> EquationOfState<f64> {
        EquationOfState::Linear(Linear { density: 8000.0, sound_speed: 4000.0 })
    }

    fn aluminium() -> EquationOfState<f64> {
        EquationOfState::MieGruneisenHugoniot(MieGruneisenHugoniot::new(&[2700.0, 5300.0, 1.5, 1.7]))
    }

    #[test]
    fn energies_below_absolute_zero_count_as_it() {
        // 450 300 = 135 kJ/kg, less than 0.01 c0^2 = 160 kJ/kg.
        assert_eq!(BoundedPressure::<f64>::new(&steel(), 450.0, 300.0).least_energy, -135e3);
        assert_eq!(BoundedPressure::<f64>::new(&steel(), f64::INFINITY, 300.0).least_energy, -160e3);
    }

    #[test]
    fn energy_is_left_down_to_absolute_zero() {
        let law = BoundedPressure::<f64>::new(&steel(), 450.0, 300.0);
        for (energy, left) in [(1e6, 1.0), (0.0, 1.0), (-33.75e3, 0.75), (-135e3, 0.0), (-1e9, 0.0)] {
            assert_eq!(law.energy_left(energy), left, "{energy}");
        }
        // A reference state at absolute zero.
        let cold = BoundedPressure { least_energy: 0.0, ..law };
        assert_eq!((cold.energy_left(0.0), cold.energy_left(-1e-3)), (1.0, 0.0));
    }

    #[test]
    fn what_opens_keeps_the_cold_energy_of_the_tension_it_bears() {
        // Linear: e = c^2 (ln r + 1/r - 1), r = rho/rho_0; 2 GPa is reached at r = 1 - 1/64, 7875 kg/m^3.
        let cold = ColdEnergy::<f64>::new(&steel(), 2e9, 300.0, 450.0);
        let of_law = |r: f64| 16e6 * (r.ln() + 1.0 / r - 1.0);
        for (density, integrity, solid) in [
            (8400.0, 1.0, 8400.0),
            (7900.0, 1.0, 7900.0),
            (7800.0, 1.0, 7875.0),
            (800.0, 1.0, 7875.0),
            (7930.0, 0.4, 7950.0),
            (7960.0, 0.4, 7960.0),
            (800.0, 0.4, 7950.0),
            (800.0, 0.0, 8000.0),
            (8100.0, 0.0, 8100.0),
        ] {
            let (found, expected) = (cold.at(density, integrity), of_law(solid / 8000.0));
            assert!((found - expected).abs() < 1e-6 * expected.max(1.0), "{density} {integrity}: {found} {expected}");
        }
        let never = ColdEnergy::<f64>::new(&steel(), f64::INFINITY, 300.0, 450.0);
        assert!((never.at(6000.0, 1.0) / of_law(0.75) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_isotherm_spalls_where_the_law_says() {
        for spall_pressure in [0.3e9, 1.5e9, 8e9] {
            let cold = ColdEnergy::<f64>::new(&aluminium(), spall_pressure, 300.0, 900.0);
            let density = 2700.0 - cold.to_cut_off.unwrap();
            let pressure = aluminium().pressure(density, cold.at(density, 1.0)).pressure;
            assert!((pressure / spall_pressure + 1.0).abs() < 1e-9, "{pressure:e}");
        }
    }

    #[test]
    fn warm_material_is_at_rest_at_a_lower_density() {
        let law = aluminium();
        for spall_pressure in [1.5e9, f64::INFINITY] {
            let cold = ColdEnergy::<f64>::new(&law, spall_pressure, 300.0, 900.0);
            for (temperature, is_denser) in [(100.0, true), (299.0, true), (310.0, false), (900.0, false)] {
                let density = cold.density_at_rest(temperature).unwrap();
                assert_eq!(density > 2700.0, is_denser, "{temperature} {density}");
                let energy = cold.of_temperature(density, temperature);
                let pressure = law.pressure(density, energy).pressure;
                assert!(pressure.abs() < 1e-12 * 2700.0 * 5300.0 * 5300.0, "{temperature}: {pressure:e}");
                let found = crate::heat::temperature_from_energy(300.0, energy, cold.at(density, 1.0), 0.0, 0.0, 900.0);
                assert!((found - temperature).abs() < 1e-9, "{found}");
            }
            // By hand for little heat: of each kelvin Gamma c_p/(c_0^2 - Gamma^2 c_p T_0) = 1530/(28.09e6 - 0.7803e6) = 5.6024e-5.
            let share = 1.0 - cold.density_at_rest(301.0).unwrap() / 2700.0;
            assert!((share / 5.602_4e-5 - 1.0).abs() < 1e-3, "{share:e}");
            assert_eq!(cold.density_at_rest(300.0), Some(2700.0));
        }
        // What energy does not press stays as it is; there is no metal at a million kelvin.
        assert_eq!(ColdEnergy::<f64>::new(&steel(), 2e9, 300.0, 450.0).density_at_rest(900.0), Some(8000.0));
        assert_eq!(ColdEnergy::<f64>::new(&law, 1.5e9, 300.0, 900.0).density_at_rest(1e6), None);
    }

    #[test]
    fn what_expands_without_heat_cools_and_stays_above_absolute_zero() {
        // Aluminium: T_0 (rho/rho_0)^Gamma.
        let (t_0, cp) = (300.0, 900.0);
        let law = BoundedPressure::new(&aluminium(), cp, t_0);
        let cold = ColdEnergy::<f64>::new(&aluminium(), 1.5e9, t_0, cp);
        let (mut rho, mut energy) = (2700.0, 0.0);
        while law.at(rho, energy).pressure > -1.5e9 {
            let (step, half) = (-0.01, -0.005);
            let slope = |rho: f64, e: f64| law.at(rho, e).pressure / (rho * rho);
            energy += step * slope(rho + half, energy + half * slope(rho, energy));
            rho += step;
        }
        let temperature = t_0 + (energy - cold.at(rho, 1.0)) / cp;
        assert!((temperature - t_0 * (rho / 2700.0).powf(1.7)).abs() < 1e-3, "{rho}: {temperature}");
        assert!(rho < 2660.0 && temperature < 295.0, "{rho} {temperature}");
    }
}
