//! The surfaces that bound a shape: where a point is nearest to each of them, the normal there, and how it is curved.
//!
//! The signed distance of a composed shape says which of its parts is nearest, but not which of them a face of a
//! particle belongs to: a particle beside the cut of a half ball is nearer to the cut than to the sphere. So all
//! surfaces are listed, and the caller chooses.

use super::shape::{about_axis, arc_radius, dot, subtract};
use crate::model::{Dimensions, Operation, Shape, Solid, Transform};
use smallvec::SmallVec;

/// The place of a surface nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// m.
    pub(super) closest: [f64; 3],
    /// Outward unit normal there.
    pub(super) normal: [f64; 3],
    /// Curvature there, 1/m: positive along directions in which the surface falls off behind its tangent plane.
    pub(super) curvature: [[f64; 3]; 3],
}

/// Surfaces of one shape.
pub(super) type Places = SmallVec<[Place; 8]>;

const FLAT: [[f64; 3]; 3] = [[0.0; 3]; 3];

fn plus(a: [f64; 3], s: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + s * b[k])
}

/// A unit vector at right angles to an axis; in the plane one in the plane.
fn across(axis: [f64; 3]) -> [f64; 3] {
    unit([-axis[1], axis[0], 0.0]).unwrap_or([1.0, 0.0, 0.0])
}

fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > 0.0).then(|| a.map(|c| c / length))
}

/// `c (I - n n - a a)`: curvature around an axis; without one, of a sphere.
fn around(c: f64, normal: [f64; 3], axis: Option<[f64; 3]>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let one = if i == j { 1.0 } else { 0.0 };
            c * (one - normal[i] * normal[j] - axis.map_or(0.0, |a| a[i] * a[j]))
        })
    })
}

/// `c t t`.
fn along(c: f64, t: [f64; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| c * t[i] * t[j]))
}

fn sum(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

/// A body of revolution seen from a point: distance along and across the axis, and the unit vector across.
struct Round {
    from: [f64; 3],
    axis: [f64; 3],
    x: f64,
    r: f64,
    out: [f64; 3],
}

impl Round {
    /// A point on the axis is as near to the places of a round side in any direction: it has one of them.
    fn new(point: [f64; 3], from: [f64; 3], axis: [f64; 3]) -> Self {
        let (x, r) = about_axis(point, from, axis);
        let out = unit(plus(subtract(point, from), -x, axis)).unwrap_or_else(|| across(axis));
        Self { from, axis, x, r, out }
    }

    fn at(&self, x: f64, r: f64) -> [f64; 3] {
        plus(plus(self.from, x, self.axis), r, self.out)
    }

    /// A direction of the half plane through the point.
    fn direction(&self, along: f64, across: f64) -> [f64; 3] {
        std::array::from_fn(|k| along * self.axis[k] + across * self.out[k])
    }

    fn ends(&self, length: f64, radii: (f64, f64), places: &mut Places) {
        for (x, side) in [(0.0, -1.0), (length, 1.0)] {
            let closest = self.at(x, self.r.clamp(radii.0, radii.1));
            places.push(Place { closest, normal: self.axis.map(|c| side * c), curvature: FLAT });
        }
    }

    fn side(&self, x: f64, radius: f64, outward: f64, places: &mut Places) {
        let normal = self.out.map(|c| outward * c);
        let curvature = around(outward / radius, self.out, Some(self.axis));
        places.push(Place { closest: self.at(x, radius), normal, curvature });
    }
}

impl Shape {
    /// The nearest place of every surface that bounds the shape or one of its parts, m. Where a surface comes to a
    /// point it is as curved as a ball of radius `finest`, m, at most.
    pub(super) fn surfaces(&self, point: [f64; 3], dimensions: Dimensions, finest: f64) -> Places {
        let mut places = Places::new();
        self.add_surfaces(point, dimensions, finest, 1.0, &mut places);
        places
    }

    fn add_surfaces(&self, point: [f64; 3], dimensions: Dimensions, finest: f64, sign: f64, places: &mut Places) {
        let first = places.len();
        let local = self.transform.apply_inverse(point);
        self.solid.add_surfaces(local, dimensions, finest, sign, places);
        for place in &mut places[first..] {
            *place = turned(&self.transform, place);
        }
    }
}

/// Cosine between the normal of a round surface and a direction from which on it looks that way.
const TOWARDS: f64 = 0.3;

impl Shape {
    /// Whether a round surface of the shape, or of one of its parts, looks along a direction of unit length.
    pub fn is_round_towards(&self, direction: [f64; 3]) -> bool {
        let local = std::array::from_fn(|b| (0..3).map(|a| self.transform.rotation[a][b] * direction[a]).sum());
        self.solid.is_round_towards(local)
    }
}

impl Solid {
    fn is_round_towards(&self, direction: [f64; 3]) -> bool {
        // A round surface whose normals are at this angle to the axis, all around it.
        let looks = |axis: [f64; 3], [along, across]: [f64; 2]| {
            let axial = dot(axis, direction);
            along * axial + across * (1.0 - axial * axial).max(0.0).sqrt() > TOWARDS
        };
        match self {
            Self::Box { .. } | Self::Polygon { .. } | Self::Cloud { .. } => false,
            Self::Ball { .. } => true,
            Self::Cylinder { from, to, .. } => unit(subtract(*to, *from)).is_some_and(|axis| looks(axis, [0.0, 1.0])),
            // Of a nose all normals from that of the bar to nearly that of the axis.
            Self::Ogive { from, to, .. } => {
                unit(subtract(*to, *from)).is_some_and(|axis| looks(axis, [0.0, 1.0]) || looks(axis, [0.8, 0.6]))
            }
            Self::Revolution { axis, profile, .. } => profile.windows(2).any(|ends| {
                let (x, r) = (ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]);
                let length = x.hypot(r);
                x > 0.0 && looks(*axis, [-r / length, x / length])
            }),
            Self::Composed { operation, parts } => parts.iter().enumerate().any(|(k, part)| {
                let is_taken = matches!(operation, Operation::Difference) && k > 0;
                part.is_round_towards(if is_taken { direction.map(|c| -c) } else { direction })
            }),
        }
    }
}

