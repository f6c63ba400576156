//! Steps that are taken back and repeated smaller.
//!
//! A state is kept in memory now and then. Where a step fails that a smaller one may do, the run goes back to it and comes again by the same steps,
//! bit by bit, to the one that failed, which is now half as long. So it does not matter to a result when a state was kept, and a run that was
//! resumed repeats the same steps as one that was not.
//!
//! All that steps a deck steps by this: a run, and what only tries how fast or how long one would be, which else could fail where a run does not.

use super::{error::Trouble, progress::Observer, state::RunState};
use crate::{
    engine::{
        RunFailure, Simulation, StepReport,
        persist::{Archive, ArchiveError, MemoryArchive},
    },
    number::plain_quantity,
};
use std::{collections::BTreeMap, time::Instant};

/// A state is kept so seldom that all of them cost half a hundredth of the run.
const SPARSENESS: f64 = 200.0;
/// Steps that are told of one by one.
const MOST_TOLD: u64 = 3;

/// What takes steps that can be taken back.
pub(crate) trait Steps {
    /// What ends it.
    type Trouble: From<RunFailure>;

    /// Its simulation.
    fn simulation(&mut self) -> &mut Simulation;
    /// Takes the next step, which has failed some times before.
    fn step(&mut self, failures: u32) -> Result<StepReport, Self::Trouble>;
    /// The failure of a step, if that is the trouble.
    fn failure(trouble: Self::Trouble) -> Result<RunFailure, Self::Trouble>;
    /// Saves everything the steps to come depend on; what is under way is waited for before.
    fn save(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError>;
    /// Waits for what is under way.
    fn settle(&mut self) -> Result<(), Self::Trouble>;
    /// Waits for what is being written, too.
    fn settle_output(&mut self) -> Result<(), Self::Trouble>;
    /// Goes back to a state of its own.
    fn go_back(&mut self, kept: &MemoryArchive) -> Result<(), ArchiveError>;
    /// Does away with what was written since the state it has gone back to.
    fn forget(&mut self) -> Result<(), Self::Trouble>;
    /// Tells whoever watches.
    fn note(&mut self, note: &str);
}

/// A run, and who watches it.
pub(super) struct Watched<'a> {
    pub(super) state: &'a mut RunState,
    pub(super) observer: &'a mut dyn Observer,
}

impl Steps for Watched<'_> {
    type Trouble = Trouble;

    fn simulation(&mut self) -> &mut Simulation {
        &mut self.state.simulation
    }
    fn step(&mut self, failures: u32) -> Result<StepReport, Trouble> {
        self.state.step(self.observer, failures)
    }
    fn failure(trouble: Trouble) -> Result<RunFailure, Trouble> {
        match trouble {
            Trouble::Engine(failure) => Ok(*failure),
            Trouble::Output(_) => Err(trouble),
        }
    }
    fn save(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.state.save(archive)
    }
    fn settle(&mut self) -> Result<(), Trouble> {
        self.state.settle_row(self.observer)
    }
    fn settle_output(&mut self) -> Result<(), Trouble> {
        Ok(self.state.recorder.settle()?)
    }
    fn go_back(&mut self, kept: &MemoryArchive) -> Result<(), ArchiveError> {
        self.state.go_back(kept)
    }
    fn forget(&mut self) -> Result<(), Trouble> {
        self.state.recorder.rewrite()?;
        Ok(())
    }
    fn note(&mut self, note: &str) {
        self.observer.noted(note);
    }
}

/// A simulation of which nothing is written and that nobody watches.
impl Steps for Simulation {
    type Trouble = RunFailure;

