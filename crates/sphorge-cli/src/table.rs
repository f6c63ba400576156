//! Plain tables that also read well in a log file.

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};

/// Names and values in two columns.
pub(crate) fn facts<N: AsRef<str>>(facts: &[(N, String)]) -> String {
    let width = facts.iter().map(|(name, _)| name.as_ref().chars().count()).max().unwrap_or(0);
    facts.iter().map(|(name, value)| format!("{:<width$}  {value}\n", name.as_ref())).collect()
}

/// A table with a head; columns listed in `right` hold numbers.
pub(crate) fn columns(head: &[&str], right: &[usize], rows: Vec<Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(head.iter().copied()).add_rows(rows);
    for &k in right {
        if let Some(column) = table.column_mut(k) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    format!("{table}\n")
}
