//! Faces of bodies of the total Lagrangian form, at which they meet each other and themselves.
//!
//! Particles near a face know their depth below it and its normal in the initial configuration. Their whole deformation, renewed references
//! or not, says where the face is now, where they stand for the contact and how others see them there ([`Face`]).

use super::CpuEngine;
use super::ghosts::WithGhosts;
use crate::halo::FieldSet;
use crate::lanes::PairScalar;
use crate::model::Body;
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::contact::flat_body;
use sphorge_physics::corner::{Approach, face_towards, faces_of_corner};
use sphorge_physics::face::{Face, FaceRates, Leverage, PressedFace};
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::{Dimension, Tensor, Vector};

/// Length of the mean of unit normals of the faces near a particle below which it is near no one face, as in the middle of a sheet.
const ONE_FACE: f64 = 0.5;

/// A face as it is, and how it moves.
pub(super) type MovingFace = (PressedFace<f64>, FaceRates<f64>);

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the surfaces of the reference configuration, whose lists were just made, and the faces of the initial one.
    pub(super) fn find_surfaces(&mut self) {
        if !self.model.has_faces() {
            return;
        }
        self.find_normals();
        if !self.has_come_apart.contains(&true) {
            self.ghosts.exchange(FieldSet::Search, &self.particles);
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
    }

    /// Depths below faces, of the outermost layer half a spacing, of those behind it by their neighbours in that layer.
    fn find_depths(&mut self) {
        let (list, points) = (&self.lists.list, &self.lists.points);
        let (kernel, dimension) = (self.model.numerics.kernel, super::dimension(&self.model));
        let bodies = &self.model.bodies;
        let Particles { face_arm, corner_faces, reference_normal, body, .. } = &mut self.particles;
        let normal = WithGhosts::new(reference_normal, &self.ghosts.columns.reference_normal);
        let body = WithGhosts::new(body, &self.ghosts.columns.body);
        let columns = (face_arm, corner_faces).into_par_iter().with_min_len(BLOCK).enumerate();
        columns.for_each(|(i, (arm, faces))| {
            let of = &bodies[body.at(i) as usize];
            let half = 0.5 * of.spacing;
            let own = normal.at(i);
            if own != [0.0; 3] {
                let unit = |n: Vector<f64>| n.map(|c| c / dot(n, n).sqrt());
                let of_surface = |&&j: &&u32| normal.at(j as usize) != [0.0; 3] && body.at(j as usize) == body.at(i);
                let beside = list.row(i).iter().filter(of_surface).map(|&j| {
                    let j = j as usize;
                    ([0, 1, 2].map(|a| points[j][a] - points[i][a]), unit(normal.at(j)))
                });
                *arm = unit(own).map(|n| half * n);
                *faces = faces_of_corner(unit(own), beside, of.spacing);
                return;
            }
            let (mut sum, mut mean, mut below) = (0.0, [0.0; 3], 0.0);
            for &j in list.row(i) {
                let j = j as usize;
                let outward = normal.at(j);
                if outward == [0.0; 3] || body.at(j) != body.at(i) {
                    continue;
                }
                let x = [0, 1, 2].map(|a| points[j][a] - points[i][a]);
                let weight = kernel.value(dimension, dot(x, x).sqrt(), of.smoothing_length);
                let per_length = weight / dot(outward, outward).sqrt();
                sum += weight;
                below += per_length * dot(x, outward);
                (0..3).for_each(|a| mean[a] += per_length * outward[a]);
            }
            let length = dot(mean, mean).sqrt();
            *arm = if sum > 0.0 && length > ONE_FACE * sum {
                let depth = half + (below / sum).max(0.0);
                mean.map(|n| depth * n / length)
            } else {
                [0.0; 3]
            };
        });
    }

    /// Gives particles of corners the face that looks at what comes near, before it is in reach: what is met is not changed.
    pub(super) fn choose_faces(&mut self) {
        let is_start = self.step.count == 0;
        let has_come_apart = &self.has_come_apart;
        let Some(contacts) = self.contacts.as_ref().filter(|_| self.model.has_faces()) else { return };
        let Particles {
            face_arm,
            corner_faces,
            reference_normal,
            deformation,
            earlier_deformation,
            position,
            body,
            ..
        } = &mut self.particles;
        let ghosts = &contacts.ghosts(&self.ghosts).columns;
        let (position, body) = (WithGhosts::new(position, &ghosts.position), WithGhosts::new(body, &ghosts.body));
        let whole = WholeDeformation { since: deformation, earlier: earlier_deformation };
        let (corners, normals) = (&*corner_faces, &*reference_normal);
        let blocks = contacts.foreign().blocks().par_iter().zip(face_arm.par_chunks_mut(BLOCK));
        blocks.for_each(|(block, arms)| {
            let is_corner = |i: usize| corners[i][0] != [0.0; 3] && !has_come_apart[body.at(i) as usize];
            for (i, row) in block.rows().filter(|&(i, _)| is_corner(i)) {
                let mut near = Approach::default();
                for j in row.iter().map(|&j| j as usize).filter(|&j| body.at(j) != body.at(i)) {
                    let (x, y) = (position.at(i), position.at(j));
                    let x = [0, 1, 2].map(|a| x[a] - y[a]);
                    near.add(x, contacts.reach(body.at(i), body.at(j)));
                }
                if near.is_free(is_start) {
                    let arm = &mut arms[i % BLOCK];
                    let (depth, own) = (dot(*arm, *arm).sqrt(), normals[i]);
                    let own = own.map(|n| n / dot(own, own).sqrt());
                    *arm = face_towards(&whole.at(i), own, &corners[i], near.direction).map(|n| depth * n);
                }
            }
        });
    }

    /// How forces on faces reach neighbours, in the reference configuration, whose gradient corrections were just made.
    pub(super) fn find_leverage(&mut self) {
        if !self.model.has_faces() {
            return;
        }
        let (list, points) = (&self.lists.list, &self.lists.points);
        let (kernel, dimension) = (self.model.numerics.kernel, super::dimension(&self.model));
        let bodies = &self.model.bodies;
        let Particles { leverage_sum, leverage_squares, correction, mass, reference_volume, body, face_arm, .. } =
            &mut self.particles;
        let masses = WithGhosts::new(mass, &self.ghosts.columns.mass);
        let volume = WithGhosts::new(reference_volume, &self.ghosts.columns.reference_volume);
        let columns = (&*correction, &*body, &*face_arm).into_par_iter();
        let sums = (leverage_sum, leverage_squares).into_par_iter();
        sums.zip(columns).with_min_len(BLOCK).enumerate().for_each(|(i, ((sum, squares), (correction, &of, &arm)))| {
            if arm == [0.0; 3] {
                return;
            }
            let h = bodies[of as usize].smoothing_length;
            let neighbours = list.row(i).iter().map(|&j| {
                let j = j as usize;
                let x = [0, 1, 2].map(|a| points[i][a] - points[j][a]);
                let slope = kernel.slope(dimension, dot(x, x).sqrt(), h);
                (x.map(|c| -volume.at(j) * slope * c), masses.at(i) / masses.at(j))
            });
            let leverage = Leverage::new(correction, neighbours);
            (*sum, *squares) = (leverage.sum, leverage.squares);
        });
    }

    /// Where particles near faces stand for the contact, and how others see them.
    pub(super) fn shift_to_faces(&mut self) {
        self.choose_faces();
        let dimension = super::dimension(&self.model);
        let p = &mut self.particles;
        let Particles {
            face_arm,
            contact_shift,
            contact_shift_rate,
            contact_normal,
            contact_widening,
            velocity_gradient,
            ..
        } = p;
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        let shifts = (contact_shift, contact_shift_rate).into_par_iter();
        let metrics = (contact_normal, contact_widening).into_par_iter();
        let columns = (shifts, metrics, &*face_arm, &*velocity_gradient).into_par_iter();
        columns.with_min_len(BLOCK).enumerate().for_each(|(i, ((shift, rate), (normal, widening), &arm, gradient))| {
            let Some(face) = Face::new(dimension, &whole.at(i), arm) else { return };
            (*shift, *rate) = (face.shift(), face.rates(gradient).shift);
            let seen = face.metric();
            (*normal, *widening) = (seen.normal, seen.widening);
        });
    }

    /// The face near particle `i`, and how what presses it reaches others; `None` where there is none or where the formulation knows none.
    pub(super) fn pressed_face(dimension: Dimension, p: &Particles, i: usize) -> Option<MovingFace> {
        let arm = *p.face_arm.get(i)?;
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        let face = Face::new(dimension, &whole.at(i), arm)?;
        let leverage = Leverage { sum: p.leverage_sum[i], squares: p.leverage_squares[i] };
        Some((PressedFace::new(face, &p.deformation[i], leverage), face.rates(&p.velocity_gradient[i])))
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
        self.earlier.get(i).map_or(f, |earlier| multiply(&f, earlier))
    }
}
