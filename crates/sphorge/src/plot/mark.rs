//! A particle in a picture.

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
}
