//! The engine for graphics cards: the whole step on the card.
//!
//! Columns stay in the memory of the card; of each step the limits of the next one come back, and what a user asks for when it is asked for.
//! Numbers are of single precision; those a step adds to (positions, velocities, densities, energies, strains) keep what rounding leaves of
//! them in a second number, which carries them like double precision.

mod columns;
mod heat;
mod kernels;
mod ledger;
mod lists;
mod plan;
mod ranks;
mod reductions;
mod renewal;
mod room;
mod saved;
mod search;
mod sections;
mod segments;
mod snapshot;
mod start;
mod step;
mod supports;
mod surfaces;
#[cfg(test)]
mod tests;

pub use start::{KernelText, kernel_texts};

use crate::device::{Card, Launch, Profile};
use columns::{Columns, Group};
use kernels::grid::Grid;
use plan::Plan;
use ranks::Domain;
use ranks::touched::Touched;
use search::Kept;
use segments::Segments;
use sphorge_engine::{Engine, EngineKind, HeatClock, Model, Particles, RunFailure, Unsupported};
use std::cell::RefCell;
use std::sync::Arc;

/// The engine for graphics cards, to be started on a model.
#[derive(Clone, Debug, Default)]
pub struct Gpu {
    /// Words of the name and the interface of the card; the best there is if nothing is asked for.
    pub device: Option<String>,
    /// Which of those that are like it, from zero on, and from the first again where there are fewer.
    pub number: usize,
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
    /// Where particles are shared: the first ghost whose place in the common order is before those of the own particles.
    pub(super) const GHOSTS_BEFORE: u32 = 7;
    /// The first wall.
    pub(super) const WALLS: u32 = 8;
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

/// A kernel that is launched in a step, and what it has to do with columns of particles; nothing is known of that on one card.
struct Staged {
    launch: Launch,
    touched: Touched,
}

/// Kernels that are launched one after the other.
type Stage = Vec<Staged>;

/// Kernels of a step, in groups that are launched together.
#[derive(Default)]
struct Stages {
    /// Of bodies that come apart the reference configuration of now.
    renew: Stage,
    /// Lists of the reference configuration: before their lengths are known, and when there is room for them.
    count_lists: Stage,
    fill_lists: Stage,
    /// Where particles are shared: how far they have moved since ghosts were chosen.
    ghost_ways: Stage,
    begin: Stage,
    /// Smoothing lengths that follow the density.
    follow: Stage,
    /// Before a search: places along periodic axes.
    wrap: Stage,
    sorting: Stage,
    /// Where lists are kept: how far particles have moved, and the search.
    ways: Stage,
    /// In adaptive search along periodic axes: how far particles have moved since the last full search.
    strayed: Stage,
    search: Stage,
    /// In adaptive search: who is searched, and their search.
    mark: Stage,
    search_marked: Stage,
    /// What the lists miss.
    audit: Stage,
    gradients: Stage,
    /// The same with the corrections of the strain that the guard counts, where these are due now and then.
    corrected_gradients: Stage,
    /// Where forces are evaluated elsewhere than gradients, which are corrected.
    correct: Stage,
    /// Moving least squares, where they are due now and then.
    restore: Stage,
    /// Walls and gravity.
    push: Stage,
    stress: Stage,
    forces: Stage,
    /// The end of the step, and what it changed.
    finish: Stage,
    /// Of each section the force through it.
    sections: Vec<Stage>,
    section_sums: Vec<Stage>,
    /// The flow of heat: its sums where they are due, what flows, and the extremes of both.
    sum_heat: Stage,
    flow_heat: Stage,
    heat_extremes: Stage,
    /// The sums of the ledger.
    ledger: Stage,
}

/// An engine on a card.
struct GpuEngine {
    model: Arc<Model>,
    card: Card,
    columns: Columns,
    plan: Plan,
    grid: Grid,
    stages: Stages,
    kept: Kept,
    /// By body, whether its reference configuration has been renewed.
    has_come_apart: Vec<bool>,
    /// The particles of this card as they came, in their common order: ids, bodies, masses.
    initial: Particles,
    /// The share of this rank, where there are others.
    domain: Option<Domain>,
    /// Lists that were loaded, until ghosts are chosen; their entries name places in the common order.
    loaded_kept: Option<Vec<f32>>,
    /// Of the particles of the surface those that are no ghosts.
    own_surface: Vec<u32>,
    /// Particles and room for ghosts, rounded up to whole chunks: the length of the columns.
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
    /// Portions that sums are taken of.
    segments: Segments,
    /// Groups that were copied back since the last step.
    read_back: RefCell<Vec<(Group, Arc<Vec<f32>>)>>,
    /// Reductions that were asked for.
    reductions: RefCell<reductions::Known>,
}

impl EngineKind for Gpu {
    fn name(&self) -> &'static str {
        "gpu"
    }

    fn supports(&self, model: &Model) -> Result<(), Unsupported> {
        supports::supports(model)
    }

    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let engine = GpuEngine::new(model, particles, self, None)?;
        Ok(Box::new(engine))
    }
}

/// A card that does not do what it has to.
fn failure(fault: impl std::fmt::Display) -> RunFailure {
    RunFailure::of_engine(fault.to_string())
}
