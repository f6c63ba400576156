//! Slow loads on bodies with more mass than they have.

use super::setup::{run_to, simulation};

/// A block of copper that heats as it is pressed together by a tenth.
const PRESSED: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
time = { end = "250 us" }

[material.metal]
base = "ofhc-copper"

[[body]]
name = "block"
material = "metal"
shape = { box = { min = ["-3 mm", "0 mm"], max = ["3 mm", "6 mm"] } }

[[wall]]
name = "below"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { friction = 0.0 } }

[[wall]]
name = "above"
plane = { point = ["0 mm", "6 mm"], normal = [0, -1] }
velocity = ["0 m/s", "-2.4 m/s"]
contact = { penalty = { friction = 0.0 } }
"#;

/// Force on the upper wall, N/m, mean temperature, K, steps, and mass, kg/m.
fn pressed(factor: &str) -> (f64, f64, u64, f64) {
    let mut simulation = simulation(PRESSED, &[("material.metal.mass-scaling", factor)]);
    // Heavy blocks ring between the walls: the mean over some of their periods.
    let forces = (0..=100).map(|k| {
        run_to(&mut simulation, 200e-6 + 0.5e-6 * f64::from(k));
        simulation.ledger().unwrap().wall_forces[1][1]
    });
    let force = forces.sum::<f64>() / 101.0;
    let p = simulation.particles().unwrap();
    let temperature = p.temperature.iter().sum::<f64>() / p.len() as f64;
    (force, temperature, simulation.steps(), p.mass.iter().sum())
}

#[test]
fn a_heavy_block_is_pressed_by_the_same_force_to_the_same_temperature_in_fewer_steps() {
    let [(force, temperature, steps, mass), heavy] = ["1", "16"].map(pressed);
    assert!(force.abs() > 1e6 && temperature > 300.0, "{force} N/m, {temperature} K");
    assert!((heavy.0 / force - 1.0).abs() < 0.01, "{} N/m of {force}", heavy.0);
    // What is heated is as much per volume as without.
    assert!(((heavy.1 - 293.15) / (temperature - 293.15) - 1.0).abs() < 0.01, "{} K of {temperature}", heavy.1);
    assert!((heavy.2 as f64 * 4.0 / steps as f64 - 1.0).abs() < 0.05, "{} steps of {steps}", heavy.2);
    assert!((heavy.3 / mass - 16.0).abs() < 1e-9, "{} kg/m of {mass}", heavy.3);
}
