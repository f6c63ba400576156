//! What a user should know of a material that can be used.

use super::breaking::breaking;
use super::constants::Constants;
use super::plausible::implausible;
use super::poisson::{
    OF_METALS, STATED_NEARLY, STATED_WITHIN, nearly_incompressible, poisson_ratio, ratio_of_waves, small_poisson_ratio,
};
use crate::suggest::listed;
use sphorge_engine::model::Material;

/// One sentence for each thing that is probably not meant.
pub(crate) fn advice(constants: &Constants, material: &Material) -> Vec<String> {
    let slip = slip_of_unit(constants, material);
    let odd = beyond_matter(constants, material, slip.is_some());
    // What a wrong density or modulus leads to is not told.
    let has_slip = slip.is_some() || odd.iter().any(|note| note.contains("no material has such a"));
    let ratio = if has_slip { None } else { poisson_ratio(constants, material) };
    let is_odd = |what: &&str| odd.iter().any(|note| note.contains(&format!("its {what} of")));
    let has_moduli =
        slip.is_none() && !["density", "shear modulus", "speed of sound", "`sound-speed`"].iter().any(is_odd);
    let told_of_constants = implausible(material, constants, has_moduli);
    let told = slip.into_iter().chain(ratio).chain(temperature(material));
    // What follows from a constant that has been told is not.
    let has_odd_law = material.damage.is_some_and(|damage| {
        let names = [format!("of `{}`", damage.law.key()), "`minimum-failure-strain`".to_owned()];
        told_of_constants.iter().any(|note| names.iter().any(|name| note.contains(name)))
    });
    let of_breaking = breaking(material, !has_odd_law);
    told.chain(odd).chain(told_of_constants).chain(of_breaking).collect()
}

/// Densities of metals, kg/m^3, from below lithium's to above osmium's.
const DENSITIES: (f64, f64) = (400.0, 25e3);
/// Speed of shear waves that no matter has, m/s: diamond has 12 km/s.
const FASTEST_SHEAR: f64 = 2e4;
/// Density from which on nothing is as soft as rubber, kg/m^3: wet soils have less.
const HEAVY: f64 = 2500.0;
/// Young's modulus below that of any metal, Pa: lithium has 5 GPa.
const SOFT: f64 = 1e8;
/// Young's moduli of metals, Pa, with room.
const MODULI: (f64, f64) = (1e9, 7e11);
/// Shear moduli of matter, Pa.
const STIFFNESS: (f64, f64) = (1.0, 5.6e11);
/// Flow stress over the shear modulus that no lattice bears.
const IDEAL_STRENGTH: f64 = 0.2;

/// A density or a modulus that is one of a metal in another unit.
fn slip_of_unit(constants: &Constants, material: &Material) -> Option<String> {
    let (name, density, shear) = (&material.name, material.density, material.shear_modulus);
    let within = |value: f64, (least, most): (f64, f64)| (least..=most).contains(&value);
    if shear == 0.0 {
        return None;
    }
    if within(1e3 * density, DENSITIES) && (shear / density).sqrt() > FASTEST_SHEAR {
        return Some(format!(
            "material `{name}`: a density of {density} kg/m^3 is that of a gas, and its shear modulus that of a solid: is \"{density} g/cm^3\" meant?"
        ));
    }
    if let Some(told) = slip_beside_shear(constants, material) {
        return Some(told);
    }
    let (given, modulus) = match constants.elastic.young {
        Some(young) => ("Young's modulus", young),
        None => ("shear modulus", shear),
    };
    let bears_too_much = flow_stress(material).is_some_and(|yields| yields > IDEAL_STRENGTH * shear);
    let is_soft = density >= HEAVY && 2.6 * shear < SOFT;
    let is_odd_ratio = poisson_ratio(constants, material).is_some();
    let stated = constants.elastic.completed().and_then(|elastic| elastic.poisson);
    let scaled = |factor: f64| Material { shear_modulus: factor * shear, ..material.clone() };
    let is_meant = |factor: &f64| {
        let (least, most) = match stated {
            Some(nu) => (nu - STATED_NEARLY, nu + STATED_NEARLY),
            // Published pressure laws and moduli go together within this.
            None => (OF_METALS.0 - STATED_WITHIN, OF_METALS.1 + STATED_WITHIN),
        };
        let of_metal = within(factor * 2.6 * shear, MODULI);
        // A pressure law of its own tells what the modulus is.
        of_metal && (!is_odd_ratio || within(ratio_of_waves(&scaled(*factor)), (least, most)))
    };
    let factor = [1e3, 1e6, 1e9].into_iter().find(is_meant);
    let factor = factor.filter(|_| bears_too_much || is_soft || (is_odd_ratio && density >= DENSITIES.0))?;
    let giga = (modulus * factor / 1e9 * 1e6).round() / 1e6;
    Some(format!(
        "material `{name}`: a {given} of {} is that of no metal with a density of {density} kg/m^3: is \"{giga} GPa\" meant?",
        super::shown(modulus, "Pa")
    ))
}

