//! A run in progress: an engine, its clock and the choice of steps.

use super::cpu::CpuEngine;
use super::engine::{Engine, Vote};
use super::step::advance;
use super::{Ledger, RunFailure, StageSeconds, StepReport, VoteReason};
use crate::model::{Model, Precision};
use crate::particles::Particles;
use std::sync::Arc;

/// A run in progress. Threads are those of the rayon pool it is called in.
pub struct Simulation {
    model: Arc<Model>,
    engine: Box<dyn Engine>,
    vote: Option<Vote>,
    time: f64,
    steps: u64,
    seconds: StageSeconds,
}

impl Simulation {
    /// Sets up the engine the model asks for.
    pub fn new(model: Model, particles: Particles) -> Self {
        let model = Arc::new(model);
        let engine: Box<dyn Engine> = match model.numerics.precision {
            Precision::Mixed => Box::new(CpuEngine::<f32>::new(model.clone(), particles)),
            Precision::Double => Box::new(CpuEngine::<f64>::new(model.clone(), particles)),
        };
        Self { model, engine, vote: None, time: 0.0, steps: 0, seconds: StageSeconds::default() }
    }

    /// Takes one time step, shortened so that it does not pass `land_on`, s.
    ///
    /// # Errors
    /// A value that is not finite, a density that is not positive, or a fixed step beyond the stable one.
    pub fn step(&mut self, land_on: Option<f64>) -> Result<StepReport, RunFailure> {
        let vote = self.next_vote()?;
        let (dt, reason) = self.choose_step(vote, land_on)?;
        let advanced = advance(self.engine.as_mut(), dt, &mut self.seconds).map_err(|f| self.date(f))?;
        self.vote = Some(advanced.vote);
        self.steps += 1;
        // Landing is exact: the sum of steps would miss the output time by a rounding.
        self.time = match land_on {
            Some(t) if reason == VoteReason::Output && self.time + dt >= t * (1.0 - 1e-12) => t,
            _ => self.time + dt,
        };
        Ok(StepReport {
            step: self.steps,
            time: self.time,
            dt,
            reason,
            searched_fraction: advanced.search.searched_fraction,
            pairs: self.engine.pairs(),
            audit: advanced.audit,
        })
    }

    /// Size of the next step, s, and its reason, before landing on output times. Evaluates the initial rates if needed.
    ///
    /// # Errors
    /// The initial state is not finite.
    pub fn next_step_estimate(&mut self) -> Result<(f64, VoteReason), RunFailure> {
        let vote = self.next_vote()?;
        self.choose_step(vote, None)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The particles as they are now.
    pub fn particles(&self) -> &Particles {
        self.engine.particles()
    }

    /// Time reached, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps done.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Conservation sums.
    pub fn ledger(&self) -> Ledger {
        self.engine.ledger()
    }

    /// Seconds by stage.
    pub fn stage_seconds(&self) -> StageSeconds {
        self.seconds
    }

    /// Mean number of neighbours inside the kernel support.
    pub fn mean_neighbors(&self) -> f64 {
        self.engine.pairs() as f64 / self.particles().len().max(1) as f64
    }

    /// Bytes held by columns, lists and scratch.
    pub fn memory_bytes(&self) -> u64 {
        self.engine.memory_bytes()
    }

    fn next_vote(&mut self) -> Result<Vote, RunFailure> {
        match self.vote {
            Some(vote) => Ok(vote),
            None => {
                // Preparation is not part of a step's time.
                let mut preparation = StageSeconds::default();
                let advanced = advance(self.engine.as_mut(), 0.0, &mut preparation).map_err(|f| self.date(f))?;
                self.vote = Some(advanced.vote);
                Ok(advanced.vote)
            }
        }
    }

    fn choose_step(&self, vote: Vote, land_on: Option<f64>) -> Result<(f64, VoteReason), RunFailure> {
        let control = &self.model.time;
        let (mut dt, mut reason) = (vote.dt, vote.reason);
        if let Some(fixed) = control.fixed_step {
            // The vote carries the Courant number as its margin; a fixed step may use that margin up, not more.
            if fixed * control.courant > vote.dt {
                return Err(self.date(RunFailure {
                    step: 0,
                    time: 0.0,
                    field: "time step",
                    particle: None,
                    body: None,
                    position: None,
                    message: format!(
                        "the fixed step {fixed:.3e} s is unstable: the vote ({}) allows {:.3e} s; lower `time.fixed-step`",
                        vote.reason.name(),
                        vote.dt
                    ),
                }));
            }
            (dt, reason) = (fixed, VoteReason::Deck);
        }
        if let Some(max) = control.max_step.filter(|&max| max < dt) {
            (dt, reason) = (max, VoteReason::Deck);
        }
        if let Some(left) = land_on.map(|t| t - self.time).filter(|&left| left > 0.0) {
            if left <= dt * (1.0 + 1e-9) {
                (dt, reason) = (left, VoteReason::Output);
            } else if left < 2.0 * dt {
                // Two equal steps rather than a full one and a sliver.
                (dt, reason) = (0.5 * left, VoteReason::Output);
            }
        }
        Ok((dt, reason))
    }

    fn date(&self, failure: RunFailure) -> RunFailure {
        RunFailure { step: self.steps + 1, time: self.time, ..failure }
    }
}
