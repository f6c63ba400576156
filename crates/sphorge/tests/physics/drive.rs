//! Loads and velocities that a program gives between steps: motions known in closed form, and balances to rounding whatever is given.

use super::setup::simulation;
use sphorge::engine::{Drive, Simulation, persist::MemoryArchive};

/// A soft block that is driven at its foot, whose other end is free.
const DRIVEN: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "10 mm" }
numerics = { precision = "double" }
time = { end = "1 s" }

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
velocity = ["0 m/s", "0 m/s"]

[[region]]
name = "foot"
shape = { box = { min = ["0 mm", "0 mm"], max = ["20 mm", "50 mm"] } }
"#;

const MOTION: &str = r#"
[[motion]]
region = "foot"
velocity = ["0 m/s", "free"]
"#;

/// Mass of the block, kg/m, and of its foot.
const MASS: f64 = 5.0;

const METHODS: [(&str, &str); 3] = [
    ("total-lagrangian", "leapfrog"),
    ("updated-lagrangian", "leapfrog"),
    ("updated-lagrangian", "predictor-corrector"),
];

fn start(deck: &str, (method, integrator): (&str, &str)) -> Simulation {
    simulation(deck, &[("method", method), ("numerics.integrator", integrator)])
}

fn energy(simulation: &Simulation) -> f64 {
    let ledger = simulation.ledger().unwrap();
    ledger.total_energy() - ledger.external_work
}

#[test]
fn a_constant_load_is_that_of_gravity() {
    for method in METHODS {
        let mut falling = start(&format!("gravity = [\"4 m/s^2\", \"-8 m/s^2\"]\n{DRIVEN}"), method);
        let mut loaded = start(DRIVEN, method);
        let drive = Drive { forces: vec![Some([4.0 * MASS, -8.0 * MASS, 0.0])], ..Drive::none(loaded.model()) };
        for _ in 0..40 {
            loaded.drive(&drive).unwrap();
            let (a, b) = (falling.step(None).unwrap(), loaded.step(None).unwrap());
            assert!((a.dt / b.dt - 1.0).abs() < 1e-12, "{method:?}");
        }
        let (a, b) = (falling.ledger().unwrap(), loaded.ledger().unwrap());
        assert!((a.external_work / b.external_work - 1.0).abs() < 1e-12 && b.external_work > 0.0, "{method:?}");
        for axis in 0..2 {
            assert!((a.total.momentum[axis] / b.total.momentum[axis] - 1.0).abs() < 1e-12, "{method:?}");
            assert!((a.total.centre[axis] / b.total.centre[axis] - 1.0).abs() < 1e-12, "{method:?}");
            assert!((a.external_impulse[axis] / b.external_impulse[axis] - 1.0).abs() < 1e-12, "{method:?}");
            assert!((a.total.force[axis] / b.total.force[axis] - 1.0).abs() < 1e-9, "{method:?}");
        }
    }
}

#[test]
fn a_load_that_jumps_gives_its_impulse_and_work_to_rounding() {
    for method in METHODS {
        let mut simulation = start(DRIVEN, method);
        let before = energy(&simulation);
        let (mut impulse, mut largest) = (0.0, 0.0f64);
        for step in 0..60 {
            // Up and down, nothing for a while, and on again.
            let force = [3e3, -7e3, 0.0, 0.0, 5e3][step % 5] * (1.0 + step as f64);
            simulation
                .drive(&Drive { forces: vec![Some([force, 0.0, 0.0])], ..Drive::none(simulation.model()) })
                .unwrap();
            impulse += force * simulation.step(None).unwrap().dt;
            largest = largest.max(simulation.ledger().unwrap().external_work.abs());
        }
        let ledger = simulation.ledger().unwrap();
        assert!((ledger.total.momentum[0] / impulse - 1.0).abs() < 1e-11, "{method:?}: {impulse}");
        assert!((ledger.external_impulse[0] / impulse - 1.0).abs() < 1e-11, "{method:?}");
        assert!((energy(&simulation) - before).abs() < 1e-12 * largest, "{method:?}");
        // Nothing else does work.
        assert!((ledger.load_work - ledger.external_work).abs() < 1e-12 * largest, "{method:?}: {}", ledger.load_work);
    }
}

#[test]
fn the_work_of_loads_is_told_from_that_of_motions_and_gravity() {
    for method in METHODS {
        let mut simulation = start(&format!("gravity = [\"0 m/s^2\", \"-8 m/s^2\"]\n{DRIVEN}{MOTION}"), method);
        let (mut work, mut largest) = (0.0, 0.0f64);
        for step in 0..60 {
            let force = [3e3, -7e3, 0.0, 0.0, 5e3][step % 5] * (1.0 + step as f64);
            let (forces, velocities) = (vec![Some([force, 0.0, 0.0])], vec![Some([Some(2.0), None, None])]);
            simulation.drive(&Drive { forces, velocities }).unwrap();
            let momentum = simulation.ledger().unwrap().total.momentum[0];
            let dt = simulation.step(None).unwrap().dt;
            // Spread by mass: the force times the mean velocity of the centre of mass.
            work += force * dt * 0.5 * (momentum + simulation.ledger().unwrap().total.momentum[0]) / MASS;
            largest = largest.max(work.abs());
        }
        let ledger = simulation.ledger().unwrap();
        // The kicks of a leapfrog step have another mean, by what is of second order.
        let exactly = if method.1 == "leapfrog" { 0.005 } else { 1e-9 };
        assert!((ledger.load_work - work).abs() < exactly * largest, "{method:?}: {} {work}", ledger.load_work);
        assert!((ledger.external_work - ledger.load_work).abs() > 0.1 * largest, "{method:?}: {ledger:?}");
    }
}

