//! Contact of a body with itself in the total Lagrangian form, whose sums know no neighbours but those of the reference configuration.
//!
//! Particles of the outermost layer of a body have a normal. Those of one body that are no neighbours in the reference configuration are in
//! contact, by the law of different bodies, where they are of different sides of the surface: those of a fold or a slot, not those of a sheet, an
//! edge or a foot that is pressed flat. Which side is which is asked of the reference configuration: were it asked of the present one, pairs
//! that slide past each other under load would come and go with all their energy. Images of the body in symmetry planes are met alike.

use super::CpuEngine;
use super::ghosts::WithGhosts;
use crate::lanes::PairScalar;
use crate::model::Body;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::contact::flat_body;
use sphorge_physics::surface::{are_back_to_back, are_different_sides, surface_normal};
use sphorge_physics::{Tensor, Vector, tensor::dot};

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the surfaces of the reference configuration, whose lists were just made.
    pub(super) fn find_surfaces(&mut self) {
        if !self.model.has_self_contact() {
            return;
        }
        let (list, points) = (&self.lists.list, &self.lists.points);
        let (kernel, dimension) = (self.model.numerics.kernel, super::dimension(&self.model));
        let bodies = &self.model.bodies;
        // Between what the outermost layer of a flat surface has and the one behind it, the sum over the layers that are not there; less
        // than midway, since a sheet of two layers with twice the usual smoothing has but seven tenths of that.
        let missing =
            |b: &Body, layer: f64| flat_body(kernel, dimension, b.spacing, b.smoothing_length, layer * b.spacing);
        let exposed = |b: &Body| 0.7 * 0.5 * (missing(b, 1.0).slope + missing(b, 2.0).slope);
        let exposed: Vec<f64> = bodies.iter().map(exposed).collect();
        let p = &mut self.particles;
        let volume = WithGhosts::new(&p.reference_volume, &self.ghosts.columns.reference_volume);
        let columns = (&mut p.reference_normal, &p.body).into_par_iter();
        columns.enumerate().for_each(|(i, (normal, &body))| {
            let h = bodies[body as usize].smoothing_length;
            let mut outward = [0.0; 3];
            for &j in list.row(i) {
                let x = [0, 1, 2].map(|a| points[i][a] - points[j as usize][a]);
                let weight = volume.at(j as usize) * kernel.slope(dimension, dot(x, x).sqrt(), h);
                for a in 0..3 {
                    outward[a] += weight * x[a];
                }
            }
            *normal = if dot(outward, outward).sqrt() > exposed[body as usize] { outward } else { [0.0; 3] };
        });
        if let Some(search) = self.contacts.as_mut().and_then(|contacts| contacts.search.as_mut()) {
            search.forget();
        }
    }
}

/// The surfaces of bodies that meet themselves.
#[derive(Clone, Copy)]
pub(super) struct Surfaces<'a> {
    reference_normal: WithGhosts<'a, Vector<f64>>,
    deformation: WithGhosts<'a, Tensor<f64>>,
}

/// How far behind each other two places are that are back to back, in spacings.
const BEHIND: f64 = 0.25;
/// Sides of a body that are farther apart at the start, in spacings, meet by their normals alone: before they are pressed into the reach of the
/// contact through the body it has come apart, but its ends may be bent round to meet.
const THICKEST: f64 = 32.0;

/// Cosine of the angle between normals, 25 degrees, from which on surfaces are of one side until the next search: to turn to 60 degrees moves
/// neighbours on a surface by more than the skin of the search.
const TURNED_AWAY: f64 = 0.9;

impl<'a> Surfaces<'a> {
    /// Of particles, with the ghosts behind them; empty where no body meets itself.
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
        let is_near = dot(apart, apart) < (THICKEST * spacing).powi(2);
        own != [0.0; 3]
            && other != [0.0; 3]
            && !(is_near && are_back_to_back(apart, own, other, BEHIND * spacing))
            && dot(self.normal(i), self.normal(j)) < TURNED_AWAY
    }

    fn normal(&self, i: usize) -> Vector<f64> {
        surface_normal(&self.deformation.at(i), self.reference_normal.at(i))
    }

    /// Whether surface particles of one body are of different sides now.
    pub(super) fn press(&self, i: usize, j: usize) -> bool {
        are_different_sides(self.normal(i), self.normal(j))
    }
}
