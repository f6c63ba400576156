//! A constant failure strain.

use super::{DamageGrowth, DamageState, over_failure_strain};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `dD = deps_p/eps_f` in every state of stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailureStrain<T> {
    /// `eps_f`.
    pub strain: T,
}

impl<T: Elementary> FailureStrain<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> FailureStrain<U>
    where
        T: Scalar,
    {
        FailureStrain { strain: U::of(self.strain.to_f64()) }
    }
}

impl<T: Elementary> DamageGrowth<T> for FailureStrain<T> {
    const KEY: &'static str = "failure-strain";
    const NAME: &'static str = "constant failure strain";
    const REFERENCE: &'static str = "the equivalent plastic strain, whatever the state of stress";
    const PARAMETERS: &'static [Parameter] = &[Parameter::required(
        "strain",
        "eps_f",
        PhysicalQuantity::Dimensionless,
        Bound::Positive,
        "equivalent plastic strain at which the material begins to break",
    )];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self { strain: T::of(values[0]) }
    }

    #[inline(always)]
    fn growth(&self, _state: &DamageState<T>) -> T {
        over_failure_strain(self.strain)
    }
}
