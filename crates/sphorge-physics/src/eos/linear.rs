//! Linear pressure.

use super::{EquationConstants, GruneisenForm, REFERENCE_DENSITY, ReferenceCurve, SOUND_SPEED};
use crate::parameter::Parameter;
use crate::{Real, Scalar};

/// `p = K (rho/rho_0 - 1)`, `K = rho_0 c_0^2`; energy has no effect. For small volume change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<T> {
    /// `rho_0`, kg/m^3.
    pub density: T,
    /// `c_0`, m/s.
    pub sound_speed: T,
}

impl<T: Scalar> Linear<T> {
    /// The same law in another precision, or in lanes.
    #[inline(always)]
    pub fn cast<U: Real>(&self) -> Linear<U> {
        Linear { density: U::of(self.density.to_f64()), sound_speed: U::of(self.sound_speed.to_f64()) }
    }
}

impl<T: Real> EquationConstants for Linear<T> {
    type Number = T;

    const KEY: &'static str = "linear";
    const NAME: &'static str = "linear";
    const REFERENCE: &'static str = "Hooke's law for volume change, K = rho_0 c_0^2";
    const PARAMETERS: &'static [Parameter] = &[REFERENCE_DENSITY, SOUND_SPEED];

    fn new(values: &[f64]) -> Self {
        Self { density: T::of(values[0]), sound_speed: T::of(values[1]) }
    }

    #[inline(always)]
    fn reference_density(&self) -> T {
        self.density
    }

    #[inline(always)]
    fn reference_sound_speed(&self) -> T {
        self.sound_speed
    }
}

impl<T: Real> GruneisenForm for Linear<T> {
    #[inline(always)]
    fn reference_curve(&self, density: T) -> ReferenceCurve<T> {
        let slope = self.sound_speed * self.sound_speed;
        ReferenceCurve { pressure: slope * (density - self.density), slope }
    }

    #[inline(always)]
    fn gamma(&self) -> T {
        T::zero()
    }
}
