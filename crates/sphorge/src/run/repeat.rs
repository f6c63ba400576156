//! Steps that are taken back and repeated smaller.
//!
//! A state is kept in memory now and then. Where a step fails that a smaller one may do, the run goes back to it and comes again by the same steps,
//! bit by bit, to the one that failed, which is now half as long. So it does not matter to a result when a state was kept, and a run that was
//! resumed repeats the same steps as one that was not.

use super::{error::Trouble, progress::Observer, state::RunState};
use crate::{
    engine::{RunFailure, StepReport, persist::MemoryArchive},
    number::plain_quantity,
};
use std::{collections::BTreeMap, time::Instant};

/// A state is kept so seldom that all of them cost half a hundredth of the run.
const SPARSENESS: f64 = 200.0;
/// Steps that are told of one by one.
const MOST_TOLD: u64 = 3;

/// Takes steps, and takes back those that fail.
pub(super) struct Repeater {
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
    pub(super) fn new(state: &RunState) -> Self {
        let most = state.simulation.model().time.step_control.map_or(0, |control| control.repeats);
        Self { sparseness: SPARSENESS, most, kept: None, smaller: BTreeMap::new(), told: 0 }
    }

    /// Takes the next step, or goes back and takes one before it.
    pub(super) fn step(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<StepReport, Trouble> {
        loop {
            let steps = state.simulation.steps();
            let smaller = self.smaller.get(&(steps + 1)).copied();
            // It may fail again: from here on there is nothing to repeat before it.
            let is_near = smaller.is_some() && self.kept.as_ref().is_some_and(|kept| kept.steps < steps);
            if self.most > 0 && (is_near || self.is_due()) {
                self.keep(state, observer)?;
            }
            if let Some(smaller) = smaller {
                state.simulation.shorten_next_step(smaller.share);
            }
            match state.step(observer, smaller.map_or(0, |smaller| smaller.failures)) {
                Err(Trouble::Engine(failure)) if failure.step_may_be_smaller => {
                    self.go_back(state, *failure, observer)?
                }
                result => return result,
            }
        }
    }

    fn is_due(&self) -> bool {
        self.kept.as_ref().is_none_or(|kept| kept.at.elapsed().as_secs_f64() > self.sparseness * kept.seconds)
    }

    fn keep(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<(), Trouble> {
        state.settle_row(observer)?;
        let start = Instant::now();
        // Before there is another one: there may be no room for two.
        self.kept = None;
        let mut archive = MemoryArchive::in_parts();
        if state.save(&mut archive).is_err() {
            // The engine does not give its state away.
            self.most = 0;
            return Ok(());
        }
        let steps = state.simulation.steps();
        self.smaller.retain(|&step, _| step > steps);
        let seconds = start.elapsed().as_secs_f64();
        self.kept = Some(Kept { state: archive, steps, at: Instant::now(), seconds });
        Ok(())
    }

    /// Goes back to the state that was kept, so that the step that failed comes again, smaller; or gives the failure back.
    fn go_back(
        &mut self,
        state: &mut RunState,
        failure: RunFailure,
        observer: &mut dyn Observer,
    ) -> Result<(), Trouble> {
        let step = failure.step;
        let failures = 1 + self.smaller.get(&step).map_or(0, |smaller| smaller.failures);
        // Steps that each fail a few times on the way down are no better than one that always does.
        let is_hopeless = failures > self.most || state.simulation.step_share() <= 0.5f64.powi(self.most as i32);
        let Some(kept) = self.kept.as_ref().filter(|_| !is_hopeless) else {
            return Err(self.given_up(failure, state.simulation.step_share()));
        };
        let share = 0.5 * state.simulation.tried_share();
        if self.told < MOST_TOLD && failures == 1 {
            self.told += 1;
            let last = if self.told == MOST_TOLD { "; further ones are only counted in `summary.json`" } else { "" };
            observer.noted(&format!(
                "step {step} at {} is repeated at half its size: {}{last}",
                plain_quantity(failure.time, "s"),
                failure.message
            ));
        }
        if let Err(error) = state.go_back(&kept.state) {
            let message = format!("{}; the state before it is lost: {error}", failure.message);
            return Err(Trouble::from(RunFailure { message, ..failure }));
        }
        self.smaller.insert(step, Smaller { share, failures });
        state.recorder.rewrite()?;
        Ok(())
    }

    fn given_up(&self, failure: RunFailure, share: f64) -> Trouble {
        let repeated = match self.most {
            0 => String::new(),
            _ => format!("; repeating the step down to {share:.2e} of the stable step did not help"),
        };
        let message = format!(
            "{}{repeated}; a smaller `time.courant`, more artificial viscosity or a softer contact may help",
            failure.message
        );
        RunFailure { message, ..failure }.into()
    }
}

#[cfg(test)]
mod tests;
