//! The table of a sweep: what was changed in each run, how it ended, what was measured.

use super::Sweep;
use crate::{
    number::{plain, plain_quantity},
    output::{Durability, OutputError, RunDirectory, Status, Summary, write_file},
};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use std::{
    collections::{BTreeMap, HashMap},
    fmt,
    path::Path,
};

/// Name of the file.
const FILE: &str = "sweep.csv";

/// A quantity with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepColumn {
    /// Key or measure.
    pub name: String,
    /// SI unit, empty for pure numbers and for what is none.
    pub unit: String,
}

/// All runs of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepTable {
    /// The keys that were varied.
    pub keys: Vec<SweepColumn>,
    /// The measures that any of the runs has.
    pub measures: Vec<SweepColumn>,
    /// The runs.
    pub rows: Vec<SweepRow>,
}

/// A run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SweepRow {
    /// Name of its folder.
    pub run: String,
    /// Value of each key, as it was given.
    pub values: Vec<String>,
    /// The same as numbers, SI; none where the values of a key are not all quantities of one kind.
    pub numbers: Vec<Option<f64>>,
    /// How the run ended; none while it has not.
    pub summary: Option<Box<Summary>>,
    /// What the program told where it could not make the run.
    pub told: Option<String>,
}

/// The number that each value of each key is, where all of the key are.
pub(super) struct Numbers(Vec<HashMap<String, f64>>);

impl Numbers {
    pub(super) fn of(sweep: &Sweep) -> Self {
        let of_key = |of: &super::Varied| {
            let numbers = of.numbers().map(|(numbers, _)| numbers).unwrap_or_default();
            of.values.iter().cloned().zip(numbers).collect()
        };
        Self(sweep.varied.iter().map(of_key).collect())
    }
}

impl SweepRow {
    /// A run with what its folder says of it.
    pub(super) fn read(sweep: &Sweep, k: usize, numbers: &Numbers) -> Self {
        let run = &sweep.runs[k];
        let number = |(key, value): (usize, &String)| numbers.0[key].get(value).copied();
        let summary = RunDirectory::open(&sweep.directory(run)).and_then(|folder| Summary::read(&folder)).ok();
        Self {
            run: run.name.clone(),
            values: run.values.clone(),
            numbers: run.values.iter().enumerate().map(number).collect(),
            summary: summary.map(Box::new),
            told: None,
        }
    }

    /// How it ended, in a word or two.
    pub fn status(&self) -> &'static str {
        match (&self.summary, &self.told) {
            (Some(summary), None) => summary.status.name(),
            (Some(summary), Some(_)) if summary.status == Status::Failed => summary.status.name(),
            (_, Some(_)) => "not run",
            (None, None) => "unfinished",
        }
    }

    /// Whether it has reached its end.
    pub fn is_complete(&self) -> bool {
        let is_end = |status| matches!(status, Status::Completed | Status::CompletedWithWarnings);
        self.told.is_none() && self.summary.as_ref().is_some_and(|summary| is_end(summary.status))
    }

    /// Value of a measure, SI, of a run that has reached its end.
    pub fn measure(&self, name: &str) -> Option<f64> {
        let summary = self.summary.as_ref().filter(|_| self.is_complete())?;
        summary.measures.get(name).copied().flatten()
    }

    /// Names of the warnings.
    pub fn warnings(&self) -> Vec<&str> {
        self.summary.iter().flat_map(|summary| &summary.warnings).map(|warning| warning.name.as_str()).collect()
    }
}

impl SweepTable {
    /// The table as the folders of the runs tell it now.
    pub fn read(sweep: &Sweep) -> Self {
        let key = |of: &super::Varied| SweepColumn {
            name: of.key.clone(),
            unit: of.numbers().map_or_else(String::new, |(_, unit)| unit.to_owned()),
        };
        let numbers = Numbers::of(sweep);
        let rows = (0..sweep.runs.len()).map(|k| SweepRow::read(sweep, k, &numbers)).collect();
        let mut table = Self { keys: sweep.varied.iter().map(key).collect(), measures: Vec::new(), rows };
        table.find_measures();
        table
    }

