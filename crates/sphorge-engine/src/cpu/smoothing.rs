//! Smoothing lengths that follow the density.

use super::CpuEngine;
use crate::lanes::PairScalar;
use crate::model::SmoothingLength;
use crate::neighbors::{BLOCK, range_of};
use rayon::prelude::*;

impl<T: PairScalar> CpuEngine<T> {
    /// Takes the smoothing lengths to the present density; they stay through the step, so that both of its sums see the same
    /// kernels.
    pub(super) fn follow_density(&mut self) {
        let SmoothingLength::FollowDensity { factor } = self.model.numerics.smoothing_length else { return };
        let model = &*self.model;
        let power = 1.0 / model.dimensions.count() as f64;
        let p = &mut self.particles;
        let (density, body, material) = (&p.density, &p.body, &p.material);
        p.smoothing_length.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, h)| {
            let at_rest = model.materials[material[i] as usize].density;
            let ratio = (at_rest / density[i]).powf(power).clamp(1.0 / factor, factor);
            *h = model.bodies[body[i] as usize].smoothing_length * ratio;
        });
        self.lists.smoothing_lengths = range_of(&self.particles.smoothing_length);
    }

    /// The thinnest skin since the last search, as a length to be multiplied by the support, m; `constant` where smoothing lengths
    /// are. What kernels have grown by is no longer skin. The lists must be in the order of the particles.
    pub(super) fn skin_left(&self, constant: f64, fraction: f64) -> f64 {
        if self.model.numerics.smoothing_length == SmoothingLength::Constant {
            return constant;
        }
        let pairs = self.particles.smoothing_length.iter().zip(&self.lists.smoothing_length);
        pairs.map(|(now, then)| (1.0 + fraction) * then - now).fold(f64::INFINITY, f64::min)
    }
}