#[test]
fn a_velocity_that_jumps_is_that_of_its_particles_and_its_work_is_booked() {
    for method in METHODS {
        let mut simulation = start(&format!("{DRIVEN}{MOTION}"), method);
        let before = energy(&simulation);
        let mut largest = 0.0f64;
        for step in 0..60 {
            let velocity = [1.0, -2.0, 0.5][step % 3];
            let driven =
                Drive { velocities: vec![Some([Some(velocity), None, None])], ..Drive::none(simulation.model()) };
            simulation.drive(&driven).unwrap();
            let dt = simulation.step(None).unwrap().dt;
            let ledger = simulation.ledger().unwrap();
            largest = largest.max(ledger.external_work.abs());
            // Two of ten columns of particles, from one velocity to the next in one step: the whole reaction less what the others push.
            let former = if step == 0 { 0.0 } else { [1.0, -2.0, 0.5][(step - 1) % 3] };
            let inertia = 0.2 * MASS * (velocity - former) / dt;
            assert!((ledger.motion_forces[0][0] / inertia - 1.0).abs() < 0.5, "{method:?} {step}: {inertia}");
        }
        let velocities = simulation.particles().unwrap().velocity;
        assert_eq!(velocities.iter().filter(|v| v[0] == 0.5).count(), 10, "{method:?}");
        assert!((energy(&simulation) - before).abs() < 1e-11 * largest, "{method:?}");
        // Let go of, the foot keeps its velocity but for what the block does to it.
        let free = Drive { velocities: vec![Some([None; 3])], ..Drive::none(simulation.model()) };
        simulation.drive(&free).unwrap();
        let work = simulation.ledger().unwrap().external_work;
        for _ in 0..10 {
            simulation.step(None).unwrap();
        }
        assert!((simulation.ledger().unwrap().external_work - work).abs() < 1e-12 * largest, "{method:?}");
    }
}

#[test]
fn a_driven_state_that_is_saved_goes_on_to_the_same_bits() {
    for method in METHODS {
        let deck = format!("{DRIVEN}{MOTION}");
        let drive = |simulation: &mut Simulation, step: usize| {
            let velocity = [1.0, -2.0, 0.5][step % 3];
            let forces = vec![Some([0.0, 1e3 * (step as f64 - 5.0), 0.0])];
            simulation.drive(&Drive { forces, velocities: vec![Some([Some(velocity), None, None])] }).unwrap();
            simulation.step(None).unwrap();
        };
        let mut whole = start(&deck, method);
        (0..10).for_each(|step| drive(&mut whole, step));
        let mut saved = MemoryArchive::default();
        whole.persist(&mut saved).unwrap();
        let mut other = start(&deck, method);
        assert!(!other.is_driven());
        other.persist(&mut saved.reader()).unwrap();
        assert!(other.is_driven());
        assert_eq!(other.ledger().unwrap(), whole.ledger().unwrap(), "{method:?}");
        for step in 10..20 {
            drive(&mut whole, step);
            drive(&mut other, step);
            assert_eq!(other.ledger().unwrap(), whole.ledger().unwrap(), "{method:?} {step}");
        }
        assert_eq!(other.particles().unwrap().velocity, whole.particles().unwrap().velocity);
        // A state without is saved and loaded without.
        let mut plain = MemoryArchive::default();
        start(&deck, method).persist(&mut plain).unwrap();
        whole.persist(&mut plain.reader()).unwrap();
        assert!(!whole.is_driven());
    }
}

#[test]
fn what_does_not_fit_the_model_is_refused() {
    let mut simulation = start(&format!("{DRIVEN}{MOTION}"), METHODS[0]);
    let none = Drive::none(simulation.model());
    for wrong in [
        Drive { forces: vec![], ..none.clone() },
        Drive { forces: vec![Some([f64::NAN, 0.0, 0.0])], ..none.clone() },
        Drive { forces: vec![Some([0.0, 0.0, 1.0])], ..none.clone() },
        Drive { velocities: vec![], ..none.clone() },
        Drive { velocities: vec![Some([Some(f64::INFINITY), None, None])], ..none },
    ] {
        assert!(simulation.drive(&wrong).is_err(), "{wrong:?}");
    }
    assert!(!simulation.is_driven());
}
