//! A run in progress: an engine, its clock and the choice of steps.

use crate::approach;
use crate::engine::{Engine, EngineKind, InPieces, TimeStepLimit};
use crate::model::Model;
use crate::particles::{Column, FIELDS, History, Particles};
use crate::persist::{Archive, ArchiveError, Persist, persist_count, require};
use crate::reduction::{FieldSource, ParticleSource, QueuedSums, Reduction};
use crate::step::advance;
use crate::{Drive, ENGINES, Ledger, LimitReason, RunFailure, StageSeconds, StepReport};
use std::sync::Arc;

/// A run in progress. Threads are those of the rayon pool it is called in.
pub struct Simulation {
    model: Arc<Model>,
    engine: Box<dyn Engine>,
    name: &'static str,
    saved_as: &'static str,
    clock: RunClock,
    /// Longest step in which bodies that approach each other as at the start are still found to meet, s.
    approach: f64,
    /// Share of the stable step that the last step took or tried.
    tried_share: f64,
    seconds: StageSeconds,
    /// Of the seconds of each stage, those that this process has waited for others.
    waiting: StageSeconds,
    /// Seconds it has waited before the first step.
    waited_before: f64,
}

/// How far a run is.
#[derive(Clone, Copy, Debug)]
struct RunClock {
    /// Longest stable next step; unknown before the initial rates are.
    limit: Option<TimeStepLimit>,
    /// s.
    time: f64,
    steps: u64,
    /// Share of that step to take: 1, unless a step was taken back.
    share: f64,
}

impl Default for RunClock {
    fn default() -> Self {
        Self { limit: None, time: 0.0, steps: 0, share: 1.0 }
    }
}

/// Growth of the share of the stable step after one was taken back: four steps double it.
const RECOVERY: f64 = 1.189_207_115_002_721;

impl Persist for RunClock {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.time.persist(&format!("{name}.time"), archive)?;
        persist_count(&mut self.steps, &format!("{name}.steps"), archive)?;
        let mut limit = self.limit.map(|limit| (limit.dt, limit.reason));
        limit.persist(&format!("{name}.limit"), archive)?;
        self.limit = limit.map(|(dt, reason)| TimeStepLimit { dt, reason });
        let share = format!("{name}.share");
        self.share.persist(&share, archive)?;
        require(self.share > 0.0 && self.share <= 1.0, &share)
    }
}

impl FieldSource for Simulation {
    fn count(&self) -> usize {
        self.engine.count()
    }
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.engine.read(field)
    }
}

impl ParticleSource for Simulation {
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        self.engine.reduce(reduction)
    }
}

impl Simulation {
    /// Starts the default engine.
    ///
    /// # Panics
    /// If that engine does not run the model; only tests and tools that know that it does call this.
    pub fn new(model: Model, particles: Particles) -> Self {
        Self::start(ENGINES[0], model, particles).unwrap_or_else(|failure| panic!("{failure}"))
    }

    /// Starts an engine; [`EngineKind::supports`] says beforehand whether it can run the model.
    ///
    /// # Errors
    /// See [`EngineKind::start`].
    pub fn start(kind: &dyn EngineKind, model: Model, mut particles: Particles) -> Result<Self, RunFailure> {
        let model = Arc::new(model);
        let approach = approach::limit(&model, &particles);
        if kind.ranks() == 1 && !kind.completes_particles() {
            particles.complete();
        }
        let engine = kind.start(model.clone(), particles)?;
        let seconds = StageSeconds::default();
        let waited_before = engine.waited();
        Ok(Self {
            waiting: StageSeconds::default(),
            waited_before,
            model,
            engine,
            name: kind.name(),
            saved_as: kind.saved_as(),
            clock: RunClock::default(),
            approach,
            tried_share: 1.0,
            seconds,
        })
    }

    /// Takes one time step, shortened so that it does not pass `land_on`, s.
    ///
    /// # Errors
    /// A value that is not finite, a density that is not positive, a fixed step beyond the stable one, or an engine that is lost.
    pub fn step(&mut self, land_on: Option<f64>) -> Result<StepReport, RunFailure> {
        let limit = self.next_limit()?;
        let (dt, reason) = self.choose_step(limit, land_on)?;
        self.tried_share = dt / limit.dt.min(self.model.time.max_step.unwrap_or(f64::INFINITY));
        let advanced =
            advance(self.engine.as_mut(), dt, &mut self.seconds, &mut self.waiting).map_err(|f| self.date(f))?;
        let clock = &mut self.clock;
        clock.limit = Some(advanced.limit);
        clock.steps += 1;
        clock.share = (clock.share * RECOVERY).min(1.0);
        // Landing is exact: the sum of steps would miss the output time by a rounding.
        clock.time = match land_on {
            Some(t) if reason == LimitReason::Output && clock.time + dt >= t * (1.0 - 1e-12) => t,
            _ => clock.time + dt,
        };
        Ok(StepReport {
            step: clock.steps,
            time: clock.time,
            dt,
            reason,
            searched_fraction: advanced.search.searched_fraction,
            pairs: self.engine.pairs(),
            audit: advanced.audit,
        })
    }

