//! Symmetry planes and periodic ends against the whole problem, and against each other.

use super::setup::{run_to, simulation};
use sphorge::{Particles, engine::Simulation};
use std::collections::HashMap;

const BLOCK: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double", artificial-stress = true, xsph = 0.5 }
time = { end = "20 us" }

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["-5 mm", "-5 mm"], max = ["5 mm", "5 mm"] } }
velocity = ["0 m/s", "0 m/s"]

[[wall]]
name = "right"
plane = { point = ["5.2 mm", "0 mm"], normal = [-1, 0] }
velocity = ["-150 m/s", "0 m/s"]

[[wall]]
name = "left"
plane = { point = ["-5.2 mm", "0 mm"], normal = [1, 0] }
velocity = ["150 m/s", "0 m/s"]
"#;

/// Positions at the start, in tenths of a millimetre, by id.
fn starts(particles: &Particles) -> HashMap<u32, [i64; 2]> {
    let start = |i: usize| [0, 1].map(|a| (particles.position[i][a] * 1e4).round() as i64);
    (0..particles.len()).map(|i| (particles.id[i], start(i))).collect()
}

/// State of the particle that started at a place.
fn states(simulation: &Simulation, starts: &HashMap<u32, [i64; 2]>) -> HashMap<[i64; 2], ([f64; 3], f64, f64)> {
    let p = &simulation.particles().unwrap();
    (0..p.len()).map(|i| (starts[&p.id[i]], (p.position[i], p.plastic_strain[i], p.energy[i]))).collect()
}

#[test]
fn a_quarter_between_symmetry_planes_is_the_whole_block() {
    for correction in ["none", "linear"] {
        let overrides = [("numerics.gradient-correction", correction)];
        let mut whole = simulation(BLOCK, &overrides);
        let quarter = BLOCK.replace(r#"min = ["-5 mm", "-5 mm"]"#, r#"min = ["0 mm", "0 mm"]"#).replace(
            "[[wall]]\nname = \"left\"",
            "[[symmetry]]\naxis = \"x\"\n\n[[symmetry]]\naxis = \"y\"\n\n[[wall]]\nname = \"left\"",
        );
        let mut quarter = simulation(&quarter, &overrides);
        let (whole_starts, quarter_starts) =
            (starts(&whole.particles().unwrap()), starts(&quarter.particles().unwrap()));
        assert_eq!(whole.particles().unwrap().len(), 4 * quarter.particles().unwrap().len());
        run_to(&mut whole, 10e-6);
        run_to(&mut quarter, 10e-6);
        let (whole, quarter) = (states(&whole, &whole_starts), states(&quarter, &quarter_starts));
        let mut yielded = 0.0f64;
        for (start, (x, strain, energy)) in &quarter {
            let (x_whole, strain_whole, energy_whole) = whole[start];
            yielded = yielded.max(*strain);
            for a in 0..2 {
                assert!((x[a] - x_whole[a]).abs() < 1e-10, "{correction} {start:?}: {x:?} and {x_whole:?}");
            }
            assert!((strain - strain_whole).abs() < 1e-7 && (energy - energy_whole).abs() < 1e-6 * energy.abs() + 1e-6);
        }
        assert!(yielded > 0.05, "{yielded}");
    }
}

/// A strip that hits its mirror image.
const STRIP: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
time = { end = "5 us" }

[[body]]
name = "strip"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["30 mm", "6 mm"] } }
velocity = ["-100 m/s", "0 m/s"]

[[symmetry]]
axis = "x"
"#;

#[test]
fn periodic_and_symmetric_sides_hold_a_strip_in_the_same_way() {
    let planes = r#"
[[symmetry]]
axis = "y"

[[symmetry]]
axis = "y"
at = "6 mm"
side = "negative"
"#;
    let periodic = "[periodic]\ny = [\"0 mm\", \"6 mm\"]\n";
    let [periodic, planes] = [periodic, planes].map(|sides| {
        let mut simulation = simulation(&format!("{STRIP}\n{sides}"), &[]);
        let starts = starts(&simulation.particles().unwrap());
        run_to(&mut simulation, 3e-6);
        assert!(simulation.particles().unwrap().velocity.iter().all(|v| v[1].abs() < 1e-6));
        assert!(
            simulation.particles().unwrap().velocity.iter().any(|v| v[0].abs() < 50.0),
            "the wave has not left the plane"
        );
        states(&simulation, &starts)
    });
    for (start, (x, ..)) in &periodic {
        let other = planes[start].0;
        assert!((0..2).all(|a| (x[a] - other[a]).abs() < 1e-12), "{start:?}: {x:?} and {other:?}");
    }
}

/// A row of layers that drifts along a periodic axis. Its reach of 2.5 spacings lets a layer leave the ghosts of one end in the step
/// in which another enters those of the other.
const DRIFT: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm", smoothing = 1.25 }
numerics = { precision = "double" }
time = { end = "20 us" }
periodic = { y = ["0 mm", "6 mm"] }

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["8 mm", "6 mm"] } }
velocity = ["0 m/s", "200 m/s"]
"#;

#[test]
fn ghosts_that_change_in_equal_number_are_searched_for_anew() {
    for search in ["every-step", "skin", "adaptive"] {
        let mut simulation = simulation(DRIFT, &[("search", search), ("audit", "1")]);
        // More than a spacing of the drift.
        while simulation.time() < 6e-6 {
            let report = simulation.step(None).unwrap();
            let missed = report.audit.map(|audit| audit.missed_pairs);
            assert_eq!(missed, Some(0), "{search}, step {}", report.step);
        }
    }
}
