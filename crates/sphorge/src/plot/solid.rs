//! Bodies in space as polygons: the faces of cells that are seen from outside, and where a section cuts cells. The viewer draws the same.

use super::{
    cell::{HalfSpace, cross, dot, minus},
    view::Projection,
};
use crate::{
    cells::{JoinedCells, NONE, Nodes, Outside},
    model::SymmetryPlane,
};

/// How far before a plane cells are cut, in their spacing: a face in the plane is cut, too.
const ON_CUT: f64 = 2e-3;
/// Corners at most where a plane cuts a cell: one on each edge.
const EDGES: usize = 12;

/// A polygon of a body: to the right, up, towards the eye, m.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polygon {
    /// Number of the mark it is of.
    pub(super) mark: u32,
    /// Its corners among those of all.
    pub(super) corners: std::ops::Range<usize>,
    /// Away from the particle; none where a section cuts it.
    pub(super) outward: Option<[f64; 3]>,
    /// Which of the edges from each corner to the next one are drawn, one bit each; of a cut, those that are at the surface.
    pub(super) edges: u32,
}

/// All of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Solid {
    pub(super) corners: Vec<[f64; 3]>,
    pub(super) polygons: Vec<Polygon>,
    /// Marks that are joined to no other.
    pub(super) alone: Vec<u32>,
}

/// The cells of a frame, and what a picture shows of them.
pub(super) struct Cells<'a> {
    pub(super) joined: &'a JoinedCells,
    pub(super) nodes: &'a Nodes,
    pub(super) positions: &'a [[f64; 3]],
    /// Whether each is kept by the conditions of the picture; all where there are none.
    pub(super) is_kept: Option<&'a [bool]>,
    /// Planes in which images stand, with their numbers in the deck: each doubles what is there.
    pub(super) mirrors: &'a [(usize, SymmetryPlane)],
    /// Numbers of the marks of all particles, then of those of the next image; [`NONE`] where there is none.
    pub(super) marks: &'a [u32],
    /// The plane of a section, and the largest spacing, m.
    pub(super) cut: Option<(HalfSpace, f64)>,
}

/// A polygon with a flag for the edge from each corner to the next one.
type Flagged = Vec<([f64; 3], bool)>;

impl Solid {
    pub(super) fn new(cells: &Cells<'_>, projection: &Projection) -> Self {
        let mut outside = cells.joined.outside(cells.nodes, |cell| cells.is_kept.is_none_or(|kept| kept[cell]));
        // An image continues what is at its plane.
        let mirrored = cells.mirrors.iter().fold(0, |bits, (number, _)| bits | 1u32 << number);
        outside.faces.retain(|face| {
            let is_open = u32::from(face.held) & mirrored == 0;
            if !is_open && !face.is_filler {
                outside.sides[face.cell as usize] &= !(1 << face.face);
            }
            is_open
        });
        let cut = cells.cut.map(|(cut, spacing)| HalfSpace { offset: cut.offset - ON_CUT * spacing, ..cut });
        let mut solid = Self::default();
        for image in 0..1usize << cells.mirrors.len() {
            let marks = cells.marks.iter().skip(image * cells.positions.len()).take(cells.positions.len());
            let marks: Vec<u32> = marks.copied().collect();
            solid.add(cells, &outside, image, &marks, cut.as_ref(), projection);
        }
        solid
    }

    /// Adds the polygons of an image.
    fn add(
        &mut self,
        cells: &Cells<'_>,
        outside: &Outside,
        image: usize,
        marks: &[u32],
        cut: Option<&HalfSpace>,
        projection: &Projection,
    ) {
        let mirrors =
            || cells.mirrors.iter().enumerate().filter(move |(k, _)| image >> k & 1 == 1).map(|(_, (_, at))| at);
        let place = |mut p: [f64; 3]| {
            mirrors().for_each(|plane| p[plane.axis] = 2.0 * plane.position - p[plane.axis]);
            p
        };
        let of_node = |node: u32| place(cells.nodes.places[node as usize]);
        let is_there = |cell: usize| marks.get(cell).is_some_and(|mark| *mark != NONE);
        for face in outside.faces.iter().filter(|face| is_there(face.cell as usize)) {
            let cell = face.cell as usize;
            let corners = face.nodes.map(of_node);
            let normal = outward(&corners, place(cells.positions[cell]));
            let count = if face.is_filler { 3 } else { 4 };
            let polygon: Flagged = corners[..count].iter().map(|corner| (*corner, !face.is_filler)).collect();
            let polygon = match cut {
                Some(cut) => clipped(&polygon, cut),
                None => polygon,
            };
            self.push(marks[cell], &polygon, Some(normal), projection);
        }
        for (cell, sides) in outside.sides.iter().enumerate().filter(|(cell, _)| is_there(*cell)) {
            if *sides & 0b11_1111 == 0b11_1111 {
                self.alone.push(marks[cell]);
            }
            if let Some(cut) = cut {
                let corners = std::array::from_fn(|k| of_node(outside.of[8 * cell + k]));
                self.push(marks[cell], &section(&corners, *sides, cut), None, projection);
            }
        }
    }