    /// Makes the next step at most this share, above 0 and below 1, of the longest stable one. Those after it grow by and by.
    pub fn shorten_next_step(&mut self, share: f64) {
        self.clock.share = self.clock.share.min(share);
    }

    /// Share of the longest stable step that the next step is to take: 1 unless steps were taken back.
    pub fn step_share(&self) -> f64 {
        self.clock.share
    }

    /// Share of the longest stable step that the last step took, or tried where it failed.
    pub fn tried_share(&self) -> f64 {
        self.tried_share
    }

    /// Size of the next step, s, and its reason, before landing on output times. Evaluates the initial rates if needed.
    ///
    /// # Errors
    /// The initial state is not finite.
    pub fn next_step_estimate(&mut self) -> Result<(f64, LimitReason), RunFailure> {
        let limit = self.next_limit()?;
        self.choose_step(limit, None)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Most work of a process over the mean of all that share the particles, counted in pairs, in the last step.
    pub fn imbalance(&self) -> f64 {
        self.engine.imbalance()
    }

    /// Share of the particles whose pairs are summed while ghosts are on their way between processes.
    pub fn inner_share(&self) -> f64 {
        self.engine.inner_share()
    }

    /// Name of the engine whose saved states these are.
    pub fn saved_as(&self) -> &'static str {
        self.saved_as
    }

    /// Name of the device that computes, where that is not the processor.
    pub fn device(&self) -> Option<String> {
        self.engine.device()
    }

