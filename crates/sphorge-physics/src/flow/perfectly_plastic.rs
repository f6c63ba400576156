//! Perfect plasticity.

use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// A constant yield stress, `Y = sigma_y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerfectlyPlastic<T> {
    /// `sigma_y`, Pa.
    pub yield_stress: T,
}

/// The constant `sigma_y` of the laws that start from one.
pub(super) const YIELD_STRESS: Parameter = Parameter::required(
    "yield-stress",
    "sigma_y",
    PhysicalQuantity::Pressure,
    Bound::NonNegative,
    "stress in uniaxial tension at which plastic flow starts",
);

impl<T: Elementary> PerfectlyPlastic<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> PerfectlyPlastic<U>
    where
        T: Scalar,
    {
        PerfectlyPlastic { yield_stress: U::of(self.yield_stress.to_f64()) }
    }
}

impl<T: Elementary> YieldLaw<T> for PerfectlyPlastic<T> {
    const KEY: &'static str = "perfectly-plastic";
    const NAME: &'static str = "elastic, perfectly plastic";
    const REFERENCE: &'static str = "von Mises 1913";
    const PARAMETERS: &'static [Parameter] = &[YIELD_STRESS];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self { yield_stress: T::of(values[0]) }
    }

    #[inline(always)]
    fn yield_stress(&self, _state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        YieldStress { value: self.yield_stress, by_strain: T::zero(), by_rate: T::zero() }
    }

    fn melting_temperature(&self) -> Option<T> {
        None
    }
}
