//! Kernels of a card, timed one by one.

use super::StageShares;
use super::measure::steps;
use crate::{
    engine::{EngineKind, RunFailure, Simulation},
    run::repeat::Repeater,
};
use serde::Serialize;
use std::sync::Arc;

/// An engine that can wait for each kernel of a card, and gives their times.
#[derive(Clone)]
pub struct KernelClock {
    /// The engine, which waits for nothing until it is told to.
    pub engine: Arc<dyn EngineKind>,
    /// Waits for no kernel from here on, or for each.
    pub pause: Arc<dyn Fn(bool) + Send + Sync>,
    /// Forgets what was timed so far.
    pub clear: Arc<dyn Fn() + Send + Sync>,
    /// Gives what was timed in so many steps, and forgets it.
    pub take: Arc<dyn Fn(u64) -> Vec<KernelRow> + Send + Sync>,
}

impl std::fmt::Debug for KernelClock {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("KernelClock").field("engine", &self.engine).finish_non_exhaustive()
    }
}

/// Times of a kernel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KernelRow {
    /// Its name.
    pub kernel: String,
    /// Launches a step.
    pub launches_per_step: f64,
    /// Seconds a launch.
    pub seconds: f64,
    /// Share of the time of all kernels.
    pub share: f64,
    /// Bytes its threads read and write, a launch, from memory or from a cache.
    pub bytes: Option<f64>,
    /// Arithmetic operations, a launch.
    pub operations: Option<f64>,
    /// These bytes a second over those of a copy; above one where caches serve.
    pub share_of_bandwidth: Option<f64>,
    /// Operations a second over those of products that are added to something.
    pub share_of_arithmetic: Option<f64>,
}

impl KernelClock {
    /// Takes steps of a simulation of [`Self::engine`] for `seconds` of wall-clock time, waiting for each kernel: share of the time by stage, and
    /// kernels.
    pub(super) fn measure(
        &self,
        (repeater, simulation): (&mut Repeater, &mut Simulation),
        seconds: f64,
    ) -> Result<(StageShares, Vec<KernelRow>), RunFailure> {
        (self.pause)(false);
        (self.clear)();
        // What each kernel does is counted in one of these.
        let counted = steps((repeater, simulation), 0.0);
        (self.clear)();
        let before = simulation.stage_seconds();
        let measured = counted.and_then(|_| steps((repeater, simulation), seconds));
        let shares = StageShares::between(before, simulation.stage_seconds());
        let kernels = (self.take)(measured.as_ref().map_or(0, |measured| measured.steps));
        (self.pause)(true);
        measured.map(|_| (shares, kernels))
    }
}
