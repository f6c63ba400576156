//! What the engine must keep, on small problems: conservation, independence of threads and of the search, boundaries.

use sphorge::{Particles, deck::load_text, solver::Simulation};

/// A deck, the changes to it, and its simulation.
fn simulation(deck: &str, overrides: &[(&str, &str)]) -> Simulation {
    let overrides: Vec<(String, String)> = overrides.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect();
    let setup = load_text("test", deck, &overrides).expect("the deck is right");
    Simulation::new(setup.model, setup.particles)
}

/// Runs `steps` steps in a pool of `threads` threads and returns the simulation.
fn run(mut simulation: Simulation, steps: u64, threads: usize) -> Simulation {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        for _ in 0..steps {
            simulation.step(None).expect("a sound step");
        }
    });
    simulation
}

/// Velocities in the order of the particles' ids.
fn velocities(p: &Particles) -> Vec<[f64; 3]> {
    let mut sorted: Vec<(u32, [f64; 3])> = p.id.iter().copied().zip(p.velocity.iter().copied()).collect();
    sorted.sort_by_key(|v| v.0);
    sorted.into_iter().map(|v| v.1).collect()
}

fn largest_difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Two plates collide off centre, with everything the papers switch on.
const COLLISION: &str = r#"
title = "Two plates collide"
dimensions = "plane-strain"

[particles]
spacing = "1 mm"

[numerics]
precision = "double"
xsph = 0.5
artificial-stress = { epsilon = 0.3, exponent = 4 }

[time]
end = "1 s"

[[body]]
name = "left"
material = "armco-iron"
shape = { box = { min = ["-12 mm", "0 mm"], max = ["0 mm", "10 mm"] } }
velocity = ["150 m/s", "0 m/s"]

[[body]]
name = "right"
material = "armco-iron"
shape = { box = { min = ["0 mm", "4 mm"], max = ["12 mm", "14 mm"] } }
velocity = ["-150 m/s", "20 m/s"]
"#;

#[test]
fn momentum_and_energy_are_conserved_to_round_off() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        for split in ["own-stress", "symmetric"] {
            let overrides = [("numerics.integrator", integrator), ("numerics.energy-split", split)];
            let simulation = simulation(COLLISION, &overrides);
            let before = simulation.ledger();
            let after = run(simulation, 200, 2).ledger();
            let total = |l: &sphorge::solver::Ledger| l.total.energies.kinetic + l.total.energies.internal;
            assert!(after.total.energies.plastic_work > 1e-3 * total(&before), "nothing happened");
            assert!((total(&after) / total(&before) - 1.0).abs() < 1e-12, "{integrator} {split}: energy");
            for a in 0..3 {
                let drift = (after.total.momentum[a] - before.total.momentum[a]).abs() / before.total.momentum_scale;
                assert!(drift < 1e-13, "{integrator} {split}: momentum {drift}");
            }
        }
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    for precision in ["mixed", "double"] {
        let overrides = [("numerics.precision", precision)];
        let one = run(simulation(COLLISION, &overrides), 150, 1);
        let two = run(simulation(COLLISION, &overrides), 150, 2);
        assert_eq!(velocities(one.particles()), velocities(two.particles()), "{precision}");
        assert_eq!(one.particles().plastic_strain, two.particles().plastic_strain);
    }
}

#[test]
fn a_skin_and_single_precision_change_nothing_but_rounding() {
    let steps = 60;
    let reference = velocities(run(simulation(COLLISION, &[]), steps, 2).particles());
    let skin = velocities(run(simulation(COLLISION, &[("search", "skin")]), steps, 2).particles());
    assert!(largest_difference(&reference, &skin) < 1e-8, "skin: {}", largest_difference(&reference, &skin));
    let mixed = velocities(run(simulation(COLLISION, &[("numerics.precision", "mixed")]), steps, 2).particles());
    let difference = largest_difference(&reference, &mixed);
    assert!(difference > 0.0 && difference < 0.05, "mixed: {difference} m/s of 150");
}

/// A block falls, or slides on a wall.
const SLIDER: &str = r#"
title = "A block slides on a wall"
dimensions = "plane-strain"
gravity = ["0 m/s^2", "-1000 m/s^2"]

[particles]
spacing = "1 mm"

[numerics]
precision = "double"

[time]
end = "1 s"

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["12 mm", "6 mm"] } }
velocity = ["10 m/s", "0 m/s"]

[[wall]]
name = "floor"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { stiffness = 1.0, damping = 0.3, friction = 0.2 } }
"#;

#[test]
fn free_fall_is_exact() {
    let falling = run(simulation(SLIDER, &[("wall.floor.plane.point", "[\"0 mm\", \"-1 m\"]")]), 200, 1);
    let t = falling.time();
    for v in &falling.particles().velocity {
        assert!((v[0] - 10.0).abs() < 1e-9 && (v[1] + 1000.0 * t).abs() < 1e-9, "{v:?}");
    }
    let centre = falling.ledger().total.centre;
    assert!((centre[1] - (3e-3 - 500.0 * t * t)).abs() < 1e-12);
}

