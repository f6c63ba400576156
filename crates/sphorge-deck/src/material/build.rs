//! A complete material of given constants, or what is missing.

use super::constants::{Constants, ElasticConstants, LawConstants};
use crate::defaults;
use sphorge_engine::model::Material;
use sphorge_engine::model::NO_HEATING;
use sphorge_physics::damage::{DAMAGE_LAWS, DEFAULT_SMALLEST_STRAIN, DEFAULT_SOFTENING, Damage, Softening};
use sphorge_physics::integrity::DEFAULT_OPENING;
use sphorge_physics::{
    eos::{EQUATIONS_OF_STATE, EquationOfState},
    flow::FLOW_LAWS,
    parameter::{LawEntry, Parameter},
};

/// A constant a material lacks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Missing {
    /// Key in a deck.
    pub(crate) key: &'static str,
    /// Table of the deck it belongs to, below `[material.NAME]`: empty, or `strength.johnson-cook`.
    pub(crate) table: String,
    /// Law that needs it, if one does.
    pub(crate) law: Option<&'static str>,
    /// What it is, with its unit.
    pub(crate) meaning: String,
    /// Key of the material that asks for it, where a user may have written one.
    pub(crate) beside: &'static str,
}

/// Why constants do not make a material.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Incomplete {
    /// These are not given.
    Missing(Vec<Missing>),
    /// These do not fit together.
    Inconsistent(Inconsistent),
}

/// What does not fit together, and what to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inconsistent {
    pub(crate) message: String,
    pub(crate) help: String,
    /// Keys of the material that have to do with it: `young-modulus`, or `strength.B` for a constant of its law.
    pub(crate) keys: Vec<String>,
}

impl Inconsistent {
    fn of(message: impl Into<String>, help: impl Into<String>, keys: &[&str]) -> Incomplete {
        let keys = keys.iter().map(|key| (*key).to_owned()).collect();
        Incomplete::Inconsistent(Self { message: message.into(), help: help.into(), keys })
    }

    /// What a law, at the key `kind`, says against its constants. Its own message names keys alone; which of them is wrong their values tell.
    fn of_law<L>(
        entry: &LawEntry<L>,
        kind: &str,
        message: &str,
        (given, constants): (&LawConstants, &Constants),
        values: &[f64],
    ) -> Incomplete {
        let words: Vec<&str> = message.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').collect();
        let named = entry.parameters.iter().zip(values).filter(|(parameter, _)| words.contains(&parameter.key));
        let (mut told, mut keys, mut has_units) = (Vec::new(), Vec::new(), false);
        for (Parameter { key, quantity, .. }, value) in named {
            let mut told_of = format!("`{key}` is {}", super::shown(*value, quantity.si_unit()));
            if given.get(key).is_some() {
                keys.push(format!("{kind}.{key}"));
            } else {
                let (whence, from) = source(key, constants);
                told_of += &whence;
                keys.extend(from);
            }
            told.push(told_of);
            has_units |= !quantity.si_unit().is_empty();
        }
        let units = if has_units { "; check the units: a number without one is in SI" } else { "" };
        let (message, help) = (format!("{}: {message}", entry.key), format!("{}{units}", told.join(", ")));
        Incomplete::Inconsistent(Self { message, help, keys })
    }

    /// A sound speed that leaves no second elastic constant.
    fn of_sound(constants: &Constants, law: &EquationOfState<f64>, density: f64) -> Incomplete {
        let sound = law.reference_sound_speed();
        let given = [
            ("young-modulus", constants.elastic.young, "Pa"),
            ("poisson-ratio", constants.elastic.poisson, ""),
            ("shear-modulus", constants.elastic.shear, "Pa"),
        ];
        let (key, value) = given
            .into_iter()
            .find_map(|(key, value, unit)| Some((key, super::shown(value?, unit))))
            .unwrap_or_default();
        let message = format!(
            "`sound-speed` of {} and `density` of {} make a bulk modulus of {:.3e} Pa, which `{key}` of {value} does not go with",
            super::shown(sound, "m/s"),
            super::shown(density, "kg/m^3"),
            density * sound * sound
        );
        let help = "check the units: a number without one is in SI, and sound speeds of metals are 1 to 13 km/s";
        Self::of(message, help, &["equation-of-state.sound-speed", key])
    }
}

