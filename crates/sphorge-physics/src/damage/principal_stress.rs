//! Largest principal stress.

use super::{DamageGrowth, DamageState};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `D = s_1/s_f`, the largest the principal stress `s_1` has been over the strength `s_f` (Rankine): of brittle metals, which break without
/// plastic flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalStress<T> {
    /// `s_f`, Pa.
    pub strength: T,
}

impl<T: Elementary> PrincipalStress<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> PrincipalStress<U>
    where
        T: Scalar,
    {
        PrincipalStress { strength: U::of(self.strength.to_f64()) }
    }
}

impl<T: Elementary> DamageGrowth<T> for PrincipalStress<T> {
    const KEY: &'static str = "principal-stress";
    const NAME: &'static str = "largest principal stress";
    const REFERENCE: &'static str = "Rankine (1857)";
    const PARAMETERS: &'static [Parameter] = &[Parameter::required(
        "strength",
        "s_f",
        PhysicalQuantity::Pressure,
        Bound::Positive,
        "largest principal stress at which the material begins to break",
    )];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self { strength: T::of(values[0]) }
    }

    #[inline(always)]
    fn growth(&self, state: &DamageState<T>) -> T {
        state.largest_stress().max(T::zero()) / self.strength
    }

    #[inline(always)]
    fn strength(&self) -> Option<T> {
        Some(self.strength)
    }
}
