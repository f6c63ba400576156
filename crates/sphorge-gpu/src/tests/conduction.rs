//! Heat that flows on a GPU, beside the processor's engine.

use super::card::gpu;
use super::contact::{RUBS, striking};
use super::engine::{conserves_and_repeats, count_steps, start, start_text};
use super::facet_contact;
use sphorge_deck::decks;
use sphorge_engine::{Cpu, EngineKind, Simulation};

/// Runs of both engines to a time, s: temperatures of every particle, heat of boundaries and what was exchanged, and the steps taken. Heat
/// must change temperatures by more than a tenth of their range.
fn compare_runs(runs: [Simulation; 2], end: f64, near: f64) {
    compare_where(runs, end, near, true);
}

/// The same; rows that know pairs others do not, as those of the adaptive search without its guard, do not conserve.
fn compare_where(runs: [Simulation; 2], end: f64, near: f64, is_conserved: bool) {
    let [theirs, ours] = runs.map(|mut simulation| {
        let first = simulation.ledger().unwrap();
        let steps = count_steps(&mut simulation, end);
        let ledger = simulation.ledger().unwrap();
        let change = ledger.total_energy() - first.total_energy() - ledger.external_work - ledger.boundary_heat();
        let given = ledger.total_energy().abs().max(ledger.heat.exchanged);
        assert!(!is_conserved || change.abs() < 2e-7 * given, "{change:e} of {given:e}");
        (steps, simulation.particles().unwrap(), ledger.heat)
    });
    assert!(ours.0.abs_diff(theirs.0) <= 1, "{} steps on the card, {}", ours.0, theirs.0);
    let (p, q) = (&ours.1, &theirs.1);
    let extreme = |of: fn(f64, f64) -> f64| q.temperature.iter().copied().reduce(of).unwrap();
    let range = extreme(f64::max) - extreme(f64::min);
    assert!(range > 1.0, "{range} K");
    for (i, (ours, theirs)) in p.temperature.iter().zip(&q.temperature).enumerate() {
        let x = q.position[i];
        assert!(
            (ours - theirs).abs() <= near * range,
            "particle {i} at {x:?}: {ours} K on the card, {theirs}; of {range}"
        );
    }
    assert_eq!(ours.2.supplied.len(), theirs.2.supplied.len());
    assert!(theirs.2.exchanged > 0.0, "nothing flows");
    let supplied = ours.2.supplied.iter().zip(&theirs.2.supplied);
    for (ours, theirs) in supplied.chain([(&ours.2.exchanged, &theirs.2.exchanged)]) {
        assert!((ours - theirs).abs() <= near * theirs.abs(), "{ours} J on the card, {theirs}");
    }
}

fn compare(deck: &str, overrides: &[(&str, &str)], end: f64, near: f64) {
    compare_runs([&Cpu as &dyn EngineKind, &gpu()].map(|kind| start(kind, deck, overrides)), end, near);
}

#[test]
fn heat_through_held_faces_and_between_metals_matches_the_cpu() {
    compare("heat-slab", &[], 20.0, 1e-5);
    compare("two-materials", &[], 1.0, 1e-5);
}

#[test]
fn heat_through_surfaces_matches_the_cpu() {
    compare("convecting-block", &[("particles.spacing", "\"4 mm\"")], 20.0, 1e-5);
    let boundaries = "[{ name = \"air\", region = \"left\", convection = { coefficient = \"500 W/(m^2 K)\", ambient = \"0 degC\" } }, \
                      { name = \"flame\", region = \"right\", normal = [1, 0], flux = \"2e5 W/m^2\" }, { name = \"ice\", region = \"top\", surface-temperature = \"0 degC\" }]";
    let region = |name: &str, low: &str, high: &str| {
        format!("[[region]]\nname = \"{name}\"\nshape = {{ box = {{ min = {low}, max = {high} }} }}\n")
    };
    let deck = decks::find("convecting-block").unwrap();
    let text = format!(
        "{}\n{}{}{}",
        deck.text,
        region("left", "[\"0 mm\", \"0 mm\"]", "[\"20 mm\", \"80 mm\"]"),
        region("right", "[\"60 mm\", \"0 mm\"]", "[\"80 mm\", \"80 mm\"]"),
        region("top", "[\"20 mm\", \"40 mm\"]", "[\"60 mm\", \"80 mm\"]"),
    );
    let overrides = [("particles.spacing", "\"4 mm\""), ("thermal.boundary", boundaries)];
    let kinds = [&Cpu as &dyn EngineKind, &gpu()];
    compare_runs(kinds.map(|kind| start_text(kind, "surfaces", &text, &overrides)), 10.0, 1e-5);
}

/// The quarter of a bar, whose metal conducts so well that heat flows through it while it is pressed flat.
const BAR: [(&str, &str); 2] =
    [("particles.spacing", "\"0.8 mm\""), ("material.42crmo4-steel.conductivity", "\"2e5 W/(m K)\"")];

#[test]
fn heat_in_what_is_deformed_matches_the_cpu() {
    compare("taylor-bar-42crmo4", &BAR, 8e-6, 3e-4);
}

#[test]
fn heat_flows_at_current_distances_where_sums_keep_former_ones() {
    for (search, is_conserved) in
        [("{ adaptive = { guard = \"none\" } }", false), ("{ total-lagrangian = { form = \"frozen\" } }", true)]
    {
        let bar = [BAR[0], BAR[1], ("method", "\"patino\""), ("search", search)];
        let kinds = [&Cpu as &dyn EngineKind, &gpu()];
        compare_where(kinds.map(|kind| start(kind, "taylor-bar-42crmo4", &bar)), 6e-6, 3e-4, is_conserved);
    }
}

/// What makes heat pass between blocks that strike each other.
const CONDUCT: [(&str, &str); 4] = [
    ("material.ofhc-copper.conductivity", "\"4e5 W/(m K)\""),
    ("material.armco-iron.conductivity", "\"4e4 W/(m K)\""),
    ("thermal.conduction", "true"),
    ("body.0.temperature", "\"600 K\""),
];

#[test]
fn heat_passes_between_bodies_in_contact_as_on_the_cpu() {
    for more in [
        RUBS.to_owned(),
        facet_contact::RUBS.to_owned(),
        format!("method = \"patino\"\nsearch = \"every-step\"\n{RUBS}"),
    ] {
        let kinds = [&Cpu as &dyn EngineKind, &gpu()];
        compare_runs(kinds.map(|kind| start_text(kind, "striking", &striking(&more), &CONDUCT)), 6e-6, 3e-4);
    }
}

#[test]
fn heat_conduction_is_reproducible_to_the_bit() {
    conserves_and_repeats("taylor-bar-42crmo4", &BAR, 2e-6);
}

#[test]
fn a_flux_that_cools_below_zero_ends_the_run_with_its_name() {
    let overrides =
        [("particles.spacing", "\"4 mm\""), ("thermal.boundary", "[{ name = \"out\", flux = \"-1e9 W/m^2\" }]")];
    let mut simulation = start(&gpu(), "convecting-block", &overrides);
    let failure = (0..60).find_map(|_| simulation.step(None).err()).expect("colder than absolute zero");
    assert!(failure.message.contains("removes more heat than it contains") && failure.particle.is_some(), "{failure}");
    assert!(!failure.step_may_be_smaller);
}
