//! A run that breaks down says where.

use super::setup::{COLLISION, simulation};
use sphorge::{deck, engine::Simulation};

#[test]
fn a_value_that_is_not_a_number_names_step_particle_and_field() {
    let setup = deck::load_text("test", COLLISION, &[]).unwrap();
    let mut particles = setup.particles;
    let victim = particles.len() / 3;
    particles.temperature[victim] = f64::NAN;
    let id = particles.id[victim];
    let body = particles.body[victim];
    let mut simulation = Simulation::new(setup.model, particles);
    let failure = simulation.step(None).unwrap_err();
    assert_eq!((failure.particle, failure.body, failure.field), (Some(id), Some(body), "temperature"));
    assert!(failure.to_string().contains(&format!("particle {id}")), "{failure}");
    assert_eq!(failure.step, 1);
}

#[test]
fn an_infinite_velocity_is_found_before_it_spreads() {
    let setup = deck::load_text("test", COLLISION, &[]).unwrap();
    let mut particles = setup.particles;
    particles.velocity[5][1] = f64::INFINITY;
    let mut simulation = Simulation::new(setup.model, particles);
    let failure = simulation.step(None).unwrap_err();
    assert!(failure.particle.is_some() && failure.time == 0.0, "{failure}");
}

#[test]
fn a_position_that_is_lost_is_told_by_where_the_step_began() {
    for integrator in ["leapfrog", "predictor-corrector"] {
        // The square of the speed is beyond double precision.
        let settings = [("numerics.integrator", integrator), ("numerics.precision", "double")];
        let settings = settings.map(|(key, value)| (key.to_owned(), format!("\"{value}\"")));
        let setup = deck::load_text("test", COLLISION, &settings).unwrap();
        let mut particles = setup.particles;
        particles.velocity.iter_mut().step_by(2).for_each(|v| v[0] = 1e160);
        let places = particles.position.clone();
        let mut simulation = Simulation::new(setup.model, particles);
        let failure = simulation.step(None).unwrap_err();
        let (id, place) = (failure.particle.unwrap() as usize, failure.position.unwrap());
        assert!(place.iter().all(|x| x.is_finite()), "{integrator}: {failure}");
        assert!((0..3).all(|a| (place[a] - places[id][a]).abs() < 1e-3), "{integrator}: {failure}");
    }
}

/// A plate that a flux cools without end.
const COOLED: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "5 mm" }
time = { end = "1000 s" }
thermal = { mechanics = false, boundary = [{ name = "sink", flux = "-1 MW/m^2" }] }

[material.metal]
density = "4000 kg/m^3"
young-modulus = "200 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"
specific-heat = "500 J/(kg K)"
conductivity = "20 W/(m K)"

[[body]]
name = "plate"
material = "metal"
shape = { box = { min = ["0 mm", "0 mm"], max = ["50 mm", "30 mm"] } }
"#;

#[test]
fn a_flux_that_takes_more_heat_than_there_is_ends_the_run() {
    let mut simulation = simulation(COOLED, &[]);
    let failure = loop {
        if let Err(failure) = simulation.step(None) {
            break failure;
        }
        assert!(simulation.particles().unwrap().temperature.iter().all(|&t| t >= 0.0));
    };
    assert_eq!(failure.field, "temperature");
    assert!(failure.particle.is_some() && failure.step == simulation.steps() + 1 && failure.time > 0.0);
    assert!(failure.to_string().contains("removes more heat than it contains"), "{failure}");
}
