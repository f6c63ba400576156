//! Johnson–Cook with a power of the rate.

use super::{FlowState, JohnsonCook, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::real::branch;
use crate::{Elementary, Scalar};

/// `Y = (A + B eps_p^n) (1 + rate/rate_0)^C (1 - T*^m)`, `T* = (T - T_0)/(T_m - T_0)` clamped to [0, 1] (Børvik, Hopperstad,
/// Berstad & Langseth 2001, whose damage is left out; LS-DYNA's *modified Johnson–Cook*).
///
/// Hardening and softening are those of [`JohnsonCook`]. Where rates are far above `rate_0` the factor is close to its
/// `1 + C ln(rate/rate_0)`, but it is smooth and never below one: nothing is cut off at `rate_0`. A negative rate counts as none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModifiedJohnsonCook<T> {
    /// The constants, by the names they have there.
    pub constants: JohnsonCook<T>,
}

impl<T: Elementary> ModifiedJohnsonCook<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> ModifiedJohnsonCook<U>
    where
        T: Scalar,
    {
        ModifiedJohnsonCook { constants: self.constants.cast() }
    }
}

/// The constants of Johnson & Cook's law.
const COMMON: &[Parameter] = <JohnsonCook<f64> as YieldLaw<f64>>::PARAMETERS;

impl<T: Elementary> YieldLaw<T> for ModifiedJohnsonCook<T> {
    const KEY: &'static str = "modified-johnson-cook";
    const NAME: &'static str = "modified Johnson–Cook";
    const REFERENCE: &'static str =
        "Børvik, Hopperstad, Berstad & Langseth, European Journal of Mechanics A/Solids 20 (2001) 685";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter {
            meaning: "yield stress at zero plastic strain and rate and the reference temperature",
            ..COMMON[0]
        },
        COMMON[1],
        COMMON[2],
        Parameter { meaning: "exponent of the rate", ..COMMON[3] },
        COMMON[4],
        Parameter::required(
            "reference-strain-rate",
            "rate_0",
            PhysicalQuantity::StrainRate,
            Bound::Positive,
            "plastic strain rate at which the rate factor is 2^C",
        ),
        COMMON[6],
        COMMON[7],
    ];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;
    const DEPENDS_ON_TEMPERATURE: bool = true;

    fn check(values: &[f64]) -> Option<&'static str> {
        <JohnsonCook<T> as YieldLaw<T>>::check(values)
    }

    fn new(values: &[f64]) -> Self {
        Self { constants: JohnsonCook::new(values) }
    }

    #[inline(always)]
    fn yield_stress(&self, state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        let JohnsonCook { rate_sensitivity: exponent, reference_rate, .. } = self.constants;
        let rate = state.plastic_strain_rate;
        let by_rate = branch!(
            T,
            T::zero(),
            rate,
            {
                let factor = (T::one() + rate / reference_rate).powf(exponent);
                [factor, exponent * factor / (reference_rate + rate)]
            },
            // At no rate the slope is that of flow about to begin.
            [T::one(), exponent / reference_rate]
        );
        self.constants.at_rate_factor(state, by_rate)
    }

    #[inline(always)]
    fn held(&self, state: FlowState<T>) -> Self {
        Self { constants: self.constants.held(state) }
    }

    fn melting_temperature(&self) -> Option<T> {
        self.constants.melting_temperature()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::tests::{assert_slopes, close, state};

    /// Weldox 460 E steel, and a metal with every constant different.
    const WELDOX: [f64; 8] = [490.0e6, 383.0e6, 0.45, 0.0114, 0.94, 5e-4, 293.0, 1800.0];
    const BRASS: [f64; 8] = [206.0e6, 505.0e6, 0.42, 0.010, 1.68, 2.0, 273.15, 1189.0];

    fn law(values: &[f64]) -> ModifiedJohnsonCook<f64> {
        ModifiedJohnsonCook::new(values)
    }

    #[test]
    fn by_hand() {
        // Weldox, 0.2, 1e4/s, 600 K: 0.2^0.45 = exp(-0.724247) = 0.484689; 490 + 383 0.484689 = 675.6360 MPa;
        // (1 + 2e7)^0.0114 = exp(0.0114 16.811243) = 1.211244; T* = 307/1507 = 0.203716, T*^0.94 = exp(-1.495567) = 0.224122.
        close(law(&WELDOX).yield_stress(state(0.2, 1.0e4, 600.0), &[]).value, 634.9481e6, 1e-6);
        // Brass, 0.05, 300/s, 400 K: 0.05^0.42 = exp(-1.258208) = 0.284163; 206 + 505 0.284163 = 349.5023 MPa;
        // 151^0.01 = exp(0.050173) = 1.051453; T* = 126.85/915.85 = 0.138505, T*^1.68 = exp(-3.321103) = 0.036113.
        close(law(&BRASS).yield_stress(state(0.05, 300.0, 400.0), &[]).value, 354.2142e6, 1e-6);
    }

    #[test]
    fn limits() {
        let y = |e, r, t| law(&WELDOX).yield_stress(state(e, r, t), &[]);
        // At rest the rate changes nothing, and the slope is A C/rate_0 = 490 MPa 0.0114/5e-4 s.
        assert_eq!(y(0.0, 0.0, 293.0).value, 490.0e6);
        close(y(0.0, 0.0, 293.0).by_rate, 490.0e6 * 22.8, 1e-14);
        assert_eq!(y(0.0, -1.0, 293.0), y(0.0, 0.0, 293.0));
        // At rate_0 2^C, without a kink there; the factor of Johnson & Cook is one up to rate_0.
        close(y(0.0, 5e-4, 293.0).value, 490.0e6 * 1.007_933, 1e-6);
        // Hardening, softening, melting and cold are Johnson & Cook's.
        let without_rate = JohnsonCook::<f64>::new(&WELDOX);
        for (e, t) in
            [(0.0, 100.0), (-1e-3, 293.0), (1e-13, 293.0), (0.3, 900.0), (2.0, 1799.0), (0.3, 1800.0), (0.3, 1e6)]
        {
            let want = without_rate.yield_stress(state(e, 0.0, t), &[]);
            let got = y(e, 0.0, t);
            assert_eq!((got.value, got.by_strain), (want.value, want.by_strain));
        }
        let melt = y(0.3, 1e5, 1800.0);
        assert_eq!((melt.value, melt.by_strain, melt.by_rate), (0.0, 0.0, 0.0));
    }

    #[test]
    fn held_at_a_state_it_is_the_same_there_and_softens_no_more() {
        for t in [250.0, 293.0, 700.0, 1800.0] {
            let at = state(0.1, 2.0e3, t);
            let (held, want) = (law(&WELDOX).held(at), law(&WELDOX).yield_stress(at, &[]).value);
            for asked in [at, state(0.1, 2.0e3, 250.0)] {
                let got = held.yield_stress(asked, &[]).value;
                assert!((got - want).abs() <= 1e-15 * 490.0e6, "{t}: {got} {want}");
            }
        }
    }

    #[test]
    fn slopes() {
        for constants in [WELDOX, BRASS] {
            for at in [(0.01, 50.0, 310.0), (0.7, 1e5, 700.0), (1e-6, 0.3, 250.0), (0.1, 1e-4, 300.0)] {
                assert_slopes(&|state| law(&constants).yield_stress(state, &[]), at);
            }
        }
        let single = law(&WELDOX).cast::<f32>().yield_stress(FlowState::at_rest(300.0), &[]);
        assert!(single.by_strain.is_finite() && single.by_rate.is_finite());
    }
}
