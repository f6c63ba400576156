//! Who is beside whom: every pair of particles and images is tested.

use super::Oracle;
use sphorge_engine::model::{BodyContact, Model, Search};
use sphorge_physics::face_gradient::ThirdOrder;
use sphorge_physics::tensor::dot;
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
    pub(crate) fn is_of(&self, model: &Model, x: Vector<f64>) -> bool {
        let off = |s: &sphorge_engine::model::SymmetryPlane| (x[s.axis] - s.position).abs() > 1e-9 * model.spacing;
        let mirrored = |s: &&sphorge_engine::model::SymmetryPlane| {
            self.sign[s.axis] < 0.0 && self.shift[s.axis] == 2.0 * s.position
        };
        model.symmetry.iter().filter(mirrored).all(off)
    }

    /// Whether it is the other way round, like a hand in a mirror.
    pub(crate) fn is_mirrored(&self) -> bool {
        self.sign[0] * self.sign[1] * self.sign[2] < 0.0
    }

    pub(crate) fn point(&self, x: Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| self.sign[a] * x[a] + self.shift[a])
    }

    pub(crate) fn vector(&self, v: Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| self.sign[a] * v[a])
    }

    /// The image that its particle is of itself.
    pub(crate) fn back(&self) -> Self {
        Self { sign: self.sign, shift: [0, 1, 2].map(|a| -self.sign[a] * self.shift[a]) }
    }

    pub(crate) fn third_order(&self, t: &ThirdOrder) -> ThirdOrder {
        let mut seen = t.map(|t| self.tensor(&t));
        (0..3).for_each(|a| seen[a] = seen[a].map(|row| row.map(|c| self.sign[a] * c)));
        seen
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
            BodyContact::Penalty(_) | BodyContact::Facets { .. } => {
                p.smoothing_length[i].max(model.bodies[p.body[i] as usize].smoothing_length)
            }
        };
        let (mut rows, mut foreign) = (vec![Vec::new(); p.len()], vec![Vec::new(); p.len()]);
        for i in 0..p.len() {
            for j in 0..p.len() {
                let is_foreign = apart && p.body[i] != p.body[j];
                let h = pair_smoothing_length(searched_h(i), searched_h(j)) * (1.0 + skin);
                for (k, image) in self.images.iter().enumerate().filter(|(k, _)| *k > 0 || i != j) {
                    let x = minus(at[i], image.point(at[j]));
                    if dot(x, x) < (support * h).powi(2) && image.is_of(model, at[j]) {
                        let list = if is_foreign { &mut foreign } else { &mut rows };
                        list[i].push((j, k));
                    }
                }
            }
        }
        (rows, foreign)
    }

    /// Whose heat crosses the contact in the total Lagrangian form, where the sums know nothing of other bodies.
    pub(crate) fn meet(&mut self) {
        if self.total_lagrangian().is_some() {
            self.foreign = self.near(&self.p.position).1;
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
}
