//! Facets of cells that are stretched along their normal.

use super::Facet;
use crate::tensor::dot;
use crate::{Real, Tensor, Vector};

/// Distance of a face from its particle over that at rest, at a stretch along its normal above one: value and slope are
/// those of the stretch at one, and it never is above two, so that faces of torn material stay within a spacing of their
/// particles.
#[inline(always)]
fn held<T: Real>(stretch: T) -> T {
    T::of(2.0) - T::one() / stretch
}

impl<T: Real> Facet<T> {
    /// The facet where it is held if its cell is stretched along its normal, and that stretch, one at least; `at_rest` is the depth of its owner in
    /// the reference configuration, m. A facet without depth stays. Compression moves no facet.
    #[inline]
    pub fn held(self, at_rest: T) -> (Self, T) {
        let (zero, one) = (T::zero(), T::one());
        let stretch = T::select_lt(zero, at_rest, self.depth / at_rest, one).max(one);
        let nearer = at_rest * (held(stretch) - stretch);
        let shift = |arm: Vector<T>| [0, 1, 2].map(|k: usize| arm[k] + nearer * self.normal[k]);
        (Self { corners: self.corners.map(shift), middle: shift(self.middle), ..self }, stretch)
    }
}

/// Moment (power `M:L`), N m, of the force (N) of a pair on a facet that is [held](Facet::held) at a stretch, beyond the one that it would have
/// if its place followed the deformation: the facet is at `D (c - lambda) n` from there, with `d lambda = lambda n.L n` and
/// `dn = -(I - n n) L^T n`.
#[inline]
pub fn moment_of_torn<T: Real>(facet: &Facet<T>, stretch: T, force: Vector<T>) -> Tensor<T> {
    let (n, depth) = (facet.normal, facet.depth / stretch);
    let along = dot(force, n);
    let tilt = depth * (held(stretch) - stretch);
    let press = depth * (T::one() / stretch - stretch);
    [0, 1, 2].map(|a: usize| {
        [0, 1, 2].map(|b: usize| {
            let across = force[b] - along * n[b];
            press * along * n[a] * n[b] - tilt * (n[a] * across + force[a] * n[b])
        })
    })
}
