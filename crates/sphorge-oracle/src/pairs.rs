//! Who is beside whom: every pair of particles and images is tested.

use super::Oracle;
use sphorge_engine::model::{BodyContact, Model, Search};
use sphorge_physics::contact::flat_body;
use sphorge_physics::surface::{FaceShift, are_back_to_back, are_different_sides, surface_normal};
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::{Tensor, Vector, kernel::pair_smoothing_length};

/// A mirror or a shift by axis, or neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Image {
    sign: Vector<f64>,
    shift: Vector<f64>,
}

impl Image {
    /// The particles themselves, then all their images: every choice of a side on every axis.
    pub(crate) fn all(model: &Model) -> Vec<Self> {
        let mut images = vec![Self { sign: [1.0; 3], shift: [0.0; 3] }];
        for axis in 0..3 {
            let mirrors = model.symmetry.iter().filter(|s| s.axis == axis).map(|s| (-1.0, 2.0 * s.position));
            let copies = model.periodic[axis].map(|(low, high)| [(1.0, high - low), (1.0, low - high)]);
            let sides: Vec<_> = mirrors.chain(copies.into_iter().flatten()).collect();
            for image in images.clone() {
                images.extend(sides.iter().map(|&(sign, shift)| {
                    let mut other = image;
                    (other.sign[axis], other.shift[axis]) = (sign, shift);
                    other
                }));
            }
        }
        images
    }

    /// Whether a particle at `x` has this image: what stands on a symmetry plane has none.
    fn is_of(&self, model: &Model, x: Vector<f64>) -> bool {
        let off = |s: &sphorge_engine::model::SymmetryPlane| (x[s.axis] - s.position).abs() > 1e-9 * model.spacing;
        let mirrored = |s: &&sphorge_engine::model::SymmetryPlane| {
            self.sign[s.axis] < 0.0 && self.shift[s.axis] == 2.0 * s.position
        };
        model.symmetry.iter().filter(mirrored).all(off)
    }

    pub(crate) fn point(&self, x: Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| self.sign[a] * x[a] + self.shift[a])
    }

    pub(crate) fn vector(&self, v: Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| self.sign[a] * v[a])
    }

    pub(crate) fn tensor(&self, t: &Tensor<f64>) -> Tensor<f64> {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| self.sign[a] * self.sign[b] * t[a][b]))
    }
}

/// By particle: neighbours, and which of their images.
pub(crate) type Rows = Vec<Vec<(usize, usize)>>;

/// A particle and a neighbour, or an image of one.
pub(crate) struct Pair {
    /// Number of the neighbour, and which of its images.
    pub(crate) j: usize,
    pub(crate) image: Image,
    /// `x_i - x_j`, m, and its length.
    pub(crate) x: Vector<f64>,
    pub(crate) r: f64,
    /// Mean smoothing length, m.
    pub(crate) h: f64,
    /// `W_ij`, and the `F` of `grad_i W_ij = F x_ij`.
    pub(crate) w: f64,
    pub(crate) f: f64,
}

