//! Damage: how near a metal is to breaking, and what it loses of its integrity from then on.
//!
//! A law says how fast damage grows with the plastic strain in a state of stress, `dD = deps_p/eps_f`, or what damage a stress is by itself.
//! At a damage of one metal begins to break: the [integrity](crate::integrity) falls with the plastic strain that follows, so that a crack
//! takes a stated energy per area or opens by a stated displacement, whatever the spacing. A further law is one file and one line of the
//! table at the end.
//!
//! Stresses are those of whole material, which damaged material bears times its integrity. Triaxiality is positive in tension.

mod breaking;
mod cockcroft_latham;
mod failure_strain;
mod hancock_mackenzie;
mod johnson_cook;
mod modified_mohr_coulomb;
mod principal_stress;
mod state;

pub use breaking::{
    AfterFailure, Before, Breaking, DEFAULT_SMALLEST_STRAIN, DEFAULT_SOFTENING, Damage, Moduli, Softening,
};
pub use cockcroft_latham::{CockcroftLatham, NormalisedCockcroftLatham};
pub use failure_strain::FailureStrain;
pub use hancock_mackenzie::HancockMackenzie;
pub use johnson_cook::JohnsonCookDamage;
pub use modified_mohr_coulomb::ModifiedMohrCoulomb;
pub use principal_stress::PrincipalStress;
pub use state::{DamageState, lode_angle};

use crate::history::HistoryVariable;
use crate::parameter::{Bound, LawEntry, Parameter};
use crate::{Elementary, Scalar};

/// Damage as a number kept from step to step.
pub static DAMAGE: HistoryVariable = HistoryVariable {
    name: "damage",
    unit: "",
    initial: 0.0,
    bound: Bound::NonNegative,
    meaning: "damage of the material's law: 0 none, from 1 on integrity is lost",
};

/// When a particle lost the last of its integrity.
pub static FAILED_AT: HistoryVariable = HistoryVariable {
    name: "failed_at",
    unit: "s",
    initial: 0.0,
    bound: Bound::NonNegative,
    meaning: "time at which a particle lost the last of its integrity; 0 where it has some left",
};

/// What breaking has taken so far.
pub static FRACTURE_ENERGY: HistoryVariable = HistoryVariable {
    name: "fracture_energy",
    unit: "J/kg",
    initial: 0.0,
    bound: Bound::NonNegative,
    meaning: "energy that breaking has dissipated per mass: plastic work since the damage is one, and elastic energy lost with the integrity",
};

/// What a material with a law of damage keeps, in this order; its integrity comes behind.
pub static KEPT: [&HistoryVariable; 3] = [&DAMAGE, &FAILED_AT, &FRACTURE_ENERGY];

/// What a law of damage has to give.
pub trait DamageGrowth<T: Elementary>: Copy {
    /// Name in a deck.
    const KEY: &'static str;
    /// Name in a text.
    const NAME: &'static str;
    /// Where it is published.
    const REFERENCE: &'static str;
    /// The constants, in the order of `new`.
    const PARAMETERS: &'static [Parameter];
    /// Whether it depends on the temperature.
    const DEPENDS_ON_TEMPERATURE: bool = false;

    /// What is wrong with constants that do not fit together, or `None`.
    fn check(values: &[f64]) -> Option<&'static str>;
    /// From one value per parameter, SI units.
    fn new(values: &[f64]) -> Self;
    /// Damage per plastic strain in a state; where damage is a number of the stress, this number. Never negative.
    fn growth(&self, state: &DamageState<T>) -> T;
    /// Where damage is a number of the stress, so that it grows without plastic flow, too: stress at which it is one, Pa.
    #[inline(always)]
    fn strength(&self) -> Option<T> {
        None
    }
}

/// One over a failure strain, and a large number where the strain is not above zero.
#[inline(always)]
fn over_failure_strain<T: Elementary>(strain: T) -> T {
    let least = T::of(1e-12);
    T::one() / strain.max(least)
}

macro_rules! damage_laws {
    ($($law:ident,)*) => {
        /// The laws of damage a material can have.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum DamageLaw<T> {
            $(
                #[doc = concat!("See [`", stringify!($law), "`](struct@", stringify!($law), ").")]
                $law($law<T>),
            )*
        }

        /// Every law of damage, for the deck reader.
        pub const DAMAGE_LAWS: &[LawEntry<DamageLaw<f64>>] = &[
            $(LawEntry {
                key: <$law<f64> as DamageGrowth<f64>>::KEY,
                name: <$law<f64> as DamageGrowth<f64>>::NAME,
                reference: <$law<f64> as DamageGrowth<f64>>::REFERENCE,
                parameters: <$law<f64> as DamageGrowth<f64>>::PARAMETERS,
                history: &[],
                check: <$law<f64> as DamageGrowth<f64>>::check,
                build: |values| DamageLaw::$law(<$law<f64> as DamageGrowth<f64>>::new(values)),
            },)*
        ];

        impl<T: Elementary> DamageLaw<T> {
            /// Damage per plastic strain in a state; where the law has a [`Self::strength`], damage. Never negative.
            #[inline(always)]
            pub fn growth(&self, state: &DamageState<T>) -> T {
                match self { $(Self::$law(law) => law.growth(state),)* }
            }

            /// Where damage is a number of the stress, so that it grows without plastic flow, too: stress at which it is one, Pa.
            #[inline(always)]
            pub fn strength(&self) -> Option<T> {
                match self { $(Self::$law(law) => law.strength(),)* }
            }

            /// Whether damage depends on the temperature.
            pub fn depends_on_temperature(&self) -> bool {
                match self { $(Self::$law(_) => <$law<T> as DamageGrowth<T>>::DEPENDS_ON_TEMPERATURE,)* }
            }

            /// Name in a deck.
            pub fn key(&self) -> &'static str {
                match self { $(Self::$law(_) => <$law<T> as DamageGrowth<T>>::KEY,)* }
            }

            /// The same law in another precision.
            pub fn cast<U: Elementary>(&self) -> DamageLaw<U>
            where
                T: Scalar,
            {
                match self { $(Self::$law(law) => DamageLaw::$law(law.cast()),)* }
            }
        }
    };
}

damage_laws! {
    FailureStrain,
    JohnsonCookDamage,
    HancockMackenzie,
    CockcroftLatham,
    NormalisedCockcroftLatham,
    ModifiedMohrCoulomb,
    PrincipalStress,
}

#[cfg(test)]
mod tests;
