//! Columns of histories over time or over each other, as curves or as numbers.

use super::{
    Paper, PlotError,
    chart::{Chart, Curve, page, time},
    history::{unknown_column, words},
    save::write,
    title::title_of,
};
use crate::output::{HistoryTable, RunDirectory};
use std::{fmt::Write as _, path::Path};

/// Columns of the history over time or another column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnsPicture {
    /// Columns, those of one unit in one chart.
    pub columns: Vec<String>,
    /// Column along the page; time if not given.
    pub along: Option<String>,
    /// Factors on columns.
    pub factors: Vec<(String, f64)>,
    /// Columns of which the change since the first row is shown.
    pub from_start: Vec<String>,
    /// Size and fineness.
    pub paper: Paper,
}

/// A column as it is shown.
struct Shown {
    /// For people.
    label: String,
    /// For programs: the name of the column, with what was done to it.
    head: String,
    unit: String,
    values: Vec<f64>,
}

impl ColumnsPicture {
    /// Draws runs, under their names where there are several, to a PNG or SVG file, or writes the numbers to a CSV file, as the name ends.
    ///
    /// # Errors
    /// [`PlotError::Column`] for a column that a history does not have, [`PlotError::Empty`] if none has a value,
    /// [`PlotError::Output`] if a history cannot be read or the file cannot be written.
    pub fn save(&self, runs: &[(String, RunDirectory)], to: &Path) -> Result<(), PlotError> {
        // A name that no column has would change nothing.
        for name in self.factors.iter().map(|(name, _)| name).chain(&self.from_start) {
            if !self.columns.contains(name) && self.along.as_ref() != Some(name) {
                return Err(PlotError::Empty { reason: format!("`{name}` is not among the columns to draw") });
            }
        }
        if to.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) {
            return write(to, self.table(runs)?.as_bytes());
        }
        let named = |(name, run)| (if runs.len() > 1 { name } else { "" }, run);
        let runs: Vec<_> = runs.iter().map(|(name, run)| named((name.as_str(), run))).collect();
        page(&self.charts(&runs)?, 1, &title_of(&runs), None, self.paper)?.save(to)
    }

    /// A column of a history.
    fn shown(&self, table: &HistoryTable, name: &str) -> Result<Shown, PlotError> {
        let (column, values) = table.column(name).ok_or_else(|| unknown_column(table, name))?;
        let factor = self.factors.iter().find(|(of, _)| of == name).map_or(1.0, |(_, factor)| *factor);
        let is_change = self.from_start.iter().any(|of| of == name);
        let start = if is_change { values.iter().copied().find(|x| x.is_finite()).unwrap_or(0.0) } else { 0.0 };
        let words = if is_change { format!("change of {}", words(name)) } else { words(name) };
        let label =
            if factor == 1.0 { words } else { format!("{} × {words}", factor.to_string().replace('-', "−")) };
        let name = if is_change { format!("change of {name}") } else { name.to_owned() };
        let head = if factor == 1.0 { name } else { format!("{factor} * {name}") };
        // A zero has no sign for people.
        let values = values.iter().map(|x| factor * (x - start) + 0.0).collect();
        Ok(Shown { label, head, unit: column.unit.clone(), values })
    }

    /// A chart for each unit of a run, or for each column of several.
    pub(super) fn charts(&self, runs: &[(&str, &RunDirectory)]) -> Result<Vec<Chart>, PlotError> {
        let mut charts: Vec<Chart> = Vec::new();
        for (k, (run_name, run)) in runs.iter().enumerate() {
            let table = HistoryTable::read(run)?;
            let along = self.shown(&table, self.along.as_deref().unwrap_or("time"))?;
            let axis = if self.along.is_some() { (along.label.clone(), along.unit.clone()) } else { time() };
            for name in &self.columns {
                let Shown { label, unit, values, .. } = self.shown(&table, name)?;
                let points = along.values.iter().copied().zip(values).collect();
                let curve_name = if run_name.is_empty() { label.clone() } else { (*run_name).to_owned() };
                let curve = Curve { name: curve_name, points, marked: false };
                let same =
                    |chart: &&mut Chart| if runs.len() > 1 { chart.quantity == label } else { chart.unit == unit };
                match charts.iter_mut().find(same) {
                    Some(chart) => {
                        if k == 0 {
                            chart.quantity = format!("{}, {label}", chart.quantity);
                        }
                        chart.curves.push(curve);
                    }
                    None => charts.push(Chart {
                        along: axis.clone(),
                        quantity: label,
                        unit,
                        curves: vec![curve],
                        limits: None,
                        walls: Vec::new(),
                    }),
                }
            }
        }
        if !charts.iter().any(Chart::has_values) {
            return Err(PlotError::Empty { reason: "the columns contain no numbers".into() });
        }
        Ok(charts)
    }

    /// The numbers as comma-separated values: a row for each row of a history, with the name of its run where there are several.
    fn table(&self, runs: &[(String, RunDirectory)]) -> Result<String, PlotError> {
        let mut text = String::new();
        for (k, (run_name, run)) in runs.iter().enumerate() {
            let table = HistoryTable::read(run)?;
            let names =
                std::iter::once(self.along.as_deref().unwrap_or("time")).chain(self.columns.iter().map(String::as_str));
            let columns = names.map(|name| self.shown(&table, name)).collect::<Result<Vec<_>, _>>()?;
            if k == 0 {
                let heads = columns.iter().map(|column| match column.unit.as_str() {
                    "" => column.head.clone(),
                    unit => format!("{} ({unit})", column.head),
                });
                let first = (runs.len() > 1).then(|| "run".to_owned());
                let heads: Vec<String> = first.into_iter().chain(heads).map(|head| quoted(&head)).collect();
                let _ = writeln!(text, "{}", heads.join(","));
            }
            for row in 0..columns.first().map_or(0, |column| column.values.len()) {
                let number = |x: f64| if x.is_finite() { format!("{x:e}") } else { String::new() };
                let cells = columns.iter().map(|column| number(column.values[row]));
                let first = (runs.len() > 1).then(|| quoted(run_name));
                let cells: Vec<String> = first.into_iter().chain(cells).collect();
                let _ = writeln!(text, "{}", cells.join(","));
            }
        }
        Ok(text)
    }
}

