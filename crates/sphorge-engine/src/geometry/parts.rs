//! How far a point is from many parts of a shape, by their boxes: a union of a thousand would else be gone through for every site of its
//! lattice and every cell its volume is counted in.

use crate::model::{Dimensions, Parts};

/// Parts from which on their boxes are worth sorting.
const MANY: usize = 8;
/// Least distance from a shape over that from its box along the axis where that is largest: beside an edge of a cuboid, which stands askew in its
/// box, the distance of shapes is that from the nearest face, 1/sqrt(3) of the true one.
const LEAST_SHARE: f64 = 0.5;
/// What corners of boxes can be off by rounding, over their coordinates.
const ROUNDING: f64 = 1e-12;

impl Parts {
    /// The least signed distance of a point from all parts but the first, m, where it is no more than `limit`; else no less than that.
    pub(super) fn distance_of_others(&self, point: [f64; 3], dimensions: Dimensions, limit: f64) -> f64 {
        let value = |k: usize| self[k + 1].signed_distance(point, dimensions);
        let others = self.len().saturating_sub(1);
        let tree = if others >= MANY { self.boxes_of_others(dimensions) } else { None };
        match tree {
            Some(tree) => {
                let off = ROUNDING * point.into_iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
                let floor = |d: f64| if d > off { LEAST_SHARE * (d - off) } else { f64::NEG_INFINITY };
                tree.least(point, limit, floor, value)
            }
            None => (0..others).map(value).fold(f64::INFINITY, f64::min),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Operation, Shape, Solid, Transform};

    /// Numbers from 0 up to 1 that look like chance.
    fn chance(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*seed >> 11) as f64 / (1u64 << 53) as f64
    }

    fn part(kind: usize, seed: &mut u64, dimensions: Dimensions) -> Shape {
        let size = 0.1 + 0.3 * chance(seed);
        let mut along = || [chance(seed), chance(seed), chance(seed)];
        let axis = along().map(|c| c - 0.4);
        let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        let solid = match kind % 6 {
            0 => Solid::Box { min: [0.0; 3], max: along().map(|c| 0.1 + c) },
            1 => Solid::Ball { centre: [0.1; 3], radius: size, inner_radius: 0.4 * size },
            _ if dimensions == Dimensions::PlaneStrain => {
                Solid::Polygon { corners: vec![[0.0, 0.0], [0.6, 0.1], [0.2, 0.15], [0.1, 0.5]] }
            }
            2 => Solid::Cylinder { from: [0.0; 3], to: axis, radius: size, inner_radius: 0.0 },
            3 => Solid::Ogive { from: [0.0; 3], to: axis, radius: 0.2 * length, nose_length: 0.6 * length },
            4 => Solid::Revolution {
                from: [0.0; 3],
                axis: axis.map(|c| c / length),
                profile: vec![[0.0, 0.2], [0.3, 0.2], [0.3, 0.4], [0.9, 0.0]],
            },
            _ => {
                let parts = [part(0, seed, dimensions), part(1, seed, dimensions), part(2, seed, dimensions)];
                let operation = [Operation::Union, Operation::Difference, Operation::Intersection][kind / 6 % 3];
                Solid::Composed { operation, parts: Parts::from_iter(parts) }
            }
        };
        let mut place = || 3.0 * chance(seed) - 1.5;
        let (x, y, z, angle) = (place(), place(), place(), place());
        let (axis, z) = match dimensions {
            Dimensions::Three => ([0.48, 0.6, 0.64], z),
            _ => ([0.0, 0.0, 1.0], 0.0),
        };
        let turn = Transform::about_axis(axis, angle, [0.0; 3]);
        Shape { solid, transform: Transform { translation: [x, y, z], ..turn } }
    }

    #[test]
    fn many_parts_are_as_far_as_each_of_them_to_the_bit() {
        for dimensions in [Dimensions::PlaneStrain, Dimensions::Three] {
            let mut seed = 7;
            let parts: Parts = (0..120).map(|k| part(k, &mut seed, dimensions)).collect();
            let mut met = [0; 2];
            for _ in 0..20_000 {
                let point =
                    std::array::from_fn(|k| if k < dimensions.count() { 5.0 * chance(&mut seed) - 2.5 } else { 0.0 });
                let expected = (1..parts.len()).map(|k| parts[k].signed_distance(point, dimensions));
                let expected = expected.fold(f64::INFINITY, f64::min);
                let found = parts.distance_of_others(point, dimensions, f64::INFINITY);
                assert_eq!(found.to_bits(), expected.to_bits(), "{point:?} {dimensions:?}: {found} and {expected}");
                for limit in [-0.05, 0.0, 0.2] {
                    let is_within = parts.distance_of_others(point, dimensions, limit) <= limit;
                    assert_eq!(is_within, expected <= limit, "{point:?}");
                }
                met[usize::from(expected <= 0.0)] += 1;
            }
            assert!(met[0] > 1000 && met[1] > 1000, "{met:?}");
        }
    }
}
