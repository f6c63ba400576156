//! The shipped materials, read once from the text they are written in.

use super::constants::Constants;
use super::listing::{MaterialListing, listing};
use super::read::constants;
use crate::declare::Named;
use crate::fault::Problems;
use crate::keys;
use crate::raw::RawMaterial;
use crate::report::DeckReport;
use crate::suggest::like;
use crate::written::Spanned;
use std::sync::LazyLock;

const TEXT: &str = include_str!("catalogue.toml");

static ENTRIES: LazyLock<Vec<(String, Constants)>> = LazyLock::new(|| match read(TEXT) {
    Ok(entries) => entries,
    // The text is part of the program; a test reads it.
    Err(report) => panic!("the material catalogue cannot be read: {report}"),
});

/// Reads `[NAME]` tables of materials, as a deck has them below `material`.
fn read(text: &str) -> Result<Vec<(String, Constants)>, DeckReport> {
    let mut problems = Problems::new("catalogue", text);
    let raw: Named<RawMaterial> = keys::read(&mut problems).unwrap_or_default();
    // What breaks breaks because a deck says so.
    let entry = |(name, material): &(Spanned<String>, _)| {
        (name.get_ref().clone(), Constants { breaks: false, ..constants(material, &mut problems) })
    };
    let entries = raw.0.iter().map(entry).collect();
    problems.check()?;
    Ok(entries)
}

/// Every material of the catalogue, by name.
pub(crate) fn entries() -> &'static [(String, Constants)] {
    &ENTRIES
}

/// Constants of a material of the catalogue.
pub(crate) fn entry(name: &str) -> Option<&'static Constants> {
    entries().iter().find(|(n, _)| n == name).map(|(_, constants)| constants)
}

/// All materials of the catalogue, in alphabetic order.
pub fn catalogue() -> Vec<MaterialListing> {
    entries().iter().map(|(name, constants)| listing(name, constants)).collect()
}

