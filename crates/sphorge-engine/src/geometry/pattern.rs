//! The particles of a shape: its lattice, or rings.
//!
//! Composed shapes carry on the lattice of their first part, so that a plate with a hole has the lattice of the plate and a
//! head on a bar that of the bar. A particle exactly on the surface of a further part belongs to a union and stays in a
//! difference.

use super::{
    cell::Cell,
    lattice::{Grid, ROUNDING},
    rings,
};
use crate::model::{Arrangement, CloudShare, Dimensions, Lattice, Operation, Shape, Solid, Transform};

/// How the particles of a body are arranged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pattern {
    pub(super) dimensions: Dimensions,
    pub(super) spacing: f64,
    /// kg/m³.
    pub(super) density: f64,
    pub(super) lattice: Lattice,
}

/// Share of the sites gone through that counts as kept at least.
const LEAST_KEPT: f64 = 0.02;

impl Transform {
    /// The axes of the solid in space.
    fn axes(&self) -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| self.turn(axis))
    }

    /// This one after `first`.
    fn after(&self, first: &Self) -> Self {
        let rotation = std::array::from_fn(|a| {
            std::array::from_fn(|b| (0..3).map(|k| self.rotation[a][k] * first.rotation[k][b]).sum())
        });
        Self { rotation, translation: self.apply(first.translation) }
    }
}

/// The single solid the lattice is that of, and its place in space.
pub(super) fn owner(shape: &Shape) -> (&Solid, Transform) {
    match &shape.solid {
        Solid::Composed { parts, .. } if !parts.is_empty() => {
            let (solid, inner) = owner(&parts[0]);
            (solid, shape.transform.after(&inner))
        }
        solid => (solid, shape.transform),
    }
}

/// Whether rings can fill a shape: they have no lattice that goes on into a further part of a union.
pub fn rings_fill(shape: &Shape, dimensions: Dimensions) -> bool {
    match &shape.solid {
        Solid::Composed { operation: Operation::Union, parts } if parts.len() > 1 => false,
        Solid::Composed { parts, .. } => parts.first().is_some_and(|part| rings_fill(part, dimensions)),
        solid => rings::can_fill(solid, dimensions),
    }
}

impl Pattern {
    /// Calls `visit` with place in space and volume (area, length) of every particle of a shape.
    pub(super) fn for_each_site(&self, shape: &Shape, mut visit: impl FnMut([f64; 3], f64)) {
        self.for_each_cell(shape, |place, volume, _| visit(place, volume));
    }

    /// The same with its cell in space. Particles from a file have cubes of their volume.
    pub(super) fn for_each_cell(&self, shape: &Shape, mut visit: impl FnMut([f64; 3], f64, Cell)) {
        let cell = self.spacing.powi(self.dimensions.count() as i32);
        if let Solid::Cloud { particles, .. } = &shape.solid {
            for particle in particles.iter() {
                let volume = match particle.share {
                    CloudShare::Spacing => cell,
                    CloudShare::Volume(volume) => volume,
                    CloudShare::Mass(mass) => mass / self.density,
                };
                let edge = volume.powf(1.0 / self.dimensions.count() as f64);
                let cube = Cell::cube(shape.transform.axes(), edge);
                visit(shape.transform.apply(particle.position), volume, cube);
            }
            return;
        }
        let (solid, transform) = owner(shape);
        if self.lattice.arrangement == Arrangement::Rings && rings::can_fill(solid, self.dimensions) {
            rings::for_each_cell(solid, self.spacing, &self.corners(shape), |site, volume, cell| {
                let place = transform.apply(site);
                if self.keeps(shape, place, true) {
                    visit(place, volume, cell.placed(&transform));
                }
            });
            return;
        }
        let grid = Grid::new(solid, self.dimensions, self.spacing, self.lattice);
        grid.for_each_site(&self.corners(shape), |site, own, of_site| {
            let place = transform.apply(site);
            if self.keeps(shape, place, own) {
                visit(place, cell, of_site.placed(&transform));
            }
        });
    }

    /// Corners of a box about a composed shape, in the frame of the owner of its lattice; none for a single solid, which needs no more than
    /// its own sites.
    fn corners(&self, shape: &Shape) -> Vec<[f64; 3]> {
        let Solid::Composed { .. } = &shape.solid else { return Vec::new() };
        let (low, high) = shape.bounds(self.dimensions);
        let corner = |k: usize| std::array::from_fn(|a| if k >> a & 1 == 0 { low[a] } else { high[a] });
        let (_, transform) = owner(shape);
        (0..8).map(|k| transform.apply_inverse(corner(k))).collect()
    }

