//! The report on a terminal.

use super::{
    Effort,
    finding::Finding,
    number::{deviation, significant},
    report::{CaseReport, Report},
    study::Study,
};
use comfy_table::{CellAlignment, ContentArrangement, Row, Table, presets};
use std::fmt;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for case in &self.cases {
            writeln!(f, "{case}")?;
        }
        for case in &self.cases {
            let ((passed, asked), missed) = (case.checks(), case.missed_in_words());
            writeln!(f, "{:<24}  {:<7}  {passed} of {asked} checks{missed}", case.name, case.verdict.name())?;
        }
        let effort = match self.effort {
            Effort::Quick => "low resolution",
            Effort::Full => "full resolution",
        };
        let outcome = if self.passed { "all passed" } else { "FAILED" };
        writeln!(f, "{outcome}, at {effort}, in {:.0} s{}", self.seconds, self.known_misses())
    }
}

impl fmt::Display for CaseReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.name, self.title)?;
        for run in self.runs.iter().filter(|run| run.failure.is_some()) {
            writeln!(f, "  run `{}` FAILED: {}", run.label, run.failure.as_deref().unwrap_or_default())?;
        }
        for run in &self.runs {
            for warning in &run.unexpected_warnings {
                writeln!(f, "  run `{}` is BROKEN: {warning}", run.label)?;
            }
        }
        for numbers in &self.tables {
            let columns: Vec<usize> = (1..numbers.head.len()).collect();
            writeln!(f, "{}\n{}", numbers.title, table(&numbers.head, &columns, numbers.rows.iter()))?;
        }
        if !self.findings.is_empty() {
            let head = ["quantity", "run", "ours", "reference", "deviation", "tolerance", "verdict"];
            writeln!(f, "{}", table(&head, &[2, 3, 4], self.findings.iter().flat_map(finding_rows)))?;
        }
        if !self.studies.is_empty() {
            let head = ["against spacing", "run", "ours", "exact", "error", "order", "verdict"];
            writeln!(f, "{}", table(&head, &[2, 3, 4, 5], self.studies.iter().flat_map(study_rows)))?;
        }
        for note in &self.notes {
            writeln!(f, "  {note}")?;
        }
        for (name, reason) in &self.expected_warnings {
            writeln!(f, "  the warning `{name}` is expected: {reason}")?;
        }
        Ok(())
    }
}

/// A value for a cell.
pub(super) fn value_cell(finding: &Finding) -> String {
    finding.value.map_or_else(|| "none".to_owned(), |value| finding.unit.show(value))
}

/// One row, and one more for each further reference: quantity, run, ours, reference, deviation, asked, verdict.
pub(super) fn finding_rows(finding: &Finding) -> Vec<[String; 7]> {
    let reference = |k: usize| {
        finding.references.get(k).map_or_else(Default::default, |r| {
            let text = format!("{} {} ({})", finding.unit.show(r.value), r.kind.name(), r.source);
            (text, finding.deviation(r).map_or_else(String::new, deviation))
        })
    };
    let (text, off) = reference(0);
    let verdict = finding.verdict.name().to_owned();
    let mut rows = vec![[
        finding.quantity.clone(),
        finding.run.clone(),
        value_cell(finding),
        text,
        off,
        finding.demand(),
        verdict,
    ]];
    rows.extend((1..finding.references.len()).map(|k| {
        let (text, off) = reference(k);
        [String::new(), String::new(), String::new(), text, off, String::new(), String::new()]
    }));
    rows
}

/// One row for each run: quantity, run, ours, exact, error, order, verdict.
pub(super) fn study_rows(study: &Study) -> Vec<[String; 7]> {
    let row = |(k, point): (usize, &super::StudyPoint)| {
        let first = |text: String| if k == 0 { text } else { String::new() };
        // An error of a quantity that should be zero is the quantity.
        let relative = study.exact.is_some_and(|exact| exact != 0.0);
        [
            first(study.quantity.clone()),
            point.run.clone(),
            point.value.map_or_else(|| "none".to_owned(), |value| study.unit.show(value)),
            first(study.exact.map_or_else(String::new, |exact| study.unit.show(exact))),
            point.error.filter(|_| relative).map_or_else(String::new, deviation),
            first(study.order.map_or_else(String::new, significant_order)),
            first(study.verdict.name().to_owned()),
        ]
    };
    study.points.iter().enumerate().map(row).collect()
}

/// An order: two digits say all there is.
fn significant_order(order: f64) -> String {
    significant((order * 100.0).round() / 100.0)
}

fn table(head: &[&str], right: &[usize], rows: impl Iterator<Item = impl Into<Row>>) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(head.iter().copied()).add_rows(rows);
    for &k in right {
        if let Some(column) = table.column_mut(k) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}
