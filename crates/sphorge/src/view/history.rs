//! The history of a run that is shown: read when its file has changed, and thinned to what a screen can show.

use super::{ViewError, description::ColumnDescription};
use crate::{
    output::{HistoryTable, MEASURE_MEANING, RunDirectory},
    plot::unknown_column,
};
use std::{
    fs,
    sync::{Arc, Mutex, PoisonError},
    time::SystemTime,
};

/// A history in memory.
#[derive(Debug, Default)]
pub(super) struct History {
    read: Mutex<Option<(Stamp, Arc<HistoryTable>)>>,
}

/// By which a file is known to be the same.
type Stamp = (Option<SystemTime>, u64);

impl History {
    /// The table; none of a run without a history that can be read.
    fn table(&self, directory: &RunDirectory) -> Option<Arc<HistoryTable>> {
        let metadata = fs::metadata(directory.history()).ok()?;
        let stamp = (metadata.modified().ok(), metadata.len());
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, table)) = read.as_ref().filter(|(known, _)| *known == stamp) {
            return Some(Arc::clone(table));
        }
        let table = Arc::new(HistoryTable::read(directory).ok()?);
        *read = Some((stamp, Arc::clone(&table)));
        Some(table)
    }

    /// The columns, and the number of rows.
    pub(super) fn columns(&self, directory: &RunDirectory) -> (Vec<ColumnDescription>, usize) {
        let Some(table) = self.table(directory) else { return (Vec::new(), 0) };
        let rows = table.values.first().map_or(0, Vec::len);
        let columns = table.columns.iter().map(|column| ColumnDescription {
            name: column.name.clone(),
            unit: column.unit.clone(),
            meaning: column.meaning.clone(),
            is_measure: column.meaning == MEASURE_MEANING,
        });
        (columns.collect(), rows)
    }

    /// What a column has in the last row.
    pub(super) fn last(&self, directory: &RunDirectory, name: &str) -> Option<f64> {
        let table = self.table(directory)?;
        let column = table.columns.iter().position(|column| column.name == name)?;
        table.values.get(column)?.last().copied()
    }

    /// Values of a column, of at most so many rows: the first, the last, and others at equal distances.
    pub(super) fn column(&self, directory: &RunDirectory, column: usize, most: usize) -> Result<Vec<f64>, ViewError> {
        // Without a history there is no column either.
        let table = self.table(directory);
        let values = table.as_ref().and_then(|table| table.values.get(column)).map_or(&[][..], Vec::as_slice);
        Ok(thinned(values.len(), most).map(|row| values[row]).collect())
    }

    /// Whether there are columns of these names.
    pub(super) fn check(&self, directory: &RunDirectory, columns: &[String]) -> Result<(), ViewError> {
        let Some(table) = self.table(directory) else { return Ok(()) };
        match columns.iter().find(|name| table.column(name).is_none()) {
            Some(name) => Err(unknown_column(&table, name).into()),
            None => Ok(()),
        }
    }
}

/// Of so many things in a row at most so many: the first, the last, and others at equal distances.
pub(super) fn thinned(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let kept = count.min(most.max(1));
    (0..kept).map(move |k| {
        if kept == count {
            k
        } else if kept == 1 {
            count - 1
        } else {
            k * (count - 1) / (kept - 1)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_are_kept_and_nothing_twice() {
        let of = |count, most| thinned(count, most).collect::<Vec<_>>();
        assert_eq!(of(3, 9), [0, 1, 2]);
        assert_eq!(of(10, 4), [0, 3, 6, 9]);
        assert_eq!(of(11, 2), [0, 10]);
        assert_eq!((of(5, 1), of(0, 4)), (vec![4], vec![]));
        let many = of(1000, 999);
        assert!(many.windows(2).all(|pair| pair[0] < pair[1]) && many.len() == 999);
    }
}
