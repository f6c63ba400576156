//! A thin rigid segment in the plane, and the facets that it presses: on both of its sides, and at its ends.
//!
//! A side is a rigid facet without depth. Facets across the segment do not face its sides, and would let it through end on. At each end
//! they meet a short strip around it, which always lies along the plane of the facet, so that the place where contact begins is the end
//! itself whatever the angle. The pair stores
//!
//! ```text
//! U = chi(-n.e) int_Omega psi(d) dA
//! ```
//!
//! with the direction `e` in which the segment ends, the outward normal `n` of the facet, the depth `d` of the end behind its plane and the part
//! `Omega` of the strip beside which the facet is. The parts of a plane face together have the whole strip, wherever the end is. `chi` is that of
//! facets that face each other: one for facets within 45 degrees of square to the segment, zero beyond 73 degrees. Sides press facets
//! within 45 degrees of parallel to them. So a facet at any angle meets at least one of both.

use super::press::facing;
use super::{Facet, FacetPairLaw, FacetPress, Partner, press};
use crate::tensor::dot;
use crate::{Elementary, Vector};

/// A straight segment in the plane with a thickness across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidSegment<T> {
    /// Its ends, m.
    pub ends: [Vector<T>; 2],
    /// Of the facets that it meets, across the plane, m.
    pub thickness: T,
}

impl<T: Elementary> RigidSegment<T> {
    /// What the side of the segment that a facet looks at presses.
    #[inline]
    pub fn press_side(&self, a: &Facet<T>, law: &FacetPairLaw<T>) -> FacetPress<T> {
        let (zero, half) = (T::zero(), T::of(0.5));
        let [from, to] = self.ends;
        let along = [0, 1, 2].map(|k: usize| to[k] - from[k]);
        let length = dot(along, along).sqrt();
        let square = [along[1] / length, -along[0] / length, zero];
        // The side that looks against the facet.
        let sign = T::select_lt(dot(square, a.normal), zero, T::one(), -T::one());
        let normal = square.map(|c| sign * c);
        let distance = dot([0, 1, 2].map(|k: usize| a.owner[k] - from[k]), normal);
        // Below the owner, so that the order of owners along the normal is that of the sides.
        let foot = [0, 1, 2].map(|k: usize| a.owner[k] - distance * normal[k]);
        let (middle, reach) =
            ([0, 1, 2].map(|k: usize| half * (from[k] + to[k])), [0, 1, 2].map(|k: usize| sign * half * along[k]));
        press(a, &self.strip(middle, reach, normal, foot), Partner::Facet, law)
    }

    /// What one end of the segment presses with a strip of that width, m.
    #[inline]
    pub fn press_end(&self, a: &Facet<T>, end: usize, width: T, law: &FacetPairLaw<T>) -> FacetPress<T> {
        let (zero, half) = (T::zero(), T::of(0.5));
        let (tip, other) = (self.ends[end], self.ends[1 - end]);
        let along = [0, 1, 2].map(|k: usize| tip[k] - other[k]);
        let length = dot(along, along).sqrt();
        let outward = along.map(|c| c / length);
        let n = a.normal;
        let cosine = -dot(n, outward);
        let (chi, by_cosine) = facing(cosine);
        let reach = [half * width * n[1], -half * width * n[0], zero];
        let meet = || {
            let strip = self.strip(tip, reach, n.map(|c| -c), tip);
            let whole = press(a, &strip, Partner::Facet, law);
            // The strip turns with the facet: its torque about the end turns the normal.
            let torque = whole.moment_b[1][0] - whole.moment_b[0][1];
            let across = [-n[1], n[0], zero];
            let mut met = whole.times(chi);
            for i in 0..3 {
                // -dU = (chi' U e + chi torque (z x n)).dn, dn = -(I - n n) L^T n.
                let by_normal = by_cosine * whole.energy * (outward[i] + cosine * n[i]) + chi * torque * across[i];
                (0..3).for_each(|j: usize| met.moment_a[j][i] += -n[j] * by_normal);
            }
            met
        };
        T::if_lt(zero, chi, meet, FacetPress::none)
    }

    /// A rigid facet around a middle, m, as far as `reach` (m) to both sides.
    #[inline(always)]
    fn strip(&self, middle: Vector<T>, reach: Vector<T>, normal: Vector<T>, owner: Vector<T>) -> Facet<T> {
        let high = T::of(0.5) * self.thickness;
        let corner =
            |side: T, z: T| [0, 1, 2].map(|k: usize| middle[k] + side * reach[k] + if k == 2 { z } else { T::zero() });
        let one = T::one();
        let corners = [corner(-one, -high), corner(one, -high), corner(one, high), corner(-one, high)];
        let rigid = Facet::rigid(corners, normal, T::zero());
        let shift = [0, 1, 2].map(|k: usize| rigid.owner[k] - owner[k]);
        let moved = |arm: Vector<T>| [0, 1, 2].map(|k: usize| arm[k] + shift[k]);
        Facet { owner, corners: rigid.corners.map(moved), middle: moved(rigid.middle), ..rigid }
    }
}
