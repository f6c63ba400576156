//! Reads a history back.

use super::{
    HistoryColumn, RunDirectory,
    error::{AtPath, OutputError},
    history::REASON,
    regular_file::{self, most},
};
use std::collections::BTreeMap;

/// A history in memory, column by column.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryTable {
    /// What the columns hold, in the order of the file.
    pub columns: Vec<HistoryColumn>,
    /// Values by column, then row; NaN for empty cells and words.
    pub values: Vec<Vec<f64>>,
    /// Cells of the columns that hold words, by their names.
    pub words: BTreeMap<String, Vec<String>>,
}

impl HistoryTable {
    /// Reads `history.csv` and, where it is there, `history-columns.json`.
    ///
    /// # Errors
    /// [`OutputError::Read`] without a history, [`OutputError::Damaged`] for an empty file, or a line with too many or too few cells.
    pub fn read(run: &RunDirectory) -> Result<Self, OutputError> {
        let path = run.history();
        let text = regular_file::read(&path, most::HISTORY).reading(&path)?;
        // A run writes the names of the columns with the first row.
        if text.trim_ascii().is_empty() {
            return Err(OutputError::damaged(&path, "it is empty"));
        }
        let mut reader = csv::Reader::from_reader(text.as_slice());
        let damaged = |e: csv::Error| OutputError::damaged(&path, e.to_string());
        let names: Vec<String> = reader.headers().map_err(damaged)?.iter().map(str::to_owned).collect();
        let mut values = vec![Vec::new(); names.len()];
        let mut words = BTreeMap::from([(REASON.to_owned(), Vec::new())]);
        words.retain(|name, _| names.contains(name));
        for record in reader.records() {
            for ((column, name), cell) in values.iter_mut().zip(&names).zip(&record.map_err(damaged)?) {
                column.push(cell.parse().unwrap_or(f64::NAN));
                if let Some(words) = words.get_mut(name) {
                    words.push(cell.to_owned());
                }
            }
        }
        let known = known_columns(run);
        let describe = |name: String| {
            let unknown = || HistoryColumn { name: name.clone(), unit: String::new(), meaning: String::new() };
            known.iter().find(|column| column.name == name).cloned().unwrap_or_else(unknown)
        };
        Ok(Self { columns: names.into_iter().map(describe).collect(), values, words })
    }

    /// Values and description of a column.
    pub fn column(&self, name: &str) -> Option<(&HistoryColumn, &[f64])> {
        let k = self.columns.iter().position(|column| column.name == name)?;
        Some((&self.columns[k], &self.values[k]))
    }
}

/// Descriptions of the columns; a history without them is still a history.
fn known_columns(run: &RunDirectory) -> Vec<HistoryColumn> {
    regular_file::read(&run.history_columns(), most::TEXT)
        .ok()
        .and_then(|text| serde_json::from_slice(&text).ok())
        .unwrap_or_default()
}

/// The step of the last row, without reading the rows before.
pub(crate) fn last_step(run: &RunDirectory) -> Option<u64> {
    let text = regular_file::read(&run.history(), most::HISTORY).ok()?;
    let lines = text.strip_suffix(b"\n")?;
    let last = lines.iter().rposition(|byte| *byte == b'\n')?;
    let first = lines.iter().position(|byte| *byte == b'\n')?;
    let rows = [&text[..=first], &text[last + 1..]].concat();
    let mut reader = csv::Reader::from_reader(rows.as_slice());
    let column = reader.headers().ok()?.iter().position(|name| name == "step")?;
    reader.records().next()?.ok()?.get(column)?.parse().ok()
}
