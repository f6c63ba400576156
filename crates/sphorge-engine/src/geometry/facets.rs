//! Facets: the faces of the cells of particles at which bodies are exposed at the start.
//!
//! A face of a cell is exposed if no particle of the body is beyond it, images in symmetry planes and beyond periodic
//! ends included. Bodies end where their shape does, not where the cells of their lattice do: corners and middle of a
//! face are placed on the surface of the shape, with its normal and curvature. Particles from a file have no shape;
//! their facets are those of cubes of their volume.

use self::beside::Owner;
use super::{
    cell::{Cell, CellFace, FACES},
    fill::pattern,
    pattern::Pattern,
    shape::dot,
    surface::{Place, Places},
};
use crate::model::{Dimensions, LatticePlacement, Model, Shape, Solid, SymmetryPlane};
use smallvec::SmallVec;
use sphorge_physics::facet::ReferenceFacet;
use sphorge_physics::{SymmetricTensor, Tensor, Vector};
use std::collections::HashMap;

/// Distance from where the next particle is expected within which one covers a face, in spacings: rings next to each
/// other, and rows of a hexagonal lattice, are shifted by up to 0.65.
const COVERED: f64 = 0.7;
/// Faces farther than this from the surface stay where they are, in spacings.
const FARTHEST: f64 = 1.0;
/// Smallest cosine between a face of a cell and the surface it belongs to.
const FACING: f64 = 0.1;
/// Cosine between normals above which two surfaces do not meet at an edge.
const ONE_SURFACE: f64 = 0.95;
/// Distance from a surface, in spacings, that is rounding.
const ON_SURFACE: f64 = 1e-6;
/// What of a turn between corners is rounding, over the square of the largest distance.
const ROUNDING: f64 = 1e-9;
/// Cosine between the normals of two faces of a cell below which an edge between them is one of the body.
const ELSEWHERE: f64 = 0.5;
/// Distance of an edge from the plane of a face that begins there, in spacings.
const BESIDE: f64 = 0.25;
/// Facets smaller than this share of the face of a cube are left out.
const SMALLEST: f64 = 1e-6;

/// A facet in the initial configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFacet {
    /// Number of the face of the cell that it is, or a part of, at most five.
    pub side: u8,
    /// Itself.
    pub facet: ReferenceFacet<f64>,
}

impl CellFacet {
    /// Between corners (m, from the particle) that need not be in the plane of the facet: four in space, two in the
    /// plane, of which the facet is a strip of that thickness (m), none on a line, where it is a square as wide.
    fn new(
        side: u8,
        mut corners: SmallVec<[Vector<f64>; 4]>,
        middle: Vector<f64>,
        normal: Vector<f64>,
        mut curvature: Tensor<f64>,
        thickness: f64,
    ) -> Self {
        let half = 0.5 * thickness;
        let thick = |p: Vector<f64>, z: f64| [p[0], p[1], z];
        match corners[..] {
            [] => {
                let square = [[-half, -half], [half, -half], [half, half], [-half, half]];
                corners.extend(square.map(|[y, z]| [middle[0], y, z]));
            }
            [start, end] => {
                corners = [thick(start, -half), thick(end, -half), thick(end, half), thick(start, half)]
                    .into_iter()
                    .collect();
                // Nothing falls off across the plane.
                for k in 0..3 {
                    (curvature[k][2], curvature[2][k]) = (0.0, 0.0);
                }
            }
            _ => {}
        }
        for corner in &mut corners {
            let from_middle: Vector<f64> = std::array::from_fn(|k| corner[k] - middle[k]);
            let above = dot(from_middle, normal);
            *corner = std::array::from_fn(|k| corner[k] - above * normal[k]);
        }
        let corners: [Vector<f64>; 4] = std::array::from_fn(|k| corners.get(k).copied().unwrap_or(middle));
        let mut corners = convex(corners, normal);
        // Corners that coincide come last.
        if let Some(k) = (0..4).find(|&k| corners[k] == corners[(k + 1) % 4]) {
            corners.rotate_left((k + 2) % 4);
        }
        let curvature = SymmetricTensor::symmetric_part(&curvature);
        let facet = ReferenceFacet {
            corners,
            middle,
            normal,
            curvature,
            depth: dot(middle, normal),
            free: [0.0; 4],
            across: [[0.0; 3]; 3],
        };
        // Anticlockwise as seen from outside.
        let facet = if facet.area() < 0.0 { ReferenceFacet { corners: reversed(corners), ..facet } } else { facet };
        Self { side, facet }
    }
}