    /// Whether a shape keeps a site at a point outside it, given whether the owner of the lattice keeps it.
    fn keeps(&self, shape: &Shape, point: [f64; 3], own: bool) -> bool {
        let Solid::Composed { operation, parts } = &shape.solid else { return own };
        let local = shape.transform.apply_inverse(point);
        let Some((first, others)) = parts.split_first() else { return false };
        let rounding = ROUNDING * self.spacing;
        let first = self.keeps(first, local, own);
        let in_another = |tolerance| parts.distance_of_others(local, self.dimensions, tolerance) <= tolerance;
        match operation {
            Operation::Union => first || in_another(rounding),
            Operation::Intersection => {
                first && others.iter().all(|part| part.contains(local, self.dimensions, rounding))
            }
            Operation::Difference => first && !in_another(-rounding),
        }
    }

    /// Number of particles a shape will take, without making them: exact for boxes, from the volume for others; no less than what
    /// going through the lattice is worth.
    pub(super) fn estimate(&self, shape: &Shape) -> f64 {
        if let Solid::Cloud { particles, .. } = &shape.solid {
            return particles.len() as f64;
        }
        let volume = shape.rough_volume(self.dimensions);
        match (&shape.solid, self.lattice.arrangement) {
            // Little may be left of a large lattice, but all of it is gone through.
            (Solid::Composed { .. } | Solid::Polygon { .. }, Arrangement::Square | Arrangement::Hexagonal) => {
                let (low, high) = shape.bounds(self.dimensions);
                let along = |a: usize| ((high[a] - low[a]) / self.spacing).max(1.0);
                let sites: f64 = (0..self.dimensions.count()).map(along).product();
                (volume / self.spacing.powi(self.dimensions.count() as i32)).max(sites * LEAST_KEPT)
            }
            // The same of rings.
            (Solid::Composed { .. }, Arrangement::Rings) => {
                let sites = rings::sites(owner(shape).0, self.spacing, &self.corners(shape));
                (volume / self.spacing.powi(self.dimensions.count() as i32)).max(sites * LEAST_KEPT)
            }
            (_, Arrangement::Rings) => volume / self.spacing.powi(self.dimensions.count() as i32),
            (solid, _) => {
                // A profile can be one thin flange.
                let grid = Grid::new(solid, self.dimensions, self.spacing, self.lattice);
                grid.estimate(volume).max(grid.sites() * LEAST_KEPT)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::LatticePlacement;

    fn shape(solid: Solid) -> Shape {
        Shape { solid, transform: Transform::default() }
    }

    fn composed(operation: Operation, parts: Vec<Shape>) -> Shape {
        shape(Solid::Composed { operation, parts: parts.into() })
    }

    fn sites(shape: &Shape, dimensions: Dimensions, arrangement: Arrangement) -> Vec<([f64; 3], f64)> {
        let lattice = Lattice { arrangement, placement: LatticePlacement::CellCentres };
        let mut all = Vec::new();
        Pattern { dimensions, spacing: 0.1, density: 1.0, lattice }
            .for_each_site(shape, |site, volume| all.push((site, volume)));
        all
    }

    fn square(min: [f64; 2], max: [f64; 2]) -> Shape {
        shape(Solid::Box { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] })
    }

    fn disc(centre: [f64; 2], radius: f64) -> Shape {
        shape(Solid::Ball { centre: [centre[0], centre[1], 0.0], radius, inner_radius: 0.0 })
    }

    #[test]
    fn a_part_of_wide_rings_counts_what_is_gone_through() {
        let lattice = Lattice { arrangement: Arrangement::Rings, placement: LatticePlacement::CellCentres };
        let pattern = Pattern { dimensions: Dimensions::PlaneStrain, spacing: 0.1, density: 1.0, lattice };
        let part = |radius: f64, min: [f64; 2], max: [f64; 2]| {
            composed(Operation::Intersection, vec![disc([0.0, 0.0], radius), square(min, max)])
        };
        // Rings about the centre as far as its ends: pi 5000^2/0.01, of which a fiftieth counts.
        let strip = part(1e6, [-5e3, -0.2], [5e3, 0.2]);
        assert!((pattern.estimate(&strip) / 1.57e8 - 1.0).abs() < 0.01, "{}", pattern.estimate(&strip));
        assert!(pattern.estimate(&part(1.0, [0.0, 0.0], [1.0, 1.0])) < 90.0);
        // However wide they are elsewhere.
        for at in [0.0, 3e5] {
            let corner = part(1e12, [at, at], [at + 1.0, at + 1.0]);
            assert!((90.0..110.0).contains(&pattern.estimate(&corner)), "{}", pattern.estimate(&corner));
            let mut volume = 0.0;
            pattern.for_each_site(&corner, |_, of_site| volume += of_site);
            assert!((volume - 1.0).abs() < 0.15, "{volume}");
        }
    }

    /// All sites of the owner of the lattice, however little of it the shape has.
    fn sites_of_all(pattern: &Pattern, shape: &Shape) -> Vec<([f64; 3], f64)> {
        let (solid, transform) = owner(shape);
        let mut all = Vec::new();
        let mut visit = |site: [f64; 3], volume: f64, own: bool| {
            let place = transform.apply(site);
            if pattern.keeps(shape, place, own) {
                all.push((place, volume));
            }
        };
        if pattern.lattice.arrangement == Arrangement::Rings {
            rings::for_each_cell(solid, pattern.spacing, &[], |site, volume, _| visit(site, volume, true));
        } else {
            let corner = |k: usize| std::array::from_fn(|a| if k >> a & 1 == 0 { -2.5 } else { 2.5 });
            let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
            let grid = Grid::new(solid, pattern.dimensions, pattern.spacing, pattern.lattice);
            grid.for_each_site(&corners, |site, own, _| visit(site, 0.1f64.powi(3), own));
        }
        all
    }

    #[test]
    fn a_part_of_a_lattice_is_the_same_whatever_is_gone_through() {
        use {Arrangement::*, LatticePlacement::*, Operation::*};
        let placed = |solid: Solid, angle: f64, shift: [f64; 3]| Shape {
            solid,
            transform: Transform::about_axis([0.36, 0.48, 0.8], angle, shift),
        };
        let block = |low: [f64; 3], high: [f64; 3]| Solid::Box { min: low, max: high };
        let bar = || Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.6, 0.8], radius: 0.63, inner_radius: 0.21 };
        let ball = || Solid::Ball { centre: [0.1, 0.0, 0.2], radius: 0.66, inner_radius: 0.0 };
        let mut compared = 0;
        for angle in [0.0, 0.7] {
            for shift in [[0.4, -0.3, 0.25], [-0.62, 0.1, 0.0]] {
                let cut = placed(block([0.0; 3], [0.5, 0.7, 0.4]), angle, shift);
                for first in [bar(), ball(), block([-0.33; 3], [0.52, 0.77, 0.61])] {
                    let is_round = matches!(first, Solid::Cylinder { .. });
                    let first = placed(first, 1.3 - angle, [0.05, 0.0, 0.0]);
                    for operation in [Intersection, Difference, Union] {
                        let inner = composed(operation, vec![first.clone(), cut.clone()]);
                        let outer = composed(Intersection, vec![inner.clone(), placed(ball(), 0.0, shift)]);
                        let nested = Shape { transform: cut.transform, ..outer };
                        for shape in [inner, nested] {
                            for (arrangement, placement) in [
                                (Square, CellCentres),
                                (Square, OnFaces),
                                (Hexagonal, CellCentres),
                                (Rings, CellCentres),
                            ] {
                                if arrangement == Rings && (!is_round || operation == Union) {
                                    continue;
                                }
                                let lattice = Lattice { arrangement, placement };
                                let pattern =
                                    Pattern { dimensions: Dimensions::Three, spacing: 0.1, density: 1.0, lattice };
                                let mut part = Vec::new();
                                pattern.for_each_site(&shape, |site, volume| part.push((site, volume)));
                                let all = sites_of_all(&pattern, &shape);
                                let is_ring = arrangement == Rings;
                                let same = part.len() == all.len()
                                    && part.iter().zip(&all).all(|(a, b)| a.0 == b.0 && (!is_ring || a.1 == b.1));
                                assert!(same, "{shape:?} {arrangement:?}: {} of {}", part.len(), all.len());
                                compared += part.len();
                            }
                        }
                    }
                }
            }
        }
        assert!(compared > 50_000, "{compared}");
        let plane = Pattern {
            dimensions: Dimensions::PlaneStrain,
            spacing: 0.1,
            density: 1.0,
            lattice: Lattice { arrangement: Rings, placement: CellCentres },
        };
        for angle in 0..24 {
            let (sin, cos) = (f64::from(angle) * std::f64::consts::TAU / 24.0).sin_cos();
            for (far, half) in [(0.9, 0.2), (0.5, 0.31), (0.1, 0.4), (2.5, 0.3)] {
                let [x, y] = [far * cos, far * sin];
                let cut = square([x - half, y - 0.1], [x + half, y + 0.1]);
                let part = composed(Intersection, vec![disc([0.0, 0.0], 1.4), cut]);
                let found = sites(&part, Dimensions::PlaneStrain, Rings);
                assert_eq!(found, sites_of_all(&plane, &part), "{angle} {far}");
            }
        }
    }