/// One material of the catalogue; otherwise the names like the one asked for.
///
/// # Errors
/// Names that may be meant; none if no name is like it.
pub fn find(name: &str) -> Result<MaterialListing, Vec<&'static str>> {
    match entry(name) {
        Some(constants) => Ok(listing(name, constants)),
        None => Err(like(name, entries().iter().map(|(n, _)| n.as_str()))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{advice, build};
    use sphorge_physics::flow::FlowState;

    #[test]
    fn every_material_is_complete_or_says_what_is_missing() {
        for listing in catalogue() {
            assert!(!listing.reference.is_empty() && !listing.description.is_empty(), "{}", listing.name);
            assert_eq!(listing.missing.is_empty(), listing.note.is_empty(), "{}: {:?}", listing.name, listing.missing);
        }
        let incomplete: Vec<_> = catalogue().into_iter().filter(|m| !m.missing.is_empty()).map(|m| m.name).collect();
        let expected = [
            "1006-steel",
            "7039-aluminium",
            "carpenter-electric-iron",
            "cartridge-brass",
            "s7-tool-steel",
            "tungsten-alloy",
        ];
        assert_eq!(incomplete, expected);
    }

    #[test]
    fn one_metal_of_the_catalogue_is_doubtful() {
        let told = |(name, constants): &&(String, Constants)| {
            build(name, constants).is_ok_and(|material| !advice(constants, &material).is_empty())
        };
        let doubtful: Vec<_> = entries().iter().filter(told).map(|(name, _)| name.as_str()).collect();
        assert_eq!(doubtful, ["armco-iron"]);
    }

    #[test]
    fn yield_stresses_follow_from_the_constants() {
        // At rest, 293.15 K, no rate: C0; 65 + 1033 exp(-0.00698 293.15 - 0.000415 293.15 6.907755) = 65 + 57.608 MPa. At 300 K: Y_0.
        for (name, yield_stress) in [
            ("ofhc-copper-zerilli", 65e6),
            ("armco-iron-zerilli", 122.608e6),
            ("copper-steinberg", 0.12e9),
            ("6061-t6-aluminium-steinberg", 0.29e9),
            ("tantalum-steinberg", 0.77e9),
            ("tungsten-alloy-steinberg", 1.87e9),
            ("6061-t6-aluminium", 324e6),
            ("ti-6al-4v", 1098e6),
            ("weldox-460-e", 490e6),
        ] {
            let material = build(name, entry(name).unwrap()).unwrap();
            let state = material.flow_state(0.0, material.reference_temperature, material.density, 0.0);
            let got = material.flow_law.yield_stress(state, &[]).value;
            assert!((got / yield_stress - 1.0).abs() < 1e-5, "{name}: {got}");
        }
        // At 20 % and 1e4/s, 293 K: 675.6360 MPa 1.211244; the weaker rate of Johnson & Cook would give 1 + 0.0114 16.811243 = 1.191648.
        let weldox = build("weldox-460-e", entry("weldox-460-e").unwrap()).unwrap();
        let fast = FlowState { plastic_strain_rate: 1e4, ..weldox.flow_state(0.2, 293.0, weldox.density, 0.0) };
        let got = weldox.flow_law.yield_stress(fast, &[]).value;
        assert!((got / 818.360e6 - 1.0).abs() < 1e-5, "{got}");
        // 1 Mbar is 100 GPa: G = 69 GPa (1 + 1.45 0.1) at 10 GPa.
        let tantalum = build("tantalum-steinberg", entry("tantalum-steinberg").unwrap()).unwrap();
        let pressed = tantalum.flow_state(0.0, 300.0, tantalum.density, 10e9);
        assert!((tantalum.flow_law.shear_modulus(tantalum.shear_modulus, pressed) / 79.005e9 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn wave_speeds_of_the_exact_solutions_follow_from_the_constants() {
        let material = |name: &str| build(name, entry(name).unwrap()).unwrap();
        let copper = material("copper-elastic");
        // Bar wave speed sqrt(E/rho), with E = 9KG/(3K + G).
        let k = copper.density * copper.equation_of_state.reference_sound_speed().powi(2);
        let e = 9.0 * k * copper.shear_modulus / (3.0 * k + copper.shear_modulus);
        assert!(((e / copper.density).sqrt() - 3619.7).abs() < 0.1);
        // Precursor of the piston: sqrt((K + 4G/3)/rho) = 4716 m/s.
        let piston = material("copper-piston");
        let c0 = piston.equation_of_state.reference_sound_speed();
        assert!(((c0 * c0 + 4.0 / 3.0 * piston.shear_modulus / piston.density).sqrt() - 4716.0).abs() < 1.0);
        // Bulk sound speeds Gray, Monaghan & Swift's cases print.
        assert!((material("rubber-rings").equation_of_state.reference_sound_speed() - 4032.0).abs() < 1.0);
        assert!((material("rubber-plate").equation_of_state.reference_sound_speed() - 57.03).abs() < 0.01);
    }

    #[test]
    fn a_slip_in_a_name_finds_the_nearest() {
        assert_eq!(find("armco-irn").unwrap_err(), ["armco-iron"]);
        let coppers = find("copr").unwrap_err();
        assert!(coppers.len() == 6 && coppers.iter().all(|name| name.contains("copper")), "{coppers:?}");
        for other in [
            "unobtainium",
            "lead",
            "zinc",
            "tin",
            "gold",
            "silver",
            "bronze",
            "magnesium",
            "316-steel",
            "7075-t6-aluminium",
        ] {
            assert_eq!(find(other).unwrap_err(), [""; 0], "{other}");
        }
        assert_eq!(find("armco-iron").unwrap().strength.unwrap().constants[0].value, Some(175e6));
        assert_eq!(find("weldox").unwrap_err(), ["weldox-460-e"]);
        let weldox = find("weldox-460-e").unwrap().strength.unwrap();
        assert_eq!((weldox.key, weldox.constants[5].value), ("modified-johnson-cook", Some(5e-4)));
    }
}
