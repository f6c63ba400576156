//! Contact at the facets of particles: where bodies touch, how they rest, slide and bounce.

use super::setup::{run_steps, run_to, simulation};
use sphorge::engine::Simulation;

/// Two elastic blocks of steel that share a face; the springs against hourglass modes are not what is tested.
const BLOCKS: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
search = { total-lagrangian = { hourglass = 0 } }
time = { end = "1 ms" }

[material.steel]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "upper"
material = "steel"
shape = { box = { min = ["-6 mm", "0 mm"], max = ["6 mm", "6 mm"] } }

[[body]]
name = "lower"
material = "steel"
shape = { box = { min = ["-10 mm", "-6 mm"], max = ["10 mm", "0 mm"] } }
"#;

/// Largest speed of any particle, m/s.
fn fastest(simulation: &Simulation) -> f64 {
    simulation.particles().unwrap().velocity.iter().flatten().fold(0.0, |most, c| f64::max(most, c.abs()))
}

/// What the contact of bodies `a` and `b` of two holds, J/m.
fn held(simulation: &Simulation, pair: usize) -> f64 {
    simulation.ledger().unwrap().contacts[pair].stored_energy
}

#[test]
fn what_touches_at_the_start_stays_at_rest() {
    // Lattices in line, shifted, finer, coarser, and edges that are no multiples of their spacing.
    let cases: [&[(&str, &str)]; 5] = [
        &[],
        &[("body.upper.shape.shift", "[\"0.3 mm\", 0]")],
        &[("body.upper.spacing", "0.8 mm")],
        &[("body.upper.spacing", "0.25 mm")],
        &[("body.lower.spacing", "0.7 mm")],
    ];
    for overrides in cases {
        let mut simulation = simulation(BLOCKS, overrides);
        run_steps(&mut simulation, 300);
        // A millionth of the sound speed would be 5 mm/s.
        let fastest = fastest(&simulation);
        assert!(fastest < 1e-9, "{overrides:?}: {fastest}");
        assert!(held(&simulation, 1) < 1e-12, "{overrides:?}: {}", held(&simulation, 1));
    }
}

#[test]
fn what_rests_on_edges_by_less_than_a_spacing_stays_there() {
    // A beam on two ledges, whose sides lie beside theirs, closer to be pressed apart sideways than its particles are to each other.
    let beam = r#"
dimensions = "plane-strain"
gravity = ["0 m/s^2", "-1000 m/s^2"]
particles = { spacing = "1 mm" }
time = { end = "1 ms" }

[material.soft]
density = "1000 kg/m^3"
young-modulus = "1 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "beam"
material = "soft"
shape = { box = { min = ["-0.5 mm", "0 mm"], max = ["12.5 mm", "6 mm"] } }

[[body]]
name = "left"
material = "soft"
shape = { box = { min = ["-10 mm", "-6 mm"], max = ["0 mm", "0 mm"] } }

[[body]]
name = "right"
material = "soft"
shape = { box = { min = ["12 mm", "-6 mm"], max = ["22 mm", "0 mm"] } }

[[region]]
name = "feet"
shape = { box = { min = ["-11 mm", "-6 mm"], max = ["23 mm", "-5 mm"] } }

[[motion]]
region = "feet"
velocity = ["0 m/s", "0 m/s"]
"#;
    for overlap in ["-0.5 mm", "-0.1 mm", "-1 mm"] {
        let right = format!("{} mm", 12.0 - overlap.trim_end_matches(" mm").parse::<f64>().unwrap());
        let overrides = [(
            "body.beam.shape",
            &*format!("{{ box = {{ min = [\"{overlap}\", 0], max = [\"{right}\", \"6 mm\"] }} }}"),
        )];
        let mut simulation = simulation(beam, &overrides);
        run_to(&mut simulation, 0.3e-3);
        // It falls by what the corners give: at a speed below that of a free fall.
        let ledger = simulation.ledger().unwrap();
        let mass = 1000.0 * 13.0 * 6e-6;
        let fallen = ledger.bodies[0].energies.kinetic / (0.5 * mass * (1000.0f64 * 0.3e-3).powi(2));
        assert!(fallen < 0.5, "{overlap}: {fallen}");
        assert!(ledger.bodies[0].momentum[0].abs() < 1e-3 * mass, "{overlap}: {:?}", ledger.bodies[0].momentum);
        assert!(fastest(&simulation) < 0.5, "{overlap}: {}", fastest(&simulation));
    }
}