/// Where a constant that a law does not give comes from: in words, after its value, and the keys of the material.
fn source(key: &str, constants: &Constants) -> (String, Vec<String>) {
    let elastic = constants.elastic.keys();
    match key {
        "young-modulus" if constants.elastic.young.is_none() => {
            let sound = constants.equation_of_state.as_ref().and_then(|law| law.get("sound-speed"));
            let mut from: Vec<String> = elastic.iter().map(|key| (*key).to_owned()).collect();
            let mut named: Vec<String> = from.iter().map(|key| format!("`{key}`")).collect();
            if let Some(sound) = sound.filter(|_| from.len() < 2) {
                named.insert(0, format!("`sound-speed` of {}", super::shown(sound, "m/s")));
                from.insert(0, "equation-of-state.sound-speed".to_owned());
            }
            (format!(" (from {})", named.join(" and ")), from)
        }
        "reference-temperature" if constants.reference_temperature.is_none() => {
            (" (by default)".to_owned(), Vec::new())
        }
        "young-modulus" | "density" | "reference-temperature" => (String::new(), vec![key.to_owned()]),
        "melting-temperature" | "reference-strain-rate" => {
            (" (of the flow law)".to_owned(), vec![format!("strength.{key}")])
        }
        _ => (" (by default)".to_owned(), Vec::new()),
    }
}

fn missing_key(key: &'static str, meaning: &str, law: Option<&'static str>, beside: &'static str) -> Missing {
    Missing { key, table: String::new(), law, meaning: meaning.to_owned(), beside }
}

/// The values of a law in the order of its parameters: given, derived from the material, or the default.
fn values<L>(
    entry: &LawEntry<L>,
    table: &'static str,
    given: &LawConstants,
    derived: &dyn Fn(&str) -> Option<f64>,
    missing: &mut Vec<Missing>,
) -> Option<Vec<f64>> {
    let value = |p: &Parameter| given.get(p.key).or_else(|| derived(p.key)).or(p.default);
    let before = missing.len();
    let beside = table;
    for parameter in entry.parameters.iter().filter(|p| value(p).is_none()) {
        let unit = parameter.quantity.si_unit();
        let unit = if unit.is_empty() { "a pure number".to_owned() } else { format!("in {unit}") };
        // What a material can give for all its laws is asked for there.
        let table = if super::constants_key(parameter.key) { String::new() } else { format!("{table}.{}", entry.key) };
        missing.push(Missing {
            key: parameter.key,
            table,
            law: Some(entry.key),
            meaning: format!("{} ({}), {unit}", parameter.meaning, parameter.symbol),
            beside,
        });
    }
    (missing.len() == before).then(|| entry.parameters.iter().filter_map(value).collect())
}

