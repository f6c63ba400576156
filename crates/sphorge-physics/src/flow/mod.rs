//! Flow laws: the stress at which a metal yields.
//!
//! A law gives only the yield stress `Y(eps_p, deps_p/dt, T)` and its slopes; the stress update that uses it is the one
//! [`return_mapping`](crate::return_mapping). A further law is one file and one line of the table at the end.
//!
//! Units: stress Pa, strain 1, strain rate 1/s, temperature K.

mod bilinear;
mod elastic;
mod johnson_cook;
mod none;
mod perfectly_plastic;

pub use bilinear::Bilinear;
pub use elastic::Elastic;
pub use johnson_cook::JohnsonCook;
pub use none::NoStrength;
pub use perfectly_plastic::PerfectlyPlastic;

use crate::Scalar;
use crate::parameter::{LawEntry, Parameter};

/// What a yield stress can depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowState<T> {
    /// Equivalent plastic strain.
    pub plastic_strain: T,
    /// Its rate, 1/s.
    pub plastic_strain_rate: T,
    /// Temperature, K.
    pub temperature: T,
}

/// Yield stress and its slopes, all finite unless the law never yields.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct YieldStress<T> {
    /// `Y`, Pa; never negative.
    pub value: T,
    /// `dY/d eps_p`, Pa. Where the formula's slope is infinite (a power below one at zero strain) a large finite number.
    pub by_strain: T,
    /// `dY/d(deps_p/dt)`, Pa s.
    pub by_rate: T,
}

/// What a flow law has to give.
pub trait YieldLaw<T: Scalar>: Copy {
    /// Name in a deck.
    const KEY: &'static str;
    /// Name in a text.
    const NAME: &'static str;
    /// Where it is published.
    const REFERENCE: &'static str;
    /// The constants, in the order of `new`.
    const PARAMETERS: &'static [Parameter];
    /// Whether the material can bear shear at all.
    const HAS_SHEAR: bool;
    /// Whether there is a finite yield stress.
    const YIELDS: bool;

    /// What is wrong with constants that do not fit together, or `None`.
    fn check(values: &[f64]) -> Option<&'static str>;
    /// From one value per parameter, SI units.
    fn new(values: &[f64]) -> Self;
    /// Yield stress in a state.
    fn yield_stress(&self, state: FlowState<T>) -> YieldStress<T>;
    /// The law at one temperature, K: what does not depend on anything else is computed once.
    fn isothermal(&self, temperature: T) -> Self
    where
        Self: Sized + Copy,
    {
        let _ = temperature;
        *self
    }
    /// Temperature above which the law has no strength, K.
    fn melting_temperature(&self) -> Option<T>;
}

macro_rules! flow_laws {
    ($($law:ident,)*) => {
        /// The flow laws a material can have.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum FlowLaw<T> {
            $(
                #[doc = concat!("See [`", stringify!($law), "`](struct@", stringify!($law), ").")]
                $law($law<T>),
            )*
        }

        /// Every flow law, for the deck reader.
        pub const FLOW_LAWS: &[LawEntry<FlowLaw<f64>>] = &[
            $(LawEntry {
                key: <$law<f64> as YieldLaw<f64>>::KEY,
                name: <$law<f64> as YieldLaw<f64>>::NAME,
                reference: <$law<f64> as YieldLaw<f64>>::REFERENCE,
                parameters: <$law<f64> as YieldLaw<f64>>::PARAMETERS,
                check: <$law<f64> as YieldLaw<f64>>::check,
                build: |values| FlowLaw::$law(<$law<f64> as YieldLaw<f64>>::new(values)),
            },)*
        ];

        impl<T: Scalar> FlowLaw<T> {
            /// Yield stress and its slopes in a state.
            #[inline(always)]
            pub fn yield_stress(&self, state: FlowState<T>) -> YieldStress<T> {
                match self { $(Self::$law(law) => law.yield_stress(state),)* }
            }

            /// The law at one temperature, K.
            #[inline(always)]
            pub fn isothermal(&self, temperature: T) -> Self {
                match self { $(Self::$law(law) => Self::$law(law.isothermal(temperature)),)* }
            }

            /// Whether there is a finite yield stress, so that plastic strain can grow.
            #[inline(always)]
            pub fn yields(&self) -> bool {
                match self { $(Self::$law(_) => <$law<T> as YieldLaw<T>>::YIELDS,)* }
            }

            /// Whether the material can bear shear at all.
            #[inline(always)]
            pub fn has_shear(&self) -> bool {
                match self { $(Self::$law(_) => <$law<T> as YieldLaw<T>>::HAS_SHEAR,)* }
            }

            /// Temperature at and above which the yield stress is zero, K, where the law knows one.
            pub fn melting_temperature(&self) -> Option<T> {
                match self { $(Self::$law(law) => law.melting_temperature(),)* }
            }

            /// Name in a deck.
            pub fn key(&self) -> &'static str {
                match self { $(Self::$law(_) => <$law<T> as YieldLaw<T>>::KEY,)* }
            }

            /// The constants of this law.
            pub fn parameters(&self) -> &'static [Parameter] {
                match self { $(Self::$law(_) => <$law<T> as YieldLaw<T>>::PARAMETERS,)* }
            }

            /// The same law in another precision.
            pub fn cast<U: Scalar>(&self) -> FlowLaw<U> {
                match self { $(Self::$law(law) => FlowLaw::$law(law.cast()),)* }
            }
        }
    };
}

flow_laws! {
    NoStrength,
    Elastic,
    PerfectlyPlastic,
    Bilinear,
    JohnsonCook,
}

#[cfg(test)]
mod tests;
