//! Cockcroft & Latham.

use super::{DamageGrowth, DamageState};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `dD = max(s_1, 0) deps_p/W_c` with the largest principal stress `s_1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CockcroftLatham<T> {
    /// `W_c`, Pa.
    pub work: T,
}

/// `dD = max(s_1, 0)/q deps_p/C` with the largest principal stress `s_1` and the von Mises stress `q`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalisedCockcroftLatham<T> {
    /// `C`.
    pub strain: T,
}

impl<T: Elementary> CockcroftLatham<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> CockcroftLatham<U>
    where
        T: Scalar,
    {
        CockcroftLatham { work: U::of(self.work.to_f64()) }
    }
}

impl<T: Elementary> NormalisedCockcroftLatham<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> NormalisedCockcroftLatham<U>
    where
        T: Scalar,
    {
        NormalisedCockcroftLatham { strain: U::of(self.strain.to_f64()) }
    }
}

impl<T: Elementary> DamageGrowth<T> for CockcroftLatham<T> {
    const KEY: &'static str = "cockcroft-latham";
    const NAME: &'static str = "Cockcroft & Latham";
    const REFERENCE: &'static str = "Cockcroft & Latham, J. Inst. Metals 96 (1968) 33";
    const PARAMETERS: &'static [Parameter] = &[Parameter::required(
        "work",
        "W_c",
        PhysicalQuantity::Pressure,
        Bound::Positive,
        "integral of the largest principal stress over the plastic strain at which the material begins to break",
    )];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self { work: T::of(values[0]) }
    }

    #[inline(always)]
    fn growth(&self, state: &DamageState<T>) -> T {
        state.largest_stress().max(T::zero()) / self.work
    }
}

impl<T: Elementary> DamageGrowth<T> for NormalisedCockcroftLatham<T> {
    const KEY: &'static str = "normalised-cockcroft-latham";
    const NAME: &'static str = "Cockcroft & Latham, normalised";
    const REFERENCE: &'static str = "Oh, Chen & Kobayashi, J. Eng. Ind. 101 (1979) 36";
    const PARAMETERS: &'static [Parameter] = &[Parameter::required(
        "strain",
        "C",
        PhysicalQuantity::Dimensionless,
        Bound::Positive,
        "integral of the largest principal stress over von Mises stress over the plastic strain at which the material begins to break",
    )];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self { strain: T::of(values[0]) }
    }

    #[inline(always)]
    fn growth(&self, state: &DamageState<T>) -> T {
        // No stress, no flow.
        let share = state.largest_stress().max(T::zero()) / state.von_mises.max(T::one());
        share / self.strain
    }
}
