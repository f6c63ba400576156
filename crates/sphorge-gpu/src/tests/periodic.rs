//! Periodic axes on a GPU, beside the processor's engine.

use super::contact::{PRESENT, RUBS, compare as compare_contact, striking};
use super::engine::{IRON, PLATE, compare, compare_fields, conserves_and_repeats, conserves_and_repeats_text};
use super::renewal::{compare as compare_renewals, shipped};
use super::verlet_lists::compare as compare_searches;

/// A plate whose particles leave the cell and come in again.
pub(super) const LEAVES: [(&str, &str); 4] = [
    PLATE.1[0],
    ("periodic", "{ x = [\"-3.8 mm\", \"3.8 mm\"] }"),
    // Nothing is pulled.
    ("numerics.artificial-stress", "false"),
    ("body.plate.velocity", "[\"150 m/s\", \"-200 m/s\"]"),
];

#[test]
fn sums_in_the_current_configuration_match_the_cpu() {
    compare(PLATE.0, &LEAVES, 5e-6, 1e-4);
    let skin = [("search", "\"skin\""), ("numerics.integrator", "\"leapfrog\"")];
    compare(PLATE.0, &[&LEAVES[..], &skin].concat(), 5e-6, 1e-4);
    conserves_and_repeats(PLATE.0, &LEAVES, 2e-6);
}

/// A plate on a foot that goes on beyond both ends of the cell, by the default method; it leaves the cell.
pub(super) const ON_A_FOOT: [(&str, &str); 5] = [
    IRON.1[0],
    IRON.1[1],
    ("periodic", "{ x = [\"-3.819 mm\", \"3.819 mm\"] }"),
    ("body.bar.velocity", "[\"600 m/s\", \"-300 m/s\"]"),
    (
        "body.bar.shape",
        "{ union = [{ box = { min = [\"-3.819 mm\", \"0 mm\"], max = [\"3.819 mm\", \"3.819 mm\"] } }, \
           { box = { min = [\"-1.9095 mm\", \"3.819 mm\"], max = [\"1.9095 mm\", \"15.276 mm\"] } }] }",
    ),
];

#[test]
fn the_default_method_matches_the_cpu() {
    compare(IRON.0, &ON_A_FOOT, 8e-6, 1e-4);
    // So fast that it is several cells away.
    let fast = ("body.bar.velocity", "[\"6000 m/s\", \"-300 m/s\"]");
    compare_fields(IRON.0, &[&ON_A_FOOT[..3], &[ON_A_FOOT[4], fast]].concat(), 3e-6);
    conserves_and_repeats(IRON.0, &ON_A_FOOT, 2e-6);
}

/// One that is half a spacing from its images, of which it knows nothing until it is renewed; fast, so that it is cells away then.
pub(super) const JOINED: [(&str, &str); 5] = [
    IRON.1[0],
    IRON.1[1],
    ("periodic", "{ x = [\"-4.2 mm\", \"4.2 mm\"] }"),
    ("body.bar.velocity", "[\"3000 m/s\", \"-200 m/s\"]"),
    ("search.total-lagrangian.renewal", "1.1"),
];

#[test]
fn separated_parts_are_wrapped_and_meet_their_images() {
    compare_renewals(shipped(IRON.0), &JOINED, 12e-6, 1, (1e-4, 3e-4));
    conserves_and_repeats_text(IRON.0, shipped(IRON.0), &JOINED, 8e-6);
}

#[test]
fn the_adaptive_search_matches_the_cpu() {
    let fast = ("body.plate.velocity", "[\"300 m/s\", \"-200 m/s\"]");
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    for search in ["\"adaptive\"", "{ adaptive = { guard = \"none\" } }"] {
        let plate = [LEAVES[0], LEAVES[1], LEAVES[2], fast, leapfrog, ("search", search)];
        compare_searches(PLATE.0, &plate, (100, 6e-6), (0, 1, 1e-3));
        compare(PLATE.0, &plate, 6e-6, 1e-4);
    }
    let guarded = [LEAVES[0], LEAVES[1], LEAVES[2], fast, leapfrog, ("search", "\"adaptive\"")];
    conserves_and_repeats(PLATE.0, &guarded, 2e-6);
}

/// Blocks of which the upper flies round the end of a periodic cell.
pub(super) const ACROSS: [(&str, &str); 2] =
    [("periodic", "{ x = [\"-4 mm\", \"5 mm\"] }"), ("body.upper.velocity", "[\"300 m/s\", \"-120 m/s\"]")];

#[test]
fn bodies_in_contact_across_the_ends_match_the_cpu() {
    let text = striking(&format!("{PRESENT}\n{RUBS}"));
    compare_contact(&text, &ACROSS, 7e-6, 2e-4);
    let leapfrog = ("numerics.integrator", "\"leapfrog\"");
    for search in ["\"skin\"", "\"adaptive\""] {
        compare_contact(&text, &[ACROSS[0], ACROSS[1], leapfrog, ("search", search)], 7e-6, 2e-4);
    }
    conserves_and_repeats_text("striking", &text, &ACROSS, 4e-6);
}
