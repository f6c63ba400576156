//! Coefficients far beyond what anything has: of friction, of heat through surfaces, of viscosity.

use sphorge_engine::model::{HeatBoundary, HeatBoundaryKind, Model, WallContact};

/// What of them cannot be meant.
pub(crate) fn coefficients(model: &Model) -> Vec<String> {
    too_rough(model).into_iter().chain(too_stiff(model)).chain(too_hot(model)).chain(too_viscous(model)).collect()
}

/// Coulomb coefficient above which none of metals is.
const ROUGHEST: f64 = 2.0;

/// Stiffness of a contact above which time steps shrink and nothing else is gained.
const STIFFEST: f64 = 100.0;

/// Friction and stiffness of contacts, with whose they are.
fn contacts(model: &Model) -> impl Iterator<Item = (String, f64, f64)> {
    let of_bodies = model.contact.strength().map(|of| ("between bodies".to_owned(), of.friction, of.stiffness));
    let of_walls = model.walls.iter().filter_map(|wall| match wall.contact {
        WallContact::Penalty { friction, stiffness, .. } => {
            Some((format!("of wall `{}`", wall.name), friction, stiffness))
        }
        WallContact::MonaghanKos { .. } => None,
    });
    of_bodies.into_iter().chain(of_walls)
}

/// Friction in per cent or in degrees.
fn too_rough(model: &Model) -> Vec<String> {
    let rough = contacts(model).filter(|(_, friction, _)| *friction > ROUGHEST);
    let note = |(whose, friction, _)| {
        format!(
            "the friction coefficient {whose} is {friction}: metals have 0.05 to 1; it is a ratio of forces, neither a percentage nor an angle"
        )
    };
    rough.map(note).collect()
}

/// A modulus in place of a ratio.
fn too_stiff(model: &Model) -> Vec<String> {
    let stiff = contacts(model).filter(|(.., stiffness)| *stiffness > STIFFEST);
    let note = |(whose, _, stiffness)| {
        format!(
            "the stiffness of the contact {whose} is {stiffness:e}: it is a ratio to the stiffness of the cells that meet, no modulus; 1 is usual, and \
             the time step falls with its square root"
        )
    };
    stiff.map(note).collect()
}

/// Heat flux, W/m^2, that no source of long duration has: burners have 1e6, arcs of welding 1e9.
const LARGEST_FLUX: f64 = 1e11;
/// Heat transfer coefficient that no flow has, W/(m^2 K): boiling and condensing metals have 1e6.
const LARGEST_TRANSFER: f64 = 1e8;

/// Heat through surfaces that no source brings.
fn too_hot(model: &Model) -> Vec<String> {
    let note = |boundary: &HeatBoundary| {
        let name = &boundary.name;
        match boundary.kind {
            HeatBoundaryKind::Flux(flux) if flux.abs() > LARGEST_FLUX => Some(format!(
                "the flux of heat boundary `{name}` is {flux:.3e} W/m^2: arcs of welding have up to 1e9, beams of lasers and electrons 1e10 to 1e12; check the unit"
            )),
            HeatBoundaryKind::Convection { coefficient, .. } if coefficient > LARGEST_TRANSFER => Some(format!(
                "the heat transfer coefficient of heat boundary `{name}` is {coefficient:.3e} W/(m^2 K): boiling water has 1e5; check the unit"
            )),
            _ => None,
        }
    };
    model.thermal.boundaries.iter().filter_map(note).collect()
}

/// Linear and quadratic coefficients of viscosity above which the time step shrinks and nothing else is gained.
const LARGEST_VISCOSITY: [f64; 2] = [10.0, 50.0];

/// Viscosity that does nothing, or too much.
fn too_viscous(model: &Model) -> Vec<String> {
    let numerics = &model.numerics;
    let mut told = Vec::new();
    for (key, value, largest) in [
        ("alpha", numerics.viscosity_alpha, LARGEST_VISCOSITY[0]),
        ("beta", numerics.viscosity_beta, LARGEST_VISCOSITY[1]),
    ] {
        if value > largest {
            told.push(format!(
                "`numerics.viscosity.{key}` is {value}: values in use are 0.1 to {}; the time step falls with it",
                largest / 5.0
            ));
        }
    }
    if numerics.viscosity_of_all_waves && numerics.viscosity_alpha == 0.0 {
        told.push("`numerics.viscosity.all-waves` has no effect, because `alpha` is zero: it is the linear viscosity that acts on all waves".to_owned());
    }
    told
}

#[cfg(test)]
mod tests {
    use crate::load_text;

