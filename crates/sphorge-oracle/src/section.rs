//! Force through a section: that of the pairs whose particles stand on either side.

use super::Oracle;
use super::pairs::{minus, plus};
use sphorge_engine::model::Section;
use sphorge_physics::{Vector, tensor::dot};

impl Oracle {
    /// Force of what is ahead of a plane on what is behind it, N.
    pub(crate) fn section_force(&self, section: &Section) -> Vector<f64> {
        let ahead = |x: Vector<f64>| dot(minus(x, section.point), section.normal);
        let counts = |i: usize| section.body.is_none_or(|body| body == self.p.body[i] as usize);
        let mut sum = [0.0; 3];
        for &(i, j, image, force) in self.exerted.iter().filter(|(i, j, ..)| counts(*i) && counts(*j)) {
            let (x_i, x_j) = (self.exerted_at[i], self.exerted_at[j]);
            let (own, other) = (ahead(x_i), ahead(image.point(x_j)));
            if (own >= 0.0) != (other >= 0.0) {
                // Of a pair and its image along the plane, which both are met, each is half.
                let share = if (other - ahead(x_j)).abs() > 1e-3 * self.model.spacing { 1.0 } else { 0.5 };
                sum = plus(sum, if own >= 0.0 { -share } else { share }, force);
            }
        }
        sum
    }
}
