//! No strength: a fluid.

use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::Parameter;
use crate::{Elementary, Scalar};
use core::marker::PhantomData;

/// No deviatoric stress at all: a fluid, or a metal at pressures where strength does not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoStrength<T>(PhantomData<T>);

impl<T: Elementary> NoStrength<T> {
    /// The law, which has no constants.
    pub const fn law() -> Self {
        Self(PhantomData)
    }

    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> NoStrength<U>
    where
        T: Scalar,
    {
        NoStrength::law()
    }
}

impl<T: Elementary> YieldLaw<T> for NoStrength<T> {
    const KEY: &'static str = "none";
    const NAME: &'static str = "no strength";
    const REFERENCE: &'static str = "inviscid fluid";
    const PARAMETERS: &'static [Parameter] = &[];
    const HAS_SHEAR: bool = false;
    const YIELDS: bool = false;

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(_values: &[f64]) -> Self {
        Self::law()
    }

    #[inline(always)]
    fn yield_stress(&self, _state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        YieldStress { value: T::zero(), by_strain: T::zero(), by_rate: T::zero() }
    }

    fn melting_temperature(&self) -> Option<T> {
        None
    }
}