    /// A bar of steel on its way to a wall, with parts of the deck replaced.
    fn notes(replaced: &[(&str, &str)]) -> Vec<String> {
        let mut deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"20 us\" }\n\
                        [material.m]\ndensity = \"7850 kg/m^3\"\nyoung-modulus = \"210 GPa\"\npoisson-ratio = 0.3\nspecific-heat = \"450 J/(kg K)\"\n\
                        conductivity = \"45 W/(m K)\"\nstrength = { perfectly-plastic = { yield-stress = \"350 MPa\" } }\n\
                        [[body]]\nname = \"bar\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0], max = [\"6 mm\", \"12 mm\"] } }\n\
                        velocity = [\"0 m/s\", \"-10 m/s\"]\n\
                        [[wall]]\nname = \"anvil\"\nplane = { point = [0, 0], normal = [0, 1] }\n"
            .to_owned();
        for (old, new) in replaced {
            assert!(deck.contains(old), "{old}");
            deck = deck.replace(old, new);
        }
        load_text("bar", &deck, &[]).unwrap_or_else(|report| panic!("{report:?}")).all_notes()
    }

    #[track_caller]
    fn told(replaced: &[(&str, &str)], words: &[&str]) {
        let notes = notes(replaced);
        assert!(notes.len() == 1 && words.iter().all(|word| notes[0].contains(word)), "{notes:?}");
    }

    #[test]
    fn friction_that_is_a_percentage_is_told() {
        let wall =
            |friction: &str| format!("normal = [0, 1] }}\ncontact = {{ penalty = {{ friction = {friction} }} }}\n");
        let deck = |friction: &str| notes(&[("normal = [0, 1] }\n", &wall(friction))]);
        assert!(deck("20")[0].contains("friction coefficient of wall `anvil` is 20"), "{:?}", deck("20"));
        assert_eq!(deck("1.2"), [""; 0]);
        told(
            &[("[material.m]", "contact = { penalty = { friction = 30 } }\n[material.m]")],
            &["friction coefficient between bodies is 30"],
        );
    }

    #[test]
    fn a_stiffness_that_is_a_modulus_is_told() {
        let of = |stiffness: &str| {
            let wall = format!("normal = [0, 1] }}\ncontact = {{ penalty = {{ stiffness = {stiffness} }} }}\n");
            notes(&[("normal = [0, 1] }\n", &wall)])
        };
        assert!(of("1e11").len() == 1 && of("1e11")[0].contains("contact of wall `anvil` is 1e11"), "{:?}", of("1e11"));
        assert_eq!(of("10"), [""; 0]);
        told(
            &[("[material.m]", "contact = { penalty = { stiffness = 2e11 } }\n[material.m]")],
            &["stiffness of the contact between bodies is 2e11"],
        );
    }

    #[test]
    fn heat_that_no_source_brings_is_told() {
        let boundary = |kind: &str| {
            let heat = format!("[thermal]\nconduction = true\n[[thermal.boundary]]\nname = \"top\"\n{kind}\n[[wall]]");
            notes(&[("[[wall]]", &heat)])
        };
        for (flux, is_told) in [("1 MW/mm^2", true), ("50 GW/m^2", false), ("-1e12 W/m^2", true)] {
            let notes = boundary(&format!("flux = \"{flux}\""));
            assert_eq!(
                notes.iter().filter(|note| note.contains("flux of heat boundary `top`")).count(),
                usize::from(is_told),
                "{notes:?}"
            );
        }
        for (coefficient, is_told) in [("1 GW/(m^2 K)", true), ("50 MW/(m^2 K)", false)] {
            let notes = boundary(&format!("convection = {{ coefficient = \"{coefficient}\", ambient = \"300 K\" }}"));
            assert_eq!(
                notes.iter().filter(|note| note.contains("transfer coefficient")).count(),
                usize::from(is_told),
                "{notes:?}"
            );
        }
    }

    #[test]
    fn viscosity_that_does_nothing_or_too_much_is_told() {
        let with = |table: &str| format!("numerics = {{ viscosity = {{ {table} }} }}\n[material.m]");
        told(&[("[material.m]", &with("alpha = 1e9"))], &["`numerics.viscosity.alpha` is 1000000000", "0.1 to 2;"]);
        told(&[("[material.m]", &with("beta = 60"))], &["`numerics.viscosity.beta` is 60", "0.1 to 10;"]);
        told(
            &[("[material.m]", &with("alpha = 0, all-waves = true"))],
            &["`numerics.viscosity.all-waves` has no effect"],
        );
        for sound in ["alpha = 10", "beta = 50", "all-waves = true", "alpha = 0"] {
            assert_eq!(notes(&[("[material.m]", &with(sound))]), [""; 0], "{sound}");
        }
    }
}
