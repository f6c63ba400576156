//! The time step, in the order of the papers.

use super::engine::{Engine, SearchReport, Vote};
use super::{Audit, RunFailure, StageSeconds};
use std::time::Instant;

/// What one pass through the stages yields.
pub(super) struct Advance {
    pub(super) search: SearchReport,
    pub(super) audit: Option<Audit>,
    pub(super) vote: Vote,
}

/// Takes one step of size `dt`, timing each stage. A step of size zero evaluates the initial rates.
pub(super) fn advance(engine: &mut dyn Engine, dt: f64, seconds: &mut StageSeconds) -> Result<Advance, RunFailure> {
    let mut clock = Clock(Instant::now());
    engine.begin(dt);
    clock.lap(&mut seconds.integrate);
    let search = engine.refresh_neighbors();
    clock.lap(&mut seconds.search);
    let audit = engine.audit();
    clock.skip();
    engine.kinematics();
    clock.lap(&mut seconds.kinematics);
    engine.stress();
    clock.lap(&mut seconds.stress);
    engine.forces();
    clock.lap(&mut seconds.forces);
    engine.finish();
    engine.guard()?;
    let vote = engine.vote();
    clock.lap(&mut seconds.integrate);
    Ok(Advance { search, audit, vote })
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
