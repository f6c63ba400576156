//! Bounds of a pressure law: the tension a material bears before it spalls, and the energy of absolute zero.

use super::{EquationOfState, PressureState};
use crate::{Elementary, Real};

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

impl BoundedPressure<f64> {
    /// Specific energy, J/kg, on the isotherm of a reference temperature (K): that of the law
    /// ([`EquationOfState::cold_energy`]) down to the density `rho_s` where it pulls with the spall pressure `p_s`, from there on
    /// `e(rho_s) + p_s (1/rho - 1/rho_s)`, since the pressure no longer depends on anything.
    pub fn cold_energy(&self, density: f64, reference_temperature: f64, specific_heat: f64) -> f64 {
        let rest = self.law.reference_density();
        let (energy, margin) = self.cold(density, reference_temperature, specific_heat);
        if density >= rest || margin >= 0.0 {
            return energy;
        }
        let cut_off = self.cut_off((density, margin), reference_temperature, specific_heat);
        let (energy, _) = self.cold(cut_off, reference_temperature, specific_heat);
        expanded((cut_off, energy), self.least_pressure, density)
    }

    /// Energy of the isotherm of the law, J/kg, and what its pressure is above the cut-off, Pa.
    fn cold(&self, density: f64, reference_temperature: f64, specific_heat: f64) -> (f64, f64) {
        let energy = self.law.cold_energy(density, reference_temperature, specific_heat);
        (energy, self.law.pressure(density, energy).pressure - self.least_pressure)
    }

    /// Density of the cut-off on the isotherm, above one with what the pressure is above the cut-off there, which is negative.
    fn cut_off(&self, mut low: (f64, f64), reference_temperature: f64, specific_heat: f64) -> f64 {
        let rest = self.law.reference_density();
        let mut high = (rest, -self.least_pressure);
        // The secant where it stays well inside, else the middle.
        for _ in 0..STEPS_TO_CUT_OFF {
            let width = high.0 - low.0;
            if width <= 1e-12 * rest {
                break;
            }
            let share = (low.1 / (low.1 - high.1)).clamp(0.0, 1.0);
            let at = low.0 + width * if (0.05..0.95).contains(&share) { share } else { 0.5 };
            let (_, margin) = self.cold(at, reference_temperature, specific_heat);
            if margin < 0.0 {
                low = (at, margin)
            } else {
                high = (at, margin)
            }
            if margin.abs() <= -1e-12 * self.least_pressure {
                (low, high) = ((at, margin), (at, margin));
            }
        }
        high.0
    }
}

/// Energy, J/kg, of what has expanded from the cut-off, whose density and energy are given, at the least pressure.
#[inline(always)]
fn expanded<T: Real>((cut_off, energy): (T, T), least_pressure: T, density: T) -> T {
    energy - least_pressure * (T::one() / density - T::one() / cut_off)
}

/// The cold energy of a material ([`BoundedPressure::cold_energy`]), its cut-off found once: what is the same for all of its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColdEnergy<T> {
    law: EquationOfState<T>,
    /// K.
    reference_temperature: T,
    /// J/(kg K).
    specific_heat: T,
    /// Pa.
    least_pressure: T,
    /// Density, kg/m³, and energy, J/kg, of the cut-off, where there is one.
    cut_off: Option<(T, T)>,
}

/// Share of the density at rest where every metal is beyond its cut-off.
const FAR_EXPANDED: f64 = 1e-3;

impl<T: Real> ColdEnergy<T> {
    /// Of a pressure law with its cut-off, on the isotherm of a reference temperature (K), with a specific heat (J/(kg K)).
    pub fn new(law: &BoundedPressure<f64>, reference_temperature: f64, specific_heat: f64) -> Self {
        let far = FAR_EXPANDED * law.law.reference_density();
        let (_, margin) = law.cold(far, reference_temperature, specific_heat);
        let cut_off = (margin < 0.0).then(|| {
            let density = law.cut_off((far, margin), reference_temperature, specific_heat);
            (T::of(density), T::of(law.cold(density, reference_temperature, specific_heat).0))
        });
        Self {
            law: law.law.cast(),
            reference_temperature: T::of(reference_temperature),
            specific_heat: T::of(specific_heat),
            least_pressure: T::of(law.least_pressure),
            cut_off,
        }
    }
}

