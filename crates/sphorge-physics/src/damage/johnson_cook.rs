//! Johnson–Cook.

use super::{DamageGrowth, DamageState, over_failure_strain};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::real::branch;
use crate::{Elementary, Scalar};

/// `dD = deps_p/eps_f`, `eps_f = (D1 + D2 exp(D3 eta)) (1 + D4 ln(rate/rate_0)) (1 + D5 T*)`, `T* = (T - T_0)/(T_m - T_0)` between 0 and 1
/// (Johnson & Cook 1985).
///
/// The triaxiality `eta` is positive in tension, so `D3` is not positive: other programs and some tables have the opposite sign of both.
/// Below `rate_0` the factor of the rate is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JohnsonCookDamage<T> {
    /// `D1` to `D5`.
    pub d: [T; 5],
    /// `rate_0`, 1/s.
    pub reference_rate: T,
    /// `T_0`, K.
    pub reference_temperature: T,
    /// `T_m`, K.
    pub melting_temperature: T,
}

impl<T: Elementary> JohnsonCookDamage<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> JohnsonCookDamage<U>
    where
        T: Scalar,
    {
        JohnsonCookDamage {
            d: self.d.map(|d| U::of(d.to_f64())),
            reference_rate: U::of(self.reference_rate.to_f64()),
            reference_temperature: U::of(self.reference_temperature.to_f64()),
            melting_temperature: U::of(self.melting_temperature.to_f64()),
        }
    }

    /// `eps_f` in a state; it may be negative.
    #[inline(always)]
    pub fn failure_strain(&self, state: &DamageState<T>) -> T {
        let [d1, d2, d3, d4, d5] = self.d;
        let one = T::one();
        let of_stress = d1 + d2 * (d3 * state.triaxiality).exp();
        let of_rate =
            branch!(T, self.reference_rate, state.rate, one + d4 * (state.rate / self.reference_rate).ln(), one);
        let range = self.melting_temperature - self.reference_temperature;
        let warmth = ((state.temperature - self.reference_temperature) / range).max(T::zero()).min(one);
        of_stress * of_rate * (one + d5 * warmth)
    }
}

/// A pure number that may be left out, where `default` says so.
const fn number(key: &'static str, bound: Bound, default: Option<f64>, meaning: &'static str) -> Parameter {
    Parameter { key, symbol: key, quantity: PhysicalQuantity::Dimensionless, bound, default, meaning }
}

impl<T: Elementary> DamageGrowth<T> for JohnsonCookDamage<T> {
    const KEY: &'static str = "johnson-cook";
    const NAME: &'static str = "Johnson–Cook";
    const REFERENCE: &'static str = "Johnson & Cook, Eng. Fract. Mech. 21 (1985) 31";
    const PARAMETERS: &'static [Parameter] = &[
        number("D1", Bound::Any, None, "failure strain where the triaxiality is large"),
        number("D2", Bound::NonNegative, None, "what is added to it without mean stress"),
        number("D3", Bound::Any, None, "exponent of the triaxiality, which is positive in tension: not above zero"),
        number("D4", Bound::Any, Some(0.0), "growth of the failure strain with the logarithm of the rate"),
        number("D5", Bound::Any, Some(0.0), "growth of the failure strain with the temperature"),
        Parameter {
            key: "reference-strain-rate",
            symbol: "rate_0",
            quantity: PhysicalQuantity::StrainRate,
            bound: Bound::Positive,
            default: Some(1.0),
            meaning: "plastic strain rate up to which the rate has no effect",
        },
        Parameter::required(
            "reference-temperature",
            "T_0",
            PhysicalQuantity::Temperature,
            Bound::NonNegative,
            "temperature below which the temperature has no effect",
        ),
        Parameter::required(
            "melting-temperature",
            "T_m",
            PhysicalQuantity::Temperature,
            Bound::Positive,
            "temperature from which on it has no further effect",
        ),
    ];
    const DEPENDS_ON_TEMPERATURE: bool = true;

    fn check(values: &[f64]) -> Option<&'static str> {
        if values[2] > 0.0 {
            return Some(
                "D3 is above zero, which would make the metal tougher in tension: triaxiality counts positive in tension here; give D3 \
                 the opposite sign",
            );
        }
        if values[0] <= 0.0 && values[1] == 0.0 {
            return Some("D1 + D2 exp(D3 eta) is not above zero for any triaxiality");
        }
        (values[7] <= values[6]).then_some("melting-temperature must be above reference-temperature")
    }

    fn new(values: &[f64]) -> Self {
        Self {
            d: [0, 1, 2, 3, 4].map(|k| T::of(values[k])),
            reference_rate: T::of(values[5]),
            reference_temperature: T::of(values[6]),
            melting_temperature: T::of(values[7]),
        }
    }

    #[inline(always)]
    fn growth(&self, state: &DamageState<T>) -> T {
        over_failure_strain(self.failure_strain(state))
    }
}
