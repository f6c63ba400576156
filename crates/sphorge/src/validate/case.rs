//! What a case is.

use super::{Effort, Variant, findings::Findings, picture::Picture, runs::Runs};

/// A warning that a case lives with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExpectedWarning {
    /// Name of the check.
    pub name: &'static str,
    /// Why its number may be beyond its limit.
    pub reason: &'static str,
    /// How the labels of the runs begin that it is expected of; empty for all.
    pub runs: &'static [&'static str],
}

impl ExpectedWarning {
    /// Of any run of the case.
    pub const fn new(name: &'static str, reason: &'static str) -> Self {
        Self { name, reason, runs: &[] }
    }

    /// Whether this warning is expected of a run.
    pub(super) fn covers(&self, name: &str, label: &str) -> bool {
        self.name == name && (self.runs.is_empty() || self.runs.iter().any(|start| label.starts_with(start)))
    }
}

/// A case with a known answer.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Name on the command line.
    pub name: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// What it shows, where its answers come from, what to know when reading the numbers.
    pub about: &'static str,
    /// Name of its shipped deck.
    pub deck: &'static str,
    /// What checks of its runs may find broken, and why; any other warning fails the case.
    pub expected_warnings: &'static [ExpectedWarning],
    /// The runs.
    pub variants: fn(Effort) -> Vec<Variant>,
    /// Sets the runs beside the answers.
    pub(super) judge: fn(&Runs, &mut Findings),
    /// Pictures of the report.
    pub(super) pictures: &'static [Picture],
}
