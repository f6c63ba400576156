//! Edges that facets of neighbouring cells share.
//!
//! Facets follow their owners, whose motion has parts that no deformation gradient sees: where neighbours in a face part by more than `F` says, a gap opens
//! between their facets, and where they near each other facets lap. Bodies press where facets of both are. Where gaps in one face meet laps in the other there is
//! no pressure at all, so that the energy falls, from nothing on, as neighbours of one body move together in pairs and those of the other between them:
//! plates with their cells in line passed through each other at a third of the speed of sound.
//!
//! The edge between two cells is therefore in the middle between where both carry it: for the cell `i` it is
//!
//! ```text
//! s = (x_k - x_i - F_i d)/2
//! ```
//!
//! from where `F_i` carries it, with `d` the way to the cell `k` beside it at the start, or nearly so far where that is much ([`SharedEdge`]). A facet with the shifts `s-` and `s+` at both ends of
//! each axis along it has the point `Y` of the cell at `x_i + F_i Y + (I - n n)(T + G Y)`, with `T` the sum over the axes of `(s- + s+)/2` and `G` that of
//! `(s+ - s-) (x) u` ([`Facet::shifted`]). `u` is along the axis, one over the width of the cell. Only edges are shifted: the plane and the curvature remain where
//! the owner carries them. Forces on the edges are on what the shifts follow from, so that energy and momentum are conserved as without ([`EdgeForces::on_cell`]).
//!
//! What presses on a facet follows the places of its edges, and the volume of its cell does not: a cell that is wider than `F` says bears more and does not get thinner.
//! Under pressure that is unstable, whatever the material: surfaces of plates whose lattices are not in line moved along each other until nothing pressed. Stretched edges
//! therefore make the contact firmer, in proportion to its energy, so that they are held ([`Facet::misfit`]).

use super::press::add_of_normal;
use super::{Facet, ReferenceFacet};
use crate::tensor::{apply, dot, inverse, multiply, plus, transpose};
use crate::{Numbers, Real, Tensor, Vector};

/// Vectors of the six sides of a cell, a row for each of its axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OnSides<T> {
    /// Of the low sides.
    pub low: Tensor<T>,
    /// Of the high sides.
    pub high: Tensor<T>,
}

impl<T: Real> OnSides<T> {
    /// Zero.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = [[T::zero(); 3]; 3];
        Self { low: zero, high: zero }
    }

    /// Of a side, `2 axis + side`.
    #[inline(always)]
    pub fn on(&self, side: usize) -> &Vector<T> {
        if side.is_multiple_of(2) { &self.low[side / 2] } else { &self.high[side / 2] }
    }

    /// The same to be written.
    #[inline(always)]
    pub fn on_mut(&mut self, side: usize) -> &mut Vector<T> {
        if side.is_multiple_of(2) { &mut self.low[side / 2] } else { &mut self.high[side / 2] }
    }
}

/// The most that edges are shifted, in widths of the cell: facets do not follow what has broken away.
const FARTHEST: f64 = 0.5;

/// An edge to the next cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedEdge<T> {
    /// How far the middle between both cells is from where the own one carries it, m.
    apart: Vector<T>,
    /// Square of the largest shift, m^2.
    farthest: T,
}

impl<T: Real> SharedEdge<T> {
    /// From the way to the next particle (m), the deformation gradient and the way at the start (m).
    #[inline(always)]
    pub fn of(to: Vector<T>, f: &Tensor<T>, way: Vector<T>) -> Self {
        Self { apart: half_of_misfit(to, f, way), farthest: T::of(FARTHEST * FARTHEST) * dot(way, way) }
    }

    /// `q`, the square of the distance over the farthest, and `g = (1 + q^2)^(-1/4)`.
    #[inline(always)]
    fn share(&self) -> (T, T) {
        let q = dot(self.apart, self.apart) / self.farthest;
        (q, T::one() / (T::one() + q * q).sqrt().sqrt())
    }

