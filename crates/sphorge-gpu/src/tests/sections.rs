//! Forces through sections on a GPU, beside the processor's engine.

use super::card::gpu;
use super::contact::{RUBS, striking};
use super::engine::{count_steps, start, start_text};
use super::facet_contact;
use sphorge_engine::{Cpu, EngineKind, ParticleSource, Reduction, Simulation};

/// Runs of both engines to the middle and the end of a time, s: the forces through all sections, as near as that to the largest.
fn compare_runs(runs: [Simulation; 2], end: f64, near: f64) {
    let [theirs, ours] = runs.map(|mut simulation| {
        let mut forces: Vec<Vec<f64>> = Vec::new();
        for until in [0.5 * end, end] {
            count_steps(&mut simulation, until);
            let sections = simulation.model().sections.clone();
            forces.extend(sections.iter().map(|of| simulation.reduce(&Reduction::SectionForce(of)).unwrap()));
        }
        forces
    });
    for (ours, theirs) in ours.iter().zip(&theirs) {
        let size = theirs.iter().map(|f| f.abs()).fold(0.0, f64::max);
        assert!(size > 0.0, "nothing goes through");
        for (ours, theirs) in ours.iter().zip(theirs) {
            assert!((ours - theirs).abs() <= near * size, "{ours} N on the card, {theirs}; of {size}");
        }
    }
}

fn compare(deck: &str, overrides: &[(&str, &str)], end: f64, near: f64) {
    compare_runs([&Cpu as &dyn EngineKind, &gpu()].map(|kind| start(kind, deck, overrides)), end, near);
}

#[test]
fn the_force_through_a_strip_that_is_pulled_matches_the_cpu() {
    compare("pulled", &[("particles.spacing", "\"1 mm\"")], 20e-6, 1e-3);
}

#[test]
fn planes_of_symmetry_have_their_part_of_a_force() {
    // Across a plane of symmetry, where all is with images, along it, and slanted through an edge of two planes.
    let sections = "[{ name = \"foot\", point = [\"0 mm\", \"0 mm\", \"0 mm\"], normal = [0, 0, 1] }, \
                    { name = \"side\", point = [\"0 mm\", \"0 mm\", \"6 mm\"], normal = [0, 0, 1] }, \
                    { name = \"slanted\", point = [\"0.9 mm\", \"0 mm\", \"1 mm\"], normal = [1, 0.2, 0.4] }]";
    compare("copper-bar", &[("particles.spacing", "\"0.95 mm\""), ("section", sections)], 3e-6, 1e-3);
    let half = [
        ("particles.spacing", "\"0.6 mm\""),
        ("symmetry", "[{ axis = \"x\", at = \"0.1 mm\" }]"),
        ("body.plate.shape", "{ box = { min = [\"0.1 mm\", \"0 mm\"], max = [\"3.7 mm\", \"12 mm\"] } }"),
        ("section", "[{ name = \"slanted\", point = [\"0.2 mm\", \"1 mm\"], normal = [1, 0.5] }]"),
    ];
    compare("taylor-plate", &half, 3e-6, 1e-3);
}

#[test]
fn the_contact_goes_through_sections() {
    // Between the upper and the middle block, and through both for the middle one alone.
    let sections = "[{ name = \"between\", point = [\"0 mm\", \"0.5 mm\"], normal = [0, 1] }, \
                    { name = \"down\", body = \"middle\", point = [\"0.1 mm\", \"0 mm\"], normal = [1, 0] }]";
    for more in [
        RUBS.to_owned(),
        facet_contact::RUBS.to_owned(),
        format!("method = \"patino\"\nsearch = \"every-step\"\n{RUBS}"),
    ] {
        let kinds = [&Cpu as &dyn EngineKind, &gpu()];
        let text = striking(&more);
        compare_runs(kinds.map(|kind| start_text(kind, "striking", &text, &[("section", sections)])), 8e-6, 2e-3);
    }
}
