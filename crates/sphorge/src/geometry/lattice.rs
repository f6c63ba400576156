//! Square and cubic lattices in the frame of a solid.
//!
//! A lattice is anchored to its solid and turns with it, so a symmetric solid gets a symmetric lattice. Along the edge of a
//! box, or along a cylinder, the number of cells is the length over the spacing, rounded; the lattice is centred, so an edge
//! that is no multiple of the spacing is over- or underfilled by less than a quarter of a spacing at either end. Across a
//! cylinder and in a disc or sphere the lattice is centred on the axis or centre, with a cell corner there (particles at cell
//! centres) or a particle (particles on faces), and keeps the particles whose centre is inside.

use super::shape::{dot, subtract};
use crate::model::{Dimensions, LatticePlacement, Solid};

/// A particle this much (over the spacing) outside a round surface still counts as on it.
const ROUNDING: f64 = 1e-9;

/// Sites along one line: `centre + (k - (count - 1)/2) spacing`, exactly symmetric about the centre.
#[derive(Clone, Copy, Debug)]
struct Line {
    centre: f64,
    count: u64,
}

impl Line {
    fn along(low: f64, high: f64, spacing: f64, placement: LatticePlacement) -> Self {
        let cells = ((high - low) / spacing).round().max(1.0) as u64;
        let count = match placement {
            LatticePlacement::CellCentres => cells,
            LatticePlacement::OnFaces => cells + 1,
        };
        Self { centre: 0.5 * (low + high), count }
    }

    /// Sites within `radius` of the centre.
    fn across(centre: f64, radius: f64, spacing: f64, placement: LatticePlacement) -> Self {
        let reach = radius / spacing + ROUNDING;
        let count = match placement {
            LatticePlacement::CellCentres => 2 * (reach + 0.5).floor() as u64,
            LatticePlacement::OnFaces => 2 * reach.floor() as u64 + 1,
        };
        Self { centre, count }
    }

    fn one() -> Self {
        Self { centre: 0.0, count: 1 }
    }

    fn site(&self, k: u64, spacing: f64) -> f64 {
        self.centre + (k as f64 - (self.count as f64 - 1.0) / 2.0) * spacing
    }
}

/// A right-handed frame whose third vector is the unit vector along `axis`; along a coordinate axis it is made of coordinate
/// axes, so that the lattice lines up with others.
fn frame(axis: [f64; 3]) -> [[f64; 3]; 3] {
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

/// Calls `visit` with every particle of the solid, in its own frame.
pub(super) fn for_each_site(
    solid: &Solid,
    dimensions: Dimensions,
    spacing: f64,
    placement: LatticePlacement,
    mut visit: impl FnMut([f64; 3]),
) {
    let count = dimensions.count();
    match solid {
        Solid::Box { min, max } => {
            let lines: [Line; 3] = std::array::from_fn(|k| {
                if k < count { Line::along(min[k], max[k], spacing, placement) } else { Line::one() }
            });
            for_each(&lines, spacing, visit);
        }
        Solid::Ball { centre, radius } => {
            let lines: [Line; 3] = std::array::from_fn(|k| {
                if k < count { Line::across(0.0, *radius, spacing, placement) } else { Line::one() }
            });
            let limit = (radius + ROUNDING * spacing).powi(2);
            for_each(&lines, spacing, |offset| {
                if dot(offset, offset) <= limit {
                    visit(std::array::from_fn(|k| if k < count { centre[k] + offset[k] } else { 0.0 }));
                }
            });
        }
        Solid::Cylinder { from, to, radius } => {
            let axis = subtract(*to, *from);
            let length = dot(axis, axis).sqrt();
            let [u, v, w] = frame(axis);
            let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (from[k] + to[k]));
            let across = Line::across(0.0, *radius, spacing, placement);
            let lines = [across, across, Line::along(-0.5 * length, 0.5 * length, spacing, placement)];
            let limit = (radius + ROUNDING * spacing).powi(2);
            for_each(&lines, spacing, |[a, b, c]| {
                if a * a + b * b <= limit {
                    visit(std::array::from_fn(|k| middle[k] + a * u[k] + b * v[k] + c * w[k]));
                }
            });
        }
    }
}

