//! When a run saves its state.

use super::{error::Trouble, listed, progress::Observer, state::RunState};
use crate::{
    deck::marked_as_driven,
    output::{
        About, DECK, Durability, OutputError, RunDirectory, checkpoints, remove_former_checkpoints, write_checkpoint,
    },
};
use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

/// When a run saves its state. With any of these but the request, a run that is stopped by the user saves it too.
#[derive(Clone, Debug, Default)]
pub struct CheckpointPlan {
    /// Wall-clock time from one checkpoint to the next.
    pub every: Option<Duration>,
    /// Simulated time from one to the next, s; after the first step past its multiples.
    pub interval: Option<f64>,
    /// Whether the run saves its state when it has reached its end, so that it can go on beyond.
    pub at_end: bool,
    /// The run saves its state and goes on when this becomes true; it is false again then.
    pub request: Option<Arc<AtomicBool>>,
}

impl CheckpointPlan {
    /// Whether a run saves its state without being asked by a request.
    fn saves(&self) -> bool {
        self.every.is_some() || self.interval.is_some() || self.at_end
    }
}

/// Keeps a plan.
pub(super) struct Keeper {
    plan: CheckpointPlan,
    last: Instant,
    /// Simulated time of the next one, s.
    next: f64,
    deck_name: String,
    deck_text: String,
    /// Sums of the particles from files, once a state has been saved.
    listed: Option<BTreeMap<String, String>>,
}

impl Keeper {
    /// From `time` (s) on.
    pub(super) fn new(plan: CheckpointPlan, deck_name: String, deck_text: String, time: f64) -> Self {
        let next = plan.interval.map_or(f64::INFINITY, |interval| multiple_after(time, interval));
        Self { plan, last: Instant::now(), next, deck_name, deck_text, listed: None }
    }

    /// Writes to the deck that a program drives the run: whoever runs the deck alone is told.
    pub(super) fn mark_as_driven(&mut self, directory: &RunDirectory) -> Result<(), OutputError> {
        let marked = marked_as_driven(&self.deck_text);
        if marked != self.deck_text {
            directory.write(DECK, Durability::Disk, |out| out.write_all(marked.as_bytes()))?;
            self.deck_text = marked;
        }
        Ok(())
    }

    /// Saves the state if it is time to.
    pub(super) fn after_step(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<(), Trouble> {
        let time = state.simulation.time();
        let is_asked = self.plan.request.as_ref().is_some_and(|request| request.swap(false, Ordering::Relaxed));
        let is_late = self.plan.every.is_some_and(|every| self.last.elapsed() >= every);
        if time >= self.next || is_late || is_asked {
            self.save(state, observer)?;
        }
        Ok(())
    }

    /// Saves the state of a run that is stopped; before the first step there is nothing to go on from.
    pub(super) fn at_stop(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<(), Trouble> {
        if self.plan.saves() && state.simulation.steps() > 0 {
            self.save(state, observer)?;
        }
        Ok(())
    }

    /// Saves the state of a run that has reached its end, if that was asked for.
    pub(super) fn at_end(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<(), Trouble> {
        if self.plan.at_end {
            self.save(state, observer)?;
        }
        Ok(())
    }

    /// Saves the state now. A run whose state cannot be written goes on: it is well, and the checkpoints before are there.
    ///
    /// # Errors
    /// The row or the frame that was under way is lost.
    pub(super) fn save(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<(), Trouble> {
        state.settle_row(observer)?;
        state.recorder.settle()?;
        if let Err(error) = self.try_save(state, observer) {
            let kept = checkpoints(state.recorder.directory().path()).unwrap_or_default();
            let kept = match kept.first() {
                Some((step, _)) => format!("the checkpoint of step {step} is kept"),
                None => "there is no checkpoint yet".to_owned(),
            };
            observer.noted(&format!("the state of the run could not be saved: {}; {kept}", error.chain()));
        }
        Ok(())
    }

    /// Saves the state now, or says why it could not be written.
    fn try_save(&mut self, state: &mut RunState, observer: &mut dyn Observer) -> Result<(), OutputError> {
        // Rows and frames that it counts on come to the disk before it.
        let synced = state.recorder.flush();
        let written = synced.and_then(|()| self.write(state, None, observer));
        written.and_then(|()| remove_former_checkpoints(state.recorder.directory()))
    }

    /// Saves the state of a run whose deck has changed from `former`, before anything else in its folder does.
    pub(super) fn save_changed(
        &mut self,
        state: &mut RunState,
        former: String,
        observer: &mut dyn Observer,
    ) -> Result<(), OutputError> {
        self.write(state, Some(former), observer)
    }

    fn write(
        &mut self,
        state: &mut RunState,
        changed_from: Option<String>,
        observer: &mut dyn Observer,
    ) -> Result<(), OutputError> {
        let (step, time) = (state.simulation.steps(), state.simulation.time());
        let mut about = About::new(state.simulation.saved_as(), &self.deck_name, step, time);
        about.changed_from = changed_from;
        about.listed = self.listed.get_or_insert_with(|| listed::sums(state.simulation.model())).clone();
        if let Some(interval) = self.plan.interval {
            self.next = multiple_after(time, interval);
        }
        let directory = state.recorder.directory().clone();
        let written = write_checkpoint(&directory, &about, &self.deck_text, state.simulation.ranks(), |archive| {
            state.save(archive)
        });
        self.last = Instant::now();
        match written? {
            Some(path) => observer.saved(&path, step, time),
            None => {
                observer.noted("the engine cannot save its state: the run cannot be resumed");
                self.plan = CheckpointPlan::default();
            }
        }
        Ok(())
    }
}

/// The first multiple of an interval after a time.
fn multiple_after(time: f64, interval: f64) -> f64 {
    ((time / interval * (1.0 + 1e-12)).floor() + 1.0) * interval
}
