//! Flow laws: the stress at which a metal yields.
//!
//! A law gives the yield stress `Y(eps_p, deps_p/dt, T, p, rho/rho_0)` and its slopes; the stress update that uses it is the
//! one [`return_mapping`](crate::return_mapping). It may also vary the shear modulus, and keep a history of its own for each
//! particle. A further law is one file and one line of the table at the end.
//!
//! Units: stress and pressure Pa, strain 1, strain rate 1/s, temperature K.

mod bilinear;
mod elastic;
mod johnson_cook;
mod modified_johnson_cook;
mod neo_hookean;
mod none;
mod perfectly_plastic;
mod steinberg_guinan;
mod strain_power;
#[cfg(any(test, feature = "test-law"))]
mod test_law;
mod thermal_activation;
mod zerilli_armstrong_bcc;
mod zerilli_armstrong_fcc;

pub use bilinear::Bilinear;
pub use elastic::Elastic;
pub use johnson_cook::JohnsonCook;
pub use modified_johnson_cook::ModifiedJohnsonCook;
pub use neo_hookean::NeoHookean;
pub use none::NoStrength;
pub use perfectly_plastic::PerfectlyPlastic;
pub use steinberg_guinan::SteinbergGuinan;
#[cfg(any(test, feature = "test-law"))]
pub use test_law::PressureAndDamage;
pub use thermal_activation::ThermalActivation;
pub use zerilli_armstrong_bcc::ZerilliArmstrongBcc;
pub use zerilli_armstrong_fcc::ZerilliArmstrongFcc;

use crate::history::HistoryVariable;
use crate::parameter::{LawEntry, Parameter};
use crate::{Elementary, Numbers, Real, Scalar, SymmetricTensor};

/// What a yield stress and a shear modulus can depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowState<T> {
    /// Equivalent plastic strain.
    pub plastic_strain: T,
    /// Its rate, 1/s.
    pub plastic_strain_rate: T,
    /// Temperature, K.
    pub temperature: T,
    /// Pressure of the equation of state, Pa, positive in compression.
    pub pressure: T,
    /// Density over density at rest, `rho/rho_0`.
    pub compression: T,
}

impl<T: Elementary> FlowState<T> {
    /// Neither strained nor compressed, at a temperature (K).
    pub fn at_rest(temperature: T) -> Self {
        Self {
            plastic_strain: T::zero(),
            plastic_strain_rate: T::zero(),
            temperature,
            pressure: T::zero(),
            compression: T::one(),
        }
    }
}

/// A step that counts, as the history of a law sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowStep<T> {
    /// State after the return: strain and rate are those of the end of the step, temperature that of its start.
    pub state: FlowState<T>,
    /// Deviatoric stress after the return, Pa.
    pub deviator: SymmetricTensor<T>,
    /// Increment of the equivalent plastic strain; zero in an elastic step.
    pub plastic_strain_increment: T,
    /// Length of the step, s.
    pub dt: T,
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

impl<T: Real> Numbers<T> for YieldStress<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { value, by_strain, by_rate } = self;
        [value, by_strain, by_rate].into_iter().for_each(visit);
    }
    #[inline(always)]
    fn choose_lt(a: T, b: T, then: Self, otherwise: Self) -> Self {
        Self {
            value: T::select_lt(a, b, then.value, otherwise.value),
            by_strain: T::select_lt(a, b, then.by_strain, otherwise.by_strain),
            by_rate: T::select_lt(a, b, then.by_rate, otherwise.by_rate),
        }
    }
}

/// What a flow law has to give.
pub trait YieldLaw<T: Elementary>: Copy {
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
    /// Whether the deviator is a function of the deformation gradient; otherwise it is the integral of a rate.
    const IS_HYPERELASTIC: bool = false;
    /// Whether the shear modulus is another than the material's in some state.
    const SHEAR_MODULUS_VARIES: bool = false;
    /// Whether yield stress or history can change in a step without plastic flow at a constant temperature, as with a yield
    /// stress of the pressure or a history of time. Such a law is asked in every step; any other is not asked where stress
    /// stays below the yield stress of a last step without flow.
    const CHANGES_WITHOUT_FLOW: bool = false;
    /// Whether yield stress or shear modulus depend on the temperature.
    const DEPENDS_ON_TEMPERATURE: bool = false;
    /// What the law keeps of the past of a particle, in the order of the values in `history`.
    const HISTORY: &'static [HistoryVariable] = &[];

    /// What is wrong with constants that do not fit together, or `None`.
    fn check(values: &[f64]) -> Option<&'static str>;
    /// From one value per parameter, SI units.
    fn new(values: &[f64]) -> Self;
    /// Yield stress in a state, with one value per variable of [`Self::HISTORY`].
    fn yield_stress(&self, state: FlowState<T>, history: &[T]) -> YieldStress<T>;
    /// The law where temperature, pressure and compression stay those of `state`: what depends on nothing else is computed
    /// once.
    #[inline(always)]
    fn held(&self, state: FlowState<T>) -> Self {
        let _ = state;
        *self
    }
    /// Shear modulus in a state, Pa, never negative; `at_rest` is the material's. The plastic strain rate is not known there,
    /// and is zero.
    #[inline(always)]
    fn shear_modulus(&self, at_rest: T, state: FlowState<T>) -> T {
        let _ = state;
        at_rest
    }
    /// Takes the history through a step, once for each step that counts: it is held over a return, so that yield stress
    /// grows with the plastic strain increment even where damage softens.
    #[inline(always)]
    fn evolve(&self, step: &FlowStep<T>, history: &mut [T]) {
        let _ = (step, history);
    }
    /// Temperature at and above which the law has no strength at the density at rest, K.
    fn melting_temperature(&self) -> Option<T>;
}

