//! Bodies meet however fast they approach each other.

use super::setup::{run_to, simulation};

/// Two plates of copper that touch; at 20 km/s a step that sound alone limits takes them past each other.
const PLATES: &str = r#"
dimensions = "1d"
particles = { spacing = "0.1 mm" }
time = { end = "1 us", step-control = { repeats = 0 } }

[material.m]
density = "8930 kg/m^3"
specific-heat = "385 J/(kg K)"
equation-of-state = { mie-gruneisen = { sound-speed = "3940 m/s", shock-slope = 1.49, gruneisen = 2.0 } }
strength = "none"

[[body]]
name = "flyer"
material = "m"
shape = { box = { min = ["-20 mm"], max = ["0 mm"] } }
velocity = ["20 km/s"]

[[body]]
name = "target"
material = "m"
shape = { box = { min = ["0 mm"], max = ["20 mm"] } }
"#;

#[test]
fn plates_at_twenty_kilometres_a_second_do_not_pass_through_each_other() {
    let mut simulation = simulation(PLATES, &[]);
    let start = simulation.ledger().unwrap().total.energies.kinetic;
    run_to(&mut simulation, 20e-9);
    let lost = 1.0 - simulation.ledger().unwrap().total.energies.kinetic / start;
    // Half of the energy of what the shocks have reached, at 18.84 km/s, is 0.94 %.
    assert!(lost > 0.005 && lost < 0.02, "{lost}");
}

#[test]
fn bodies_that_may_meet_step_no_farther_than_at_a_courant_number_of_a_third() {
    let alone = PLATES.split("\n[[body]]\nname = \"target\"").next().unwrap();
    let first = |deck: &str, courant: &str| {
        let slow = [("body.flyer.velocity", "[\"100 m/s\"]"), ("time.courant", courant)];
        simulation(deck, &slow).step(None).unwrap().dt
    };
    let usual = first(PLATES, "0.3");
    for courant in ["0.45", "0.6"] {
        let share = first(PLATES, courant) / usual;
        assert!((share - 1.0).abs() < 1e-9, "{courant}: {share}");
    }
    // Walls press facets as other bodies do, points as they may.
    let walled = |surfaces: &str| {
        format!(
            "{alone}\n[[wall]]\nname = \"wall\"\nplane = {{ point = [\"30 mm\"], normal = [-1] }}\ncontact = {{ penalty = {{ surfaces = \"{surfaces}\" }} }}\n"
        )
    };
    assert!((first(&walled("facets"), "0.45") / usual - 1.0).abs() < 1e-9);
    assert!((first(&walled("particles"), "0.45") / usual - 1.5).abs() < 1e-9);
    // A body that is alone is bound by waves only, and a smaller number is what it is.
    assert!((first(alone, "0.45") / first(alone, "0.3") - 1.5).abs() < 1e-9);
    assert!((first(PLATES, "0.1") / usual - 1.0 / 3.0).abs() < 1e-9);
}

#[test]
fn an_impact_books_little_of_its_energy_to_the_integration() {
    let mut simulation = simulation(PLATES, &[("body.flyer.velocity", "[\"1 km/s\"]")]);
    let brought = simulation.ledger().unwrap().total.energies.kinetic;
    run_to(&mut simulation, 20e-9);
    // The first layers alone are in it: 20 ns at 4.7 km/s.
    let share = simulation.ledger().unwrap().integration_energy.abs() / brought;
    assert!(share < 0.0016, "{share}");
}
