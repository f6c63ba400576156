//! How a law describes what it keeps of the past of a particle, so that storage, output and checks follow.

use crate::parameter::Bound;

/// A number a law keeps for each particle from step to step, such as damage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryVariable {
    /// Name of the particle field, lower case, words joined by underscores; laws that mean the same share it.
    pub name: &'static str,
    /// SI unit, empty for a pure number.
    pub unit: &'static str,
    /// Value before the first step.
    pub initial: f64,
    /// Values it may take; any other means the run has failed.
    pub bound: Bound,
    /// One line for the user.
    pub meaning: &'static str,
}
