//! Where facets that may meet come from: the initial configuration, or its image in symmetry planes.

use crate::geometry::{CellFacet, ReferenceFacets, reversed};
use sphorge_physics::Vector;
use sphorge_physics::facet::{ReferenceFacet, edges_reversed};

/// Where a facet comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    /// Particle or ghost.
    pub(super) point: u32,
    /// Place among the facets of the initial configuration.
    pub(super) place: u32,
    /// Signs of the image that the point is.
    pub(super) sign: Vector<f64>,
}

impl Source {
    /// The facet in the initial configuration.
    pub(super) fn facet<'a>(&self, reference: &'a ReferenceFacets) -> &'a CellFacet {
        reference.at(self.place as usize)
    }

    /// Axis and side of its face of the cell.
    pub(super) fn face(&self, reference: &ReferenceFacets) -> (usize, usize) {
        let face = usize::from(self.facet(reference).side);
        (face / 2, face % 2)
    }

    pub(super) fn is_reversed(&self) -> bool {
        self.sign[0] * self.sign[1] * self.sign[2] < 0.0
    }
}

/// The facet of an image.
pub(super) fn mirrored(facet: &ReferenceFacet<f64>, source: &Source) -> ReferenceFacet<f64> {
    let sign = source.sign;
    let turned = |v: Vector<f64>| -> Vector<f64> { std::array::from_fn(|k| sign[k] * v[k]) };
    let corners = facet.corners.map(turned);
    let mirror = [[sign[0], 0.0, 0.0], [0.0, sign[1], 0.0], [0.0, 0.0, sign[2]]];
    ReferenceFacet {
        corners: if source.is_reversed() { reversed(corners) } else { corners },
        middle: turned(facet.middle),
        normal: turned(facet.normal),
        curvature: facet.curvature.congruence(&mirror),
        depth: facet.depth,
        free: if source.is_reversed() { edges_reversed(facet.free) } else { facet.free },
        across: facet.across.map(turned),
    }
}