    /// `s`, m: never farther than half the width of the cell.
    #[inline(always)]
    pub fn shift(&self) -> Vector<T> {
        let (_, g) = self.share();
        self.apart.map(|c| g * c)
    }

    /// Change of the shift with a change of the distance; the same, since it is symmetric, of a force on the shift to one on the distance.
    #[inline(always)]
    pub fn tangent(&self, change: Vector<T>) -> Vector<T> {
        let (q, g) = self.share();
        let squared = g * g;
        let less = q * squared * squared * g * dot(self.apart, change) / self.farthest;
        [0, 1, 2].map(|a: usize| g * change[a] - less * self.apart[a])
    }
}

/// Half of how much farther the next cell is than it is carried; of velocities with `L F`, its rate.
#[inline(always)]
pub fn half_of_misfit<T: Real>(to: Vector<T>, f: &Tensor<T>, way: Vector<T>) -> Vector<T> {
    let carried = apply(f, way);
    [0, 1, 2].map(|a: usize| T::of(0.5) * (to[a] - carried[a]))
}

/// Moment, N m (power `M:L`), on a cell of the force (N) on the distance of its edge; half of that force is on the next cell, and the opposite on the own one.
#[inline(always)]
pub fn moment_of_edge<T: Real>(force: Vector<T>, f: &Tensor<T>, way: Vector<T>) -> Tensor<T> {
    let carried = apply(f, way);
    force.map(|c| carried.map(|d| -(T::of(0.5) * c * d)))
}

/// What half of the square of the stretch of an edge adds to the energy of the contact of its facet.
const STIFFNESS: f64 = 400.0;

/// Stretch of an edge above which little is added: there, what `F` does not see is its change from cell to cell, as in feet and at corners, which must not be resisted.
const YIELDS: f64 = 0.03;

/// What a stretch adds to the energy of the contact of its facet, over that, its derivative, and the largest second one there may be with less of it.
#[inline(always)]
fn firmer<T: Real>(stretch: T) -> [T; 3] {
    let over = stretch / T::of(YIELDS);
    let share = T::one() / (T::one() + over * over);
    let slope = T::of(STIFFNESS) * share;
    [T::of(0.5) * slope * stretch * stretch, slope * share * stretch, slope * share]
}

/// What pairs do to a cell by the edges of its facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnCell<T> {
    /// Forces on the shifts of its sides, N.
    pub sides: OnSides<T>,
    /// Beside the moment of the pairs, N m (power `M:L`).
    pub moment: Tensor<T>,
    /// Stiffness against the motion of a particle, as others move against it, N/m.
    pub stiffness: T,
}

/// What edges do that are shifted along a facet with an energy of contact. With the stretches `e = s.F^-T u` of its edges, that energy is
///
/// ```text
/// (33l)  U (1 + 2 (D_a M_a + D_b M_b)/(D_a + D_b)),   M = sum over edges (k/2) e^2/(1 + (e/c)^2)
/// ```
///
/// with the depths `D` at rest: the work of a pressure on a cell is in proportion to its own volume. `by_misfit` is what the energy grows by with `M`, J.
#[inline(always)]
fn springs<T: Real>(reference: &ReferenceFacet<T>, f: &Tensor<T>, shifts: &OnSides<T>, by_misfit: T) -> OnCell<T> {
    let mut springs = OnCell { sides: OnSides::zero(), moment: [[T::zero(); 3]; 3], stiffness: T::zero() };
    let turned = transpose(&inverse(f));
    for axis in 0..3 {
        let mut of_axis = T::zero();
        let along = apply(&turned, reference.across[axis]);
        for (side, shift) in [(2 * axis, shifts.low[axis]), (2 * axis + 1, shifts.high[axis])] {
            let [_, slope, stiffness] = firmer(dot(shift, along));
            let force = along.map(|u| -(by_misfit * slope * u));
            *springs.sides.on_mut(side) = force;
            springs.moment = plus(&springs.moment, -T::one(), &dyad(force, shift));
            of_axis += T::of(0.5) * by_misfit * stiffness * dot(along, along);
        }
        // Motion along one axis is held by the edges at its ends.
        springs.stiffness = springs.stiffness.max(of_axis);
    }
    springs
}