pub(crate) fn minus(a: Vector<f64>, b: Vector<f64>) -> Vector<f64> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + s b`.
pub(crate) fn plus(a: Vector<f64>, s: f64, b: Vector<f64>) -> Vector<f64> {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(crate) fn apply(t: &Tensor<f64>, v: Vector<f64>) -> Vector<f64> {
    t.map(|row| dot(row, v))
}

impl Oracle {
    /// Finds the pairs of the positions just reached. As in every search, a pair that leaves the support in a step is not one of its
    /// middle; a skin keeps it.
    pub(crate) fn search(&mut self) {
        self.wrap();
        (self.rows, self.foreign) = self.near(&self.p.position);
        self.searched_at = self.p.position.clone();
    }

    /// Brings particles that left a periodic cell back in.
    pub(crate) fn wrap(&mut self) {
        let model = self.model.clone();
        for (axis, cell) in model.periodic.iter().enumerate() {
            let Some((low, high)) = *cell else { continue };
            for x in self.p.position.iter_mut() {
                x[axis] = low + (x[axis] - low).rem_euclid(high - low);
            }
        }
    }

    /// The neighbours of every particle at these places: those of the kernel sums, and those of other bodies it is in contact with.
    pub(crate) fn near(&self, at: &[Vector<f64>]) -> (Rows, Rows) {
        let model = &self.model;
        let skin = if let Search::Skin { fraction } = model.search { fraction } else { 0.0 };
        let support = model.numerics.kernel.support();
        let apart = model.contact != BodyContact::Sph;
        let p = &self.p;
        // The contact has the kernels of the start.
        let searched_h = |i: usize| match model.contact {
            BodyContact::Sph => p.smoothing_length[i],
            BodyContact::Penalty(_) => p.smoothing_length[i].max(model.bodies[p.body[i] as usize].smoothing_length),
        };
        let (mut rows, mut foreign) = (vec![Vec::new(); p.len()], vec![Vec::new(); p.len()]);
        for i in 0..p.len() {
            for j in 0..p.len() {
                let is_foreign = apart && p.body[i] != p.body[j];
                let h = pair_smoothing_length(searched_h(i), searched_h(j)) * (1.0 + skin);
                for (k, image) in self.images.iter().enumerate().filter(|(k, _)| *k > 0 || i != j) {
                    let x = minus(at[i], image.point(at[j]));
                    // Heat crosses contacts between positions.
                    let now = minus(p.position[i], image.point(p.position[j]));
                    let squared = if is_foreign { dot(x, x).min(dot(now, now)) } else { dot(x, x) };
                    if squared < (support * h).powi(2) && image.is_of(model, at[j]) {
                        let list = if is_foreign { &mut foreign } else { &mut rows };
                        list[i].push((j, k));
                    }
                }
            }
        }
        (rows, foreign)
    }

    /// Finds the surfaces of the configuration the sums are taken in, midway between what the outermost layer of a flat body has of the kernel
    /// gradient and what the one behind it has.
    pub(crate) fn find_surfaces(&mut self) {
        let (kernel, dimension) = (self.model.numerics.kernel, self.dimension);
        self.normal = self.each(|i| {
            let body = &self.model.bodies[self.p.body[i] as usize];
            let mut outward = [0.0; 3];
            for n in self.pairs(i, &self.searched_at) {
                outward = plus(outward, -n.f * self.initial_volume[n.j], n.x);
            }
            let missing = |layer: f64| {
                flat_body(kernel, dimension, body.spacing, body.smoothing_length, layer * body.spacing).slope
            };
            let is_outermost = dot(outward, outward).sqrt() > 0.35 * (missing(1.0) + missing(2.0));
            is_outermost.then_some(outward)
        });
    }

    /// Depths below faces of the initial configuration: half a spacing in the outermost layer, behind it by the neighbours in that layer.
    pub(crate) fn find_depths(&mut self) {
        self.arm = self.each(|i| {
            let half = 0.5 * self.model.bodies[self.p.body[i] as usize].spacing;
            let unit = |n: Vector<f64>| n.map(|c| c / dot(n, n).sqrt());
            if let Some(own) = self.normal[i] {
                return unit(own).map(|c| half * c);
            }
            let (mut sum, mut mean, mut below) = (0.0, [0.0; 3], 0.0);
            for n in self.pairs(i, &self.searched_at) {
                if let Some(normal) = self.normal[n.j].filter(|_| self.p.body[n.j] == self.p.body[i]) {
                    let normal = unit(n.image.vector(normal));
                    sum += n.w;
                    mean = plus(mean, n.w, normal);
                    below -= n.w * dot(n.x, normal);
                }
            }
            let length = dot(mean, mean).sqrt();
            if sum > 0.0 && length > 0.5 * sum {
                unit(mean).map(|c| (half + (below / sum).max(0.0)) * c)
            } else {
                [0.0; 3]
            }
        });
    }

    /// Where particles stand for the contact.
    pub(crate) fn shift_to_faces(&mut self) {
        (self.stands, self.stands_moving) = (self.p.position.clone(), self.evaluated.clone());
        for i in 0..self.p.len() {
            let whole = multiply(&self.deformation[i], &self.earlier_deformation[i]);
            if let Some(face) = FaceShift::new(&whole, self.arm[i]) {
                self.stands[i] = plus(self.stands[i], 1.0, face.shift());
                self.stands_moving[i] = plus(self.stands_moving[i], 1.0, face.rate(&self.p.velocity_gradient[i]));
            }
        }
        if self.total_lagrangian().is_some() {
            self.foreign = self.near(&self.stands).1;
        }
    }

    /// Adds the contacts of bodies with themselves as they are now: particles that are no neighbours in the sums and face each other.
    pub(crate) fn meet_themselves(&mut self) {
        if !self.model.has_self_contact() {
            return;
        }
        for i in 0..self.p.len() {
            let body = self.p.body[i] as usize;
            let reach = self.model.numerics.kernel.support() * self.model.bodies[body].smoothing_length;
            let spacing = self.model.bodies[body].spacing;
            let Some(own_then) = self.normal[i].filter(|_| !self.has_come_apart[body]) else { continue };
            let own = surface_normal(&self.deformation[i], own_then);
            for j in (0..self.p.len()).filter(|&j| self.p.body[j] as usize == body) {
                let Some(other_then) = self.normal[j] else { continue };
                let other = surface_normal(&self.deformation[j], other_then);
                for (k, image) in self.images.iter().enumerate() {
                    let [now, then] = [&self.stands, &self.searched_at].map(|x| minus(x[i], image.point(x[j])));
                    let is_near = dot(now, now) < reach * reach && image.is_of(&self.model, self.p.position[j]);
                    let is_sheet = dot(then, then) < (32.0 * spacing).powi(2)
                        && are_back_to_back(then, own_then, image.vector(other_then), 0.25 * spacing);
                    let are_different_sides = are_different_sides(own, image.vector(other));
                    if is_near && dot(then, then) >= reach * reach && !is_sheet && are_different_sides {
                        self.foreign[i].push((j, k));
                    }
                }
            }
        }
    }

    /// Places the sums are taken at, of particles that are at `now`.
    pub(crate) fn places(&self, now: Vec<Vector<f64>>) -> Vec<Vector<f64>> {
        if self.model.search == Search::Initial { self.searched_at.clone() } else { now }
    }

    fn pair(&self, i: usize, (j, k): (usize, usize), at: &[Vector<f64>]) -> Pair {
        let image = self.images[k];
        let x = minus(at[i], image.point(at[j]));
        let h = pair_smoothing_length(self.p.smoothing_length[i], self.p.smoothing_length[j]);
        let (r, kernel) = (dot(x, x).sqrt(), self.model.numerics.kernel);
        let (w, f) = (kernel.value(self.dimension, r, h), -kernel.slope(self.dimension, r, h));
        Pair { j, image, x, r, h, w, f }
    }

    /// The pairs of a particle in the kernel sums, of particles at these places.
    pub(crate) fn pairs(&self, i: usize, at: &[Vector<f64>]) -> impl Iterator<Item = Pair> {
        self.rows[i].iter().map(move |&n| self.pair(i, n, at))
    }

    /// Its pairs with particles of other bodies that it is in contact with, as they are now.
    pub(crate) fn contacts(&self, i: usize) -> impl Iterator<Item = Pair> {
        self.foreign[i].iter().map(move |&n| self.pair(i, n, &self.p.position))
    }

    /// The same pairs where they stand for the contact.
    pub(crate) fn meetings(&self, i: usize) -> impl Iterator<Item = Pair> {
        self.foreign[i].iter().map(move |&n| self.pair(i, n, &self.stands))
    }
}
