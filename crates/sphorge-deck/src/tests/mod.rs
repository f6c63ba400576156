//! Decks read whole.

mod diagnostics;
mod features;
mod filling;
mod laws;
mod reference;
mod shapes;
mod thermal;
mod whole;

use super::*;
use sphorge_engine::model::*;

/// The deck of the README.
const FLAVOUR: &str = r#"
title = "Taylor impact of an Armco iron plate (Patiño et al., test 2)"
dimensions = "plane-strain"                      # or "3d", "1d"
search = "every-step"                            # or "skin"

[particles]
spacing = "0.3 mm"
smoothing = 1.2                                  # h / spacing

[time]
end = "60 us"

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["-3.8 mm", "0 mm"], max = ["3.8 mm", "25.46 mm"] } }
velocity = ["0 m/s", "-200 m/s"]

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }

[[measure]]
name = "height"
extent = { body = "bar", axis = "y" }
"#;

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