/// `(I - n n) v`.
#[inline(always)]
fn within_plane<T: Real>(v: Vector<T>, normal: Vector<T>) -> Vector<T> {
    let above = dot(v, normal);
    [0, 1, 2].map(|a: usize| v[a] - above * normal[a])
}

/// `(I - n n) M`.
#[inline(always)]
fn rows_within_plane<T: Real>(m: &Tensor<T>, normal: Vector<T>) -> Tensor<T> {
    transpose(&transpose(m).map(|column| within_plane(column, normal)))
}

/// `f (x) y`.
#[inline(always)]
fn dyad<T: Real>(f: Vector<T>, y: Vector<T>) -> Tensor<T> {
    f.map(|a| y.map(|b| a * b))
}

impl<T: Real> ReferenceFacet<T> {
    /// One for each axis along which the facet has edges to other cells, else zero.
    #[inline(always)]
    fn shared(&self) -> [T; 3] {
        self.across.map(|u| T::select_lt(T::zero(), dot(u, u), T::one(), T::zero()))
    }
}

impl<T: Real> Facet<T> {
    /// The same facet with its edges shifted; `reference` is the one that was carried by `f`, and `shifts` (m) those of the sides of its cell.
    #[inline]
    pub fn shifted(self, reference: &ReferenceFacet<T>, f: &Tensor<T>, shifts: &OnSides<T>) -> Self {
        let (mut shift, mut gradient) = ([T::zero(); 3], [[T::zero(); 3]; 3]);
        let shared = reference.shared();
        let back = inverse(f);
        let (turned, mut misfit) = (transpose(&back), T::zero());
        for axis in 0..3 {
            let (low, high, u) = (shifts.low[axis], shifts.high[axis], reference.across[axis]);
            // At the middle of the facet.
            let along = dot(u, reference.middle);
            for a in 0..3 {
                let apart = high[a] - low[a];
                shift[a] += T::of(0.5) * shared[axis] * (low[a] + high[a]) + along * apart;
                (0..3).for_each(|b| gradient[a][b] += apart * u[b]);
            }
            let stretched = apply(&turned, u);
            misfit += firmer(dot(low, stretched))[0] + firmer(dot(high, stretched))[0];
        }
        let shear = multiply(&gradient, &back);
        let moved = |arm: Vector<T>| {
            let more = apply(&shear, [0, 1, 2].map(|a: usize| arm[a] - self.middle[a]));
            let by = within_plane([0, 1, 2].map(|a: usize| shift[a] + more[a]), self.normal);
            [0, 1, 2].map(|a: usize| arm[a] + by[a])
        };
        Self { corners: self.corners.map(moved), shift, shear, misfit, ..self }
    }
}

/// What pairs do to the edges of a facet, as if these were where the owner carries them. All that follows is linear in it, so that it is followed once for all
/// pairs of a facet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EdgeForces<T> {
    /// Their force, N (N/m).
    pub force: Vector<T>,
    /// Its moment about the middle of the facet, N m (N).
    pub moment: Tensor<T>,
    /// What the energy grows by with the [misfit](Facet::misfit) of the facet, J; zero only where nothing presses.
    pub by_misfit: T,
}

impl<T: Real> EdgeForces<T> {
    /// None.
    #[inline(always)]
    pub fn none() -> Self {
        Self { force: [T::zero(); 3], moment: [[T::zero(); 3]; 3], by_misfit: T::zero() }
    }

