//! What the judgement of a case says.

use super::{finding::Finding, study::Study};
use serde::Serialize;

/// What the judgement of a case says, in the order it is shown.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    pub(super) findings: Vec<Finding>,
    pub(super) tables: Vec<NumberTable>,
    pub(super) studies: Vec<Study>,
    pub(super) notes: Vec<String>,
}

/// Runs beside each other, a row each, in the form a source shows them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NumberTable {
    /// What it is.
    pub title: String,
    /// Heads of the columns; the first names the row.
    pub head: Vec<&'static str>,
    /// Cells, as many a row as there are heads; an empty one has no number.
    pub rows: Vec<Vec<String>>,
}

impl Findings {
    /// Adds a number.
    pub(super) fn add(&mut self, mut finding: Finding) {
        finding.judge();
        self.findings.push(finding);
    }

    /// Adds a table, before all else.
    pub(super) fn table(&mut self, table: NumberTable) {
        self.tables.push(table);
    }

    /// Adds a study.
    pub(super) fn study(&mut self, mut study: Study) {
        study.judge();
        self.studies.push(study);
    }

    /// Adds something to know when reading the numbers.
    pub(super) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }
}
