//! A run between two of its steps: all that goes on from one to the next.

use super::{
    error::Trouble,
    progress::{Observer, Pace, Progress},
    record::Recorder,
    schedule::{Schedule, arrived},
    watch::telling,
};
use crate::{
    engine::{
        FieldSource, Simulation, StepReport,
        persist::{Archive, ArchiveError, MemoryArchive, Persist, require},
    },
    geometry::FilledMass,
    model::TimeControl,
    output::{EndReason, OutputError, RunDirectory},
    particles::Column,
};

/// A run under way.
///
/// What a run must survive with is here, and each part saves and loads its own:
///
/// - the simulation: state of the engine, time, steps, the limit of the next step, seconds by stage;
/// - the recorder: rows of the history, memories of the measures, what was found broken, particles that tracers follow, the start and the extremes of what is
///   conserved, times of the frames, sums over the steps, the last audit and the worst, energies of the last row;
/// - what the loop itself keeps: which frame and which row come next, the kinetic energies of the stop rule;
/// - what is told to whoever watches: seconds so far, the recent speed.
///
/// Deck, engine, folder and threads are given anew when a run is loaded; only threads and folder may be others.
pub(super) struct RunState {
    pub(super) simulation: Simulation,
    pub(super) recorder: Recorder,
    pub(super) pace: Pace,
    time: TimeControl,
    frames: Schedule,
    rows: Schedule,
    /// Of the first row, and of the last.
    initial_kinetic: f64,
    kinetic: f64,
}

/// Whether a run begins or goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beginning {
    /// Its files are begun with it.
    New,
    /// Its files are left alone until its state is loaded.
    Resumed,
}

impl RunState {
    /// A run that has not begun, of bodies of these masses.
    pub(super) fn new(
        directory: RunDirectory,
        simulation: Simulation,
        masses: &[FilledMass],
        pace: Pace,
        beginning: Beginning,
    ) -> Result<Self, OutputError> {
        let model = simulation.model();
        let (time, output) = (model.time.clone(), &model.output);
        Ok(Self {
            recorder: Recorder::new(directory, model, masses, beginning)?,
            frames: Schedule::new(output.frame_interval, time.end),
            rows: Schedule::new(output.history_interval, time.end),
            initial_kinetic: 0.0,
            kinetic: 0.0,
            time,
            simulation,
            pace,
        })
    }

    /// Saves everything the steps to come depend on.
    pub(super) fn save(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.persist("run", archive)
    }

    /// Loads what was saved.
    pub(super) fn load(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.persist("run", archive)
    }

    /// Goes back to a state of this run. The time spent since counts.
    pub(super) fn go_back(&mut self, kept: &MemoryArchive) -> Result<(), ArchiveError> {
        let seconds = self.pace.seconds();
        self.load(&mut kept.reader())?;
        self.pace.set_seconds(seconds);
        Ok(())
    }

