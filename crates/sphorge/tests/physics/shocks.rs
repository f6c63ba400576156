//! States behind shocks are those of the Hugoniot, by default.

use super::setup::{run_to, simulation};
use sphorge::engine::Simulation;
use std::collections::BTreeMap;

/// A plate of copper without strength that hits another one: 20 mm of each, so that no release reaches what is looked at.
const PLATES: &str = r#"
dimensions = "1d"
particles = { spacing = "0.1 mm" }
time = { end = "1 s", step-control = { repeats = 0 } }

[material.m]
density = "8930 kg/m^3"
specific-heat = "385 J/(kg K)"
equation-of-state = { mie-gruneisen = { sound-speed = "3940 m/s", shock-slope = 1.49, gruneisen = 2.0 } }
strength = "none"

[[body]]
name = "flyer"
material = "m"
shape = { box = { min = ["-20 mm"], max = ["0 mm"] } }
velocity = ["1000 m/s"]

[[body]]
name = "target"
material = "m"
shape = { box = { min = ["0 mm"], max = ["20 mm"] } }
"#;

/// Jump of the velocity and speed of the shock of an impact, m/s.
fn hugoniot(impact: f64) -> (f64, f64) {
    (0.5 * impact, 3940.0 + 1.49 * 0.5 * impact)
}

/// Mean pressure, Pa, mean energy, J/kg, and highest pressure, Pa, from a third to three quarters of the way between the faces and a shock that has
/// gone 9 mm, of this jump and speed (m/s).
fn behind(simulation: &Simulation, (jump, speed): (f64, f64)) -> (f64, f64, f64) {
    let (face, front) = (9e-3 * jump / speed, 9e-3);
    let p = simulation.particles().unwrap();
    let within = |share: f64| face + share * (front - face);
    let found: Vec<usize> =
        (0..p.len()).filter(|&i| p.position[i][0] > within(0.35) && p.position[i][0] < within(0.75)).collect();
    let mean = |of: &[f64]| found.iter().map(|&i| of[i]).sum::<f64>() / found.len() as f64;
    (mean(&p.pressure), mean(&p.energy), found.iter().map(|&i| p.pressure[i]).fold(0.0, f64::max))
}

#[test]
fn behind_a_shock_is_the_state_of_the_hugoniot() {
    for impact in [500.0, 1000.0, 2000.0, 4000.0] {
        let velocity = format!("[\"{impact} m/s\"]");
        let mut simulation = simulation(PLATES, &[("body.flyer.velocity", &velocity)]);
        let (jump, speed) = hugoniot(impact);
        run_to(&mut simulation, 9e-3 / speed);
        let pressure = 8930.0 * speed * jump;
        let (found, energy, highest) = behind(&simulation, (jump, speed));
        assert!((found / pressure - 1.0).abs() < 5e-3, "{impact}: {found} of {pressure}");
        assert!((energy / (0.5 * jump * jump) - 1.0).abs() < 0.03, "{impact}: {energy}");
        // What rings from particle to particle; with a quadratic viscosity of 1 nearly as much as the shock itself at 2 km/s, without one of shocks a third.
        assert!(highest < 1.05 * pressure, "{impact}: {highest} of {pressure}");
    }
}

/// Impact of the fastest plates, m/s: with a constant Grüneisen parameter of two, shocks of more than 15.4 km/s compress by its limit of two.
const FASTEST: f64 = 10000.0;

#[test]
fn shocks_leave_no_ringing_behind_them() {
    for (impact, most) in [(200.0, 1.05), (500.0, 1.05), (2000.0, 1.05), (FASTEST, 1.08)] {
        let velocity = format!("[\"{impact} m/s\"]");
        let mut simulation = simulation(PLATES, &[("body.flyer.velocity", &velocity)]);
        let (jump, speed) = hugoniot(impact);
        let pressure = 8930.0 * speed * jump;
        // What starts at the faces is left out: twelve particles of each plate.
        let start: BTreeMap<u32, f64> = {
            let p = simulation.particles().unwrap();
            p.id.iter().zip(&p.position).map(|(id, x)| (*id, x[0])).collect()
        };
        let mut highest = 0.0f64;
        while simulation.time() < 9e-3 / speed {
            simulation.step(Some(9e-3 / speed)).unwrap_or_else(|failure| panic!("{failure}"));
            let p = simulation.particles().unwrap();
            let far = (0..p.len()).filter(|&i| start[&p.id[i]].abs() > 1.2e-3).map(|i| p.pressure[i]);
            highest = far.fold(highest, f64::max);
        }
        assert!(highest < most * pressure, "{impact}: {highest} of {pressure}");
        let (found, energy, _) = behind(&simulation, (jump, speed));
        assert!((found / pressure - 1.0).abs() < 5e-3, "{impact}: {found} of {pressure}");
        // Slow shocks have not forgotten how they began.
        let within = if impact < 500.0 { 0.05 } else { 0.03 };
        assert!((energy / (0.5 * jump * jump) - 1.0).abs() < within, "{impact}: {energy}");
    }
}

