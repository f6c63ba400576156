//! The validated model: everything in SI units, every default filled in, nothing left to interpret.
//!
//! The deck layer builds it, engines read it. Vectors always have three components; unused axes are zero.

mod body;
mod boundary;
mod contact;
mod dimensions;
mod material;
mod measure;
mod numerics;
mod observed;
mod parts;
mod problem;
mod thermal;
mod warnings;

pub use body::{
    Arrangement, Body, CloudParticle, CloudShare, Lattice, LatticePlacement, Operation, RadialVelocity, Region, Shape,
    Solid, Transform, VelocityProfile,
};
pub use boundary::{MotionAxis, PrescribedMotion, SymmetryPlane, TimeTable, Wall, WallContact, WallSurface};
pub use contact::BodyContact;
pub use dimensions::Dimensions;
pub use material::{EnergyState, Material, NO_HEATING};
pub use measure::{
    CloudExtent, CraterEdge, Extremum, FragmentQuantity, Measure, MeasureKind, ParticleSelection, Perforation,
};
pub use numerics::{
    AdaptiveSearch, ArtificialStress, FaceGradients, Formulation, GradientCorrection, Integrator, Numerics,
    OutputControl, Precision, Search, SmoothingLength, StepControl, TemperatureSource, TimeControl,
};
pub use observed::{Section, Tracer};
pub use parts::Parts;
pub use problem::Model;
pub use thermal::{HeatBoundary, HeatBoundaryKind, Thermal};
pub use warnings::{STOP_AT_STEPS, WarningInfo, WarningKind, WarningLimits};
