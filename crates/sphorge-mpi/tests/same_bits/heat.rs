//! Conduction of heat and its boundaries.

use super::{compare, contact::CLAMP, symmetry::CORNER};

#[test]
fn a_block_that_cools_and_does_not_move() {
    let changes = [("time.end", "\"20 s\""), ("output.frames", "2"), ("output.history-interval", "\"1 s\"")];
    compare("convecting-block", &changes, &[1, 2, 3, 4, 5, 7]);
}

#[test]
fn two_metals_in_one_dimension() {
    let changes = [
        ("particles.spacing", "\"0.2 mm\""),
        ("time.end", "\"10 ms\""),
        ("output.frames", "2"),
        ("output.history-interval", "\"1 ms\""),
    ];
    compare("two-materials", &changes, &[2, 3]);
}

/// Heat of four kinds, for a deck with a clamp or a corner.
const HEAT: &str = r#"
[thermal]

[[thermal.boundary]]
name = "held"
body = "BODY"
region = "edge"
hold = "400 K"

[[thermal.boundary]]
name = "lamp"
body = "BODY"
flux = "2e9 W/m^2"

[[thermal.boundary]]
name = "water"
convection = { coefficient = "1e7 W/(m^2 K)", ambient = "250 K" }

[[region]]
name = "edge"
shape = { box = { min = ["0 mm", "0 mm"], max = ["30 mm", "1 mm"] } }
"#;

#[test]
fn bodies_that_meet_rub_and_conduct_in_the_initial_configuration() {
    compare(&format!("{CLAMP}{}", HEAT.replace("BODY", "clamp")), &[], &[1, 2, 3, 4, 7]);
}

#[test]
fn bodies_of_the_present_configuration_and_their_images() {
    let deck = format!("{CORNER}{}", HEAT.replace("BODY", "corner"));
    compare(&deck, &[], &[2, 3]);
    compare(&deck, &[("contact", "\"penalty\""), ("search", "\"skin\"")], &[4]);
}
