//! The decks that come with the program, part of it, so that an installed program runs them by name anywhere.

use super::suggest;

/// A shipped deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedDeck {
    /// Its name: that of its file without `.toml`.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! shipped {
    ($( $name:literal, )+) => {
        /// Every file of the folder `decks`, in the order they are best shown in.
        pub const DECKS: &[ShippedDeck] = &[ $(
            ShippedDeck { name: $name, text: include_str!(concat!("../decks/", $name, ".toml")) },
        )+ ];
    };
}

shipped! {
    "iron-plate",
    "taylor-plate",
    "taylor-bar",
    "taylor-bar-42crmo4",
    "copper-bar",
    "high-shear",
    "penetration",
    "disc-on-plate",
    "tensile",
    "bullet",
    "perforation",
    "plate-impact",
    "elastic-plastic-piston",
    "homogeneous",
    "pulled",
    "elastic-bar",
    "oscillating-plate",
    "rubber-rings",
    "rotating-rod",
    "heat-slab",
    "two-materials",
    "convecting-block",
    "failure-strains",
    "weldox-tension",
    "notched-bars",
    "spall",
    "taylor-fracture",
    "crack-energy",
    "block",
}

/// The shipped deck of this name.
pub fn find(name: &str) -> Option<&'static ShippedDeck> {
    DECKS.iter().find(|deck| deck.name == name)
}

/// The names of shipped decks that may be meant by this one.
pub fn like(name: &str) -> Vec<&'static str> {
    suggest::like(name, DECKS.iter().map(|deck| deck.name))
}

impl ShippedDeck {
    /// Its `title`.
    pub fn title(&self) -> String {
        let deck = toml_edit::Document::parse(self.text).ok();
        deck.and_then(|deck| Some(deck.as_table().get("title")?.as_str()?.to_owned())).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decks_are_found_by_slips_and_by_parts_of_their_names() {
        assert_eq!(like("blok"), ["block"]);
        assert_eq!(like("iron-plat"), ["iron-plate"]);
        assert_eq!(like("tailor"), ["taylor-plate", "taylor-bar", "taylor-bar-42crmo4", "taylor-fracture"]);
        assert_eq!(like("my-case"), [""; 0]);
    }
    use std::{collections::BTreeSet, fs, path::Path};

    #[test]
    fn every_file_of_the_folder_is_shipped() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../decks");
        let names = |path: fs::DirEntry| path.file_name().into_string().unwrap();
        let files: BTreeSet<_> = fs::read_dir(folder).unwrap().map(|e| names(e.unwrap())).collect();
        let shipped: BTreeSet<_> = DECKS.iter().map(|deck| format!("{}.toml", deck.name)).collect();
        assert_eq!(files, shipped);
    }

    #[test]
    fn every_shipped_deck_reads_and_has_particles_and_a_title() {
        for deck in DECKS {
            let setup = crate::load_text(deck.name, deck.text, &[]);
            let setup = setup.unwrap_or_else(|report| panic!("{}: {report}", deck.name));
            assert!(!setup.particles.is_empty());
            assert_eq!(setup.model.title, deck.title());
            assert!(!deck.title().is_empty(), "{}", deck.name);
        }
    }
}
