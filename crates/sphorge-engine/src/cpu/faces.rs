//! Faces of bodies in the total Lagrangian form, at which contacts act.
//!
//! Particles near a face store their depth below it and its normal in the initial configuration. The whole deformation
//! since the start, across renewals of the reference, gives the current position of the face and the contact position
//! of the particle ([`FaceShift`]).

use super::CpuEngine;
use super::ghosts::WithGhosts;
use crate::halo::FieldSet;
use crate::lanes::PairScalar;
use crate::model::Body;
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::Tensor;
use sphorge_physics::surface::{FaceShift, NearFace, add_outward, exposed, outermost_arm};
use sphorge_physics::tensor::{dot, multiply};

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the surfaces of the reference configuration, whose lists were just made, and the faces of the initial one.
    pub(super) fn find_surfaces(&mut self) {
        if !self.model.has_faces() {
            return;
        }
        self.find_normals();
        if !self.has_come_apart.contains(&true) {
            self.ghosts.exchange(&[FieldSet::Search], &self.particles);
            self.find_depths();
        }
        if let Some(search) = self.contacts.as_mut().and_then(|contacts| contacts.search.as_mut()) {
            search.forget();
        }
    }

    fn find_normals(&mut self) {
        let (list, points) = (&self.lists.list, &self.lists.points);
        let (kernel, dimension) = (self.model.numerics.kernel, super::dimension(&self.model));
        let bodies = &self.model.bodies;
        let exposed = |b: &Body| exposed(kernel, dimension, b.spacing, b.smoothing_length);
        let exposed: Vec<f64> = bodies.iter().map(exposed).collect();
        let p = &mut self.particles;
        let volume = WithGhosts::new(&p.reference_volume, &self.ghosts.columns.reference_volume);
        let columns = (&mut p.reference_normal, &p.body).into_par_iter();
        columns.enumerate().for_each(|(i, (normal, &body))| {
            let h = bodies[body as usize].smoothing_length;
            let mut outward = [0.0; 3];
            for &j in list.row(i) {
                let x = [0, 1, 2].map(|a| points[i][a] - points[j as usize][a]);
                add_outward(&mut outward, kernel, dimension, x, volume.at(j as usize), h);
            }
            *normal = if dot(outward, outward).sqrt() > exposed[body as usize] { outward } else { [0.0; 3] };
        });
    }

    /// Depths below faces: half a spacing for the outermost layer; for the particles behind it from their neighbours in
    /// that layer.
    fn find_depths(&mut self) {
        let (list, points) = (&self.lists.list, &self.lists.points);
        let (kernel, dimension) = (self.model.numerics.kernel, super::dimension(&self.model));
        let bodies = &self.model.bodies;
        let Particles { face_arm, reference_normal, body, .. } = &mut self.particles;
        let normal = WithGhosts::new(reference_normal, &self.ghosts.columns.reference_normal);
        let body = WithGhosts::new(body, &self.ghosts.columns.body);
        face_arm.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, arm)| {
            let of = &bodies[body.at(i) as usize];
            let half = 0.5 * of.spacing;
            let own = normal.at(i);
            if own != [0.0; 3] {
                *arm = outermost_arm(own, half);
                return;
            }
            let mut face = NearFace::default();
            for &j in list.row(i) {
                let j = j as usize;
                let outward = normal.at(j);
                if outward == [0.0; 3] || body.at(j) != body.at(i) {
                    continue;
                }
                let x = [0, 1, 2].map(|a| points[j][a] - points[i][a]);
                face.add(x, outward, kernel.value(dimension, dot(x, x).sqrt(), of.smoothing_length));
            }
            *arm = face.arm(half);
        });
    }

    /// Contact positions of particles near faces.
    pub(super) fn shift_to_faces(&mut self) {
        let p = &mut self.particles;
        let Particles { face_arm, contact_shift, contact_shift_rate, velocity_gradient, .. } = p;
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        let shifts = (contact_shift, contact_shift_rate).into_par_iter();
        let columns = (&*face_arm, &*velocity_gradient).into_par_iter();
        shifts.zip(columns).with_min_len(BLOCK).enumerate().for_each(|(i, ((shift, rate), (&arm, gradient)))| {
            let Some(face) = FaceShift::new(&whole.at(i), arm) else { return };
            (*shift, *rate) = (face.shift(), face.rate(gradient));
        });
    }
}

/// Deformation gradient since the start.
#[derive(Clone, Copy)]
pub(super) struct WholeDeformation<'a> {
    /// Since the reference configuration.
    pub(super) since: &'a [Tensor<f64>],
    /// That of the reference configuration; empty where that is the initial one.
    pub(super) earlier: &'a [Tensor<f64>],
}

impl WholeDeformation<'_> {
    pub(super) fn at(&self, i: usize) -> Tensor<f64> {
        let f = self.since[i];
        self.earlier.get(i).map_or(f, |earlier| Self::product(&f, earlier))
    }

    /// A deformation after an earlier one.
    pub(super) fn product(since: &Tensor<f64>, earlier: &Tensor<f64>) -> Tensor<f64> {
        multiply(since, earlier)
    }
}
