//! What is made of a run: measures while it goes on; pictures and comparisons afterwards.

mod measures;
pub mod plot;

pub use measures::Measures;