#[test]
fn free_surfaces_start_at_the_velocity_of_the_impact() {
    for (impact, most) in [(200.0, 1.03), (500.0, 1.02), (2000.0, 1.03)] {
        let velocity = format!("[\"{impact} m/s\"]");
        let thin = ("body.target.shape.box.max", "[\"10 mm\"]");
        let mut simulation = simulation(PLATES, &[("body.flyer.velocity", &velocity), thin]);
        let (_, speed) = hugoniot(impact);
        let end = 10e-3 / speed + 2.5e-3 / 3940.0;
        let mut highest = 0.0f64;
        while simulation.time() < end {
            simulation.step(Some(end)).unwrap_or_else(|failure| panic!("{failure}"));
            let p = simulation.particles().unwrap();
            let last = (0..p.len()).max_by(|&i, &j| p.position[i][0].total_cmp(&p.position[j][0])).unwrap();
            highest = highest.max(p.velocity[last][0]);
        }
        assert!(highest > 0.99 * impact && highest < most * impact, "{impact}: {highest}");
    }
}

/// Two periods and a half of a wave of 20 particles, in a cell of one wavelength.
const STANDING: &str = r#"
dimensions = "1d"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "1 s" }
periodic = { x = ["0 mm", "20 mm"] }

[material.metal]
density = "2700 kg/m^3"
young-modulus = "70 GPa"
poisson-ratio = 0.33
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "bar"
material = "metal"
shape = { box = { min = ["0 mm"], max = ["20 mm"] } }
velocity-profile = { along = "x", amplitude = ["5 m/s"], rows = [["0 mm", 0.0], ["2.5 mm", 0.7], ["5 mm", 1.0], ["7.5 mm", 0.7], ["10 mm", 0.0], ["12.5 mm", -0.7], ["15 mm", -1.0], ["17.5 mm", -0.7], ["20 mm", 0.0]] }
"#;

#[test]
fn viscosity_of_shocks_does_not_act_in_waves() {
    let run = |overrides: &[(&str, &str)]| {
        let mut simulation = simulation(STANDING, overrides);
        run_to(&mut simulation, 8e-6);
        (simulation.ledger().unwrap().viscous_energy, simulation.particles().unwrap().velocity.clone())
    };
    let alone = ("numerics.viscosity", "{ alpha = 0.0, beta = 0.0, shocks = 0.5 }");
    let (viscous, velocities) = run(&[alone]);
    assert_eq!(viscous, 0.0);
    assert_eq!(velocities, run(&[("numerics.viscosity", "false")]).1);
    // Twenty times as fast the wave has the rates of a shock.
    assert!(run(&[alone, ("body.bar.velocity-profile.amplitude", "[\"100 m/s\"]")]).0 > 0.0);
}

