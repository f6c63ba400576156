//! Simulations from deck text.

use sphorge::{Particles, deck, engine::Simulation};
use std::borrow::Borrow;

/// A deck's simulation, with some values changed.
pub(crate) fn simulation(text: &str, overrides: &[(&str, &str)]) -> Simulation {
    let overrides: Vec<_> = overrides.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
    let setup = deck::load_text("test", text, &overrides).unwrap_or_else(|report| panic!("{report:?}"));
    Simulation::new(setup.model, setup.particles)
}

/// Steps until exactly `end`, s.
pub(crate) fn run_to(simulation: &mut Simulation, end: f64) {
    while simulation.time() < end {
        simulation.step(Some(end)).unwrap_or_else(|failure| panic!("{failure}"));
    }
}

/// Takes a number of steps.
pub(crate) fn run_steps(simulation: &mut Simulation, steps: u64) {
    for _ in 0..steps {
        simulation.step(None).unwrap_or_else(|failure| panic!("{failure}"));
    }
}

/// Places of the particles in the columns, in the order of their ids.
pub(crate) fn by_id(particles: impl Borrow<Particles>) -> Vec<usize> {
    let particles = particles.borrow();
    let mut order: Vec<usize> = (0..particles.len()).collect();
    order.sort_by_key(|&i| particles.id[i]);
    order
}

/// Length of a vector.
pub(crate) fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Two blocks of iron that hit each other off centre, yield and heat: pairs of both bodies, every term of the force.
pub(crate) const COLLISION: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }

[numerics]
precision = "double"
viscosity = { alpha = 1.0, beta = 2.0 }
artificial-stress = true
xsph = 0.5

[time]
end = "20 us"

[[body]]
name = "anvil"
material = "armco-iron"
shape = { box = { min = ["-10 mm", "-12 mm"], max = ["10 mm", "0 mm"] } }

[[body]]
name = "hammer"
material = "armco-iron"
shape = { box = { min = ["-2 mm", "0 mm"], max = ["10 mm", "12 mm"] } }
velocity = ["-40 m/s", "-250 m/s"]
spin = { rate = "2000 rad/s" }
"#;
