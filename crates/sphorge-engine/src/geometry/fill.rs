//! From bodies to particles.

use super::{FillError, overlap, pattern::Pattern};
use crate::model::{Body, Model, Region, Solid, WallSurface};
use crate::particles::Particles;

/// Regions a deck can have: one bit each.
pub const MAX_REGIONS: usize = 32;
/// Particles a run can have on a machine of any size.
pub const MAX_PARTICLES: f64 = 2e8;
/// Memory of a run per particle, bytes, rounded: columns, the arrays of the engine and neighbour lists in three dimensions.
pub const BYTES_PER_PARTICLE: f64 = 1000.0;
/// Memory per particle of the state that step control keeps, bytes, rounded.
const KEPT_BYTES_PER_PARTICLE: f64 = 800.0;

/// Memory of a run of this model per particle, bytes, rounded.
pub fn bytes_per_particle(model: &Model) -> f64 {
    BYTES_PER_PARTICLE + if model.time.step_control.is_some() { KEPT_BYTES_PER_PARTICLE } else { 0.0 }
}

pub(super) fn pattern(model: &Model, body: &Body) -> Pattern {
    let density = model.density_at_start(body);
    Pattern { dimensions: model.dimensions, spacing: body.spacing, density, lattice: body.lattice }
}

/// Number of particles of each body, without making them: exact for boxes, from the volume for others.
pub fn estimated_count(model: &Model) -> Vec<f64> {
    model.bodies.iter().map(|body| pattern(model, body).estimate(&body.shape)).collect()
}

