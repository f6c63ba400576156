//! Concentric rings of equally spaced particles, for discs and cylinders.
//!
//! Between hole and surface lies a whole number of rings of one width, about a spacing; particles sit in the middle of their
//! ring, as many as make each stand for about a spacing squared, a multiple of four that stands half a distance off the two axes
//! across: planes through the centre along them cut the body in halves and quarters that are alike, with no particle in the cut. A
//! particle has its share of the area of its ring, so the body weighs exactly what its shape does. A cylinder is a whole number of
//! equal slices of rings.
//!
//! The four about the centre of a disc stand for quarters of it and sit in their centroids, a fifth farther out than the middle of
//! their ring: with them in the middle, the foot of a copper bar at 250 m/s, 24 particles across, has one strain in both innermost
//! rings, 7.8 % below that of finite elements at the axis. From the second ring on centroids are within 0.02 widths of the middle;
//! there particles stay in the middle, since measures and contacts take faces to be half a width beyond the outermost.

use super::{
    cell::Cell,
    lattice::frame,
    shape::{dot, subtract},
};
use crate::model::{Dimensions, Solid};
use std::f64::consts::TAU;

/// Whether rings fill a solid: one that is round about an axis or a point of the plane, with straight sides.
pub(crate) fn can_fill(solid: &Solid, dimensions: Dimensions) -> bool {
    matches!(solid, Solid::Cylinder { .. })
        || matches!(solid, Solid::Ball { .. }) && dimensions == Dimensions::PlaneStrain
}

/// About as many particles as a solid that rings can fill has.
pub(super) fn sites(solid: &Solid, spacing: f64) -> f64 {
    let of_section = |inner: f64, outer: f64| 0.5 * TAU * (outer - inner) * (outer + inner) / (spacing * spacing);
    match solid {
        Solid::Ball { radius, inner_radius, .. } => of_section(*inner_radius, *radius),
        Solid::Cylinder { from, to, radius, inner_radius } => {
            let axis = subtract(*to, *from);
            of_section(*inner_radius, *radius) * (dot(axis, axis).sqrt() / spacing).max(1.0)
        }
        _ => 0.0,
    }
}

/// Calls `visit` with place, volume (area in the plane) and cell of every particle of a solid that rings can fill.
pub(super) fn for_each_cell(solid: &Solid, spacing: f64, mut visit: impl FnMut([f64; 3], f64, Cell)) {
    match solid {
        Solid::Ball { centre, radius, inner_radius } => {
            let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            for_each_of_section(*inner_radius, *radius, spacing, |sector| {
                let (x, y) = (sector.radius * sector.cos, sector.radius * sector.sin);
                let centre = [centre[0], centre[1], 0.0];
                visit([centre[0] + x, centre[1] + y, 0.0], sector.area, sector.cell(centre, &frame, 0.5))
            });
        }
        Solid::Cylinder { from, to, radius, inner_radius } => {
            let axis = subtract(*to, *from);
            let length = dot(axis, axis).sqrt();
            let [u, v, w] = frame(axis);
            let slices = (length / spacing).round().max(1.0);
            let thickness = length / slices;
            for slice in 0..slices as u64 {
                let z = (slice as f64 + 0.5) * thickness;
                let centre = std::array::from_fn(|k| from[k] + z * w[k]);
                for_each_of_section(*inner_radius, *radius, spacing, |sector| {
                    let (x, y) = (sector.radius * sector.cos, sector.radius * sector.sin);
                    let place = std::array::from_fn(|k| from[k] + x * u[k] + y * v[k] + z * w[k]);
                    visit(place, sector.area * thickness, sector.cell(centre, &[u, v, w], 0.5 * thickness));
                });
            }
        }
        _ => {}
    }
}

/// A particle of a section.
struct Sector {
    radius: f64,
    cos: f64,
    sin: f64,
    area: f64,
    radii: [f64; 2],
    half_angle: f64,
}

impl Sector {
    /// Its cell in a slice about a point of the axis, given the axes of the section.
    fn cell(&self, centre: [f64; 3], [u, v, w]: &[[f64; 3]; 3], half_thickness: f64) -> Cell {
        let out = std::array::from_fn(|k| self.cos * u[k] + self.sin * v[k]);
        let along = std::array::from_fn(|k| self.cos * v[k] - self.sin * u[k]);
        let Self { radius, radii, half_angle, .. } = *self;
        Cell::Sector { centre, frame: [out, along, *w], radius, radii, half_angle, half_thickness }
    }
}