/// The convex hull of four corners in a plane with that normal, in the order of a way round; of three corners the last comes twice. The corners of a face
/// that are placed on the edge of a shape may lie behind a diagonal, or cross it.
fn convex(corners: [Vector<f64>; 4], normal: Vector<f64>) -> [Vector<f64>; 4] {
    let way = |from: usize, to: usize| -> Vector<f64> { std::array::from_fn(|k| corners[to][k] - corners[from][k]) };
    let turn = |a: usize, b: usize, c: usize| dot(cross(way(a, b), way(b, c)), normal);
    let size =
        (0..4).flat_map(|a| (0..4).map(move |b| (a, b))).map(|(a, b)| dot(way(a, b), way(a, b))).fold(0.0, f64::max);
    let turns = [turn(3, 0, 1), turn(0, 1, 2), turn(1, 2, 3), turn(2, 3, 0)];
    let (least, most) = turns.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), t| (l.min(*t), m.max(*t)));
    // Straight corners are none that matter.
    if least.max(-most) >= -ROUNDING * size {
        return corners;
    }
    // Of every three corners those that have the others to one side follow each other.
    let is_edge = |a: usize, b: usize| {
        a != b && way(a, b) != [0.0; 3] && (0..4).filter(|c| *c != a && *c != b).all(|c| turn(a, b, c) >= 0.0)
    };
    let Some(start) = (0..4).find(|&a| (0..4).any(|b| is_edge(a, b))) else { return corners };
    let mut around = vec![start];
    while let Some(after) = (0..4).find(|&b| is_edge(around[around.len() - 1], b) && !around.contains(&b)) {
        around.push(after);
    }
    std::array::from_fn(|k| corners[around[k.min(around.len() - 1)]])
}

fn cross(a: Vector<f64>, b: Vector<f64>) -> Vector<f64> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The same corners the other way round.
pub(crate) fn reversed([a, b, c, d]: [Vector<f64>; 4]) -> [Vector<f64>; 4] {
    [b, a, d, c]
}

/// Thickness of facets along axes that the deck does not have, m: that of all of them, and as little as their edges.
pub fn facet_thickness(model: &Model) -> f64 {
    model.bodies.iter().map(|body| body.spacing).fold(f64::INFINITY, f64::min)
}

/// The facets of all particles by their numbers.
#[derive(Clone, Debug)]
pub struct ReferenceFacets {
    /// Of each particle the first.
    starts: Vec<u32>,
    facets: Vec<CellFacet>,
    /// Of each particle with facets what is beside its cell, and of every particle where that is.
    beside: Vec<Beside>,
    beside_of: Vec<u32>,
    /// Number of the first particle of each body.
    first: Vec<u32>,
    /// Edge of the cell of a particle, by body, m.
    edge: Vec<f64>,
}

impl ReferenceFacets {
    /// Of the particles that fill the bodies of a model.
    pub fn new(model: &Model) -> Self {
        let mut all = Self::empty(model.bodies.iter().map(|body| body.spacing).collect());
        let space = Space { dimensions: model.dimensions, symmetry: &model.symmetry, periodic: &model.periodic };
        let thickness = facet_thickness(model);
        for body in &model.bodies {
            all.add_body(&Near { space, pattern: pattern(model, body), shape: &body.shape, thickness });
        }
        all
    }

    /// Without any, of cells with that edge by body, m.
    fn empty(edge: Vec<f64>) -> Self {
        let (facets, beside, beside_of, first) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { starts: vec![0], facets, beside, beside_of, first, edge }
    }

    /// What is beside the cell of the particle with this number, if it has facets.
    pub fn beside(&self, id: u32) -> Option<&Beside> {
        self.beside.get(*self.beside_of.get(id as usize)? as usize)
    }

    /// Places of those of the particle with this number.
    pub fn range(&self, id: u32) -> std::ops::Range<usize> {
        let id = id as usize;
        let (Some(&from), Some(&to)) = (self.starts.get(id), self.starts.get(id + 1)) else { return 0..0 };
        from as usize..to as usize
    }

    /// The facet at a place.
    pub fn at(&self, place: usize) -> &CellFacet {
        &self.facets[place]
    }

    /// Number of the particles.
    pub(crate) fn particles(&self) -> u32 {
        self.starts.len() as u32 - 1
    }

    /// Index of the body of the particle with this number.
    pub(super) fn body_of(&self, id: u32) -> usize {
        self.first.partition_point(|first| *first <= id) - 1
    }

    /// Number of the facets.
    pub fn count(&self) -> usize {
        self.facets.len()
    }

