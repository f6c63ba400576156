//! Constants that are possible, and beyond those of any metal, polymer, rock or liquid: slips of a unit or of a factor. Each constant of a
//! law and each of breaking has a kind, each kind its range.

use super::constants::{Constants, LawConstants};
use super::shown;
use sphorge_engine::model::Material;
use sphorge_physics::damage::DAMAGE_LAWS;
use sphorge_physics::eos::EQUATIONS_OF_STATE;
use sphorge_physics::flow::FLOW_LAWS;
use sphorge_physics::parameter::LawEntry;

/// What a range is a multiple of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// One: the range is in SI units.
    Si,
    /// The shear modulus, since stresses that a solid bears are a share of its stiffness.
    Shear,
    /// The shear modulus of a solid, the bulk modulus of a liquid.
    Stiffness,
}

/// Range of constants of one kind. Zero, where a law allows it, leaves a term out and is in all of them; what may be negative is
/// judged by its magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    least: f64,
    most: f64,
    scale: Scale,
    /// What is published.
    published: &'static str,
}

const fn number(least: f64, most: f64, published: &'static str) -> Range {
    Range { least, most, scale: Scale::Si, published }
}

/// Stress above which softness alone explains no value, Pa: rubber bears more than its shear modulus, but none bears this.
pub(super) const BORNE_BY_SOFT: f64 = 2e8;

/// Stresses beside the yield stress. Athermal parts of pure single crystals are 2e-5 of the shear modulus, hardening of steels that
/// transform 0.04, of polymers up to 0.3.
const STRESS: Range = Range {
    least: 1e-5,
    most: 1.0,
    scale: Scale::Shear,
    published: "metals have 10 MPa to 10 GPa, polymers 1 to 500 MPa",
};
/// Slopes of hardening. Metals have 1e-3 to 0.3 of the shear modulus; a small one in place of none is usual.
const SLOPE: Range = Range {
    least: 1e-6,
    most: 2.0,
    scale: Scale::Shear,
    published: "metals have 10 MPa to 30 GPa, and 0 is no hardening",
};
/// Young's modulus in a flow law: 2 to 3 times the shear modulus.
const YOUNG: Range = Range {
    least: 0.5,
    most: 10.0,
    scale: Scale::Shear,
    published: "it is 2 to 3 times the shear modulus of the material",
};
/// Plastic work per volume: a yield stress times a strain. Brittle steels have 1e-4 of the shear modulus, polymers 0.5.
const WORK: Range = Range {
    least: 2e-5,
    most: 5.0,
    scale: Scale::Shear,
    published: "metals have 10 MPa to 5 GPa, polymers 1 to 500 MPa",
};
/// Tensions at which solids part, or liquids boil: concrete and rocks have 1e-4 of the shear modulus, metals 4e-3 to 0.1; water at 20 degC
/// 1e-6 of its bulk modulus.
const TENSION: Range = Range {
    least: 5e-5,
    most: 2.0,
    scale: Scale::Stiffness,
    published: "metals have 0.1 to 20 GPa, liquids 1 kPa to 100 MPa",
};
/// The least of liquids over their bulk modulus.
const LEAST_OF_LIQUIDS: f64 = 1e-7;

