//! The isotherm of any equation of state, by integration.

use super::PressureLaw;
use crate::Elementary;

/// Steps from the reference density: to a compression of 1.5 the energy is off by less than 1e-6 of itself.
const STEPS: u32 = 16;

/// Specific energy, J/kg, on the isotherm through the reference state where `heat` is `T_0 c_p` (J/kg), on the isentrope through it
/// where that is zero.
///
/// `de = T ds - p d(1/rho)` with `(ds/drho)_T = -Gamma c_p/rho` gives `de/du = p(rho, e)/rho - heat Gamma` with `u = ln(rho/rho_0)`,
/// taken by classical Runge–Kutta steps.
#[inline]
pub(super) fn energy<T: Elementary, L: PressureLaw<Number = T>>(law: &L, density: T, heat: T) -> T {
    let rho_0 = law.reference_density();
    let step = (density / rho_0).ln() * T::of(1.0 / f64::from(STEPS));
    let half = T::of(0.5) * step;
    let slope = |u: T, e: T| {
        let rho = rho_0 * u.exp();
        law.pressure(rho, e).pressure / rho - heat * law.gruneisen(rho, e)
    };
    let mut energy = T::zero();
    for k in 0..STEPS {
        let start = T::of(f64::from(k)) * step;
        let k1 = slope(start, energy);
        let k2 = slope(start + half, energy + half * k1);
        let k3 = slope(start + half, energy + half * k2);
        let k4 = slope(start + step, energy + step * k3);
        energy += step * T::of(1.0 / 6.0) * (k1 + T::of(2.0) * (k2 + k3) + k4);
    }
    energy
}
