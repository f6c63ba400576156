//! Mie–Grüneisen with the exact Hugoniot of a linear shock velocity.

use super::{EquationConstants, GRUNEISEN, GruneisenForm, REFERENCE_DENSITY, ReferenceCurve, SHOCK_SLOPE, SOUND_SPEED};
use crate::parameter::Parameter;
use crate::{Real, Scalar};

/// `p = (1 - Gamma eta/2) P_H + Gamma rho e`, `eta = rho/rho_0 - 1` (Patiño et al. Eq 15), in compression, with the Hugoniot of
/// `Us = c_0 + S Up` not expanded: `P_H = rho_0 c_0^2 chi / (1 - S chi)^2`, `chi = 1 - rho_0/rho`. On the Hugoniot,
/// `e = P_H chi / (2 rho_0)`, it gives back `P_H`.
///
/// In expansion `p = rho_0 c_0^2 eta + Gamma rho e`. The factor `1 - Gamma eta/2` takes away the energy of the shock, and no shock
/// expands: the line is the pressure at zero energy itself (Steinberg, UCRL-MA-106439, 1996), and no stress of tension is raised by it.
///
/// `P_H` is singular at `chi = 1/S`, a compression no shock reaches; from `S chi = 0.9` on it goes along its tangent, so
/// that it stays finite and rising. Rice, McQueen & Walsh 1958; Meyers, *Dynamic Behavior of Materials* (1994), chapter 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MieGruneisenHugoniot<T> {
    /// `rho_0`, kg/m^3.
    pub density: T,
    /// Bulk sound speed `c_0`, m/s.
    pub sound_speed: T,
    /// Slope `S` of `Us = c_0 + S Up`.
    pub shock_slope: T,
    /// `Gamma`.
    pub gruneisen: T,
}

/// `S chi` from which the Hugoniot is continued by its tangent.
const TANGENT_FROM: f64 = 0.9;

impl<T: Scalar> MieGruneisenHugoniot<T> {
    /// The same law in another precision, or in lanes.
    #[inline(always)]
    pub fn cast<U: Real>(&self) -> MieGruneisenHugoniot<U> {
        MieGruneisenHugoniot {
            density: U::of(self.density.to_f64()),
            sound_speed: U::of(self.sound_speed.to_f64()),
            shock_slope: U::of(self.shock_slope.to_f64()),
            gruneisen: U::of(self.gruneisen.to_f64()),
        }
    }
}

impl<T: Real> EquationConstants for MieGruneisenHugoniot<T> {
    type Number = T;

    const KEY: &'static str = "mie-gruneisen";
    const NAME: &'static str = "Mie–Grüneisen, exact linear Us-Up Hugoniot";
    const REFERENCE: &'static str =
        "Rice, McQueen & Walsh, Solid State Physics 6 (1958) 1; Meyers, Dynamic Behavior of Materials (1994) ch. 4";
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

impl<T: Real> GruneisenForm for MieGruneisenHugoniot<T> {
    #[inline(always)]
    fn reference_curve(&self, density: T) -> ReferenceCurve<T> {
        let c_2 = self.sound_speed * self.sound_speed;
        let eta = (density - self.density) / self.density;
        let volume_ratio = self.density / density;
        let chi = eta * volume_ratio;
        let s_chi = (self.shock_slope * chi).min(T::of(TANGENT_FROM));
        // Distance along the tangent: zero before it starts, and where `S = 0` it never does.
        let beyond = (self.shock_slope * chi - s_chi) / self.shock_slope.max(T::of(1e-30));
        let q = T::one() / (T::one() - s_chi);
        let tangent = c_2 * (T::one() + s_chi) * q * q * q;
        let compressed = c_2 * (chi - beyond) * q * q + tangent * beyond;
        // `P_H / rho_0` and its slope against `rho`; in expansion linear in `eta`.
        let hugoniot = T::select_lt(T::zero(), eta, compressed, c_2 * eta);
        let hugoniot_slope = T::select_lt(T::zero(), eta, tangent * volume_ratio * volume_ratio, c_2);
        let half_gamma = T::of(0.5) * self.gruneisen;
        let factor = T::one() - half_gamma * eta.max(T::zero());
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
