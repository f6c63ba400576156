//! Volumes of shapes.

use super::shape::{arc_radius, dot, subtract};
use crate::model::{Dimensions, Shape, Solid};
use std::f64::consts::PI;

/// Points along an axis of the grid that estimates what has no closed form: in the plane, in space.
const FINE: [u32; 2] = [1000, 120];
/// The same where the order of magnitude is enough.
const COARSE: [u32; 2] = [100, 30];

/// A volume, and whether it is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// m³; area (m²) in plane strain, length (m) in one dimension.
    pub size: f64,
    /// Whether it comes from a formula; otherwise points of a grid were counted.
    pub is_exact: bool,
}

impl Shape {
    /// The volume: exact for single shapes, counted for composed ones, to about a thousandth.
    pub fn volume(&self, dimensions: Dimensions) -> Volume {
        match self.solid.exact_volume(dimensions) {
            Some(size) => Volume { size, is_exact: true },
            None => Volume { size: self.counted_volume(dimensions, FINE), is_exact: false },
        }
    }

    /// The order of the volume, cheaply.
    pub(super) fn rough_volume(&self, dimensions: Dimensions) -> f64 {
        self.solid.exact_volume(dimensions).unwrap_or_else(|| self.counted_volume(dimensions, COARSE))
    }

    /// Volume of the cells of a grid over the bounds whose middle is inside.
    fn counted_volume(&self, dimensions: Dimensions, points: [u32; 2]) -> f64 {
        let (low, high) = self.solid.bounds(dimensions);
        let along: [u32; 3] = match dimensions {
            Dimensions::One => [points[0], 1, 1],
            Dimensions::PlaneStrain => [points[0], points[0], 1],
            Dimensions::Three => [points[1]; 3],
        };
        let grid = Grid {
            solid: &self.solid,
            dimensions,
            low,
            edge: std::array::from_fn(|axis| (high[axis] - low[axis]) / f64::from(along[axis])),
        };
        let inside = grid.inside([0; 3], along);
        let cell: f64 = grid.edge[..dimensions.count()].iter().product();
        inside as f64 * cell
    }
}

/// Cells whose middles are counted.
struct Grid<'a> {
    solid: &'a Solid,
    dimensions: Dimensions,
    low: [f64; 3],
    edge: [f64; 3],
}

impl Grid<'_> {
    /// Number of cells from `first` up to `end` whose middle is inside. Where the middle of the block is farther from the surface than from the
    /// middles of its outermost cells, all of them are inside or none is: signed distances differ by no more than the distance of the points.
    fn inside(&self, first: [u32; 3], end: [u32; 3]) -> u64 {
        let middle =
            std::array::from_fn(|a| self.low[a] + 0.5 * (f64::from(first[a]) + f64::from(end[a])) * self.edge[a]);
        let distance = self.solid.signed_distance(middle, self.dimensions);
        let counts: [u32; 3] = std::array::from_fn(|a| end[a] - first[a]);
        let all: u64 = counts.iter().map(|&n| u64::from(n)).product();
        let half = |a: usize| 0.5 * f64::from(counts[a] - 1) * self.edge[a];
        let reach = (0..self.dimensions.count()).map(|a| half(a).powi(2)).sum::<f64>().sqrt();
        if all == 1 || distance.abs() > reach * (1.0 + 1e-9) {
            return if distance <= 0.0 { all } else { 0 };
        }
        let longest = (0..3).max_by_key(|&a| counts[a]).expect("three axes");
        let (mut end_of_first, mut start_of_second) = (end, first);
        end_of_first[longest] = first[longest] + counts[longest] / 2;
        start_of_second[longest] = end_of_first[longest];
        self.inside(first, end_of_first) + self.inside(start_of_second, end)
    }
}

