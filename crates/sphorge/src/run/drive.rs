//! The loop over time.

use super::{
    checkpoint::{CheckpointPlan, Keeper},
    error::{RunError, Trouble, failure_record},
    progress::{Observer, Pace, RunStart},
    repeat::{Repeater, Watched},
    state::{Beginning, RunState},
};
use crate::{
    deck::Setup,
    engine::{EngineKind, FieldSource, Simulation},
    output::{EndReason, FailureRecord, RunDirectory, Summary},
};
use std::{
    path::PathBuf,
    sync::atomic::{AtomicBool, Ordering},
};

/// How to run, beside what the deck says.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// Folder to write to.
    pub directory: PathBuf,
    /// Replace a former run in that folder.
    pub overwrite: bool,
    /// Take the folder from a run that writes to it, or seems to: that one stops before its next file.
    pub by_force: bool,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
    /// When it saves its state.
    pub checkpoints: CheckpointPlan,
}

/// Runs a deck on an engine from its start to its end time, a stop rule of the deck, or until `stop` becomes true, and writes
/// everything a run writes.
///
/// # Errors
/// See [`RunError`]. A stop by the user is no error: the summary says so.
pub fn execute(
    setup: Setup,
    kind: &dyn EngineKind,
    options: &RunOptions,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Summary, RunError> {
    kind.supports(&setup.model).map_err(|unsupported| RunError::Unsupported { engine: kind.name(), unsupported })?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()
        .map_err(|source| RunError::Threads { threads: options.threads, source })?;
    RunDirectory::check(&options.directory, options.overwrite).map_err(RunError::Directory)?;
    pool.install(|| run(setup, kind, options, stop, observer))
}

fn run(
    setup: Setup,
    kind: &dyn EngineKind,
    options: &RunOptions,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Summary, RunError> {
    let Setup { model, particles, masses, deck_text: text, .. } = setup;
    let pace = Pace::new();
    let name = model.name.clone();
    kind.take_deck(&name, &text);
    let mut simulation = Simulation::start(kind, model, particles)
        .map_err(|failure| RunError::Start { engine: kind.name(), failure: Box::new(failure) })?;
    // Of many particles this takes a while. If it fails it does so again when the run begins, and is told as a failure of the run.
    let _ = simulation.next_step_estimate();
    observer.prepared();
    let RunOptions { directory, overwrite, by_force, .. } = options;
    let directory = RunDirectory::begin(directory, *overwrite, *by_force, Some(&text)).map_err(RunError::Directory)?;
    let path = directory.path().to_owned();
    let mut keeper = Keeper::new(options.checkpoints.clone(), name, text, 0.0);
    observer.started(&RunStart {
        directory: path.clone(),
        title: simulation.model().title.clone(),
        particles: simulation.count(),
        ranks: simulation.ranks(),
        threads: rayon::current_num_threads(),
        device: simulation.device(),
        end: simulation.model().time.end,
    });
    let mut state = RunState::new(directory, simulation, &masses, pace, Beginning::New)
        .map_err(|source| RunError::Output { source })?;

    let ended = state.begin(observer).and_then(|()| go_on(&mut state, &mut keeper, stop, observer));
    conclude(state, path, ended, observer)
}

/// Writes the summary of a run that has come to an end, in the folder `path`.
pub(super) fn conclude(
    mut state: RunState,
    path: PathBuf,
    ended: Result<EndReason, Trouble>,
    observer: &mut dyn Observer,
) -> Result<Summary, RunError> {
    if ended.is_err() {
        // What a card that is lost has not given any more is no row, and not the trouble to report.
        let _ = state.settle_row(observer);
    }
    let RunState { simulation, recorder, pace, .. } = &mut state;
    match ended {
        Ok(reason) => {
            let (summary, written) =
                recorder.summary(simulation, reason, None, pace.seconds(), observer.peak_memory_bytes());
            written.map_err(|source| RunError::Output { source })?;
            Ok(summary)
        }
        Err(Trouble::Engine(failure)) => {
            let failure = failure_record(simulation.model(), *failure);
            // What a card that is lost has not given any more is no frame, and not the trouble to report.
            let settled = recorder.settle().or_else(|lost| if lost.is_of_the_engine() { Ok(()) } else { Err(lost) });
            let flushed = settled.and(recorder.flush());
            let memory = observer.peak_memory_bytes();
            let (summary, written) =
                recorder.summary(simulation, EndReason::Failure, Some(failure.clone()), pace.seconds(), memory);
            flushed.and(written).map_err(|source| RunError::Output { source })?;
            Err(RunError::Failed { failure, directory: path, summary: Box::new(summary) })
        }
        Err(Trouble::Output(source)) => {
            let failure = Box::new(FailureRecord {
                message: source.to_string(),
                step: simulation.steps(),
                time: simulation.time(),
                field: None,
                particle: None,
                body: None,
                position: None,
            });
            // Rows and frames that were complete come before the summary: with it the list of frames is taken for whole, and it may be behind by
            // some of them. The disk may still take these files; the trouble to report is the first one.
            let _ = recorder.flush();
            let memory = observer.peak_memory_bytes();
            let _ = recorder.summary(simulation, EndReason::Failure, Some(failure), pace.seconds(), memory);
            Err(RunError::Output { source })
        }
    }
}

/// Steps from wherever the run is to its end, or until `stop` becomes true.
pub(super) fn go_on(
    state: &mut RunState,
    keeper: &mut Keeper,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<EndReason, Trouble> {
    let stopped = || stop.load(Ordering::Relaxed).then_some(EndReason::User);
    let mut last_report = None;
    let mut repeater = Repeater::new(&state.simulation);
    let reason = loop {
        let is_left = observer.between_steps(&state.simulation).is_break();
        if let Some(reason) = state.end_reason().or_else(|| is_left.then_some(EndReason::User)).or_else(stopped) {
            break reason;
        }
        if let Some(drive) = observer.drive() {
            state.simulation.drive(&drive)?;
            if state.recorder.driven(&drive) {
                keeper.mark_as_driven(state.recorder.directory())?;
            }
        }
        let report = repeater.step(&mut Watched { state, observer })?;
        keeper.after_step(state, observer)?;
        state.tell(&report, observer, false);
        last_report = Some(report);
    };
    let reason = match observer.stopped_by() {
        Some(by) if reason == EndReason::User => {
            state.recorder.stopped_by = Some(by);
            EndReason::Program
        }
        _ => reason,
    };
    if matches!(reason, EndReason::User | EndReason::Program) {
        // Before rows and frames that an unbroken run would not have.
        keeper.at_stop(state, observer)?;
        state.close(observer)?;
    } else {
        state.close(observer)?;
        keeper.at_end(state, observer)?;
    }
    if let Some(report) = last_report {
        state.tell(&report, observer, true);
    }
    Ok(reason)
}
