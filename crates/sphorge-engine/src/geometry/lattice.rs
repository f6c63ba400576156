//! Square, cubic and hexagonal lattices in the frame of a solid.
//!
//! A lattice is anchored to its solid and turns with it, so a symmetric solid gets a symmetric lattice. Between faces (edges
//! of a box, the ends of a cylinder) the number of cells is the length over the pitch, rounded; the lattice is centred, so an
//! edge that is no multiple is over- or underfilled by less than a quarter of a pitch at either end. Across an axis and about
//! a centre a square lattice has a cell corner there (particles at cell centres) or a particle (particles on faces), a
//! hexagonal one a particle; particles whose centre is inside are kept.
//!
//! In a hexagonal lattice rows are shifted by half their pitch against their neighbours, in space every second layer too
//! (hexagonal close-packed, layers across the third axis). Its pitch is such that a particle stands for as much area or
//! volume as in a square or cubic one.

use super::cell::Cell;
use super::shape::{about_axis, arc_radius, dot, radius_at, subtract};
use crate::model::{Arrangement, Dimensions, Lattice, LatticePlacement, Solid};

/// A particle this much (over the spacing) outside a round surface still counts as on it.
pub(super) const ROUNDING: f64 = 1e-9;

/// More sites along one axis than can be run anyway.
const MOST_SITES: f64 = 1e15;

/// Sites along one axis of a lattice: `(k - (count - 1)/2) pitch`, exactly symmetric about its middle.
#[derive(Clone, Copy, Debug)]
struct Line {
    count: i64,
    pitch: f64,
    /// Ends at faces rather than at a round surface.
    between_faces: bool,
    /// Distance of the faces from the middle, m, if it ends at some.
    half_length: f64,
}

impl Line {
    fn along(length: f64, pitch: f64, placement: LatticePlacement) -> Self {
        let cells = (length / pitch).round().clamp(1.0, MOST_SITES) as i64;
        let count = match placement {
            LatticePlacement::CellCentres => cells,
            LatticePlacement::OnFaces => cells + 1,
        };
        let beyond = match placement {
            LatticePlacement::CellCentres => 0.0,
            // Particles on a face reach half a pitch beyond it.
            LatticePlacement::OnFaces => 0.5 * pitch,
        };
        Self { count, pitch, between_faces: true, half_length: 0.5 * length + beyond }
    }

    /// Sites within `radius` of the middle.
    fn across(radius: f64, pitch: f64, placement: LatticePlacement) -> Self {
        let reach = (radius / pitch + ROUNDING).min(MOST_SITES);
        let count = match placement {
            LatticePlacement::CellCentres => 2 * (reach + 0.5).floor() as i64,
            LatticePlacement::OnFaces => 2 * reach.floor() as i64 + 1,
        };
        Self { count, pitch, between_faces: false, half_length: 0.0 }
    }

    fn one() -> Self {
        Self { count: 1, pitch: 1.0, between_faces: false, half_length: 0.0 }
    }

    fn site(&self, k: i64) -> f64 {
        (k as f64 - (self.count as f64 - 1.0) / 2.0) * self.pitch
    }

    /// Distances of site `k`, `offset` (m) from the middle, from the faces below and above, m, if it is next to them.
    fn ends(&self, k: i64, offset: f64) -> [Option<f64>; 2] {
        let is_last = |last: i64| self.between_faces && k == last;
        let (low, high) = (self.half_length + offset, self.half_length - offset);
        [is_last(0).then_some(low), is_last(self.count - 1).then_some(high)]
    }

    /// Steps from the middle site.
    fn step(&self, k: i64) -> i64 {
        k - (self.count - 1) / 2
    }

