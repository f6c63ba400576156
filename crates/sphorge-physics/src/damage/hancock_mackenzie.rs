//! Hancock & Mackenzie.

use super::{DamageGrowth, DamageState, over_failure_strain};
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `dD = deps_p/eps_f`, `eps_f = a exp(-b eta)`: holes grow with the triaxiality as Rice & Tracey find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HancockMackenzie<T> {
    /// `a`.
    pub factor: T,
    /// `b`.
    pub exponent: T,
}

impl<T: Elementary> HancockMackenzie<T> {
    /// The same law in another precision.
    pub fn cast<U: Elementary>(&self) -> HancockMackenzie<U>
    where
        T: Scalar,
    {
        HancockMackenzie { factor: U::of(self.factor.to_f64()), exponent: U::of(self.exponent.to_f64()) }
    }
}

/// A pure number above zero, with the value of a default.
const fn number(key: &'static str, symbol: &'static str, default: f64, meaning: &'static str) -> Parameter {
    Parameter {
        key,
        symbol,
        quantity: PhysicalQuantity::Dimensionless,
        bound: Bound::Positive,
        default: Some(default),
        meaning,
    }
}

impl<T: Elementary> DamageGrowth<T> for HancockMackenzie<T> {
    const KEY: &'static str = "hancock-mackenzie";
    const NAME: &'static str = "Hancock & Mackenzie";
    const REFERENCE: &'static str = "Hancock & Mackenzie, J. Mech. Phys. Solids 24 (1976) 147";
    const PARAMETERS: &'static [Parameter] = &[
        number("factor", "a", 1.65, "failure strain without mean stress"),
        number("exponent", "b", 1.5, "decrease of its logarithm with the triaxiality"),
    ];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        Self { factor: T::of(values[0]), exponent: T::of(values[1]) }
    }

    #[inline(always)]
    fn growth(&self, state: &DamageState<T>) -> T {
        over_failure_strain(self.factor * (-(self.exponent * state.triaxiality)).exp())
    }
}