    /// Those of the particle with this number that are exposed at the start.
    pub fn of(&self, id: u32) -> &[CellFacet] {
        &self.facets[self.range(id)]
    }

    /// Distance of the farthest corner of a facet of a body from its particle at the start, m; of cubes inside at least.
    pub(crate) fn farthest(&self, body: usize) -> f64 {
        let ids = self.first[body] as usize..self.first.get(body + 1).map_or(self.starts.len() - 1, |&id| id as usize);
        let facets = &self.facets[self.starts[ids.start] as usize..self.starts[ids.end] as usize];
        let arms = facets.iter().flat_map(|facet| facet.facet.corners);
        let of_cube = 0.75 * self.edge[body] * self.edge[body];
        arms.map(|arm| dot(arm, arm)).fold(of_cube, f64::max).sqrt()
    }

    pub(crate) fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.beside_of.capacity())
            + size_of::<CellFacet>() * self.facets.capacity()
            + size_of::<Beside>() * self.beside.capacity()
    }

    fn add_body(&mut self, near: &Near<'_>) {
        let Near { space, pattern, shape, .. } = near;
        let (first_facet, first_id) = (self.facets.len(), self.starts.len() - 1);
        let mut owners = Vec::new();
        self.first.push(self.starts.len() as u32 - 1);
        let mut sites = Sites::new(pattern.spacing);
        pattern.for_each_cell(shape, |site, _, _| {
            if near.surface(site, 3.0) {
                sites.add(site);
            }
        });
        pattern.for_each_cell(shape, |site, _, cell| {
            if near.surface(site, 2.0) {
                let exposed: [bool; FACES] = std::array::from_fn(|face| {
                    let across = cell.across(site, face, space.dimensions);
                    across.is_some_and(|place| !space.folded(place).iter().any(|place| sites.has(*place)))
                });
                let is_missing = |place| !space.folded(place).iter().any(|place| sites.has(*place));
                let first = self.facets.len();
                for face in (0..FACES).filter(|&face| exposed[face]) {
                    for part in 0..cell.parts(face) {
                        let of_cell = cell.face(site, (face, part), exposed, space.dimensions);
                        self.facets.extend(near.facet(site, &of_cell, &cell, is_missing));
                    }
                }
                find_free_edges(&mut self.facets[first..], pattern.spacing);
                if self.facets.len() > first {
                    let way = |side: usize| {
                        let there = cell.across(site, side, space.dimensions)?;
                        Some(std::array::from_fn(|a| there[a] - site[a]))
                    };
                    owners.push(Owner { site, ways: std::array::from_fn(way) });
                }
            }
            self.starts.push(self.facets.len() as u32);
        });
        let mut beside = beside::find(&owners, space, pattern.spacing).into_iter();
        let mut facets = self.facets[first_facet..].iter_mut();
        for ends in self.starts[first_id..].windows(2) {
            if ends[0] == ends[1] {
                self.beside_of.push(u32::MAX);
                continue;
            }
            let Some(beside) = beside.next() else { break };
            for facet in facets.by_ref().take((ends[1] - ends[0]) as usize) {
                facet.facet.across = beside::across(facet, &beside);
            }
            self.beside_of.push(self.beside.len() as u32);
            self.beside.push(beside);
        }
    }
}

/// Marks the edges of the facets of a cell at which another one of the cell begins that looks elsewhere.
fn find_free_edges(facets: &mut [CellFacet], spacing: f64) {
    let planes: Vec<(Vector<f64>, f64)> = facets.iter().map(|of| (of.facet.normal, of.facet.depth)).collect();
    for CellFacet { facet, .. } in facets {
        for k in 0..4 {
            let (from, to) = (facet.corners[k], facet.corners[(k + 1) % 4]);
            let middle = std::array::from_fn(|a| 0.5 * (from[a] + to[a]));
            let begins = |(normal, depth): &(Vector<f64>, f64)| {
                dot(*normal, facet.normal) < ELSEWHERE && (dot(middle, *normal) - depth).abs() < BESIDE * spacing
            };
            facet.free[k] = f64::from(u8::from(from != to && planes.iter().any(begins)));
        }
    }
}

/// What lies around the bodies.
#[derive(Clone, Copy)]
struct Space<'a> {
    dimensions: Dimensions,
    symmetry: &'a [SymmetryPlane],
    periodic: &'a [Option<(f64, f64)>; 3],
}

