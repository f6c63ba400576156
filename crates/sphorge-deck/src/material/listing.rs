//! A material of the catalogue for people: every constant with its letter, unit and meaning, and what is not given.

use super::advice::advice;
use super::build::{Incomplete, build};
use super::constants::{Constants, LawConstants};
use crate::defaults::REFERENCE_TEMPERATURE;
use sphorge_physics::{
    damage::DAMAGE_LAWS,
    eos::EQUATIONS_OF_STATE,
    flow::FLOW_LAWS,
    parameter::{LawEntry, Parameter},
};

/// One constant.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstantLine {
    /// Key in a deck.
    pub key: &'static str,
    /// Letter in the formulas.
    pub symbol: &'static str,
    /// Value in SI units; `None` if it is not given.
    pub value: Option<f64>,
    /// SI unit, empty for a pure number.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
}

/// A law with its constants.
#[derive(Clone, Debug, PartialEq)]
pub struct LawListing {
    /// Name in a deck.
    pub key: &'static str,
    /// Name in a text.
    pub name: &'static str,
    /// Where the law is published.
    pub reference: &'static str,
    /// The constants in the order of the law.
    pub constants: Vec<ConstantLine>,
}

/// A material of the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialListing {
    /// Name in a deck.
    pub name: String,
    /// Description of the material.
    pub description: String,
    /// Where the constants are published.
    pub reference: String,
    /// What a user has to know; may be empty.
    pub note: String,
    /// What is doubtful about the constants.
    pub doubts: Vec<String>,
    /// Constants that belong to no law.
    pub constants: Vec<ConstantLine>,
    /// Pressure law; `None` if not given and not derivable from elastic constants.
    pub equation_of_state: Option<LawListing>,
    /// Flow law.
    pub strength: Option<LawListing>,
    /// Law of damage, by which the material breaks if a deck says so.
    pub damage: Option<LawListing>,
    /// What a deck has to add before the material can be used, with the table it goes to; empty for a complete material.
    pub missing: Vec<String>,
}

fn law<L>(entry: &LawEntry<L>, given: &LawConstants, material: &Constants) -> LawListing {
    // Constants a material states once for all its laws.
    let shared = |key: &str| match key {
        "density" => material.density,
        "young-modulus" => material.elastic.completed()?.young,
        "reference-temperature" => material.reference_temperature.or(Some(REFERENCE_TEMPERATURE)),
        "sound-speed" if entry.key == "linear" => {
            Some((material.elastic.completed()?.bulk? / material.density?).sqrt())
        }
        _ => None,
    };
    let line = |p: &Parameter| ConstantLine {
        key: p.key,
        symbol: p.symbol,
        value: given.get(p.key).or_else(|| shared(p.key)).or(p.default),
        unit: p.quantity.si_unit(),
        meaning: p.meaning,
    };
    LawListing {
        key: entry.key,
        name: entry.name,
        reference: entry.reference,
        constants: entry.parameters.iter().map(line).collect(),
    }
}

/// The listing of one entry of the catalogue.
pub(super) fn listing(name: &str, constants: &Constants) -> MaterialListing {
    let line = |key, symbol, value, unit, meaning| ConstantLine { key, symbol, value, unit, meaning };
    let all = [
        line("density", "rho_0", constants.density, "kg/m^3", "density at rest"),
        line("shear-modulus", "G", constants.elastic.shear, "Pa", "shear modulus"),
        line("young-modulus", "E", constants.elastic.young, "Pa", "Young's modulus"),
        line("poisson-ratio", "nu", constants.elastic.poisson, "", "Poisson's ratio"),
        line("bulk-modulus", "K", constants.elastic.bulk, "Pa", "bulk modulus"),
        line("specific-heat", "Cp", constants.specific_heat, "J/(kg K)", "specific heat"),
        line("conductivity", "k", constants.conductivity, "W/(m K)", "thermal conductivity"),
        line("taylor-quinney", "beta", constants.taylor_quinney, "", "share of plastic work that heats"),
        line("spall-pressure", "p_s", constants.spall_pressure, "Pa", "tension at which it spalls"),
        line("spall-opening", "delta", constants.spall_opening, "m", "opening at which a crack bears no tension"),
        line(
            "reference-temperature",
            "T_0",
            constants.reference_temperature,
            "K",
            "temperature of zero internal energy",
        ),
    ];
    let built = build(name, constants);
    let doubts = built.as_ref().map(|material| advice(constants, material)).unwrap_or_default();
    let missing = match built {
        Ok(_) => Vec::new(),
        Err(Incomplete::Inconsistent(of)) => vec![of.message],
        Err(Incomplete::Missing(missing)) => missing
            .into_iter()
            .map(|m| {
                let key = if m.table.is_empty() { m.key.to_owned() } else { format!("{}.{}", m.table, m.key) };
                format!("{key}: {}", m.meaning)
            })
            .collect(),
    };
    // Elastic constants alone give the linear law.
    let linear = constants.elastic.completed().map(|_| LawConstants::default());
    let state = constants.equation_of_state.clone().or(linear);
    MaterialListing {
        name: name.to_owned(),
        description: constants.description.clone().unwrap_or_default(),
        reference: constants.reference.clone().unwrap_or_default(),
        note: constants.note.clone().unwrap_or_default(),
        doubts,
        constants: all.into_iter().filter(|line| line.value.is_some()).collect(),
        equation_of_state: state.as_ref().map(|c| law(&EQUATIONS_OF_STATE[c.law], c, constants)),
        strength: constants.strength.as_ref().map(|c| law(&FLOW_LAWS[c.law], c, constants)),
        damage: constants.damage.as_ref().map(|c| law(&DAMAGE_LAWS[c.law], c, constants)),
        missing,
    }
}
