//! Smoothing lengths that follow the density.

use super::CpuEngine;
use super::contact::BodyContacts;
use crate::RunFailure;
use crate::lanes::PairScalar;
use crate::model::{Model, SmoothingLength};
use crate::neighbors::{BLOCK, range_of};
use rayon::prelude::*;
use sphorge_physics::kernel::following_smoothing_length;

impl<T: PairScalar> CpuEngine<T> {
    /// Updates the smoothing lengths to the current density. They are constant during the step, so that both of its
    /// sums see the same kernels.
    pub(super) fn follow_density(&mut self) -> Result<(), RunFailure> {
        let SmoothingLength::FollowDensity { factor } = self.model.numerics.smoothing_length else { return Ok(()) };
        let model = &*self.model;
        let p = &mut self.particles;
        let (density, body, material) = (&p.density, &p.body, &p.material);
        p.smoothing_length.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, h)| {
            let (at_start, at_rest) =
                (model.bodies[body[i] as usize].smoothing_length, model.materials[material[i] as usize].density);
            *h = following_smoothing_length(model.dimensions.into(), at_start, at_rest, density[i], factor);
        });
        let own = range_of(&self.particles.smoothing_length);
        let (smallest, largest) = self.domain.as_ref().map_or(Ok(own), |domain| domain.range(own))?;
        let least = least_searched(&self.model, self.contacts.as_ref()).unwrap_or_default();
        self.lists.smoothing_lengths = (smallest, least.iter().fold(largest, |m, h| m.max(*h)));
        Ok(())
    }

    /// The thinnest skin since the last search, as a length to be multiplied by the support, m; `constant` for constant
    /// smoothing lengths. The growth of kernels reduces the skin. The lists must be in the order of the particles.
    pub(super) fn skin_left(&self, constant: f64, fraction: f64) -> Result<f64, RunFailure> {
        if self.model.numerics.smoothing_length == SmoothingLength::Constant {
            return Ok(constant);
        }
        let (p, least) = (&self.particles, least_searched(&self.model, self.contacts.as_ref()));
        let searched = |(h, body): (&f64, &u32)| least.map_or(*h, |least| h.max(least[*body as usize]));
        let now = p.smoothing_length.iter().zip(&p.body).map(searched);
        let pairs = now.zip(&self.lists.smoothing_length);
        let own = pairs.map(|(now, then)| (1.0 + fraction) * then - now).fold(f64::INFINITY, f64::min);
        self.domain.as_ref().map_or(Ok(own), |domain| Ok(domain.range((own, 0.0))?.0))
    }
}

/// Lower bounds by body (m) of the smoothing lengths in the search: those of particles may shrink, while the contact
/// between bodies keeps the initial ones. `None` if no particle has a smaller one.
pub(super) fn least_searched<'a>(model: &Model, contacts: Option<&'a BodyContacts>) -> Option<&'a [f64]> {
    match model.numerics.smoothing_length {
        SmoothingLength::Constant => None,
        SmoothingLength::FollowDensity { .. } => contacts.map(BodyContacts::smoothing_lengths),
    }
}
