//! Curves of the history.

use super::{
    ColumnsPicture, Paper, PlotError,
    chart::{Chart, Curve, page, time},
    title::{run_title, title_of},
};
use crate::{
    deck::{did_you_mean, names_like},
    output::{HistoryTable, MEASURE_MEANING, RunDirectory},
};
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

/// Draws one of the standard pictures to a PNG or SVG file. Returns false if the history has nothing for it.
///
/// # Errors
/// [`PlotError::Output`] if the history cannot be read or the picture cannot be written.
pub fn plot_history(run: &RunDirectory, picture: HistoryPicture, paper: Paper, to: &Path) -> Result<bool, PlotError> {
    let table = HistoryTable::read(run)?;
    let chart = |quantity: &str, columns: &[(&str, &str)]| {
        // A curve that is zero but for round-off says nothing but its name; keep those that the case has.
        let curves: Vec<_> = columns.iter().filter_map(|(column, name)| curve(&table, column, name)).collect();
        let size = |c: &Curve| c.points.iter().map(|p| p.1.abs()).filter(|x| x.is_finite()).fold(0.0, f64::max);
        let largest = curves.iter().map(size).fold(0.0, f64::max);
        let some: Vec<_> = curves.iter().filter(|c| size(c) > 1e-6 * largest).cloned().collect();
        let unit = columns.first().and_then(|(column, _)| table.column(column)).map(|(column, _)| column.unit.clone());
        Chart {
            along: time(),
            limits: None,
            walls: Vec::new(),
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
                    ("viscous_energy", "viscosity"),
                    ("hourglass_energy", "hourglass springs"),
                    ("artificial_stress_energy", "artificial stress"),
                    ("fracture_energy", "fracture"),
                ],
            ),
            chart("energy drift", &[("energy_drift", "drift")]),
        ],
        HistoryPicture::Momentum => vec![
            named(chart("momentum", &[("momentum_x", "x"), ("momentum_y", "y"), ("momentum_z", "z")])),
            chart("momentum drift", &[("momentum_drift", "drift")]),
        ],
        HistoryPicture::Measures => measure_names(&table)
            .iter()
            .map(|name| chart(&words(name), &[(name, name)]))
            .filter(Chart::has_values)
            .collect(),
        HistoryPicture::Step => vec![chart("time step", &[("dt", "dt")])],
    };
    if !charts.iter().any(Chart::has_values) {
        return Ok(false);
    }
    let columns = if picture == HistoryPicture::Measures && charts.len() > 1 { 2 } else { 1 };
    page(&charts, columns, &run_title(run), None, paper)?.save(to)?;
    Ok(true)
}

/// A chart of components with a single curve says which it is: one curve has no legend.
fn named(chart: Chart) -> Chart {
    match &chart.curves[..] {
        [only] => Chart { quantity: format!("{} {}", chart.quantity, only.name), ..chart },
        _ => chart,
    }
}

/// Draws columns of the history to a PNG or SVG file, those of one unit in one chart.
///
/// # Errors
/// [`PlotError::Column`] for a column the history does not have, [`PlotError::Empty`] if none has a value, otherwise as
/// [`plot_history`].
pub fn plot_columns(run: &RunDirectory, columns: &[String], paper: Paper, to: &Path) -> Result<(), PlotError> {
    let title = run_title(run);
    page(&of(columns).charts(&[("", run)])?, 1, &title, None, paper)?.save(to)
}

/// Draws columns of the history of several runs, under the given names, over each other: a chart for each column.
///
/// # Errors
/// As [`plot_columns`]; the column that is missing in one of the runs is an error too.
pub fn plot_columns_of_runs(
    runs: &[(String, RunDirectory)],
    columns: &[String],
    paper: Paper,
    to: &Path,
) -> Result<(), PlotError> {
    let runs: Vec<_> = runs.iter().map(|(name, run)| (name.as_str(), run)).collect();
    let title = title_of(&runs);
    page(&of(columns).charts(&runs)?, 1, &title, None, paper)?.save(to)
}

fn of(columns: &[String]) -> ColumnsPicture {
    ColumnsPicture { columns: columns.to_vec(), ..ColumnsPicture::default() }
}

/// A column for people.
pub(super) fn words(column: &str) -> String {
    column.trim_start_matches("measure.").replace('_', " ")
}

/// The measures that all of some runs have.
///
/// # Errors
/// [`PlotError::Output`] if a history cannot be read.
pub fn common_measures(runs: &[(String, RunDirectory)]) -> Result<Vec<String>, PlotError> {
    let mut common: Option<Vec<String>> = None;
    for (_, run) in runs {
        let own = measure_names(&HistoryTable::read(run)?);
        common = Some(common.map_or(own.clone(), |names| names.into_iter().filter(|n| own.contains(n)).collect()));
    }
    Ok(common.unwrap_or_default())
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
    paper: Paper,
    to: &Path,
) -> Result<(), PlotError> {
    let mut chart = Chart {
        along: time(),
        quantity: words(column),
        unit: String::new(),
        curves: Vec::new(),
        limits: None,
        walls: Vec::new(),
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
    let runs: Vec<_> = runs.iter().map(|(name, run)| (name.as_str(), run)).collect();
    page(&[chart], 1, &title_of(&runs), None, paper)?.save(to)
}

pub(crate) fn unknown_column(table: &HistoryTable, name: &str) -> PlotError {
    let available = table.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>().join(", ");
    let near = did_you_mean(names_like(name, table.columns.iter().map(|column| column.name.as_str())));
    PlotError::Column { name: name.to_owned(), near, available }
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
