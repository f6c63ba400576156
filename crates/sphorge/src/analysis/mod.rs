//! What is made of a run: measures while it goes on; pictures and comparisons afterwards.

pub mod compare;
pub mod measures;
mod number;
pub(crate) mod observed;
pub mod plot;
pub mod validate;

pub use compare::Comparison;
pub use measures::Measures;
