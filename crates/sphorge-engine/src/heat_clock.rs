//! When the flow of heat is summed again.

use crate::Model;

/// Share of its own time step after which a flow beside mechanics is summed again.
const RENEWAL: f64 = 0.1;

/// Steps beside mechanics after which it is summed again in any case: work has warmed particles since.
const RENEWAL_STEPS: u32 = 50;

/// Conduction in metals is slower than sound by many orders, so beside mechanics a flow goes on until a tenth of the step that it bears itself
/// has passed, or fifty steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatClock {
    /// Largest stable step over the margin at the last evaluation, s.
    pub limit: f64,
    /// Time since then, s; infinite before the first.
    age: f64,
    /// Steps since then.
    steps: u32,
}

impl Default for HeatClock {
    fn default() -> Self {
        Self { limit: f64::INFINITY, age: f64::INFINITY, steps: 0 }
    }
}

impl HeatClock {
    /// Whether the flow is summed again in this step.
    pub fn is_due(&self, model: &Model) -> bool {
        let is_recent = self.steps < RENEWAL_STEPS && self.age < RENEWAL * model.time.courant * self.limit;
        !(model.thermal.mechanics && is_recent)
    }

    /// The flow is summed now.
    pub fn start(&mut self) {
        (self.age, self.steps) = (0.0, 0);
    }

    /// It has gone on for a step, s.
    pub fn advance(&mut self, dt: f64) {
        self.age += dt;
        self.steps += 1;
    }
}

crate::persist_fields!(HeatClock { limit, age, steps });
