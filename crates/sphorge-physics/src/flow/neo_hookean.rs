//! Neo-Hookean: hyperelastic, never yields.

use super::{FlowState, YieldLaw, YieldStress};
use crate::parameter::Parameter;
use crate::{Elementary, Scalar};
use core::marker::PhantomData;

/// The compressible neo-Hookean solid: the deviator is a function of the deformation gradient
/// ([`hyperelastic`](crate::hyperelastic)), the pressure that of the equation of state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NeoHookean<T>(PhantomData<T>);

impl<T: Elementary> NeoHookean<T> {
    /// The law, which has no constants of its own (the shear modulus is the material's).
    pub const fn law() -> Self {
        Self(PhantomData)
    }

    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> NeoHookean<U>
    where
        T: Scalar,
    {
        NeoHookean::law()
    }
}

impl<T: Elementary> YieldLaw<T> for NeoHookean<T> {
    const KEY: &'static str = "neo-hookean";
    const NAME: &'static str = "neo-Hookean";
    const REFERENCE: &'static str = "Simo & Pister 1984; Bonet & Wood 2008, Eq 6.52";
    const PARAMETERS: &'static [Parameter] = &[];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = false;
    const IS_HYPERELASTIC: bool = true;

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
