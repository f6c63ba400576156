//! Materials: the same keys in a deck and in the catalogue.

use super::super::{choice::*, value::*};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use sphorge_physics::{eos::EQUATIONS_OF_STATE, flow::FLOW_LAWS, parameter::LawEntry};
use std::{borrow::Cow, collections::BTreeMap};
use toml::Spanned;

/// A material. Of the elastic constants, two give the others.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RawMaterial {
    /// Material to start from; a material named as one of the catalogue starts from that.
    #[schemars(extend("examples" = ["armco-iron"], "x-default" = "the catalogue's material of this name, if any"))]
    pub(crate) base: Option<Word>,
    /// What the material is.
    #[schemars(extend("examples" = ["4340 steel, Rockwell C 30"], "default" = ""))]
    pub(crate) description: Option<Word>,
    /// Where the constants come from.
    #[schemars(extend("examples" = ["Johnson & Cook 1983"], "default" = ""))]
    pub(crate) reference: Option<Word>,
    /// What a user has to know, such as constants that are not published.
    #[schemars(extend("examples" = ["no equation of state"], "default" = ""))]
    pub(crate) note: Option<Word>,
    /// Density at rest.
    #[schemars(extend("examples" = ["7890 kg/m^3"], "x-default" = "must be given"))]
    pub(crate) density: Option<Given<Density>>,
    /// Shear modulus G.
    #[schemars(extend("examples" = ["80 GPa"], "x-default" = "from two of them"))]
    pub(crate) shear_modulus: Option<Given<Stress>>,
    /// Young's modulus E.
    #[schemars(extend("examples" = ["210 GPa"], "x-default" = "from two of them"))]
    pub(crate) young_modulus: Option<Given<Stress>>,
    /// Poisson's ratio nu.
    #[schemars(extend("examples" = [0.3], "x-default" = "from two of them"))]
    pub(crate) poisson_ratio: Option<Given<Number>>,
    /// Bulk modulus K.
    #[schemars(extend("examples" = ["170 GPa"], "x-default" = "from two of them"))]
    pub(crate) bulk_modulus: Option<Given<Stress>>,
    /// Pressure law.
    #[schemars(extend("examples" = [{ "mie-gruneisen": { "sound-speed": "3630 m/s", "shock-slope": 1.8, "gruneisen": 1.81 } }], "default" = "linear"))]
    pub(crate) equation_of_state: Option<RawLaw<EquationOfStateWord>>,
    /// Flow law.
    #[schemars(extend("examples" = [{ "perfectly-plastic": { "yield-stress": "350 MPa" } }], "x-default" = "must be given"))]
    pub(crate) strength: Option<RawLaw<StrengthWord>>,
    /// How the trial stress returns to the yield surface.
    #[schemars(extend("examples" = ["benz-asphaug"], "default" = "radial-return"))]
    pub(crate) return_rule: Option<Choice<ReturnRuleWord>>,
    /// Specific heat; without it the temperature stays.
    #[schemars(extend("examples" = ["452 J/(kg K)"], "x-default" = "none: the temperature stays"))]
    pub(crate) specific_heat: Option<Given<SpecificHeat>>,
    /// Thermal conductivity.
    #[schemars(extend("examples" = ["80.2 W/(m K)"], "default" = 0.0))]
    pub(crate) conductivity: Option<Given<Conductivity>>,
    /// Share of plastic work that heats (Taylor & Quinney), 0 to 1.
    #[schemars(extend("examples" = [0.9], "default" = 0.9))]
    pub(crate) taylor_quinney: Option<Given<Number>>,
    /// Tension the material bears before it spalls, above zero: the pressure is cut off at its negative, in every pressure law. The
    /// deviator is not touched.
    #[schemars(extend("examples" = ["1.2 GPa"], "x-default" = "none: any tension"))]
    pub(crate) spall_pressure: Option<Given<Stress>>,
    /// Temperature at which the internal energy is zero and at which bodies start unless they say otherwise.
    #[schemars(extend("examples" = ["20 degC"], "default" = "293.15 K"))]
    pub(crate) reference_temperature: Option<Given<Temperature>>,
}

/// A table of laws a material can choose from.
pub(crate) trait LawTable: Choices<Value = usize> {
    type Law: 'static;
    /// What the law is, for people.
    const ENTRIES: &'static [LawEntry<Self::Law>];
}

/// Equations of state by key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum EquationOfStateWord {}
/// Flow laws by key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum StrengthWord {}

impl LawTable for EquationOfStateWord {
    type Law = sphorge_physics::eos::EquationOfState<f64>;
    const ENTRIES: &'static [LawEntry<Self::Law>] = EQUATIONS_OF_STATE;
}
impl LawTable for StrengthWord {
    type Law = sphorge_physics::flow::FlowLaw<f64>;
    const ENTRIES: &'static [LawEntry<Self::Law>] = FLOW_LAWS;
}

macro_rules! law_choices {
    ($word:ident, $what:literal) => {
        impl Choices for $word {
            type Value = usize;
            const NAME: &'static str = stringify!($word);
            const WHAT: &'static str = $what;
            fn table() -> Vec<(&'static str, usize, &'static str)> {
                Self::ENTRIES.iter().enumerate().map(|(index, entry)| (entry.key, index, entry.name)).collect()
            }
        }
    };
}
law_choices!(EquationOfStateWord, "equation of state");
law_choices!(StrengthWord, "flow law");

/// Constants of a law as written: key, value.
pub(crate) type RawConstants = BTreeMap<Spanned<String>, Scalar>;

/// A law by its name alone, or as a table of one law and its constants.
pub(crate) type RawLaw<C> = ScalarOr<Choice<C>, LawTableValue<C>>;

/// `{ law = { constant = value } }`.
#[derive(Clone, Debug)]
pub(crate) struct LawTableValue<C>(pub(crate) BTreeMap<Spanned<String>, RawConstants>, std::marker::PhantomData<C>);

impl<'de, C> Deserialize<'de> for LawTableValue<C> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        BTreeMap::deserialize(deserializer).map(|laws| Self(laws, std::marker::PhantomData))
    }
}

impl<C: LawTable> JsonSchema for LawTableValue<C> {
    fn schema_name() -> Cow<'static, str> {
        format!("{}Table", C::NAME).into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut laws = serde_json::Map::new();
        for entry in C::ENTRIES {
            let mut constants = serde_json::Map::new();
            for parameter in entry.parameters {
                let kind = super::super::quantity::QuantityKind::from(parameter.quantity);
                let mut schema = json_schema!({
                    "description": format!("{} ({})", parameter.meaning, parameter.symbol),
                    "type": ["number", "string"],
                    "x-unit": kind.si_unit,
                });
                let given = match (parameter.key, entry.key) {
                    ("density" | "young-modulus" | "reference-temperature", _) => Some("the material's"),
                    ("sound-speed", "linear") => Some("from the elastic constants"),
                    _ => None,
                };
                match (parameter.default, given) {
                    (Some(default), _) => schema.insert("default".to_owned(), default.into()),
                    (None, Some(given)) => schema.insert("x-default".to_owned(), given.into()),
                    (None, None) => schema.insert("x-default".to_owned(), "must be given".into()),
                };
                constants.insert(parameter.key.to_owned(), schema.to_value());
            }
            let description = format!("{}: {}", entry.name, entry.reference);
            laws.insert(
                entry.key.to_owned(),
                serde_json::json!({
                    "description": description, "type": "object", "properties": constants, "additionalProperties": false,
                }),
            );
        }
        json_schema!({ "type": "object", "properties": laws, "additionalProperties": false, "maxProperties": 1 })
    }
}