impl Solid {
    fn exact_volume(&self, dimensions: Dimensions) -> Option<f64> {
        let plane = dimensions == Dimensions::PlaneStrain;
        Some(match self {
            Self::Box { min, max } => (0..dimensions.count()).map(|k| max[k] - min[k]).product(),
            Self::Ball { radius, inner_radius, .. } => match dimensions {
                Dimensions::One => 2.0 * (radius - inner_radius),
                Dimensions::PlaneStrain => PI * (radius * radius - inner_radius * inner_radius),
                Dimensions::Three => 4.0 / 3.0 * PI * (radius.powi(3) - inner_radius.powi(3)),
            },
            Self::Cylinder { from, to, radius, inner_radius } => {
                let axis = subtract(*to, *from);
                PI * (radius * radius - inner_radius * inner_radius) * dot(axis, axis).sqrt()
            }
            Self::Revolution { profile, .. } => {
                let slices = profile.windows(2).map(|p| (p[1][0] - p[0][0], p[0][1], p[1][1]));
                match plane {
                    true => slices.map(|(length, a, b)| length * (a + b)).sum(),
                    // Frusta.
                    false => slices.map(|(length, a, b)| PI / 3.0 * length * (a * a + a * b + b * b)).sum(),
                }
            }
            Self::Ogive { from, to, radius, nose_length } => {
                let axis = subtract(*to, *from);
                let bar = dot(axis, axis).sqrt() - nose_length;
                let nose = ogive_nose(*radius, *nose_length, plane);
                nose + bar * if plane { 2.0 * radius } else { PI * radius * radius }
            }
            Self::Polygon { corners } => {
                let next = corners.iter().cycle().skip(1);
                0.5 * corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
            }
            // One part alone is itself.
            // Known with the spacing and the density only.
            Self::Cloud { .. } => return None,
            Self::Composed { parts, .. } => match &**parts {
                [one] => one.solid.exact_volume(dimensions)?,
                _ => return None,
            },
        })
    }
}

