//! Curves of the history.

use super::{
    PlotError,
    chart::{Chart, Curve, TIME, page},
    title::run_title,
};
use crate::output::{HistoryTable, MEASURE_MEANING, RunDirectory};
use std::path::Path;

/// The standard pictures of a history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HistoryPicture {
    /// Where the energy is, and its drift.
    Energy,
    /// Linear momentum by axis, and its drift.
    Momentum,
    /// Every declared measure.
    Measures,
    /// Size of the time steps.
    Step,
}

impl HistoryPicture {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Energy, Self::Momentum, Self::Measures, Self::Step];

    /// Word in the name of the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Momentum => "momentum",
            Self::Measures => "measures",
            Self::Step => "step",
        }
    }
}

/// Draws one of the standard pictures to a PNG file. Returns false if the history has nothing for it.
///
/// # Errors
/// [`PlotError::Output`] if the history cannot be read or the picture cannot be written.
pub fn plot_history(run: &RunDirectory, picture: HistoryPicture, to: &Path) -> Result<bool, PlotError> {
    let table = HistoryTable::read(run)?;
    let chart = |quantity: &str, columns: &[(&str, &str)]| {
        // A curve that is zero but for round-off says nothing but its name; keep those that the case has.
        let curves: Vec<_> = columns.iter().filter_map(|(column, name)| curve(&table, column, name)).collect();
        let size = |c: &Curve| c.points.iter().map(|p| p.1.abs()).filter(|x| x.is_finite()).fold(0.0, f64::max);
        let largest = curves.iter().map(size).fold(0.0, f64::max);
        let some: Vec<_> = curves.iter().filter(|c| size(c) > 1e-6 * largest).cloned().collect();
        let unit = columns.first().and_then(|(column, _)| table.column(column)).map(|(column, _)| column.unit.clone());
        Chart {
            along: TIME,
            limits: None,
            quantity: quantity.into(),
            unit: unit.unwrap_or_default(),
            curves: if some.is_empty() { curves } else { some },
        }
    };
    let charts = match picture {
        HistoryPicture::Energy => vec![
            chart(
                "energy",
                &[
                    ("total_energy", "total"),
                    ("kinetic_energy", "kinetic"),
                    ("internal_energy", "internal"),
                    ("elastic_energy", "elastic"),
                    ("plastic_work", "plastic work"),
                    ("external_work", "external work"),
                ],
            ),
            chart("energy drift", &[("energy_drift", "drift")]),
        ],
        HistoryPicture::Momentum => vec![
            chart("momentum", &[("momentum_x", "x"), ("momentum_y", "y"), ("momentum_z", "z")]),
            chart("momentum drift", &[("momentum_drift", "drift")]),
        ],
        HistoryPicture::Measures => measure_names(&table)
            .iter()
            .map(|name| chart(&name.trim_start_matches("measure.").replace('_', " "), &[(name, name)]))
            .filter(Chart::has_values)
            .collect(),
        HistoryPicture::Step => vec![chart("time step", &[("dt", "dt")])],
    };
    if !charts.iter().any(Chart::has_values) {
        return Ok(false);
    }
    let columns = if picture == HistoryPicture::Measures && charts.len() > 1 { 2 } else { 1 };
    page(&charts, columns, &run_title(run), None)?.save(to)?;
    Ok(true)
}

/// Draws columns of the history to a PNG file, those of one unit in one chart.
///
/// # Errors
/// [`PlotError::Column`] for a column the history does not have, [`PlotError::Empty`] if none has a value, otherwise as
/// [`plot_history`].
pub fn plot_columns(run: &RunDirectory, columns: &[String], to: &Path) -> Result<(), PlotError> {
    let table = HistoryTable::read(run)?;
    let mut charts: Vec<Chart> = Vec::new();
    for name in columns {
        let (column, _) = table.column(name).ok_or_else(|| unknown_column(&table, name))?;
        let Some(curve) = curve(&table, name, name) else { continue };
        match charts.iter_mut().find(|chart| chart.unit == column.unit) {
            Some(chart) => {
                chart.quantity = format!("{}, {name}", chart.quantity);
                chart.curves.push(curve);
            }
            None => charts.push(Chart {
                along: TIME,
                quantity: name.clone(),
                unit: column.unit.clone(),
                curves: vec![curve],
                limits: None,
            }),
        }
    }
    if !charts.iter().any(Chart::has_values) {
        return Err(PlotError::Empty { reason: "the columns hold no number".into() });
    }
    page(&charts, 1, &run_title(run), None)?.save(to)
}

/// Draws one column of the history of several runs over each other, under the given names, with points of others `beside` them: time in s
/// and value in SI, as hollow squares.
///
/// # Errors
/// As [`plot_columns`].
pub fn plot_overlay(
    runs: &[(String, RunDirectory)],
    column: &str,
    beside: &[(String, Vec<(f64, f64)>)],
    to: &Path,
) -> Result<(), PlotError> {
    let mut chart = Chart {
        along: TIME,
        quantity: column.replace('_', " "),
        unit: String::new(),
        curves: Vec::new(),
        limits: None,
    };
    for (name, run) in runs {
        let table = HistoryTable::read(run)?;
        let (description, _) = table.column(column).ok_or_else(|| unknown_column(&table, column))?;
        chart.unit = description.unit.clone();
        chart.curves.extend(curve(&table, column, name));
    }
    let others = beside.iter().map(|(name, points)| (name.clone(), points.clone()));
    chart.curves.extend(others.map(|(name, points)| Curve { name, points, marked: true }));
    if !chart.has_values() {
        return Err(PlotError::Empty { reason: format!("no run has a number in `{column}`") });
    }
    let title = runs.first().map_or(String::new(), |(_, run)| run_title(run));
    page(&[chart], 1, &title, None)?.save(to)
}

fn unknown_column(table: &HistoryTable, name: &str) -> PlotError {
    let available = table.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ");
    PlotError::Column { name: name.to_owned(), available }
}

/// A column over time.
fn curve(table: &HistoryTable, column: &str, name: &str) -> Option<Curve> {
    let (_, times) = table.column("time")?;
    let (_, values) = table.column(column)?;
    let points = times.iter().copied().zip(values.iter().copied()).collect();
    Some(Curve { name: name.to_owned(), points, marked: false })
}

/// Columns that hold measures.
fn measure_names(table: &HistoryTable) -> Vec<String> {
    let measures = table.columns.iter().filter(|column| column.meaning == MEASURE_MEANING);
    measures.map(|column| column.name.clone()).collect()
}