/// Makes a material; `name` is the name it goes by.
pub(crate) fn build(name: &str, constants: &Constants) -> Result<Material, Incomplete> {
    let mut missing = Vec::new();
    if constants.elastic.count() > 2 {
        return Err(Inconsistent::of(
            "more than two elastic constants are given, and two define the others",
            "keep two of `young-modulus`, `shear-modulus`, `bulk-modulus` and `poisson-ratio`; those of a `base` count, too",
            &constants.elastic.keys(),
        ));
    }
    let density = constants.density;
    if density.is_none() {
        missing.push(missing_key("density", "density at rest, in kg/m^3", None, ""));
    }
    let reference_temperature = constants.reference_temperature.unwrap_or(defaults::REFERENCE_TEMPERATURE);
    let elastic = constants.elastic.completed();
    if let Some(ElasticConstants { poisson: Some(nu), .. }) = elastic.filter(|e| !is_physical(e)) {
        return Err(Inconsistent::of(
            format!("the elastic constants give Poisson's ratio {nu:.4}; it must be above -1 and below 0.5"),
            "check their units: a number without one is in Pa; Young's modulus of a metal is about 2.6 times its shear modulus",
            &constants.elastic.keys(),
        ));
    }

    // Pressure: linear with K unless the material says otherwise.
    let bulk = elastic.and_then(|e| e.bulk).or(constants.elastic.bulk);
    let linear = LawConstants::default();
    let state = constants.equation_of_state.as_ref().unwrap_or(&linear);
    let state_entry = &EQUATIONS_OF_STATE[state.law];
    let lacks_pressure = constants.equation_of_state.is_none() && bulk.is_none();
    let lacks_second = lacks_pressure && constants.elastic.count() == 1;
    let state_values = if lacks_pressure {
        missing.push(match constants.elastic.keys()[..] {
            // What is asked for is the second of two.
            ["poisson-ratio"] => missing_key("young-modulus", "Young's modulus (E), in Pa", None, "poisson-ratio"),
            [given] => missing_key("poisson-ratio", "Poisson's ratio (nu), a pure number: steel has 0.3", None, given),
            _ => {
                let meaning = "pressure law; or give two elastic constants for the linear one";
                missing_key("equation-of-state", meaning, None, "")
            }
        });
        None
    } else {
        let derived = |key: &str| match (key, state_entry.key) {
            ("density", _) => density,
            ("sound-speed", "linear") => Some((bulk? / density?).sqrt()),
            _ => None,
        };
        // A density that is missing has been named already.
        let known = |key: &str| match key {
            "density" => density.or(Some(1.0)),
            "sound-speed" if density.is_none() && state_entry.key == "linear" => bulk,
            _ => derived(key),
        };
        values(state_entry, "equation-of-state", state, &known, &mut missing)
    };
    let state_values = state_values.filter(|_| density.is_some());
    if let Some((values, message)) = state_values.as_ref().and_then(|v| Some((v, (state_entry.check)(v)?))) {
        return Err(Inconsistent::of_law(state_entry, "equation-of-state", message, (state, constants), values));
    }
    let equation_of_state = state_values.map(|v| (state_entry.build)(&v));

    // With one elastic constant given, the bulk modulus of the pressure law is the second.
    let elastic = elastic.or_else(|| with_bulk_modulus(constants.elastic, equation_of_state.as_ref(), density));
    let Some(strength) = &constants.strength else {
        missing.push(missing_key("strength", "flow law, for example \"elastic\"", None, ""));
        return Err(Incomplete::Missing(missing));
    };
    let flow_entry = &FLOW_LAWS[strength.law];
    let derived = |key: &str| match key {
        "young-modulus" => elastic.and_then(|elastic| elastic.young).or(constants.elastic.young),
        "reference-temperature" => Some(reference_temperature),
        _ => None,
    };
    let flow_values = values(flow_entry, "strength", strength, &derived, &mut missing);
    if let Some((values, message)) = flow_values.as_ref().and_then(|v| Some((v, (flow_entry.check)(v)?))) {
        return Err(Inconsistent::of_law(flow_entry, "strength", message, (strength, constants), values));
    }
    let flow_law = flow_values.map(|v| (flow_entry.build)(&v));
    let of_flow = (
        reference_temperature,
        strength.get("reference-strain-rate"),
        flow_law.and_then(|law| law.melting_temperature()),
    );
    let damage = damage(constants, of_flow, &mut missing)?;
    if damage.is_some() && flow_law.is_some_and(|law| !law.has_shear() || law.is_hyperelastic()) {
        let message = format!("`damage` needs a flow law of metals, and `strength` is \"{}\"", flow_entry.key);
        return Err(Inconsistent::of(
            message,
            "choose a `strength` that yields, or \"elastic\", or leave `damage` out",
            &["damage", "strength"],
        ));
    }
    let has_shear = flow_law.as_ref().is_none_or(|law| law.has_shear());
    let shear_modulus = if has_shear { elastic.and_then(|e| e.shear).or(constants.elastic.shear) } else { Some(0.0) };
    // Young's modulus of a law follows from what is asked for.
    if shear_modulus.is_none() || lacks_second {
        missing.retain(|constant| constant.law.is_none() || constant.key != "young-modulus");
    }
    if shear_modulus.is_none() && !lacks_second {
        if let (1, None, Some(law), Some(density)) =
            (constants.elastic.count(), constants.elastic.bulk, &equation_of_state, density)
        {
            return Err(Inconsistent::of_sound(constants, law, density));
        }
        let meaning = "shear modulus (G), in Pa; or two elastic constants";
        missing.push(missing_key("shear-modulus", meaning, Some(flow_entry.key), "strength"));
    }
    match (density, shear_modulus, equation_of_state, flow_law) {
        (Some(density), Some(shear_modulus), Some(equation_of_state), Some(flow_law)) if missing.is_empty() => {
            Ok(Material {
                name: name.to_owned(),
                reference: constants.reference.clone().unwrap_or_default(),
                density,
                shear_modulus,
                equation_of_state,
                flow_law,
                return_rule: constants.return_rule.unwrap_or_default(),
                specific_heat: constants.specific_heat.unwrap_or(NO_HEATING),
                conductivity: constants.conductivity.unwrap_or(0.0),
                taylor_quinney: constants.taylor_quinney.unwrap_or(defaults::TAYLOR_QUINNEY),
                spall_pressure: constants.spall_pressure.unwrap_or(f64::INFINITY),
                spall_opening: constants.spall_opening.unwrap_or(DEFAULT_OPENING),
                damage,
                reference_temperature,
                mass_scaling: 1.0,
            })
        }
        _ => Err(Incomplete::Missing(missing)),
    }
}

