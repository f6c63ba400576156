//! Inside tests and bounds of placed solids.

use crate::model::{Dimensions, Operation, Shape, Solid, Transform};

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

    /// A direction or velocity of the solid's frame in space.
    pub fn turn(&self, vector: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| (0..3).map(|b| self.rotation[a][b] * vector[b]).sum())
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
        self.solid.signed_distance_within(local, dimensions, tolerance) <= tolerance
    }

    /// Distance of a point of space from the surface, negative inside, m: exact beside faces and near the surface, and
    /// of the right sign everywhere.
    pub(super) fn signed_distance(&self, point: [f64; 3], dimensions: Dimensions) -> f64 {
        self.solid.signed_distance(self.transform.apply_inverse(point), dimensions)
    }

    /// The smallest thickness a lattice has to resolve, m: the shortest edge, the diameter, the wall; of composed shapes that
    /// of what they are made of.
    pub fn thickness(&self, dimensions: Dimensions) -> f64 {
        match &self.solid {
            Solid::Box { min, max } => (0..dimensions.count()).map(|k| max[k] - min[k]).fold(f64::INFINITY, f64::min),
            Solid::Ball { radius, inner_radius, .. } => wall(*radius, *inner_radius),
            Solid::Cylinder { from, to, radius, inner_radius } => {
                wall(*radius, *inner_radius).min(distance(*from, *to))
            }
            Solid::Ogive { from, to, radius, .. } => (2.0 * radius).min(distance(*from, *to)),
            Solid::Revolution { profile, .. } => {
                let widest = profile.iter().map(|p| 2.0 * p[1]).fold(0.0, f64::max);
                widest.min(profile[profile.len() - 1][0] - profile[0][0])
            }
            Solid::Polygon { corners } => {
                let (low, high) = extremes(corners.iter().map(|c| [c[0], c[1], 0.0]));
                (high[0] - low[0]).min(high[1] - low[1])
            }
            // A cloud is as thick as its particles are.
            Solid::Cloud { .. } => f64::INFINITY,
            Solid::Composed { operation, parts } => {
                let each = || parts.iter().map(|part| part.thickness(dimensions));
                match operation {
                    Operation::Union => each().fold(0.0, f64::max),
                    Operation::Difference => each().next().unwrap_or(0.0),
                    Operation::Intersection => each().fold(f64::INFINITY, f64::min),
                }
            }
        }
    }

    /// Corners of a box that holds the shape, in space.
    pub fn bounds(&self, dimensions: Dimensions) -> ([f64; 3], [f64; 3]) {
        let (low, high) = self.solid.bounds(dimensions);
        let corner = |k: usize| std::array::from_fn(|a| if k >> a & 1 == 0 { low[a] } else { high[a] });
        extremes((0..8).map(|k| self.transform.apply(corner(k))))
    }
}

fn wall(radius: f64, inner_radius: f64) -> f64 {
    if inner_radius > 0.0 { radius - inner_radius } else { 2.0 * radius }
}

/// Smallest and largest coordinates.
fn extremes(points: impl Iterator<Item = [f64; 3]>) -> ([f64; 3], [f64; 3]) {
    points.fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), p| {
        (std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k])))
    })
}

impl Solid {
    /// See [`Shape::signed_distance`]; the point is in the frame of the solid.
    pub(super) fn signed_distance(&self, point: [f64; 3], dimensions: Dimensions) -> f64 {
        self.signed_distance_within(point, dimensions, f64::INFINITY)
    }