    /// Sites from the lowest to one past the highest that can lie between `low` and `high`, m, or belong to a face there: those of a solid
    /// lie up to half a pitch beyond its faces, and as far again in a shifted row.
    fn between(&self, low: f64, high: f64) -> (i64, i64) {
        let half = (self.count as f64 - 1.0) / 2.0;
        let (first, last) = ((low / self.pitch + half).floor() as i64, (high / self.pitch + half).ceil() as i64);
        (first.saturating_sub(2), last.saturating_add(3))
    }
}

/// The least and the largest of some numbers.
pub(super) fn extremes(numbers: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    numbers.map(|x| (x, x)).reduce(|(low, high), (x, _)| (low.min(x), high.max(x)))
}

/// A right-handed frame whose third vector is the unit vector along `axis`; along a coordinate axis it is made of coordinate
/// axes, so that the lattice lines up with others.
pub(super) fn frame(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let length = dot(axis, axis).sqrt();
    let w = axis.map(|c| c / length);
    // The coordinate axis least along w, and the one after it, span the section best.
    let least = (0..3).min_by(|&a, &b| w[a].abs().total_cmp(&w[b].abs())).unwrap_or(0);
    let mut u = [0.0; 3];
    u[least] = 1.0;
    let along = dot(u, w);
    u = std::array::from_fn(|k| u[k] - along * w[k]);
    let norm = dot(u, u).sqrt();
    u = u.map(|c| c / norm);
    let v = [w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]];
    [u, v, w]
}

/// The lattice of one solid, which goes on beyond it.
#[derive(Clone, Debug)]
pub(super) struct Grid<'a> {
    solid: &'a Solid,
    dimensions: Dimensions,
    spacing: f64,
    centre: [f64; 3],
    frame: [[f64; 3]; 3],
    lines: [Line; 3],
    is_hexagonal: bool,
}

impl<'a> Grid<'a> {
    /// The lattice of a solid that is not composed.
    pub(super) fn new(solid: &'a Solid, dimensions: Dimensions, spacing: f64, lattice: Lattice) -> Self {
        let count = dimensions.count();
        let is_hexagonal = lattice.arrangement == Arrangement::Hexagonal && count > 1;
        let pitch = if is_hexagonal { hexagonal_pitch(dimensions, spacing) } else { [spacing; 3] };
        // A row of a hexagonal lattice may be shifted into the solid: one site more either side.
        let across = |axis: usize, radius: f64| match is_hexagonal {
            true => Line::across(radius + pitch[axis], pitch[axis], LatticePlacement::OnFaces),
            false => Line::across(radius, pitch[axis], lattice.placement),
        };
        let along = |axis: usize, length: f64| Line::along(length, pitch[axis], lattice.placement);
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let used = |lines: [Line; 3]| std::array::from_fn(|k| if k < count { lines[k] } else { Line::one() });
        let round = |from: [f64; 3], to: [f64; 3], radius: f64| {
            let axis = subtract(to, from);
            let length = dot(axis, axis).sqrt();
            let centre = std::array::from_fn(|k| 0.5 * (from[k] + to[k]));
            match dimensions {
                Dimensions::Three => (centre, frame(axis), [across(0, radius), across(1, radius), along(2, length)]),
                // In the plane the axis comes first.
                _ => {
                    let u = axis.map(|c| c / length);
                    let frame = [u, [-u[1], u[0], 0.0], [0.0, 0.0, 1.0]];
                    (centre, frame, used([along(0, length), across(1, radius), Line::one()]))
                }
            }
        };
        let (centre, frame, lines) = match solid {
            Solid::Ball { centre, radius, .. } => {
                let centre = std::array::from_fn(|k| if k < count { centre[k] } else { 0.0 });
                (centre, unit, used([0, 1, 2].map(|k| across(k, *radius))))
            }
            Solid::Cylinder { from, to, radius, .. } | Solid::Ogive { from, to, radius, .. } => {
                round(*from, *to, *radius)
            }
            Solid::Revolution { from, axis, profile } => {
                let end = |x: f64| std::array::from_fn(|k| from[k] + x * axis[k]);
                let radius = profile.iter().map(|p| p[1]).fold(0.0, f64::max);
                round(end(profile[0][0]), end(profile[profile.len() - 1][0]), radius)
            }
            Solid::Box { .. } | Solid::Polygon { .. } | Solid::Cloud { .. } | Solid::Composed { .. } => {
                let (min, max) = solid.bounds(dimensions);
                let centre = std::array::from_fn(|k| if k < count { 0.5 * (min[k] + max[k]) } else { 0.0 });
                (centre, unit, used([0, 1, 2].map(|k| along(k, max[k] - min[k]))))
            }
        };
        Self { solid, dimensions, spacing, centre, frame, lines, is_hexagonal }
    }