#[test]
fn a_roller_on_slices_as_wide_rebounds_with_what_it_brought() {
    // Edges of both lie along each other, and all but parallel where the roller deforms.
    let roller = r#"
dimensions = "3d"
particles = { spacing = "1 mm" }
time = { end = "30 us" }

[material.steel]
density = "7800 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
strength = "elastic"

[[body]]
name = "roller"
material = "steel"
shape = { cylinder = { from = ["0 mm", "0 mm", "4 mm"], to = ["2 mm", "0 mm", "4 mm"], radius = "4 mm" } }
velocity = ["0 m/s", "3 m/s", "-20 m/s"]

[[body]]
name = "plate"
material = "steel"
shape = { box = { min = ["0 mm", "-5 mm", "-4 mm"], max = ["2 mm", "5 mm", "0 mm"] } }
"#;
    let mut simulation = simulation(roller, &[]);
    simulation.next_step_estimate().unwrap();
    let kinetic = simulation.ledger().unwrap().total.energies.kinetic;
    let mut pushed = 0.0f64;
    while simulation.time() < 15e-6 {
        simulation.step(Some(15e-6)).unwrap();
        let ledger = simulation.ledger().unwrap();
        assert!(ledger.total.energies.kinetic < 1.001 * kinetic, "{:e} s", simulation.time());
        let [x, y, z] = ledger.contacts[1].force;
        pushed = pushed.max(z.abs());
        assert!(x.abs().max(y.abs()) < 0.05 * z.abs() + 10.0, "{x} {y} {z}");
    }
    assert!(pushed > 1e3, "{pushed}");
}

/// A ring in a bore, a ball in a socket: round bodies that touch all around.
#[test]
fn a_rod_rests_in_its_sleeve() {
    let rod = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm", lattice = "rings" }
search = { total-lagrangian = { hourglass = 0 } }
time = { end = "1 ms" }

[[body]]
name = "rod"
material = "ofhc-copper"
shape = { disc = { centre = ["0 mm", "0 mm"], radius = "10 mm" } }

[[body]]
name = "sleeve"
material = "ofhc-copper"
spacing = "0.8 mm"
shape = { disc = { centre = ["0 mm", "0 mm"], radius = "14 mm", inner-radius = "10 mm" } }
"#;
    let mut simulation = simulation(rod, &[]);
    run_steps(&mut simulation, 300);
    let fastest = fastest(&simulation);
    assert!(fastest < 4e-3, "a millionth of the sound speed: {fastest}");
}

