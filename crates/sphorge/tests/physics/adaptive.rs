//! Adaptive search: what the published rule misses, the guarded one finds; nothing else changes.

use super::setup::{COLLISION, by_id, norm, run_steps, run_to, simulation};
use sphorge::engine::{Audit, Simulation};

const EVERY_STEP: &str = "every-step";
const GUARDED: &str = "{ adaptive = { plastic-strain-threshold = 1e-5 } }";
const PUBLISHED: &str = "{ adaptive = { plastic-strain-threshold = 1e-5, guard = \"none\" } }";

/// An elastic block that an elastic block strikes after it has flown through five spacings.
const LATE_STRIKE: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "200 us" }

[material.tough]
base = "armco-iron"
strength = "elastic"

[[body]]
name = "target"
material = "tough"
shape = { box = { min = ["0 mm", "-6 mm"], max = ["10 mm", "6 mm"] } }

[[body]]
name = "striker"
material = "tough"
shape = { box = { min = ["-17 mm", "-3 mm"], max = ["-5 mm", "3 mm"] } }
velocity = ["100 m/s", "0 m/s"]
"#;

/// An elastic rod that spins freely.
const SPINNING_ROD: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double", gradient-correction = "linear", viscosity = false }
time = { end = "1 ms" }

[material.tough]
base = "armco-iron"
strength = "elastic"

[[body]]
name = "rod"
material = "tough"
shape = { box = { min = ["-12 mm", "-3 mm"], max = ["12 mm", "3 mm"] } }
spin = { rate = "3000 rad/s" }
"#;

/// Two pieces of one elastic body that fly towards each other and meet in the middle.
const TWO_PIECES: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "200 us" }

[material.tough]
base = "armco-iron"
strength = "elastic"

[[body]]
name = "pieces"
material = "tough"
shape.union = [
    { box = { min = ["-16 mm", "-4 mm"], max = ["-5 mm", "4 mm"] } },
    { box = { min = ["5 mm", "-4 mm"], max = ["16 mm", "4 mm"] } },
]
velocity-profile = { along = "x", amplitude = ["100 m/s", "0 m/s"], rows = [["-1 mm", 1.0], ["1 mm", -1.0]] }
"#;

/// A flat section with a slot of 4 mm, of soft material, flattened at 10 m/s.
const HOLLOW: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = { alpha = 1.0, beta = 1.0 } }
time = { end = "1 ms" }

[material.soft]
density = "1000 kg/m^3"
young-modulus = "1 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "section"
material = "soft"
shape.difference = [
    { box = { min = ["-40 mm", "0 mm"], max = ["40 mm", "12 mm"] } },
    { box = { min = ["-34 mm", "4 mm"], max = ["34 mm", "8 mm"] } },
]

[[region]]
name = "bottom"
shape = { box = { min = ["-24 mm", "0 mm"], max = ["24 mm", "1 mm"] } }

[[region]]
name = "top"
shape = { box = { min = ["-24 mm", "11 mm"], max = ["24 mm", "12 mm"] } }

[[motion]]
region = "bottom"
velocity = ["0 m/s", "0 m/s"]

[[motion]]
region = "top"
velocity = ["0 m/s", "-10 m/s"]
"#;

/// A bar of the same material pulled by its ends: neighbours change and nothing flows.
fn pulled() -> String {
    let bar = r#"[[body]]
name = "bar"
material = "soft"
shape = { box = { min = ["-20 mm", "-4 mm"], max = ["20 mm", "4 mm"] } }

[[region]]
name = "left"
shape = { box = { min = ["-20 mm", "-4 mm"], max = ["-17 mm", "4 mm"] } }

[[region]]
name = "right"
shape = { box = { min = ["17 mm", "-4 mm"], max = ["20 mm", "4 mm"] } }

[[motion]]
region = "left"
velocity = ["-10 m/s", "0 m/s"]

[[motion]]
region = "right"
velocity = ["10 m/s", "0 m/s"]
"#;
    HOLLOW[..HOLLOW.find("[[body]]").expect("a body")].to_owned() + bar
}