/// Plastic strains to failure: ceramics 1e-3, soft copper at Johnson and Cook's 5.4.
const STRAIN: Range = number(1e-5, 10.0, "metals have 0.01 to 5; it is a number, no percentage");
/// Parts of a failure strain, which add up.
const PART_OF_STRAIN: Range = number(1e-5, 100.0, "metals have 0.01 to 20; it is a number, no percentage");
/// Plastic strains of what was done to a metal before: cold drawing 1 to 3.
const EARLIER_STRAIN: Range = number(1e-6, 10.0, "metals have 0.001 to 3; it is a number, no percentage");
/// Floor of a failure strain.
const LEAST_STRAIN: Range = number(1e-9, 1.0, "0.001 to 0.1 are usual; it is a number, no percentage");
/// Hardening exponents: tungsten alloys 0.12, metals after Steinberg from 0.05 on, polycarbonate 2.
const HARDENING_EXPONENT: Range = number(0.005, 3.0, "metals have 0.05 to 1, polymers up to 2");
/// Exponents of thermal softening.
const SOFTENING_EXPONENT: Range = number(0.05, 5.0, "metals have 0.5 to 2.5");
/// Coefficients of the logarithm of the rate, and exponents of the rate: lead and polymers have 0.1 to 0.2.
const RATE: Range = number(1e-6, 0.3, "metals have 0.001 to 0.1");
/// Exponents of the triaxiality: -0.47 to -6 are published, -22 of a tungsten alloy.
const TRIAXIALITY: Range = number(1e-4, 50.0, "metals have 0.3 to 10");
/// Effect of the rate on the failure strain.
const RATE_OF_FAILURE: Range = number(1e-7, 1.0, "metals have 0.001 to 0.1");
/// Effect of the temperature on it.
const HEAT_OF_FAILURE: Range = number(1e-4, 30.0, "metals have 0.3 to 5");
/// Coulomb friction of the law of Mohr and Coulomb.
const FRICTION: Range = number(1e-5, 1.0, "metals have 0.01 to 0.4");
/// Share of the strength of axial symmetry that shear has.
const SHEAR_SHARE: Range = number(0.1, 2.0, "metals have 0.8 to 1.1");
/// Slope of shock over particle velocity.
const SHOCK_SLOPE: Range = number(0.05, 5.0, "metals have 0.9 to 2.6, water 1.9");
/// Water at 4 degC is near zero, tin 2.3, gold 3.1.
const GRUNEISEN: Range = number(0.01, 6.0, "metals have 0.9 to 3.1");
/// Correction of that with the volume.
const GRUNEISEN_CORRECTION: Range = number(0.01, 10.0, "metals have 0.5 to 3");
/// Factor of Steinberg's hardening: beryllium 26, uranium 2000.
const HARDENING_FACTOR: Range = number(1e-2, 1e5, "metals have 2 to 2000");
/// Stiffening by pressure: tungsten 1e-11, lead 1.2e-10.
const BY_PRESSURE: Range = number(1e-13, 1e-8, "metals have 1e-11 to 2e-10 /Pa, which is 1 to 20 /Mbar");
/// Weakening of the shear modulus by heat: tungsten 1.4e-4, lead 1.2e-3.
const BY_HEAT: Range = number(1e-6, 0.02, "metals have 1e-4 to 2e-3 /K");
/// Thermal activation: copper 0.0028, iron 0.007.
const ACTIVATION: Range = number(1e-5, 0.1, "metals have 0.001 to 0.01 /K");
/// What the rate takes off it: copper 1.2e-4, iron 4.2e-4.
const ACTIVATION_BY_RATE: Range = number(1e-7, 0.01, "metals have 1e-5 to 1e-3 /K");
/// Rates that laws refer to: creep tests to bars of Hopkinson.
const REFERENCE_RATE: Range = number(1e-8, 2e5, "tests are made at 1e-5 to 1e4 /s");
/// Mercury melts at 234 K, tungsten after Steinberg at 4520 K.
const MELTING: Range = number(200.0, 6000.0, "metals melt between 234 K and 3700 K");
/// Temperatures of tests.
const TEST_TEMPERATURE: Range = number(0.0, 3000.0, "tests are made near 293 K");

/// Plastic work of a crack, J/m^2: glass and ceramics have 1 to 100, concrete 100, tough steels 1e6.
const CRACK: Range = number(0.3, 5e6, "metals have 1 kJ/m^2 to 1 MJ/m^2");
/// Of what is as stiff and as strong as a metal: tungsten has 250.
const CRACK_OF_METAL: f64 = 100.0;
/// Shear modulus and yield stress of metals in structures, Pa, above those of concrete.
const METAL: [f64; 2] = [1e10, 5e7];
/// Openings of cracks, m.
const OPENING: Range = number(1e-9, 0.02, "metals have 1 um to 5 mm");
/// Over which share of the failure strain something softens.
const SOFTENING: Range = number(1e-4, 10.0, "0.05 to 1 are usual; it is a number, no percentage");

