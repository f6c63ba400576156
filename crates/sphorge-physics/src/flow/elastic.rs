//! Elastic: never yields.

use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::Parameter;
use crate::{Elementary, Scalar};
use core::marker::PhantomData;

/// Hooke's law without a limit (Patiño et al. Eq 17, Fraser Eq 9): the yield stress is infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elastic<T>(PhantomData<T>);

impl<T: Elementary> Elastic<T> {
    /// The law, which has no constants of its own (the shear modulus is the material's).
    pub const fn law() -> Self {
        Self(PhantomData)
    }

    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> Elastic<U>
    where
        T: Scalar,
    {
        Elastic::law()
    }
}

impl<T: Elementary> YieldLaw<T> for Elastic<T> {
    const KEY: &'static str = "elastic";
    const NAME: &'static str = "elastic";
    const REFERENCE: &'static str = "Hooke's law; Patiño et al. Eq 17";
    const PARAMETERS: &'static [Parameter] = &[];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = false;

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(_values: &[f64]) -> Self {
        Self::law()
    }

    #[inline(always)]
    fn yield_stress(&self, _state: FlowState<T>, _history: &[T]) -> YieldStress<T> {
        YieldStress { value: T::of(f64::INFINITY), by_strain: T::zero(), by_rate: T::zero() }
    }

    fn melting_temperature(&self) -> Option<T> {
        None
    }
}