/// A modulus beside a shear modulus that goes with it in another unit alone.
fn slip_beside_shear(constants: &Constants, material: &Material) -> Option<String> {
    let shear = constants.elastic.shear?;
    let by_young = |young: f64| young / (2.0 * shear) - 1.0;
    let by_bulk = |bulk: f64| (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
    let (what, modulus, ratio): (_, _, &dyn Fn(f64) -> f64) = match (constants.elastic.young, constants.elastic.bulk) {
        (Some(young), None) => ("Young's modulus", young, &by_young),
        (None, Some(bulk)) => ("bulk modulus", bulk, &by_bulk),
        _ => return None,
    };
    let is_meant = |meant: &f64| (0.0..0.4999).contains(&ratio(*meant));
    let meant = [1e3, 1e6, 1e9].map(|factor| factor * modulus).into_iter().find(is_meant);
    let giga = |value: f64| (value / 1e9 * 1e6).round() / 1e6;
    meant.filter(|_| ratio(modulus) < 0.0).map(|meant| {
        format!(
            "material `{}`: a {what} of {} does not go with a shear modulus of {} GPa: is \"{} GPa\" meant?",
            material.name,
            super::shown(modulus, "Pa"),
            giga(shear),
            giga(meant)
        )
    })
}

/// Whether a note says that a density or a modulus is wrong, so that the speed of sound, and what is compared with it, is.
pub(crate) fn is_of_moduli(note: &str) -> bool {
    let is_of = |what: &str| note.contains(&format!("its {what} of"));
    ["that of no metal with", "that of a gas", "does not go with a shear"].iter().any(|words| note.contains(words))
        || (note.contains("no material has such a")
            && ["density", "shear modulus", "speed of sound", "`sound-speed`"].iter().any(|what| is_of(what)))
}

/// Stress at which a material yields as it starts, Pa, if it does.
pub(super) fn flow_stress(material: &Material) -> Option<f64> {
    let yields = material.yield_stress_at_rest(0.0, material.reference_temperature);
    (material.flow_law.yields() && yields.is_finite()).then_some(yields)
}

/// Constants beyond those of any solid or liquid by a factor of ten and more, which are slips of a unit.
fn beyond_matter(constants: &Constants, material: &Material, has_slip: bool) -> Vec<String> {
    let sound_speed = material.equation_of_state.reference_sound_speed();
    let heat = if material.heats() { material.specific_heat } else { 1000.0 };
    let given = |value: f64, (least, most): (f64, f64)| value == 0.0 || (least..=most).contains(&value);
    let values = [
        // Osmium has 22 590.
        ("density", material.density, (1.0, 2.3e4), "kg/m^3", "steel has \"7850 kg/m^3\", which is \"7.85e-9 t/mm^3\""),
        // Diamond has 535 GPa.
        ("shear modulus", material.shear_modulus, STIFFNESS, "Pa", "steel has \"80 GPa\""),
        // By the bulk modulus: diamond has 11.2 km/s, what hardly changes its volume more.
        ("speed of sound", sound_speed, (15.0, 1.8e4), "m/s", "steel has \"4600 m/s\""),
        ("specific heat", heat, (10.0, 2e4), "J/(kg K)", "steel has \"450 J/(kg K)\""),
        // Air has 0.026, diamond 3000.
        ("conductivity", material.conductivity, (1e-3, 1e4), "W/(m K)", "steel has \"45 W/(m K)\""),
        ("reference temperature", material.reference_temperature, (0.0, 1e5), "K", "a room has \"20 degC\""),
    ];
    let odd = values.into_iter().filter(|(_, value, range, ..)| !given(*value, *range));
    // A speed of sound follows from the density and the moduli.
    let is_dense =
        has_slip || values.iter().any(|(name, value, range, ..)| *name == "density" && !given(*value, *range));
    let soft = nearly_incompressible(constants, material);
    let follows = is_dense || soft.is_some();
    let mut told: Vec<String> = odd
        .filter(|(name, ..)| !follows || *name != "speed of sound")
        .filter(|(name, ..)| !has_slip || *name != "shear modulus")
        .map(|(name, value, _, unit, example)| {
            // A speed that the user wrote, or one that follows.
            let written = constants.equation_of_state.as_ref().and_then(|law| law.get("sound-speed"));
            let (of, unit) = match (name, written) {
                ("speed of sound", Some(_)) => ("`sound-speed`".to_owned(), unit.to_owned()),
                ("speed of sound", None) => {
                    (name.to_owned(), format!("{unit} (by density and {})", listed(constants.elastic.keys(), "and")))
                }
                _ => (name.to_owned(), unit.to_owned()),
            };
            format!(
                "material `{}`: check its {of} of {} {unit}: no material has such a {name}; a number without a unit is in SI, and {example}",
                material.name,
                super::shown(value, "")
            )
        })
        .collect();
    let is_odd_modulus = has_slip || !given(material.shear_modulus, STIFFNESS);
    if let Some(yields) = flow_stress(material).filter(|yields| {
        !is_odd_modulus && *yields > (0.5 * material.shear_modulus).max(super::plausible::BORNE_BY_SOFT)
    }) {
        told.push(format!(
            "material `{}` yields at {}, {:.1} times its shear modulus: no solid bears more than {IDEAL_STRENGTH} of it; check the unit",
            material.name,
            super::shown(yields, "Pa"),
            yields / material.shear_modulus
        ));
    }
    if !has_slip {
        told.extend(soft);
        told.extend(small_poisson_ratio(constants, material));
    }
    let stated = constants.elastic.completed().and_then(|elastic| elastic.poisson);
    if let Some(nu) = stated.filter(|nu| *nu < 0.0 && !has_slip) {
        told.push(format!(
            "material `{}`: its Poisson's ratio of {nu:.2} is negative, which no metal has: check the elastic constants",
            material.name
        ));
    }
    told
}

/// Without a specific heat work does not heat. That is chosen where no work turns to heat at all.
fn temperature(material: &Material) -> Option<String> {
    let isothermal = material.flow_law.depends_on_temperature() && !material.heats() && material.taylor_quinney > 0.0;
    isothermal.then(|| {
        format!(
            "material `{}` has no `specific-heat`: its temperature is constant, and `{}` does not soften with plastic flow; \
             set `taylor-quinney = 0` if this is intended",
            material.name,
            material.flow_law.key()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::{build, entries, entry};
    use super::*;

    fn advice_of(constants: &Constants) -> Vec<String> {
        advice(constants, &build("metal", constants).unwrap())
    }

    #[test]
    fn constants_of_no_matter_are_told() {
        let copper = entry("ofhc-copper").unwrap().clone();
        let with = |change: &dyn Fn(&mut Constants)| {
            let mut other = copper.clone();
            change(&mut other);
            advice_of(&other)
        };
        let told = with(&|c| c.specific_heat = Some(1e-300));
        assert!(
            told.len() == 1
                && told[0].contains("specific heat of 1e-300 J/(kg K): no material has such a specific heat"),
            "{told:?}"
        );
        assert!(with(&|c| c.density = Some(1e20)).iter().any(|text| text.contains("density of 1e20 kg/m^3")));
        assert_eq!(with(&|c| c.specific_heat = Some(100.0)), Vec::<String>::new());
        let mut foam = copper.clone();
        foam.elastic = Default::default();
        foam.elastic.shear = Some(4e10);
        foam.elastic.poisson = Some(-0.99);
        assert!(
            advice_of(&foam).iter().any(|text| text.contains("ratio of -0.99 is negative")),
            "{:?}",
            advice_of(&foam)
        );
        // No material of the catalogue is odd.
        for (name, constants) in entries() {
            // Some are of a part of the constants alone.
            if let Ok(material) = build(name, constants) {
                assert_eq!(beyond_matter(constants, &material, false), Vec::<String>::new(), "{name}");
                assert_eq!(slip_of_unit(constants, &material), None, "{name}");
            }
        }
    }

    #[test]
    fn a_yield_stress_that_no_lattice_bears_is_told() {
        let of = |stress: &str| {
            let strength = format!("{{ perfectly-plastic = {{ yield-stress = \"{stress}\" }} }}");
            notes_of("\"7850 kg/m^3\"", "\"210 GPa\"", "\"linear\"", &strength)
        };
        let told = of("500 GPa");
        assert!(
            told.len() == 1 && told[0].contains("yields at 5e11 Pa, 6.3 times its shear modulus: no solid bears"),
            "{told:?}"
        );
        assert_eq!(of("5 GPa"), [""; 0]);
        // Conductivity in W/(mm K) with the unit of SI.
        let copper = entry("ofhc-copper").unwrap().clone();
        for (conductivity, is_told) in [(45e3, true), (3000.0, false), (0.02, false), (1e-4, true)] {
            let told = advice_of(&Constants { conductivity: Some(conductivity), ..copper.clone() });
            assert_eq!(told.len(), usize::from(is_told), "{conductivity}: {told:?}");
        }
    }

    /// Notes on a material of a deck: density, Young's modulus, pressure law and strength as they are written.
    fn notes_of(density: &str, young: &str, law: &str, strength: &str) -> Vec<String> {
        let deck = format!(
            "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\", max-steps = 1 }}\n[material.m]\ndensity = \
             {density}\nyoung-modulus = {young}\npoisson-ratio = 0.33\nequation-of-state = {law}\nstrength = {strength}\n[[body]]\nname = \"b\"\n\
             material = \"m\"\nshape = {{ box = {{ min = [0, 0], max = [\"6 mm\", \"6 mm\"] }} }}\n"
        );
        let notes = crate::load_text("deck", &deck, &[]).unwrap_or_else(|report| panic!("{report}")).notes;
        notes.into_iter().filter(|note| note.contains("material `m`")).collect()
    }

    #[test]
    fn constants_of_metals_in_other_units_are_told_once() {
        let linear = "\"linear\"";
        let gruneisen = "{ mie-gruneisen = { sound-speed = \"5000 m/s\", shock-slope = 1.4, gruneisen = 2.0 } }";
        let elastic = "\"elastic\"";
        let yields = "{ perfectly-plastic = { yield-stress = \"120 MPa\" } }";
        let metal = ("\"2700 kg/m^3\"", "\"70 GPa\"");
        for law in [linear, gruneisen] {
            for strength in [elastic, yields] {
                assert_eq!(notes_of(metal.0, metal.1, law, strength), [""; 0], "{law} {strength}");
                for (density, young, meant) in [
                    (
                        "2.7",
                        metal.1,
                        "density of 2.7 kg/m^3 is that of a gas, and its shear modulus that of a solid: is \"2.7 g/cm^3\" meant?",
                    ),
                    (
                        metal.0,
                        "70000",
                        "Young's modulus of 70000 Pa is that of no metal with a density of 2700 kg/m^3: is \"70 GPa\" meant?",
                    ),
                    (metal.0, "\"70 MPa\"", "Young's modulus of 7e7 Pa"),
                    (metal.0, "70", "is \"70 GPa\" meant?"),
                ] {
                    let told = notes_of(density, young, law, strength);
                    assert!(told.len() == 1 && told[0].contains(meant), "{density} {young} {law} {strength}: {told:?}");
                }
            }
        }
        // Rubber, a resin, a foam, a soil, and the rings of density 1 that papers let collide.
        for (density, young, strength) in [
            ("1100", "\"1 MPa\"", elastic),
            ("1200", "\"2.4 GPa\"", yields),
            ("1200", "\"800 MPa\"", yields),
            ("30", "\"10 MPa\"", elastic),
            ("2000", "\"20 MPa\"", "{ perfectly-plastic = { yield-stress = \"20 kPa\" } }"),
            ("1", "\"10 MPa\"", elastic),
            ("7850", "\"210 GPa\"", yields),
        ] {
            assert_eq!(notes_of(density, young, linear, strength), [""; 0], "{density} {young}");
        }
        // Magnesium, by what it bears.
        let told = notes_of("1740", "\"45 MPa\"", linear, yields);
        assert!(told.len() == 1 && told[0].contains("is \"45 GPa\" meant?"), "{told:?}");
    }

    #[test]
    fn a_modulus_without_its_unit_is_told_once_whatever_goes_with_it() {
        let notes = |constants: &str, speed: f64| {
            let deck = format!(
                "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"20 us\", max-steps = 1 }}\n{constants}\n[[body]]\n\
                 name = \"b\"\nmaterial = \"armco-iron\"\nvelocity = [{speed}, 0]\nshape = {{ box = {{ min = [0, 0], max = [\"6 mm\", \"6 mm\"] }} }}\n"
            );
            crate::load_text("deck", &deck, &[]).unwrap_or_else(|report| panic!("{report}")).all_notes()
        };
        let own = "[material.armco-iron]\nequation-of-state = \"linear\"\n";
        for (constants, meant) in [
            (
                "young-modulus = 210000\npoisson-ratio = 0.3",
                "line 6: material `armco-iron`: a Young's modulus of 2.1e5 Pa is that of no",
            ),
            (
                "young-modulus = 210000\nshear-modulus = \"80 GPa\"",
                "does not go with a shear modulus of 80 GPa: is \"210 GPa\" meant?",
            ),
            ("bulk-modulus = 160000\nshear-modulus = \"80 GPa\"", "a bulk modulus of 1.6e5 Pa does not go with"),
            ("young-modulus = 210000\nbulk-modulus = \"160 GPa\"", "is \"210 GPa\" meant?"),
            ("shear-modulus = 80000\npoisson-ratio = 0.3", "line 6: "),
        ] {
            // So fast that a body would be told to exceed the speed of sound that follows.
            for speed in [0.0, 200.0] {
                let told = notes(&format!("{own}{constants}"), speed);
                assert!(told.len() == 1 && told[0].contains(meant), "{constants} {speed}: {told:?}");
            }
        }
        // With the pressure law of the catalogue.
        let told = notes("[material.armco-iron]\nshear-modulus = 80000", 200.0);
        assert!(told.len() == 1 && told[0].contains("is \"80 GPa\" meant?"), "{told:?}");
    }

    #[test]
    fn a_metal_that_cannot_warm_is_told_unless_it_is_meant() {
        let mut copper = entry("ofhc-copper").unwrap().clone();
        assert_eq!(advice_of(&copper), Vec::<String>::new());
        copper.specific_heat = None;
        let told = advice_of(&copper);
        assert!(told.len() == 1 && told[0].contains("`johnson-cook` does not soften"), "{told:?}");
        copper.taylor_quinney = Some(0.0);
        assert_eq!(advice_of(&copper), Vec::<String>::new());
        // A law that temperature does not change needs none.
        copper.taylor_quinney = None;
        copper.strength = entry("copper-piston").unwrap().strength.clone();
        assert_eq!(advice_of(&copper), Vec::<String>::new());
    }
}