#[test]
fn friction_slows_a_sliding_block_by_mu_g() {
    let mut sliding = simulation(SLIDER, &[]);
    let mut impulse = [0.0; 3];
    let steps = 3000;
    for _ in 0..steps {
        sliding.step(None).expect("a sound step");
        impulse = sliding.ledger().external_impulse;
    }
    let ledger = sliding.ledger();
    let (mass, t) = (ledger.total.mass, sliding.time());
    // The wall's share of the vertical impulse is all but the weight's; Coulomb: the horizontal one is mu times it.
    let normal = impulse[1] + mass * 1000.0 * t;
    assert!((impulse[0] + 0.2 * normal).abs() < 1e-6 * normal, "{impulse:?} {normal}");
    // Resting on the wall, the block is slowed by mu g.
    let expected = mass * (10.0 - 0.2 * normal / mass);
    assert!((ledger.total.momentum[0] - expected).abs() < 1e-6 * expected.abs());
    assert!(
        (normal / (mass * 1000.0 * t) - 1.0).abs() < 0.1,
        "the block does not rest: {}",
        normal / (mass * 1000.0 * t)
    );
}

/// A column is driven at one end.
const DRIVEN: &str = r#"
title = "A column pushed at one end"
dimensions = "plane-strain"

[particles]
spacing = "1 mm"

[numerics]
precision = "double"

[time]
end = "1 s"

[[body]]
name = "column"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["20 mm", "4 mm"] } }

[[region]]
name = "driver"
body = "column"
shape = { box = { min = ["0 mm", "0 mm"], max = ["3 mm", "4 mm"] } }

[[motion]]
region = "driver"
velocity = [[["0 us", "0 m/s"], ["1 us", "10 m/s"]], "0 m/s"]
"#;

#[test]
fn prescribed_motion_follows_its_table_and_its_work_is_booked() {
    let driven = run(simulation(DRIVEN, &[]), 60, 2);
    let t = driven.time();
    let expected = (t / 1e-6 * 10.0).min(10.0);
    let p = driven.particles();
    let held = p.regions.iter().zip(&p.velocity).filter(|(r, _)| **r & 1 == 1);
    assert_eq!(held.clone().count(), 12);
    for (_, v) in held {
        assert!((v[0] - expected).abs() < 1e-12 && v[1] == 0.0, "{v:?} at {t}");
    }
    let ledger = driven.ledger();
    let energy = ledger.total.energies.kinetic + ledger.total.energies.internal;
    assert!(ledger.external_work > 0.0 && (energy / ledger.external_work - 1.0).abs() < 1e-10);
}

/// Uniaxial impact of a strip, held sideways in one of three ways.
const STRIP: &str = r#"
title = "A strip hits its mirror image"
dimensions = "plane-strain"

[particles]
spacing = "1 mm"

[numerics]
precision = "double"

[time]
end = "1 s"

[[body]]
name = "strip"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["30 mm", "6 mm"] } }
velocity = ["-100 m/s", "0 m/s"]

[[symmetry]]
axis = "x"
at = "0 mm"
side = "positive"
"#;

#[test]
fn periodic_and_symmetric_sides_agree_and_hold_the_strip_straight() {
    let periodic = format!("{STRIP}\n[periodic]\ny = [\"0 mm\", \"6 mm\"]\n");
    let plane = |at: &str, side: &str| format!("\n[[symmetry]]\naxis = \"y\"\nat = \"{at}\"\nside = \"{side}\"\n");
    let symmetric = format!("{STRIP}{}{}", plane("0 mm", "positive"), plane("6 mm", "negative"));
    let a = velocities(run(simulation(&periodic, &[]), 150, 2).particles());
    let b = velocities(run(simulation(&symmetric, &[]), 150, 2).particles());
    assert!(a.iter().any(|v| v[0].abs() < 50.0), "the wave has not left the plane");
    for v in a.iter().chain(&b) {
        assert!(v[1].abs() < 1e-6, "{v:?}");
    }
    assert!(largest_difference(&a, &b) < 1e-6, "{}", largest_difference(&a, &b));
}

#[test]
fn a_symmetry_plane_is_the_mirrored_problem() {
    let full = STRIP.replace("[[symmetry]]\naxis = \"x\"\nat = \"0 mm\"\nside = \"positive\"\n", "")
        + r#"
[[body]]
name = "image"
material = "armco-iron"
shape = { box = { min = ["-30 mm", "0 mm"], max = ["0 mm", "6 mm"] } }
velocity = ["100 m/s", "0 m/s"]
"#;
    let half = run(simulation(STRIP, &[]), 100, 2);
    let whole = run(simulation(&full, &[]), 100, 2);
    let n = half.particles().len();
    let (a, b) = (velocities(half.particles()), velocities(whole.particles()));
    assert!(largest_difference(&a, &b[..n]) < 1e-6, "{}", largest_difference(&a, &b[..n]));
}

#[test]
fn a_value_that_is_not_finite_names_particle_step_and_field() {
    let setup = load_text("test", COLLISION, &[]).expect("the deck is right");
    let mut particles = setup.particles;
    particles.energy[17] = f64::NAN;
    let mut simulation = Simulation::new(setup.model, particles);
    let failure = (0..3).find_map(|_| simulation.step(None).err()).expect("the run must fail");
    assert!(failure.particle.is_some() && failure.step >= 1, "{failure}");
    assert!(["velocity", "acceleration", "energy", "pressure"].contains(&failure.field), "{failure}");
}
