//! Runs side by side: measures, times, conservation.

use super::number::{four_digits, plain, plain_quantity};
use crate::output::{AuditRecord, DrivenRecord, MemoryOf, OutputError, RunDirectory, Status, Summary};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use serde::Serialize;
use std::{fmt, path::PathBuf};

/// Several runs and what can be said of each in one number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Names of the runs: their folders, or where two are called the same their paths.
    pub runs: Vec<String>,
    /// How each ended.
    pub status: Vec<Status>,
    /// What checks found broken in each, by name.
    pub warnings: Vec<Vec<String>>,
    /// What a program gave to each, if it did: its deck alone is another run.
    pub driven: Vec<Option<DrivenRecord>>,
    /// One row for each quantity, measures first.
    pub rows: Vec<ComparisonRow>,
}

/// A quantity in every run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonRow {
    /// What it is.
    pub quantity: String,
    /// SI unit, empty for pure numbers.
    pub unit: String,
    /// Whether a difference to the first run is worth showing: so for measures.
    pub is_measure: bool,
    /// Values by run, SI; none where a run does not have it.
    pub values: Vec<Option<f64>>,
}

impl Comparison {
    /// Reads the summaries of the runs.
    ///
    /// # Errors
    /// See [`Summary::read`].
    pub fn read(paths: &[PathBuf]) -> Result<Self, OutputError> {
        let summaries =
            paths.iter().map(|path| Summary::read(&RunDirectory::open(path)?)).collect::<Result<Vec<_>, _>>()?;
        let status = summaries.iter().map(|summary| summary.status).collect();
        let names = |summary: &Summary| summary.warnings.iter().map(|warning| warning.name.clone()).collect();
        let warnings = summaries.iter().map(names).collect();
        let driven = summaries.iter().map(|summary| summary.driven.clone()).collect();
        Ok(Self { runs: run_names(paths), status, warnings, driven, rows: rows(&summaries) })
    }
}

/// Short names that tell the runs apart.
pub fn run_names(paths: &[PathBuf]) -> Vec<String> {
    let short = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let is_unique = |name: &Option<String>| paths.iter().filter(|path| short(path) == *name).count() == 1;
    paths
        .iter()
        .map(|path| short(path).filter(|name| is_unique(&Some(name.clone()))).unwrap_or(path.display().to_string()))
        .collect()
}

fn rows(summaries: &[Summary]) -> Vec<ComparisonRow> {
    let mut rows: Vec<ComparisonRow> = Vec::new();
    for (name, unit) in summaries.iter().flat_map(|summary| &summary.measure_units) {
        if rows.iter().all(|row| row.quantity != *name) {
            let values = summaries.iter().map(|summary| summary.measures.get(name).copied().flatten()).collect();
            rows.push(ComparisonRow { quantity: name.clone(), unit: unit.clone(), is_measure: true, values });
        }
    }
    let mut add = |quantity: &str, unit: &str, value: &dyn Fn(&Summary) -> f64| {
        let values = summaries.iter().map(|summary| Some(value(summary)).filter(|x| x.is_finite())).collect();
        rows.push(ComparisonRow { quantity: quantity.into(), unit: unit.into(), is_measure: false, values });
    };
    let first_seconds = summaries.first().map_or(0.0, |summary| summary.wall_seconds);
    add("particles", "", &|s| s.particles as f64);
    add("steps", "", &|s| s.steps as f64);
    add("simulated time", "s", &|s| s.simulated_time);
    add("wall-clock time", "s", &|s| s.wall_seconds);
    add("speed-up", "", &|s| first_seconds / s.wall_seconds);
    add("time in search", "s", &|s| s.stage_seconds.search);
    add("time in pair sums", "s", &|s| s.stage_seconds.kinematics + s.stage_seconds.forces);
    add("time in steps", "s", &|s| {
        let t = &s.stage_seconds;
        t.search + t.kinematics + t.stress + t.forces + t.integrate
    });
    add("searched fraction", "", &|s| s.searched_fraction);
    if summaries.iter().any(|summary| summary.audit.is_some()) {
        let audited = |value: fn(&AuditRecord) -> f64| move |s: &Summary| s.audit.as_ref().map_or(f64::NAN, value);
        add("missed pairs, share", "", &audited(|a| a.missed_share));
        add("missed foreign pairs", "", &audited(|a| a.missed_foreign_pairs as f64));
        add("momentum residual", "", &audited(|a| a.momentum_residual));
    }
    add("neighbors", "", &|s| s.mean_neighbors);
    add("particle-steps per second", "1/s", &|s| s.particle_steps_per_second);
    // That of the engine alone is another quantity, which has a row of its own.
    let of_process = |s: &Summary| if s.peak_memory_of == MemoryOf::Process { s.peak_memory_bytes } else { 0 };
    add("peak memory", "B", &|s| if of_process(s) == 0 { f64::NAN } else { of_process(s) as f64 });
    let per_particle = |bytes: u64, s: &Summary| if bytes == 0 { f64::NAN } else { bytes as f64 / s.particles as f64 };
    add("peak memory, per particle", "B", &|s| per_particle(of_process(s), s));
    add("columns and lists, per particle", "B", &|s| per_particle(s.engine_memory_bytes, s));
    add("energy drift", "", &|s| s.energy.relative_drift);
    add("momentum drift", "", &|s| s.momentum_drift);
    add("threads", "", &|s| s.threads as f64);
    rows
}