/// Keys that each say how a material softens, and all that act with a law of damage alone.
const OF_SOFTENING: [&str; 3] = ["fracture-energy", "softening-displacement", "softening"];
const OF_BREAKING: [&str; 5] =
    ["fracture-energy", "softening-displacement", "softening", "minimum-failure-strain", "after-failure"];

/// How a material breaks, if it does. `of_flow` are its reference temperature (K), and the reference rate (1/s) and melting temperature (K) of its
/// flow law.
fn damage(
    constants: &Constants,
    (reference_temperature, rate, melting): (f64, Option<f64>, Option<f64>),
    missing: &mut Vec<Missing>,
) -> Result<Option<Damage<f64>>, Incomplete> {
    if constants.softening.count() > 1 {
        return Err(Inconsistent::of(
            "more than one of `fracture-energy`, `softening-displacement` and `softening` is given, and each says how it softens",
            "keep one of them; those of a `base` count, too",
            &OF_SOFTENING,
        ));
    }
    let Some(law) = constants.damage.as_ref().filter(|_| constants.breaks) else {
        let is_asked = constants.softening.count() > 0
            || constants.minimum_failure_strain.is_some()
            || constants.after_failure.is_some();
        if is_asked && !constants.breaks {
            return Err(Inconsistent::of(
                "`fracture-energy`, `softening-displacement`, `softening`, `minimum-failure-strain` and `after-failure` need a law of `damage`",
                match &constants.damage {
                    Some(law) => format!(
                        "its published constants of `{0}` act with `damage = \"{0}\"`",
                        DAMAGE_LAWS[law.law].key
                    ),
                    None => {
                        "add one, as in `damage = { failure-strain = { strain = 0.5 } }`, or leave them out".to_owned()
                    }
                },
                &OF_BREAKING,
            ));
        }
        return Ok(None);
    };
    let entry = &DAMAGE_LAWS[law.law];
    let is_cold = law.get("D5").is_none_or(|d5| d5 == 0.0);
    let derived = |key: &str| match key {
        "reference-temperature" => Some(reference_temperature),
        "reference-strain-rate" => rate,
        // Any will do where the temperature has no effect.
        "melting-temperature" => melting.or(is_cold.then_some(reference_temperature + 1.0)),
        _ => None,
    };
    let values = values(entry, "damage", law, &derived, missing);
    if let Some((values, message)) = values.as_ref().and_then(|v| Some((v, (entry.check)(v)?))) {
        return Err(Inconsistent::of_law(entry, "damage", message, (law, constants), values));
    }
    let softening = constants.softening;
    let softening = match (softening.energy, softening.displacement) {
        (Some(energy), _) => Softening::Energy(energy),
        (None, Some(displacement)) => Softening::Displacement(displacement),
        (None, None) => Softening::Share(softening.share.unwrap_or(DEFAULT_SOFTENING)),
    };
    Ok(values.map(|values| Damage {
        law: (entry.build)(&values),
        smallest_strain: constants.minimum_failure_strain.unwrap_or(DEFAULT_SMALLEST_STRAIN),
        softening,
        after: constants.after_failure.unwrap_or_default(),
    }))
}

fn is_physical(elastic: &ElasticConstants) -> bool {
    let poisson = elastic.poisson.is_some_and(|nu| nu > -1.0 && nu < 0.5);
    poisson && [elastic.young, elastic.shear, elastic.bulk].iter().all(|m| m.is_some_and(|m| m > 0.0 && m.is_finite()))
}