    /// The same where it is no more than `limit`; else no less than that, which of a union takes less time.
    fn signed_distance_within(&self, point: [f64; 3], dimensions: Dimensions, limit: f64) -> f64 {
        let count = dimensions.count();
        match self {
            Self::Box { min, max } => {
                (0..count).map(|k| (min[k] - point[k]).max(point[k] - max[k])).fold(f64::NEG_INFINITY, f64::max)
            }
            Self::Ball { centre, radius, inner_radius } => {
                let r = (0..count).map(|k| (point[k] - centre[k]).powi(2)).sum::<f64>().sqrt();
                between(r, *inner_radius, *radius)
            }
            Self::Cylinder { from, to, radius, inner_radius } => {
                let length = distance(*from, *to);
                let (x, r) = about_axis(point, *from, subtract(*to, *from).map(|c| c / length));
                (-x).max(x - length).max(between(r, *inner_radius, *radius))
            }
            Self::Ogive { from, to, radius, nose_length } => {
                let length = distance(*from, *to);
                let (x, r) = about_axis(point, *from, subtract(*to, *from).map(|c| c / length));
                (-x).max(x - length).max(ogive_distance(x - (length - nose_length), r, *radius, *nose_length))
            }
            Self::Revolution { from, axis, profile } => {
                let (x, r) = about_axis(point, *from, *axis);
                let (first, last) = (profile[0], profile[profile.len() - 1]);
                let ends = [[first[0], 0.0], [last[0], 0.0]];
                let line = ends[..1].iter().chain(profile).chain(&ends[1..]);
                let distance = line_distance([x, r], line.copied());
                let inside = x >= first[0] && x <= last[0] && r <= radius_at(profile, x);
                if inside { -distance } else { distance }
            }
            Self::Polygon { corners } => {
                let here = [point[0], point[1]];
                let distance = line_distance(here, corners.iter().chain(&corners[..1]).copied());
                if is_inside_polygon(here, corners) { -distance } else { distance }
            }
            // Nothing is known of what lies between particles.
            Self::Cloud { .. } => f64::INFINITY,
            Self::Composed { operation, parts } => {
                let first = || parts.first().map_or(f64::INFINITY, |part| part.signed_distance(point, dimensions));
                match operation {
                    Operation::Union => first().min(parts.distance_of_others(point, dimensions, limit)),
                    Operation::Intersection => {
                        let each = parts.iter().map(|part| part.signed_distance(point, dimensions));
                        each.fold(f64::NEG_INFINITY, f64::max)
                    }
                    Operation::Difference => {
                        let first = first();
                        // Nothing is outside the first by more than it is in another.
                        first.max(-parts.distance_of_others(point, dimensions, -first))
                    }
                }
            }
        }
    }

    /// Corners of a box that holds the solid, in its own frame; nothing across axes the deck does not have.
    pub fn bounds(&self, dimensions: Dimensions) -> ([f64; 3], [f64; 3]) {
        let (mut low, mut high) = match self {
            Self::Box { min, max } => (*min, *max),
            Self::Ball { centre, radius, .. } => (centre.map(|c| c - radius), centre.map(|c| c + radius)),
            Self::Cylinder { from, to, radius, .. } | Self::Ogive { from, to, radius, .. } => {
                let length = distance(*from, *to);
                round_bounds(*from, *to, subtract(*to, *from).map(|c| c / length), *radius)
            }
            Self::Revolution { from, axis, profile } => {
                let radius = profile.iter().map(|p| p[1]).fold(0.0, f64::max);
                let end = |x: f64| std::array::from_fn(|k| from[k] + x * axis[k]);
                round_bounds(end(profile[0][0]), end(profile[profile.len() - 1][0]), *axis, radius)
            }
            Self::Polygon { corners } => extremes(corners.iter().map(|c| [c[0], c[1], 0.0])),
            Self::Cloud { particles, .. } => extremes(particles.iter().map(|p| p.position)),
            Self::Composed { operation, parts } => {
                let mut each = parts.iter().map(|part| part.bounds(dimensions));
                let first = each.next().unwrap_or(([0.0; 3], [0.0; 3]));
                match operation {
                    Operation::Difference => first,
                    Operation::Union => each.fold(first, |a, b| {
                        (std::array::from_fn(|k| a.0[k].min(b.0[k])), std::array::from_fn(|k| a.1[k].max(b.1[k])))
                    }),
                    // Of shapes that do not meet a box without inside is left.
                    Operation::Intersection => each.fold(first, |a, b| {
                        let low: [f64; 3] = std::array::from_fn(|k| a.0[k].max(b.0[k]));
                        (low, std::array::from_fn(|k| a.1[k].min(b.1[k]).max(low[k])))
                    }),
                }
            }
        };
        for k in dimensions.count()..3 {
            (low[k], high[k]) = (0.0, 0.0);
        }
        (low, high)
    }
}

/// Corners of a box that holds a round bar about a line with that unit vector.
fn round_bounds(from: [f64; 3], to: [f64; 3], axis: [f64; 3], radius: f64) -> ([f64; 3], [f64; 3]) {
    let (low, high) = extremes([from, to].into_iter());
    let aside: [f64; 3] = axis.map(|w| radius * (1.0 - w * w).max(0.0).sqrt());
    (std::array::from_fn(|k| low[k] - aside[k]), std::array::from_fn(|k| high[k] + aside[k]))
}

/// Distance along and across an axis.
pub(super) fn about_axis(point: [f64; 3], from: [f64; 3], axis: [f64; 3]) -> (f64, f64) {
    let offset = subtract(point, from);
    let along = dot(offset, axis);
    let across: [f64; 3] = std::array::from_fn(|k| offset[k] - along * axis[k]);
    (along, dot(across, across).sqrt())
}

