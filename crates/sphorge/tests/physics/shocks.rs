//! States behind shocks are those of the Hugoniot, by default.

use super::setup::{run_to, simulation};

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

#[test]
fn behind_a_shock_is_the_state_of_the_hugoniot() {
    for impact in [500.0, 1000.0, 2000.0, 4000.0] {
        let velocity = format!("[\"{impact} m/s\"]");
        let mut simulation = simulation(PLATES, &[("body.flyer.velocity", &velocity)]);
        let (jump, speed) = hugoniot(impact);
        run_to(&mut simulation, 9e-3 / speed);
        // From a third to three quarters of the way between the faces and the shock.
        let (face, front) = (9e-3 * jump / speed, 9e-3);
        let p = simulation.particles().unwrap();
        let within = |share: f64| face + share * (front - face);
        let behind: Vec<usize> =
            (0..p.len()).filter(|&i| p.position[i][0] > within(0.35) && p.position[i][0] < within(0.75)).collect();
        let mean = |of: &dyn Fn(usize) -> f64| behind.iter().map(|&i| of(i)).sum::<f64>() / behind.len() as f64;
        let pressure = 8930.0 * speed * jump;
        let (found, energy) = (mean(&|i| p.pressure[i]), mean(&|i| p.energy[i]));
        assert!((found / pressure - 1.0).abs() < 5e-3, "{impact}: {found} of {pressure}");
        assert!((energy / (0.5 * jump * jump) - 1.0).abs() < 0.03, "{impact}: {energy}");
        // What rings from particle to particle; with a quadratic viscosity of 1 nearly as much as the shock itself at 2 km/s.
        let highest = behind.iter().map(|&i| p.pressure[i]).fold(0.0, f64::max);
        assert!(highest < 1.4 * pressure, "{impact}: {highest} of {pressure}");
    }
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
    let mut simulation = simulation(PLATES, &[("body.flyer.velocity", "[\"100 m/s\"]"), ("time", time)]);
    run_to(&mut simulation, 0.3e-6);
}