/// Fills every body and selects the regions, with no more particles than there is memory for or [`MAX_PARTICLES`]; `most_particles` is that memory
/// over [`BYTES_PER_PARTICLE`].
///
/// Particles are numbered body by body. Mass is the density at the start ([`Model::density_at_start`]) times the volume a particle stands for, on a lattice spacing to the
/// power of the dimensions: per metre of thickness in plane strain, per square metre in one dimension.
///
/// # Errors
/// Everything that is wrong with the placement of bodies, regions, walls, symmetry planes and periodic cells.
pub fn fill(model: &Model, most_particles: f64) -> Result<Particles, Vec<FillError>> {
    let mut errors = Vec::new();
    for (index, body) in model.bodies.iter().enumerate() {
        let thickness = body.shape.thickness(model.dimensions);
        // A plate as thick as the spacing has one layer, however its edge was rounded.
        if thickness < body.spacing * (1.0 - 1e-6) {
            errors.push(FillError::Empty { body: index, thickness, spacing: body.spacing });
        }
    }
    let counts = estimated_count(model);
    let total: f64 = counts.iter().sum();
    let limit = (most_particles * BYTES_PER_PARTICLE / bytes_per_particle(model)).min(MAX_PARTICLES);
    if total > limit {
        let body = (0..counts.len()).max_by(|&a, &b| counts[a].total_cmp(&counts[b])).unwrap_or(0);
        errors.push(FillError::TooMany { body, count: total, limit });
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let mut positions: Vec<[f64; 3]> = Vec::with_capacity(total as usize);
    let mut volumes: Vec<f64> = Vec::with_capacity(total as usize);
    let mut starts = Vec::with_capacity(model.bodies.len() + 1);
    for (index, body) in model.bodies.iter().enumerate() {
        starts.push(positions.len());
        pattern(model, body).for_each_site(&body.shape, |site, volume| {
            positions.push(site);
            volumes.push(volume);
        });
        if starts[index] == positions.len() {
            errors.push(FillError::NoSite { body: index, spacing: body.spacing });
        }
    }
    starts.push(positions.len());
    // What follows takes long where particles are crowded, and says nothing where they cannot be told apart.
    let known = errors.len();
    overlap::check_distances(&positions, &starts, model, &mut errors);
    overlap::check_crowds(&positions, &starts, model, &mut errors);
    if errors.len() > known {
        return Err(errors);
    }
    let mut particles = placed(positions, volumes);
    for (index, body) in model.bodies.iter().enumerate() {
        initialise(&mut particles, starts[index]..starts[index + 1], index, body, model);
    }
    select_regions(&mut particles, model, &mut errors);
    overlap::check_bodies(&particles.position, &starts, model, &mut errors);
    check_surroundings(&particles, model, &mut errors);
    overlap::check_periodic(&particles.position, &particles.body, model, &mut errors);
    check_motions(&particles, model, &mut errors);
    if errors.is_empty() { Ok(particles) } else { Err(errors) }
}

/// Particles with room for what [`initialise`] and [`select_regions`] tell of them, and no more: each of the processes that share a run has all of
/// them at first. The volumes they stand for are in place of their mass.
fn placed(positions: Vec<[f64; 3]>, volumes: Vec<f64>) -> Particles {
    let count = positions.len();
    let zeros = || vec![0.0; count];
    Particles {
        id: vec![0; count],
        body: vec![0; count],
        material: vec![0; count],
        regions: vec![0; count],
        position: positions,
        mass: volumes,
        smoothing_length: zeros(),
        velocity: vec![[0.0; 3]; count],
        density: zeros(),
        temperature: zeros(),
        sound_speed: zeros(),
        ..Particles::default()
    }
}

/// State of the particles of a body; their mass still is the volume they stand for.
fn initialise(particles: &mut Particles, range: std::ops::Range<usize>, index: usize, body: &Body, model: &Model) {
    let material = &model.materials[body.material];
    let (first, density) = (range.start, model.density_at_start(body));
    for i in range {
        let x = particles.position[i];
        particles.id[i] = i as u32;
        particles.body[i] = index as u32;
        particles.material[i] = body.material as u32;
        particles.mass[i] *= density;
        particles.smoothing_length[i] = body.smoothing_length;
        particles.velocity[i] = body.initial_velocity(x);
        if let Solid::Cloud { particles: own, .. } = &body.shape.solid {
            let turned = body.shape.transform.turn(own[i - first].velocity);
            particles.velocity[i] = std::array::from_fn(|k| particles.velocity[i][k] + turned[k]);
        }
        particles.density[i] = density;
        particles.temperature[i] = body.temperature;
        particles.sound_speed[i] = material.equation_of_state.reference_sound_speed();
    }
}

fn inside(region: &Region, body: usize, position: [f64; 3], model: &Model) -> bool {
    region.body.is_none_or(|b| b == body)
        && region.shape.as_ref().is_none_or(|shape| {
            // Particles on the surface belong to the region, rounding or not.
            shape.contains(position, model.dimensions, 1e-6 * model.bodies[body].spacing)
        })
}

fn select_regions(particles: &mut Particles, model: &Model, errors: &mut Vec<FillError>) {
    for (index, region) in model.regions.iter().take(MAX_REGIONS).enumerate() {
        let mut count = 0;
        for i in 0..particles.len() {
            if inside(region, particles.body[i] as usize, particles.position[i], model) {
                particles.regions[i] |= 1 << index;
                count += 1;
            }
        }
        if count == 0 {
            errors.push(FillError::EmptyRegion { region: index });
        }
    }
}

/// The worst particle of each body by a signed distance, where below `limit` times the spacing.
fn worst(particles: &Particles, model: &Model, limit: f64, distance: impl Fn([f64; 3]) -> f64) -> Vec<(usize, f64)> {
    let mut least = vec![f64::INFINITY; model.bodies.len()];
    for (position, &body) in particles.position.iter().zip(&particles.body) {
        let d = distance(*position);
        least[body as usize] = least[body as usize].min(d);
    }
    least.into_iter().enumerate().filter(|&(body, d)| d < limit * model.bodies[body].spacing).collect()
}

/// A quarter of a spacing less rounding: half the distance of a particle at a cell centre from the face.
const TOO_NEAR: f64 = 0.25 * (1.0 - 1e-6);

fn check_surroundings(particles: &Particles, model: &Model, errors: &mut Vec<FillError>) {
    for (index, wall) in model.walls.iter().enumerate() {
        match wall.surface {
            WallSurface::Plane { point, normal } => {
                let distance = |x: [f64; 3]| (0..3).map(|k| (x[k] - point[k]) * normal[k]).sum::<f64>();
                for (body, depth) in worst(particles, model, 1e-6, distance) {
                    errors.push(FillError::BehindWall { wall: index, body, depth: -depth });
                }
            }
            // It pushes to both sides: nothing is behind it.
            WallSurface::Segment { .. } => {}
        }
    }
    for (index, plane) in model.symmetry.iter().enumerate() {
        let distance = |x: [f64; 3]| (x[plane.axis] - plane.position) * plane.side;
        for (body, distance) in worst(particles, model, TOO_NEAR, distance) {
            errors.push(FillError::AcrossSymmetry { plane: index, body, distance });
        }
    }
    for (axis, cell) in model.periodic.iter().enumerate() {
        let Some((low, high)) = cell else { continue };
        for (body, _) in worst(particles, model, -1e-6, |x| (x[axis] - low).min(high - x[axis])) {
            errors.push(FillError::OutsideCell { axis, body });
        }
    }
}

fn check_motions(particles: &Particles, model: &Model, errors: &mut Vec<FillError>) {
    use crate::model::MotionAxis;
    for (second, later) in model.motions.iter().enumerate() {
        for (first, earlier) in model.motions[..second].iter().enumerate() {
            let both = (1u32 << earlier.region) | (1u32 << later.region);
            let driven = |m: &MotionAxis| *m != MotionAxis::Free;
            let axis = (0..3).find(|&k| driven(&earlier.axes[k]) && driven(&later.axes[k]));
            if let Some(axis) = axis.filter(|_| particles.regions.iter().any(|bits| bits & both == both)) {
                errors.push(FillError::DrivenTwice { first, second, axis });
            }
        }
    }
}
