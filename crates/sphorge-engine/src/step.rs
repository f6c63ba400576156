//! The time step, in the order of the papers.

use crate::engine::{Engine, SearchReport, TimeStepLimit};
use crate::halo::FieldSet;
use crate::{Audit, RunFailure, StageSeconds};
use std::time::Instant;

/// What one pass through the stages yields.
#[derive(Clone, Copy, Debug)]
pub struct Advance {
    /// Share of the work the search did.
    pub search: SearchReport,
    /// Comparison of the lists with an exact search, where one was due.
    pub audit: Option<Audit>,
    /// Longest stable next step.
    pub limit: TimeStepLimit,
}

/// Takes one step of size `dt` (s), timing each stage, and of it what this process waits for others. A step of size zero evaluates the initial rates. [`crate::Simulation`] calls it, and what
/// takes the same steps beside it on other ranks.
///
/// # Errors
/// Those of the stages.
pub fn advance(
    engine: &mut dyn Engine,
    dt: f64,
    seconds: &mut StageSeconds,
    waiting: &mut StageSeconds,
) -> Result<Advance, RunFailure> {
    let mut clock = Clock { at: Instant::now(), waited: engine.waited() };
    engine.begin(dt)?;
    clock.lap(engine, &mut seconds.integrate, &mut waiting.integrate);
    let search = engine.refresh_neighbors()?;
    clock.lap(engine, &mut seconds.search, &mut waiting.search);
    let audit = engine.audit()?;
    clock.skip(engine);
    engine.begin_exchange(FieldSet::Motion)?;
    engine.inner_kinematics()?;
    engine.finish_exchange(FieldSet::Motion)?;
    engine.kinematics()?;
    engine.exchange(FieldSet::Density)?;
    engine.restore_density()?;
    engine.exchange(FieldSet::Volume)?;
    engine.correct_gradients()?;
    clock.lap(engine, &mut seconds.kinematics, &mut waiting.kinematics);
    engine.find_faces()?;
    engine.exchange(FieldSet::Contact)?;
    engine.find_overlaps()?;
    engine.exchange(FieldSet::Overlaps)?;
    engine.push_faces()?;
    clock.lap(engine, &mut seconds.forces, &mut waiting.forces);
    engine.stress()?;
    engine.begin_exchange(FieldSet::Stress)?;
    clock.lap(engine, &mut seconds.stress, &mut waiting.stress);
    engine.inner_forces()?;
    engine.finish_exchange(FieldSet::Stress)?;
    engine.intermediate_sums()?;
    engine.exchange(FieldSet::IntermediateSums)?;
    engine.forces()?;
    clock.lap(engine, &mut seconds.forces, &mut waiting.forces);
    engine.finish()?;
    engine.guard()?;
    let limit = engine.time_step_limit()?;
    clock.lap(engine, &mut seconds.integrate, &mut waiting.integrate);
    Ok(Advance { search, audit, limit })
}

struct Clock {
    at: Instant,
    /// Seconds the process had waited then.
    waited: f64,
}

impl Clock {
    /// Adds the time since the last lap, and what of it was waited.
    fn lap(&mut self, engine: &dyn Engine, stage: &mut f64, waiting: &mut f64) {
        let (at, waited) = (self.at, self.waited);
        self.skip(engine);
        *stage += self.at.duration_since(at).as_secs_f64();
        *waiting += self.waited - waited;
    }

    /// Leaves out the time since the last lap.
    fn skip(&mut self, engine: &dyn Engine) {
        *self = Self { at: Instant::now(), waited: engine.waited() };
    }
}