/// Signed distance of a radius from the wall of a ring; a ring without hole is a disc.
fn between(r: f64, inner: f64, outer: f64) -> f64 {
    if inner > 0.0 { (inner - r).max(r - outer) } else { r - outer }
}

/// Radius of the arc of a tangent ogive, m: `(R^2 + L^2)/(2 R)`.
pub(super) fn arc_radius(radius: f64, nose_length: f64) -> f64 {
    (radius * radius + nose_length * nose_length) / (2.0 * radius)
}

/// Signed distance across from an ogive, `x` behind (negative) or before the root of the nose.
fn ogive_distance(x: f64, r: f64, radius: f64, nose_length: f64) -> f64 {
    if x <= 0.0 {
        return r - radius;
    }
    let arc = arc_radius(radius, nose_length);
    x.hypot(r + arc - radius) - arc
}

/// Radius of a solid of revolution at an axial distance; at a step the larger one.
pub(super) fn radius_at(profile: &[[f64; 2]], x: f64) -> f64 {
    let pairs = profile.windows(2).filter(|p| p[0][0] <= x && x <= p[1][0]);
    pairs.fold(0.0, |largest, p| {
        let length = p[1][0] - p[0][0];
        let here =
            if length > 0.0 { p[0][1] + (x - p[0][0]) / length * (p[1][1] - p[0][1]) } else { p[0][1].max(p[1][1]) };
        f64::max(largest, here)
    })
}

/// Distance of a point from a line of points.
fn line_distance(point: [f64; 2], line: impl Iterator<Item = [f64; 2]>) -> f64 {
    let mut previous: Option<[f64; 2]> = None;
    let mut least = f64::INFINITY;
    for b in line {
        let a = previous.replace(b).unwrap_or(b);
        let edge = [b[0] - a[0], b[1] - a[1]];
        let offset = [point[0] - a[0], point[1] - a[1]];
        let squared = edge[0] * edge[0] + edge[1] * edge[1];
        let share = if squared > 0.0 { (offset[0] * edge[0] + offset[1] * edge[1]) / squared } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        least = least.min((offset[0] - share * edge[0]).hypot(offset[1] - share * edge[1]));
    }
    least
}

