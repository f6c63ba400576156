//! Inside tests, bounds and exact volumes of placed solids.

use crate::model::{Dimensions, Shape, Solid, Transform};

/// Sines and cosines this small come from rounding of right angles.
const ROUNDING: f64 = 1e-15;

impl Transform {
    /// Rotation by `angle` (rad, right-hand rule) about a line through `about` along the unit vector `axis` (Rodrigues).
    pub fn about_axis(axis: [f64; 3], angle: f64, about: [f64; 3]) -> Self {
        let exact = |v: f64| if v.abs() < ROUNDING { 0.0 } else { v };
        let (s, c) = (exact(angle.sin()), exact(angle.cos()));
        let [x, y, z] = axis;
        let t = 1.0 - c;
        let rotation = [
            [c + t * x * x, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, c + t * y * y, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, c + t * z * z],
        ];
        let turned = Self { rotation, translation: [0.0; 3] }.apply(about);
        Self { rotation, translation: std::array::from_fn(|k| about[k] - turned[k]) }
    }

    /// From the solid's frame into space.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let row = &self.rotation[a];
            row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + self.translation[a]
        })
    }

    /// From space into the solid's frame.
    pub fn apply_inverse(&self, point: [f64; 3]) -> [f64; 3] {
        let shifted: [f64; 3] = std::array::from_fn(|a| point[a] - self.translation[a]);
        std::array::from_fn(|a| (0..3).map(|b| self.rotation[b][a] * shifted[b]).sum())
    }
}

impl Shape {
    /// Whether a point of space is inside the solid grown by `tolerance` (m), or shrunk if that is negative.
    pub fn contains(&self, point: [f64; 3], dimensions: Dimensions, tolerance: f64) -> bool {
        let local = self.transform.apply_inverse(point);
        let count = dimensions.count();
        match &self.solid {
            Solid::Box { min, max } => {
                (0..count).all(|k| local[k] >= min[k] - tolerance && local[k] <= max[k] + tolerance)
            }
            Solid::Ball { centre, radius } => {
                distance_squared(local, *centre, count) <= (radius + tolerance).max(0.0).powi(2)
            }
            Solid::Cylinder { from, to, radius } => {
                let axis = subtract(*to, *from);
                let length = dot(axis, axis).sqrt();
                let offset = subtract(local, *from);
                let along = dot(offset, axis) / length;
                let across = (dot(offset, offset) - along * along).max(0.0);
                along >= -tolerance && along <= length + tolerance && across <= (radius + tolerance).max(0.0).powi(2)
            }
        }
    }

    /// Exact volume, m³; area (m²) in plane strain, length (m) in one dimension.
    pub fn volume(&self, dimensions: Dimensions) -> f64 {
        match &self.solid {
            Solid::Box { min, max } => (0..dimensions.count()).map(|k| max[k] - min[k]).product(),
            Solid::Ball { radius, .. } => match dimensions {
                Dimensions::One => 2.0 * radius,
                Dimensions::PlaneStrain => std::f64::consts::PI * radius * radius,
                Dimensions::Three => 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3),
            },
            Solid::Cylinder { from, to, radius } => {
                let axis = subtract(*to, *from);
                std::f64::consts::PI * radius * radius * dot(axis, axis).sqrt()
            }
        }
    }

    /// The smallest thickness a lattice has to resolve: the shortest edge, or the diameter, m.
    pub(crate) fn thickness(&self, dimensions: Dimensions) -> f64 {
        match &self.solid {
            Solid::Box { min, max } => (0..dimensions.count()).map(|k| max[k] - min[k]).fold(f64::INFINITY, f64::min),
            Solid::Ball { radius, .. } => 2.0 * radius,
            Solid::Cylinder { from, to, radius } => {
                let axis = subtract(*to, *from);
                (2.0 * radius).min(dot(axis, axis).sqrt())
            }
        }
    }
}

pub(super) fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn distance_squared(a: [f64; 3], b: [f64; 3], count: usize) -> f64 {
    (0..count).map(|k| (a[k] - b[k]).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_turn_about_a_point_keeps_the_point_and_turns_the_rest() {
        let turn = Transform::about_axis([0.0, 0.0, 1.0], PI / 2.0, [1.0, 2.0, 0.0]);
        assert_eq!(turn.apply([1.0, 2.0, 5.0]), [1.0, 2.0, 5.0]);
        assert_eq!(turn.apply([3.0, 2.0, 0.0]), [1.0, 4.0, 0.0]);
        let back = turn.apply_inverse(turn.apply([0.3, -0.7, 0.2]));
        assert!((0..3).all(|k| (back[k] - [0.3, -0.7, 0.2][k]).abs() < 1e-15));
    }

    #[test]
    fn a_turn_about_a_skew_axis_is_a_rotation() {
        let n = (1.0f64 / 3.0).sqrt();
        let turn = Transform::about_axis([n, n, n], 2.0 * PI / 3.0, [0.0; 3]);
        // A third of a turn about the space diagonal takes x to y to z.
        let y = turn.apply([1.0, 0.0, 0.0]);
        assert!((y[1] - 1.0).abs() < 1e-15 && y[0].abs() < 1e-15);
    }

    #[test]
    fn volumes_and_inside_tests_of_the_solids() {
        let cylinder = Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 2.0], radius: 0.5 };
        let placed = Shape { solid: cylinder, transform: Transform::about_axis([1.0, 0.0, 0.0], PI / 2.0, [0.0; 3]) };
        assert!((placed.volume(Dimensions::Three) - PI * 0.5).abs() < 1e-15);
        // It lies along -y now.
        assert!(placed.contains([0.0, -1.9, 0.4], Dimensions::Three, 0.0));
        assert!(!placed.contains([0.0, -2.1, 0.0], Dimensions::Three, 0.0));
        assert!(!placed.contains([0.4, -1.0, 0.4], Dimensions::Three, 0.0));
        let disc =
            Shape { solid: Solid::Ball { centre: [1.0, 0.0, 0.0], radius: 2.0 }, transform: Transform::default() };
        assert!((disc.volume(Dimensions::PlaneStrain) - 4.0 * PI).abs() < 1e-15);
        assert!(disc.contains([1.0, 1.9, 77.0], Dimensions::PlaneStrain, 0.0));
        assert_eq!(disc.thickness(Dimensions::PlaneStrain), 4.0);
    }
}