impl ComparisonRow {
    /// The value in run `k` for people; a measure with its difference to the first run.
    fn text(&self, k: usize) -> String {
        let Some(value) = self.values[k] else { return "\u{2013}".into() };
        let text = match self.unit.as_str() {
            "B" if value < 1e5 => format!("{value:.0} B"),
            "B" if value < 1e6 => format!("{} kB", four_digits(value / 1e3)),
            "B" if value < 1e9 => format!("{} MB", four_digits(value / 1e6)),
            "B" => format!("{} GB", four_digits(value / 1e9)),
            "1/s" => format!("{value:.3e}"),
            // Counts are told to the last digit.
            "" if value.fract() == 0.0 && value.abs() < 1e15 => format!("{value:.0}"),
            "" if value != 0.0 && value.abs() < 1e-3 => format!("{value:.2e}"),
            // Seconds of waiting are not counted in kiloseconds.
            "s" if value >= 1.0 => format!("{} s", four_digits(value)),
            unit => plain_quantity(value, unit),
        };
        let text = plain(text);
        match self.values[0].filter(|first| self.is_measure && k > 0 && *first != 0.0) {
            Some(first) => format!("{text} ({:+.2} %)", 100.0 * (value / first - 1.0)),
            None => text,
        }
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = Table::new();
        table.load_style(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Dynamic);
        table.set_header(std::iter::once(String::new()).chain(self.runs.iter().cloned()));
        let status = self.status.iter().map(|status| status.name().to_owned());
        table.add_row(std::iter::once("status".to_owned()).chain(status));
        if self.warnings.iter().any(|names| !names.is_empty()) {
            let warnings = self.warnings.iter().map(|names| names.join(", "));
            table.add_row(std::iter::once("warnings".to_owned()).chain(warnings));
        }
        if self.driven.iter().any(Option::is_some) {
            let driven =
                self.driven.iter().map(|of| of.as_ref().map_or_else(|| "\u{2013}".to_owned(), ToString::to_string));
            table.add_row(std::iter::once("driven".to_owned()).chain(driven));
        }
        for row in &self.rows {
            let texts = (0..self.runs.len()).map(|k| row.text(k));
            table.add_row(std::iter::once(row.quantity.clone()).chain(texts));
        }
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        write!(f, "{table}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::testing;
    use std::{collections::BTreeMap, fs, path::Path};

    fn summary(seconds: f64, measures: &[(&str, Option<f64>)]) -> Summary {
        Summary {
            measures: measures.iter().map(|(name, value)| ((*name).into(), *value)).collect(),
            measure_units: measures.iter().map(|(name, _)| ((*name).into(), "m".into())).collect::<BTreeMap<_, _>>(),
            ..testing::summary(seconds)
        }
    }

    fn save(folder: &Path, name: &str, summary: &Summary) -> PathBuf {
        let run = RunDirectory::create(&folder.join(name), false).unwrap();
        summary.write(&run).unwrap();
        run.path().to_owned()
    }

    #[test]
    fn runs_are_set_against_the_first() {
        let folder = tempfile::tempdir().unwrap();
        let first = save(
            folder.path(),
            "a",
            &summary(4.0, &[("height", Some(0.02)), ("width", Some(0.015)), ("gap", Some(-3e-6))]),
        );
        let second = Summary { steps: 195_112, ..summary(2.0, &[("height", Some(0.021)), ("period", None)]) };
        let second = save(folder.path(), "b", &second);
        let comparison = Comparison::read(&[first, second]).unwrap();
        let row = |name: &str| comparison.rows.iter().find(|row| row.quantity == name).unwrap();
        assert_eq!(row("height").values, [Some(0.02), Some(0.021)]);
        assert_eq!(row("width").values, [Some(0.015), None]);
        assert_eq!(row("period").values, [None, None]);
        assert_eq!(row("speed-up").values, [Some(1.0), Some(2.0)]);
        assert_eq!((row("height").text(0), row("height").text(1)), ("20 mm".into(), "21 mm (+5.00 %)".into()));
        assert_eq!((row("peak memory").text(1), row("width").text(1)), ("10.49 MB".into(), "–".into()));
        assert_eq!(row("steps").text(1), "195112");
        assert_eq!(row("peak memory, per particle").text(0), "10486 B");
        assert_eq!(row("columns and lists, per particle").text(1), "900 B");
        let table = comparison.to_string();
        assert!(
            table.contains("searched fraction")
                && table.contains("0.25")
                && table.contains("4 s")
                && table.contains("-1.00e-9"),
            "{table}"
        );
        assert_eq!(comparison.status, [Status::Completed, Status::Completed]);
        assert!(!table.contains(['\u{2212}', 'µ']), "{table}");
        assert!(!table.contains("warnings") && !table.contains("driven"), "{table}");
    }

    #[test]
    fn what_a_program_gave_is_shown_and_memory_of_engines_is_not_that_of_processes() {
        let folder = tempfile::tempdir().unwrap();
        let driven = DrivenRecord { loads: vec!["bar".into()], motions: vec!["grip".into()] };
        let other = Summary { driven: Some(driven.clone()), peak_memory_of: MemoryOf::Engine, ..summary(2.0, &[]) };
        let paths = [save(folder.path(), "a", &summary(4.0, &[])), save(folder.path(), "b", &other)];
        let comparison = Comparison::read(&paths).unwrap();
        assert_eq!(comparison.driven, [None, Some(driven)]);
        let table = comparison.to_string();
        assert!(table.contains("by a program: load on `bar`; velocity of `grip`"), "{table}");
        for name in ["peak memory", "peak memory, per particle"] {
            let row = comparison.rows.iter().find(|row| row.quantity == name).unwrap();
            assert!(row.values[0].is_some() && row.values[1].is_none(), "{row:?}");
        }
    }

    #[test]
    fn what_is_broken_is_shown_below_how_it_ended() {
        let folder = tempfile::tempdir().unwrap();
        let broken = Summary {
            status: Status::CompletedWithWarnings,
            warnings: vec![testing::warning("pairing"), testing::warning("hot")],
            ..summary(2.0, &[])
        };
        let paths = [save(folder.path(), "a", &summary(4.0, &[])), save(folder.path(), "b", &broken)];
        let comparison = Comparison::read(&paths).unwrap();
        assert_eq!(comparison.warnings, [vec![], vec!["pairing".to_owned(), "hot".to_owned()]]);
        let table = comparison.to_string();
        assert!(table.contains("completed with warnings") && table.contains("pairing, hot"), "{table}");
    }

    #[test]
    fn runs_of_one_name_are_called_by_their_path() {
        let names = run_names(&["x/run".into(), "y/run".into(), "x/other".into()]);
        assert_eq!(names, ["x/run", "y/run", "other"]);
    }

    #[test]
    fn a_run_without_or_with_a_broken_summary_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let run = save(folder.path(), "a", &summary(1.0, &[]));
        fs::write(run.join("summary.json"), "{\"status\": \"completed\"").unwrap();
        assert!(matches!(Comparison::read(std::slice::from_ref(&run)), Err(OutputError::Damaged { .. })));
        fs::remove_file(run.join("summary.json")).unwrap();
        assert!(matches!(Comparison::read(std::slice::from_ref(&run)), Err(OutputError::Read { .. })));
        fs::write(run.join("deck.toml"), "").unwrap();
        assert!(matches!(Comparison::read(&[run]), Err(OutputError::NotEnded { .. })));
        assert!(matches!(Comparison::read(&[folder.path().join("none")]), Err(OutputError::NoRun { .. })));
    }
}
