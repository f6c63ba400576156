//! Contact of facets: the exposed faces of the cells of particles, carried by `F`.
//!
//! In the reference configuration each face of the cell of a particle (a cube of a lattice, a sector of a ring) that no other particle
//! of its body covers is a [`ReferenceFacet`] with up to four corners, owned by that particle. [`Facet::now`] carries it to the
//! present. Two facets that look at each other are projected along `m = (n_b - n_a)/|n_b - n_a|`, which points from `b` to `a`. Over
//! their common polygon `Omega` the gap between them is
//!
//! ```text
//! g(s) = h_a(s) - h_b(s) + r_a.kap_a.r_a / 2 + r_b.kap_b.r_b / 2
//! ```
//!
//! with the heights `h` of their planes along `m`, and the curvatures `kap` of the surfaces that the facets touch at their middles, known
//! from the shape of the body and carried as material: `kap = F^-T kap_0 F^-1`. The pair stores
//!
//! ```text
//! U = chi(-n_a.n_b) int_Omega psi(-g) dA,        psi(d) = k d^2 / (2 (1 - d/D))  for d > 0,       D = D_a + D_b
//! ```
//!
//! where `D` is the distance of the owners at touch, so that owners never pass each other, and `chi` falls from one to zero between
//! facets that face each other at `n_a.n_b = -0.7` and at `-0.3`. [`press`] gives `U` by a quadrature that is exact for plane facets
//! at small closures, and the exact derivative of that quadrature by the positions and deformation gradients of the owners: pressure on both
//! planes, tension of the edges of `Omega` that belong to each facet, couples on normals. Forces and moments of a pair balance to
//! rounding whatever the shape, and energy is conserved whatever the quadrature.
//!
//! What each owner gets: a force `f` on its position and a moment `M`, whose power is `f.v + M:L`. In the form of a total Lagrangian method
//! `M` is the first Piola-Kirchhoff stress `P V = M F^-T`.
//!
//! In the plane a facet is a strip of unit thickness along `z`, [`ReferenceFacet::strip`]; forces are per unit of thickness and all
//! are in the plane (the strips' own ends along `z` press nothing but a moment `M_zz`, which does no work in plane strain).
//!
//! Every function is for one pair and written without branches on values that a card could not take: the common polygon has a fixed number
//! of slots, of which several may hold the same vertex.

mod clip;
mod edges;
mod friction;
mod lap;
mod limit;
mod press;
mod segment;
mod spread;
mod torn;

pub use edges::{EdgeForces, OnCell, OnSides, SharedEdge, half_of_misfit, moment_of_edge};
pub use friction::{FacetSlip, FrictionShare, SlipDrive, damp_sliding, friction_force, slip_after};
pub use limit::{FacetStiffness, MARGIN, MOBILITY};
pub use press::{FacetImpact, FacetMaterial, FacetPairLaw, FacetPress, FacetStrength, Partner, press};
pub use segment::RigidSegment;
pub use torn::moment_of_torn;

use crate::tensor::{apply, determinant, dot, inverse, multiply, transpose};
use crate::{Numbers, Real, SymmetricTensor, Tensor, Vector};

/// `a x b`.
#[inline(always)]
pub(crate) fn cross<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// An exposed face of the cell of a particle in the reference configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceFacet<T> {
    /// From the owner to the corners, m, anticlockwise as seen from outside. All are in the plane through `middle` with that `normal`. A triangle
    /// has its last corner twice; the first two corners differ.
    pub corners: [Vector<T>; 4],
    /// From the owner to where the plane touches the surface of the shape, m.
    pub middle: Vector<T>,
    /// Outward unit normal.
    pub normal: Vector<T>,
    /// Curvature of the surface of the shape, 1/m: `1/R` times the tangent's dyad along a ring, positive where the surface is convex, negative in a hole;
    /// zero for a flat one. Tangential.
    pub curvature: SymmetricTensor<T>,
    /// Distance of the owner from the plane, m.
    pub depth: T,
    /// One for each edge, from a corner to the next, at which the body ends in another face of the same cell that looks elsewhere; zero for one at which
    /// its surface goes on.
    pub free: [T; 4],
    /// A row for each axis of the cell along which there is another cell beside this one: along that axis, over the square of the width of the cell, 1/m. Zero for
    /// the axis across the facet.
    pub across: Tensor<T>,
}