    /// Adds those of another pair.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        (0..3).for_each(|a| self.force[a] += other.force[a]);
        self.moment = plus(&self.moment, T::one(), &other.moment);
        self.by_misfit += other.by_misfit;
    }

    /// So many times the same.
    #[inline(always)]
    pub(super) fn times(&self, factor: T) -> Self {
        let vector = |v: Vector<T>| v.map(|c| factor * c);
        Self { force: vector(self.force), moment: self.moment.map(vector), by_misfit: factor * self.by_misfit }
    }

    /// What follows for the cell of the facet: `reference` is the one that was carried by `f` and shifted to `now`, with the shifts of the sides of its cell, m.
    #[inline]
    pub fn on_cell(
        &self,
        now: &Facet<T>,
        reference: &ReferenceFacet<T>,
        f: &Tensor<T>,
        shifts: &OnSides<T>,
    ) -> OnCell<T> {
        let (pull, differs) = self.followed(now);
        let (sides, springs) = (pull.on_sides(reference, f), springs(reference, f, shifts, self.by_misfit));
        OnCell {
            sides: OnSides {
                low: plus(&sides.low, T::one(), &springs.sides.low),
                high: plus(&sides.high, T::one(), &springs.sides.high),
            },
            moment: plus(&springs.moment, T::one(), &differs),
            stiffness: springs.stiffness,
        }
    }

    /// What they pull by where the edges are shifted, and by what the moment on the owner then differs: what follows the shifts is not on it, and edges are
    /// shifted within the plane, which turns with the owner.
    ///
    /// With `w = T + H y` at the place `y` of the owner's from the middle, an edge is at `y + (I - n n) w`.
    #[inline(always)]
    fn followed(&self, facet: &Facet<T>) -> (Pull<T>, Tensor<T>) {
        let (Self { force, moment: whole, .. }, Facet { normal, shift, shear, .. }) = (*self, *facet);
        // Where the owner carries what is at a place: (I + (I - n n) H)^-1.
        let mut grown = rows_within_plane(&shear, normal);
        (0..3).for_each(|a| grown[a][a] += T::one());
        let less = plus(&whole, -T::one(), &dyad(force, within_plane(shift, normal)));
        let carried = multiply(&less, &transpose(&inverse(&grown)));
        let mut differs = plus(&carried, -T::one(), &whole);
        // -dU = f.dP w with dP = -(dn n + n dn).
        let (above, raised) = (dot(force, normal), dot(shift, normal));
        let of_raised = apply(&carried, apply(&transpose(&shear), normal));
        let of_above = apply(&shear, apply(&transpose(&carried), normal));
        let by_normal = [0, 1, 2].map(|a: usize| (raised * force[a] + of_raised[a]) + (above * shift[a] + of_above[a]));
        add_of_normal(&mut differs, normal, by_normal, T::zero());
        (Pull { force: within_plane(force, normal), moment: rows_within_plane(&carried, normal) }, differs)
    }
}

impl<T: Real> Numbers<T> for EdgeForces<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        self.force.each(visit);
        self.moment.each(visit);
        visit(&mut self.by_misfit);
    }
}

/// Forces of the edges of a facet on what their shifts follow from.
struct Pull<T> {
    /// On [`Facet::shift`], N (N/m).
    force: Vector<T>,
    /// On [`Facet::shear`], N m (N).
    moment: Tensor<T>,
}

impl<T: Real> Pull<T> {
    /// Forces that the shifts of the sides of the cell do work by, N.
    #[inline(always)]
    fn on_sides(&self, reference: &ReferenceFacet<T>, f: &Tensor<T>) -> OnSides<T> {
        let of_initial = multiply(&self.moment, &transpose(&inverse(f)));
        let about_owner = plus(&of_initial, T::one(), &dyad(self.force, reference.middle));
        let (mut sides, shared) = (OnSides::zero(), reference.shared());
        for axis in 0..3 {
            let apart = apply(&about_owner, reference.across[axis]);
            for a in 0..3 {
                let both = T::of(0.5) * shared[axis] * self.force[a];
                sides.low[axis][a] = both - apart[a];
                sides.high[axis][a] = both + apart[a];
            }
        }
        sides
    }
}

impl<T: Real> Numbers<T> for OnSides<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        self.low.each(visit);
        self.high.each(visit);
    }
}

#[cfg(test)]
mod tests;