/// A run to a time, audited every ten steps; the worst of all audits.
fn run(deck: &str, search: &str, end: f64) -> (Simulation, Audit) {
    let mut simulation = simulation(deck, &[("search", search), ("audit", "10")]);
    let mut worst = Audit::default();
    while simulation.time() < end {
        let report = simulation.step(Some(end)).unwrap_or_else(|failure| panic!("{failure}"));
        if let Some(audit) = report.audit {
            worst.missed_pairs = worst.missed_pairs.max(audit.missed_pairs);
            worst.missed_foreign_pairs = worst.missed_foreign_pairs.max(audit.missed_foreign_pairs);
            worst.momentum_residual = worst.momentum_residual.max(audit.momentum_residual);
            worst.density_rate_error = worst.density_rate_error.max(audit.density_rate_error);
            worst.force_error = worst.force_error.max(audit.force_error);
        }
    }
    (simulation, worst)
}

/// Largest distance of particles of the same id, m.
fn apart(a: &Simulation, b: &Simulation) -> f64 {
    let (a, b) = (a.particles().unwrap(), b.particles().unwrap());
    let distance = |(i, j): (usize, usize)| norm([0, 1, 2].map(|k| a.position[i][k] - b.position[j][k]));
    by_id(&a).into_iter().zip(by_id(&b)).map(distance).fold(0.0, f64::max)
}

#[test]
fn a_late_strike_is_missed_by_the_published_rule_and_not_by_the_guarded_one() {
    let end = 80e-6;
    let (reference, _) = run(LATE_STRIKE, EVERY_STEP, end);
    let speed = |s: &Simulation| s.ledger().unwrap().bodies[0].momentum[0] / s.ledger().unwrap().bodies[0].mass;
    assert!(speed(&reference) > 20.0, "{}", speed(&reference));

    let (published, audit) = run(LATE_STRIKE, PUBLISHED, end);
    assert!(audit.missed_foreign_pairs > 100, "{audit:?}");
    assert_eq!(speed(&published), 0.0, "the striker passes through the target unseen");

    let (guarded, audit) = run(LATE_STRIKE, GUARDED, end);
    assert_eq!(audit.missed_foreign_pairs, 0, "{audit:?}");
    assert!(audit.momentum_residual < 1e-14, "{audit:?}");
    assert!((speed(&guarded) / speed(&reference) - 1.0).abs() < 1e-3, "{} {}", speed(&guarded), speed(&reference));
}

#[test]
fn elastic_strain_is_missed_by_the_published_rule_and_not_by_the_guarded_one() {
    let (_, published) = run(&pulled(), PUBLISHED, 240e-6);
    let (_, guarded) = run(&pulled(), GUARDED, 240e-6);
    // The bar is 12 % longer in the end.
    assert!(published.density_rate_error > 0.5 && published.force_error > 0.5, "{published:?}");
    assert!(guarded.density_rate_error < 5e-3 && guarded.force_error < 5e-3, "{guarded:?}");
}

#[test]
fn the_strain_bound_decides_who_is_searched() {
    // Share of the particles searched until the waves from both ends have passed through each other: strains are a hundredth.
    let searched = |bound: &str| {
        let mut simulation =
            simulation(&pulled(), &[("search", &format!("{{ adaptive = {{ strain-bound = {bound} }} }}"))]);
        let (mut sum, mut steps) = (0.0, 0);
        while simulation.time() < 40e-6 {
            sum += simulation.step(None).unwrap().searched_fraction;
            steps += 1;
        }
        sum / f64::from(steps)
    };
    let (fine, usual, coarse) = (searched("1e-7"), searched("0.005"), searched("0.05"));
    assert!(fine > 0.5 && usual < 0.5 * fine && coarse < 0.5 * usual, "{fine} {usual} {coarse}");
}

/// A free plate of four layers that is pressed together at one rate everywhere.
const PRESSED: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = { alpha = 0.0, beta = 0.0 } }
time = { end = "10 us" }

