//! Shows how far a run is: a bar with the time left on a terminal, a line every tenth part otherwise.

use crate::{failure::Failure, memory, readable, signals::StopFlag, terminal};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::{IntoDiagnostic, WrapErr};
use sphorge::{
    output::WarningRecord,
    run::{Observer, Progress, RunStart},
};
use std::{
    io::{self, IsTerminal},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

/// Ticks of the bar.
const TICKS: u64 = 1000;
/// Without a terminal, a line comes at least so often, s.
const LINE_INTERVAL: f64 = 60.0;

/// Prints lines to standard error, above the bar if there is one; standard output holds the result alone.
#[derive(Clone)]
pub(crate) struct Lines {
    bar: Option<ProgressBar>,
    is_quiet: bool,
}

impl Lines {
    /// Prints a line that a quiet run does without.
    pub(crate) fn print(&self, text: &str) {
        if !self.is_quiet {
            self.print_anyway(text);
        }
    }

    fn print_anyway(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| terminal::note(text)),
            None => terminal::note(text),
        }
    }
}

/// Watches a run for the user.
pub(crate) struct ProgressDisplay {
    lines: Lines,
    particles: usize,
    tenths: u64,
    last_line: f64,
    /// Whether nothing of the run is on the disk yet.
    sets_up: Arc<AtomicBool>,
}

impl ProgressDisplay {
    /// One that is quiet shows warnings alone.
    pub(crate) fn new(is_quiet: bool) -> Self {
        let bar = (!is_quiet && io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(TICKS), ProgressDrawTarget::stderr());
            match ProgressStyle::with_template("[{bar:30}] {percent:>3} %  {wide_msg}") {
                Ok(style) => bar.with_style(style.progress_chars("=> ")),
                Err(_) => bar,
            }
        });
        let sets_up = Arc::new(AtomicBool::new(true));
        Self { lines: Lines { bar, is_quiet }, particles: 0, tenths: 0, last_line: 0.0, sets_up }
    }

    /// The flag that stops the run, which says so among the lines of its progress.
    ///
    /// # Errors
    /// The system refuses to tell of signals.
    pub(crate) fn stop_flag(&self) -> Result<StopFlag, Failure> {
        let lines = self.lines.clone();
        let say = move || lines.print("stopping after this step (a second signal quits at once)");
        StopFlag::new(Arc::clone(&self.sets_up), say)
            .into_diagnostic()
            .wrap_err("cannot catch Ctrl-C")
            .map_err(Failure::Failed)
    }
}

impl Observer for ProgressDisplay {
    fn prepared(&mut self) {
        self.sets_up.store(false, Ordering::SeqCst);
    }

    fn started(&mut self, start: &RunStart) {
        memory::reset_peak();
        self.particles = start.particles;
        if !start.title.is_empty() {
            self.lines.print(&start.title);
        }
        self.lines.print(&format!(
            "{} particles to {} on {}, writing to {}",
            readable::count(start.particles as u64),
            readable::quantity(start.end, "s"),
            readable::computer(start.device.as_deref(), start.ranks, start.threads),
            start.directory.display(),
        ));
    }

    fn peak_memory_bytes(&mut self) -> Option<u64> {
        memory::peak_resident_bytes()
    }

    fn saved(&mut self, checkpoint: &Path, step: u64, time: f64) {
        let (step, time) = (readable::count(step), readable::quantity(time, "s"));
        self.lines.print(&format!("saved at step {step}, {time}: {}", checkpoint.display()));
    }

    fn noted(&mut self, note: &str) {
        self.lines.print(&format!("note: {note}"));
    }

    fn warned(&mut self, warning: &WarningRecord) {
        self.lines.print_anyway(&format!("warning: {warning}"));
    }

    fn progressed(&mut self, progress: &Progress) {
        let state = state(progress, self.particles);
        if let Some(bar) = &self.lines.bar {
            bar.set_position((progress.fraction.clamp(0.0, 1.0) * TICKS as f64) as u64);
            bar.set_message(state);
            return;
        }
        let tenths = (progress.fraction.clamp(0.0, 1.0) * 10.0 + 1e-9) as u64;
        if tenths > self.tenths || progress.seconds - self.last_line >= LINE_INTERVAL {
            (self.tenths, self.last_line) = (tenths, progress.seconds);
            self.lines.print(&format!("{:>3.0} %  {state}", 100.0 * progress.fraction));
        }
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        if let Some(bar) = &self.lines.bar {
            bar.finish_and_clear();
        }
    }
}

/// One line on a run under way.
fn state(progress: &Progress, particles: usize) -> String {
    let left = match progress.seconds_left {
        Some(left) if progress.fraction < 1.0 => format!(", {} left", readable::duration(left)),
        _ => String::new(),
    };
    format!(
        "{}{left}, step {}, dt {} ({}), {} particle-steps/s",
        readable::quantity(progress.time, "s"),
        readable::count(progress.step),
        readable::quantity(progress.dt, "s"),
        progress.reason.name(),
        // The mean so far: that of the last tenth of a second jumps with every frame written.
        readable::large(particles as f64 * progress.step as f64 / progress.seconds.max(1e-9)),
    )
}
