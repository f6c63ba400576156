//! Laws of a material: their keys and constants are those the laws themselves declare.

use crate::declare::{Named, Read};
use crate::expected::{Expected, Key, TableKeys};
use crate::quantity::QuantityKind;
use crate::scalar::Scalar;
use crate::value::{Choice, Choices, ScalarOr};
use crate::written::Written;
use sphorge_physics::{
    damage::DAMAGE_LAWS,
    eos::EQUATIONS_OF_STATE,
    flow::FLOW_LAWS,
    parameter::{LawEntry, Parameter},
};
use std::{borrow::Cow, marker::PhantomData, sync::LazyLock};

/// A table of laws a material can choose from.
pub(crate) trait LawTable: Choices<Value = usize> {
    type Law: 'static;
    const ENTRIES: &'static [LawEntry<Self::Law>];
    /// The laws as keys, their constants as keys of theirs.
    fn keys() -> &'static TableKeys;
}

macro_rules! laws {
    ($( $(#[doc = $comment:literal])* $word:ident, $what:literal, $law:ty, $entries:expr; )+) => { $(
        $(#[doc = $comment])*
        pub(crate) enum $word {}

        impl Choices for $word {
            type Value = usize;
            const NAME: &'static str = stringify!($word);
            const WHAT: &'static str = $what;
            fn table() -> Vec<(&'static str, usize, &'static str)> {
                Self::ENTRIES.iter().enumerate().map(|(index, entry)| (entry.key, index, entry.name)).collect()
            }
        }

        impl LawTable for $word {
            type Law = $law;
            const ENTRIES: &'static [LawEntry<Self::Law>] = $entries;
            fn keys() -> &'static TableKeys {
                static LAWS: LazyLock<Vec<TableKeys>> =
                    LazyLock::new(|| $entries.iter().map(|entry| constants($what, entry.key, entry.parameters)).collect());
                static TABLE: LazyLock<TableKeys> = LazyLock::new(|| TableKeys {
                    name: concat!(stringify!($word), "Table"),
                    comment: Cow::Borrowed(""),
                    keys: $entries.iter().zip(LAWS.iter()).map(|(entry, law)| one_law(entry, law)).collect(),
                });
                &TABLE
            }
        }
    )+ };
}

laws! {
    /// Equations of state by key.
    EquationOfStateWord, "equation of state", sphorge_physics::eos::EquationOfState<f64>, EQUATIONS_OF_STATE;
    /// Flow laws by key.
    StrengthWord, "flow law", sphorge_physics::flow::FlowLaw<f64>, FLOW_LAWS;
    /// Laws of damage by key.
    DamageWord, "law of damage", sphorge_physics::damage::DamageLaw<f64>, DAMAGE_LAWS;
}

fn one_law<L>(entry: &LawEntry<L>, law: &'static TableKeys) -> Key {
    Key {
        name: entry.key,
        comment: Cow::Owned(format!("{}: {}", entry.name, entry.reference)),
        expected: Expected::Law(law),
        required: false,
        example: None,
        default: None,
        otherwise: None,
    }
}

/// The constants of the law called `law` of a kind.
fn constants(what: &str, law: &str, parameters: &[Parameter]) -> TableKeys {
    // Laws of damage take these from the flow law.
    let is_shared = |key: &str| matches!(key, "melting-temperature" | "reference-strain-rate");
    let of_flow_law = |parameter: &Parameter| what == DamageWord::WHAT && is_shared(parameter.key);
    let key = |parameter: &Parameter| Key {
        name: parameter.key,
        comment: Cow::Owned(format!("{} ({})", parameter.meaning, parameter.symbol)),
        expected: Expected::Constant(QuantityKind::from(parameter.quantity)),
        required: false,
        example: None,
        default: parameter.default.filter(|_| !of_flow_law(parameter)).map(|value| Cow::Owned(format!("{value:?}"))),
        otherwise: match (parameter.default, parameter.key, law) {
            (Some(_), ..) if of_flow_law(parameter) => Some("that of the flow law, or 1"),
            _ if of_flow_law(parameter) => Some("that of the flow law; without `D5` none is needed"),
            (Some(_), ..) => None,
            (_, "density" | "young-modulus" | "reference-temperature", _) => Some("the material's"),
            (_, "sound-speed", "linear") => Some("from the elastic constants"),
            _ => Some("must be given"),
        },
    };
    TableKeys { name: "", comment: Cow::Borrowed(""), keys: parameters.iter().map(key).collect() }
}

/// A law by its name alone, or as a table of one law and its constants.
pub(crate) type RawLaw<C> = ScalarOr<Choice<C>, LawTableValue<C>>;

/// `{ law = { constant = value } }`.
pub(crate) struct LawTableValue<C>(pub(crate) Named<Named<Scalar>>, PhantomData<C>);

impl<C: LawTable> Read for LawTableValue<C> {
    const EXPECTED: &'static Expected = &Expected::Laws(C::keys);
    fn read(written: Written<'_>) -> Option<Self> {
        Some(Self(Named::read(written)?, PhantomData))
    }
}
