//! Tracers and sections: further columns of the history.

/// Follows a particle, or watches a point of space.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracer {
    /// Name in the deck; columns are called `tracer.NAME.FIELD`.
    pub name: String,
    /// Where: the nearest particle of the initial configuration is followed, m.
    pub point: [f64; 3],
    /// Only particles of this body, if given.
    pub body: Option<usize>,
    /// Stays at the point and interpolates, rather than following a particle.
    pub is_fixed: bool,
    /// Names of the fields to write.
    pub fields: Vec<String>,
}

/// A plane, fixed in space, the force through which is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Name in the deck; columns are called `section.NAME.force_x` and so on.
    pub name: String,
    /// A point of the plane, m.
    pub point: [f64; 3],
    /// Unit normal: the force is the one the material ahead of the plane exerts on that behind.
    pub normal: [f64; 3],
    /// Only particles of this body, if given.
    pub body: Option<usize>,
}
