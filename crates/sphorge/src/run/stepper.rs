//! What the driver asks of a simulation; apart from it so that the driver can be tested alone.

use crate::{
    engine::{Ledger, LimitReason, RunFailure, Simulation, StageSeconds, StepReport},
    model::Model,
    output::FailureRecord,
    particles::Particles,
};

/// Something that takes time steps.
pub(super) trait Stepper {
    /// Evaluates the initial state, and the size of the first step and what limits it.
    fn prepare(&mut self) -> Result<(f64, LimitReason), Box<FailureRecord>>;
    /// Takes one step that does not pass `land_on` (s) and ends exactly there if it gets that far. After a failure the
    /// state is not to be written.
    fn step(&mut self, land_on: f64) -> Result<StepReport, Box<FailureRecord>>;
    fn model(&self) -> &Model;
    fn particles(&self) -> &Particles;
    fn time(&self) -> f64;
    fn steps(&self) -> u64;
    fn ledger(&self) -> Ledger;
    fn stage_seconds(&self) -> StageSeconds;
    fn mean_neighbors(&self) -> f64;
    fn memory_bytes(&self) -> u64;
}

impl Stepper for Simulation {
    fn prepare(&mut self) -> Result<(f64, LimitReason), Box<FailureRecord>> {
        self.next_step_estimate().map_err(|failure| record(self.model(), failure))
    }
    fn step(&mut self, land_on: f64) -> Result<StepReport, Box<FailureRecord>> {
        Simulation::step(self, Some(land_on)).map_err(|failure| record(self.model(), failure))
    }
    fn model(&self) -> &Model {
        Simulation::model(self)
    }
    fn particles(&self) -> &Particles {
        Simulation::particles(self)
    }
    fn time(&self) -> f64 {
        Simulation::time(self)
    }
    fn steps(&self) -> u64 {
        Simulation::steps(self)
    }
    fn ledger(&self) -> Ledger {
        Simulation::ledger(self)
    }
    fn stage_seconds(&self) -> StageSeconds {
        Simulation::stage_seconds(self)
    }
    fn mean_neighbors(&self) -> f64 {
        Simulation::mean_neighbors(self)
    }
    fn memory_bytes(&self) -> u64 {
        Simulation::memory_bytes(self)
    }
}

/// The failure with names for numbers.
fn record(model: &Model, failure: RunFailure) -> Box<FailureRecord> {
    let body = failure.body.and_then(|body| model.bodies.get(body as usize));
    Box::new(FailureRecord {
        message: failure.message,
        step: failure.step,
        time: failure.time,
        field: Some(failure.field.to_owned()),
        particle: failure.particle,
        body: body.map(|body| body.name.clone()),
        // JSON has no words for what is not finite.
        position: failure.position.filter(|position| position.iter().all(|x| x.is_finite())),
    })
}
