//! Contact of a body with itself in the total Lagrangian form.

use super::setup::{by_id, run_to, simulation};
use sphorge::engine::{FieldSource, Simulation};

/// Copper in plane strain, to be followed by bodies.
const HEAD: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
numerics = { precision = "double" }
time = { end = "60 us" }
"#;

/// A block 8 mm wide, its middle `shift` millimetres aside, between two heights, mm.
fn block(shift: f64, low: f64, high: f64) -> String {
    format!(
        "{{ box = {{ min = [\"{} mm\", \"{low} mm\"], max = [\"{} mm\", \"{high} mm\"] }} }}",
        shift - 4.0,
        shift + 4.0
    )
}

/// A body of copper with that shape that moves along y, m/s.
fn body(name: &str, shape: &str, speed: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nmaterial = \"ofhc-copper\"\nshape = {shape}\nvelocity = [\"0 m/s\", \"{speed} m/s\"]\n"
    )
}

/// A body of copper with that shape whose upper half moves down and whose lower half moves up, m/s.
fn body_that_closes(shape: &str, speed: f64) -> String {
    format!(
        "[[body]]\nname = \"both\"\nmaterial = \"ofhc-copper\"\nshape = {shape}\n\
         velocity-profile = {{ along = \"y\", amplitude = [\"0 m/s\", \"-{speed} m/s\"], rows = [[\"-1 mm\", -1.0], [\"1 mm\", 1.0]] }}\n"
    )
}

/// Two blocks that fly at each other, as two bodies; the upper one is `shift` millimetres to the right, the lower one as far to the left.
fn two_bodies(shift: f64) -> String {
    let (upper, lower) = (block(shift, 1.5, 7.5), block(-shift, -7.5, -1.5));
    format!("{HEAD}{}{}", body("upper", &upper, -100.0), body("lower", &lower, 100.0))
}

/// The same as one body.
fn one_body(shift: f64) -> String {
    let shape = format!("{{ union = [{}, {}] }}", block(shift, 1.5, 7.5), block(-shift, -7.5, -1.5));
    format!("{HEAD}{}", body_that_closes(&shape, 100.0))
}

/// The upper of them, and its image.
fn half() -> String {
    let plane = "symmetry = [{ axis = \"y\", at = \"0 mm\", side = \"positive\" }]\n";
    format!("{HEAD}{plane}{}", body("upper", &block(0.0, 1.5, 7.5), -100.0))
}

/// A hairpin whose arms are thrown against each other.
fn hairpin() -> String {
    let whole = r#"{ box = { min = ["0 mm", "-3.5 mm"], max = ["16 mm", "3.5 mm"] } }"#;
    let slot = r#"{ box = { min = ["5 mm", "-1.5 mm"], max = ["17 mm", "1.5 mm"] } }"#;
    format!("{HEAD}{}", body_that_closes(&format!("{{ difference = [{whole}, {slot}] }}"), 80.0))
}

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
    let run = |deck: &str, surfaces: &str, is_whole: bool| {
        let contact = format!("{{ penalty = {{ surfaces = \"{surfaces}\" }} }}");
        let mut simulation = simulation(deck, &[("contact", &contact)]);
        let start = simulation.ledger().unwrap();
        let at_first = energies(&simulation)[0];
        let states = [18e-6, 22e-6, 30e-6].map(|end| {
            run_to(&mut simulation, end);
            energies(&simulation).map(|e| e / at_first)
        });
        let [energy, momentum] = drifts(&simulation, &start);
        assert!(energy.abs() < 1e-9 && (!is_whole || momentum.abs() < 1e-9), "{surfaces}: {energy} {momentum}");
        states
    };
    for surfaces in ["facets", "overlap"] {
        let [two, one, half] = [(two_bodies(0.0), true), (one_body(0.0), true), (half(), false)]
            .map(|(deck, is_whole)| run(&deck, surfaces, is_whole));
        println!("{surfaces}\n{two:?}\n{one:?}\n{half:?}");
        for ((two, one), half) in two.iter().zip(&one).zip(&half) {
            for k in 0..2 {
                // Surfaces alone take part, and begin to press as far from each other.
                assert!((one[k] - two[k]).abs() < 0.02, "{surfaces}: {one:?} {two:?}");
                // Coincident edges of facets move with the first of a pair, which is no image of the other.
                let is_alike = surfaces == "facets" || (one[k] - half[k]).abs() < 1e-9;
                assert!(is_alike, "{surfaces}: {one:?} {half:?}");
            }
        }
        assert!(one[0][0] < 0.9 && one[2][0] < 0.01, "{surfaces}: {one:?}");
    }
}