    /// Place of a site in the axes of the lattice, from its centre.
    fn offset(&self, [i, j, k]: [i64; 3]) -> [f64; 3] {
        let mut offset = [self.lines[0].site(i), self.lines[1].site(j), self.lines[2].site(k)];
        if self.is_hexagonal {
            let is_space = self.dimensions == Dimensions::Three;
            let row = self.lines[1].step(j).rem_euclid(2);
            let layer = if is_space { self.lines[2].step(k).rem_euclid(2) } else { 0 };
            let shift = |odd: i64, line: &Line, by: f64| {
                // Between faces either kind of row is as far from the middle.
                by * (odd as f64 - if line.between_faces { 0.5 } else { 0.0 }) * line.pitch
            };
            offset[0] += shift((row + layer) % 2, &self.lines[0], 0.5);
            if is_space {
                offset[1] += shift(layer, &self.lines[1], 1.0 / 3.0);
            }
        }
        offset
    }

    fn point(&self, offset: [f64; 3]) -> [f64; 3] {
        let [u, v, w] = &self.frame;
        let [a, b, c] = offset;
        std::array::from_fn(|k| self.centre[k] + a * u[k] + b * v[k] + c * w[k])
    }

    /// Whether the solid keeps a site of its own lattice.
    fn keeps(&self, index: [i64; 3], offset: [f64; 3], point: [f64; 3]) -> bool {
        if (0..3).any(|a| self.lines[a].between_faces && !(0..self.lines[a].count).contains(&index[a])) {
            return false;
        }
        let rounding = ROUNDING * self.spacing;
        let ring = |squared: f64, inner: f64, outer: f64| {
            squared <= (outer + rounding).powi(2) && (inner == 0.0 || squared >= (inner - rounding).powi(2))
        };
        match self.solid {
            Solid::Box { .. } => true,
            Solid::Ball { radius, inner_radius, .. } => ring(dot(offset, offset), *inner_radius, *radius),
            Solid::Cylinder { radius, inner_radius, .. } => {
                ring(offset[0] * offset[0] + offset[1] * offset[1], *inner_radius, *radius)
            }
            // The outermost sites along the axis may lie a little beyond the ends.
            Solid::Revolution { from, axis, profile } => {
                let (x, r) = about_axis(point, *from, *axis);
                r <= radius_at(profile, x.clamp(profile[0][0], profile[profile.len() - 1][0])) + rounding
            }
            Solid::Ogive { from, to, radius, nose_length } => {
                let axis = subtract(*to, *from);
                let length = dot(axis, axis).sqrt();
                let (x, r) = about_axis(point, *from, axis.map(|c| c / length));
                let nose = x.min(length) - (length - nose_length);
                let arc = arc_radius(*radius, *nose_length);
                let surface =
                    if nose <= 0.0 { *radius } else { (arc * arc - nose * nose).max(0.0).sqrt() - arc + radius };
                r <= surface + rounding
            }
            Solid::Polygon { .. } | Solid::Cloud { .. } | Solid::Composed { .. } => {
                self.solid.signed_distance(point, self.dimensions) <= rounding
            }
        }
    }

