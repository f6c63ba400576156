//! The engine for GPUs: the whole step on the GPU.
//!
//! Columns stay in the memory of the GPU. After each step only the limits of the next one are copied back, and other
//! data on request. Numbers are in single precision. Those that a step adds to (positions, velocities, densities,
//! energies, strains) keep the rounding error in a second number, which gives them about double precision.

mod binding;
mod columns;
mod detached;
mod face_terms;
mod facets;
mod heat;
mod initial_columns;
mod kernel_texts;
mod kernels;
mod ledger;
mod lists;
mod made;
mod memory;
mod plan;
mod queued;
mod ranks;
mod read_back;
mod reductions;
mod renewal;
mod saved;
mod search;
mod sections;
mod segments;
mod snapshot;
mod stages;
mod start;
mod step;
mod stored_fields;
mod supports;
mod surfaces;
#[cfg(test)]
mod tests;

pub use kernel_texts::{KernelText, kernel_texts};

use crate::device::{Card, Profile};
use columns::{Columns, Group};
use facets::Facets;
use kernels::grid::Grid;
use plan::Plan;
use ranks::Domain;
use search::VerletLists;
use segments::Segments;
use sphorge_engine::{Engine, EngineKind, HeatClock, Model, Particles, RunFailure, Unsupported};
use stages::{Staged, Stages};
use std::cell::RefCell;
use std::sync::Arc;

/// The engine for GPUs, to be started on a model.
#[derive(Clone, Debug, Default)]
pub struct Gpu {
    /// Words of the name and the interface of the GPU; the best GPU if none are given.
    pub device: Option<String>,
    /// Index among identical GPUs, from zero on; it wraps around if there are fewer.
    pub number: usize,
    /// Collects the times of kernels: with it, each kernel is synchronised individually.
    pub profile: Option<Profile>,
}

/// Where the numbers of the step are: those of [`groups::Step`](columns::groups::Step), then those of the walls, then
/// the prescribed motions.
mod step_numbers {
    use super::columns::groups::{MotionOfStep, Step, WallOfStep};
    use super::columns::{Handles, Member, Shared};
    use sphorge_engine::Model;

    pub(super) const MOTION_LENGTH: usize = <MotionOfStep<()> as Handles<()>>::LENGTH;
    const WALLS: usize = <Step<()> as Handles<()>>::LENGTH;

    /// Those of a wall.
    pub(super) fn of_wall(step: Step<Shared>, wall: usize) -> WallOfStep<Shared> {
        WallOfStep::at(step.source(), WALLS).of(wall)
    }

    /// Start of the prescribed motions: the first one prescribes no axis.
    pub(super) fn motions(model: &Model) -> usize {
        WALLS + <WallOfStep<()> as Handles<()>>::LENGTH * model.walls.len()
    }

    /// The number of numbers.
    pub(super) fn count(model: &Model) -> usize {
        motions(model) + MOTION_LENGTH * (1 + model.motions.len())
    }
}

/// An engine on a GPU.
struct GpuEngine {
    model: Arc<Model>,
    card: Card,
    columns: Columns,
    plan: Plan,
    grid: Grid,
    /// Where bodies meet at facets.
    facets: Option<Facets>,
    stages: Stages<Staged>,
    lists: VerletLists,
    /// By body, whether its reference configuration has been renewed.
    has_separated: Vec<bool>,
    /// The initial particles of this GPU, in their common order: ids, bodies, masses.
    initial: Particles,
    /// The share of this rank, if there are several.
    domain: Option<Domain>,
    /// Loaded lists, until ghosts are chosen; their entries are indices in the common order.
    loaded_lists: Option<Vec<f32>>,
    /// Number of surface particles that are not ghosts.
    own_surface: Vec<u32>,
    /// Capacity for particles and ghosts, rounded up to whole chunks: the length of the columns.
    stride: usize,
    /// Number of steps begun.
    steps: u32,
    /// Start and length of the step, s.
    time: f64,
    dt: f64,
    /// Smallest limits, s, largest changes, whether a value is not a number, and the total number of neighbours, at the
    /// end of the last step.
    extremes: [f64; kernels::limits::FIELDS],
    /// With heat conduction, when it is summed again.
    heat: Option<HeatClock>,
    /// Whether what lies about particles is known, which without mechanics stays as it is.
    has_looked_for_heat: bool,
    /// Lowest temperature, K, with heat conduction.
    coldest: f64,
    /// Partition that sums are taken of.
    segments: Arc<Segments>,
    /// Groups that were copied back since the last step.
    read_back: RefCell<Vec<(Group, Arc<Vec<f32>>)>>,
    /// Reductions that were requested.
    reductions: RefCell<reductions::Known>,
}

impl EngineKind for Gpu {
    fn name(&self) -> &'static str {
        "gpu"
    }

    fn supports(&self, model: &Model) -> Result<(), Unsupported> {
        supports::supports(model)
    }

    fn completes_particles(&self) -> bool {
        true
    }

    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let engine = GpuEngine::new(model, particles, self, None)?;
        Ok(Box::new(engine))
    }
}

/// A GPU that returns wrong results.
fn failure(fault: impl std::fmt::Display) -> RunFailure {
    RunFailure::of_engine(fault.to_string())
}