/// Constants that all of a flow law shows, or that are judged as those of the material: the stress at which it yields, the speed of sound.
const ELSEWHERE: [(&str, &str); 11] = [
    ("perfectly-plastic", "yield-stress"),
    ("bilinear", "yield-stress"),
    ("johnson-cook", "A"),
    ("modified-johnson-cook", "A"),
    ("steinberg-guinan", "yield-stress"),
    ("linear", "density"),
    ("linear", "sound-speed"),
    ("mie-gruneisen", "density"),
    ("mie-gruneisen", "sound-speed"),
    ("mie-gruneisen-polynomial", "density"),
    ("mie-gruneisen-polynomial", "sound-speed"),
];

/// The range of a constant of a law: `*` stands for all laws that have it with this meaning and no line of their own.
const OF_LAWS: &[(&str, &str, Range)] = &[
    ("steinberg-guinan", "A", BY_PRESSURE),
    ("steinberg-guinan", "B", BY_HEAT),
    ("steinberg-guinan", "largest-yield-stress", STRESS),
    ("steinberg-guinan", "beta", HARDENING_FACTOR),
    ("steinberg-guinan", "a", GRUNEISEN_CORRECTION),
    ("steinberg-guinan", "initial-plastic-strain", EARLIER_STRAIN),
    ("bilinear", "young-modulus", YOUNG),
    ("bilinear", "tangent-modulus", SLOPE),
    ("modified-mohr-coulomb", "A", STRESS),
    ("modified-mohr-coulomb", "c1", FRICTION),
    ("modified-mohr-coulomb", "c2", STRESS),
    ("modified-mohr-coulomb", "c3", SHEAR_SHARE),
    ("cockcroft-latham", "work", WORK),
    ("principal-stress", "strength", TENSION),
    ("hancock-mackenzie", "factor", STRAIN),
    ("hancock-mackenzie", "exponent", TRIAXIALITY),
    ("*", "strain", STRAIN),
    ("*", "B", STRESS),
    ("*", "n", HARDENING_EXPONENT),
    ("*", "C", RATE),
    ("*", "m", SOFTENING_EXPONENT),
    ("*", "C0", STRESS),
    ("*", "C1", STRESS),
    ("*", "C2", STRESS),
    ("*", "C5", STRESS),
    ("*", "C3", ACTIVATION),
    ("*", "C4", ACTIVATION_BY_RATE),
    ("*", "D1", PART_OF_STRAIN),
    ("*", "D2", PART_OF_STRAIN),
    ("*", "D3", TRIAXIALITY),
    ("*", "D4", RATE_OF_FAILURE),
    ("*", "D5", HEAT_OF_FAILURE),
    ("*", "reference-strain-rate", REFERENCE_RATE),
    ("*", "lowest-strain-rate", REFERENCE_RATE),
    ("*", "reference-temperature", TEST_TEMPERATURE),
    ("*", "melting-temperature", MELTING),
    ("*", "shock-slope", SHOCK_SLOPE),
    ("*", "gruneisen", GRUNEISEN),
];

fn range(law: &str, key: &str) -> Option<Range> {
    let of = |name: &str| OF_LAWS.iter().find(|row| row.0 == name && row.1 == key).map(|row| row.2);
    if ELSEWHERE.contains(&(law, key)) { None } else { of(law).or_else(|| of("*")) }
}

/// A constant with what is to be said of it.
struct Judged {
    /// As it is named to the user.
    name: String,
    value: f64,
    unit: &'static str,
    range: Range,
}

