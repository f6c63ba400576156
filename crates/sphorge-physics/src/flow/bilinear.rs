//! Bilinear isotropic hardening.

use super::perfectly_plastic::YIELD_STRESS;
use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `Y = sigma_y + H eps_p` with `H = E Et / (E - Et)` (Fraser Eq 13).
///
/// `Et` is the slope of stress against total strain beyond yield, `H` the slope against plastic strain. Fraser's Eq 12
/// prints `E + Et` in the denominator: `d eps = d sigma/E + d eps_p` and `d sigma = Et d eps` give the difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bilinear<T> {
    /// `sigma_y` at zero plastic strain, Pa.
    pub yield_stress: T,
    /// `H`, Pa.
    pub hardening_modulus: T,
}

impl<T: Elementary> Bilinear<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> Bilinear<U>
    where
        T: Scalar,
    {
        Bilinear {
            yield_stress: U::of(self.yield_stress.to_f64()),
            hardening_modulus: U::of(self.hardening_modulus.to_f64()),
        }
    }
}

impl<T: Elementary> YieldLaw<T> for Bilinear<T> {
    const KEY: &'static str = "bilinear";
    const NAME: &'static str = "bilinear isotropic hardening";
    const REFERENCE: &'static str = "Fraser Eq 11-14";
    const PARAMETERS: &'static [Parameter] = &[
        YIELD_STRESS,
        Parameter::required(
            "young-modulus",
            "E",
            PhysicalQuantity::Pressure,
            Bound::Positive,
            "slope of stress against strain before yield",
        ),
        Parameter::required(
            "tangent-modulus",
            "Et",
            PhysicalQuantity::Pressure,
            Bound::NonNegative,
            "slope of stress against total strain beyond yield",
        ),
    ];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;

    fn check(values: &[f64]) -> Option<&'static str> {
        (values[2] >= values[1]).then_some("tangent-modulus must be below young-modulus")
    }

    fn new(values: &[f64]) -> Self {
        let (young, tangent) = (values[1], values[2]);
        Self { yield_stress: T::of(values[0]), hardening_modulus: T::of(young * tangent / (young - tangent)) }
    }

    #[inline(always)]
    fn yield_stress(&self, state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        YieldStress {
            value: self.yield_stress + self.hardening_modulus * state.plastic_strain,
            by_strain: self.hardening_modulus,
            by_rate: T::zero(),
        }
    }

    fn melting_temperature(&self) -> Option<T> {
        None
    }
}
