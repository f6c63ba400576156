//! Exact sizes of shapes.

use crate::model::{Dimensions, Solid};
use std::f64::consts::PI;

/// Length, area or volume of a solid in the dimensions of the model, in powers of m.
pub(super) fn exact_size(solid: &Solid, dimensions: Dimensions) -> f64 {
    match solid {
        Solid::Box { min, max } => (0..dimensions.count()).map(|a| max[a] - min[a]).product(),
        Solid::Ball { radius, .. } => match dimensions {
            Dimensions::One => 2.0 * radius,
            Dimensions::PlaneStrain => PI * radius * radius,
            Dimensions::Three => 4.0 / 3.0 * PI * radius.powi(3),
        },
        Solid::Cylinder { from, to, radius } => {
            let length = (0..3).map(|a| (to[a] - from[a]).powi(2)).sum::<f64>().sqrt();
            PI * radius * radius * length
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_by_hand() {
        let near = |solid: &Solid, dimensions, expected: f64| {
            let size = exact_size(solid, dimensions);
            assert!((size - expected).abs() < 1e-12 * expected, "{size} is not {expected}");
        };
        let cuboid = Solid::Box { min: [-1.0, 0.0, 1.0], max: [2.0, 5.0, 3.0] };
        near(&cuboid, Dimensions::One, 3.0);
        near(&cuboid, Dimensions::PlaneStrain, 15.0);
        near(&cuboid, Dimensions::Three, 30.0);
        let ball = Solid::Ball { centre: [7.0, 8.0, 9.0], radius: 3.0 };
        near(&ball, Dimensions::PlaneStrain, 9.0 * PI);
        near(&ball, Dimensions::Three, 36.0 * PI);
        let cylinder = Solid::Cylinder { from: [1.0, 1.0, 1.0], to: [1.0, 4.0, 5.0], radius: 2.0 };
        near(&cylinder, Dimensions::Three, 20.0 * PI);
    }
}