#[test]
fn waves_last_and_viscosity_on_all_of_them_damps_them() {
    // The amplitude of the velocity, from the largest kinetic energies of the first and the fiftieth period.
    let row =
        |k: u32| format!("[\"{} mm\", {}]", 0.5 * f64::from(k), (f64::from(k) * std::f64::consts::PI / 20.0).sin());
    let sine = format!("[{}]", (0..=40).map(row).collect::<Vec<_>>().join(", "));
    let kept = |overrides: &[(&str, &str)]| {
        let of_one_length = ("body.bar.velocity-profile.rows", &*sine);
        let mut simulation = simulation(STANDING, &[&[of_one_length], overrides].concat());
        let period = 20e-3 / f64::sqrt(70e9 * 0.67 / (1.33 * 0.34) / 2700.0);
        let mut most = |until: f64| {
            let mut most = 0.0f64;
            while simulation.time() < until {
                simulation.step(Some(until)).unwrap_or_else(|failure| panic!("{failure}"));
                most = most.max(simulation.ledger().unwrap().total.energies.kinetic);
            }
            most
        };
        let first = most(period);
        most(49.0 * period);
        (most(50.0 * period) / first).sqrt()
    };
    let by_default = kept(&[]);
    assert!(by_default > 0.95 && by_default < 1.0, "{by_default}");
    let all = kept(&[("numerics.viscosity.all-waves", "true")]);
    assert!((0.3..0.4).contains(&all), "{all}");
}

/// A disc that turns, and is pressed together along one axis at a third of the sound speed from edge to edge.
const PRESSED_DISC: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm", lattice = "square" }
numerics = { precision = "double", viscosity = { shocks = 1.0 } }
time = { end = "1 s" }

[[body]]
name = "disc"
material = "armco-iron"
shape = { disc = { centre = ["3 mm", "-5 mm"], radius = "10 mm" } }
velocity-gradient = { rows = [["-1e5 1/s", "-3e4 1/s"], ["3e4 1/s", "0 1/s"]] }
"#;

#[test]
fn viscosity_of_shocks_keeps_energy_momentum_and_angular_momentum() {
    let mut simulation = simulation(PRESSED_DISC, &[]);
    simulation.next_step_estimate().unwrap();
    let first = simulation.ledger().unwrap().total;
    run_to(&mut simulation, 1e-6);
    let ledger = simulation.ledger().unwrap();
    let now = ledger.total;
    let energy = |of: sphorge::engine::Energies| of.kinetic + of.internal;
    let drift = energy(now.energies) / energy(first.energies) - 1.0;
    assert!(drift.abs() < 1e-12, "{drift:.1e}");
    let turned = now.angular_momentum[2] / first.angular_momentum[2] - 1.0;
    assert!(turned.abs() < 1e-12, "{turned:.1e}");
    assert!(ledger.viscous_energy > 0.05 * first.energies.kinetic, "{}", ledger.viscous_energy);
}

#[test]
fn springs_between_bodies_do_not_step_as_far_as_waves() {
    // At twice the usual step the integration of springs of facets that meet lost nearly all of the energy brought.
    let impact = [("body.flyer.velocity", "[\"100 m/s\"]"), ("time.courant", "0.6")];
    let mut simulation = simulation(PLATES, &impact);
    let brought = simulation.ledger().unwrap().total.energies.kinetic;
    run_to(&mut simulation, 1e-6);
    let ledger = simulation.ledger().unwrap();
    let share = ledger.integration_energy.abs() / brought;
    assert!(share < 0.2, "{share}");
}

#[test]
fn a_fixed_step_is_held_against_limits_of_one_courant_number() {
    // Two thirds of the stability limit of the springs between the plates, which it is less than.
    let time = "{ end = \"1 s\", courant = 0.9, fixed-step = \"10 ns\" }";
    let slow = ("body.flyer.velocity", "[\"100 m/s\"]");
    let mut simulation = simulation(PLATES, &[("numerics.viscosity.shocks", "0.0"), slow, ("time", time)]);
    run_to(&mut simulation, 0.3e-6);
}

#[test]
fn a_fixed_step_that_viscosity_makes_unstable_is_refused() {
    // Sound allows 28 ns, the springs between the plates 16 ns, the viscosity of shocks some 5 ns.
    let end = |step: &str| {
        let time = format!("{{ end = \"1 s\", fixed-step = \"{step}\" }}");
        let mut simulation = simulation(
            PLATES,
            &[("numerics.viscosity.shocks", "1.0"), ("body.flyer.velocity", "[\"100 m/s\"]"), ("time", &time)],
        );
        let mut steps = (0..40).map(|_| simulation.step(None));
        steps.find_map(Result::err).map(|failure| failure.to_string())
    };
    assert_eq!(end("4 ns"), None);
    assert!(end("12 ns").is_some_and(|message| message.contains("the fixed step 1.200e-8 s is unstable")));
}