    fn push(&mut self, mark: u32, polygon: &Flagged, normal: Option<[f64; 3]>, projection: &Projection) {
        if polygon.len() < 3 || polygon.iter().any(|(corner, _)| corner.iter().any(|x| !x.is_finite())) {
            return;
        }
        let first = self.corners.len();
        self.corners.extend(polygon.iter().map(|(corner, _)| projection.apply(*corner)));
        let edges = polygon.iter().enumerate().fold(0, |bits, (k, (_, flag))| bits | u32::from(*flag) << k);
        let corners = first..self.corners.len();
        self.polygons.push(Polygon { mark, corners, outward: normal.map(|n| projection.apply(n)), edges });
    }
}

/// The normal of a face from its diagonals, away from the particle.
fn outward([p, q, r, s]: &[[f64; 3]; 4], particle: [f64; 3]) -> [f64; 3] {
    let normal = cross(minus(*r, *p), minus(*s, *q));
    let middle: [f64; 3] = std::array::from_fn(|a| 0.25 * (p[a] + q[a] + r[a] + s[a]));
    let sign = if dot(normal, minus(middle, particle)) < 0.0 { -1.0 } else { 1.0 };
    let length = dot(normal, normal).sqrt().max(f64::MIN_POSITIVE);
    normal.map(|x| sign * x / length)
}

/// What of a polygon is in a half space: along the cut it has no edge.
fn clipped(polygon: &Flagged, space: &HalfSpace) -> Flagged {
    if polygon.iter().all(|(corner, _)| space.depth(*corner) >= 0.0) {
        return polygon.clone();
    }
    let mut inside = Flagged::new();
    for (k, &(from, flag)) in polygon.iter().enumerate() {
        let (to, _) = polygon[(k + 1) % polygon.len()];
        let (a, b) = (space.depth(from), space.depth(to));
        if a >= 0.0 {
            inside.push((from, flag));
        }
        if (a >= 0.0) != (b >= 0.0) {
            inside.push((between(from, to, a / (a - b)), flag && b >= 0.0));
        }
    }
    inside
}

/// Where a plane cuts a cell, in order around the middle, with a flag for each edge that is on one of the `sides`.
fn section(corners: &[[f64; 3]; 8], sides: u8, plane: &HalfSpace) -> Flagged {
    let depths = corners.map(|corner| plane.depth(corner));
    if !(depths.iter().any(|depth| *depth > 0.0) && depths.iter().any(|depth| *depth < 0.0)) {
        return Flagged::new();
    }
    let mut points = Vec::with_capacity(EDGES);
    for axis in 0..3 {
        for a in (0..8usize).filter(|k| k >> axis & 1 == 0) {
            let b = a | 1 << axis;
            if (depths[a] < 0.0) != (depths[b] < 0.0) {
                let at = between(corners[a], corners[b], depths[a] / (depths[a] - depths[b]));
                // Faces that have both ends of the edge.
                let faces = (0..6).filter(|face| face / 2 != axis && face % 2 == a >> (face / 2) & 1);
                points.push((at, faces.fold(0u8, |bits, face| bits | 1 << face)));
            }
        }
    }
    let Some(&(first, _)) = points.first() else { return Flagged::new() };
    let count = points.len() as f64;
    let middle: [f64; 3] = std::array::from_fn(|a| points.iter().map(|(point, _)| point[a]).sum::<f64>() / count);
    let right = minus(first, middle);
    let up = cross(plane.normal, right);
    let angle = |point: [f64; 3]| dot(minus(point, middle), up).atan2(dot(minus(point, middle), right));
    points.sort_by(|(a, _), (b, _)| angle(*a).total_cmp(&angle(*b)));
    let edge = |k: usize| points[k].1 & points[(k + 1) % points.len()].1 & sides != 0;
    points.iter().enumerate().map(|(k, (point, _))| (*point, edge(k))).collect()
}

