//! Shapes, and the lattices of particles that fill them.

mod fill;
mod lattice;
mod overlap;
mod shape;

pub use fill::{BYTES_PER_PARTICLE, FillError, MAX_PARTICLES, MAX_REGIONS, estimated_count, fill};
