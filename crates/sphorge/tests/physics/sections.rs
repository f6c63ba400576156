//! The force through a section of a bar is the one its grips hold.

use super::setup::{run_to, simulation};
use sphorge::engine::{ParticleSource, Reduction, Simulation};
use sphorge::model::Section;

/// A bar of steel in plane strain, 80 mm x 12 mm, waisted to 8 mm in the middle, whose ends are pulled apart.
const BAR: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "2 mm" }
numerics = { precision = "double", viscosity = { alpha = 1.0, beta = 1.0 } }
search = "total-lagrangian"
time = { end = "5 ms" }

[material.steel]
density = "7800 kg/m^3"
young-modulus = "20 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = { bilinear = { yield-stress = "100 MPa", tangent-modulus = "20 MPa" } }

[[body]]
name = "bar"
material = "steel"
shape.union = [
    { box = { min = ["-40 mm", "-6 mm"], max = ["-6 mm", "6 mm"] } },
    { box = { min = ["-6 mm", "-4 mm"], max = ["6 mm", "4 mm"] } },
    { box = { min = ["6 mm", "-6 mm"], max = ["40 mm", "6 mm"] } },
]
velocity-gradient = { rows = [["37.5 1/s", "0 1/s"], ["0 1/s", "0 1/s"]] }

[[region]]
name = "held"
shape = { box = { min = ["-40 mm", "-6 mm"], max = ["-34 mm", "6 mm"] } }

[[region]]
name = "pulled"
shape = { box = { min = ["34 mm", "-6 mm"], max = ["40 mm", "6 mm"] } }

[[motion]]
region = "held"
velocity = ["-1.5 m/s", "free"]

[[motion]]
region = "pulled"
velocity = ["1.5 m/s", "free"]
"#;

/// Force through the bar at a place, and what is lacking of it in the balance of momentum of what is to the left.
fn through(simulation: &Simulation, x: f64) -> (f64, f64) {
    let section = Section { name: "waist".into(), point: [x, 0.0, 0.0], normal: [1.0, 0.0, 0.0], body: None };
    let force = simulation.reduce(&Reduction::SectionForce(&section)).unwrap()[0];
    let p = simulation.particles().unwrap();
    let behind = |i: &usize| p.position[*i][0] < x;
    let taken: f64 = (0..p.len()).filter(behind).map(|i| p.mass[i] * p.acceleration[i][0]).sum();
    (force, force - taken)
}

/// Means over some microseconds, which waves along the bar cross a few times: the force of the grips, then through two sections.
fn forces(simulation: &mut Simulation) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let start = simulation.time();
    for k in 1..=40 {
        run_to(simulation, start + 5e-6 * f64::from(k));
        let grips = simulation.ledger().unwrap().motion_forces;
        let [waist, shoulder] = [0.2e-3, 17.3e-3].map(|x| through(simulation, x));
        for (force, lacking) in [waist, shoulder] {
            assert!(lacking.abs() < 1e-9 * force.abs(), "{lacking:e} of {force}");
        }
        let now = [0.5 * (grips[1][0] - grips[0][0]), waist.0, shoulder.0];
        sum = [0, 1, 2].map(|k| sum[k] + now[k] / 40.0);
    }
    sum
}

#[test]
fn sections_carry_what_the_grips_hold_up_to_the_neck() {
    let mut simulation = simulation(BAR, &[]);
    // Flowing, then necked.
    let held = [1.5e-3, 4e-3].map(|time| {
        run_to(&mut simulation, time);
        let [grips, waist, shoulder] = forces(&mut simulation);
        for section in [waist, shoulder] {
            assert!((section / grips - 1.0).abs() < 0.005, "at {time}: {section} of {grips}");
        }
        grips
    });
    assert!(held[1] < 0.85 * held[0], "the bar has not necked: {held:?}");
}

#[test]
fn sections_of_present_sums_carry_what_is_behind_them() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        let mut simulation = simulation(BAR, &[("search", "skin"), ("numerics.integrator", integrator)]);
        run_to(&mut simulation, 0.1e-3);
        forces(&mut simulation);
    }
}
