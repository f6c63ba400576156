//! What no force may change.

use super::setup::{COLLISION, norm, run_steps, run_to, simulation};
use sphorge::engine::Simulation;

/// Largest drift of total energy and of linear momentum over a run, relative to the first total and to the first
/// `sum m |v|`.
fn drifts(simulation: &mut Simulation, end: f64) -> (f64, f64) {
    simulation.next_step_estimate().unwrap();
    let first = simulation.ledger().unwrap().total;
    let energy = |e: sphorge::engine::Energies| e.kinetic + e.internal;
    let (mut energy_drift, mut momentum_drift) = (0.0f64, 0.0f64);
    while simulation.time() < end {
        simulation.step(Some(end)).unwrap();
        let now = simulation.ledger().unwrap().total;
        energy_drift = energy_drift.max((energy(now.energies) / energy(first.energies) - 1.0).abs());
        let change = [0, 1, 2].map(|a| now.momentum[a] - first.momentum[a]);
        momentum_drift = momentum_drift.max(norm(change) / first.momentum_scale);
    }
    (energy_drift, momentum_drift)
}

#[test]
fn a_collision_keeps_energy_and_momentum_to_round_off() {
    for (integrator, correction, form, split) in [
        ("leapfrog", "none", "volume-weighted", "own-stress"),
        ("leapfrog", "none", "volume-weighted", "symmetric"),
        ("leapfrog", "linear", "volume-weighted", "own-stress"),
        ("leapfrog", "none", "density-weighted", "own-stress"),
        ("leapfrog", "none", "mixed", "symmetric"),
        ("predictor-corrector", "none", "volume-weighted", "own-stress"),
        ("predictor-corrector", "linear", "density-weighted", "symmetric"),
    ] {
        let overrides = [
            ("numerics.integrator", integrator),
            ("numerics.gradient-correction", correction),
            ("numerics.pair-form", form),
            ("numerics.energy-split", split),
        ];
        let mut simulation = simulation(COLLISION, &overrides);
        let (energy, momentum) = drifts(&mut simulation, 10e-6);
        let yielded = simulation.particles().unwrap().plastic_strain.iter().fold(0.0, |m: f64, &e| m.max(e));
        assert!(yielded > 0.05, "nothing happened: {yielded}");
        assert!(energy < 1e-12 && momentum < 1e-12, "{overrides:?}: energy {energy:.1e}, momentum {momentum:.1e}");
    }
}

#[test]
fn smoothing_lengths_that_follow_the_density_keep_energy_and_momentum_to_round_off() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        let overrides = [("numerics.integrator", integrator), ("numerics.smoothing-length", "follow-density")];
        let (energy, momentum) = drifts(&mut simulation(COLLISION, &overrides), 10e-6);
        assert!(energy < 1e-12 && momentum < 1e-12, "{integrator}: energy {energy:.1e}, momentum {momentum:.1e}");
    }
}

#[test]
fn smoothed_velocities_carry_the_centre_of_mass_as_momentum_does() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        for form in ["volume-weighted", "density-weighted", "mixed"] {
            let overrides = [("numerics.integrator", integrator), ("numerics.pair-form", form)];
            let mut simulation = simulation(COLLISION, &overrides);
            let moment = |simulation: &Simulation| {
                let p = simulation.particles().unwrap();
                [0, 1, 2].map(|a| p.mass.iter().zip(&p.position).map(|(m, x)| m * x[a]).sum::<f64>())
            };
            let (first, start) = (moment(&simulation), simulation.ledger().unwrap().total);
            run_to(&mut simulation, 5e-6);
            let (now, t) = (moment(&simulation), simulation.time());
            let off = norm([0, 1, 2].map(|a| now[a] - first[a] - t * start.momentum[a]));
            let relative = off / (t * start.momentum_scale);
            assert!(relative < 1e-12, "{integrator}, {form}: {relative:.1e}");
        }
    }
}

#[test]
fn single_precision_pair_sums_keep_energy_and_momentum_to_their_rounding() {
    let mut simulation = simulation(COLLISION, &[("numerics.precision", "mixed")]);
    let (energy, momentum) = drifts(&mut simulation, 10e-6);
    assert!(energy < 1e-6 && momentum < 1e-6, "energy {energy:.1e}, momentum {momentum:.1e}");
}

const DISC: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = false }
time = { end = "1 ms" }

[material.metal]
density = "7890 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "disc"
material = "metal"
shape = { disc = { centre = ["3 mm", "-5 mm"], radius = "10 mm" } }
spin = { rate = "100 rad/s", centre = ["3 mm", "-5 mm"] }
"#;

#[test]
fn a_turning_disc_is_stressed_by_its_inertia_alone_where_gradients_are_corrected() {
    // A turn by 0.02 rad at a rim speed of 1 m/s: inertia makes stresses of some rho v^2 = 8 kPa.
    let inertia = 7890.0 * 1.0;
    let stress = |correction: &str| {
        let mut simulation = simulation(DISC, &[("numerics.gradient-correction", correction)]);
        run_to(&mut simulation, 2e-4);
        simulation.particles().unwrap().deviator.iter().map(|s| s.von_mises()).fold(0.0, f64::max)
    };
    let (corrected, plain) = (stress("linear"), stress("none"));
    assert!(corrected < 5.0 * inertia, "{corrected:.3e}");
    // Plain sums see a strain at the rim.
    assert!(plain > 100.0 * inertia, "{plain:.3e}");
}