[[body]]
name = "plate"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["20 mm", "4 mm"] } }
velocity-gradient = { rows = [["0 1/s", "0 1/s"], ["0 1/s", "-1e4 1/s"]] }
"#;

#[test]
fn the_strain_of_the_guard_is_exact_on_free_faces() {
    let second_step = |bound: f64| {
        let search = format!("{{ adaptive = {{ strain-bound = {bound:e} }} }}");
        let mut simulation = simulation(PRESSED, &[("search", &search)]);
        let first = simulation.step(None).unwrap();
        (first.dt, simulation.step(None).unwrap().searched_fraction)
    };
    // All particles have the same strain after the first step, those of the faces, too: all pass the bound, or none.
    let strain = 1e4 * second_step(1.0).0;
    assert_eq!(second_step(0.99 * strain).1, 1.0);
    assert_eq!(second_step(1.01 * strain).1, 0.0);
}

#[test]
fn a_spinning_rod_flies_apart_at_old_gradients_and_not_at_new_ones() {
    // An eighth of a turn.
    let end = 260e-6;
    let (reference, _) = run(SPINNING_ROD, EVERY_STEP, end);
    let (guarded, audit) = run(SPINNING_ROD, GUARDED, end);
    assert!(audit.momentum_residual < 1e-13, "{audit:?}");
    assert!(apart(&guarded, &reference) < 1e-9, "{}", apart(&guarded, &reference));

    // Kept distances do not turn: particles that fly straight on seem to turn rigidly, and nothing holds them together.
    let (published, _) = run(SPINNING_ROD, PUBLISHED, end);
    assert!(apart(&published, &reference) > 1e-3, "{}", apart(&published, &reference));
    assert!(
        published.ledger().unwrap().total.energies.elastic < 1e-9 * reference.ledger().unwrap().total.energies.elastic
    );
}

#[test]
fn pieces_of_one_body_are_strangers() {
    let end = 80e-6;
    let (reference, _) = run(TWO_PIECES, EVERY_STEP, end);
    // Mean velocity of the piece that started on the left.
    let start = simulation(TWO_PIECES, &[]);
    let start = start.particles().unwrap();
    let on_the_left: Vec<usize> =
        by_id(&start).iter().enumerate().filter(|&(_, &i)| start.position[i][0] < 0.0).map(|(id, _)| id).collect();
    let left = |s: &Simulation| {
        let ids = by_id(s.particles().unwrap());
        on_the_left.iter().map(|&id| s.particles().unwrap().velocity[ids[id]][0]).sum::<f64>()
            / on_the_left.len() as f64
    };
    assert!(left(&reference) < 50.0, "{}", left(&reference));
    let (published, audit) = run(TWO_PIECES, PUBLISHED, end);
    assert!(audit.missed_pairs > 100, "{audit:?}");
    assert!(left(&published) > 99.0, "the pieces pass through each other: {}", left(&published));
    let (guarded, audit) = run(TWO_PIECES, GUARDED, end);
    assert!(audit.momentum_residual < 1e-14, "{audit:?}");
    assert!((left(&guarded) - left(&reference)).abs() < 0.1, "{} {}", left(&guarded), left(&reference));
}

#[test]
fn a_block_meets_images_as_it_meets_another() {
    let block = |rest: &str| {
        format!(
            r#"
dimensions = "plane-strain"
method = "fraser"
particles = {{ spacing = "1 mm" }}
time = {{ end = "40 us" }}

[[body]]
name = "block"
material = "armco-iron"
shape = {{ box = {{ min = ["2 mm", "0 mm"], max = ["12 mm", "5 mm"] }} }}
velocity = ["-100 m/s", "0 m/s"]
{rest}"#
        )
    };
    let mirror = block("\n[[symmetry]]\naxis = \"x\"\nat = \"0 mm\"\nside = \"positive\"\n");
    // It leaves the cell on its way, and strikes what stands at the other end.
    let cell = block(
        r#"
[periodic]
x = ["0 mm", "25 mm"]

[[body]]
name = "target"
material = "armco-iron"
shape = { box = { min = ["13.5 mm", "0 mm"], max = ["23.5 mm", "5 mm"] } }
"#,
    );
    let end = 40e-6;
    for deck in [mirror, cell] {
        let (reference, _) = run(&deck, EVERY_STEP, end);
        let (guarded, audit) = run(&deck, GUARDED, end);
        let kinetic = |s: &Simulation| s.ledger().unwrap().total.energies.kinetic;
        assert!(kinetic(&reference) < 0.8 * kinetic(&simulation(&deck, &[])), "it strikes");
        assert!(audit.density_rate_error < 1e-3, "{audit:?}");
        let difference = kinetic(&guarded) / kinetic(&reference) - 1.0;
        assert!(difference.abs() < 1e-3, "{difference}");
    }
}