    #[test]
    fn composed_shapes_carry_on_the_lattice_of_their_first_part() {
        let head = square([0.9, -0.5], [1.4, 1.5]);
        let bar = composed(Operation::Union, vec![square([0.0, 0.0], [1.0, 1.0]), head]);
        let all = sites(&bar, Dimensions::PlaneStrain, Arrangement::Square);
        // 10 x 10, and 5 x 20 less the 1 x 10 that both have.
        assert_eq!(all.len(), 100 + 100 - 10);
        let off = |x: f64| ((x - 0.05) / 0.1 - ((x - 0.05) / 0.1).round()).abs();
        assert!(all.iter().all(|(p, v)| off(p[0]) < 1e-9 && off(p[1]) < 1e-9 && (v - 0.01).abs() < 1e-15));
        let drilled = composed(Operation::Difference, vec![square([0.0, 0.0], [1.0, 1.0]), disc([0.5, 0.5], 0.2)]);
        assert_eq!(sites(&drilled, Dimensions::PlaneStrain, Arrangement::Square).len(), 100 - 12);
        let lens = composed(Operation::Intersection, vec![square([0.0, 0.0], [1.0, 1.0]), disc([0.0, 0.0], 0.2)]);
        assert_eq!(sites(&lens, Dimensions::PlaneStrain, Arrangement::Square).len(), 3);
    }