#[test]
fn blocks_bounce_with_their_energy_and_their_spin() {
    // A corner first, off centre, with spacings of one to four: couples, edges and slopes all act.
    let whole = "{ min = [\"-6 mm\", \"0 mm\"], max = [\"6 mm\", \"6 mm\"] }";
    let small = "{ min = [\"-2 mm\", \"0 mm\"], max = [\"2 mm\", \"3 mm\"] }";
    for (spacing, turn, size) in [("1 mm", "17 deg", whole), ("0.25 mm", "17 deg", small), ("0.5 mm", "0 deg", whole)] {
        let overrides = [
            ("body.upper.spacing", spacing),
            ("body.upper.shape.box", size),
            ("body.upper.shape.shift", "[\"1.3 mm\", \"2 mm\"]"),
            ("body.upper.shape.rotate", &format!("{{ angle = \"{turn}\", about = [\"0 mm\", \"0 mm\"] }}")),
            ("body.upper.velocity", "[\"0 m/s\", \"-20 m/s\"]"),
            ("contact", "{ penalty = { damping = 0.0 } }"),
            ("numerics.viscosity", "false"),
            ("numerics.precision", "double"),
        ];
        let mut simulation = simulation(BLOCKS, &overrides);
        simulation.next_step_estimate().unwrap();
        let first = simulation.ledger().unwrap();
        let kinetic = first.total.energies.kinetic;
        let (mut most, mut drift, mut turned) = (0.0f64, 0.0f64, 0.0f64);
        while simulation.time() < 300e-6 {
            // Sums over all particles take as long as a step.
            for _ in 0..16 {
                simulation.step(Some(300e-6)).unwrap();
            }
            let now = simulation.ledger().unwrap();
            most = most.max(now.contacts[1].stored_energy / kinetic);
            drift = drift.max((now.total.angular_momentum[2] - first.total.angular_momentum[2]).abs());
            turned = turned.max((now.bodies[0].angular_momentum[2] - first.bodies[0].angular_momentum[2]).abs());
        }
        let now = simulation.ledger().unwrap();
        let energies = now.total.energies;
        let after = (energies.kinetic + energies.elastic) / kinetic;
        assert!(most > 0.01 && now.contacts[1].force == [0.0; 3], "{spacing}, {turn}: they met and parted, {most}");
        assert!((0.98..1.005).contains(&after), "{spacing}, {turn}: {after}");
        assert!(drift < 1e-11 * turned, "{spacing}, {turn}: {drift} of {turned}");
    }
}

/// Acceleration along a slope of 30 degrees, and towards it, m/s^2.
const SLOPE: [f64; 2] = [4.905, -8.495709];

/// A block on this slope, with so many times its weight.
fn on_slope(friction: &str, weights: f64, steps_until: f64) -> (Simulation, f64) {
    let [along, towards] = SLOPE.map(|g| weights * g);
    let gravity = format!("[\"{along} m/s^2\", \"{towards} m/s^2\"]");
    // The load comes at once: damping ends the bounce.
    let contact = format!("{{ penalty = {{ friction = {friction}, damping = 1.0 }} }}");
    let overrides = [("gravity", gravity.as_str()), ("contact", contact.as_str()), ("numerics.precision", "double")];
    let text = format!(
        "{BLOCKS}\n[[region]]\nname = \"base\"\nbody = \"lower\"\n[[motion]]\nregion = \"base\"\nvelocity = [\"0 m/s\", \"0 m/s\"]\n"
    );
    let mut simulation = simulation(&text, &overrides);
    run_to(&mut simulation, steps_until);
    let ledger = simulation.ledger().unwrap();
    let speed = ledger.bodies[0].momentum[0] / ledger.bodies[0].mass;
    (simulation, speed)
}

#[test]
fn a_block_slides_down_a_slope_by_the_law_of_coulomb() {
    let end = 200e-6;
    let (simulation, speed) = on_slope("0.3", 1e3, end);
    // The block is let go without weight on the slope; the load is there after a few of its oscillations.
    let expected = 1e3 * (SLOPE[0] + 0.3 * SLOPE[1]) * end;
    assert!((speed / expected - 1.0).abs() < 0.02, "{speed} of {expected}");
    let ledger = simulation.ledger().unwrap();
    // Heat is what the weight does on the way less what became motion and went elsewhere.
    let contact = ledger.contacts[1];
    let energies = ledger.total.energies;
    let elsewhere = energies.kinetic + energies.elastic + contact.stored_energy + contact.damping_work;
    let expected = ledger.external_work - elsewhere - ledger.viscous_energy;
    assert!((contact.friction_work / expected - 1.0).abs() < 0.01, "{contact:?} of {expected}");
}

#[test]
fn a_block_slides_down_a_slope_under_its_own_weight() {
    // It closes some 1e-9 of a spacing, over which friction must have its stiffness. While it still bounces, at first, it is held less.
    let half = 500e-6;
    let (mut simulation, early) = on_slope("0.3", 1.0, half);
    let expected = (SLOPE[0] + 0.3 * SLOPE[1]) * half;
    assert!((early / expected - 1.0).abs() < 0.1, "{early} of {expected}");
    // Over twice and four times that.
    for times in [2.0, 4.0] {
        run_to(&mut simulation, times * half);
        let ledger = simulation.ledger().unwrap();
        let gained = (ledger.bodies[0].momentum[0] / ledger.bodies[0].mass - early) / (times - 1.0);
        assert!((gained / expected - 1.0).abs() < 0.01, "until {times} times the start: {gained} of {expected}");
    }
}

