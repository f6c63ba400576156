//! Executes the runs of a case.

use super::{
    Case, ValidateError, ValidateOptions, Variant, Watcher,
    folder::Folder,
    runs::{Finished, Run, Runs},
};
use crate::{
    deck, decks,
    engine::ENGINES,
    output::{HistoryTable, RunDirectory, Status},
    run::{CheckpointPlan, RunError, RunOptions, execute},
};
use std::sync::atomic::AtomicBool;

/// Runs every variant of a case.
///
/// A run that breaks down is a result; one that cannot be started or written is an error.
pub(super) fn run_variants(
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
    // A case is run again rather than resumed.
    let checkpoints = CheckpointPlan::default();
    let run_options =
        RunOptions { directory: directory.clone(), overwrite: true, threads: options.threads, checkpoints };
    let outcome = match execute(setup, ENGINES[0], &run_options, stop, watcher) {
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