fn turned(transform: &Transform, place: &Place) -> Place {
    let r = &transform.rotation;
    let curvature = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let of = |k: usize| (0..3).map(|l| r[i][k] * place.curvature[k][l] * r[j][l]).sum::<f64>();
            (0..3).map(of).sum()
        })
    });
    Place { closest: transform.apply(place.closest), normal: transform.turn(place.normal), curvature }
}

impl Solid {
    fn add_surfaces(&self, p: [f64; 3], dimensions: Dimensions, finest: f64, sign: f64, places: &mut Places) {
        let first = places.len();
        let count = dimensions.count();
        match self {
            Self::Box { min, max } => {
                let inside: [f64; 3] =
                    std::array::from_fn(|k| if k < count { p[k].clamp(min[k], max[k]) } else { 0.0 });
                for (k, (face, side)) in (0..count).flat_map(|k| [(k, (min[k], -1.0)), (k, (max[k], 1.0))]) {
                    let (mut closest, mut normal) = (inside, [0.0; 3]);
                    (closest[k], normal[k]) = (face, side);
                    places.push(Place { closest, normal, curvature: FLAT });
                }
            }
            Self::Ball { centre, radius, inner_radius } => {
                let from: [f64; 3] = std::array::from_fn(|k| if k < count { p[k] - centre[k] } else { 0.0 });
                let out = unit(from).unwrap_or([1.0, 0.0, 0.0]);
                let axis = (count < 3).then_some([0.0, 0.0, 1.0]);
                for (r, side) in [(*radius, 1.0), (*inner_radius, -1.0)].into_iter().filter(|(r, _)| *r > 0.0) {
                    let closest = std::array::from_fn(|k| if k < count { centre[k] + r * out[k] } else { 0.0 });
                    let curvature = if count > 1 { around(side / r, out, axis) } else { FLAT };
                    places.push(Place { closest, normal: out.map(|c| side * c), curvature });
                }
            }
            Self::Cylinder { from, to, radius, inner_radius } => {
                let Some((axis, length)) = axis_of(*from, *to) else { return };
                let round = Round::new(p, *from, axis);
                round.ends(length, (*inner_radius, *radius), places);
                let x = round.x.clamp(0.0, length);
                round.side(x, *radius, 1.0, places);
                if *inner_radius > 0.0 {
                    round.side(x, *inner_radius, -1.0, places);
                }
            }
            Self::Ogive { from, to, radius, nose_length } => {
                let Some((axis, length)) = axis_of(*from, *to) else { return };
                let round = Round::new(p, *from, axis);
                let root = length - nose_length;
                let back = round.at(0.0, round.r.min(*radius));
                places.push(Place { closest: back, normal: axis.map(|c| -c), curvature: FLAT });
                round.side(round.x.clamp(0.0, root), *radius, 1.0, places);
                // The arc about a point behind the axis.
                let arc = arc_radius(*radius, *nose_length);
                let (dx, dr) = ((round.x - root).max(0.0), round.r + arc - radius);
                let angle = dx.atan2(dr).min((nose_length / arc).asin());
                let (sin, cos) = angle.sin_cos();
                let (x, r) = (root + arc * sin, (radius - arc + arc * cos).max(0.0));
                let (normal, tangent) = (round.direction(sin, cos), round.direction(cos, -sin));
                let about = unit(cross(normal, tangent)).unwrap_or([0.0; 3]);
                let curvature = sum(along(1.0 / arc, tangent), along(cos / r.max(finest), about));
                places.push(Place { closest: round.at(x, r), normal, curvature });
            }
            Self::Revolution { from, axis, profile } => {
                let round = Round::new(p, *from, *axis);
                let ends = [[profile[0][0], 0.0], [profile[profile.len() - 1][0], 0.0]];
                let corners: Vec<[f64; 2]> = ends[..1].iter().chain(profile).chain(&ends[1..]).copied().collect();
                for pair in corners.windows(2) {
                    let (a, b) = (pair[0], pair[1]);
                    let Some((on, direction)) = nearest_on_edge([round.x, round.r], a, b) else { continue };
                    // Profiles go on along the axis with the material below them.
                    let (along_axis, across) = (-direction[1], direction[0]);
                    let normal = round.direction(along_axis, across);
                    let about = unit(cross(*axis, round.out)).unwrap_or([0.0; 3]);
                    let curvature = along(across / on[1].max(finest), about);
                    places.push(Place { closest: round.at(on[0], on[1]), normal, curvature });
                }
            }
            Self::Polygon { corners } => {
                let edges = corners.iter().zip(corners.iter().cycle().skip(1));
                let area: f64 = edges.clone().map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
                let side = area.signum();
                for (a, b) in edges {
                    let Some((on, direction)) = nearest_on_edge([p[0], p[1]], *a, *b) else { continue };
                    let normal = [side * direction[1], -side * direction[0], 0.0];
                    places.push(Place { closest: [on[0], on[1], 0.0], normal, curvature: FLAT });
                }
            }
            Self::Cloud { .. } => {}
            Self::Composed { operation, parts } => {
                for (k, part) in parts.iter().enumerate() {
                    let is_taken = *operation == Operation::Difference && k > 0;
                    part.add_surfaces(p, dimensions, finest, if is_taken { -1.0 } else { 1.0 }, places);
                }
            }
        }
        if sign < 0.0 {
            for place in &mut places[first..] {
                place.normal = place.normal.map(|c| -c);
                place.curvature = place.curvature.map(|row| row.map(|c| -c));
            }
        }
    }
}

fn axis_of(from: [f64; 3], to: [f64; 3]) -> Option<([f64; 3], f64)> {
    let axis = subtract(to, from);
    Some((unit(axis)?, dot(axis, axis).sqrt()))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The point of an edge nearest to a point, and the direction of the edge.
fn nearest_on_edge(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let edge = [b[0] - a[0], b[1] - a[1]];
    let length = edge[0].hypot(edge[1]);
    if length == 0.0 {
        return None;
    }
    let direction = edge.map(|c| c / length);
    let share = ((p[0] - a[0]) * direction[0] + (p[1] - a[1]) * direction[1]).clamp(0.0, length);
    Some(([a[0] + share * direction[0], a[1] + share * direction[1]], direction))
}
