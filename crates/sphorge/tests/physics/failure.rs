//! A run that breaks down says where.

use super::setup::COLLISION;
use sphorge::{deck, solver::Simulation};

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