    /// Name of the engine.
    pub fn engine_name(&self) -> &'static str {
        self.name
    }

    /// Processes that share the particles.
    pub fn ranks(&self) -> usize {
        self.engine.ranks()
    }

    /// The processes that share the particles, where each can write its own.
    pub fn in_pieces(&self) -> Option<&dyn InPieces> {
        self.engine.in_pieces()
    }

    /// All fields as they are now, to be read elsewhere while steps go on, where reading them now would make these wait: see [`Engine::detach`].
    ///
    /// # Errors
    /// The engine is lost.
    pub fn detach(&self) -> Result<Option<Box<dyn FieldSource + Send>>, RunFailure> {
        self.engine.detach()
    }

    /// The ledger and these sums as they are now, to be waited for when steps have gone on, where asking for them now would make these wait: see
    /// [`Engine::queue_sums`].
    ///
    /// # Errors
    /// The engine is lost.
    pub fn queue_sums(&self, asked: &[Reduction<'_>]) -> Result<Option<Box<dyn QueuedSums>>, RunFailure> {
        self.engine.queue_sums(asked)
    }

    /// A copy of every field a user can name, in the order of `id`.
    ///
    /// # Errors
    /// The engine is lost.
    pub fn particles(&self) -> Result<Particles, RunFailure> {
        let mut particles = Particles::new(self.count());
        particles.history = History::new(&self.model, particles.len());
        for field in FIELDS.iter() {
            particles.set_column(field.name, &self.engine.read(field.name)?);
        }
        Ok(particles)
    }

    /// Time reached, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }

    /// Steps done.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }

    /// Whether a program can give loads and velocities of bodies between steps: [`Self::drive`].
    pub fn can_be_driven(&self) -> bool {
        self.engine.can_be_driven()
    }

    /// Whether loads or velocities act that a program has given, now or before the state was saved.
    pub fn is_driven(&self) -> bool {
        self.driven().is_some()
    }

    /// Which bodies have a load of a program, and which motions a velocity of it; none if nothing is driven.
    pub fn driven(&self) -> Option<(Vec<bool>, Vec<bool>)> {
        self.engine.driven()
    }

    /// Gives loads and velocities that hold from the next step on, until others are given. Within a step they are constant; velocities change at its
    /// start. Their work and impulse enter the ledger.
    ///
    /// # Errors
    /// The engine cannot be driven, or the numbers do not fit the model.
    pub fn drive(&mut self, drive: &Drive) -> Result<(), RunFailure> {
        self.next_limit()?;
        self.engine.drive(drive).map_err(|f| self.date(f))?;
        // A load changes the acceleration, which limits the step.
        self.clock.limit = Some(self.engine.time_step_limit().map_err(|f| self.date(f))?);
        Ok(())
    }

    /// Conservation sums.
    ///
    /// # Errors
    /// The engine is lost.
    pub fn ledger(&self) -> Result<Ledger, RunFailure> {
        self.engine.ledger()
    }

    /// Seconds by stage.
    pub fn stage_seconds(&self) -> StageSeconds {
        self.seconds
    }

    /// Seconds by stage that this process has waited for messages of others or sent its own, since it was started and after the initial rates were
    /// evaluated; zero for a process alone.
    pub fn waiting_seconds(&self) -> StageSeconds {
        let StageSeconds { search, kinematics, stress, forces, integrate, .. } = self.waiting;
        let in_steps = search + kinematics + stress + forces + integrate;
        StageSeconds { output: (self.engine.waited() - self.waited_before - in_steps).max(0.0), ..self.waiting }
    }

    /// Mean number of neighbours inside the kernel support.
    pub fn mean_neighbors(&self) -> f64 {
        self.engine.pairs() as f64 / self.count().max(1) as f64
    }

    /// Bytes held by columns, lists and scratch.
    pub fn memory_bytes(&self) -> u64 {
        self.engine.memory_bytes()
    }

    /// Saves everything the steps to come depend on, or loads it into a simulation that was started with the same model and
    /// particles.
    ///
    /// # Errors
    /// The archive holds something else.
    pub fn persist(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.clock.persist("clock", archive)?;
        // Shares of the stages are those of the whole run.
        self.seconds.persist("seconds", archive)?;
        self.engine.persist(archive)
    }

    fn next_limit(&mut self) -> Result<TimeStepLimit, RunFailure> {
        match self.clock.limit {
            Some(limit) => Ok(limit),
            None => {
                // Preparation is not part of a step's time.
                let [mut preparation, mut waiting] = [StageSeconds::default(); 2];
                let advanced = advance(self.engine.as_mut(), 0.0, &mut preparation, &mut waiting);
                let advanced = advanced.map_err(|f| self.date(f))?;
                self.waited_before = self.engine.waited();
                self.clock.limit = Some(advanced.limit);
                Ok(advanced.limit)
            }
        }
    }

    fn choose_step(&self, limit: TimeStepLimit, land_on: Option<f64>) -> Result<(f64, LimitReason), RunFailure> {
        let control = &self.model.time;
        let (mut dt, mut reason) = (limit.dt, limit.reason);
        if let Some(fixed) = control.fixed_step {
            // The limit carries the Courant number as its margin; a fixed step may use that margin up, not more.
            if fixed * control.courant > limit.dt {
                return Err(self.date(RunFailure {
                    field: "time step",
                    ..RunFailure::of_engine(format!(
                        "the fixed step {fixed:.3e} s is unstable: the limit ({}) is {:.3e} s; lower `time.fixed-step`",
                        limit.reason.name(),
                        limit.dt
                    ))
                }));
            }
            (dt, reason) = (fixed, LimitReason::Deck);
        }
        if let Some(max) = control.max_step.filter(|&max| max < dt) {
            (dt, reason) = (max, LimitReason::Deck);
        }
        if self.approach < dt && control.fixed_step.is_none() {
            (dt, reason) = (self.approach, LimitReason::Contact);
        }
        if self.clock.share < 1.0 && control.fixed_step.is_none() {
            (dt, reason) = (dt * self.clock.share, LimitReason::Repeat);
        }
        if let Some(left) = land_on.map(|t| t - self.clock.time).filter(|&left| left > 0.0) {
            if left <= dt * (1.0 + 1e-9) {
                (dt, reason) = (left, LimitReason::Output);
            } else if left < 2.0 * dt {
                // Two equal steps rather than a full one and a sliver.
                (dt, reason) = (0.5 * left, LimitReason::Output);
            }
        }
        if self.clock.time + dt > self.clock.time {
            return Ok((dt, reason));
        }
        let message = format!(
            "the time step ({}) is {:.3e} s, which does not move the time: an acceleration, a speed or a stiffness is too large, or \
             `time.courant` too small",
            reason.name(),
            dt.abs()
        );
        Err(self.date(RunFailure { field: "time step", ..RunFailure::of_engine(message) }))
    }

    fn date(&self, failure: RunFailure) -> RunFailure {
        RunFailure { step: self.clock.steps + 1, time: self.clock.time, ..failure }
    }
}