#[test]
fn corrected_sums_keep_angular_momentum_to_round_off() {
    let mut simulation = simulation(DISC, &[("numerics.gradient-correction", "linear")]);
    simulation.next_step_estimate().unwrap();
    let first = simulation.ledger().unwrap().total.angular_momentum[2];
    run_steps(&mut simulation, 500);
    let drift = simulation.ledger().unwrap().total.angular_momentum[2] / first - 1.0;
    assert!(drift.abs() < 1e-12, "{drift:.1e}");
}

const ELASTIC_BAR: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
numerics = { precision = "double", viscosity = false }
time = { end = "1 ms" }

[material.metal]
density = "7890 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "bar"
material = "metal"
shape = { box = { min = ["0 mm", "-2 mm"], max = ["20 mm", "2 mm"] } }
velocity = ["-1 m/s", "0 m/s"]

[[symmetry]]
axis = "x"
"#;

/// What is booked with the kicks is what the work of the pair forces is out by, where it is taken at a velocity predicted with the
/// acceleration before: `-(dt^2/4) m |a_n+1 - a_n|^2` a step, third order in the time step over a run. A work that is taken at the
/// wrong time would leave an error of first order, one that is missing an error that stays.
#[test]
fn what_the_integrator_books_falls_with_the_third_power_of_the_step() {
    for hourglass in ["0", "1.25"] {
        let search = format!("{{ total-lagrangian = {{ hourglass = {hourglass} }} }}");
        let run = |step: &str| {
            let mut simulation = simulation(ELASTIC_BAR, &[("search", &search), ("time.fixed-step", step)]);
            let first = simulation.ledger().unwrap().total.energies.kinetic;
            // A length and a half of the wave: every particle has been stopped by it, or thrown back.
            run_to(&mut simulation, 6e-6);
            let ledger = simulation.ledger().unwrap();
            let energies = ledger.total.energies;
            (ledger.integration_energy / first, (energies.internal - energies.elastic) / first)
        };
        let ((coarse, springs), (fine, _)) = (run("\"40 ns\""), run("\"20 ns\""));
        let ratio = coarse / fine;
        assert!((7.0..9.0).contains(&ratio), "{hourglass}: {coarse:.2e} and {fine:.2e}, {ratio}");
        assert!(coarse < 0.0 && coarse > -0.03, "{hourglass}: {coarse:.2e}");
        // What is left in the particles is the energy of their stress, and that of the springs.
        let left = if hourglass == "0" { -1e-3..1e-3 } else { 0.0..0.03 };
        assert!(left.contains(&springs), "{hourglass}: {springs:.2e}");
    }
}

/// Flung off without a plane or a wall: it bends, turns and yields.
const FLUNG: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "1 ms" }

[material.metal]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = { perfectly-plastic = { yield-stress = "300 MPa" } }

[[body]]
name = "strip"
material = "metal"
shape = { box = { min = ["-15 mm", "-1.5 mm"], max = ["15 mm", "1.5 mm"] } }
velocity-profile = { along = "x", amplitude = ["20 m/s", "100 m/s"], rows = [["-15 mm", 0.6], ["0 mm", -1.0], ["15 mm", 1.0]] }
"#;

#[test]
fn quadratic_gradients_at_faces_keep_energy_momentum_and_angular_momentum_to_round_off() {
    let space = [
        ("dimensions", "3d"),
        ("body.strip.shape.box.min", "[\"-9 mm\", \"-1.5 mm\", \"-2 mm\"]"),
        ("body.strip.shape.box.max", "[\"9 mm\", \"1.5 mm\", \"2 mm\"]"),
        ("body.strip.velocity-profile.amplitude", "[\"20 m/s\", \"100 m/s\", \"30 m/s\"]"),
    ];
    for further in [&[][..], &space] {
        let quadratic = ("search", "{ total-lagrangian = { faces = \"quadratic\" } }");
        let overrides: Vec<_> = [quadratic].into_iter().chain(further.iter().copied()).collect();
        let mut simulation = simulation(FLUNG, &overrides);
        simulation.next_step_estimate().unwrap();
        let first = simulation.ledger().unwrap().total.angular_momentum;
        let (energy, momentum) = drifts(&mut simulation, 40e-6);
        let now = simulation.ledger().unwrap().total.angular_momentum;
        let turned = norm([0, 1, 2].map(|a| now[a] - first[a])) / norm(first);
        let yielded = simulation.particles().unwrap().plastic_strain.iter().fold(0.0, |m: f64, &e| m.max(e));
        assert!(yielded > 0.02, "nothing happened: {yielded}");
        assert!(energy < 1e-12 && momentum < 1e-12, "energy {energy:.1e}, momentum {momentum:.1e}");
        assert!(turned < 1e-11, "{turned:.1e}");
    }
}
