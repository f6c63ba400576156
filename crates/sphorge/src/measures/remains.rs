//! What is left of a plate: the particles that still hang together with a large fragment of it.

use crate::{fragments::Cloud, model::Model, particles::Particles};

/// A fragment of less than this share of the body's mass is debris.
const LARGE: f64 = 0.1;

/// For every particle, whether it belongs to what is left of `body`: to a fragment, joined over distances up to `link` (m), of at
/// least a tenth of the body's mass, some of which is `in_place`. A plug that flies off whole is not.
pub(super) fn remains(
    model: &Model,
    particles: &Particles,
    body: usize,
    link: f64,
    in_place: impl Fn(&[f64; 3]) -> bool,
) -> Vec<bool> {
    let cloud = Cloud {
        dimensions: model.dimensions.count(),
        position: &particles.position,
        deformation: None,
        link,
        periodic: model.periodic,
    };
    let joined = cloud.joined(|i| particles.body[i] as usize == body);
    let mut mass = vec![0.0; particles.len()];
    let mut stands = vec![false; particles.len()];
    let mut whole = 0.0;
    for of in &joined {
        let (i, root) = (of.particle, of.root);
        mass[root] += particles.mass[i];
        stands[root] |= in_place(&particles.position[i]);
        whole += particles.mass[i];
    }
    let mut left = vec![false; particles.len()];
    for of in joined {
        left[of.particle] = stands[of.root] && mass[of.root] >= LARGE * whole;
    }
    left
}