macro_rules! flow_laws {
    ($($(#[$attribute:meta])* $law:ident $([$listed:meta])?,)*) => {
        /// The flow laws a material can have.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum FlowLaw<T> {
            $(
                $(#[$attribute])*
                #[doc = concat!("See [`", stringify!($law), "`](struct@", stringify!($law), ").")]
                $law($law<T>),
            )*
        }

        /// Every flow law, for the deck reader.
        pub const FLOW_LAWS: &[LawEntry<FlowLaw<f64>>] = &[
            $($(#[$attribute])* $(#[$listed])? LawEntry {
                key: <$law<f64> as YieldLaw<f64>>::KEY,
                name: <$law<f64> as YieldLaw<f64>>::NAME,
                reference: <$law<f64> as YieldLaw<f64>>::REFERENCE,
                parameters: <$law<f64> as YieldLaw<f64>>::PARAMETERS,
                history: <$law<f64> as YieldLaw<f64>>::HISTORY,
                check: <$law<f64> as YieldLaw<f64>>::check,
                build: |values| FlowLaw::$law(<$law<f64> as YieldLaw<f64>>::new(values)),
            },)*
        ];

        impl<T: Elementary> FlowLaw<T> {
            /// Yield stress and its slopes in a state, with one value per variable of [`Self::history`].
            #[inline(always)]
            pub fn yield_stress(&self, state: FlowState<T>, history: &[T]) -> YieldStress<T> {
                match self { $($(#[$attribute])* Self::$law(law) => law.yield_stress(state, history),)* }
            }

            /// The law where temperature, pressure and compression stay those of `state`.
            #[inline(always)]
            pub fn held(&self, state: FlowState<T>) -> Self {
                match self { $($(#[$attribute])* Self::$law(law) => Self::$law(law.held(state)),)* }
            }

            /// Shear modulus in a state, Pa; `at_rest` is the material's.
            #[inline(always)]
            pub fn shear_modulus(&self, at_rest: T, state: FlowState<T>) -> T {
                match self { $($(#[$attribute])* Self::$law(law) => law.shear_modulus(at_rest, state),)* }
            }

            /// Whether the shear modulus is another than the material's in some state.
            #[inline(always)]
            pub fn shear_modulus_varies(&self) -> bool {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::SHEAR_MODULUS_VARIES,)* }
            }

            /// Whether yield stress or history can change in a step without plastic flow at a constant temperature.
            #[inline(always)]
            pub fn changes_without_flow(&self) -> bool {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::CHANGES_WITHOUT_FLOW,)* }
            }

            /// Whether yield stress or shear modulus depend on the temperature.
            #[inline(always)]
            pub fn depends_on_temperature(&self) -> bool {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::DEPENDS_ON_TEMPERATURE,)* }
            }

            /// What the law keeps of the past of a particle.
            #[inline(always)]
            pub fn history(&self) -> &'static [HistoryVariable] {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::HISTORY,)* }
            }

            /// Takes the history through a step that counts.
            #[inline(always)]
            pub fn evolve(&self, step: &FlowStep<T>, history: &mut [T]) {
                match self { $($(#[$attribute])* Self::$law(law) => law.evolve(step, history),)* }
            }

            /// Whether there is a finite yield stress, so that plastic strain can grow.
            #[inline(always)]
            pub fn yields(&self) -> bool {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::YIELDS,)* }
            }

            /// Whether the deviator is a function of the deformation gradient; otherwise it is the integral of a rate.
            #[inline(always)]
            pub fn is_hyperelastic(&self) -> bool {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::IS_HYPERELASTIC,)* }
            }

            /// Whether the material can bear shear at all.
            #[inline(always)]
            pub fn has_shear(&self) -> bool {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::HAS_SHEAR,)* }
            }

            /// Temperature at and above which the yield stress is zero at the density at rest, K, where the law knows one.
            pub fn melting_temperature(&self) -> Option<T> {
                match self { $($(#[$attribute])* Self::$law(law) => law.melting_temperature(),)* }
            }

            /// Name in a deck.
            pub fn key(&self) -> &'static str {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::KEY,)* }
            }

            /// The constants of this law.
            pub fn parameters(&self) -> &'static [Parameter] {
                match self { $($(#[$attribute])* Self::$law(_) => <$law<T> as YieldLaw<T>>::PARAMETERS,)* }
            }

            /// The same law in another precision.
            pub fn cast<U: Elementary>(&self) -> FlowLaw<U>
            where
                T: Scalar,
            {
                match self { $($(#[$attribute])* Self::$law(law) => FlowLaw::$law(law.cast()),)* }
            }
        }
    };
}

flow_laws! {
    NoStrength,
    Elastic,
    NeoHookean,
    PerfectlyPlastic,
    Bilinear,
    JohnsonCook,
    ModifiedJohnsonCook,
    ZerilliArmstrongBcc,
    ZerilliArmstrongFcc,
    SteinbergGuinan,
    // In tests of engines, too, but in no table of theirs.
    #[cfg(any(test, feature = "test-law"))]
    PressureAndDamage [cfg(test)],
}

#[cfg(test)]
mod tests;
