//! Contact of a body with itself in the total Lagrangian form, whose sums see only the neighbours of the reference
//! configuration.
//!
//! Particles of the outermost layer of a body have a normal. Two of them that are not neighbours in the reference
//! configuration are in contact, by the law of different bodies, if they are on different sides of the surface: those
//! of a fold or a slot, not those of a sheet, an edge or a foot that is pressed flat. The sides are determined in the
//! reference configuration. In the current one, pairs that slide past each other under load would appear and disappear
//! with all their energy. Images of the body in symmetry planes are treated in the same way.

use super::ghosts::WithGhosts;
use crate::particles::Particles;
use sphorge_physics::surface::{are_different_sides, sides_of_a_sheet, soon_different_sides, surface_normal};
use sphorge_physics::{Tensor, Vector};

/// The surfaces of bodies with self-contact.
#[derive(Clone, Copy)]
pub(super) struct Surfaces<'a> {
    reference_normal: WithGhosts<'a, Vector<f64>>,
    deformation: WithGhosts<'a, Tensor<f64>>,
}

impl<'a> Surfaces<'a> {
    /// Of particles, followed by the ghosts; empty without self-contact.
    pub(super) fn new(normal: &'a [Vector<f64>], deformation: &'a [Tensor<f64>], ghosts: &'a Particles) -> Self {
        Self {
            reference_normal: WithGhosts::new(normal, &ghosts.reference_normal),
            deformation: WithGhosts::new(deformation, &ghosts.deformation),
        }
    }

    /// Whether both particles, `apart = X_i - X_j` (m) in the reference configuration of a body of this spacing (m), are of surfaces that may
    /// press each other before the next search.
    pub(super) fn may_press(&self, i: usize, j: usize, apart: Vector<f64>, spacing: f64) -> bool {
        let (own, other) = (self.reference_normal.at(i), self.reference_normal.at(j));
        own != [0.0; 3]
            && other != [0.0; 3]
            && sides_of_a_sheet(apart, own, other, spacing) == 0.0
            && soon_different_sides(self.normal(i), self.normal(j)) > 0.0
    }

    fn normal(&self, i: usize) -> Vector<f64> {
        surface_normal(&self.deformation.at(i), self.reference_normal.at(i))
    }

    /// Whether surface particles of one body are of different sides now.
    pub(super) fn press(&self, i: usize, j: usize) -> bool {
        are_different_sides(self.normal(i), self.normal(j))
    }
}