    #[test]
    fn nested_and_turned_shapes_take_their_lattice_along() {
        let quarter = Transform::about_axis([0.0, 0.0, 1.0], 0.4, [2.0, 1.0, 0.0]);
        let inner = composed(Operation::Difference, vec![square([0.0, 0.0], [1.0, 1.0]), disc([0.5, 0.5], 0.2)]);
        let whole = composed(Operation::Union, vec![inner, square([1.0, 0.0], [1.5, 0.5])]);
        let straight = sites(&whole, Dimensions::PlaneStrain, Arrangement::Square);
        let turned = sites(&Shape { transform: quarter, ..whole }, Dimensions::PlaneStrain, Arrangement::Square);
        assert_eq!((straight.len(), turned.len()), (88 + 25, 88 + 25));
        for ((a, _), (b, _)) in straight.iter().zip(&turned) {
            let moved = quarter.apply(*a);
            assert!((0..3).all(|k| (moved[k] - b[k]).abs() < 1e-12));
        }
    }

    #[test]
    fn rings_are_cut_by_further_parts() {
        let half = composed(Operation::Intersection, vec![disc([0.0, 0.0], 1.0), square([-2.0, 0.0], [2.0, 2.0])]);
        let whole: f64 =
            sites(&disc([0.0, 0.0], 1.0), Dimensions::PlaneStrain, Arrangement::Rings).iter().map(|s| s.1).sum();
        let cut: f64 = sites(&half, Dimensions::PlaneStrain, Arrangement::Rings).iter().map(|s| s.1).sum();
        assert!((whole - std::f64::consts::PI).abs() < 1e-12 && (cut / whole - 0.5).abs() < 1e-12);
        // Quarters are alike, and no particle is in a cut.
        let quarter = composed(Operation::Difference, vec![half, square([-2.0, -2.0], [0.0, 2.0])]);
        let all = sites(&quarter, Dimensions::PlaneStrain, Arrangement::Rings);
        assert!((all.iter().map(|s| s.1).sum::<f64>() / whole - 0.25).abs() < 1e-12);
        assert!(all.iter().all(|(p, _)| p[0].min(p[1]) > 0.03));
    }
}
