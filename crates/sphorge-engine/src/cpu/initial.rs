//! Initial conditions: the state and the columns before the first step.

use super::conduction::hold;
use super::integrate::Motions;
use crate::model::{ArtificialStress, Body, BodyContact, Integrator, Material, Model, Search, Wall};
use crate::particles::{History, HistoryVariables, Owner, Particles};
use rayon::prelude::*;
use sphorge_physics::artificial_stress;

/// Particles one thread takes at least.
const AT_ONCE: usize = 1024;

/// Completes the state of particles that have position, velocity, density and temperature: energy, prescribed
/// temperatures, pressure and sound speed, and history variables of flow laws.
pub fn complete_initial_state(model: &Model, particles: &mut Particles) {
    // That of the temperature, whatever the source of temperatures to come: pressure depends on it.
    let energies: Vec<_> = model.materials.iter().map(Material::cold_energies::<f64>).collect();
    let Particles { material, temperature, density, energy, .. } = particles;
    energy.par_iter_mut().with_min_len(AT_ONCE).enumerate().for_each(|(i, energy)| {
        let material = material[i] as usize;
        // A temperature that is none is the fault to be named, not the energy that would follow from it.
        if model.materials[material].heats() && temperature[i].is_finite() {
            *energy += energies[material].of_temperature(density[i], temperature[i]);
        }
    });
    hold(model, particles);
    let Particles { material, density, energy, pressure, sound_speed, .. } = particles;
    let states = pressure.par_iter_mut().zip(sound_speed).with_min_len(AT_ONCE).enumerate();
    states.for_each(|(i, (pressure, sound_speed))| {
        let law = &model.materials[material[i] as usize].equation_of_state;
        let state = law.pressure(density[i], energy[i]);
        (*pressure, *sound_speed) = (state.pressure, state.sound_speed);
    });
    particles.history = History::new(model, particles.len());
}

/// Adds the columns that the options of a model need, and fills those that do not start with the value of the table.
pub(super) fn columns(model: &Model, particles: &mut Particles, is_corrected: bool, is_initial: bool) {
    let breaks = HistoryVariables::of(model).integrity().is_some();
    let wanted = [
        (Owner::Step, true),
        (Owner::Start, true),
        (Owner::Correction, is_corrected),
        (Owner::AdaptiveSearch, matches!(model.search, Search::Adaptive(_))),
        (Owner::PredictorCorrector, model.numerics.integrator == Integrator::PredictorCorrector),
        (Owner::Heat, model.thermal.conduction),
        (Owner::Contact, model.contact != BodyContact::Sph),
        (Owner::Faces, model.has_faces()),
        (Owner::Cells, model.has_faces() || model.meets_walls_at_facets()),
        (Owner::SharedEdges, model.has_facets()),
        (Owner::BrokenFacets, model.has_facets() && model.has_self_contact() && breaks),
        (Owner::Friction, model.contact != BodyContact::Sph || model.walls.iter().any(Wall::rubs)),
        (Owner::FacetFriction, model.has_facets() && model.contact.has_friction()),
        (Owner::WallFriction, model.rubs_at_facets_of_walls()),
        (Owner::ArtificialEnergy, model.books_artificial_energy()),
        (Owner::Reference, is_initial),
        (Owner::FaceGradients, model.formulation.is_quadratic_at_faces()),
    ];
    for (owner, _) in wanted.into_iter().filter(|(_, wanted)| *wanted) {
        particles.allocate(owner);
    }
    particles.initial_position.clone_from(&particles.position);
    particles.evaluated_velocity.clone_from(&particles.velocity);
    particles.motion = Motions::assign(model, particles);
    if matches!(model.search, Search::Adaptive(_)) {
        particles.origin.clone_from(&particles.position);
    }
}

/// Coefficient of the artificial stress of each body; nothing without one.
pub(super) fn repulsion(model: &Model) -> Vec<f64> {
    let Some(ArtificialStress { epsilon, exponent }) = model.numerics.artificial_stress else { return Vec::new() };
    let w_spacing = |body: &Body| model.numerics.kernel.w(body.spacing / body.smoothing_length);
    model.bodies.iter().map(|body| artificial_stress::coefficient(epsilon, w_spacing(body), exponent)).collect()
}