    /// Calls `visit` with every site that could be in a box with these corners, or with the solid's own if there are none; says whether it
    /// belongs to the solid, and its cell.
    pub(super) fn for_each_site(&self, corners: &[[f64; 3]], mut visit: impl FnMut([f64; 3], bool, Cell)) {
        let [x, y, z]: [(i64, i64); 3] = std::array::from_fn(|a| {
            if a >= self.dimensions.count() {
                return (0, 1);
            }
            let along = corners.iter().map(|&c| dot(subtract(c, self.centre), self.frame[a]));
            extremes(along).map_or((0, self.lines[a].count), |(low, high)| self.lines[a].between(low, high))
        });
        for k in z.0..z.1 {
            for j in y.0..y.1 {
                for i in x.0..x.1 {
                    let offset = self.offset([i, j, k]);
                    let point = self.point(offset);
                    let index = [i, j, k];
                    let ends = std::array::from_fn(|a| self.lines[a].ends(index[a], offset[a]));
                    let cell = Cell::Brick { frame: self.frame, pitch: self.lines.map(|line| line.pitch), ends };
                    visit(point, self.keeps(index, offset, point), cell);
                }
            }
        }
    }

    /// Number of sites that are gone through.
    pub(super) fn sites(&self) -> f64 {
        self.lines.iter().map(|line| line.count as f64).product()
    }

    /// Number of sites of a box or of a bar of this cross-section: exact between faces.
    pub(super) fn estimate(&self, volume: f64) -> f64 {
        let count = self.dimensions.count();
        match self.solid {
            Solid::Box { .. } => self.lines[..count].iter().map(|line| line.count as f64).product(),
            Solid::Cylinder { from, to, .. } => {
                let axis = subtract(*to, *from);
                let section = volume / dot(axis, axis).sqrt();
                let [a, b, c] = self.lines;
                section / (a.pitch * b.pitch) * c.count as f64
            }
            _ => volume / self.spacing.powi(count as i32),
        }
    }
}

