//! What neighbour lists on a card miss, beside what the processor's engine says of its own.

use super::card::card;
use super::engine::start_text;
use crate::Gpu;
use sphorge_deck::decks;
use sphorge_engine::{Audit, Cpu, EngineKind};

/// A block that strikes another when it has flown past what the search looks at: pairs of them are missed as published.
const LATE: &str = r#"
dimensions = "plane-strain"
method = "patino"
particles = { spacing = "1 mm" }
numerics = { integrator = "leapfrog" }
time = { end = "1 ms" }
audit = 20

[[body]]
name = "bar"
material = "ofhc-copper"
shape = { box = { min = ["0 mm", "0 mm"], max = ["12 mm", "6 mm"] } }

[[body]]
name = "striker"
material = "ofhc-copper"
shape = { box = { min = ["2 mm", "9 mm"], max = ["8 mm", "15 mm"] } }
velocity = ["0 m/s", "-200 m/s"]
"#;

/// The audits of both engines to a time, s.
fn audits(text: &str, overrides: &[(&str, &str)], end: f64) -> [Vec<Audit>; 2] {
    [&Cpu as &dyn EngineKind, &Gpu::default()].map(|kind| {
        let mut simulation = start_text(kind, "late", text, overrides);
        let mut audits = Vec::new();
        while simulation.time() < end {
            audits.extend(simulation.step(Some(end)).unwrap().audit);
        }
        audits
    })
}

/// Compares audits: what is counted is the same, and errors as near as single precision has them.
fn compare(text: &str, overrides: &[(&str, &str)], end: f64) -> Vec<Audit> {
    if card().is_none() {
        return Vec::new();
    }
    let [theirs, ours] = audits(text, overrides, end);
    assert_eq!(ours.len(), theirs.len());
    assert!(!theirs.is_empty());
    for (ours, theirs) in ours.iter().zip(&theirs) {
        let counts = |of: &Audit| [of.pairs, of.missed_pairs, of.missed_foreign_pairs, of.stale_pairs];
        assert_eq!(counts(ours), counts(theirs));
        for (what, ours, theirs) in [
            ("density rate", ours.density_rate_error, theirs.density_rate_error),
            ("force", ours.force_error, theirs.force_error),
            ("momentum", ours.momentum_residual, theirs.momentum_residual),
        ] {
            assert!((ours - theirs).abs() < 1e-3 * theirs + 1e-6, "{what}: {ours} on the card, {theirs}");
        }
    }
    theirs
}

#[test]
fn what_an_adaptive_search_misses_is_said_as_on_the_processor() {
    let published = ("search", "{ adaptive = { guard = \"none\" } }");
    let theirs = compare(LATE, &[published], 22e-6);
    assert!(theirs.is_empty() || theirs.iter().any(|audit| audit.missed_foreign_pairs > 20));
    let guarded = compare(LATE, &[("search", "\"adaptive\"")], 22e-6);
    assert!(guarded.iter().all(|audit| audit.missed_pairs == 0));
}

#[test]
fn pairs_beyond_a_skin_and_images_are_counted() {
    let plate = [
        ("particles.spacing", "\"0.6 mm\""),
        ("search", "{ adaptive = { guard = \"none\", plastic-strain-threshold = 3e-3 } }"),
        ("audit", "20"),
        ("symmetry", "[{ axis = \"x\" }]"),
        ("body.plate.shape", "{ box = { min = [\"0 mm\", \"0 mm\"], max = [\"3.6 mm\", \"12 mm\"] } }"),
    ];
    let text = decks::find("taylor-plate").unwrap().text;
    let theirs = compare(text, &plate, 4e-6);
    assert!(theirs.is_empty() || theirs.iter().any(|audit| audit.stale_pairs > 20 && audit.force_error > 0.05));
    let skin = [plate[0], ("search", "\"skin\""), plate[2], plate[3], plate[4]];
    let theirs = compare(text, &skin, 4e-6);
    assert!(theirs.is_empty() || theirs.iter().any(|audit| audit.stale_pairs > 0));
    assert!(theirs.iter().all(|audit| audit.missed_pairs == 0));
}