#[test]
fn a_slot_that_closes_is_seen() {
    let end = 0.45e-3;
    let force = |s: &Simulation| s.ledger().unwrap().motion_forces[0][1];
    let (reference, _) = run(HOLLOW, EVERY_STEP, end);
    let (guarded, audit) = run(HOLLOW, GUARDED, end);
    println!("{audit:?} {} {}", force(&guarded), force(&reference));
    assert!(audit.density_rate_error < 1e-4 && audit.force_error < 1e-4, "{audit:?}");
    assert!((force(&guarded) / force(&reference) - 1.0).abs() < 1e-2, "{} {}", force(&guarded), force(&reference));
}

#[test]
fn momentum_is_conserved_for_any_threshold_and_lost_without_the_guard() {
    let drift = |search: &str| {
        let mut simulation = simulation(COLLISION, &[("search", search)]);
        let before = simulation.ledger().unwrap().total.momentum;
        run_to(&mut simulation, 6e-6);
        let ledger = simulation.ledger().unwrap();
        norm([0, 1, 2].map(|a| ledger.total.momentum[a] - before[a])) / ledger.total.momentum_scale
    };
    for threshold in ["1e-2", "1e-4", "1e-6"] {
        let drift = drift(&format!("{{ adaptive = {{ plastic-strain-threshold = {threshold} }} }}"));
        assert!(drift < 1e-13, "{threshold}: {drift:.1e}");
    }
    let without = drift("{ adaptive = { plastic-strain-threshold = 1e-4, guard = \"none\" } }");
    assert!(without > 1e-8, "{without:.1e}");
}

#[test]
fn threads_do_not_change_a_bit_of_a_partial_search() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            // A target so long that its far end has no strangers.
            let deck = LATE_STRIKE.replace("[\"10 mm\", \"6 mm\"]", "[\"90 mm\", \"6 mm\"]");
            let mut simulation = simulation(&deck, &[("search", GUARDED), ("numerics.precision", "mixed")]);
            run_to(&mut simulation, 70e-6);
            simulation.particles().unwrap().clone()
        })
    };
    let (one, two) = (on(1), on(2));
    assert!(one.position == two.position && one.velocity == two.velocity && one.id == two.id);
    assert!(one.adapted == two.adapted && one.adapted.contains(&1) && one.adapted.contains(&0));
}

#[test]
fn the_total_lagrangian_rod_spins_without_strain_and_conserves() {
    // With hourglass control and viscosity, in the settings that do not conserve angular momentum otherwise.
    let mut simulation = simulation(
        SPINNING_ROD,
        &[("search", "total-lagrangian"), ("numerics.gradient-correction", "none"), ("numerics.viscosity", "true")],
    );
    run_steps(&mut simulation, 1);
    let before = simulation.ledger().unwrap();
    run_to(&mut simulation, 1e-3);
    let after = simulation.ledger().unwrap();
    let total = |l: &sphorge::engine::Ledger| l.total.energies.kinetic + l.total.energies.internal;
    assert!((total(&after) / total(&before) - 1.0).abs() < 1e-12);
    assert!((after.total.angular_momentum[2] / before.total.angular_momentum[2] - 1.0).abs() < 1e-6);
    assert!((after.total.energies.kinetic / before.total.energies.kinetic - 1.0).abs() < 1e-3);
}
