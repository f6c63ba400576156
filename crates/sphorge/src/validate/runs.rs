//! The runs of a case.

use super::{Case, ValidateError, ValidateOptions, Variant, Watcher, folder::Folder};
use crate::{
    deck, decks,
    output::{HistoryTable, RunDirectory, Status, Summary},
    run::{RunError, RunOptions, execute},
};
use std::{path::PathBuf, sync::atomic::AtomicBool};

/// What a run left behind.
#[derive(Clone, Debug)]
pub(super) struct Finished {
    pub(super) summary: Summary,
    pub(super) history: HistoryTable,
}

/// A run of a case.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) variant: Variant,
    /// Particle spacing of the deck as run, m.
    pub(super) spacing: f64,
    pub(super) directory: PathBuf,
    /// What it left, or why it failed.
    pub(super) outcome: Result<Finished, String>,
}

/// All runs of a case.
#[derive(Clone, Debug)]
pub(super) struct Runs(pub(super) Vec<Run>);

impl Runs {
    /// Runs of a series, coarse to fine.
    pub(super) fn series<'a>(&'a self, series: &'a str) -> impl Iterator<Item = &'a Run> {
        self.0.iter().filter(move |run| run.variant.series == Some(series))
    }

    /// The finest run of a series.
    pub(super) fn finest<'a>(&'a self, series: &'a str) -> Option<&'a Run> {
        self.series(series).last()
    }
}

impl Run {
    pub(super) fn label(&self) -> &str {
        &self.variant.label
    }

    fn finished(&self) -> Option<&Finished> {
        self.outcome.as_ref().ok()
    }

    pub(super) fn summary(&self) -> Option<&Summary> {
        Some(&self.finished()?.summary)
    }

    /// A measure of the deck at the end, SI.
    pub(super) fn measure(&self, name: &str) -> Option<f64> {
        *self.summary()?.measures.get(name)?
    }

    /// A column of the history.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        Some(self.finished()?.history.column(name)?.1)
    }

    /// Largest change of the sum of some columns from its first value, as a share of the first value of `scale`.
    pub(super) fn largest_drift(&self, columns: &[&str], scale: &str) -> Option<f64> {
        let columns: Vec<&[f64]> = columns.iter().map(|name| self.column(name)).collect::<Option<_>>()?;
        let scale = self.column(scale)?.first()?.abs();
        let sum = |row: usize| columns.iter().map(|column| column[row]).sum::<f64>();
        let first = sum(0);
        let rows = columns.first()?.len();
        Some((0..rows).map(|row| (sum(row) - first).abs()).fold(0.0, f64::max) / scale)
    }
}

/// Runs every variant of a case.
///
/// A run that breaks down is a result; one that cannot be started or written is an error.
pub(super) fn run(
    case: &Case,
    options: &ValidateOptions,
    folder: &Folder,
    stop: &AtomicBool,
    watcher: &mut dyn Watcher,
) -> Result<Runs, ValidateError> {
    let variants = (case.variants)(options.effort);
    let count = variants.len();
    let mut runs = Vec::with_capacity(count);
    for (k, variant) in variants.into_iter().enumerate() {
        watcher.variant_started(&variant, k + 1, count);
        runs.push(run_variant(case, variant, options, folder, stop, watcher)?);
    }
    Ok(Runs(runs))
}

fn run_variant(
    case: &Case,
    variant: Variant,
    options: &ValidateOptions,
    folder: &Folder,
    stop: &AtomicBool,
    watcher: &mut dyn Watcher,
) -> Result<Run, ValidateError> {
    let directory = folder.run(case.name, &variant.label);
    let text = decks::find(case.deck).map_or("", |deck| deck.text);
    let setup = match deck::load_text(case.deck, text, &variant.overrides) {
        Ok(setup) => setup,
        // Tests read every variant; a deck changed behind their back is told, not hidden.
        Err(report) => {
            let outcome = Err(format!("the deck cannot be read: {report}"));
            return Ok(Run { variant, spacing: f64::NAN, directory, outcome });
        }
    };
    let spacing = setup.model.spacing;
    let run_options = RunOptions { directory: directory.clone(), overwrite: true, threads: options.threads };
    let outcome = match execute(setup, &run_options, stop, watcher) {
        Ok(summary) if summary.status == Status::Stopped => {
            return Err(ValidateError::Stopped { directory: options.directory.clone() });
        }
        Ok(summary) => {
            let history = HistoryTable::read(&RunDirectory::open(&directory)?)?;
            Ok(Finished { summary, history })
        }
        Err(error @ RunError::Failed { .. }) => Err(error.to_string()),
        Err(error) => return Err(ValidateError::Run(error)),
    };
    Ok(Run { variant, spacing, directory, outcome })
}