    /// A field in which some particle has a value that none can have.
    pub(super) fn broken_field(&self) -> Option<&'static str> {
        // Largest magnitudes: the speed of light and its square, and what is far beyond any matter.
        const FIELDS: [(&str, f64); 8] = [
            ("position", 1e30),
            ("velocity", 3e8),
            ("density", 1e9),
            ("mass", 1e30),
            ("energy", 9e16),
            ("temperature", 1e12),
            ("plastic_strain", 1e6),
            ("stress", 1e24),
        ];
        let is_broken = |(field, most): &(&str, f64)| match self.simulation.read(field) {
            Ok(column) => (0..column.len()).any(|i| {
                let size = column.magnitude(i);
                // Not of a number, too.
                size.is_nan()
                    || size > *most
                    || match (*field, &column) {
                        ("density" | "mass", _) => size <= 0.0,
                        ("plastic_strain", Column::Scalar(values)) => values[i] < 0.0,
                        _ => false,
                    }
            }),
            Err(_) => true,
        };
        FIELDS.iter().find(|field| is_broken(field)).map(|(field, _)| *field)
    }

    /// A number, beside those of particles, that no run can have at this time. Output times are those of the deck that was saved.
    pub(super) fn impossible_number(&self, has_saved_output: bool) -> Option<&'static str> {
        let (time, steps) = (self.simulation.time(), self.simulation.steps());
        let energies = [self.initial_kinetic, self.kinetic];
        let is_next = |schedule: &Schedule| !has_saved_output || schedule.is_next_at(time);
        let numbers = [
            (is_next(&self.frames), "run.frames.next"),
            (is_next(&self.rows), "run.rows.next"),
            (energies.iter().all(|energy| energy.is_finite() && *energy >= 0.0), "run.kinetic"),
            (self.pace.is_possible(), "run.pace"),
        ];
        let wrong = numbers.into_iter().find(|(fits, _)| !fits).map(|(_, name)| name);
        wrong.or_else(|| self.recorder.impossible_number(time, steps))
    }

    /// Takes output times from the model, whose intervals may be others than when the state was saved.
    pub(super) fn align_output(&mut self) {
        let time = self.simulation.time();
        self.frames.align(time);
        self.rows.align(time);
    }

    /// Writes the first row and the first frame.
    pub(super) fn begin(&mut self, observer: &mut dyn Observer) -> Result<(), Trouble> {
        let (dt, reason) = self.simulation.next_step_estimate()?;
        self.recorder.prepared(dt, reason);
        self.recorder.watch_step(self.simulation.model(), dt, 0, 0.0)?;
        self.row(observer)?;
        self.settle_row(observer)?;
        self.initial_kinetic = self.kinetic;
        self.frame(observer)
    }

    /// Takes a step, which has failed some times before, and writes what is due after it.
    pub(super) fn step(&mut self, observer: &mut dyn Observer, failures: u32) -> Result<StepReport, Trouble> {
        // Steps end at frames. Rows come after the first step that has passed them, so that asking for more changes nothing.
        let stepped = self.simulation.step(Some(self.frames.next()));
        // The sums of the last row were there before the step was, also before one that failed, which is the trouble to report.
        let settled = self.settle_row(observer);
        let report = stepped?;
        settled?;
        self.recorder.stepped(&report, failures);
        let hope = match telling(&report) {
            Some(dt) => self.recorder.watch_step(self.simulation.model(), dt, report.step, report.time),
            None => Ok(()),
        };
        self.warn(observer);
        hope?;
        if self.rows.reached(report.time) {
            self.row(observer)?;
        }
        if self.frames.reached(report.time) {
            self.frame(observer)?;
        }
        Ok(report)
    }

    /// Writes the last row and the last frame where the present state has none yet.
    pub(super) fn close(&mut self, observer: &mut dyn Observer) -> Result<(), Trouble> {
        self.settle_row(observer)?;
        self.recorder.look(&self.simulation)?;
        self.warn(observer);
        let (owes_row, owes_frame) = self.recorder.owes(self.simulation.steps());
        if owes_row {
            self.recorder.row(&self.simulation)?;
            self.recorder.settle_row(self.simulation.model())?;
        }
        if owes_frame {
            self.frame(observer)?;
        }
        Ok(self.recorder.flush()?)
    }

    /// Why the run is to end now, by the rules of the deck.
    pub(super) fn end_reason(&self) -> Option<EndReason> {
        let TimeControl { end, stop_kinetic_fraction, max_steps, .. } = self.time;
        if arrived(self.simulation.time(), end) {
            Some(EndReason::EndTime)
        } else if stop_kinetic_fraction.is_some_and(|share| self.kinetic < share * self.initial_kinetic) {
            Some(EndReason::KineticEnergy)
        } else if max_steps.is_some_and(|most| self.simulation.steps() >= most) {
            Some(EndReason::MaxSteps)
        } else {
            None
        }
    }

    /// Tells how far the run is, if it is time to or `now`.
    pub(super) fn tell(&mut self, report: &StepReport, observer: &mut dyn Observer, now: bool) {
        let by_time = report.time / self.time.end;
        let by_steps = self.time.max_steps.map_or(0.0, |most| report.step as f64 / most as f64);
        let fraction = by_time.max(by_steps).clamp(0.0, 1.0);
        if let Some((steps_per_second, seconds_left)) = self.pace.report(report.step, fraction, now) {
            observer.progressed(&Progress {
                fraction,
                time: report.time,
                end: self.time.end,
                step: report.step,
                dt: report.dt,
                reason: report.reason,
                particle_steps_per_second: steps_per_second * self.simulation.count() as f64,
                seconds: self.pace.seconds(),
                seconds_left,
                frames: self.recorder.frames(),
            });
        }
    }

    /// Tells what has been found broken since the last time.
    fn warn(&mut self, observer: &mut dyn Observer) {
        let news = self.recorder.warnings_to_tell(self.simulation.model());
        news.iter().for_each(|warning| observer.warned(warning));
    }

    /// Takes a row. It may be written after the next step, unless the deck decides by it whether there is one.
    fn row(&mut self, observer: &mut dyn Observer) -> Result<(), Trouble> {
        if self.recorder.row(&self.simulation)? {
            self.row_is_written(observer);
        } else if self.time.stop_kinetic_fraction.is_some() {
            self.settle_row(observer)?;
        }
        Ok(())
    }

    /// Writes the row whose sums are still to come, before anything else looks at the run.
    pub(super) fn settle_row(&mut self, observer: &mut dyn Observer) -> Result<(), Trouble> {
        if self.recorder.settle_row(self.simulation.model())? {
            self.row_is_written(observer);
        }
        Ok(())
    }

    fn row_is_written(&mut self, observer: &mut dyn Observer) {
        self.kinetic = self.recorder.kinetic_energy();
        self.warn(observer);
    }

    fn frame(&mut self, observer: &mut dyn Observer) -> Result<(), Trouble> {
        observer.frame_written(self.recorder.frame(&self.simulation)?, self.simulation.time());
        Ok(())
    }
}

impl Persist for RunState {
    /// Loading needs a run that was made with the same setup and engine; it may have begun or not.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.simulation.persist(archive)?;
        self.recorder.persist(&format!("{name}.recorder"), archive)?;
        self.pace.persist(&format!("{name}.pace"), archive)?;
        require(self.pace.last_step() <= self.simulation.steps(), &format!("{name}.pace.last_step"))?;
        self.frames.persist(&format!("{name}.frames"), archive)?;
        self.rows.persist(&format!("{name}.rows"), archive)?;
        self.initial_kinetic.persist(&format!("{name}.initial_kinetic"), archive)?;
        self.kinetic.persist(&format!("{name}.kinetic"), archive)
    }
}

#[cfg(test)]
pub(super) mod tests;
