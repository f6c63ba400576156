//! Gravity, friction, prescribed motion: motions known in closed form.

use super::setup::{by_id, run_to, simulation};
use sphorge::engine::LimitReason;

/// A soft block of 10 x 5 particles, so that contact is soft and steps are long.
const SOFT_BLOCK: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "10 mm" }
numerics = { precision = "double" }
time = { end = "1 s" }
gravity = ["0 m/s^2", "-10 m/s^2"]

[material.soft]
density = "1000 kg/m^3"
young-modulus = "20 MPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "block"
material = "soft"
shape = { box = { min = ["0 mm", "0 mm"], max = ["100 mm", "50 mm"] } }
velocity = ["1 m/s", "0 m/s"]
"#;

/// Mass of the block, kg/m.
const MASS: f64 = 5.0;

#[test]
fn free_fall_is_a_parabola() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        let mut simulation = simulation(SOFT_BLOCK, &[("numerics.integrator", integrator)]);
        let first = simulation.ledger().unwrap().total;
        run_to(&mut simulation, 0.05);
        let ledger = simulation.ledger().unwrap();
        let (now, t) = (&ledger.total, 0.05);
        assert!((now.mass - MASS).abs() < 1e-12);
        for (a, v, x) in [(0, 1.0, t), (1, -10.0 * t, -5.0 * t * t)] {
            assert!((now.momentum[a] / MASS - v).abs() < 1e-12, "{integrator} {a}");
            assert!((now.centre[a] - first.centre[a] - x).abs() < 1e-12, "{integrator} {a}");
        }
        assert!((ledger.external_work - MASS * 10.0 * 5.0 * t * t).abs() < 1e-12, "{integrator}");
        assert!(now.force[0].abs() < 1e-9 && (now.force[1] + MASS * 10.0).abs() < 1e-9, "{integrator}");
        // No strain: nothing but gravity acts.
        assert!(now.energies.elastic < 1e-20, "{integrator} {}", now.energies.elastic);
    }
}

#[test]
fn friction_decelerates_a_sliding_block_by_its_coefficient_times_gravity() {
    let floor = r#"
[[wall]]
name = "floor"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { stiffness = 1.0, damping = 0.3, friction = 0.25 } }
"#;
    let mut simulation = simulation(&format!("{SOFT_BLOCK}{floor}"), &[]);
    let t = 0.2;
    run_to(&mut simulation, t);
    let ledger = simulation.ledger().unwrap();
    let velocity = ledger.total.momentum[0] / MASS;
    assert!((velocity - (1.0 - 0.25 * 10.0 * t)).abs() < 5e-3, "{velocity}");
    // Coulomb's law for the impulses of the floor, whatever the block does on it.
    let normal = ledger.external_impulse[1] + MASS * 10.0 * t;
    assert!((ledger.external_impulse[0] + 0.25 * normal).abs() < 1e-9, "{:?}", ledger.external_impulse);
    // It rests on the floor: its weight is what the floor carries, and it does not sink.
    assert!((ledger.total.momentum[1] / MASS).abs() < 5e-3);
    let lowest = simulation.particles().unwrap().position.iter().map(|x| x[1]).fold(f64::INFINITY, f64::min);
    assert!((4.8e-3..5.2e-3).contains(&lowest), "{lowest}");
}

#[test]
fn a_stiff_wall_limits_the_step_by_the_frequency_of_its_spring() {
    let floor = r#"
[[wall]]
name = "floor"
plane = { point = ["0 mm", "-50 mm"], normal = [0, 1] }
contact = { penalty = { stiffness = 100.0, damping = 0.0, friction = 0.0 } }
"#;
    let mut simulation = simulation(&format!("{SOFT_BLOCK}{floor}"), &[]);
    let (dt, reason) = simulation.next_step_estimate().unwrap();
    // K = 20 MPa/(3 (1 - 0.6)); omega = sqrt(100) sqrt(K/rho)/dx, and 2/omega is stable.
    let omega = 10.0 * (20e6f64 / 1.2 / 1000.0).sqrt() / 0.01;
    assert_eq!(reason, LimitReason::Contact);
    assert!((dt / (simulation.model().time.courant * 2.0 / omega) - 1.0).abs() < 1e-9, "{dt}");
}

/// A block of copper strikes a wall at rest, in the total Lagrangian form, whose particles a wall meets at their faces.
pub(crate) const STRUCK_WALL: &str = r#"
dimensions = "plane-strain"
search = "total-lagrangian"
particles = { spacing = "0.5 mm" }
numerics = { precision = "double" }
time = { end = "16 us" }

[[body]]
name = "block"
material = "ofhc-copper"
shape = { box = { min = ["-3 mm", "0 mm"], max = ["3 mm", "6 mm"] } }
velocity = ["0 m/s", "-200 m/s"]

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = "penalty"
"#;