#[test]
fn a_block_slides_over_a_lattice_without_bumps() {
    // Pressed by its weight, over seven spacings of the other body, whose lattice is not in line with its own.
    let overrides = [
        ("body.upper.spacing", "0.8 mm"),
        ("body.upper.velocity", "[\"100 m/s\", 0]"),
        ("body.lower.shape.box.min.0", "-40 mm"),
        ("body.lower.shape.box.max.0", "40 mm"),
        ("gravity", "[0, \"-1e5 m/s^2\"]"),
        ("numerics.precision", "double"),
        ("contact", "{ penalty = { damping = 1.0 } }"),
    ];
    let text = format!(
        "{BLOCKS}\n[[region]]\nname = \"base\"\nbody = \"lower\"\n[[motion]]\nregion = \"base\"\nvelocity = [\"0 m/s\", \"0 m/s\"]\n"
    );
    let mut simulation = simulation(&text, &overrides);
    run_to(&mut simulation, 70e-6);
    let ledger = simulation.ledger().unwrap();
    let slowed = 100.0 - ledger.bodies[0].momentum[0] / ledger.bodies[0].mass;
    // A friction of a thousandth would take away 7e-3 m/s.
    assert!(slowed.abs() < 7e-3, "{slowed}");
}

#[test]
fn bodies_deep_in_each_other_at_the_start_are_refused_and_little_overlap_is_told() {
    let load = |shift: &str| {
        let overrides = [
            ("body.upper.shape.shift".to_owned(), format!("[0, \"{shift}\"]")),
            ("contact.penalty.surfaces".to_owned(), "facets".to_owned()),
        ];
        sphorge::deck::load_text("test", BLOCKS, &overrides)
    };
    assert!(load("0 mm").unwrap().notes.iter().all(|note| !note.contains("deep in each other")));
    // 12 mm of a face 0.05 mm deep: k = 2 K/(1 mm), U = k d²/2 (1 + d/D) a little more.
    let notes = load("-0.05 mm").unwrap().notes;
    let note = notes.iter().find(|note| note.contains("deep in each other")).unwrap();
    let energy: f64 = note.split("holds ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let bulk = 210e9 / (3.0 * (1.0 - 0.6));
    let plane = 0.5 * 2.0 * bulk / 1e-3 * 0.05e-3f64.powi(2) * 12e-3;
    assert!((energy / plane - 1.0).abs() < 0.06, "{energy} of {plane}: {note}");
    let depth: f64 = note.split("are ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(note.contains("`upper`") && (depth / 0.05 - 1.0).abs() < 0.04, "{note}");
    let report = format!("{:?}", load("-0.2 mm").err().unwrap());
    assert!(report.contains("press each other"), "{report}");
}

#[test]
fn a_press_fit_is_told_with_the_force_all_around() {
    let fit = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm", lattice = "rings" }
time = { end = "1 us" }

[[body]]
name = "shaft"
material = "ofhc-copper"
shape = { disc = { centre = ["0 mm", "0 mm"], radius = "10.02 mm" } }

[[body]]
name = "hub"
material = "ofhc-copper"
shape = { disc = { centre = ["0 mm", "0 mm"], radius = "16 mm", inner-radius = "10 mm" } }
"#;
    let notes = sphorge::deck::load_text("fit", fit, &[]).unwrap().notes;
    let note = notes.iter().find(|note| note.contains("deep in each other")).unwrap();
    // k = 2 K/(1 mm) by 0.02 mm on 63 mm.
    let force: f64 = note.split("pushes with ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let about = 2.0 * 137e9 / 1e-3 * 0.02e-3 * 63e-3;
    assert!((0.8..1.25).contains(&(force / about)), "{force:e}, about {about:e}: {note}");
    assert!(note.contains("from all sides") && note.contains("press fit") && !note.contains("move `"), "{note}");
}
