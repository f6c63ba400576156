//! Surfaces of a body: where their normals go as it deforms, and which places of them can meet.

use crate::tensor::{apply, dot, inverse, transpose};
use crate::{Scalar, Tensor, Vector};

/// Unit normal of a surface whose normal (of any length) in the reference configuration is given: `F^-T N` over its length.
#[inline(always)]
pub fn surface_normal<T: Scalar>(f: &Tensor<T>, normal: Vector<T>) -> Vector<T> {
    let turned = apply(&transpose(&inverse(f)), normal);
    let length = dot(turned, turned).sqrt();
    turned.map(|c| c / length)
}

/// Cosine of the angle between normals below which they are of different sides: 60 degrees. A corner, whose normal stands at 45 degrees, meets
/// corners and flats.
const DIFFERENT: f64 = 0.5;

/// Whether places of a surface with these outward unit normals are of different sides of it, as those of a fold that has closed are;
/// [`are_back_to_back`] tells them from the sides of a sheet.
#[inline]
pub fn are_different_sides<T: Scalar>(normal_i: Vector<T>, normal_j: Vector<T>) -> bool {
    dot(normal_i, normal_j) < T::of(DIFFERENT)
}

/// Whether of two places of a surface `x = x_i - x_j` (m) apart, with these outward normals (of any length), at least one is behind the other
/// by more than a length (m) and none in front of it, as on the two sides of a sheet or of an edge. Asked of the reference configuration, so
/// that the answer stands.
#[inline]
pub fn are_back_to_back<T: Scalar>(x: Vector<T>, normal_i: Vector<T>, normal_j: Vector<T>, by: T) -> bool {
    let behind = |along: T, normal: Vector<T>| along / dot(normal, normal).sqrt();
    let (j, i) = (behind(dot(x, normal_i), normal_i), behind(-dot(x, normal_j), normal_j));
    j.max(i) > by && j.min(i) > -by
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_stays_square_to_its_surface() {
        // A surface along (1, 0, 0) and (0, 1, 1), sheared, stretched and turned.
        let f = [[1.2, 2.0, 0.3], [-0.4, 0.9, 0.0], [0.1, 0.5, 0.6]];
        let normal = surface_normal(&f, [0.0, -3.0, 3.0]);
        assert!((dot(normal, normal) - 1.0f64).abs() < 1e-14);
        for along in [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]] {
            assert!(dot(normal, apply(&f, along)).abs() < 1e-14);
        }
        // It points to the same side.
        assert!(dot(normal, apply(&f, [0.0, -1.0, 1.0])) > 0.0);
    }

    #[test]
    fn the_sides_of_a_slot_meet_and_those_of_a_sheet_or_an_edge_do_not() {
        let (up, down, aside): ([f64; 3], _, _) = ([0.0, 2.0, 0.0], [0.0, -2.0, 0.0], [2.0, 0.0, 0.0]);
        let halved = |v: [f64; 3]| v.map(|c| 0.5 * c);
        assert!(are_different_sides(halved(up), halved(down)) && are_different_sides(halved(up), halved(aside)));
        assert!(!are_different_sides(halved(up), halved(up)));
        // The first place is above the second, aslant: back to back where it is the upper side of a sheet, not where it is that of a slot,
        // nor on a flat surface that will fold.
        let x = [-0.5, 1.0, 0.0];
        assert!(are_back_to_back(x, up, down, 0.9) && are_back_to_back(x.map(|c| -c), down, up, 0.9));
        assert!(!are_back_to_back(x, up, down, 1.1) && !are_back_to_back(x, down, up, 0.1));
        assert!(!are_back_to_back([1.0, 0.0, 0.0], up, up, 0.1));
        // The two sides of an edge: one looks up and stands aside from it, the other looks aside and is below.
        assert!(are_back_to_back([-1.0, 1.0, 0.0], up, aside, 0.1));
        assert!(!are_back_to_back([1.0, -1.0, 0.0], up, aside, 0.1));
        // The corner itself, and a place below it on one of the sides.
        assert!(are_back_to_back([0.0, 3.0, 0.0], [1.0, 1.0, 0.0], aside, 0.1));
    }
}