#[test]
fn a_wall_at_rest_without_friction_takes_nothing() {
    for (velocity, search) in [("-50 m/s", "total-lagrangian"), ("-300 m/s", "total-lagrangian"), ("-200 m/s", "skin")]
    {
        let mut simulation = simulation(STRUCK_WALL, &[("body.block.velocity.1", velocity), ("search", search)]);
        let supplied = simulation.ledger().unwrap().total.energies.kinetic;
        let (mut deepest, end) = (0.0f64, simulation.model().time.end);
        while simulation.time() < end {
            simulation.step(Some(end)).unwrap();
            deepest = deepest.min(simulation.ledger().unwrap().walls[0].work / supplied);
        }
        let ledger = simulation.ledger().unwrap();
        let work = ledger.walls[0].work / supplied;
        // What its spring holds comes back.
        assert!(deepest < -0.01, "{velocity}, {search}: {deepest}");
        assert!(work.abs() < 0.01, "{velocity}, {search}: {work}");
        // Every joule is somewhere.
        let total = ledger.total.energies.kinetic + ledger.total.energies.internal;
        assert!((total - ledger.external_work - supplied).abs() < 1e-9 * supplied, "{velocity}, {search}");
        assert!((ledger.external_work - ledger.walls[0].work).abs() < 2e-3 * supplied, "{velocity}, {search}");
    }
}

/// Half the width of the foot at the end (m) and the largest plastic strain: finite elements, 24 x 48, on a wall that lets go and on
/// one that does not (`reference/finite-elements/taylor_bar.json`, `block`). From 12 x 24 on the feet have grown by 0.5 and 0.6 %. Where
/// the wall lets go the strain is that of elements as large as the particles, 12 x 24: it grows by 13 % with the finer ones.
const FOOT_LET_GO: (f64, f64) = (6.163e-3, 1.067);
const FOOT_HELD: (f64, f64) = (5.915e-3, 0.889);

#[test]
fn a_foot_spreads_as_in_finite_elements_on_a_wall_and_on_a_plane_of_symmetry() {
    let wall = &STRUCK_WALL[STRUCK_WALL.find("[[wall]]").unwrap()..];
    let plane = STRUCK_WALL.replace(wall, "[[symmetry]]\naxis = \"y\"\n");
    for (deck, (width, strain)) in [(STRUCK_WALL, FOOT_LET_GO), (&plane, FOOT_HELD)] {
        let mut simulation = simulation(deck, &[("particles.spacing", "0.25 mm")]);
        run_to(&mut simulation, 16e-6);
        let particles = simulation.particles().unwrap();
        // The lowest row: particles are a cell, half of which is beyond the last of them.
        let order = by_id(simulation.particles().unwrap());
        let mut row: Vec<f64> = order[..24].iter().map(|&i| particles.position[i][0]).collect();
        row.sort_by(f64::total_cmp);
        let edge = row[23] + 0.5 * (row[23] - row[22]);
        let largest = particles.plastic_strain.iter().copied().fold(0.0, f64::max);
        assert!((edge / width - 1.0).abs() < 0.01, "edge {edge}, finite elements {width}");
        assert!((largest / strain - 1.0).abs() < 0.1, "strain {largest}, finite elements {strain}");
    }
}

#[test]
fn friction_stops_a_block_and_holds_it() {
    let floor = r#"
[[wall]]
name = "floor"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { stiffness = 1.0, damping = 0.3, friction = 0.25 } }
"#;
    let mut simulation = simulation(&format!("{SOFT_BLOCK}{floor}"), &[]);
    // It would stop after 0.4 s.
    run_to(&mut simulation, 0.6);
    let velocity = simulation.ledger().unwrap().total.momentum[0] / MASS;
    assert!(velocity.abs() < 0.02, "{velocity}");
}

#[test]
fn prescribed_motion_follows_its_table_and_its_force_is_mass_times_acceleration() {
    // From 0 to 2 m/s over 10 ms, then constant; nothing else acts.
    let driven = r#"
[[region]]
name = "all"
body = "block"

[[motion]]
region = "all"
velocity = [[["0 ms", "0 m/s"], ["10 ms", "2 m/s"]], "free"]
"#;
    for integrator in ["leapfrog", "predictor-corrector"] {
        let overrides = [("numerics.integrator", integrator), ("gravity", "[0, 0]")];
        let mut simulation = simulation(&format!("{SOFT_BLOCK}{driven}"), &overrides);
        simulation.next_step_estimate().unwrap();
        let first = simulation.ledger().unwrap();
        run_to(&mut simulation, 5e-3);
        let half_way = simulation.ledger().unwrap();
        assert!((half_way.total.momentum[0] / MASS - 1.0).abs() < 1e-12, "{integrator}");
        assert!((half_way.total.centre[0] - first.total.centre[0] - 2.5e-3).abs() < 1e-12, "{integrator}");
        assert!(
            (half_way.motion_forces[0][0] - MASS * 200.0).abs() < 1e-6,
            "{integrator}: {:?}",
            half_way.motion_forces
        );
        assert!(half_way.motion_forces[0][1].abs() < 1e-9);
        // The work of the drive is the kinetic energy gained: m v^2/2 from 0 to 1 m/s.
        let work = half_way.external_work - first.external_work;
        let gained = half_way.total.energies.kinetic - first.total.energies.kinetic;
        assert!((work - gained).abs() < 1e-12 * MASS, "{integrator}: {work} {gained}");
        run_to(&mut simulation, 20e-3);
        let end = simulation.ledger().unwrap();
        assert!((end.total.momentum[0] / MASS - 2.0).abs() < 1e-12, "{integrator}");
        // A step may stride over the corner of the table.
        assert!((end.total.centre[0] - first.total.centre[0] - 30e-3).abs() < 1e-5, "{integrator}");
        assert!(end.motion_forces[0][0].abs() < 1e-6, "{integrator}: {:?}", end.motion_forces);
    }
}
