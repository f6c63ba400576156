//! Starts an engine: particles in their order, on a GPU.

use super::columns::keeps_rests;
use super::facets::Facets;
use super::initial_columns::make_columns;
use super::kernels::grid::Grid;
use super::kernels::limits;
use super::kernels::reference::References;
use super::kernels::smoothing::largest_factor;
use super::memory::refuse_beyond_memory;
use super::plan::Plan;
use super::ranks::agreement::made_on_all;
use super::ranks::lifetime::SharedModel;
use super::ranks::{Domain, choose_at_start, stride_for};
use super::search::VerletLists;
use super::segments::{self, Segments};
use super::stages::Stages;
use super::{Gpu, GpuEngine, failure};
use crate::device::{Card, CardFault};
use rayon::prelude::*;
use sphorge_engine::model::Dimensions;
use sphorge_engine::neighbors::hilbert_order;
use sphorge_engine::particles::Permutation;
use sphorge_engine::ranks::{Communicator, Ranks};
use sphorge_engine::{HeatClock, Model, Particles, RunFailure, complete_initial_state};
use std::cell::RefCell;
use std::sync::Arc;

/// Largest number of particles that single precision can count exactly.
const MOST: usize = 1 << 24;

/// How much wider a cell is than the reach of the kernel, because its index is computed in single precision.
const MARGIN: f64 = 1.0 + 1e-4;

/// Number of cells over those that contain particles at the start, because particles spread.
const SPARE: f64 = 1.5;

impl GpuEngine {
    /// An engine alone, or the part of a rank.
    pub(super) fn new(
        model: Arc<Model>,
        mut p: Particles,
        kind: &Gpu,
        communicator: Option<Arc<dyn Communicator>>,
    ) -> Result<Self, RunFailure> {
        let grid = grid_of(&model, &p);
        sort_along_curve(&model, &mut p, grid.edge);
        let mut domain = None;
        if let Some(communicator) = communicator {
            if p.len() >= MOST && model.lists_outlast_ghosts() {
                return Err(failure(format!(
                    "{} particles: lists that are kept can index up to {}",
                    p.len(),
                    MOST - 1
                )));
            }
            let mut of_rank = Domain::new(Ranks::new(communicator), p.len())?;
            p.keep(of_rank.own());
            choose_at_start(&mut of_rank, &model, &p, grid.edge)?;
            domain = Some(of_rank);
        }
        p.complete();
        complete_initial_state(&model, &mut p);
        // The masses by which forces are divided, so that the sums over bodies close.
        p.mass.iter_mut().for_each(|mass| *mass = f64::from(*mass as f32));
        let ranks = domain.as_ref().map(|domain| domain.ranks.clone());
        let engine = Self::on_a_card(model, p, kind, grid, domain);
        let mut engine = match &ranks {
            // All ranks fail together.
            Some(ranks) => made_on_all(ranks, engine)?,
            None => engine?,
        };
        engine.take_ghosts()?;
        engine.make_lists()?;
        Ok(engine)
    }

    /// Particles on a GPU.
    fn on_a_card(
        model: Arc<Model>,
        p: Particles,
        kind: &Gpu,
        grid: Grid,
        domain: Option<Domain>,
    ) -> Result<Self, RunFailure> {
        let ghosts = domain.as_ref().map_or(0, Domain::ghosts);
        if p.len() + ghosts >= MOST {
            let message = format!(
                "{} particles: the engine for graphics cards supports up to {} on each card",
                p.len() + ghosts,
                MOST - 1
            );
            return Err(failure(message));
        }
        let mut card = Card::open_number(kind.device.as_deref(), kind.number).map_err(|fault| match &fault {
            CardFault::NotFound { help, .. } => failure(format!("{fault}; {help}")),
            _ => failure(&fault),
        })?;
        if let Some(profile) = &kind.profile {
            card = card.profiled(profile.clone());
        }
        if !keeps_rests(&card).map_err(failure)? {
            let name = &card.found().name;
            return Err(failure(format!(
                "the compiler of {name} optimises the compensation of rounding errors away: positions and energies would have only six correct digits; run with `--engine cpu`"
            )));
        }
        let stride = stride_for(p.len(), ghosts);
        refuse_beyond_memory(&card, (&model, &p), stride, &grid)?;
        let mut columns = make_columns(&card, (&model, &p), stride, &grid, domain.is_some()).map_err(failure)?;
        let total = domain.as_ref().map_or(p.len(), Domain::total);
        let segments = Segments::of(&model, &p, total);
        segments::insert(&card, &mut columns, &model, (&p, &segments)).map_err(failure)?;
        let mut engine = Self {
            card,
            columns,
            plan: Plan::default(),
            stages: Stages::default(),
            lists: VerletLists::default(),
            has_separated: vec![false; model.bodies.len()],
            facets: Facets::of(&model),
            initial: p,
            loaded_lists: None,
            own_surface: Vec::new(),
            grid,
            stride,
            steps: 0,
            time: 0.0,
            dt: 0.0,
            extremes: [0.0; limits::FIELDS],
            heat: model.thermal.conduction.then(HeatClock::default),
            has_looked_for_heat: false,
            coldest: f64::INFINITY,
            segments: Arc::new(segments),
            read_back: RefCell::default(),
            reductions: RefCell::default(),
            domain,
            model,
        };
        engine.plan = engine.plan_of(References::Initial)?;
        engine.rebind()?;
        Ok(engine)
    }
}

/// The order of particles along a space-filling curve, so that neighbours are near each other in memory, and on ranks
/// on one GPU.
fn sort_along_curve(model: &Model, p: &mut Particles, cell: f64) {
    let axes = match model.dimensions {
        Dimensions::One => 1,
        Dimensions::PlaneStrain => 2,
        Dimensions::Three => 3,
    };
    let mut permutation = Permutation::default();
    permutation.set(&hilbert_order(&p.position, cell, axes));
    p.reorder(&permutation);
}

pub(super) fn grid_of(model: &Model, p: &Particles) -> Grid {
    let largest = p.smoothing_length.iter().fold(0.0f64, |a, h| a.max(*h));
    let reach = model.numerics.kernel.support() * (1.0 + model.skin_fraction());
    let edge = MARGIN * reach * largest * largest_factor(model);
    let axes = match model.dimensions {
        Dimensions::One => 1,
        Dimensions::PlaneStrain => 2,
        Dimensions::Three => 3,
    };
    let (mut origin, mut counts) = ([0.0; 3], [1; 3]);
    for axis in 0..axes {
        let along = || p.position.par_iter().with_min_len(1 << 12).map(|x| x[axis]);
        let low = along().reduce(|| f64::INFINITY, f64::min);
        let high = along().reduce(|| f64::NEG_INFINITY, f64::max);
        origin[axis] = low;
        // At least four cells along an axis, so that none is visited twice.
        counts[axis] = ((SPARE * (high - low) / edge).ceil() as u32 + 1).next_power_of_two().max(4);
    }
    Grid { origin, reach, edge, counts }
}
