//! Corners and edges of a body: which of the faces that meet there one meets.
//!
//! The normal that the kernel sum gives the particle of a corner stands midway between its faces. Pressed on one of them, the corner follows that face
//! and not the normal between: it stands as far below and is as wide as its neighbours on that face. A particle of a corner knows the normals
//! of its faces and takes the one that looks at what comes near.

use crate::surface::surface_normal;
use crate::tensor::dot;
use crate::{Scalar, Tensor, Vector};

/// Cosine of the angle between normals, 37 degrees, from which on they are of different faces: those of the faces of a square edge stand at
/// 42 to 45 degrees to the normal between; those of neighbours on a circle of four spacings at less than 30.
const ONE_FACE: f64 = 0.8;
/// How far a particle of a face may stand behind the others, in spacings: less than a layer.
const BEHIND: f64 = 0.5;

/// Unit normals of the faces other than that of its own normal of which a particle of the surface is an outermost one, zero where there are no
/// more: those of its neighbours on the surface, of which `x_ji` (m) and the unit normals are given.
pub fn faces_of_corner<T: Scalar>(
    own: Vector<T>,
    neighbours: impl Iterator<Item = (Vector<T>, Vector<T>)> + Clone,
    spacing: T,
) -> [Vector<T>; 3] {
    let mut faces = [[T::zero(); 3]; 3];
    let mut count = 0;
    let one_face = T::of(ONE_FACE);
    for (_, normal) in neighbours.clone() {
        let is_outermost = || neighbours.clone().all(|(x, _)| dot(x, normal) < T::of(BEHIND) * spacing);
        if dot(own, normal) >= one_face || !is_outermost() {
            continue;
        }
        let unit = |face: Vector<T>| face.map(|c| c / dot(face, face).sqrt());
        match faces[..count].iter().position(|face| dot(unit(*face), normal) >= one_face) {
            Some(known) => (0..3).for_each(|a| faces[known][a] += normal[a]),
            None if count < 3 => {
                faces[count] = normal;
                count += 1;
            }
            None => {}
        }
    }
    for face in &mut faces[..count] {
        let length = dot(*face, *face).sqrt();
        *face = face.map(|c| c / length);
    }
    faces
}

/// What comes near a particle of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach<T> {
    /// To where it is, m.
    pub direction: Vector<T>,
    /// Smallest distance, in reaches.
    nearest: T,
}

impl<T: Scalar> Default for Approach<T> {
    fn default() -> Self {
        Self { direction: [T::zero(); 3], nearest: T::one() }
    }
}

/// Part of its reach beyond which a kernel is next to nothing.
const NEXT_TO_NOTHING: f64 = 0.9;

impl<T: Scalar> Approach<T> {
    /// Adds a particle of another body at `x_ij` (m); the pair has that reach (m).
    pub fn add(&mut self, x_ij: Vector<T>, reach: T) {
        let distance = dot(x_ij, x_ij).sqrt() / reach;
        self.nearest = self.nearest.min(distance);
        let weight = (T::one() - distance).max(T::zero());
        (0..3).for_each(|a| self.direction[a] -= weight * x_ij[a]);
    }

    /// Whether something comes near that is not met yet, or is there at the start, when faces are as at rest: the face may be chosen.
    pub fn is_free(&self, is_start: bool) -> bool {
        self.nearest < T::one() && (is_start || self.nearest > T::of(NEXT_TO_NOTHING))
    }
}

/// Of the own normal at rest and those of the faces of a corner the one that looks along a direction (of any length) now.
pub fn face_towards<T: Scalar>(
    f: &Tensor<T>,
    own: Vector<T>,
    faces: &[Vector<T>; 3],
    direction: Vector<T>,
) -> Vector<T> {
    let (mut best, mut most) = (own, dot(surface_normal(f, own), direction));
    for &face in faces.iter().filter(|face| **face != [T::zero(); 3]) {
        let along = dot(surface_normal(f, face), direction);
        if along > most {
            (best, most) = (face, along);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours on the surface of a block `x, y <= 0`, whose corner is at the origin.
    fn around(at: Vector<f64>) -> Vec<(Vector<f64>, Vector<f64>)> {
        let half = 0.5f64.sqrt();
        let top = (1..4).map(|k| ([-f64::from(k), 0.0, 0.0], [0.0, 1.0, 0.0]));
        let side = (1..4).map(|k| ([0.0, -f64::from(k), 0.0], [1.0, 0.0, 0.0]));
        let all = top.chain(side).chain([([0.0; 3], [half, half, 0.0])]);
        let of = |(x, n): (Vector<f64>, Vector<f64>)| ([0, 1, 2].map(|a| x[a] - at[a]), n);
        all.map(of).filter(|(x, _)| *x != [0.0; 3] && dot(*x, *x) < 5.8).collect()
    }

    #[test]
    fn a_corner_knows_its_faces_and_a_face_only_itself() {
        let half = 0.5f64.sqrt();
        let corner = faces_of_corner([half, half, 0.0], around([0.0; 3]).into_iter(), 1.0);
        assert_eq!(corner, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]]);
        // Beside the corner one is an outermost particle of one face alone.
        assert_eq!(faces_of_corner([0.0, 1.0, 0.0], around([-1.0, 0.0, 0.0]).into_iter(), 1.0), [[0.0; 3]; 3]);
        // Nor are there corners on a circle.
        let on_circle = |turn: f64| ([4.0 * turn.sin(), 4.0 * (turn.cos() - 1.0), 0.0], [turn.sin(), turn.cos(), 0.0]);
        let circle = [-0.5, -0.25, 0.25, 0.5].map(on_circle);
        assert_eq!(faces_of_corner([0.0, 1.0, 0.0], circle.into_iter(), 1.0), [[0.0; 3]; 3]);
    }

    #[test]
    fn a_face_is_chosen_before_it_is_met() {
        let mut near = Approach::default();
        assert!(!near.is_free(true));
        near.add([0.0, 1.9, 0.0], 2.0);
        near.add([4.0, 0.0, 0.0], 2.0);
        assert!((near.direction[1] + 0.05 * 1.9f64).abs() < 1e-15 && near.direction[0] == 0.0, "{near:?}");
        assert!(near.is_free(false));
        near.add([0.0, 0.0, 1.0], 2.0);
        assert!(near.is_free(true) && !near.is_free(false));
    }

    #[test]
    fn a_corner_takes_the_face_that_looks_there() {
        let half = 0.5f64.sqrt();
        let faces = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]];
        let towards = |f: &Tensor<f64>, direction| face_towards(f, [half, half, 0.0], &faces, direction);
        let rest = crate::tensor::identity();
        assert_eq!(towards(&rest, [0.1, 3.0, 0.0]), faces[0]);
        assert_eq!(towards(&rest, [2.0, -0.3, 0.0]), faces[1]);
        assert_eq!(towards(&rest, [1.0, 0.9, 0.0]), [half, half, 0.0]);
        // Turned by a quarter to the left.
        assert_eq!(towards(&[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.1, 3.0, 0.0]), faces[1]);
    }
}
