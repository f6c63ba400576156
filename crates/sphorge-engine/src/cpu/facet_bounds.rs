//! Where facets are at most: what decides fast which of them cannot press.

use crate::geometry::ReferenceFacets;
use sphorge_physics::Vector;
use sphorge_physics::facet::Facet;
use sphorge_physics::tensor::dot;

/// Cosine between normals below which facets can press each other.
const FACING: f64 = -0.3;

/// A ball around a facet, and how far its surface is before its plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct About {
    /// Position of the middle, m.
    middle: Vector<f64>,
    normal: Vector<f64>,
    /// Distance from the middle within which the facet is, m.
    radius: f64,
    /// The most by which curvature takes the surface before the plane, m.
    bulge: f64,
}

impl About {
    pub(super) fn new(facet: &Facet<f64>) -> Self {
        let to_corner = |corner: &Vector<f64>| {
            let way: Vector<f64> = std::array::from_fn(|k| corner[k] - facet.middle[k]);
            dot(way, way)
        };
        let squared = facet.corners.iter().map(to_corner).fold(0.0, f64::max);
        let bent: f64 = facet.curvature.to_array().iter().map(|c| c.abs()).sum();
        Self {
            middle: std::array::from_fn(|k| facet.owner[k] + facet.middle[k]),
            normal: facet.normal,
            radius: squared.sqrt(),
            // Off the diagonal twice.
            bulge: bent * squared,
        }
    }

    /// Whether facets face each other, one is before the other, seen along the bisector of their normals, and their gap may be closed there.
    pub(super) fn may_press(&self, other: &Self) -> bool {
        if dot(self.normal, other.normal) >= FACING {
            return false;
        }
        let (mut across, mut squared, mut along) = (0.0, 0.0, 0.0);
        for k in 0..3 {
            let (apart, way) = (other.normal[k] - self.normal[k], self.middle[k] - other.middle[k]);
            across += apart * apart;
            squared += way * way;
            along += way * apart;
        }
        let reach = self.radius + other.radius;
        // Rounding decides nothing here.
        if squared - along * along / across > reach * reach * (1.0 + 1e-9) {
            return false;
        }
        // Both planes are as steep.
        let sine = (1.0 - 0.25 * across).max(0.0).sqrt();
        along / across.sqrt() - reach * sine - self.bulge - other.bulge <= 1e-9 * reach
    }
}

/// How far corners of the facets of each particle are from it along each axis at the start, m: most corners are as far as others.
#[derive(Default)]
pub(super) struct Arms {
    /// Of each particle where its own begin.
    starts: Vec<u32>,
    arms: Vec<Vector<f64>>,
}

impl Arms {
    pub(super) fn new(reference: &ReferenceFacets) -> Self {
        let mut of_all = Self { starts: vec![0], arms: Vec::new() };
        for id in 0..reference.particles() {
            let from = of_all.arms.len();
            for corner in reference.of(id).iter().flat_map(|facet| facet.facet.corners) {
                let arm = corner.map(f64::abs);
                if !of_all.arms[from..].contains(&arm) {
                    of_all.arms.push(arm);
                }
            }
            of_all.starts.push(of_all.arms.len() as u32);
        }
        of_all
    }

    pub(super) fn of(&self, id: u32) -> &[Vector<f64>] {
        let id = id as usize;
        let (Some(&from), Some(&to)) = (self.starts.get(id), self.starts.get(id + 1)) else { return &[] };
        &self.arms[from as usize..to as usize]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * self.starts.capacity() + size_of::<Vector<f64>>() * self.arms.capacity()
    }
}
