//! Executes the runs of a case.

use super::{
    Case, ValidateError, ValidateOptions, Variant, Watcher, earlier,
    folder::Folder,
    runs::{Finished, Run, Runs},
};
use crate::{
    deck, decks,
    engine::{Cpu, ENGINES},
    output::{HistoryTable, RunDirectory, Status},
    run::{CheckpointPlan, ResumeError, ResumeOptions, RunError, RunOptions, execute, resume},
};
use std::{
    sync::{Arc, atomic::AtomicBool},
    time::Duration,
};

/// Wall-clock time from one saved state to the next.
const CHECKPOINTS: Duration = Duration::from_secs(600);

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
    let goes_on = options.resume && folder.has_begun(&directory);
    if goes_on && let Some(finished) = earlier::finished(&directory, &setup) {
        return Ok(Run { variant, spacing, directory, outcome: Ok(finished) });
    }
    folder.note_begin(&directory)?;
    let checkpoints = CheckpointPlan { every: Some(CHECKPOINTS), ..CheckpointPlan::default() };
    let resumed = match goes_on && earlier::is_of(&directory, &setup) {
        true => {
            let resume_options = ResumeOptions {
                by_force: false,
                overrides: Vec::new(),
                most_particles: f64::INFINITY,
                threads: options.threads,
                checkpoints: checkpoints.clone(),
                engines: vec![Arc::new(Cpu)],
            };
            match resume(&directory, &resume_options, stop, watcher) {
                Ok(summary) => Some(Ok(summary)),
                Err(ResumeError::Run(error)) => Some(Err(error)),
                // Nothing was saved that it could go on from.
                Err(_) => None,
            }
        }
        false => None,
    };
    let run_options = RunOptions {
        directory: directory.clone(),
        overwrite: true,
        by_force: false,
        threads: options.threads,
        checkpoints,
    };
    let outcome = match resumed.unwrap_or_else(|| execute(setup, ENGINES[0], &run_options, stop, watcher)) {
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
