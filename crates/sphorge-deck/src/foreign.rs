//! Tables and keys that other programs have and decks have not, with what a deck has instead.

/// Names, as they are compared, and what there is instead of them.
const INSTEAD: [(&[&str], &str); 4] = [
    (
        LOADS,
        "decks prescribe no forces and no pressures. What sets bodies in motion is the `velocity` of a [[body]], of a region by [[motion]] or of a \
             [[wall]], and `gravity`; forces on bodies are given by a program, with `@simulation.load` of the package for Python. ",
    ),
    (
        JOINTS,
        "decks have no springs and no joints. Bodies that touch push each other by `contact`, [[motion]] fixes or drives a region, and a [[wall]] is \
              rigid. ",
    ),
    (
        BOUNDARIES,
        "[[motion]] fixes or drives a region, a [[wall]] is rigid, [[symmetry]] and [periodic] end the space, and [[thermal.boundary]] brings heat. ",
    ),
    (STARTS, "what a body starts with are keys of its own: `velocity`, `spin` and `temperature` in [[body]]. "),
];

const LOADS: &[&str] = &[
    "force",
    "pressure",
    "traction",
    "load",
    "torque",
    "moment",
    "body-force",
    "nodal-force",
    "nodal-load",
    "point-force",
    "point-load",
    "surface-load",
    "distributed-load",
    "prescribed-force",
    "prescribed-pressure",
    "boundary-force",
    "surface-traction",
    "surface-pressure",
    "external-force",
];
const JOINTS: &[&str] = &[
    "spring",
    "joint",
    "damper",
    "dashpot",
    "hinge",
    "tie",
    "weld",
    "link",
    "cable",
    "rod",
    "rigid-body",
    "connector",
    "coupling",
];
const BOUNDARIES: &[&str] = &[
    "boundary",
    "boundary-condition",
    "bc",
    "fix",
    "fixed",
    "clamp",
    "support",
    "constraint",
    "prescribed-velocity",
    "prescribed-displacement",
    "displacement",
    "prescribed-motion",
    "spc",
];
const STARTS: &[&str] = &["initial-condition", "initial-velocity", "initial-temperature", "ic", "initial"];

/// What to say of a key at a path that is the name of something decks do not have.
pub(crate) fn instead(name: &str, path: &str) -> Option<&'static str> {
    let folded = name.to_lowercase().replace(['_', ' '], "-");
    let singular =
        folded.strip_suffix("ies").map_or_else(|| folded.trim_end_matches('s').to_owned(), |stem| format!("{stem}y"));
    let (names, text) =
        INSTEAD.iter().find(|(names, _)| names.iter().any(|known| *known == folded || *known == singular))?;
    let is_of_bodies = matches!(path.split('.').next(), Some("body" | "region" | "wall" | "motion"));
    // What bounds a body has its own keys there.
    let is_load = *names == LOADS || *names == JOINTS;
    (path.is_empty() || (is_of_bodies && is_load)).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_other_programs_name_what_there_is() {
        for (name, path, word) in [
            ("force", "", "prescribe no forces"),
            ("Nodal_Forces", "", "prescribe no forces"),
            ("pressure", "body", "`velocity` of a [[body]]"),
            ("traction", "region.left", "`gravity`"),
            ("springs", "", "no springs"),
            ("boundaries", "", "[[thermal.boundary]]"),
            ("initial-velocity", "", "[[body]]"),
        ] {
            assert!(instead(name, path).is_some_and(|text| text.contains(word)), "{name} {path}");
        }
        for (name, path) in [("pressure", "measure.p"), ("boundary", "thermal"), ("forced", ""), ("bod", "")] {
            assert_eq!(instead(name, path), None, "{name} {path}");
        }
    }

    #[test]
    fn no_key_of_a_deck_is_one_of_them() {
        for (names, _) in INSTEAD {
            for name in names {
                assert!(crate::keys::DECK.key(name).is_none(), "{name}");
            }
        }
    }
}
