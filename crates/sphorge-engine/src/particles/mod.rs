//! Particles: structure of arrays, one table of fields.

mod column;
mod fields;
mod history;
mod permutation;
mod table;
mod value;

pub use column::{Column, ColumnKind};
pub use fields::{DEFORMATION_GRADIENT, FIELDS, FieldInfo, equivalent_strain_rate, find_field, is_kept, stored_behind};
pub use history::{History, HistoryVariables};
pub use permutation::Permutation;
pub use table::{Access, COLUMNS, Check, ColumnInfo, Owner, Particles};

use crate::persist::Fixed;

/// What is done with every column of the particles in turn.
pub(crate) trait ColumnVisitor {
    /// Takes the next column, which may come out of another length. One that a run does not use is empty and stays so.
    fn visit<V: Fixed + Copy>(&mut self, column: &mut Vec<V>);
}