/// A cell that commas and quotation marks do not cut.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn run(folder: &Path, name: &str, history: &str) -> (String, RunDirectory) {
        let run = RunDirectory::create(&folder.join(name), false).unwrap();
        fs::write(run.history(), history).unwrap();
        (name.to_owned(), run)
    }

    fn force_over_length() -> ColumnsPicture {
        ColumnsPicture {
            columns: vec!["force".into()],
            along: Some("length".into()),
            factors: vec![("force".into(), -4.0), ("length".into(), 10.0)],
            from_start: vec!["length".into()],
            paper: Paper::default(),
        }
    }

    #[test]
    fn a_force_is_drawn_over_an_elongation_with_the_factors_that_are_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let (_, run) = run(folder.path(), "a", "time,length,force\n0,5,0\n1,5.5,-2\n2,6,\n3,5.25,-1\n");
        let charts = force_over_length().charts(&[("", &run)]).unwrap();
        let [chart] = &charts[..] else { panic!("{charts:?}") };
        assert_eq!((chart.along.0.as_str(), chart.quantity.as_str()), ("10 × change of length", "−4 × force"));
        let points = &chart.curves[0].points;
        // The way back is a part of the curve.
        assert_eq!([points[0], points[1], points[3]], [(0.0, 0.0), (5.0, 8.0), (2.5, 4.0)]);
        assert!(points[2].0 == 10.0 && points[2].1.is_nan());
    }

    #[test]
    fn numbers_are_written_with_the_name_of_their_run() {
        let folder = tempfile::tempdir().unwrap();
        let runs =
            [("a,b", "1,2"), ("c", "3,")].map(|(name, row)| run(folder.path(), name, &format!("time,force\n{row}\n")));
        let to = folder.path().join("new/numbers.csv");
        let picture = ColumnsPicture { columns: vec!["force".into()], ..ColumnsPicture::default() };
        picture.save(&runs, &to).unwrap();
        assert_eq!(fs::read_to_string(&to).unwrap(), "run,time,force\n\"a,b\",1e0,2e0\nc,3e0,\n");
        picture.save(&runs[1..], &to).unwrap();
        assert_eq!(fs::read_to_string(&to).unwrap(), "time,force\n3e0,\n");
        // Columns are called as in the history, whatever was done to them.
        let (_, run) = self::run(folder.path(), "d", "time,rod.force_z,lowest_point\n0,2,5\n1,4,4\n");
        let picture = ColumnsPicture {
            columns: vec!["rod.force_z".into()],
            along: Some("lowest_point".into()),
            factors: vec![("lowest_point".into(), -1.0)],
            from_start: vec!["lowest_point".into()],
            paper: Paper::default(),
        };
        picture.save(&[("d".to_owned(), run)], &to).unwrap();
        let text = fs::read_to_string(&to).unwrap();
        assert_eq!(text, "-1 * change of lowest_point,rod.force_z\n0e0,2e0\n1e0,4e0\n");
    }

    #[test]
    fn a_column_that_is_not_there_or_not_drawn_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let runs = [run(folder.path(), "a", "time,force\n1,2\n")];
        let to = folder.path().join("p.csv");
        let error = |picture: ColumnsPicture| picture.save(&runs, &to).unwrap_err();
        assert!(matches!(error(force_over_length()), PlotError::Column { .. }));
        let factors = vec![("height".to_owned(), 2.0)];
        let unused = ColumnsPicture { columns: vec!["force".into()], factors, ..ColumnsPicture::default() };
        assert!(error(unused).to_string().contains("`height` is not among the columns to draw"));
        assert!(!to.exists());
    }
}
