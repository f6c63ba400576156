//! Shapes, and the patterns of particles that fill them.

mod error;
mod fill;
mod fit;
mod lattice;
mod overlap;
mod parts;
mod pattern;
mod rings;
mod shape;
mod volume;

pub use error::FillError;
pub use fill::{BYTES_PER_PARTICLE, MAX_PARTICLES, MAX_REGIONS, bytes_per_particle, estimated_count, fill};
pub use fit::{
    BoundingPlane, FilledMass, LAYER_TOLERANCE, MASS_TOLERANCE, MisplacedLayer, filled_masses, fitting_spacings,
    misplaced_layers,
};
pub use pattern::rings_fill;
pub use volume::Volume;
