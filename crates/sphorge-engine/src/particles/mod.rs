//! Particles: structure of arrays, one table of fields.

mod column;
mod fields;
mod history;
mod permutation;
mod table;
mod value;

pub use column::{Column, ColumnKind};
pub use fields::{FIELDS, FieldInfo, find_field, is_kept, stored_behind};
pub use history::{History, HistoryVariables};
pub use permutation::Permutation;
pub use table::{Access, COLUMNS, Check, ColumnInfo, Owner, Particles};