impl Space<'_> {
    /// A point, and where it is seen from within the model: its images in symmetry planes and periodic ends that it
    /// is beyond.
    fn folded(&self, mut point: Vector<f64>) -> [Vector<f64>; 2] {
        let given = point;
        for plane in self.symmetry {
            let beyond = (point[plane.axis] - plane.position) * plane.side;
            if beyond < 0.0 {
                point[plane.axis] = 2.0 * plane.position - point[plane.axis];
            }
        }
        for (x, cell) in point.iter_mut().zip(self.periodic) {
            if let Some((low, high)) = *cell {
                *x = low + (*x - low).rem_euclid(high - low);
            }
        }
        [given, point]
    }

    /// The second of these, and the signs of the axes along which it is mirrored.
    fn folded_with_signs(&self, given: Vector<f64>) -> (Vector<f64>, Vector<f64>) {
        let mut sign = [1.0; 3];
        for plane in self.symmetry.iter().filter(|plane| (given[plane.axis] - plane.position) * plane.side < 0.0) {
            sign[plane.axis] = -sign[plane.axis];
        }
        (self.folded(given)[1], sign)
    }
}

/// Sites of a body near its surface, sorted into cells of space.
struct Sites {
    reach: f64,
    cells: HashMap<[i64; 3], Vec<Vector<f64>>>,
}

impl Sites {
    fn new(spacing: f64) -> Self {
        Self { reach: COVERED * spacing, cells: HashMap::new() }
    }

    fn cell(&self, place: Vector<f64>) -> [i64; 3] {
        place.map(|c| (c / self.reach).floor() as i64)
    }

    fn add(&mut self, site: Vector<f64>) {
        self.cells.entry(self.cell(site)).or_default().push(site);
    }

    /// Whether a site is within reach of a place.
    fn has(&self, place: Vector<f64>) -> bool {
        let [x, y, z] = self.cell(place);
        let around = (-1..=1).flat_map(|a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [x + a, y + b, z + c])));
        let is_near =
            |site: &Vector<f64>| (0..3).map(|k| (site[k] - place[k]).powi(2)).sum::<f64>() < self.reach * self.reach;
        around.filter_map(|cell| self.cells.get(&cell)).flatten().any(is_near)
    }
}

/// The surface of a body.
struct Near<'a> {
    space: Space<'a>,
    pattern: Pattern,
    shape: &'a Shape,
    /// Thickness of facets along axes that the deck does not have, m.
    thickness: f64,
}

