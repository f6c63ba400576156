//! The loop over time.

use super::{
    error::{RunError, Trouble, failure_record},
    progress::{Observer, Pace, Progress, RunStart},
    record::Recorder,
    schedule::{Schedule, arrived},
};
use crate::{
    deck::Setup,
    engine::{EngineKind, FieldSource, Simulation, StepReport},
    model::TimeControl,
    output::{Durability, EndReason, FailureRecord, RunDirectory, Summary, write_file},
};
use std::{
    path::PathBuf,
    sync::atomic::{AtomicBool, Ordering},
};

/// How to run, beside what the deck says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// Folder to write to.
    pub directory: PathBuf,
    /// Replace a former run in that folder.
    pub overwrite: bool,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
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
    let directory = RunDirectory::create(&options.directory, options.overwrite).map_err(RunError::Directory)?;
    let (deck, text) = (directory.deck(), &setup.deck_text);
    write_file(&deck, Durability::Disk, |out| out.write_all(text.as_bytes())).map_err(RunError::Directory)?;
    pool.install(|| run(directory, setup, kind, stop, observer))
}

/// What ends the loop.
enum Ending {
    Reached(EndReason),
    Failed(Box<FailureRecord>),
}

fn run(
    directory: RunDirectory,
    setup: Setup,
    kind: &dyn EngineKind,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Summary, RunError> {
    let mut pace = Pace::new();
    let path = directory.path().to_owned();
    let mut engine = Simulation::start(kind, setup.model, setup.particles)
        .map_err(|failure| RunError::Start { engine: kind.name(), failure })?;
    observer.started(&RunStart {
        directory: path.clone(),
        title: engine.model().title.clone(),
        particles: engine.count(),
        threads: rayon::current_num_threads(),
        end: engine.model().time.end,
    });
    let mut recorder = Recorder::new(directory, engine.model()).map_err(|source| RunError::Output { source })?;

    let ended = match steps(&mut engine, &mut recorder, stop, observer, &mut pace) {
        Err(Trouble::Engine(failure)) => Ok(Ending::Failed(failure_record(engine.model(), *failure))),
        Err(Trouble::Output(source)) => Err(source),
        Ok(reason) => Ok(Ending::Reached(reason)),
    };
    match ended {
        Ok(Ending::Reached(reason)) => {
            let (summary, written) =
                recorder.summary(&engine, reason, None, pace.seconds(), observer.peak_memory_bytes());
            written.map_err(|source| RunError::Output { source })?;
            Ok(summary)
        }
        Ok(Ending::Failed(failure)) => {
            let flushed = recorder.flush();
            let memory = observer.peak_memory_bytes();
            let (summary, written) =
                recorder.summary(&engine, EndReason::Failure, Some(failure.clone()), pace.seconds(), memory);
            flushed.and(written).map_err(|source| RunError::Output { source })?;
            Err(RunError::Failed { failure, directory: path, summary: Box::new(summary) })
        }
        Err(source) => {
            let failure = Box::new(FailureRecord {
                message: source.to_string(),
                step: engine.steps(),
                time: engine.time(),
                field: None,
                particle: None,
                body: None,
                position: None,
            });
            // The disk may still take this one small file; the trouble to report is the first one.
            let memory = observer.peak_memory_bytes();
            let _ = recorder.summary(&engine, EndReason::Failure, Some(failure), pace.seconds(), memory);
            Err(RunError::Output { source })
        }
    }
}

fn steps(
    engine: &mut Simulation,
    recorder: &mut Recorder,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
    pace: &mut Pace,
) -> Result<EndReason, Trouble> {
    let (dt, reason) = engine.next_step_estimate()?;
    recorder.prepared(dt, reason);
    let initial_kinetic = recorder.row(engine)?;
    let mut kinetic = initial_kinetic;
    observer.frame_written(recorder.frame(engine)?, engine.time());

    let time = engine.model().time.clone();
    let mut frames = Schedule::new(engine.model().output.frame_interval, time.end);
    let mut rows = Schedule::new(engine.model().output.history_interval, time.end);
    let mut last_report = None;
    let reason = loop {
        if let Some(reason) = end_reason(&time, engine, kinetic, initial_kinetic, stop) {
            break reason;
        }
        // Steps end at frames. Rows come after the first step that has passed them, so that asking for more changes nothing.
        let report = engine.step(Some(frames.next()))?;
        recorder.stepped(&report);
        if rows.reached(report.time) {
            kinetic = recorder.row(engine)?;
        }
        if frames.reached(report.time) {
            observer.frame_written(recorder.frame(engine)?, report.time);
        }
        progress(&time, engine, recorder, &report, observer, pace, false);
        last_report = Some(report);
    };

    let (owes_row, owes_frame) = recorder.owes(engine.steps());
    if owes_row {
        recorder.row(engine)?;
    }
    if owes_frame {
        observer.frame_written(recorder.frame(engine)?, engine.time());
    }
    recorder.flush()?;
    if let Some(report) = last_report {
        progress(&time, engine, recorder, &report, observer, pace, true);
    }
    Ok(reason)
}

fn end_reason(
    time: &TimeControl,
    engine: &Simulation,
    kinetic: f64,
    initial_kinetic: f64,
    stop: &AtomicBool,
) -> Option<EndReason> {
    if arrived(engine.time(), time.end) {
        Some(EndReason::EndTime)
    } else if time.stop_kinetic_fraction.is_some_and(|share| kinetic < share * initial_kinetic) {
        Some(EndReason::KineticEnergy)
    } else if time.max_steps.is_some_and(|most| engine.steps() >= most) {
        Some(EndReason::MaxSteps)
    } else if stop.load(Ordering::Relaxed) {
        Some(EndReason::User)
    } else {
        None
    }
}

fn progress(
    time: &TimeControl,
    engine: &Simulation,
    recorder: &Recorder,
    report: &StepReport,
    observer: &mut dyn Observer,
    pace: &mut Pace,
    now: bool,
) {
    let by_time = report.time / time.end;
    let by_steps = time.max_steps.map_or(0.0, |most| report.step as f64 / most as f64);
    let fraction = by_time.max(by_steps).clamp(0.0, 1.0);
    if let Some((steps_per_second, seconds_left)) = pace.report(report.step, fraction, now) {
        observer.progressed(&Progress {
            fraction,
            time: report.time,
            end: time.end,
            step: report.step,
            dt: report.dt,
            reason: report.reason,
            particle_steps_per_second: steps_per_second * engine.count() as f64,
            seconds: pace.seconds(),
            seconds_left,
            frames: recorder.frames(),
        });
    }
}
