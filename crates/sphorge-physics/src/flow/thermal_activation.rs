//! How heat helps dislocations past obstacles: the factor of Zerilli & Armstrong's laws.

use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `exp(-C_3 T + C_4 T ln rate)` with the plastic strain rate in 1/s (Zerilli & Armstrong 1987): one at 0 K.
///
/// The exponent is that of obstacles that are passed more easily the hotter it is and the longer the time, `-T (C_3 - C_4 ln rate)`.
/// From the rate on at which the bracket is zero, `exp(C_3/C_4)` (iron 2e7 1/s, copper 4e10 1/s), it is held at zero: the formula
/// would harden with heat and run over. Below the lowest rate the factor is that of the lowest rate, since the logarithm has no end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalActivation<T> {
    /// `C_3`, 1/K.
    pub softening: T,
    /// `C_4`, 1/K.
    pub rate_sensitivity: T,
    /// `rate_min`, 1/s.
    pub lowest_rate: T,
}

/// The constant `C_3`.
pub(super) const SOFTENING: Parameter = Parameter::required(
    "C3",
    "C_3",
    PhysicalQuantity::Unit("1/K"),
    Bound::NonNegative,
    "softening with temperature at a plastic strain rate of 1/s",
);
/// The constant `C_4`.
pub(super) const RATE_SENSITIVITY: Parameter = Parameter::required(
    "C4",
    "C_4",
    PhysicalQuantity::Unit("1/K"),
    Bound::NonNegative,
    "decrease of this softening per logarithm of the plastic strain rate",
);
/// The constant `rate_min`.
pub(super) const LOWEST_RATE: Parameter = Parameter {
    key: "lowest-strain-rate",
    symbol: "rate_min",
    quantity: PhysicalQuantity::StrainRate,
    bound: Bound::Positive,
    default: Some(1e-3),
    meaning: "plastic strain rate up to which the rate has no effect",
};

impl<T: Elementary> ThermalActivation<T> {
    /// From `C_3`, `C_4` and the lowest rate.
    pub(super) fn new(values: [f64; 3]) -> Self {
        let [softening, rate_sensitivity, lowest_rate] = values.map(T::of);
        Self { softening, rate_sensitivity, lowest_rate }
    }

    /// The same in another precision.
    pub(super) fn cast<U: Elementary>(&self) -> ThermalActivation<U>
    where
        T: Scalar,
    {
        ThermalActivation {
            softening: U::of(self.softening.to_f64()),
            rate_sensitivity: U::of(self.rate_sensitivity.to_f64()),
            lowest_rate: U::of(self.lowest_rate.to_f64()),
        }
    }

    /// The factor at a temperature (K) and a plastic strain rate (1/s), and its slope against the rate, s.
    #[inline(always)]
    pub(super) fn factor(&self, temperature: T, rate: T) -> (T, T) {
        let temperature = temperature.max(T::zero());
        let exponent = temperature * (self.rate_sensitivity * rate.max(self.lowest_rate).ln() - self.softening);
        let factor = exponent.min(T::zero()).exp();
        let slope = factor * self.rate_sensitivity * temperature / rate;
        let slope = T::select_lt(exponent, T::zero(), slope, T::zero());
        (factor, T::select_lt(self.lowest_rate, rate, slope, T::zero()))
    }
}