    fn simulation(&mut self) -> &mut Simulation {
        self
    }
    fn step(&mut self, _: u32) -> Result<StepReport, RunFailure> {
        Simulation::step(self, None)
    }
    fn failure(trouble: RunFailure) -> Result<RunFailure, RunFailure> {
        Ok(trouble)
    }
    fn save(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.persist(archive)
    }
    fn settle(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn settle_output(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn go_back(&mut self, kept: &MemoryArchive) -> Result<(), ArchiveError> {
        self.persist(&mut kept.reader())
    }
    fn forget(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn note(&mut self, _: &str) {}
}

/// Takes steps, and takes back those that fail.
pub(crate) struct Repeater {
    /// Time from one state to the next over the time it takes to keep one.
    sparseness: f64,
    /// How often a step is repeated; 0 where none is taken back.
    most: u32,
    kept: Option<Kept>,
    /// Steps after the kept state that have failed, by their numbers.
    smaller: BTreeMap<u64, Smaller>,
    told: u64,
}

/// A state to go back to.
struct Kept {
    state: MemoryArchive,
    steps: u64,
    at: Instant,
    /// Seconds it took.
    seconds: f64,
}

/// How a step that has failed is taken.
#[derive(Clone, Copy)]
struct Smaller {
    /// Of the longest stable step.
    share: f64,
    /// How often it has failed.
    failures: u32,
}

impl Repeater {
    pub(crate) fn new(simulation: &Simulation) -> Self {
        let most = simulation.model().time.step_control.map_or(0, |control| control.repeats);
        Self { sparseness: SPARSENESS, most, kept: None, smaller: BTreeMap::new(), told: 0 }
    }

    /// Takes the next step, or goes back and takes one before it.
    pub(crate) fn step<S: Steps>(&mut self, stepped: &mut S) -> Result<StepReport, S::Trouble> {
        loop {
            let steps = stepped.simulation().steps();
            let smaller = self.smaller.get(&(steps + 1)).copied();
            // It may fail again: from here on there is nothing to repeat before it.
            let is_near = smaller.is_some() && self.kept.as_ref().is_some_and(|kept| kept.steps < steps);
            if self.most > 0 && (is_near || self.is_due()) {
                self.keep(stepped)?;
            }
            if let Some(smaller) = smaller {
                stepped.simulation().shorten_next_step(smaller.share);
            }
            let trouble = match stepped.step(smaller.map_or(0, |smaller| smaller.failures)) {
                Ok(report) => return Ok(report),
                Err(trouble) => trouble,
            };
            match S::failure(trouble)? {
                failure if failure.step_may_be_smaller => self.go_back(stepped, failure)?,
                failure => return Err(failure.into()),
            }
        }
    }

    fn is_due(&self) -> bool {
        self.kept.as_ref().is_none_or(|kept| kept.at.elapsed().as_secs_f64() > self.sparseness * kept.seconds)
    }

    fn keep<S: Steps>(&mut self, stepped: &mut S) -> Result<(), S::Trouble> {
        stepped.settle()?;
        let start = Instant::now();
        // Before there is another one: there may be no room for two.
        self.kept = None;
        let mut archive = MemoryArchive::in_parts();
        if stepped.save(&mut archive).is_err() {
            // The engine does not give its state away.
            self.most = 0;
            return Ok(());
        }
        let steps = stepped.simulation().steps();
        self.smaller.retain(|&step, _| step > steps);
        let seconds = start.elapsed().as_secs_f64();
        self.kept = Some(Kept { state: archive, steps, at: Instant::now(), seconds });
        Ok(())
    }

    /// Goes back to the state that was kept, so that the step that failed comes again, smaller; or gives the failure back.
    fn go_back<S: Steps>(&mut self, stepped: &mut S, failure: RunFailure) -> Result<(), S::Trouble> {
        let step = failure.step;
        let failures = 1 + self.smaller.get(&step).map_or(0, |smaller| smaller.failures);
        let share = stepped.simulation().step_share();
        // Steps that each fail a few times on the way down are no better than one that always does.
        let is_hopeless = failures > self.most || share <= 0.5f64.powi(self.most as i32);
        let Some(kept) = self.kept.as_ref().filter(|_| !is_hopeless) else {
            return Err(self.given_up(failure, share).into());
        };
        let share = 0.5 * stepped.simulation().tried_share();
        if self.told < MOST_TOLD && failures == 1 {
            self.told += 1;
            let last = if self.told == MOST_TOLD { "; further ones are only counted in `summary.json`" } else { "" };
            stepped.note(&format!(
                "step {step} at {} is repeated at half its size: {}{last}",
                plain_quantity(failure.time, "s"),
                failure.message
            ));
        }
        // A frame that is lost ends the run, with those before it, which the state that was kept may not know yet; one that is not is known by its sum.
        stepped.settle_output()?;
        if let Err(error) = stepped.go_back(&kept.state) {
            let message = format!("{}; the state before it is lost: {error}", failure.message);
            return Err(RunFailure { message, ..failure }.into());
        }
        self.smaller.insert(step, Smaller { share, failures });
        stepped.forget()
    }

    fn given_up(&self, failure: RunFailure, share: f64) -> RunFailure {
        let repeated = match self.most {
            0 => String::new(),
            _ => format!("; repeating the step down to {share:.2e} of the stable step did not help"),
        };
        let message = format!(
            "{}{repeated}; a smaller `time.courant`, more artificial viscosity or a softer contact may help",
            failure.message
        );
        RunFailure { message, ..failure }
    }
}

#[cfg(test)]
mod tests;
