//! The validated model: everything in SI units, every default filled in, nothing left to interpret.
//!
//! The deck layer builds it, engines read it. Vectors always have three components; unused axes are zero.

mod body;
mod boundary;
mod contact;
mod material;
mod measure;
mod numerics;
mod observed;
mod thermal;

pub use body::{
    Arrangement, Body, CloudParticle, CloudShare, Lattice, LatticePlacement, Operation, Region, Shape, Solid,
    Transform, VelocityProfile,
};
pub use boundary::{MotionAxis, PrescribedMotion, SymmetryPlane, TimeTable, Wall, WallContact, WallSurface};
pub use contact::BodyContact;
pub use material::{Material, NO_HEATING};
pub use measure::{CloudExtent, CraterEdge, Extremum, Measure, MeasureKind, Perforation, Probe};
pub use numerics::{
    AdaptiveSearch, ArtificialStress, GradientCorrection, Integrator, Numerics, OutputControl, Precision, Search,
    SmoothingLength, TemperatureSource, TimeControl, TotalLagrangian,
};
pub use observed::{Section, Tracer};
pub use thermal::{HeatBoundary, HeatBoundaryKind, Thermal};

/// Dimensions of the problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimensions {
    /// Uniaxial strain along x: motion along x, the full stress tensor carried.
    One,
    /// Plane strain in x, y: in-plane motion, out-of-plane stress carried.
    PlaneStrain,
    /// Three dimensions.
    Three,
}

impl Dimensions {
    /// Number of space dimensions particles move in.
    pub fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::PlaneStrain => 2,
            Self::Three => 3,
        }
    }
}

/// A whole problem.
#[derive(Clone, Debug)]
pub struct Model {
    /// One line for people.
    pub title: String,
    /// File stem of the deck; names the output folder.
    pub name: String,
    /// Space dimensions.
    pub dimensions: Dimensions,
    /// Particle spacing, m.
    pub spacing: f64,
    /// Choices of the discretisation.
    pub numerics: Numerics,
    /// Neighbour search strategy.
    pub search: Search,
    /// Compare the neighbour lists with an exact search every so many steps.
    pub audit: Option<u64>,
    /// When to start, stop and how to choose steps.
    pub time: TimeControl,
    /// Materials in use; bodies refer to them by index.
    pub materials: Vec<Material>,
    /// Bodies in deck order.
    pub bodies: Vec<Body>,
    /// How bodies meet.
    pub contact: BodyContact,
    /// Heat that flows.
    pub thermal: Thermal,
    /// Named regions of particles, selected in the initial configuration.
    pub regions: Vec<Region>,
    /// Rigid walls.
    pub walls: Vec<Wall>,
    /// Symmetry planes.
    pub symmetry: Vec<SymmetryPlane>,
    /// Periodic axes: lower and upper end of the cell, m.
    pub periodic: [Option<(f64, f64)>; 3],
    /// Held and prescribed motion.
    pub motions: Vec<PrescribedMotion>,
    /// Body acceleration, m/s².
    pub gravity: [f64; 3],
    /// What to write and when.
    pub output: OutputControl,
    /// Declared measures.
    pub measures: Vec<Measure>,
    /// Followed particles and watched points.
    pub tracers: Vec<Tracer>,
    /// Planes the force through which is written.
    pub sections: Vec<Section>,
}
