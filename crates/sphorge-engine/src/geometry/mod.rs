//! Shapes, and the patterns of particles that fill them.

mod cell;
mod corners;
mod error;
mod facets;
mod fill;
mod fit;
mod heat_faces;
mod lattice;
mod overlap;
mod parts;
mod pattern;
mod pressed;
mod rings;
mod shape;
mod surface;
mod volume;

pub use corners::cell_corners;
pub use error::FillError;
pub(crate) use facets::reversed;
pub use facets::{Beside, CellFacet, ReferenceFacets, facet_thickness};
pub use fill::{BYTES_PER_PARTICLE, MAX_PARTICLES, MAX_REGIONS, bytes_per_particle, estimated_count, fill};
pub use fit::{
    BoundingPlane, FilledMass, LAYER_TOLERANCE, MASS_TOLERANCE, MisplacedLayer, filled_masses, fitting_spacings,
    misplaced_layers,
};
pub use heat_faces::{HeatFaces, faces_by_direction};
pub use pattern::rings_fill;
pub use pressed::{LARGEST_CLOSURE, PressedBodies, pressed_at_start};
pub use volume::Volume;
