//! What can go wrong with the placement of bodies.

/// Why bodies cannot be filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FillError {
    /// A body thinner than its spacing.
    #[error("body has no particles: it is {thickness} m thick and the spacing is {spacing} m")]
    Empty {
        /// Index of the body.
        body: usize,
        /// Shortest edge or diameter, m.
        thickness: f64,
        /// Spacing, m.
        spacing: f64,
    },
    /// A body no particle of its lattice falls into.
    #[error("body has no particles: no lattice point is inside its shape at a spacing of {spacing} m")]
    NoSite {
        /// Index of the body.
        body: usize,
        /// Spacing, m.
        spacing: f64,
    },
    /// More particles than can be run.
    #[error("about {count:.3e} particles; at most {limit:.1e} are possible here")]
    TooMany {
        /// Index of the body with most of them.
        body: usize,
        /// Estimated number of all particles.
        count: f64,
        /// Number that can be run.
        limit: f64,
    },
    /// Particles of a file far nearer each other than the spacing says.
    #[error("{count} particles within a spacing of {spacing} m at {position:?}")]
    Crowded {
        /// Index of the body.
        body: usize,
        /// Where, m.
        position: [f64; 3],
        /// Particles in a cell of one spacing there.
        count: usize,
        /// Spacing, m.
        spacing: f64,
    },
    /// A body so far from the origin that double precision does not tell its particles apart.
    #[error("body is too far from the origin at {position:?}")]
    Far {
        /// Index of the body.
        body: usize,
        /// A particle of it, m.
        position: [f64; 3],
        /// Spacing, m.
        spacing: f64,
    },
    /// Two bodies in one place.
    #[error("bodies overlap at {position:?}")]
    Overlap {
        /// Index of the first body.
        first: usize,
        /// Index of the second body.
        second: usize,
        /// Where, m.
        position: [f64; 3],
        /// Particles of the first body that are too near to the second.
        count: usize,
    },
    /// A region without particles.
    #[error("region is empty")]
    EmptyRegion {
        /// Index of the region.
        region: usize,
    },
    /// Particles on or behind a wall.
    #[error("body is behind a wall")]
    BehindWall {
        /// Index of the wall.
        wall: usize,
        /// Index of the body.
        body: usize,
        /// How far the deepest particle is behind, m.
        depth: f64,
    },
    /// Particles behind a symmetry plane, or so near that they meet their image.
    #[error("body reaches across a symmetry plane")]
    AcrossSymmetry {
        /// Index of the plane.
        plane: usize,
        /// Index of the body.
        body: usize,
        /// Distance of the worst particle from the plane, negative behind it, m.
        distance: f64,
    },
    /// Particles outside a periodic cell.
    #[error("body reaches out of the periodic cell")]
    OutsideCell {
        /// Axis of the cell.
        axis: usize,
        /// Index of the body.
        body: usize,
    },
    /// Particles that meet those at the other end of a periodic cell.
    #[error("particles at the ends of the periodic cell overlap")]
    PeriodicOverlap {
        /// Axis of the cell.
        axis: usize,
        /// Distance across the ends, m.
        distance: f64,
    },
    /// Particles driven twice along one axis.
    #[error("particles are driven twice")]
    DrivenTwice {
        /// Index of the first motion.
        first: usize,
        /// Index of the second motion.
        second: usize,
        /// Axis driven by both.
        axis: usize,
    },
}