/// One note for each constant outside of its range. Without `has_moduli` the density or a modulus has been told, and nothing is compared
/// with them.
pub(super) fn implausible(material: &Material, constants: &Constants, has_moduli: bool) -> Vec<String> {
    let mut judged = Vec::new();
    of_law(EQUATIONS_OF_STATE, constants.equation_of_state.as_ref(), &mut judged);
    of_law(FLOW_LAWS, constants.strength.as_ref(), &mut judged);
    let breaks = material.damage.is_some();
    of_law(DAMAGE_LAWS, constants.damage.as_ref().filter(|_| breaks), &mut judged);
    let is_metal = material.shear_modulus >= METAL[0] && super::advice::flow_stress(material) >= Some(METAL[1]);
    let crack = Range { least: if is_metal { CRACK_OF_METAL } else { CRACK.least }, ..CRACK };
    let tension = match material.shear_modulus {
        0.0 => Range { least: LEAST_OF_LIQUIDS, ..TENSION },
        _ => TENSION,
    };
    let softening = constants.softening;
    let of_breaking = [
        ("spall-pressure", constants.spall_pressure, "Pa", tension),
        ("spall-opening", constants.spall_opening, "m", OPENING),
        ("fracture-energy", softening.energy, "J/m^2", crack),
        ("softening-displacement", softening.displacement, "m", OPENING),
        ("softening", softening.share, "", SOFTENING),
        ("minimum-failure-strain", constants.minimum_failure_strain, "", LEAST_STRAIN),
    ];
    judged.extend(
        of_breaking.into_iter().filter_map(|(key, value, unit, range)| {
            Some(Judged { name: format!("`{key}`"), value: value?, unit, range })
        }),
    );
    judged.into_iter().filter_map(|of| note(material, &of, has_moduli)).collect()
}

fn of_law<L>(table: &[LawEntry<L>], given: Option<&LawConstants>, judged: &mut Vec<Judged>) {
    let Some(given) = given else { return };
    let entry = &table[given.law];
    judged.extend(entry.parameters.iter().filter_map(|parameter| {
        let (value, range) = (given.get(parameter.key)?, range(entry.key, parameter.key)?);
        let name = format!("`{}` of `{}`", parameter.key, entry.key);
        Some(Judged { name, value, unit: parameter.quantity.si_unit(), range })
    }));
}

fn note(material: &Material, Judged { name, value, unit, range }: &Judged, has_moduli: bool) -> Option<String> {
    let bulk = material.density * material.equation_of_state.reference_sound_speed().powi(2);
    let (shear, what) = match (range.scale, material.shear_modulus) {
        (Scale::Si, _) => (None, ""),
        (Scale::Stiffness, 0.0) => (Some(bulk), "bulk modulus"),
        // What bears no shear has no such constant.
        (Scale::Shear, 0.0) => return None,
        (_, shear) => (Some(shear), "shear modulus"),
    };
    if shear.is_some() && !has_moduli {
        return None;
    }
    let most = shear.map_or(range.most, |modulus| (range.most * modulus).max(BORNE_BY_SOFT));
    let least = range.least * shear.unwrap_or(1.0);
    let is_plausible = |value: f64| value == 0.0 || (least..=most).contains(&value.abs());
    if is_plausible(*value) {
        return None;
    }
    let share = shear.map_or_else(String::new, |modulus| format!(", {:.0e} of its {what}", value / modulus));
    // Megapascals without their unit are the most usual slip; those of an energy per area, a thousand.
    let factors: &[f64] = match *unit {
        "Pa" => &[1e6, 1e9, 1e3, 1e-3, 1e-6],
        "J/m^2" => &[1e3, 1e-3, 1e6, 1e-6],
        _ => &[],
    };
    let meant = factors.iter().map(|factor| factor * value).find(|meant| is_plausible(*meant));
    let ask = match meant {
        Some(meant) => format!("is \"{}\" meant?", with_prefix(meant, unit)),
        None if unit.is_empty() => "check it".to_owned(),
        None => "check the unit".to_owned(),
    };
    Some(format!("material `{}`: {name} is {}{share}; {}: {ask}", material.name, shown(*value, unit), range.published))
}

