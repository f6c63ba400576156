//! Johnson–Cook.

use super::strain_power::strain_power;
use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::real::branch;
use crate::{Elementary, Scalar};

/// `Y = (A + B eps_p^n) (1 + C ln(rate/rate_0)) (1 - T*^m)`, `T* = (T - T_0)/(T_m - T_0)` clamped to [0, 1]
/// (Johnson & Cook 1983; Patiño et al. Eq 25).
///
/// The equation takes the accumulated plastic strain; Patiño et al. Eq 26 puts the total strain in its place, which is
/// the same only once elastic strain is negligible. Below `rate_0` the rate factor is one: its logarithm would soften
/// and at last turn negative. At and above `T_m` the yield stress is zero.
///
/// The slope of `eps_p^n` is infinite at zero for `n < 1`. Below a plastic strain of 1e-12 the power is replaced by the
/// chord from the origin, which keeps `Y(0) = A` and a finite slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JohnsonCook<T> {
    /// `A`, Pa.
    pub yield_stress: T,
    /// `B`, Pa.
    pub hardening: T,
    /// `n`.
    pub exponent: T,
    /// `C`.
    pub rate_sensitivity: T,
    /// `m`.
    pub softening_exponent: T,
    /// `rate_0`, 1/s.
    pub reference_rate: T,
    /// `T_0`, K.
    pub reference_temperature: T,
    /// `T_m`, K.
    pub melting_temperature: T,
}

impl<T: Elementary> JohnsonCook<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> JohnsonCook<U>
    where
        T: Scalar,
    {
        JohnsonCook {
            yield_stress: U::of(self.yield_stress.to_f64()),
            hardening: U::of(self.hardening.to_f64()),
            exponent: U::of(self.exponent.to_f64()),
            rate_sensitivity: U::of(self.rate_sensitivity.to_f64()),
            softening_exponent: U::of(self.softening_exponent.to_f64()),
            reference_rate: U::of(self.reference_rate.to_f64()),
            reference_temperature: U::of(self.reference_temperature.to_f64()),
            melting_temperature: U::of(self.melting_temperature.to_f64()),
        }
    }
}

impl<T: Elementary> JohnsonCook<T> {
    /// `1 - T*^m`.
    #[inline(always)]
    fn thermal_factor(&self, temperature: T) -> T {
        branch!(
            T,
            self.reference_temperature,
            temperature,
            {
                let range = self.melting_temperature - self.reference_temperature;
                let t = ((temperature - self.reference_temperature) / range).min(T::one());
                T::one() - t.powf(self.softening_exponent)
            },
            T::one()
        )
    }

    /// Yield stress in a state where the rate raises it by `rate_factor`, which has the slope `rate_slope` (s).
    #[inline(always)]
    pub(super) fn at_rate_factor(&self, state: FlowState<T>, [rate_factor, rate_slope]: [T; 2]) -> YieldStress<T> {
        // Powers and the logarithm are skipped where they are known: most particles are cold, slow or unstrained.
        let [power, power_slope] = branch!(
            T,
            T::zero(),
            self.hardening,
            <[T; 2]>::from(strain_power(state.plastic_strain, self.exponent)),
            [T::zero(); 2]
        );
        let hardened = self.yield_stress + self.hardening * power;
        let hardening_slope = self.hardening * power_slope;

        let thermal_factor = self.thermal_factor(state.temperature);
        YieldStress {
            value: hardened * rate_factor * thermal_factor,
            by_strain: hardening_slope * rate_factor * thermal_factor,
            by_rate: hardened * rate_slope * thermal_factor,
        }
    }
}

impl<T: Elementary> YieldLaw<T> for JohnsonCook<T> {
    const KEY: &'static str = "johnson-cook";
    const NAME: &'static str = "Johnson–Cook";
    const REFERENCE: &'static str = "Johnson & Cook, 7th International Symposium on Ballistics (1983) 541";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "A",
            "A",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "yield stress at zero plastic strain, reference rate and temperature",
        ),
        Parameter::required("B", "B", PhysicalQuantity::Pressure, Bound::NonNegative, "strength of hardening"),
        Parameter::required("n", "n", PhysicalQuantity::Dimensionless, Bound::Positive, "exponent of hardening"),
        Parameter::required("C", "C", PhysicalQuantity::Dimensionless, Bound::NonNegative, "strain-rate sensitivity"),
        Parameter::required(
            "m",
            "m",
            PhysicalQuantity::Dimensionless,
            Bound::Positive,
            "exponent of softening with temperature",
        ),
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
            "temperature below which there is no thermal softening",
        ),
        Parameter::required(
            "melting-temperature",
            "T_m",
            PhysicalQuantity::Temperature,
            Bound::Positive,
            "temperature at which the strength is zero",
        ),
    ];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;
    const DEPENDS_ON_TEMPERATURE: bool = true;

    fn check(values: &[f64]) -> Option<&'static str> {
        (values[7] <= values[6]).then_some("melting-temperature must be above reference-temperature")
    }

    fn new(values: &[f64]) -> Self {
        Self {
            yield_stress: T::of(values[0]),
            hardening: T::of(values[1]),
            exponent: T::of(values[2]),
            rate_sensitivity: T::of(values[3]),
            softening_exponent: T::of(values[4]),
            reference_rate: T::of(values[5]),
            reference_temperature: T::of(values[6]),
            melting_temperature: T::of(values[7]),
        }
    }

    #[inline(always)]
    fn yield_stress(&self, state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        let by_rate = branch!(
            T,
            self.reference_rate,
            state.plastic_strain_rate,
            {
                let logarithm = (state.plastic_strain_rate / self.reference_rate).ln();
                [T::one() + self.rate_sensitivity * logarithm, self.rate_sensitivity / state.plastic_strain_rate]
            },
            [T::one(), T::zero()]
        );
        self.at_rate_factor(state, by_rate)
    }

    #[inline(always)]
    fn held(&self, state: FlowState<T>) -> Self {
        let factor = self.thermal_factor(state.temperature);
        Self {
            yield_stress: self.yield_stress * factor,
            hardening: self.hardening * factor,
            reference_temperature: self.reference_temperature.max(state.temperature),
            ..*self
        }
    }

    fn melting_temperature(&self) -> Option<T> {
        Some(self.melting_temperature)
    }
}