    /// Brings the columns of measures to what the runs have.
    pub(super) fn find_measures(&mut self) {
        let units: BTreeMap<&String, &String> = self
            .rows
            .iter()
            .filter_map(|row| row.summary.as_ref())
            .flat_map(|summary| &summary.measure_units)
            .collect();
        self.measures =
            units.into_iter().map(|(name, unit)| SweepColumn { name: name.clone(), unit: unit.clone() }).collect();
    }

    /// The table as comma-separated values, SI, with units in the first line.
    pub fn csv(&self) -> String {
        let head = |column: &SweepColumn| match column.unit.as_str() {
            "" => column.name.clone(),
            unit => format!("{} ({unit})", column.name),
        };
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut lines = vec![
            [
                own(&["run"]),
                self.keys.iter().map(head).collect(),
                own(&["status", "warnings"]),
                self.measures.iter().map(head).collect(),
                own(&["simulated_time (s)", "wall_seconds (s)", "steps", "particles", "energy_drift"]),
            ]
            .concat(),
        ];
        let number = |x: Option<f64>| x.filter(|x| x.is_finite()).map_or_else(String::new, |x| x.to_string());
        for row in &self.rows {
            let value = |(number, text): (&Option<f64>, &String)| number.map_or(text.clone(), |x| x.to_string());
            let of = |pick: &dyn Fn(&Summary) -> f64| number(row.summary.as_ref().map(|summary| pick(summary)));
            lines.push(
                [
                    vec![row.run.clone()],
                    row.numbers.iter().zip(&row.values).map(value).collect(),
                    vec![row.status().to_owned(), row.warnings().join(" ")],
                    self.measures.iter().map(|measure| number(row.measure(&measure.name))).collect(),
                    vec![
                        of(&|summary| summary.simulated_time),
                        of(&|summary| summary.wall_seconds),
                        of(&|summary| summary.steps as f64),
                        of(&|summary| summary.particles as f64),
                        of(&|summary| summary.energy.relative_drift),
                    ],
                ]
                .concat(),
            );
        }
        let mut text = csv::Writer::from_writer(Vec::new());
        // Memory takes all that is written to it, and all lines have the same length.
        let written = lines.iter().all(|line| text.write_record(line).is_ok());
        let bytes = text.into_inner().unwrap_or_default();
        debug_assert!(written);
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// Writes `sweep.csv`.
    pub(super) fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let text = self.csv();
        write_file(&folder.join(FILE), Durability::Process, |out| out.write_all(text.as_bytes()))
    }

    /// A measure over a key that has numbers: a curve for each combination of the other values, by its name, of the runs that have reached their end,
    /// in the order of the key.
    pub fn curves(&self, measure: &str, key: usize) -> Vec<(String, Vec<(f64, f64)>)> {
        let mut curves: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
        for row in &self.rows {
            let Some(point) = row.numbers.get(key).copied().flatten().zip(row.measure(measure)) else { continue };
            let others = (0..self.keys.len()).filter(|k| *k != key);
            let name: Vec<String> =
                others.map(|k| format!("{} = {}", short(&self.keys[k].name), row.values[k])).collect();
            let name = name.join(", ");
            match curves.iter_mut().find(|(known, _)| *known == name) {
                Some((_, points)) => points.push(point),
                None => curves.push((name, vec![point])),
            }
        }
        curves.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
        curves
    }
}

/// A value without its quotation marks.
pub(super) fn unquoted(value: &str) -> String {
    let inside = value.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
    inside.filter(|inside| !inside.contains(['"', '\\'])).unwrap_or(value).to_owned()
}

/// The last word of a key.
fn short(key: &str) -> &str {
    let last = key.rsplit('.').next().unwrap_or(key);
    // A component says little alone.
    if last.bytes().all(|byte| byte.is_ascii_digit()) { key } else { last }
}

