//! A particle in a picture.

use super::cell::Corners;

/// A particle on the plane of the picture, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) right: f64,
    pub(super) up: f64,
    pub(super) towards: f64,
    pub(super) spacing: f64,
    pub(super) value: f64,
    /// How the surface here is lit, 0 to 1; 1 inside and in a plane.
    pub(super) light: f64,
    pub(super) body: u16,
    /// Corners of its deformed cell from the particle, m, where they are known.
    pub(super) cell: Option<Corners<f32>>,
}

impl Mark {
    /// How far it reaches along the page, to the right (0) or up (1), from its middle, m.
    pub(super) fn reach(&self, axis: usize) -> (f64, f64) {
        let half = 0.5 * self.spacing;
        let corners = self.cell.iter().flatten().map(|corner| f64::from(corner[axis])).filter(|x| x.is_finite());
        corners.map(|x| (x, x)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((-half, half))
    }
}
