//! Zerilli–Armstrong for face-centred cubic metals.

use super::strain_power::strain_root;
use super::thermal_activation::{LOWEST_RATE, RATE_SENSITIVITY, SOFTENING, ThermalActivation};
use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `Y = C_0 + C_2 eps_p^(1/2) exp(-C_3 T + C_4 T ln rate)`, for copper, nickel and other face-centred cubic metals
/// (Zerilli & Armstrong 1987, the equation of the f.c.c. case), with the limits of [`ThermalActivation`].
///
/// `C_0` is what temperature does not change: `Delta sigma_G' + k l^(-1/2)`, solutes and first dislocations, and the grain size `l`.
/// The law knows no melting: hot metal keeps `C_0`. The root is a chord below a plastic strain of 1e-12.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZerilliArmstrongFcc<T> {
    /// `C_0`, Pa.
    pub athermal: T,
    /// `C_2`, Pa.
    pub hardening: T,
    /// `C_3`, `C_4` and the lowest rate.
    pub activation: ThermalActivation<T>,
}

impl<T: Elementary> ZerilliArmstrongFcc<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> ZerilliArmstrongFcc<U>
    where
        T: Scalar,
    {
        ZerilliArmstrongFcc {
            athermal: U::of(self.athermal.to_f64()),
            hardening: U::of(self.hardening.to_f64()),
            activation: self.activation.cast(),
        }
    }
}

impl<T: Elementary> YieldLaw<T> for ZerilliArmstrongFcc<T> {
    const KEY: &'static str = "zerilli-armstrong-fcc";
    const NAME: &'static str = "Zerilli–Armstrong, face-centred cubic";
    const REFERENCE: &'static str = "Zerilli & Armstrong, Journal of Applied Physics 61 (1987) 1816";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::required(
            "C0",
            "C_0",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "yield stress at zero plastic strain, including that of the grain size",
        ),
        Parameter::required(
            "C2",
            "C_2",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "strength of hardening with the root of the plastic strain, at 0 K",
        ),
        SOFTENING,
        RATE_SENSITIVITY,
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
            hardening: T::of(values[1]),
            activation: ThermalActivation::new([values[2], values[3], values[4]]),
        }
    }

    #[inline(always)]
    fn yield_stress(&self, state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        let (factor, factor_slope) = self.activation.factor(state.temperature, state.plastic_strain_rate);
        let (root, root_slope) = strain_root(state.plastic_strain);
        YieldStress {
            value: self.athermal + self.hardening * root * factor,
            by_strain: self.hardening * root_slope * factor,
            by_rate: self.hardening * root * factor_slope,
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

    /// OFHC copper (Zerilli & Armstrong 1987) and a metal with every constant different.
    const COPPER: [f64; 5] = [65.0e6, 890.0e6, 0.0028, 0.000115, 1e-3];
    const OTHER: [f64; 5] = [50.0e6, 600.0e6, 0.003, 0.0002, 1.0];

    fn law(values: &[f64]) -> ZerilliArmstrongFcc<f64> {
        ZerilliArmstrongFcc::new(values)
    }

    #[test]
    fn by_hand() {
        // Copper, 0.25, 1e4/s, 300 K: ln 1e4 = 9.210340; 300 (0.000115 9.210340 - 0.0028) = -0.522243, exp = 0.593188;
        // 65 + 890 0.5 0.593188 = 328.9688 MPa.
        close(law(&COPPER).yield_stress(state(0.25, 1.0e4, 300.0), &[]).value, 328.9688e6, 1e-6);
        // 0.04, 50/s, 500 K: ln 50 = 3.912023; 500 (0.0002 3.912023 - 0.003) = -1.108798, exp = 0.329955; 50 + 600 0.2 0.329955.
        close(law(&OTHER).yield_stress(state(0.04, 50.0, 500.0), &[]).value, 89.59465e6, 1e-6);
    }

    #[test]
    fn limits() {
        let y = |e, r, t| law(&COPPER).yield_stress(state(e, r, t), &[]);
        // Without strain nothing but C_0, at any temperature; hot metal keeps it.
        for temperature in [0.0, 300.0, 1356.0, 5000.0] {
            assert_eq!(y(0.0, 1e4, temperature).value, 65.0e6);
            assert!(y(0.0, 1e4, temperature).by_strain.is_finite());
        }
        close(y(0.25, 1e3, 1.0e5).value, 65.0e6, 1e-12);
        // All of C_2 at 0 K, and never more.
        assert_eq!(y(0.25, 1e3, 0.0).value, 510.0e6);
        assert_eq!(y(0.25, 1e300, 1e6).value, 510.0e6);
        // Up to the lowest rate, no effect of the rate.
        for rate in [-1.0, 0.0, 1e-9] {
            assert_eq!(y(0.25, rate, 300.0), y(0.25, 1e-3, 300.0));
            assert_eq!(y(0.25, rate, 300.0).by_rate, 0.0);
        }
        assert!(y(0.25, 2e-3, 300.0).value > y(0.25, 1e-3, 300.0).value);
    }

    #[test]
    fn slopes() {
        for constants in [COPPER, OTHER] {
            for at in [(0.01, 50.0, 310.0), (0.7, 1e5, 700.0), (1e-6, 0.3, 250.0), (0.1, 0.0, 300.0)] {
                assert_slopes(&|state| law(&constants).yield_stress(state, &[]), at);
            }
        }
        let single = law(&COPPER).cast::<f32>().yield_stress(
            FlowState { plastic_strain: 0.25f32, plastic_strain_rate: 1.0e4, ..FlowState::at_rest(300.0) },
            &[],
        );
        assert!((f64::from(single.value) / 328.9688e6 - 1.0).abs() < 1e-5);
    }
}
