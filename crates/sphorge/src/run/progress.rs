//! How far a run is, for whoever watches.

use crate::{
    engine::{
        LimitReason,
        persist::{Archive, ArchiveError, Persist},
    },
    output::WarningRecord,
};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// A run about to start.
#[derive(Clone, Debug, PartialEq)]
pub struct RunStart {
    /// Folder of the run.
    pub directory: PathBuf,
    /// Title of the deck.
    pub title: String,
    /// Number of particles.
    pub particles: usize,
    /// Processes that share the run.
    pub ranks: usize,
    /// Threads of each.
    pub threads: usize,
    /// Name of the device that computes, where that is not the processor.
    pub device: Option<String>,
    /// End time, s.
    pub end: f64,
}

/// A run under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Share done, 0 to 1: of the end time, or of the deck's number of steps where that comes first.
    pub fraction: f64,
    /// Time reached, s.
    pub time: f64,
    /// End time, s.
    pub end: f64,
    /// Steps done.
    pub step: u64,
    /// Size of the last step, s.
    pub dt: f64,
    /// What limited it.
    pub reason: LimitReason,
    /// Speed since the previous report.
    pub particle_steps_per_second: f64,
    /// Wall-clock seconds since the start.
    pub seconds: f64,
    /// Estimate of the wall-clock seconds left, from the recent speed; `None` at first.
    pub seconds_left: Option<f64>,
    /// Frames written.
    pub frames: usize,
}

/// Watches a run. Reports come some ten times a second, and after the last step.
pub trait Observer: Send {
    /// All is ready for the first step and nothing has been written yet: until now the process may end at any moment and leave no trace.
    fn prepared(&mut self) {}
    /// The folder is there, the first step is next.
    fn started(&mut self, _start: &RunStart) {}
    /// Steps have been done.
    fn progressed(&mut self, _progress: &Progress) {}
    /// Frame `index` at `time` (s) is on the disk.
    fn frame_written(&mut self, _index: usize, _time: f64) {}
    /// The state has been saved to a file, after a step, at a time (s).
    fn saved(&mut self, _checkpoint: &Path, _step: u64, _time: f64) {}
    /// Something the user should know.
    fn noted(&mut self, _note: &str) {}
    /// A check has found the run broken for the first time.
    fn warned(&mut self, _warning: &WarningRecord) {}
    /// Largest memory of the process since [`Self::started`], bytes, for the summary; `None` where nobody knows.
    fn peak_memory_bytes(&mut self) -> Option<u64> {
        None
    }
}

/// An observer that does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}

/// Seconds between reports.
const REPORT_INTERVAL: f64 = 0.1;
/// Seconds over which the speed is averaged for the time left.
const MEMORY: f64 = 10.0;

/// Turns counts into rates.
#[derive(Debug)]
pub(super) struct Pace {
    start: Instant,
    /// Seconds of the run before `start`.
    before: f64,
    last_seconds: f64,
    last_step: u64,
    last_fraction: f64,
    /// Share done per second, recent mean.
    rate: Option<f64>,
}

impl Pace {
    pub(super) fn new() -> Self {
        Self { start: Instant::now(), before: 0.0, last_seconds: 0.0, last_step: 0, last_fraction: 0.0, rate: None }
    }

    /// The step of the last report.
    pub(super) fn last_step(&self) -> u64 {
        self.last_step
    }

    pub(super) fn seconds(&self) -> f64 {
        self.before + self.start.elapsed().as_secs_f64()
    }

    /// Sets the seconds of the run so far.
    pub(super) fn set_seconds(&mut self, seconds: f64) {
        (self.before, self.start) = (seconds, Instant::now());
    }

    /// Steps per second since the last report and seconds left, if it is time to report (or `now`).
    pub(super) fn report(&mut self, step: u64, fraction: f64, now: bool) -> Option<(f64, Option<f64>)> {
        let seconds = self.seconds();
        let since = seconds - self.last_seconds;
        if since < REPORT_INTERVAL && !now || since <= 0.0 || step == self.last_step {
            return None;
        }
        let rate = (fraction - self.last_fraction) / since;
        let weight = 1.0 - (-since / MEMORY).exp();
        let rate = self.rate.map_or(rate, |old| old + weight * (rate - old));
        let steps_per_second = (step - self.last_step) as f64 / since;
        (self.last_seconds, self.last_step, self.last_fraction, self.rate) = (seconds, step, fraction, Some(rate));
        Some((steps_per_second, (rate > 0.0).then(|| (1.0 - fraction) / rate)))
    }
}

impl Persist for Pace {
    /// Seconds are those of the whole run, as steps are: the time between saving and loading is none of them.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let mut seconds = self.seconds();
        seconds.persist(&format!("{name}.seconds"), archive)?;
        self.last_seconds.persist(&format!("{name}.last_seconds"), archive)?;
        self.last_step.persist(&format!("{name}.last_step"), archive)?;
        self.last_fraction.persist(&format!("{name}.last_fraction"), archive)?;
        self.rate.persist(&format!("{name}.rate"), archive)?;
        if !archive.is_saving() {
            (self.before, self.start) = (seconds, Instant::now());
        }
        Ok(())
    }
}