/// What belongs to the edges of four corners, for the same corners the other way round, `[b, a, d, c]` for `[a, b, c, d]`.
#[inline(always)]
pub fn edges_reversed<V>([ab, bc, cd, da]: [V; 4]) -> [V; 4] {
    [ab, da, cd, bc]
}

impl<T: Real> ReferenceFacet<T> {
    /// A flat facet between corners (m, from the owner, anticlockwise as seen from outside).
    pub fn flat(corners: [Vector<T>; 4], normal: Vector<T>) -> Self {
        let quarter = T::of(0.25);
        let middle = [0, 1, 2].map(|a| quarter * (corners[0][a] + corners[1][a] + (corners[2][a] + corners[3][a])));
        let (free, across) = ([T::zero(); 4], [[T::zero(); 3]; 3]);
        Self { corners, middle, normal, curvature: SymmetricTensor::zero(), depth: dot(middle, normal), free, across }
    }

    /// A flat facet in the plane, of unit thickness, between two ends (m, from the owner); its outward normal is to the right of the way from
    /// `start` to `end`, so that a body's outline is followed anticlockwise.
    pub fn strip(start: Vector<T>, end: Vector<T>) -> Self {
        let half = T::of(0.5);
        let along = [end[0] - start[0], end[1] - start[1]];
        let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
        let normal = [along[1] / length, -along[0] / length, T::zero()];
        // Seen from outside, `start` is to the left of `end` and z points to where it is anticlockwise.
        let at = |p: Vector<T>, z: T| [p[0], p[1], z];
        Self::flat([at(start, -half), at(end, -half), at(end, half), at(start, half)], normal)
    }

    /// The same facet moved towards its owner by a length, m: the surface of a body that overlaps another one by that much when contact between them
    /// begins.
    pub fn inset(self, by: T) -> Self {
        let inward = |arm: Vector<T>| [0, 1, 2].map(|a: usize| arm[a] - by * self.normal[a]);
        Self { corners: self.corners.map(inward), middle: inward(self.middle), depth: self.depth - by, ..self }
    }

    /// The same facet of a surface with a curvature (1/m) along tangential directions.
    pub fn curved(self, curvature: SymmetricTensor<T>) -> Self {
        Self { curvature, ..self }
    }

    /// Area, m^2; m in the plane.
    pub fn area(&self) -> T {
        let between = |i: usize, j: usize| [0, 1, 2].map(|a| self.corners[j][a] - self.corners[i][a]);
        T::of(0.5) * dot(cross(between(0, 2), between(1, 3)), self.normal)
    }
}

/// A facet now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet<T> {
    /// Position of the owner, m. Only differences of owners are used; single precision wants both near the origin.
    pub owner: Vector<T>,
    /// From the owner to the corners, m.
    pub corners: [Vector<T>; 4],
    /// From the owner to the middle, m.
    pub middle: Vector<T>,
    /// Outward unit normal, `F^-T N` over its length.
    pub normal: Vector<T>,
    /// `F^-T kap_0 F^-1`, 1/m.
    pub curvature: SymmetricTensor<T>,
    /// Distance of the owner from the plane, m: the depth at rest over `|F^-T N|`.
    pub depth: T,
    /// Area, m^2; m in the plane.
    pub area: T,
    /// [`ReferenceFacet::free`].
    pub free: [T; 4],
    /// How far its edges are from where the owner carries them, m, were they at the middle ([`SharedEdge`]); zero unless [`Self::shifted`].
    pub shift: Vector<T>,
    /// Change of that with the place from the middle where the owner carries it.
    pub shear: Tensor<T>,
    /// `M` of the stretches of its edges (33l).
    pub misfit: T,
    /// Distance of the owner from the plane at rest, m.
    pub rest_depth: T,
}