fn for_each(lines: &[Line; 3], spacing: f64, mut visit: impl FnMut([f64; 3])) {
    for k in 0..lines[2].count {
        let z = lines[2].site(k, spacing);
        for j in 0..lines[1].count {
            let y = lines[1].site(j, spacing);
            for i in 0..lines[0].count {
                visit([lines[0].site(i, spacing), y, z]);
            }
        }
    }
}

/// Number of particles a solid will take, without making them: exact for boxes, from the volume for round solids.
pub(super) fn estimate(solid: &Solid, dimensions: Dimensions, spacing: f64, placement: LatticePlacement) -> f64 {
    let line = |length: f64| {
        let cells = (length / spacing).round().max(1.0);
        if placement == LatticePlacement::OnFaces { cells + 1.0 } else { cells }
    };
    match solid {
        Solid::Box { min, max } => (0..dimensions.count()).map(|k| line(max[k] - min[k])).product(),
        Solid::Ball { radius, .. } => {
            let ratio = radius / spacing;
            match dimensions {
                Dimensions::One => 2.0 * ratio,
                Dimensions::PlaneStrain => std::f64::consts::PI * ratio * ratio,
                Dimensions::Three => 4.0 / 3.0 * std::f64::consts::PI * ratio.powi(3),
            }
        }
        Solid::Cylinder { from, to, radius } => {
            let axis = subtract(*to, *from);
            std::f64::consts::PI * (radius / spacing).powi(2) * line(dot(axis, axis).sqrt())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use LatticePlacement::{CellCentres, OnFaces};

    fn sites(solid: &Solid, dimensions: Dimensions, spacing: f64, placement: LatticePlacement) -> Vec<[f64; 3]> {
        let mut all = Vec::new();
        for_each_site(solid, dimensions, spacing, placement, |site| all.push(site));
        all
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
        assert_eq!(estimate(&plate, Dimensions::Three, 6e-3, OnFaces), 251.0 * 126.0 * 6.0);
        let line = Solid::Box { min: [1.0, 0.0, 0.0], max: [2.0, 0.0, 0.0] };
        let all = sites(&line, Dimensions::One, 0.25, OnFaces);
        assert_eq!(all.iter().map(|p| p[0]).collect::<Vec<_>>(), [1.0, 1.25, 1.5, 1.75, 2.0]);
    }

    #[test]
    fn round_solids_are_symmetric_about_a_cell_corner_or_a_particle() {
        let disc = Solid::Ball { centre: [0.0; 3], radius: 1.0 };
        assert_eq!(sites(&disc, Dimensions::PlaneStrain, 1.0, CellCentres).len(), 4);
        assert_eq!(sites(&disc, Dimensions::PlaneStrain, 1.0, OnFaces).len(), 5);
        let all = sites(&disc, Dimensions::PlaneStrain, 0.1, CellCentres);
        assert!(all.iter().all(|p| all.contains(&[-p[0], p[1], 0.0]) && all.contains(&[p[1], p[0], 0.0])));
        assert!((all.len() as f64 / 314.159 - 1.0).abs() < 0.02);
        let sphere = Solid::Ball { centre: [5.0, 0.0, 0.0], radius: 1.0 };
        let count = sites(&sphere, Dimensions::Three, 0.1, CellCentres).len() as f64;
        assert!((count / 4188.79 - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_cylinder_along_any_axis_has_the_same_lattice() {
        let z = Solid::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 1.0], radius: 0.35 };
        let y = Solid::Cylinder { from: [0.0; 3], to: [0.0, 1.0, 0.0], radius: 0.35 };
        let skew = Solid::Cylinder { from: [0.0; 3], to: [0.6, 0.8, 0.0], radius: 0.35 };
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
