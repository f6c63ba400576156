//! Zerilli–Armstrong for body-centred cubic metals.

use super::strain_power::strain_power;
use super::thermal_activation::{LOWEST_RATE, RATE_SENSITIVITY, SOFTENING, ThermalActivation};
use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `Y = C_0 + C_1 exp(-C_3 T + C_4 T ln rate) + C_5 eps_p^n`, for iron, tantalum and other body-centred cubic metals
/// (Zerilli & Armstrong 1987, the equation of the b.c.c. case), with the limits of [`ThermalActivation`].
///
/// `C_0` is what temperature does not change: `Delta sigma_G' + k l^(-1/2)`, solutes and first dislocations, and the grain size `l`.
/// The law knows no melting: hot metal keeps `C_0 + C_5 eps_p^n`. The power is a chord below a plastic strain of 1e-12.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZerilliArmstrongBcc<T> {
    /// `C_0`, Pa.
    pub athermal: T,
    /// `C_1`, Pa.
    pub thermal: T,
    /// `C_3`, `C_4` and the lowest rate.
    pub activation: ThermalActivation<T>,
    /// `C_5`, Pa.
    pub hardening: T,
    /// `n`.
    pub exponent: T,
}

impl<T: Elementary> ZerilliArmstrongBcc<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> ZerilliArmstrongBcc<U>
    where
        T: Scalar,
    {
        ZerilliArmstrongBcc {
            athermal: U::of(self.athermal.to_f64()),
            thermal: U::of(self.thermal.to_f64()),
            activation: self.activation.cast(),
            hardening: U::of(self.hardening.to_f64()),
            exponent: U::of(self.exponent.to_f64()),
        }
    }
}

impl<T: Elementary> YieldLaw<T> for ZerilliArmstrongBcc<T> {
    const KEY: &'static str = "zerilli-armstrong-bcc";
    const NAME: &'static str = "Zerilli–Armstrong, body-centred cubic";
    const REFERENCE: &'static str = "Zerilli & Armstrong, Journal of Applied Physics 61 (1987) 1816";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "C0",
            "C_0",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "part of the yield stress that does not depend on temperature, rate or strain, including that of the grain size",
        ),
        Parameter::required(
            "C1",
            "C_1",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "part of the yield stress at 0 K that decreases with temperature",
        ),
        SOFTENING,
        RATE_SENSITIVITY,
        Parameter::required("C5", "C_5", PhysicalQuantity::Pressure, Bound::NonNegative, "strength of hardening"),
        Parameter::required("n", "n", PhysicalQuantity::Dimensionless, Bound::Positive, "exponent of hardening"),
        LOWEST_RATE,
    ];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;
    const DEPENDS_ON_TEMPERATURE: bool = true;

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self {
            athermal: T::of(values[0]),
            thermal: T::of(values[1]),
            activation: ThermalActivation::new([values[2], values[3], values[6]]),
            hardening: T::of(values[4]),
            exponent: T::of(values[5]),
        }
    }

    #[inline(always)]
    fn yield_stress(&self, state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        let (factor, factor_slope) = self.activation.factor(state.temperature, state.plastic_strain_rate);
        let (power, power_slope) = strain_power(state.plastic_strain, self.exponent);
        YieldStress {
            value: self.athermal + self.thermal * factor + self.hardening * power,
            by_strain: self.hardening * power_slope,
            by_rate: self.thermal * factor_slope,
        }
    }

    fn melting_temperature(&self) -> Option<T> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::tests::{assert_slopes, close, state};

    /// Armco iron (Zerilli & Armstrong 1987) and tantalum (the same, 1990).
    const IRON: [f64; 7] = [65.0e6, 1033.0e6, 0.00698, 0.000415, 266.0e6, 0.289, 1e-3];
    const TANTALUM: [f64; 7] = [30.0e6, 1125.0e6, 0.00535, 0.000327, 310.0e6, 0.44, 1.0];

    fn law(values: &[f64]) -> ZerilliArmstrongBcc<f64> {
        ZerilliArmstrongBcc::new(values)
    }

    #[test]
    fn by_hand() {
        // Iron, 0.2, 1e4/s, 400 K: ln 1e4 = 9.210340; 400 (0.000415 9.210340 - 0.00698) = -1.263083, exp = 0.282781;
        // 0.2^0.289 = exp(-0.465128) = 0.628055; 65 + 1033 0.282781 + 266 0.628055 = 65 + 292.1125 + 167.0626 MPa.
        close(law(&IRON).yield_stress(state(0.2, 1.0e4, 400.0), &[]).value, 524.1751e6, 1e-6);
        // Tantalum, 0.05, 500/s, 600 K: ln 500 = 6.214608; 600 (0.000327 6.214608 - 0.00535) = -1.990694, exp = 0.136601;
        // 0.05^0.44 = exp(-1.318122) = 0.267637; 30 + 1125 0.136601 + 310 0.267637 = 30 + 153.6757 + 82.9676 MPa.
        close(law(&TANTALUM).yield_stress(state(0.05, 500.0, 600.0), &[]).value, 266.6433e6, 1e-6);
    }

    #[test]
    fn limits() {
        let y = |e, r, t| law(&IRON).yield_stress(state(e, r, t), &[]);
        // At 0 K all of C_0 + C_1; far above melting C_0 and the hardening are left. Colder than cold counts as 0 K.
        assert_eq!(y(0.0, 0.0, 0.0).value, 1098.0e6);
        for rate in [1e3, 1e30] {
            assert_eq!((y(0.0, rate, -50.0).value, y(0.0, rate, -50.0).by_rate), (1098.0e6, 0.0));
        }
        close(y(0.0, 1e3, 1.0e5).value, 65.0e6, 1e-12);
        close(y(0.3, 1e3, 1.0e5).value, 65.0e6 + 266.0e6 * (0.289 * 0.3f64.ln()).exp(), 1e-12);
        // Up to the lowest rate, no effect of the rate: -0.00698 300 - 0.000415 300 6.907755 = -2.954016, exp = 0.052130.
        for rate in [-1.0, 0.0, 1e-9, 1e-3] {
            close(y(0.0, rate, 300.0).value, 65.0e6 + 1033.0e6 * 0.052_129_9, 1e-5);
            assert_eq!(y(0.0, rate, 300.0).by_rate, 0.0);
        }
        // Beyond exp(0.00698/0.000415) = 2.0e7/s heat would harden: never above the strength of 0 K, at any temperature.
        for (rate, temperature) in [(3e7, 300.0), (1e30, 1811.0), (1e300, 1e6), (f64::MAX, f64::MAX)] {
            let fast = y(0.0, rate, temperature);
            assert_eq!((fast.value, fast.by_rate), (1098.0e6, 0.0));
        }
        assert!(y(0.0, 1e7, 300.0).value < 1098.0e6);
        assert_eq!(y(-1e-3, 10.0, 300.0).value, y(0.0, 10.0, 300.0).value);
    }

    #[test]
    fn slopes() {
        for constants in [IRON, TANTALUM] {
            for at in
                [(0.01, 50.0, 310.0), (0.7, 1e5, 700.0), (1e-6, 0.3, 250.0), (0.1, 0.0, 300.0), (0.2, 1e9, 1500.0)]
            {
                assert_slopes(&|state| law(&constants).yield_stress(state, &[]), at);
            }
        }
        let single = law(&IRON).cast::<f32>().yield_stress(FlowState::at_rest(300.0), &[]);
        assert!(single.by_strain.is_finite() && (f64::from(single.value) / 118.850e6 - 1.0).abs() < 1e-4);
    }
}