/// Volume, or in the plane area, of the nose of a tangent ogive: the integral of `r = sqrt(a^2 - x^2) - (a - R)` over `0..L`, or
/// of its square, with the radius `a` of the arc.
fn ogive_nose(radius: f64, length: f64, plane: bool) -> f64 {
    let a = arc_radius(radius, length);
    let sagitta = a - radius;
    let segment = length * (a * a - length * length).max(0.0).sqrt() + a * a * (length / a).asin();
    if plane {
        return segment - 2.0 * sagitta * length;
    }
    PI * (a * a * length - length.powi(3) / 3.0 - sagitta * segment + sagitta * sagitta * length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Operation, Transform};

    fn size(solid: Solid, dimensions: Dimensions) -> Volume {
        Shape { solid, transform: Transform::default() }.volume(dimensions)
    }

    #[track_caller]
    fn near(solid: Solid, dimensions: Dimensions, expected: f64) {
        let volume = size(solid, dimensions);
        assert!(volume.is_exact && (volume.size - expected).abs() < 1e-12 * expected, "{volume:?} is not {expected}");
    }

    #[test]
    fn sizes_by_hand() {
        let cuboid = Solid::Box { min: [-1.0, 0.0, 1.0], max: [2.0, 5.0, 3.0] };
        near(cuboid.clone(), Dimensions::One, 3.0);
        near(cuboid.clone(), Dimensions::PlaneStrain, 15.0);
        near(cuboid, Dimensions::Three, 30.0);
        let ball = Solid::Ball { centre: [7.0, 8.0, 9.0], radius: 3.0, inner_radius: 0.0 };
        near(ball.clone(), Dimensions::PlaneStrain, 9.0 * PI);
        near(ball, Dimensions::Three, 36.0 * PI);
        let ring = Solid::Ball { centre: [0.0; 3], radius: 3.0, inner_radius: 1.0 };
        near(ring.clone(), Dimensions::PlaneStrain, 8.0 * PI);
        near(ring, Dimensions::Three, 104.0 / 3.0 * PI);
        let tube = Solid::Cylinder { from: [1.0, 1.0, 1.0], to: [1.0, 4.0, 5.0], radius: 2.0, inner_radius: 1.0 };
        near(tube, Dimensions::Three, 15.0 * PI);
        let angle =
            Solid::Polygon { corners: vec![[0.0, 0.0], [0.0, 3.0], [1.0, 3.0], [1.0, 1.0], [3.0, 1.0], [3.0, 0.0]] };
        near(angle, Dimensions::PlaneStrain, 5.0);
    }

    #[test]
    fn profiles_are_sums_of_frusta() {
        // A cylinder, a step down, a cone to a tip.
        let profile = vec![[1.0, 2.0], [4.0, 2.0], [4.0, 1.0], [7.0, 0.0]];
        let bar = Solid::Revolution { from: [5.0; 3], axis: [0.0, 1.0, 0.0], profile };
        near(bar.clone(), Dimensions::Three, 12.0 * PI + PI);
        near(bar, Dimensions::PlaneStrain, 12.0 + 3.0);
    }

    #[test]
    fn an_ogive_as_long_as_its_radius_is_a_hemisphere() {
        let bullet = Solid::Ogive { from: [0.0; 3], to: [0.0, 0.0, 5.0], radius: 2.0, nose_length: 2.0 };
        near(bullet.clone(), Dimensions::Three, 12.0 * PI + 16.0 / 3.0 * PI);
        near(bullet, Dimensions::PlaneStrain, 12.0 + 2.0 * PI);
        // A slender one against slices of its radius.
        let (radius, length) = (1.0, 4.0);
        let slices = 20_000;
        let sum: f64 = (0..slices)
            .map(|k| {
                let x = (f64::from(k) + 0.5) * length / f64::from(slices);
                PI * ((8.5f64 * 8.5 - x * x).sqrt() - 7.5).powi(2) * length / f64::from(slices)
            })
            .sum();
        assert!((ogive_nose(radius, length, false) / sum - 1.0).abs() < 1e-8);
    }

    #[test]
    fn composed_volumes_are_estimates() {
        let part = |solid| Shape { solid, transform: Transform::default() };
        let plate = part(Solid::Box { min: [-2.0, -2.0, 0.0], max: [2.0, 2.0, 1.0] });
        let hole =
            part(Solid::Cylinder { from: [0.5, 0.0, -1.0], to: [0.5, 0.0, 2.0], radius: 1.0, inner_radius: 0.0 });
        let drilled = Solid::Composed { operation: Operation::Difference, parts: vec![plate, hole.clone()].into() };
        let volume = size(drilled, Dimensions::Three);
        assert!(!volume.is_exact && (volume.size / (16.0 - PI) - 1.0).abs() < 1e-3, "{volume:?}");
        // A disc far thinner than wide has no room above and below it.
        let disc = Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 0.03], radius: 1.0, inner_radius: 0.0 };
        let drilled = Solid::Composed { operation: Operation::Difference, parts: vec![part(disc), hole].into() };
        let lens = 2.0 * (0.25f64.acos() - 0.25 * (1.0 - 0.0625f64).sqrt());
        let volume = size(drilled, Dimensions::Three);
        assert!((volume.size / (0.03 * (PI - lens)) - 1.0).abs() < 3e-3, "{volume:?}");
    }

    #[test]
    fn blocks_count_what_their_cells_do() {
        let part = |solid| Shape { solid, transform: Transform::default() };
        let turned = |solid| Shape { solid, transform: Transform::about_axis([0.6, 0.0, 0.8], 0.7, [0.3, -0.2, 0.1]) };
        let plate = part(Solid::Box { min: [-2.0, -1.5, 0.0], max: [2.0, 2.0, 1.0] });
        let tube =
            turned(Solid::Cylinder { from: [0.5, 0.0, -1.0], to: [0.5, 0.3, 2.0], radius: 1.0, inner_radius: 0.4 });
        let bullet = turned(Solid::Ogive { from: [-1.0; 3], to: [1.0, 1.0, 2.0], radius: 0.5, nose_length: 1.5 });
        let ball = part(Solid::Ball { centre: [1.0, 1.0, 0.5], radius: 0.7, inner_radius: 0.3 });
        let profile = vec![[0.0, 0.5], [1.0, 0.5], [1.0, 0.9], [2.0, 0.1]];
        let bar = turned(Solid::Revolution { from: [0.0; 3], axis: [0.0, 1.0, 0.0], profile });
        for operation in [Operation::Union, Operation::Difference, Operation::Intersection] {
            for others in [vec![tube.clone()], vec![bullet.clone(), ball.clone()], vec![bar.clone(), tube.clone()]] {
                let parts = [vec![plate.clone()], others].concat().into();
                let shape = part(Solid::Composed { operation, parts });
                let (low, high) = shape.solid.bounds(Dimensions::Three);
                let n = 24;
                let at = |a: usize, k: usize| low[a] + (k as f64 + 0.5) / n as f64 * (high[a] - low[a]);
                let cells = (0..n * n * n).map(|k| [at(0, k % n), at(1, k / n % n), at(2, k / n / n)]);
                let inside = cells.filter(|&x| shape.contains(x, Dimensions::Three, 0.0)).count() as f64;
                let cell: f64 = (0..3).map(|a| (high[a] - low[a]) / n as f64).product();
                let counted = shape.counted_volume(Dimensions::Three, [n as u32; 2]);
                assert!((counted / cell - inside).abs() < 1e-6, "{operation:?}: {} and {inside}", counted / cell);
            }
        }
    }
}
