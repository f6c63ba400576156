//! Strips of few layers that bend plastically: how far they bend, and what the outermost layer sees of it.

use super::setup::{by_id, run_to, simulation};
use sphorge::{Particles, deck, engine::Simulation};

/// Half of a strip of 60 x 3 mm whose arms fly to the same side and are stopped by a hinge in the middle.
const STRIP: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "0.5 mm" }
time = { end = "360 us" }
symmetry = [{ axis = "x" }]

[material.metal]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = { perfectly-plastic = { yield-stress = "300 MPa" } }

[[body]]
name = "strip"
material = "metal"
shape = { box = { min = ["0 mm", "-1.5 mm"], max = ["30 mm", "1.5 mm"] } }
velocity-profile = { along = "x", amplitude = ["0 m/s", "54.51 m/s"], rows = [["0 mm", -1.0], ["30 mm", 1.0]] }
"#;

/// By finite elements. An arm has 350 J per metre of width and a fully plastic hinge takes 779 J/m per radian of either
/// arm: 0.449 rad for rigid arms.
const RIGHT: f64 = 0.441;

/// The angle by which the arm has turned, between its outermost tenth and the stretch from 12 to 15 mm.
fn angle(now: &Particles, at_start: &[[f64; 3]]) -> f64 {
    let mean = |from: f64, to: f64| {
        let of = by_id(now).into_iter().zip(at_start).filter(|(_, x)| (from..to).contains(&x[0]));
        let places: Vec<[f64; 3]> = of.map(|(i, _)| now.position[i]).collect();
        [0, 1].map(|a| places.iter().map(|x| x[a]).sum::<f64>() / places.len() as f64)
    };
    let (near, far) = (mean(0.012, 0.015), mean(0.027, 0.030));
    (far[1] - near[1]).atan2(far[0] - near[0])
}

const LINEAR: (&str, &str) = ("search", "total-lagrangian");
const QUADRATIC: (&str, &str) = ("search", "{ total-lagrangian = { faces = \"quadratic\" } }");

/// The final angle with so many layers, over the right one.
fn bent(layers: u32, faces: (&str, &str)) -> f64 {
    let mut simulation =
        simulation(STRIP, &[("particles.spacing", &format!("\"{} mm\"", 3.0 / f64::from(layers))), faces]);
    let at_start = {
        let p = simulation.particles().unwrap();
        by_id(&p).into_iter().map(|i| p.position[i]).collect::<Vec<_>>()
    };
    // The arms vibrate about it.
    let times = (0..=60).map(|k| 1e-6 * f64::from(300 + k));
    let angles = times.map(|time| {
        run_to(&mut simulation, time);
        angle(&simulation.particles().unwrap(), &at_start)
    });
    angles.sum::<f64>() / 61.0 / RIGHT
}

fn bends_as_far_as_finite_elements(layers: u32, faces: (&str, &str), bound: f64) {
    let bent = bent(layers, faces);
    assert!((bent - 1.0).abs() < bound, "{layers} layers: {bent}");
}

#[test]
fn hinges_of_six_layers_bend_as_far_as_finite_elements() {
    bends_as_far_as_finite_elements(6, LINEAR, 0.02);
}

#[test]
#[ignore = "long: scripts/nightly.sh"]
fn hinges_of_eight_layers_bend_as_far_as_finite_elements() {
    bends_as_far_as_finite_elements(8, LINEAR, 0.015);
}

#[test]
fn hinges_with_quadratic_gradients_at_faces_bend_as_far_as_finite_elements() {
    for (layers, bound) in [(3, 0.02), (4, 0.045)] {
        bends_as_far_as_finite_elements(layers, QUADRATIC, bound);
    }
}

#[test]
#[ignore = "long: scripts/nightly.sh"]
fn hinges_of_six_layers_with_quadratic_gradients_at_faces_bend_as_far_as_finite_elements() {
    bends_as_far_as_finite_elements(6, QUADRATIC, 0.02);
}

/// What `docs/guide/limits.md` says of fewer layers.
#[test]
fn hinges_of_three_and_four_layers_bend_a_third_too_far_and_a_fifth_too_little() {
    for (layers, measured) in [(3, 1.33), (4, 0.81)] {
        let bent = bent(layers, LINEAR);
        assert!((bent - measured).abs() < 0.02, "{layers} layers: {bent}");
    }
}

/// The reason: neighbours of a particle at a face are on one side of it. In bending that keeps the volume, `v = k (-x y,
/// (x^2 + y^2)/2)`, it sees `-0.772 k` less than its own place along the strip and so on, and with both a change of volume of
/// 0.475 `k h`. Metal that yields cannot follow it.
#[test]
fn the_outermost_layer_of_a_bent_strip_sees_a_change_of_volume() {
    see_bending(LINEAR, [(0.0, 0.0), (0.0, 0.0173), (0.2278, 0.4747)]);
}

/// What is left is that of the second layer, which is not taken for a face.
#[test]
fn with_quadratic_gradients_at_faces_it_sees_none() {
    see_bending(QUADRATIC, [(0.0, 0.0), (0.0, 0.0173), (0.0, 0.0)]);
}

/// What the layers, from the middle outwards, see less of the strain along the strip than there is, and of its volume, over `k h`.
fn see_bending(faces: (&str, &str), expected: [(f64, f64); 3]) {
    let (layers, curvature, h) = (6u32, 1e3, 0.5e-3);
    let fixed = [
        faces,
        ("numerics", "{ precision = \"double\", viscosity = false }"),
        ("time", "{ end = \"1 s\", fixed-step = \"0.001 ns\" }"),
    ];
    let overrides: Vec<_> = fixed.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
    let mut setup = deck::load_text("test", STRIP, &overrides).unwrap_or_else(|report| panic!("{report:?}"));
    for (x, v) in setup.particles.position.iter().zip(&mut setup.particles.velocity) {
        *v = [-curvature * x[0] * x[1], 0.5 * curvature * (x[0] * x[0] + x[1] * x[1]), 0.0];
    }
    let mut simulation = Simulation::new(setup.model, setup.particles);
    simulation.step(None).unwrap();
    let p = simulation.particles().unwrap();
    for i in (0..p.len()).filter(|&i| (0.010..0.020).contains(&p.position[i][0])) {
        let (y, l) = (p.position[i][1], &p.velocity_gradient[i]);
        let layer = ((y.abs() / h + 0.5).round() as u32).min(layers / 2);
        let (seen, volume) = (-l[0][0] / curvature, (l[0][0] + l[1][1]) / curvature);
        let (lost, false_volume) = expected[layer as usize - 1];
        assert!((seen - y.signum() * (y.abs() - lost * h)).abs() < 1e-3 * h, "{y}: {seen}");
        assert!((volume + y.signum() * false_volume * h).abs() < 1e-3 * h, "{y}: {volume}");
    }
}
