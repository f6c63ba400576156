//! Particles that a deck takes from files: whether a file is what it was when the run began.

use crate::{
    engine::persist::Fixed,
    model::{CloudShare, Model, Solid},
};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// SHA-256 sums of the particles of the bodies that are listed in files, by the names of the bodies. What in a file is no number of a particle does
/// not count.
pub(super) fn sums(model: &Model) -> BTreeMap<String, String> {
    let mut sums = BTreeMap::new();
    for body in &model.bodies {
        let Solid::Cloud { particles, .. } = &body.shape.solid else { continue };
        let mut sum = Sha256::new();
        let mut bytes = Vec::new();
        for particle in particles.iter() {
            bytes.clear();
            particle.position.write(&mut bytes);
            particle.velocity.write(&mut bytes);
            let (kind, share) = match particle.share {
                CloudShare::Spacing => (0_u64, 0.0),
                CloudShare::Volume(volume) => (1, volume),
                CloudShare::Mass(mass) => (2, mass),
            };
            kind.write(&mut bytes);
            share.write(&mut bytes);
            sum.update(&bytes);
        }
        let digits = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        sums.insert(body.name.clone(), digits);
    }
    sums
}