fn with_bulk_modulus(
    given: ElasticConstants,
    state: Option<&EquationOfState<f64>>,
    density: Option<f64>,
) -> Option<ElasticConstants> {
    let bulk = density? * state?.reference_sound_speed().powi(2);
    ElasticConstants { bulk: given.bulk.or(Some(bulk)), ..given }.completed().filter(is_physical)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphorge_physics::flow::FlowLaw;

    fn law(key: &str, values: &[(&'static str, f64)]) -> Option<LawConstants> {
        let law = FLOW_LAWS.iter().position(|entry| entry.key == key).unwrap();
        Some(LawConstants { law, values: values.to_vec() })
    }

    fn steel() -> Constants {
        Constants {
            density: Some(7850.0),
            elastic: ElasticConstants { young: Some(210e9), poisson: Some(0.3), ..Default::default() },
            strength: law("bilinear", &[("yield-stress", 350e6), ("tangent-modulus", 2e9)]),
            ..Default::default()
        }
    }

    #[test]
    fn two_elastic_constants_make_the_linear_pressure_and_reach_the_flow_law() {
        let material = build("steel", &steel()).unwrap();
        assert!((material.shear_modulus / (210e9 / 2.6) - 1.0).abs() < 1e-12);
        let c0 = material.equation_of_state.reference_sound_speed();
        assert!((7850.0 * c0 * c0 / (210e9 / 1.2) - 1.0).abs() < 1e-12);
        let FlowLaw::Bilinear(law) = material.flow_law else { panic!("bilinear expected") };
        assert!((law.yield_stress - 350e6).abs() < 1.0);
        assert!(!material.heats());
    }

    #[test]
    fn an_energy_below_absolute_zero_pulls_no_harder_than_none() {
        let law = EQUATIONS_OF_STATE.iter().position(|entry| entry.key == "mie-gruneisen").unwrap();
        let values = vec![("sound-speed", 4000.0), ("shock-slope", 1.5), ("gruneisen", 2.0)];
        let heated = |specific_heat| Constants {
            equation_of_state: Some(LawConstants { law, values: values.clone() }),
            elastic: ElasticConstants { shear: Some(80e9), ..Default::default() },
            specific_heat,
            reference_temperature: Some(300.0),
            ..steel()
        };
        let pressure = |material: &Material, energy: f64| material.pressure(7850.0, energy).pressure;
        // Gamma rho e at -400 300 J/kg; without specific heat at a hundredth of the square of the sound speed.
        for (specific_heat, least) in [(Some(400.0), 1.2e5), (None, 1.6e5)] {
            let material = build("steel", &heated(specific_heat)).unwrap();
            assert!((pressure(&material, -1e5) / -1.57e9 - 1.0).abs() < 1e-9);
            assert!((pressure(&material, -1e7) / (-2.0 * 7850.0 * least) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn what_spalls_says_at_which_tension_and_opening() {
        let given = Constants { spall_pressure: Some(1e9), spall_opening: Some(2e-5), ..steel() };
        let spall = build("steel", &given).unwrap().spall().unwrap();
        assert_eq!((spall.pressure, spall.opening, spall.density), (1e9, 2e-5, 7850.0));
        let spall = build("steel", &Constants { spall_opening: None, ..given }).unwrap().spall().unwrap();
        assert_eq!(spall.opening, 1e-4);
        assert_eq!(build("steel", &steel()).unwrap().spall(), None);
    }

    #[test]
    fn a_missing_constant_names_the_law_and_where_it_goes() {
        let constants =
            Constants { strength: law("johnson-cook", &[("A", 1e8), ("B", 1e8), ("n", 0.3), ("C", 0.01)]), ..steel() };
        let Err(Incomplete::Missing(missing)) = build("steel", &constants) else { panic!("incomplete expected") };
        let keys: Vec<_> = missing.iter().map(|m| (m.key, m.table.as_str(), m.law)).collect();
        assert_eq!(keys[0], ("m", "strength.johnson-cook", Some("johnson-cook")));
        assert_eq!(keys[1], ("melting-temperature", "strength.johnson-cook", Some("johnson-cook")));
        assert_eq!(keys.len(), 2);
    }

    #[test]
    fn a_law_that_softens_needs_no_specific_heat_where_nothing_heats() {
        let iron = [("A", 175e6), ("B", 380e6), ("n", 0.32), ("C", 0.06), ("m", 0.55), ("melting-temperature", 1811.0)];
        for (strength, reference_temperature) in
            [(law("johnson-cook", &iron), None), (law("johnson-cook", &iron), Some(600.0))]
        {
            let material = build("iron", &Constants { strength, reference_temperature, ..steel() }).unwrap();
            assert!(!material.heats() && material.flow_law.depends_on_temperature());
            // Bodies start at the reference temperature and stay there: no softening.
            let state = material.flow_state(0.0, material.reference_temperature, 7850.0, 0.0);
            assert_eq!(material.flow_law.yield_stress(state, &[]).value, 175e6);
        }
    }

    #[test]
    fn contradicting_elastic_constants_are_refused() {
        let elastic = ElasticConstants { shear: Some(80e9), ..steel().elastic };
        assert!(matches!(build("s", &Constants { elastic, ..steel() }), Err(Incomplete::Inconsistent(_))));
        let elastic = ElasticConstants { young: Some(210e9), shear: Some(60e9), ..Default::default() };
        assert!(matches!(build("s", &Constants { elastic, ..steel() }), Err(Incomplete::Inconsistent(_))));
    }
}
