//! Mie–Grüneisen with the Hugoniot expanded in the compression.

use super::{EquationConstants, GRUNEISEN, GruneisenForm, REFERENCE_DENSITY, ReferenceCurve, SHOCK_SLOPE, SOUND_SPEED};
use crate::parameter::Parameter;
use crate::{Real, Scalar};

/// `p = (1 - Gamma eta/2) P_H + Gamma rho e`, `eta = rho/rho_0 - 1` (Patiño et al. Eq 15), in compression, with
/// `P_H = a_0 eta + b_0 eta^2 + c_0 eta^3` (Eq 16, from `Us = c_s + S Up`): `a_0 = rho_0 c_s^2`, `b_0 = a_0 [1 + 2 (S - 1)]`,
/// `c_0 = a_0 [2 (S - 1) + 3 (S - 1)^2]`. Libersky & Petschek 1991. The paper leaves `eta = 0` open: both pieces give zero there.
///
/// In expansion `p = a_0 eta + Gamma rho e`. Patiño et al. print the factor `1 - Gamma eta/2` there, too, which raises the
/// tension by `Gamma |eta|/2`; but it takes away the energy of a shock, and no shock expands. The line is the pressure at zero
/// energy itself (Steinberg, UCRL-MA-106439, 1996).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MieGruneisenPolynomial<T> {
    /// `rho_0`, kg/m^3.
    pub density: T,
    /// Bulk sound speed `c_s`, m/s.
    pub sound_speed: T,
    /// Slope `S` of `Us = c_s + S Up`.
    pub shock_slope: T,
    /// `Gamma`.
    pub gruneisen: T,
}

impl<T: Scalar> MieGruneisenPolynomial<T> {
    /// The same law in another precision, or in lanes.
    #[inline(always)]
    pub fn cast<U: Real>(&self) -> MieGruneisenPolynomial<U> {
        MieGruneisenPolynomial {
            density: U::of(self.density.to_f64()),
            sound_speed: U::of(self.sound_speed.to_f64()),
            shock_slope: U::of(self.shock_slope.to_f64()),
            gruneisen: U::of(self.gruneisen.to_f64()),
        }
    }
}

impl<T: Real> EquationConstants for MieGruneisenPolynomial<T> {
    type Number = T;

    const KEY: &'static str = "mie-gruneisen-polynomial";
    const NAME: &'static str = "Mie–Grüneisen, Hugoniot as a polynomial";
    const REFERENCE: &'static str =
        "Patiño et al. Eq 15, 16; Libersky & Petschek, Lecture Notes in Physics 395 (1991) 248";
    const PARAMETERS: &'static [Parameter] = &[REFERENCE_DENSITY, SOUND_SPEED, SHOCK_SLOPE, GRUNEISEN];

    fn new(values: &[f64]) -> Self {
        Self {
            density: T::of(values[0]),
            sound_speed: T::of(values[1]),
            shock_slope: T::of(values[2]),
            gruneisen: T::of(values[3]),
        }
    }

    #[inline(always)]
    fn reference_density(&self) -> T {
        self.density
    }

    #[inline(always)]
    fn reference_sound_speed(&self) -> T {
        self.sound_speed
    }

    fn shock_slope(&self) -> Option<T> {
        Some(self.shock_slope)
    }
}

impl<T: Real> GruneisenForm for MieGruneisenPolynomial<T> {
    #[inline(always)]
    fn reference_curve(&self, density: T) -> ReferenceCurve<T> {
        // `a_0`, `b_0`, `c_0` divided by `rho_0`.
        let a_0 = self.sound_speed * self.sound_speed;
        let s_1 = self.shock_slope - T::one();
        let two_s_1 = s_1 + s_1;
        let b_0 = a_0 * (T::one() + two_s_1);
        let c_0 = a_0 * (two_s_1 + T::of(3.0) * s_1 * s_1);
        let eta = (density - self.density) / self.density;
        let compression = eta.max(T::zero());
        let hugoniot = a_0 * eta + (c_0 * compression + b_0) * compression * compression;
        let hugoniot_slope = a_0 + (T::of(3.0) * c_0 * compression + b_0 + b_0) * compression;
        let half_gamma = T::of(0.5) * self.gruneisen;
        let factor = T::one() - half_gamma * compression;
        ReferenceCurve {
            pressure: self.density * factor * hugoniot,
            slope: factor * hugoniot_slope - half_gamma * hugoniot.max(T::zero()),
        }
    }

    #[inline(always)]
    fn gamma(&self) -> T {
        self.gruneisen
    }
}
