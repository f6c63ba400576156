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

/// Takes one step of size `dt` (s), timing each stage. A step of size zero evaluates the initial rates. [`crate::Simulation`] calls it, and what
/// takes the same steps beside it on other ranks.
///
/// # Errors
/// Those of the stages.
pub fn advance(engine: &mut dyn Engine, dt: f64, seconds: &mut StageSeconds) -> Result<Advance, RunFailure> {
    let mut clock = Clock(Instant::now());
    engine.begin(dt)?;
    clock.lap(&mut seconds.integrate);
    let search = engine.refresh_neighbors()?;
    clock.lap(&mut seconds.search);
    engine.exchange(FieldSet::Audit)?;
    let audit = engine.audit()?;
    clock.skip();
    engine.exchange(FieldSet::Motion)?;
    engine.kinematics()?;
    engine.exchange(FieldSet::Density)?;
    engine.restore_density()?;
    engine.exchange(FieldSet::Volume)?;
    engine.correct_gradients()?;
    clock.lap(&mut seconds.kinematics);
    engine.find_faces()?;
    engine.exchange(FieldSet::Contact)?;
    engine.find_overlaps()?;
    engine.exchange(FieldSet::Overlaps)?;
    engine.push_faces()?;
    clock.lap(&mut seconds.forces);
    engine.stress()?;
    engine.exchange(FieldSet::Stress)?;
    clock.lap(&mut seconds.stress);
    engine.intermediate_sums()?;
    engine.exchange(FieldSet::IntermediateSums)?;
    engine.forces()?;
    clock.lap(&mut seconds.forces);
    engine.finish()?;
    engine.guard()?;
    let limit = engine.time_step_limit()?;
    clock.lap(&mut seconds.integrate);
    Ok(Advance { search, audit, limit })
}

struct Clock(Instant);

impl Clock {
    /// Adds the time since the last lap.
    fn lap(&mut self, stage: &mut f64) {
        let now = Instant::now();
        *stage += now.duration_since(self.0).as_secs_f64();
        self.0 = now;
    }

    /// Leaves out the time since the last lap.
    fn skip(&mut self) {
        self.0 = Instant::now();
    }
}
