//! The engine for graphics cards: the whole step on the card.
//!
//! Columns stay in the memory of the card; of each step the limits of the next one come back, and what a user asks for when it is asked for.
//! Numbers are of single precision; those a step adds to (positions, velocities, densities, energies, strains) keep what rounding leaves of
//! them in a second number, which carries them like double precision.

mod columns;
mod conservation;
mod heat;
mod kernels;
mod lists;
mod plan;
mod renewal;
mod room;
mod search;
mod snapshot;
mod start;
mod step;
mod supports;
mod surfaces;

pub use start::{KernelText, kernel_texts};

use crate::device::{Card, Launch, Profile};
use columns::Columns;
use plan::Plan;
use search::Kept;
use snapshot::Snapshot;
use sphorge_engine::{Engine, EngineKind, HeatClock, Model, Particles, RunFailure, Unsupported};
use std::cell::OnceCell;
use std::sync::Arc;

/// The engine for graphics cards, to be started on a model.
#[derive(Clone, Debug, Default)]
pub struct Gpu {
    /// Words of the name and the interface of the card; the best there is if nothing is asked for.
    pub device: Option<String>,
    /// Where times of kernels go: with it, each is waited for by itself.
    pub profile: Option<Profile>,
}

/// Places in the numbers of the step.
mod step_numbers {
    /// Length of the step, s.
    pub(super) const DT: u32 = 0;
    /// Half of it.
    pub(super) const HALF: u32 = 1;
    /// Gravity, m/s².
    pub(super) const GRAVITY: u32 = 2;
    /// Neighbours that lists that are kept have room for.
    pub(super) const ROOM: u32 = 5;
    /// Number of the step.
    pub(super) const NUMBER: u32 = 6;
    /// The first wall.
    pub(super) const WALLS: u32 = 7;
    /// Displacement, m, and velocity, m/s, of a wall.
    pub(super) const WALL_LENGTH: u32 = 6;
    /// Of a prescribed motion: one along each axis where it holds, velocities at the middle and at the end of the step, m/s.
    pub(super) const MOTION_LENGTH: u32 = 9;

    /// Where prescribed motions start: the first is none, which holds no axis.
    pub(super) fn motions(model: &sphorge_engine::Model) -> u32 {
        WALLS + WALL_LENGTH * model.walls.len() as u32
    }

    /// How many numbers there are.
    pub(super) fn count(model: &sphorge_engine::Model) -> u32 {
        motions(model) + MOTION_LENGTH * (1 + model.motions.len() as u32)
    }
}

/// Kernels of a step, in groups that are launched together.
struct Stages {
    /// Of bodies that come apart the reference configuration of now.
    renew: Vec<Launch>,
    begin: Vec<Launch>,
    /// Before a search: smoothing lengths that follow the density, and places along periodic axes.
    wrap: Vec<Launch>,
    sorting: Vec<Launch>,
    /// Where lists are kept: how far particles have moved, and the search.
    ways: Vec<Launch>,
    search: Vec<Launch>,
    /// In adaptive search: who is searched, and their search.
    mark: Vec<Launch>,
    search_marked: Vec<Launch>,
    /// What the lists miss.
    audit: Vec<Launch>,
    gradients: Vec<Launch>,
    /// The same with the corrections of the strain that the guard counts, where these are due now and then.
    corrected_gradients: Vec<Launch>,
    /// Where forces are evaluated elsewhere than gradients, which are corrected.
    correct: Vec<Launch>,
    /// Moving least squares, where they are due now and then.
    restore: Vec<Launch>,
    /// Walls and gravity.
    push: Vec<Launch>,
    stress: Vec<Launch>,
    forces: Vec<Launch>,
    /// The end of the step, and what it changed.
    finish: Vec<Launch>,
    /// Of each section the force through it.
    sections: Vec<Vec<Launch>>,
    /// The flow of heat: its sums where they are due, what flows, and the extremes of both.
    sum_heat: Vec<Launch>,
    flow_heat: Vec<Launch>,
    heat_extremes: Vec<Launch>,
}

/// An engine on a card.
struct GpuEngine {
    model: Arc<Model>,
    card: Card,
    columns: Columns,
    plan: Plan,
    stages: Stages,
    kept: Kept,
    /// By body, whether its reference configuration has been renewed.
    has_come_apart: Vec<bool>,
    /// The particles as they came: ids, bodies, masses.
    initial: Particles,
    /// Particles, rounded up to whole chunks: the length of the columns.
    stride: usize,
    /// Steps begun.
    steps: u32,
    /// Start and length of the step, s.
    time: f64,
    dt: f64,
    /// Least limits, s, largest changes, whether a number is none, and neighbours of all, at the end of the last step.
    extremes: [f64; kernels::limits::FIELDS],
    /// Where heat flows, when it is summed again.
    heat: Option<HeatClock>,
    /// Least temperature, K, where heat flows.
    coldest: f64,
    /// What the card holds, where it was asked for since the last step.
    snapshot: OnceCell<Snapshot>,
}

impl EngineKind for Gpu {
    fn name(&self) -> &'static str {
        "gpu"
    }

    fn supports(&self, model: &Model) -> Result<(), Unsupported> {
        supports::supports(model)
    }

    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let engine = GpuEngine::new(model, particles, self)?;
        Ok(Box::new(engine))
    }
}

/// A card that does not do what it has to.
fn failure(fault: impl std::fmt::Display) -> RunFailure {
    RunFailure::of_engine(fault.to_string())
}