fn between(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        cells::{Deformation, tests::cylinder},
        plot::View,
    };

    /// The polygons of a cylinder and of its images as it was at the start, seen along no axis of its own.
    fn solid(is_quarter: bool, mirrors: &[(usize, SymmetryPlane)], cut: Option<(HalfSpace, f64)>) -> Solid {
        let (joined, positions) = cylinder(is_quarter);
        let gradient: Vec<f32> = (0..9 * positions.len()).map(|k| if k % 9 % 4 == 0 { 1.0 } else { 0.0 }).collect();
        let nodes = joined.at(&positions, &Deformation::whole(gradient));
        let marks: Vec<u32> = (0..(positions.len() << mirrors.len()) as u32).collect();
        let (joined, nodes, positions, marks) = (&joined, &nodes, &positions[..], &marks[..]);
        let cells = Cells { joined, nodes, positions, is_kept: None, mirrors, marks, cut };
        Solid::new(&cells, &View::Xy.projection())
    }

    const PLANES: [(usize, SymmetryPlane); 2] = [
        (0, SymmetryPlane { axis: 0, position: 0.0, side: 1.0 }),
        (1, SymmetryPlane { axis: 1, position: 0.0, side: 1.0 }),
    ];

    /// Twice the area of a polygon seen along z.
    fn twice(solid: &Solid, polygon: &Polygon) -> f64 {
        let corners = &solid.corners[polygon.corners.clone()];
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs()
    }

    #[test]
    fn all_of_an_end_has_the_light_of_that_end() {
        let solid = solid(false, &[], None);
        let is_end = |polygon: &&Polygon| {
            let corners = &solid.corners[polygon.corners.clone()];
            corners.iter().all(|p| (p[2] - 4e-3).abs() < 1e-9) && twice(&solid, polygon) > 1e-12
        };
        let ends: Vec<_> = solid.polygons.iter().filter(is_end).collect();
        assert!(ends.len() > 76, "faces of {} and what is between rings", ends.len());
        assert!(ends.iter().all(|end| end.outward.is_some_and(|n| n[2] > 0.999)));
    }

    #[test]
    fn images_go_on_across_their_planes() {
        let is_in_plane = |solid: &Solid, axis: usize| {
            let held = |p: &Polygon| solid.corners[p.corners.clone()].iter().all(|corner| corner[axis].abs() < 1e-9);
            solid.polygons.iter().any(held)
        };
        let alone = solid(true, &[], None);
        assert!(is_in_plane(&alone, 0) && is_in_plane(&alone, 1));
        let half = solid(true, &PLANES[1..], None);
        assert!(is_in_plane(&half, 0) && !is_in_plane(&half, 1));
        let whole = solid(true, &PLANES, None);
        assert!(!is_in_plane(&whole, 0) && !is_in_plane(&whole, 1));
    }

    #[test]
    fn a_cut_is_as_large_as_the_body_there() {
        // Across the axis, between layers and in the middle of one.
        for place in [1.0e-3, 1.5e-3, 2.2e-3] {
            let cut = HalfSpace { normal: [0.0, 0.0, 1.0], offset: place };
            for (is_quarter, mirrors) in [(false, &[][..]), (true, &PLANES[..])] {
                let solid = solid(is_quarter, mirrors, Some((cut, 1e-3)));
                assert!(solid.corners.iter().all(|corner| corner[2] < place));
                let cuts: Vec<_> = solid.polygons.iter().filter(|polygon| polygon.outward.is_none()).collect();
                // The rim has chords for arcs: 28 of them or so.
                let area = 0.5 * cuts.iter().map(|cut| twice(&solid, cut)).sum::<f64>();
                let disc = std::f64::consts::PI * 25e-6;
                assert!(area < disc && area > 0.94 * disc, "{place}: {area} of {disc}");
                // What is at the surface is the rim alone.
                let length = |polygon: &Polygon| {
                    let corners = &solid.corners[polygon.corners.clone()];
                    let count = corners.len();
                    let edge = |k: usize| minus(corners[(k + 1) % count], corners[k]);
                    (0..count)
                        .filter(|k| polygon.edges >> k & 1 == 1)
                        .map(|k| dot(edge(k), edge(k)).sqrt())
                        .sum::<f64>()
                };
                let rim: f64 = cuts.iter().map(|cut| length(cut)).sum();
                assert!((rim / (std::f64::consts::TAU * 5e-3) - 1.0).abs() < 0.02, "{place}: {rim}");
            }
        }
    }
}