impl<T: Real> Facet<T> {
    /// The facet of an owner at that position (m) with this deformation gradient.
    #[inline]
    pub fn now(owner: Vector<T>, f: &Tensor<T>, reference: &ReferenceFacet<T>) -> Self {
        let back = inverse(f);
        let carried = apply(&transpose(&back), reference.normal);
        let length = dot(carried, carried).sqrt();
        Self {
            owner,
            corners: reference.corners.map(|arm| apply(f, arm)),
            middle: apply(f, reference.middle),
            normal: carried.map(|n| n / length),
            curvature: reference.curvature.congruence(&transpose(&back)),
            depth: reference.depth / length,
            area: reference.area() * determinant(f) * length,
            free: reference.free,
            shift: [T::zero(); 3],
            shear: [[T::zero(); 3]; 3],
            misfit: T::zero(),
            rest_depth: reference.depth,
        }
    }

    /// What this facet meets of a plane without end through `point` (m) with that unit normal: the place at its foot. The plane is the second of the
    /// pair, with [`Partner::Plane`].
    #[inline]
    pub fn foot_on_plane(&self, point: Vector<T>, normal: Vector<T>) -> Self {
        let distance = dot([0, 1, 2].map(|a| self.owner[a] - point[a]), normal);
        let owner = [0, 1, 2].map(|a| self.owner[a] - distance * normal[a]);
        let zero = T::zero();
        Self {
            owner,
            corners: [[zero; 3]; 4],
            middle: [zero; 3],
            normal,
            curvature: SymmetricTensor::zero(),
            depth: zero,
            area: zero,
            free: [zero; 4],
            shift: [zero; 3],
            shear: [[zero; 3]; 3],
            misfit: zero,
            rest_depth: zero,
        }
    }

    /// A facet of a rigid body or segment: corners in space (m, anticlockwise as seen from outside). Its owner is behind its middle by that depth, m; a thin
    /// one has the depth zero.
    #[inline]
    pub fn rigid(corners: [Vector<T>; 4], normal: Vector<T>, depth: T) -> Self {
        let quarter = T::of(0.25);
        let owner = [0, 1, 2]
            .map(|a| quarter * (corners[0][a] + corners[1][a] + (corners[2][a] + corners[3][a])) - depth * normal[a]);
        let arms = corners.map(|p| [0, 1, 2].map(|a| p[a] - owner[a]));
        let zero = T::zero();
        let flat = ReferenceFacet::flat(arms, normal);
        Self {
            owner,
            corners: arms,
            middle: flat.middle,
            normal,
            curvature: SymmetricTensor::zero(),
            depth,
            area: flat.area().max(zero),
            free: [zero; 4],
            shift: [zero; 3],
            shear: [[zero; 3]; 3],
            misfit: zero,
            rest_depth: depth,
        }
    }
}

/// The first Piola-Kirchhoff stress times the reference volume, N m, of a moment (N m, power `M:L`) on a particle: `M F^-T`.
#[inline]
pub fn stress_of_moment<T: Real>(moment: &Tensor<T>, f: &Tensor<T>) -> Tensor<T> {
    multiply(moment, &transpose(&inverse(f)))
}

impl<T: Real> Numbers<T> for Facet<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { owner, corners, middle, normal, curvature, depth, area, free, shift, shear, misfit, rest_depth } =
            self;
        owner.each(visit);
        corners.each(visit);
        middle.each(visit);
        normal.each(visit);
        curvature.each(visit);
        visit(depth);
        visit(area);
        free.each(visit);
        shift.each(visit);
        shear.each(visit);
        visit(misfit);
        visit(rest_depth);
    }
}

#[cfg(test)]
mod tests;