/// Whether a ray from the point crosses the closed line an odd number of times.
fn is_inside_polygon(point: [f64; 2], corners: &[[f64; 2]]) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = edges.filter(|(a, b)| {
        (a[1] > point[1]) != (b[1] > point[1]) && point[0] < a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}

pub(super) fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = subtract(a, b);
    dot(d, d).sqrt()
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

    fn at_rest(solid: Solid) -> Shape {
        Shape { solid, transform: Transform::default() }
    }

    #[test]
    fn inside_tests_of_the_round_solids() {
        let cylinder = Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 2.0], radius: 0.5, inner_radius: 0.2 };
        let placed = Shape { solid: cylinder, transform: Transform::about_axis([1.0, 0.0, 0.0], PI / 2.0, [0.0; 3]) };
        // It lies along -y now.
        assert!(placed.contains([0.0, -1.9, 0.4], Dimensions::Three, 0.0));
        assert!(!placed.contains([0.0, -2.1, 0.3], Dimensions::Three, 0.0));
        assert!(!placed.contains([0.4, -1.0, 0.4], Dimensions::Three, 0.0));
        assert!(!placed.contains([0.1, -1.0, 0.1], Dimensions::Three, 0.0));
        assert!(placed.contains([0.1, -1.0, 0.1], Dimensions::Three, 0.06));
        assert_eq!(placed.thickness(Dimensions::Three), 0.3);
        let disc = at_rest(Solid::Ball { centre: [1.0, 0.0, 0.0], radius: 2.0, inner_radius: 0.0 });
        assert!(disc.contains([1.0, 1.9, 77.0], Dimensions::PlaneStrain, 0.0));
        assert_eq!(disc.thickness(Dimensions::PlaneStrain), 4.0);
    }

    #[test]
    fn a_profile_is_inside_up_to_its_radius_with_steps_and_cones() {
        // Along y from y = 1: radius 2 to 1, a step to 1, a cone to the tip at 5.
        let profile = vec![[0.0, 2.0], [1.0, 2.0], [1.0, 1.0], [3.0, 1.0], [5.0, 0.0]];
        let bar = at_rest(Solid::Revolution { from: [0.0, 1.0, 0.0], axis: [0.0, 1.0, 0.0], profile });
        let inside = |p| bar.contains(p, Dimensions::Three, 0.0);
        assert!(inside([1.3, 1.5, 1.4]) && !inside([1.5, 1.5, 1.5]));
        assert!(inside([2.0, 2.0, 0.0]) && !inside([1.5, 2.01, 0.0]));
        assert!(inside([0.0, 4.99, 0.5]) && !inside([0.0, 5.01, 0.5]));
        assert!(!inside([0.0, 0.99, 0.0]) && !inside([0.0, 6.01, 0.0]));
        // Grown and shrunk by a distance: the cone falls by one in two.
        let across = (0.25f64.powi(2) / (1.0 + 0.25)).sqrt();
        assert!(bar.contains([0.75, 5.0, 0.0], Dimensions::Three, across + 1e-9 + 0.01));
        assert!(!inside([0.75, 5.0, 0.0]) && !bar.contains([0.95, 3.0, 0.0], Dimensions::Three, -0.1));
        assert_eq!(bar.thickness(Dimensions::Three), 4.0);
        assert_eq!(bar.bounds(Dimensions::Three), ([-2.0, 1.0, -2.0], [2.0, 6.0, 2.0]));
        // Its ends stand across the line: beyond them by 2 times the sine to the axis.
        let rod = at_rest(Solid::Cylinder { from: [0.0; 3], to: [3.0, 4.0, 0.0], radius: 2.0, inner_radius: 0.0 });
        let (low, high) = rod.bounds(Dimensions::Three);
        let expected = ([-1.6, -1.2, -2.0], [4.6, 5.2, 2.0]);
        assert!((0..3).all(|k| (low[k] - expected.0[k]).abs().max((high[k] - expected.1[k]).abs()) < 1e-12));
    }

    #[test]
    fn an_ogive_leaves_the_bar_without_a_kink_and_ends_in_a_tip() {
        let bullet = at_rest(Solid::Ogive { from: [0.0; 3], to: [10.0, 0.0, 0.0], radius: 1.0, nose_length: 4.0 });
        let inside = |x: f64, r: f64| bullet.contains([x, 0.0, r], Dimensions::Three, 0.0);
        assert!(inside(5.9, 0.999) && !inside(5.9, 1.001));
        // Arc of radius 8.5 about (6, -7.5): at x = 8 the radius is sqrt(8.5^2 - 4) - 7.5 = 0.7613.
        assert!(inside(8.0, 0.761) && !inside(8.0, 0.762));
        assert!(inside(9.999, 0.0) && !inside(10.001, 0.0) && !inside(-0.001, 0.0));
        assert!(
            (bullet.signed_distance([8.0, 0.0, 0.0], Dimensions::Three) - (4.0f64 + 7.5 * 7.5).sqrt() + 8.5).abs()
                < 1e-12
        );
    }

    #[test]
    fn a_polygon_need_not_be_convex() {
        let angle = at_rest(Solid::Polygon {
            corners: vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]],
        });
        let inside = |x, y, grown| angle.contains([x, y, 0.0], Dimensions::PlaneStrain, grown);
        assert!(inside(0.5, 2.5, 0.0) && inside(2.5, 0.5, 0.0) && !inside(2.0, 2.0, 0.0));
        assert!(inside(1.1, 2.0, 0.11) && !inside(0.95, 2.0, -0.1));
    }

    #[test]
    fn composed_shapes_turn_as_one() {
        let cuboid = |min: [f64; 3], max: [f64; 3]| at_rest(Solid::Box { min, max });
        let parts = vec![cuboid([0.0; 3], [2.0, 2.0, 2.0]), cuboid([1.0, 0.0, 0.0], [3.0, 1.0, 2.0])];
        let turned = |operation| Shape {
            solid: Solid::Composed { operation, parts: parts.clone().into() },
            transform: Transform::about_axis([0.0, 0.0, 1.0], PI / 2.0, [0.0; 3]),
        };
        // Points of the frame of the parts, turned by a quarter: (x, y) becomes (-y, x).
        let inside = |operation, x: f64, y: f64| turned(operation).contains([-y, x, 1.0], Dimensions::Three, 0.0);
        let [only_first, both, only_second] = [(0.5, 1.5), (1.5, 0.5), (2.5, 0.5)];
        for (operation, expected) in [
            (Operation::Union, [true, true, true]),
            (Operation::Difference, [true, false, false]),
            (Operation::Intersection, [false, true, false]),
        ] {
            let found = [only_first, both, only_second].map(|(x, y)| inside(operation, x, y));
            assert_eq!(found, expected, "{operation:?}");
        }
    }
}