impl<T: Elementary> ColdEnergy<T> {
    /// Of a density, kg/m³; J/kg.
    #[inline]
    pub fn at(&self, density: T) -> T {
        let of_law = || self.law.cold_energy(density, self.reference_temperature, self.specific_heat);
        match self.cut_off {
            None => of_law(),
            Some(cut_off) => T::if_lt(density, cut_off.0, || expanded(cut_off, self.least_pressure, density), of_law),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eos::{EquationConstants, Linear, MieGruneisenHugoniot};

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

    #[test]
    fn energy_is_left_down_to_absolute_zero() {
        let law = steel(1e9, 450.0);
        for (energy, left) in [(1e6, 1.0), (0.0, 1.0), (-33.75e3, 0.75), (-135e3, 0.0), (-1e9, 0.0)] {
            assert_eq!(law.energy_left(energy), left, "{energy}");
        }
        // A reference state at absolute zero.
        let cold = BoundedPressure { least_energy: 0.0, ..law };
        assert_eq!((cold.energy_left(0.0), cold.energy_left(-1e-3)), (1.0, 0.0));
    }

    #[test]
    fn beyond_the_cut_off_the_cold_energy_is_the_work_of_the_spall_pressure() {
        // Linear: e = c^2 (ln r + 1/r - 1), r = rho/rho_0; 2 GPa is reached at r = 1 - 1/64, 7875 kg/m^3.
        let law = steel(2e9, 450.0);
        let of_law = |r: f64| 16e6 * (r.ln() + 1.0 / r - 1.0);
        for density in [8400.0, 8000.0, 7900.0] {
            let (found, expected) = (law.cold_energy(density, 300.0, 450.0), of_law(density / 8000.0));
            assert!((found - expected).abs() < 1e-6 * expected.max(1.0), "{density}: {found} {expected}");
        }
        for density in [7800.0, 6000.0, 800.0] {
            let expected = of_law(63.0 / 64.0) + 2e9 * (1.0 / density - 1.0 / 7875.0);
            let found = law.cold_energy(density, 300.0, 450.0);
            assert!((found / expected - 1.0).abs() < 1e-7, "{density}: {found} {expected}");
        }
    }

    #[test]
    fn a_cut_off_found_once_is_that_found_for_every_density() {
        let aluminium = EquationOfState::MieGruneisenHugoniot(MieGruneisenHugoniot::new(&[2700.0, 5300.0, 1.5, 1.7]));
        for spall_pressure in [1.5e9, 8e9, f64::INFINITY] {
            let law = BoundedPressure::<f64>::new(&aluminium, spall_pressure, 900.0, 300.0);
            let cold = ColdEnergy::<f64>::new(&law, 300.0, 900.0);
            for density in [3500.0, 2701.0, 2699.0, 2680.0, 2660.0, 2400.0, 1500.0, 300.0] {
                let (found, expected) = (cold.at(density), law.cold_energy(density, 300.0, 900.0));
                assert!((found - expected).abs() <= 1e-9 * expected.abs(), "{density}: {found} {expected}");
            }
        }
    }

    #[test]
    fn what_expands_without_heat_cools_and_stays_above_absolute_zero() {
        // Aluminium: T_0 (rho/rho_0)^Gamma until it spalls, then as it is.
        let (t_0, cp) = (300.0, 900.0);
        let law = EquationOfState::MieGruneisenHugoniot(MieGruneisenHugoniot::new(&[2700.0, 5300.0, 1.5, 1.7]));
        let law = BoundedPressure::new(&law, 1.5e9, cp, t_0);
        let (mut rho, mut energy, mut spalled) = (2700.0, 0.0, 0.0);
        for count in 0..200_000 {
            let (step, half) = (-0.01, -0.005);
            let slope = |rho: f64, e: f64| law.at(rho, e).pressure / (rho * rho);
            energy += step * slope(rho + half, energy + half * slope(rho, energy));
            rho += step;
            let intact = law.at(rho, energy).pressure > -1.5e9;
            if intact {
                spalled = t_0 * (rho / 2700.0).powf(1.7);
            }
            // The cold energy costs more than a hundred steps.
            if count % 97 == 0 {
                let temperature = t_0 + (energy - law.cold_energy(rho, t_0, cp)) / cp;
                let tolerance = if intact { 1e-3 } else { 0.5 };
                assert!((temperature - spalled).abs() < tolerance, "{rho}: {temperature} {spalled}");
            }
        }
        assert!(rho < 701.0 && spalled < 295.0, "{rho} {spalled}");
    }
}
