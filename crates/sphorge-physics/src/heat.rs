//! Temperature from plastic work or from energy.
//!
//! Units: temperature K, specific energy J/kg, specific heat J/(kg K), work J/m^3, density kg/m^3.

use crate::{Real, SymmetricTensor};

/// Temperature rise where the share `beta` (Taylor & Quinney 1934) of plastic work turns to heat and none flows away:
/// `dT = beta w_p / (rho c_p)`, with the plastic work per volume `w_p` of the step.
#[inline(always)]
pub fn temperature_rise_from_plastic_work<T: Real>(
    beta: T,
    plastic_work_per_volume: T,
    density: T,
    specific_heat: T,
) -> T {
    beta * plastic_work_per_volume / (density * specific_heat)
}

/// Temperature of a specific internal energy `e`: `T = T_0 + (e - e_cold - e_elastic - e_stored) / c_p`.
///
/// `e` has no part of forces that keep particles apart and are no stress of the material, such as the artificial stress.
/// `cold_energy` is the energy of the density on the isotherm `T_0`
/// ([`ColdEnergy`](crate::eos::ColdEnergy)), `elastic_energy` that of the deviatoric
/// stress ([`elastic_energy`]), `stored_plastic` the share `(1 - beta)` of plastic work kept in the lattice. All J/kg.
#[inline(always)]
pub fn temperature_from_energy<T: Real>(
    reference_temperature: T,
    energy: T,
    cold_energy: T,
    elastic_energy: T,
    stored_plastic: T,
    specific_heat: T,
) -> T {
    reference_temperature + (energy - cold_energy - elastic_energy - stored_plastic) / specific_heat
}

/// One where a metal is liquid, else zero: at the temperature of melting by its temperature or by that of its energy
/// ([`temperature_from_energy`]). A temperature from plastic work does not know what a shock heats, the energy does.
#[inline(always)]
pub fn melted<T: Real>(temperature: T, temperature_of_energy: T, melting_temperature: T) -> T {
    T::select_lt(temperature.max(temperature_of_energy), melting_temperature, T::zero(), T::one())
}

/// Specific elastic energy of shape change, `S:S / (4 G rho)`; zero without shear modulus.
#[inline(always)]
pub fn elastic_energy<T: Real>(deviator: SymmetricTensor<T>, shear_modulus: T, density: T) -> T {
    let energy = deviator.double_dot(deviator) / (T::of(4.0) * shear_modulus * density);
    T::select_lt(T::zero(), shear_modulus, energy, T::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plastic_work_heats_by_hand() {
        // 0.9 500 MPa 0.2/(7890 452) = 25.23638 K; 0.5 300 MPa/(2710 875).
        let rise = temperature_rise_from_plastic_work(0.9, 500.0e6 * 0.2, 7890.0, 452.0f64);
        assert!((rise - 25.236_380_8).abs() < 1e-6, "{rise}");
        let rise = temperature_rise_from_plastic_work(0.5, 300.0e6, 2710.0, 875.0f64);
        assert!((rise - 63.257_775_4).abs() < 1e-6, "{rise}");
    }

    #[test]
    fn energy_gives_temperature_by_hand() {
        assert_eq!(temperature_from_energy(300.0f64, 90.0e3, 30.0e3, 5.0e3, 10.0e3, 450.0), 400.0);
        assert_eq!(temperature_from_energy(280.0f64, -1.0e3, 3.0e3, 0.5e3, 0.5e3, 500.0), 270.0);
    }

    #[test]
    fn either_temperature_melts() {
        let cases = [(999.9, 300.0, 0.0), (1000.0, 300.0, 1.0), (300.0, 999.9, 0.0), (300.0, 1000.0, 1.0)];
        for (temperature, of_energy, is_liquid) in cases {
            assert_eq!(melted(temperature, of_energy, 1000.0f64), is_liquid);
        }
    }

    #[test]
    fn elastic_energy_by_hand() {
        // Simple shear tau: 2 tau^2/(4 G rho) = tau^2/(2 G)/rho.
        let shear = SymmetricTensor { xy: 100.0e6, ..SymmetricTensor::zero() };
        assert!((elastic_energy(shear, 80.0e9, 8000.0) - 7.8125f64).abs() < 1e-12);
        // Uniaxial deviator (200, -100, -100) MPa: 6e16/(4 45e9 8930).
        let uniaxial = SymmetricTensor::diagonal(200.0e6, -100.0e6, -100.0e6);
        assert!((elastic_energy(uniaxial, 45.0e9, 8930.0) - 37.327_360_955_580_4f64).abs() < 1e-9);
        assert_eq!(elastic_energy(shear, 0.0f64, 1000.0), 0.0);
    }
}
