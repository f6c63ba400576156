//! How far a run is, for whoever watches.

use crate::{
    engine::{
        Drive, LimitReason, Simulation,
        persist::{Archive, ArchiveError, Persist},
    },
    output::WarningRecord,
};
use std::{
    ops::ControlFlow,
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
    /// The state before the first step and after each one, which can be read until this returns. Steps that turn out to be too large are taken back, and
    /// then come again. A break ends the run as a stop by the user does.
    fn between_steps(&mut self, _state: &Simulation) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    /// Loads and velocities of bodies from the next step on, asked for after [`Self::between_steps`]; none leaves them as they are.
    fn drive(&mut self) -> Option<Drive> {
        None
    }
    /// Whether it gives loads or velocities: a run that was saved under some is not resumed without.
    fn drives(&self) -> bool {
        false
    }
    /// What of a program that drives the run has ended it, such as a callback that raised; nothing where it was the user.
    fn stopped_by(&mut self) -> Option<String> {
        None
    }
    /// Frame `index` at `time` (s) is written, or is being written while steps go on (cards).
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

/// No run takes so many seconds: a thousand years.
const LONGEST: f64 = 3e10;

/// Turns counts into rates.
#[derive(Debug)]
pub(super) struct Pace {
    start: Instant,
    /// Seconds of the run before `start`.
    before: f64,
    last_seconds: f64,
    last_step: u64,
    last_fraction: f64,
    /// Share done of late, and the seconds it took, each fading with [`MEMORY`]: their ratio is a mean from the first report on.
    recent: (f64, f64),
}

impl Pace {
    pub(super) fn new() -> Self {
        Self {
            start: Instant::now(),
            before: 0.0,
            last_seconds: 0.0,
            last_step: 0,
            last_fraction: 0.0,
            recent: (0.0, 0.0),
        }
    }

    /// The step of the last report.
    pub(super) fn last_step(&self) -> u64 {
        self.last_step
    }

    /// Whether its numbers can be those of a run.
    pub(super) fn is_possible(&self) -> bool {
        let seconds = [self.before, self.last_seconds, self.recent.1];
        let shares = [self.last_fraction, self.recent.0];
        seconds.iter().all(|seconds| (0.0..LONGEST).contains(seconds))
            && shares.iter().all(|share| (0.0..=1.0 + 1e-9).contains(share))
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
        let steps_per_second = (step - self.last_step) as f64 / since;
        self.recent = mean_of_late(self.recent, fraction - self.last_fraction, since);
        (self.last_seconds, self.last_step, self.last_fraction) = (seconds, step, fraction);
        let (share, took) = self.recent;
        Some((steps_per_second, (share > 0.0).then(|| (1.0 - fraction) * took / share)))
    }
}

/// A share done and the seconds it took, with another share that took `since` seconds.
fn mean_of_late(recent: (f64, f64), share: f64, since: f64) -> (f64, f64) {
    let kept = (-since / MEMORY).exp();
    (kept * recent.0 + share, kept * recent.1 + since)
}

impl Persist for Pace {
    /// Seconds are those of the whole run, as steps are: the time between saving and loading is none of them.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let mut seconds = self.seconds();
        seconds.persist(&format!("{name}.seconds"), archive)?;
        self.last_seconds.persist(&format!("{name}.last_seconds"), archive)?;
        self.last_step.persist(&format!("{name}.last_step"), archive)?;
        self.last_fraction.persist(&format!("{name}.last_fraction"), archive)?;
        self.recent.persist(&format!("{name}.recent"), archive)?;
        if !archive.is_saving() {
            (self.before, self.start) = (seconds, Instant::now());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_start_does_not_stay_in_the_time_left() {
        // A tenth of a second that gets nowhere, then a tenth of the run each second.
        let mut recent = mean_of_late((0.0, 0.0), 0.0, 0.1);
        for _ in 0..10 {
            recent = mean_of_late(recent, 0.01, 0.1);
        }
        let left = 0.9 * recent.1 / recent.0;
        assert!((left / 9.9 - 1.0).abs() < 0.02, "{left}");
    }

    #[test]
    fn what_was_long_ago_is_forgotten() {
        let slow = (0..100).fold((0.0, 0.0), |recent, _| mean_of_late(recent, 0.001, 1.0));
        let fast = (0..30).fold(slow, |recent, _| mean_of_late(recent, 0.01, 1.0));
        assert!((fast.1 / fast.0 / 100.0 - 1.0).abs() < 0.06, "{fast:?}");
        let (share, took) = (0..100).fold(slow, |recent, _| mean_of_late(recent, 0.01, 1.0));
        assert!((took / share / 100.0 - 1.0).abs() < 1e-3);
    }
}