impl fmt::Display for SweepTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = Table::new();
        table.load_style(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Disabled);
        let names = |columns: &[SweepColumn]| columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
        table.set_header(
            [names(&self.keys), vec!["status".to_owned()], names(&self.measures), vec!["time".to_owned()]].concat(),
        );
        for row in &self.rows {
            let warnings = row.warnings();
            let status = match row.summary.as_ref().map(|summary| summary.status) {
                Some(Status::CompletedWithWarnings) if row.told.is_none() => {
                    format!("warnings: {}", warnings.join(", "))
                }
                _ => row.status().to_owned(),
            };
            let measure = |column: &SweepColumn| match row.measure(&column.name) {
                Some(value) => plain(plain_quantity(value, &column.unit)),
                None => "\u{2013}".to_owned(),
            };
            let seconds =
                row.summary.as_ref().map_or_else(|| "\u{2013}".to_owned(), |s| format!("{:.1} s", s.wall_seconds));
            let values = row.values.iter().map(|value| unquoted(value)).collect();
            table.add_row([values, vec![status], self.measures.iter().map(measure).collect(), vec![seconds]].concat());
        }
        for (k, column) in table.column_iter_mut().enumerate() {
            if k != self.keys.len() {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        write!(f, "{table}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::testing;

    fn row(values: [&str; 2], numbers: [Option<f64>; 2], status: Status, height: Option<f64>) -> SweepRow {
        let summary = Summary {
            status,
            measures: BTreeMap::from([("height".to_owned(), height)]),
            measure_units: BTreeMap::from([("height".to_owned(), "m".to_owned())]),
            ..testing::summary(2.0)
        };
        SweepRow {
            run: values.join(","),
            values: values.map(str::to_owned).to_vec(),
            numbers: numbers.to_vec(),
            summary: Some(Box::new(summary)),
            told: None,
        }
    }

    fn table() -> SweepTable {
        let column = |name: &str, unit: &str| SweepColumn { name: name.to_owned(), unit: unit.to_owned() };
        let mut table = SweepTable {
            keys: vec![column("particles.spacing", "m"), column("search", "")],
            measures: Vec::new(),
            rows: vec![
                row(["0.6 mm", "skin"], [Some(6e-4), None], Status::Completed, Some(0.021)),
                row(["0.3 mm", "skin"], [Some(3e-4), None], Status::CompletedWithWarnings, Some(0.02)),
                row(["0.6 mm", "every-step"], [Some(6e-4), None], Status::Stopped, Some(0.5)),
                SweepRow {
                    run: "x".into(),
                    values: vec!["0.3 mm".into(), "a,b".into()],
                    numbers: vec![Some(3e-4), None],
                    ..SweepRow::default()
                },
            ],
        };
        table.rows[1].summary.as_mut().unwrap().warnings = vec![testing::warning("hot")];
        table.rows[3].told = Some("another run writes to it".to_owned());
        table.find_measures();
        table
    }

    #[test]
    fn the_file_has_si_numbers_with_units_and_values_of_runs_that_ended_alone() {
        let text = table().csv();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("run,particles.spacing (m),search,status,warnings,height (m),simulated_time (s)"));
        assert!(lines[1].starts_with("\"0.6 mm,skin\",0.0006,skin,completed,,0.021,"), "{}", lines[1]);
        assert!(lines[2].starts_with("\"0.3 mm,skin\",0.0003,skin,completed with warnings,hot,0.02,"), "{}", lines[2]);
        assert!(lines[3].contains(",stopped,,,"), "{}", lines[3]);
        assert!(lines[4].starts_with("x,0.0003,\"a,b\",not run,,,,"), "{}", lines[4]);
    }

    #[test]
    fn people_are_shown_values_as_given_and_what_is_wrong() {
        let text = table().to_string();
        for shown in ["0.6 mm", "skin", "21 mm", "warnings: hot", "stopped", "not run", "2.0 s"] {
            assert!(text.contains(shown), "`{shown}` is not in:\n{text}");
        }
        assert!(!text.contains("0.5 m") && !text.contains("500 mm"), "{text}");
    }

    #[test]
    fn only_quotation_marks_around_a_value_are_left_out() {
        for (value, shown) in
            [("\"0.6 mm\"", "0.6 mm"), ("it's, \"x\"", "it's, \"x\""), ("\"", "\""), ("\"a\" \"b\"", "\"a\" \"b\"")]
        {
            assert_eq!(unquoted(value), shown);
        }
    }

    #[test]
    fn curves_go_along_a_key_one_for_each_of_the_other_values() {
        let curves = table().curves("height", 0);
        assert_eq!(curves, [("search = skin".to_owned(), vec![(3e-4, 0.02), (6e-4, 0.021)])]);
        assert!(table().curves("height", 1).is_empty());
    }
}