/// How far the particles of the upper arm are above the plane of symmetry at the end, m, at least.
fn lowest(simulation: &Simulation) -> f64 {
    let start = super::setup::simulation(&hairpin(), &[]);
    let (first, now) = (start.particles().unwrap(), simulation.particles().unwrap());
    let (first_order, order) = (by_id(start.particles().unwrap()), by_id(simulation.particles().unwrap()));
    let upper = first_order.iter().zip(&order).filter(|(f, _)| first.position[**f][1] > 1.5e-3);
    upper.map(|(_, &i)| now.position[i][1]).fold(f64::INFINITY, f64::min)
}

#[test]
fn arms_of_a_hairpin_stop_each_other_unless_told_not_to() {
    let run = |meets: &str| {
        let mut simulation =
            simulation(&hairpin(), &[("search", &format!("{{ total-lagrangian = {{ self-contact = {meets} }} }}"))]);
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
fn what_slides_past_a_corner_stores_no_less_than_nothing() {
    // Corners meet flats.
    for (by, surfaces) in [2.0, 3.25].into_iter().flat_map(|by| ["overlap", "facets"].map(|surfaces| (by, surfaces))) {
        let contact = format!("{{ penalty = {{ surfaces = \"{surfaces}\" }} }}");
        let run = |deck: &str, self_contact: bool| {
            let mut simulation = simulation(deck, &[("contact", &contact)]);
            let (start, mut least) = (simulation.ledger().unwrap(), 0.0f64);
            let of = usize::from(!self_contact && start.contacts.len() > 1);
            while simulation.time() < 30e-6 {
                simulation.step(Some(30e-6)).unwrap();
                least = least.min(simulation.ledger().unwrap().contacts[of].stored_energy);
            }
            [least / start.total_energy(), energies(&simulation)[1] / start.total_energy()]
        };
        let ([one, plastic_of_one], [two, plastic_of_two]) = (run(&one_body(by), true), run(&two_bodies(by), false));
        println!(
            "{by} mm, {surfaces}: {one:.4} and {two:.4} of the energy, plastic work {plastic_of_one:.4} and {plastic_of_two:.4}"
        );
        assert!(one > -0.005, "{by} mm, {surfaces}: {one}");
        assert!(
            (plastic_of_one - plastic_of_two).abs() < 0.02,
            "{by} mm, {surfaces}: {plastic_of_one} {plastic_of_two}"
        );
    }
}

#[test]
fn what_comes_apart_keeps_the_energy_its_contact_held() {
    let mut simulation = simulation(&one_body(0.0), &[("search", "{ total-lagrangian = { renewal = 1.2 } }")]);
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

/// A plate that is clamped at both ends and struck by a block; what is severed flies through its other pieces.
const STRUCK: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
time = { end = "30 us" }
[material.soft]
density = "7800 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
strength = { perfectly-plastic = { yield-stress = "200 MPa" } }
damage = { failure-strain = { strain = 0.1 } }
after-failure = "delete"
[material.hard]
density = "7800 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
strength = "elastic"
[[body]]
name = "plate"
material = "soft"
shape = { box = { min = ["-12 mm", "-2 mm"], max = ["12 mm", "0 mm"] } }
[[body]]
name = "block"
material = "hard"
shape = { box = { min = ["-2 mm", "0 mm"], max = ["2 mm", "4 mm"] } }
velocity = ["0 m/s", "-150 m/s"]
[[region]]
name = "rim"
shape = { union = [{ box = { min = ["-12 mm", "-2 mm"], max = ["-10 mm", "0 mm"] } }, { box = { min = ["10 mm", "-2 mm"], max = ["12 mm", "0 mm"] } }] }
[[motion]]
region = "rim"
velocity = ["0 m/s", "0 m/s"]
"#;

/// Facets that severed particles carried through their own body were met from behind: 1 kJ became 2 MJ at 10.56 us with "delete", and 14 and 37 us with
/// the other two.
#[test]
fn what_is_severed_does_not_meet_its_own_body_from_behind() {
    for (after, end) in [("delete", 12e-6), ("fluid", 30e-6)] {
        let mut simulation = simulation(STRUCK, &[("material.soft.after-failure", after)]);
        let supplied = simulation.ledger().unwrap().total.energies.kinetic;
        run_to(&mut simulation, end);
        let ledger = simulation.ledger().unwrap();
        let made = ledger.integration_energy + ledger.contacts.iter().map(|c| c.integration_energy).sum::<f64>();
        println!("{after}: {:.4} of the energy made by the steps", made / supplied);
        assert!(made.abs() < 0.05 * supplied, "{after}: {made} J of {supplied}");
        let integrity = simulation.read("integrity").unwrap();
        let least = (0..integrity.len()).map(|k| integrity.component(k, 0)).fold(1.0, f64::min);
        assert_eq!(least, 0.0, "{after}: nothing is severed");
    }
}
