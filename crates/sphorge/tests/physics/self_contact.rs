//! Contact of a body with itself in the total Lagrangian form.

use super::setup::{by_id, run_to, simulation};
use sphorge::engine::Simulation;

/// Two blocks of copper that fly at each other, as two bodies.
const TWO_BODIES: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
numerics = { precision = "double" }
time = { end = "30 us" }

[[body]]
name = "upper"
material = "ofhc-copper"
shape = { box = { min = ["-4 mm", "1.5 mm"], max = ["4 mm", "7.5 mm"] } }
velocity = ["0 m/s", "-100 m/s"]

[[body]]
name = "lower"
material = "ofhc-copper"
shape = { box = { min = ["-4 mm", "-7.5 mm"], max = ["4 mm", "-1.5 mm"] } }
velocity = ["0 m/s", "100 m/s"]
"#;

/// The same as one body.
const ONE_BODY: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
numerics = { precision = "double" }
time = { end = "30 us" }

[[body]]
name = "both"
material = "ofhc-copper"
shape.union = [
    { box = { min = ["-4 mm", "1.5 mm"], max = ["4 mm", "7.5 mm"] } },
    { box = { min = ["-4 mm", "-7.5 mm"], max = ["4 mm", "-1.5 mm"] } },
]
velocity-profile = { along = "y", amplitude = ["0 m/s", "-100 m/s"], rows = [["-1 mm", -1.0], ["1 mm", 1.0]] }
"#;

/// The upper of them, and its image.
const HALF: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
numerics = { precision = "double" }
time = { end = "30 us" }
symmetry = [{ axis = "y", at = "0 mm", side = "positive" }]

[[body]]
name = "upper"
material = "ofhc-copper"
shape = { box = { min = ["-4 mm", "1.5 mm"], max = ["4 mm", "7.5 mm"] } }
velocity = ["0 m/s", "-100 m/s"]
"#;

/// A hairpin whose arms are thrown against each other.
const HAIRPIN: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
numerics = { precision = "double" }
time = { end = "60 us" }

[[body]]
name = "hairpin"
material = "ofhc-copper"
shape.difference = [
    { box = { min = ["0 mm", "-3.5 mm"], max = ["16 mm", "3.5 mm"] } },
    { box = { min = ["5 mm", "-1.5 mm"], max = ["17 mm", "1.5 mm"] } },
]
velocity-profile = { along = "y", amplitude = ["0 m/s", "-80 m/s"], rows = [["-1 mm", -1.0], ["1 mm", 1.0]] }
"#;

/// Kinetic energy and plastic work, J/m.
fn energies(simulation: &Simulation) -> [f64; 2] {
    let energies = simulation.ledger().unwrap().total.energies;
    [energies.kinetic, energies.plastic_work]
}

/// Total energy less what was there at the start, over it, and momentum over the sum of `m |v|` at the start.
fn drifts(simulation: &Simulation, start: &sphorge::engine::Ledger) -> [f64; 2] {
    let ledger = simulation.ledger().unwrap();
    let (energy, scale) = (start.total_energy(), start.total.momentum_scale);
    [(ledger.total_energy() - energy - ledger.external_work) / energy, ledger.total.momentum[1] / scale]
}

#[test]
fn parts_of_one_body_meet_as_two_bodies_do() {
    // An image gives back the momentum of what it stands for.
    let run = |deck: &str, is_whole: bool| {
        let mut simulation = simulation(deck, &[]);
        let start = simulation.ledger().unwrap();
        let at_first = energies(&simulation)[0];
        let states = [18e-6, 22e-6, 30e-6].map(|end| {
            run_to(&mut simulation, end);
            energies(&simulation).map(|e| e / at_first)
        });
        let [energy, momentum] = drifts(&simulation, &start);
        assert!(energy.abs() < 1e-9 && (!is_whole || momentum.abs() < 1e-9), "{energy} {momentum}");
        states
    };
    let (two, one, half) = (run(TWO_BODIES, true), run(ONE_BODY, true), run(HALF, false));
    println!("{two:?}\n{one:?}\n{half:?}");
    for ((two, one), half) in two.iter().zip(&one).zip(&half) {
        for k in 0..2 {
            // Surfaces alone take part, and begin to press as far from each other.
            assert!((one[k] - two[k]).abs() < 0.02, "{one:?} {two:?}");
            assert!((one[k] - half[k]).abs() < 1e-9, "{one:?} {half:?}");
        }
    }
    assert!(one[0][0] < 0.9 && one[2][0] < 0.01, "{one:?}");
}

/// How far the particles of the upper arm are above the plane of symmetry at the end, m, at least.
fn lowest(simulation: &Simulation) -> f64 {
    let start = super::setup::simulation(HAIRPIN, &[]);
    let (first, now) = (start.particles().unwrap(), simulation.particles().unwrap());
    let (first_order, order) = (by_id(start.particles().unwrap()), by_id(simulation.particles().unwrap()));
    let upper = first_order.iter().zip(&order).filter(|(f, _)| first.position[**f][1] > 1.5e-3);
    upper.map(|(_, &i)| now.position[i][1]).fold(f64::INFINITY, f64::min)
}

#[test]
fn arms_of_a_hairpin_stop_each_other_unless_told_not_to() {
    let run = |meets: &str| {
        let mut simulation =
            simulation(HAIRPIN, &[("search", &format!("{{ total-lagrangian = {{ self-contact = {meets} }} }}"))]);
        let start = simulation.ledger().unwrap();
        run_to(&mut simulation, 60e-6);
        for drift in drifts(&simulation, &start) {
            assert!(drift.abs() < 1e-9, "{drift}");
        }
        lowest(&simulation)
    };
    let (met, passed) = (run("true"), run("false"));
    println!("{met:e} {passed:e}");
    assert!(met > 0.1e-3 && passed < -0.5e-3, "{met} {passed}");
}

#[test]
fn what_comes_apart_keeps_the_energy_its_contact_held() {
    let mut simulation = simulation(ONE_BODY, &[("search", "{ total-lagrangian = { renewal = 1.3 } }")]);
    let start = simulation.ledger().unwrap();
    let held = |simulation: &Simulation| simulation.ledger().unwrap().contacts[0].stored_energy;
    let mut most = 0.0f64;
    while simulation.time() < 30e-6 {
        simulation.step(Some(30e-6)).unwrap();
        most = most.max(held(&simulation));
    }
    println!("{most} {}", held(&simulation));
    assert!(most > 1e-3 * start.total_energy() && held(&simulation) == 0.0, "{most}");
    for drift in drifts(&simulation, &start) {
        assert!(drift.abs() < 1e-9, "{drift}");
    }
}