/// Distance of sites in a row, of rows, of layers, in which a particle stands for `spacing` squared or cubed.
pub(super) fn hexagonal_pitch(dimensions: Dimensions, spacing: f64) -> [f64; 3] {
    let root = |x: f64| x.sqrt();
    if dimensions == Dimensions::Three {
        // A particle stands for a^3 / sqrt(2).
        let a = spacing * 2f64.powf(1.0 / 6.0);
        return [a, a * root(3.0) / 2.0, a * root(2.0 / 3.0)];
    }
    // A particle stands for a^2 sqrt(3) / 2.
    let a = spacing * root(2.0 / root(3.0));
    [a, a * root(3.0) / 2.0, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use LatticePlacement::{CellCentres, OnFaces};

    fn lattice(arrangement: Arrangement, placement: LatticePlacement) -> Lattice {
        Lattice { arrangement, placement }
    }

    fn of(solid: &Solid, dimensions: Dimensions, spacing: f64, lattice: Lattice) -> Vec<[f64; 3]> {
        let mut all = Vec::new();
        Grid::new(solid, dimensions, spacing, lattice)
            .for_each_site(&[], |site, kept, _| all.extend(kept.then_some(site)));
        all
    }

    fn sites(solid: &Solid, dimensions: Dimensions, spacing: f64, placement: LatticePlacement) -> Vec<[f64; 3]> {
        of(solid, dimensions, spacing, lattice(Arrangement::Square, placement))
    }

    fn hexagonal(solid: &Solid, dimensions: Dimensions, spacing: f64) -> Vec<[f64; 3]> {
        of(solid, dimensions, spacing, lattice(Arrangement::Hexagonal, CellCentres))
    }

    /// Distance to the nearest other site, and how many are there.
    fn neighbors(all: &[[f64; 3]], i: usize) -> (f64, usize) {
        let distance = |p: &[f64; 3]| dot(subtract(*p, all[i]), subtract(*p, all[i])).sqrt();
        let others = || all.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, p)| distance(p));
        let nearest = others().fold(f64::INFINITY, f64::min);
        (nearest, others().filter(|d| *d < nearest * (1.0 + 1e-6)).count())
    }

    fn nearest_to(all: &[[f64; 3]], point: [f64; 3]) -> usize {
        let squared = |p: &[f64; 3]| dot(subtract(*p, point), subtract(*p, point));
        (0..all.len()).min_by(|&a, &b| squared(&all[a]).total_cmp(&squared(&all[b]))).unwrap()
    }

    #[test]
    fn hexagonal_lattices_have_six_and_twelve_neighbors_at_one_distance() {
        let plate = Solid::Box { min: [0.0; 3], max: [2.0, 1.0, 0.0] };
        let all = hexagonal(&plate, Dimensions::PlaneStrain, 0.1);
        let (distance, count) = neighbors(&all, nearest_to(&all, [1.0, 0.5, 0.0]));
        assert!((distance - 0.1 * (2.0 / 3f64.sqrt()).sqrt()).abs() < 1e-12 && count == 6);
        // 18.6 sites in a row and 10.7 rows, rounded; rows of either kind are centred between the faces.
        assert_eq!(all.len(), 19 * 11);
        let (low, high) = all.iter().fold((2.0f64, 0.0f64), |(a, b), p| (a.min(p[0]), b.max(p[0])));
        assert!((low + high - 2.0).abs() < 1e-12);
        let block = Solid::Box { min: [0.0; 3], max: [1.0; 3] };
        let all = hexagonal(&block, Dimensions::Three, 0.1);
        let (distance, count) = neighbors(&all, nearest_to(&all, [0.5; 3]));
        assert!((distance - 0.1 * 2f64.powf(1.0 / 6.0)).abs() < 1e-12 && count == 12);
        assert_eq!(all.len(), 9 * 10 * 11);
    }

    #[test]
    fn a_hexagonal_disc_has_sixfold_symmetry() {
        let disc = Solid::Ball { centre: [0.0; 3], radius: 1.0, inner_radius: 0.0 };
        let all = hexagonal(&disc, Dimensions::PlaneStrain, 0.1);
        assert!((all.len() as f64 / 314.159 - 1.0).abs() < 0.02);
        let (s, c) = (60f64.to_radians().sin(), 0.5);
        for p in &all {
            let turned = [c * p[0] - s * p[1], s * p[0] + c * p[1], 0.0];
            let found = all[nearest_to(&all, turned)];
            assert!(dot(subtract(found, turned), subtract(found, turned)) < 1e-20);
        }
    }

    #[test]
    fn bars_of_revolution_are_filled_up_to_their_profile() {
        let profile = vec![[0.0, 1.0], [2.0, 1.0], [4.0, 0.5]];
        let bar = Solid::Revolution { from: [0.0; 3], axis: [1.0, 0.0, 0.0], profile };
        let all = sites(&bar, Dimensions::Three, 0.1, CellCentres);
        let volume = std::f64::consts::PI * (2.0 + 2.0 / 3.0 * (1.0 + 0.5 + 0.25));
        assert!((all.len() as f64 * 1e-3 / volume - 1.0).abs() < 0.02);
        // In the plane: the profile and its mirror image, each mirror site exact.
        let all = sites(&bar, Dimensions::PlaneStrain, 0.1, CellCentres);
        assert!((all.len() as f64 * 0.01 / 7.0 - 1.0).abs() < 0.02);
        assert!(all.iter().all(|p| all.contains(&[p[0], -p[1], 0.0])));
        let bullet = Solid::Ogive { from: [0.0; 3], to: [4.0, 0.0, 0.0], radius: 0.5, nose_length: 1.0 };
        let all = sites(&bullet, Dimensions::PlaneStrain, 0.05, OnFaces);
        // The tip is a particle, and beside it nothing.
        assert!(all.iter().any(|p| (p[0] - 4.0).abs() < 1e-12 && p[1] == 0.0));
        assert_eq!(all.iter().filter(|p| p[0] > 3.99).count(), 1);
    }

    #[test]
    fn an_edge_that_is_no_multiple_is_rounded_and_centred() {
        // 25.46 mm x 7.6 mm at 0.3 mm: 84.87 and 25.33 cells.
        let plate = Solid::Box { min: [-3.8e-3, 0.0, 0.0], max: [3.8e-3, 25.46e-3, 0.0] };
        let all = sites(&plate, Dimensions::PlaneStrain, 0.3e-3, CellCentres);
        assert_eq!(all.len(), 25 * 85);
        let lowest = all.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
        assert!((lowest - (25.46e-3 / 2.0 - 42.0 * 0.3e-3)).abs() < 1e-15);
        // Mirror images are exact.
        let xs: Vec<f64> = all.iter().map(|p| p[0]).collect();
        assert!(xs.iter().all(|x| xs.contains(&-x)));
    }

    #[test]
    fn on_faces_puts_particles_on_both_ends() {
        // Fraser's plate at 6 mm: 251 x 126 x 6 particles, the last along 30 mm from face to face.
        let plate = Solid::Box { min: [0.0; 3], max: [1.5, 0.75, 0.03] };
        let grid = Grid::new(&plate, Dimensions::Three, 6e-3, lattice(Arrangement::Square, OnFaces));
        assert_eq!(grid.estimate(0.0), 251.0 * 126.0 * 6.0);
        let line = Solid::Box { min: [1.0, 0.0, 0.0], max: [2.0, 0.0, 0.0] };
        let all = sites(&line, Dimensions::One, 0.25, OnFaces);
        assert_eq!(all.iter().map(|p| p[0]).collect::<Vec<_>>(), [1.0, 1.25, 1.5, 1.75, 2.0]);
    }

    #[test]
    fn round_solids_are_symmetric_about_a_cell_corner_or_a_particle() {
        let disc = Solid::Ball { centre: [0.0; 3], radius: 1.0, inner_radius: 0.0 };
        assert_eq!(sites(&disc, Dimensions::PlaneStrain, 1.0, CellCentres).len(), 4);
        assert_eq!(sites(&disc, Dimensions::PlaneStrain, 1.0, OnFaces).len(), 5);
        let all = sites(&disc, Dimensions::PlaneStrain, 0.1, CellCentres);
        assert!(all.iter().all(|p| all.contains(&[-p[0], p[1], 0.0]) && all.contains(&[p[1], p[0], 0.0])));
        assert!((all.len() as f64 / 314.159 - 1.0).abs() < 0.02);
        let sphere = Solid::Ball { centre: [5.0, 0.0, 0.0], radius: 1.0, inner_radius: 0.0 };
        let count = sites(&sphere, Dimensions::Three, 0.1, CellCentres).len() as f64;
        assert!((count / 4188.79 - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_cylinder_along_any_axis_has_the_same_lattice() {
        let z = Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 1.0], radius: 0.35, inner_radius: 0.0 };
        let y = Solid::Cylinder { from: [0.0; 3], to: [0.0, 1.0, 0.0], radius: 0.35, inner_radius: 0.0 };
        let skew = Solid::Cylinder { from: [0.0; 3], to: [0.6, 0.8, 0.0], radius: 0.35, inner_radius: 0.0 };
        let along_z = sites(&z, Dimensions::Three, 0.1, CellCentres);
        let along_y = sites(&y, Dimensions::Three, 0.1, CellCentres);
        assert_eq!(along_z.len(), along_y.len());
        assert_eq!(along_z.len(), sites(&skew, Dimensions::Three, 0.1, CellCentres).len());
        // Sections along coordinate axes are made of coordinate planes.
        let lowest = along_y.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
        assert!((lowest - 0.05).abs() < 1e-12);
        assert!(along_y.iter().all(|p| ((p[0] / 0.1).abs().fract() - 0.5).abs() < 1e-9));
    }
}
