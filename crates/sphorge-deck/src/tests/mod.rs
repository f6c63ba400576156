//! Decks read whole.

mod corpus;
mod diagnostics;
mod features;
mod filling;
mod idle;
mod laws;
pub(crate) mod notes;
mod reference;
mod shapes;
mod thermal;
mod whole;

use super::*;
use sphorge_engine::model::*;

/// The deck of the README.
const FLAVOUR: &str = include_str!("decks/flavour.toml");

/// The deck with a piece replaced.
#[track_caller]
fn changed(old: &str, new: &str) -> String {
    let deck = FLAVOUR.replacen(old, new, 1);
    assert_ne!(deck, FLAVOUR, "`{old}` is not in the deck");
    deck
}

#[test]
fn the_flavour_of_a_deck_becomes_a_setup() {
    let setup = load_text("taylor", FLAVOUR, &[]).unwrap();
    let model = &setup.model;
    assert_eq!(
        (model.name.as_str(), model.dimensions, model.search),
        ("taylor", Dimensions::PlaneStrain, Search::EveryStep)
    );
    assert_eq!((model.spacing, model.time.end), (0.3e-3, 60e-6));
    assert_eq!(setup.particles.len(), 25 * 85);
    assert_eq!(setup.particles.velocity[7], [0.0, -200.0, 0.0]);
    assert!((setup.particles.mass[0] - 7890.0 * 0.3e-3 * 0.3e-3).abs() < 1e-12);
    assert_eq!(setup.particles.smoothing_length[0], 1.2 * 0.3e-3);
    assert_eq!(
        model.measures[0].kind,
        MeasureKind::Extent { selection: ParticleSelection { body: Some(0), ..ParticleSelection::default() }, axis: 1 }
    );
    assert_eq!(setup.deck_text, FLAVOUR);
}