/// A value with the largest prefix of its unit that leaves a number of one and more.
fn with_prefix(value: f64, unit: &str) -> String {
    let (factor, prefix) = [(1e9, "G"), (1e6, "M"), (1e3, "k")]
        .into_iter()
        .find(|(factor, _)| value.abs() >= 0.999 * factor)
        .unwrap_or((1.0, ""));
    format!("{} {prefix}{unit}", (value / factor * 1e6).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::super::{advice, build, entries, entry};
    use super::*;

    /// Every law with its constants.
    fn constants_of_laws() -> Vec<(&'static str, &'static str)> {
        fn all<L>(table: &[LawEntry<L>]) -> Vec<(&'static str, &'static str)> {
            table.iter().flat_map(|law| law.parameters.iter().map(|parameter| (law.key, parameter.key))).collect()
        }
        [all(EQUATIONS_OF_STATE), all(FLOW_LAWS), all(DAMAGE_LAWS)].concat()
    }

    fn law<L>(table: &[LawEntry<L>], key: &str, values: &[(&'static str, f64)]) -> Option<LawConstants> {
        let law = table.iter().position(|entry| entry.key == key)?;
        Some(LawConstants { law, values: values.to_vec() })
    }

    #[test]
    fn every_constant_of_every_law_has_a_range_and_every_range_a_constant() {
        let known = constants_of_laws();
        for (law, key) in &known {
            assert_ne!(range(law, key).is_some(), ELSEWHERE.contains(&(*law, *key)), "`{key}` of `{law}`");
        }
        for of in ELSEWHERE {
            assert!(known.contains(&of), "{of:?}");
        }
        for (law, key, _) in OF_LAWS {
            let is_of = |of: &(&str, &str)| of.1 == *key && (of.0 == *law || *law == "*");
            assert!(known.iter().any(is_of), "`{key}` of `{law}`");
        }
    }

    /// Notes on copper of the catalogue with some constants changed.
    fn told(change: &dyn Fn(&mut Constants)) -> Vec<String> {
        let mut copper = entry("ofhc-copper").unwrap().clone();
        change(&mut copper);
        let material = build("m", &copper).unwrap_or_else(|incomplete| panic!("{incomplete:?}"));
        advice(&copper, &material)
    }

    /// The same with one constant of its flow law, pressure law or law of damage.
    fn told_with(name: &str, key: &'static str, value: f64) -> Vec<String> {
        told(&|c| {
            c.softening.energy = Some(2e4);
            c.breaks = true;
            let all = [law(EQUATIONS_OF_STATE, name, &[]), law(FLOW_LAWS, name, &[]), law(DAMAGE_LAWS, name, &[])];
            let slots = [&mut c.equation_of_state, &mut c.strength, &mut c.damage];
            let is_of =
                |given: &LawConstants, of: &Option<LawConstants>| of.as_ref().is_some_and(|of| of.law == given.law);
            let mut given =
                slots.into_iter().zip(&all).filter_map(|(slot, of)| slot.as_mut().filter(|given| is_of(given, of)));
            // Constants that the flow law and the law of damage both have are changed in the first.
            let given = if key.starts_with('D') { given.next_back() } else { given.next() };
            let given = given.expect("copper has this law");
            given.values.retain(|(known, _)| *known != key);
            given.values.push((key, value));
        })
    }

    #[track_caller]
    fn is_told(told: &[String], words: &[&str]) {
        assert!(told.len() == 1 && words.iter().all(|word| told[0].contains(word)), "{told:?}");
    }

    #[test]
    fn slips_of_a_unit_or_a_factor_are_told_once() {
        is_told(&told(&|c| c.spall_pressure = Some(1.2)), &["`spall-pressure` is 1.2 Pa", "is \"1.2 GPa\" meant?"]);
        is_told(
            &told_with("johnson-cook", "B", 300.0),
            &["`B` of `johnson-cook` is 300 Pa, 7e-9 of its shear modulus", "is \"300 MPa\" meant?"],
        );
        is_told(&told_with("johnson-cook", "B", 300e3), &["is \"300 MPa\" meant?"]);
        is_told(&told_with("johnson-cook", "B", 300e9), &["3e11 Pa", "is \"300 MPa\" meant?"]);
        is_told(&told_with("johnson-cook", "C", 1.4), &["`C` of `johnson-cook` is 1.4;", "0.001 to 0.1"]);
        is_told(&told_with("johnson-cook", "n", 31.0), &["`n` of", "0.05 to 1"]);
        is_told(&told_with("johnson-cook", "m", 10.9), &["`m` of", "0.5 to 2.5"]);
        is_told(&told_with("johnson-cook", "melting-temperature", 13560.0), &["13560 K", "3700 K", "check the unit"]);
        is_told(&told_with("johnson-cook", "reference-strain-rate", 1e12), &["1e12 1/s"]);
        is_told(&told_with("mie-gruneisen", "shock-slope", 149.0), &["`shock-slope` of `mie-gruneisen` is 149"]);
        is_told(&told_with("mie-gruneisen", "gruneisen", 100.0), &["0.9 to 3.1"]);
        is_told(&told_with("johnson-cook", "D2", 489.0), &["`D2` of", "no percentage"]);
        is_told(&told_with("johnson-cook", "D3", -303.0), &["`D3` of"]);
        is_told(&told_with("johnson-cook", "D4", 14.0), &["`D4` of"]);
        is_told(&told_with("johnson-cook", "D5", 112.0), &["`D5` of"]);
        for (value, meant) in [(5e7, "is \"50 kJ/m^2\" meant?"), (30.0, "is \"30 kJ/m^2\" meant?")] {
            let breaks = |c: &mut Constants| {
                (c.breaks, c.softening.energy) = (true, Some(value));
                c.damage = law(DAMAGE_LAWS, "failure-strain", &[("strain", 0.5)]);
            };
            // Annealed copper yields below what structures do.
            let stronger = |c: &mut Constants| {
                breaks(c);
                c.strength = law(FLOW_LAWS, "perfectly-plastic", &[("yield-stress", 300e6)]);
            };
            is_told(&told(&stronger), &["`fracture-energy` is", meant]);
        }
        for (name, key, value, word) in [
            ("failure-strain", "strain", 50.0, "no percentage"),
            ("normalised-cockcroft-latham", "strain", 50.0, "no percentage"),
            ("hancock-mackenzie", "factor", 165.0, "no percentage"),
            ("hancock-mackenzie", "exponent", 150.0, "`exponent` of"),
            ("cockcroft-latham", "work", 800.0, "is \"800 MPa\" meant?"),
            ("cockcroft-latham", "work", 800e3, "is \"800 MPa\" meant?"),
            ("cockcroft-latham", "work", 800e9, "is \"800 MPa\" meant?"),
            ("principal-stress", "strength", 1.0, "is \"1 GPa\" meant?"),
            ("principal-stress", "strength", 1e12, "is \"1 GPa\" meant?"),
        ] {
            let told = told(&|c| {
                (c.breaks, c.softening.energy) = (true, Some(2e4));
                c.damage = law(DAMAGE_LAWS, name, &[(key, value)]);
            });
            is_told(&told, &[&format!("`{key}` of `{name}`"), word]);
        }
        is_told(&told(&|c| c.spall_opening = Some(20.0)), &["`spall-opening` is 20 m"]);
        let breaks = |c: &mut Constants| {
            c.breaks = true;
            c.damage = law(DAMAGE_LAWS, "failure-strain", &[("strain", 0.5)]);
        };
        let opening = |c: &mut Constants| {
            breaks(c);
            c.softening.displacement = Some(50.0);
        };
        is_told(&told(&opening), &["`softening-displacement` is 50 m"]);
        let floor = |c: &mut Constants| {
            breaks(c);
            (c.softening.energy, c.minimum_failure_strain) = (Some(2e4), Some(5.0));
        };
        is_told(&told(&floor), &["`minimum-failure-strain` is 5;"]);
        let share = |c: &mut Constants| {
            breaks(c);
            c.softening.share = Some(20.0);
        };
        assert!(told(&share).iter().any(|note| note.contains("`softening` is 20;")));
    }

    /// Constants with their values.
    type Values<'a> = &'a [(&'static str, f64)];

    #[test]
    fn slips_in_other_flow_laws_are_told_once() {
        let steinberg = [
            ("yield-stress", 0.12e9),
            ("largest-yield-stress", 0.64e9),
            ("beta", 36.0),
            ("n", 0.45),
            ("A", 2.83e-11),
            ("B", 3.77e-4),
            ("melting-temperature", 1790.0),
            ("gruneisen", 2.02),
            ("a", 1.5),
        ];
        let zerilli = [("C0", 65e6), ("C1", 1033e6), ("C3", 0.00698), ("C4", 0.000415), ("C5", 266e6), ("n", 0.289)];
        let copper = [("C0", 65e6), ("C2", 890e6), ("C3", 0.0028), ("C4", 0.000115)];
        let bilinear = [("yield-stress", 90e6), ("tangent-modulus", 1e9)];
        let slips: [(&str, Values<'_>, Values<'_>); 4] = [
            (
                "steinberg-guinan",
                &steinberg,
                &[
                    ("largest-yield-stress", 0.64e12),
                    ("beta", 1e7),
                    ("A", 2.83),
                    ("B", 3.77),
                    ("gruneisen", 202.0),
                    ("a", 150.0),
                    ("initial-plastic-strain", 30.0),
                ],
            ),
            (
                "zerilli-armstrong-bcc",
                &zerilli,
                &[("C0", 65.0), ("C1", 1033.0), ("C5", 266.0), ("C3", 6.98), ("C4", 0.415)],
            ),
            ("zerilli-armstrong-fcc", &copper, &[("C2", 890.0), ("lowest-strain-rate", 1e15)]),
            ("bilinear", &bilinear, &[("tangent-modulus", 1e3), ("young-modulus", 3e12)]),
        ];
        for (name, values, slips) in slips {
            assert_eq!(told(&|c| c.strength = law(FLOW_LAWS, name, values)), [""; 0], "{name}");
            for (key, value) in slips {
                let with: Vec<_> =
                    values.iter().filter(|(known, _)| known != key).copied().chain([(*key, *value)]).collect();
                is_told(&told(&|c| c.strength = law(FLOW_LAWS, name, &with)), &[&format!("`{key}` of `{name}`")]);
            }
        }
        let mohr = [("A", 900e6), ("n", 0.2), ("c1", 0.1), ("c2", 500e6), ("c3", 0.95)];
        for (key, value) in [("A", 900.0), ("n", 20.0), ("c1", 10.0), ("c2", 500.0), ("c3", 95.0)] {
            let with: Vec<_> = mohr.iter().filter(|of| of.0 != key).copied().chain([(key, value)]).collect();
            let told = told(&|c| {
                (c.breaks, c.softening.energy) = (true, Some(2e4));
                c.damage = law(DAMAGE_LAWS, "modified-mohr-coulomb", &with);
            });
            assert!(told.iter().any(|note| note.contains(&format!("`{key}` of `modified-mohr-coulomb`"))), "{told:?}");
        }
    }

    #[test]
    fn what_is_published_is_plausible() {
        // Laws of the catalogue, those of damage as well, which count where a deck names them.
        for (name, constants) in entries() {
            let breaks = Constants { breaks: constants.damage.is_some(), ..constants.clone() };
            if let Ok(material) = build(name, &breaks) {
                assert_eq!(implausible(&material, &breaks, true), [""; 0], "{name}");
            }
        }
        // Polycarbonate, polyethylene, lead, uranium, tungsten alloys, beryllium: extremes of each kind.
        for (range, values) in [
            (HARDENING_EXPONENT, [0.05, 2.0]),
            (SOFTENING_EXPONENT, [0.3, 3.0]),
            (RATE, [0.001, 0.2]),
            (STRAIN, [0.001, 5.4]),
            (TRIAXIALITY, [-0.47, -22.0]),
            (SHOCK_SLOPE, [0.7, 2.6]),
            (GRUNEISEN, [0.1, 3.1]),
            (HARDENING_FACTOR, [1.0, 2000.0]),
            (BY_PRESSURE, [1e-11, 1.4e-10]),
            (BY_HEAT, [1.3e-4, 1.3e-3]),
            (MELTING, [234.0, 4520.0]),
            (REFERENCE_RATE, [1e-6, 1e4]),
            (CRACK, [1.0, 2e6]),
            (OPENING, [1e-7, 5e-3]),
        ] {
            for value in values {
                assert!((range.least..=range.most).contains(&f64::abs(value)), "{value} {range:?}");
            }
        }
    }

    #[test]
    fn shipped_decks_hear_nothing_of_their_constants() {
        for deck in crate::decks::DECKS {
            let notes = crate::load_text(deck.name, deck.text, &[]).unwrap().all_notes();
            let is_of =
                |note: &String| OF_LAWS.iter().any(|row| note.contains(row.2.published)) || note.contains(" meant?");
            assert!(!notes.iter().any(is_of), "{}: {notes:?}", deck.name);
        }
    }

    fn without_shear(spall: f64, density: f64, sound: f64) -> Vec<String> {
        let liquid = Constants {
            density: Some(density),
            equation_of_state: law(EQUATIONS_OF_STATE, "linear", &[("sound-speed", sound)]),
            strength: law(FLOW_LAWS, "none", &[]),
            spall_pressure: Some(spall),
            ..Constants::default()
        };
        advice(&liquid, &build("liquid", &liquid).unwrap())
    }

    #[test]
    fn softer_and_weaker_matter_than_metals_is_left_alone() {
        // Water that boils, water that is pulled, molten copper.
        for (spall, density, sound) in [(2.3e3, 1000.0, 1480.0), (3e7, 1000.0, 1480.0), (1e9, 8930.0, 3940.0)] {
            assert_eq!(without_shear(spall, density, sound), [""; 0], "{spall}");
        }
        is_told(&without_shear(1.2, 8930.0, 3940.0), &["`spall-pressure` is 1.2 Pa, 9e-12 of its bulk modulus"]);
        // Young's modulus, yield stress, tension, plastic work, energy of a crack: epoxy, concrete, granite, rubber, glass.
        for (young, yields, tension, crack) in [
            (3e9, Some(8e7), 6e7, 200.0),
            (30e9, Some(3e7), 3e6, 100.0),
            (60e9, Some(2e8), 1e7, 100.0),
            (2e6, None, 2e7, 1e4),
            (70e9, None, 5e7, 8.0),
        ] {
            let mut solid = Constants { density: Some(2000.0), spall_pressure: Some(tension), ..Constants::default() };
            (solid.elastic.young, solid.elastic.poisson) = (Some(young), Some(0.3));
            solid.strength = match yields {
                Some(stress) => law(FLOW_LAWS, "perfectly-plastic", &[("yield-stress", stress)]),
                None => law(FLOW_LAWS, "elastic", &[]),
            };
            (solid.breaks, solid.softening.energy) = (true, Some(crack));
            solid.damage = law(DAMAGE_LAWS, "principal-stress", &[("strength", tension)]);
            let material = build("solid", &solid).unwrap();
            assert_eq!(implausible(&material, &solid, true), [""; 0], "{young}");
        }
        // Terms that are left out.
        for key in ["B", "C"] {
            assert_eq!(told_with("johnson-cook", key, 0.0), [""; 0], "{key}");
        }
    }

    #[test]
    fn a_wrong_modulus_is_told_and_not_all_that_is_compared_with_it() {
        let told = told(&|c| c.elastic.shear = Some(46e3));
        is_told(&told, &["is \"46 GPa\" meant?"]);
    }

    #[test]
    fn numbers_have_the_prefix_of_a_unit() {
        for (value, unit, text) in
            [(1.2e9, "Pa", "1.2 GPa"), (3e8, "Pa", "300 MPa"), (5e4, "J/m^2", "50 kJ/m^2"), (20.0, "Pa", "20 Pa")]
        {
            assert_eq!(with_prefix(value, unit), text);
        }
    }
}
