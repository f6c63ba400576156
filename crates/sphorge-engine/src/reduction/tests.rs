//! Extents of particles that are deformed.

use super::suspicion::tests::{material, model};
use super::*;

/// Three particles in a row along y, two spacings of 1 m apart, each stretched to twice its length and sheared.
fn stretched() -> Particles {
    let mut particles = Particles::new(3);
    particles.position = vec![[0.0, -2.0, 0.0], [0.0; 3], [0.0, 2.0, 0.0]];
    particles.deformation = vec![[[0.5, 0.3, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]; 3];
    particles
}

fn extents(particles: &Particles) -> [f64; 3] {
    let of = &ParticleSelection::default();
    let model = model(vec![material("mie-gruneisen")]);
    let reductions =
        [Reduction::Extent { of, axis: 0 }, Reduction::Extent { of, axis: 1 }, Reduction::Diameter { of, axis: 2 }];
    reductions.map(|reduction| {
        let found = evaluate(&reduction, &model, particles);
        // What it says it reads is all it reads.
        assert_eq!(found, evaluate(&reduction, &model, &particles.with_fields(&reduction.fields()).unwrap()));
        found[0]
    })
}

#[test]
fn particles_reach_as_far_as_they_are_deformed() {
    // Balls of 1 m reach |F^T n|/2: sqrt(0.5^2 + 0.3^2)/2 along x, 1 along y.
    let [across, along, diameter] = extents(&stretched());
    assert!((across - 0.34f64.sqrt()).abs() < 1e-12, "{across}");
    assert_eq!([along, diameter], [6.0, 6.0]);
}

#[test]
fn particles_of_bodies_that_come_apart_and_of_present_neighbours_are_as_large_as_at_rest() {
    let mut apart = stretched();
    apart.earlier_deformation = apart.deformation.clone();
    assert_eq!(extents(&apart), [1.0, 5.0, 5.0]);
    let mut undeformed = stretched();
    undeformed.deformation.clear();
    assert_eq!(extents(&undeformed), [1.0, 5.0, 5.0]);
}

#[test]
fn one_particle_is_as_wide_as_its_spacing() {
    assert_eq!(extents(&Particles::new(1)), [1.0; 3]);
}
