//! Particle state: structure of arrays, one table of fields.

mod column;
mod fields;
mod permutation;
mod state;

pub use column::{Column, ColumnKind};
pub use fields::{FIELDS, FieldInfo, find_field};
pub use permutation::Permutation;
pub use state::Particles;