impl Near<'_> {
    /// How far the faces of its particles are outside the shape, m.
    fn level(&self) -> f64 {
        match self.pattern.lattice.placement {
            LatticePlacement::CellCentres => 0.0,
            LatticePlacement::OnFaces => 0.5 * self.pattern.spacing,
        }
    }

    /// Whether a particle is within so many spacings of the surface.
    fn surface(&self, site: Vector<f64>, spacings: f64) -> bool {
        let is_cloud = matches!(self.shape.solid, Solid::Cloud { .. });
        is_cloud || self.shape.signed_distance(site, self.space.dimensions) > -spacings * self.pattern.spacing
    }

    fn is_on_surface(&self, place: Vector<f64>) -> bool {
        let distance = self.shape.signed_distance(place, self.space.dimensions);
        distance.abs() < ON_SURFACE * self.pattern.spacing
    }

    /// The surface that a face of a cell belongs to, by its place among those of the shape: the nearest it looks to.
    fn surface_of(&self, face: &CellFace, places: &Places) -> Option<usize> {
        let distance = |place: &Place| (0..3).map(|k| (place.closest[k] - face.middle[k]).powi(2)).sum::<f64>().sqrt();
        let is_possible = |place: &Place| {
            dot(place.normal, face.outward) > FACING
                && distance(place) < FARTHEST * self.pattern.spacing + self.level()
                && self.is_on_surface(place.closest)
        };
        let possible = places.iter().enumerate().filter(|(_, place)| is_possible(place));
        possible.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1))).map(|(k, _)| k)
    }

    fn surfaces(&self, point: Vector<f64>) -> Places {
        self.shape.surfaces(point, self.space.dimensions, self.pattern.spacing)
    }

    /// From a corner of a face of a cell, along the face, to where the body has no particles; zero in the middle of a face.
    fn open(
        &self,
        site: Vector<f64>,
        face: &CellFace,
        corner: usize,
        cell: &Cell,
        is_missing: impl Fn(Vector<f64>) -> bool,
    ) -> Vector<f64> {
        let mut open = [0.0; 3];
        let mut beside = [site; 2];
        let mut count = 0;
        let from_middle = |p: Vector<f64>| -> Vector<f64> { std::array::from_fn(|k| p[k] - face.middle[k]) };
        for other in (0..FACES).filter(|other| other / 2 != usize::from(face.number) / 2) {
            let Some(across) = cell.across(site, other, self.space.dimensions) else { continue };
            let towards: Vector<f64> = std::array::from_fn(|k| across[k] - site[k]);
            if dot(towards, from_middle(face.corners[corner])) <= 0.0 {
                continue;
            }
            beside[count.min(1)] = across;
            count += 1;
            if is_missing(across) {
                (0..3).for_each(|k| open[k] += towards[k]);
            }
        }
        // The cell across the corner alone.
        let diagonal: Vector<f64> = std::array::from_fn(|k| beside[0][k] + beside[1][k] - site[k]);
        if count == 2 && open == [0.0; 3] && is_missing(diagonal) {
            open = std::array::from_fn(|k| diagonal[k] - site[k]);
        }
        open
    }

    /// The same corner where the surface of its face meets the one that the body ends at towards `open`.
    fn on_edge(&self, corner: Vector<f64>, surface: usize, open: Vector<f64>) -> Vector<f64> {
        let mut corner = corner;
        // A few turns for surfaces that are not at right angles.
        for _ in 0..4 {
            let places = self.surfaces(corner);
            let Some(own) = places.get(surface).copied() else { return corner };
            let distance = |place: &Place| (0..3).map(|k| (place.closest[k] - corner[k]).powi(2)).sum::<f64>().sqrt();
            let is_met = |place: &Place| {
                dot(place.normal, open) > FACING * dot(open, open).sqrt()
                    && dot(place.normal, own.normal) < ONE_SURFACE
                    && distance(place) < FARTHEST * self.pattern.spacing
            };
            let others = places.iter().enumerate().filter(|(k, place)| *k != surface && is_met(place));
            let nearest = others.map(|(_, place)| place).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(other) = nearest else { return corner };
            let places = self.surfaces(other.closest);
            corner = places.get(surface).map_or(other.closest, |own| own.closest);
        }
        corner
    }

    /// A corner of a face on its surface, and within the others.
    fn corner(&self, corner: Vector<f64>, surface: usize) -> Vector<f64> {
        let level = self.level();
        let raised = |place: &Place| std::array::from_fn(|k| place.closest[k] + level * place.normal[k]);
        let places = self.surfaces(corner);
        let Some(own) = places.get(surface) else { return corner };
        // A plane that is raised with its whole body keeps its extent.
        if level > 0.0 && own.curvature.as_flattened().iter().all(|c| *c == 0.0) {
            return corner;
        }
        if self.shape.signed_distance(own.closest, self.space.dimensions) <= ON_SURFACE * self.pattern.spacing {
            return raised(own);
        }
        // It juts out beyond an edge.
        let again = self.surfaces(own.closest);
        let distance = |place: &Place| (0..3).map(|k| (place.closest[k] - own.closest[k]).powi(2)).sum::<f64>();
        let on_body = again.iter().filter(|place| self.is_on_surface(place.closest));
        on_body.min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or_else(|| raised(own), raised)
    }

    /// The facet of a face of a cell.
    fn facet(
        &self,
        site: Vector<f64>,
        face: &CellFace,
        cell: &Cell,
        is_missing: impl Fn(Vector<f64>) -> bool,
    ) -> Option<CellFacet> {
        let places = self.surfaces(face.middle);
        let surface = self.surface_of(face, &places);
        let arm = |p: Vector<f64>| -> Vector<f64> { std::array::from_fn(|k| p[k] - site[k]) };
        let corner = |(k, corner): (usize, &Vector<f64>)| {
            let Some(surface) = surface else { return arm(*corner) };
            let placed = self.corner(*corner, surface);
            let open = self.open(site, face, k, cell, &is_missing);
            arm(if open == [0.0; 3] || self.level() > 0.0 { placed } else { self.on_edge(placed, surface, open) })
        };
        let corners = face.corners.iter().enumerate().map(corner).collect();
        let flat = [[0.0; 3]; 3];
        let facet = match surface.map(|surface| &places[surface]) {
            None => CellFacet::new(face.number, corners, arm(face.middle), face.outward, flat, self.thickness),
            Some(place) => {
                let level = self.level();
                let middle = std::array::from_fn(|k| place.closest[k] + level * place.normal[k]);
                CellFacet::new(face.number, corners, arm(middle), place.normal, place.curvature, self.thickness)
            }
        };
        let count = self.space.dimensions.count() as i32;
        let cube = self.pattern.spacing.powi(count - 1) * self.thickness.powi(3 - count);
        (facet.facet.area() > SMALLEST * cube).then_some(facet)
    }
}

mod beside;

pub use beside::Beside;

#[cfg(test)]
mod tests;