fn for_each_of_section(inner: f64, outer: f64, spacing: f64, mut visit: impl FnMut(Sector)) {
    let rings = ((outer - inner) / spacing).round().max(1.0);
    let width = (outer - inner) / rings;
    for ring in 0..rings as u64 {
        let middle = inner + (ring as f64 + 0.5) * width;
        let area = TAU * middle * width;
        let count = 4.0 * (area / (4.0 * spacing * spacing)).round().max(1.0);
        let r = if inner == 0.0 && ring == 0 { centroid(width, count) } else { middle };
        for k in 0..count as u64 {
            let (sin, cos) = (TAU * (k as f64 + 0.5) / count).sin_cos();
            let radii = [
                inner + ring as f64 * width,
                if ring as f64 + 1.0 == rings { outer } else { inner + (ring as f64 + 1.0) * width },
            ];
            visit(Sector { radius: r, cos, sin, area: area / count, radii, half_angle: 0.5 * TAU / count });
        }
    }
}

/// How far from the centre of a disc the centroid of a sector is, of which the disc has so many.
fn centroid(radius: f64, count: f64) -> f64 {
    let half_angle = 0.5 * TAU / count;
    2.0 / 3.0 * radius * half_angle.sin() / half_angle
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn all_sites(solid: &Solid, spacing: f64) -> Vec<([f64; 3], f64)> {
        let mut all = Vec::new();
        for_each_cell(solid, spacing, |site, volume, _| all.push((site, volume)));
        all
    }

    #[test]
    fn a_disc_of_rings_has_its_area_and_its_centre() {
        let disc = Solid::Ball { centre: [2.0, 1.0, 0.0], radius: 1.0, inner_radius: 0.0 };
        // Rings of width 0.25 at 1/8, 3/8, 5/8, 7/8, whose areas are those of 3.1, 9.4, 15.7 and 22.0 particles.
        let all = all_sites(&disc, 0.25);
        assert_eq!(all.len(), 4 + 8 + 16 + 20);
        assert!((sites(&disc, 0.25) - 50.27).abs() < 0.01);
        assert!((all.iter().map(|s| s.1).sum::<f64>() - PI).abs() < 1e-12);
        // The innermost in the centroids of quarters, 4/(3 pi) of the radius off both sides.
        let from_centre = |k: usize| (all[k].0[0] - 2.0).hypot(all[k].0[1] - 1.0);
        assert!((0..4).all(|k| (from_centre(k) - 0.25 * 4.0 / (3.0 * PI) * 2.0f64.sqrt()).abs() < 1e-12));
        assert!((from_centre(4) - 0.375).abs() < 1e-12);
        let moment = |a: usize| all.iter().map(|s| s.1 * s.0[a]).sum::<f64>() / PI;
        assert!((moment(0) - 2.0).abs() < 1e-12 && (moment(1) - 1.0).abs() < 1e-12);
        // Of the smallest rings a particle is 4/3.1 or 8/9.4 of a spacing squared.
        assert!(all.iter().all(|s| (s.1 / 0.0625 - 1.0).abs() < 0.22));
        assert!(all_sites(&disc, 0.01).iter().filter(|s| (s.1 / 1e-4 - 1.0).abs() > 0.05).count() < 400);
    }

    #[test]
    fn a_tube_of_rings_has_its_volume_whatever_its_axis() {
        let tube = Solid::Cylinder { from: [0.0; 3], to: [0.6, 0.8, 0.0], radius: 0.5, inner_radius: 0.33 };
        let all = all_sites(&tube, 0.07);
        let volume: f64 = all.iter().map(|s| s.1).sum();
        assert!((volume / (PI * (0.25 - 0.33 * 0.33)) - 1.0).abs() < 1e-12);
        assert!((sites(&tube, 0.07) / all.len() as f64 - 1.0).abs() < 0.1);
        // Two rings, 14 slices.
        let radius = |p: [f64; 3]| super::super::shape::about_axis(p, [0.0; 3], [0.6, 0.8, 0.0]).1;
        let inner = all.iter().filter(|s| radius(s.0) < 0.415).count();
        assert_eq!(inner % 14, 0);
        assert!(all.iter().all(|s| (radius(s.0) - 0.3725).abs() < 1e-12 || (radius(s.0) - 0.4575).abs() < 1e-12));
    }
}
