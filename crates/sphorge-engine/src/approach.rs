//! How long a step may be where bodies approach each other: a contact acts from the step on in which surfaces have met, and what passes through a
//! particle in a step is not met at all.

use crate::model::Model;
use crate::particles::Particles;

/// How far surfaces approach each other in a step, in spacings. Below some 3 km/s sound limits the steps more.
const LARGEST: f64 = 0.2;

/// Longest step, s, for bodies that approach each other as fast as any two particles do at the start, infinite where no bodies meet. It is
/// the same in every uniformly moving frame. What an impact throws out faster, a jet, is not looked for. A step that a deck fixes is not limited.
pub(crate) fn limit(model: &Model, particles: &Particles) -> f64 {
    if model.contact_pairs().is_empty() {
        return f64::INFINITY;
    }
    let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for velocity in &particles.velocity {
        for a in 0..3 {
            (least[a], most[a]) = (least[a].min(velocity[a]), most[a].max(velocity[a]));
        }
    }
    let squared: f64 = (0..3).map(|a| (most[a] - least[a]).powi(2)).sum();
    let spacing = model.bodies.iter().map(|body| body.spacing).fold(f64::INFINITY, f64::min);
    LARGEST * spacing / squared.sqrt()
}
