//! Copies particles to the card and compiles its kernels.

use super::columns::{Columns, Group, Recording, keeps_rests};
use super::facets::Facets;
use super::kernels::reference::References;
use super::kernels::smoothing::{AT_START, largest_factor};
use super::kernels::{conduction, contact, facets, grid, kept, limits, reduce, walls};
use super::plan::{Grids, Plan, Planned, Rows, Threads, members};
use super::ranks::agreement::made_on_all;
use super::ranks::lifetime::SharedModel;
use super::ranks::touched::{ALL, ColumnSet, Touched};
use super::ranks::{Domain, choose_at_start, exchange, stride_for};
use super::room::refuse_what_has_no_room;
use super::search::Kept;
use super::segments::{self, Segments};
use super::snapshot::fields;
use super::stages::{Staged, Stages};
use super::{Gpu, GpuEngine, failure};
use crate::device::{Array, Card, CardFault};
use crate::record::KernelFault;
use grid::Grid;
use rayon::prelude::*;
use sphorge_engine::model::Dimensions;
use sphorge_engine::neighbors::hilbert_order;
use sphorge_engine::particles::{HistoryVariables, Permutation};
use sphorge_engine::ranks::{Communicator, Ranks};
use sphorge_engine::{HeatClock, Model, Particles, RunFailure, complete_initial_state};
use sphorge_physics::artificial_stress::coefficient;
use std::cell::RefCell;
use std::iter;
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

    /// Particles on a card.
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
        refuse_what_has_no_room(&card, (&model, &p), stride, &grid)?;
        let mut columns = make_columns(&card, (&model, &p), stride, &grid, domain.is_some()).map_err(failure)?;
        let total = domain.as_ref().map_or(p.len(), Domain::total);
        let segments = Segments::of(&model, &p, total);
        segments::insert(&card, &mut columns, &model, (&p, &segments)).map_err(failure)?;
        let mut engine = Self {
            card,
            columns,
            plan: Plan::default(),
            stages: Stages::default(),
            kept: Kept::default(),
            has_come_apart: vec![false; model.bodies.len()],
            facets: Facets::of(&model),
            initial: p,
            loaded_kept: None,
            own_surface: Vec::new(),
            grid,
            stride,
            steps: 0,
            time: 0.0,
            dt: 0.0,
            extremes: [0.0; limits::FIELDS],
            heat: model.thermal.conduction.then(HeatClock::default),
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

    /// The kernels of the step, compiled.
    pub(super) fn plan_of(&self, references: References) -> Result<Plan, RunFailure> {
        let portions = self.segments.portions();
        let rows = Rows { stride: self.stride, are_shared: self.domain.is_some(), portions };
        let grids = Grids { of_kernels: &self.grid, of_facets: &self.grid_of_facets() };
        let plan = Plan::of(&self.model, &self.initial, rows, grids, references).map_err(failure)?;
        self.card.compile_ahead(&plan.all().map(|recording| &recording.kernel).collect::<Vec<_>>());
        if !self.card.found().is_software {
            // With a software renderer, unneeded kernels cost more than they save.
            self.card.compile_ahead(&plan.reductions.iter().map(|of| &of.kernel.kernel).collect::<Vec<_>>());
        }
        Ok(plan)
    }
}

/// The order of particles along a space-filling curve, so that neighbours are near each other in memory, and on ranks
/// on one card.
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

/// Numbers of a group, field by field, of columns of whole chunks.
pub(super) fn fill(
    stride: usize,
    fields: usize,
    count: usize,
    number: impl Fn(usize, usize) -> f64 + Sync,
) -> Vec<f32> {
    let mut numbers = vec![0.0; stride * fields];
    numbers.par_chunks_mut(limits::CHUNK).with_min_len(16).enumerate().for_each(|(chunk, numbers)| {
        let (field, first) = (chunk * limits::CHUNK / stride, chunk * limits::CHUNK % stride);
        for (i, to) in (first..count).zip(numbers) {
            *to = number(field, i) as f32;
        }
    });
    numbers
}

/// Numbers on the card; if all are zero, none are copied there.
fn brought(card: &Card, numbers: &[f32]) -> Result<Array, CardFault> {
    let is_zero = |numbers: &[f32]| numbers.iter().all(|number| number.to_bits() == 0);
    if numbers.par_chunks(1 << 16).all(is_zero) { card.zeros(numbers.len()) } else { card.numbers(numbers) }
}

/// A number, or its rest in single precision.
pub(super) fn part(number: f64, rest: bool) -> f64 {
    let high = f64::from(number as f32);
    if rest { number - high } else { high }
}

/// Prescribed motion of every particle: its index plus one; zero for none.
pub(super) fn motions(model: &Model, p: &Particles) -> Vec<u32> {
    p.regions
        .par_iter()
        .with_min_len(1 << 12)
        .map(|regions| model.motion_of(*regions).map_or(0, |k| k as u32 + 1))
        .collect()
}

/// The initial configuration: positions, m, and volumes, m^d.
pub(super) fn reference(p: &Particles, field: usize, i: usize) -> f64 {
    match field {
        6 | 7 => part(p.mass[i] / p.density[i], field == 7),
        _ => part(p.position[i][field % 3], field >= 3),
    }
}

/// Columns of a given length for particles, with their initial values; those of shared particles are followed by
/// ghosts.
pub(super) fn make_columns(
    card: &Card,
    (model, p): (&Model, &Particles),
    stride: usize,
    grid: &Grid,
    is_shared: bool,
) -> Result<Columns, CardFault> {
    let mut columns = Columns::default();
    let count = p.len();
    let numerics = &model.numerics;
    let of_body = |i: usize| &model.bodies[p.body[i] as usize];
    let variables = HistoryVariables::of(model).variables;
    let vector = |of: &[[f64; 3]], field: usize, i: usize| part(of[i][field % 3], field >= 3);
    for (group, fields) in fields(model) {
        let number = |field: usize, i: usize| match (group, field) {
            (Group::Place, _) => vector(&p.position, field, i),
            (Group::Velocity, _) => vector(&p.velocity, field, i),
            (Group::Evaluated, _) => p.velocity[i][field],
            (Group::Density, _) => part(p.density[i], field == 1),
            (Group::Energy, 0 | 1) => part(p.energy[i], field == 1),
            (Group::Temperature, _) => part(p.temperature[i], field == 1),
            (Group::Deviator, _) => p.deviator[i].to_array()[field],
            (Group::History, _) => part(variables[field / 2].initial, field % 2 == 1),
            (Group::Plastic, 0 | 1) => part(p.plastic_strain[i], field == 1),
            (Group::Plastic, 3) => p.yield_stress[i],
            (Group::Plastic, 4 | 5) => part(p.plastic_work[i], field == 5),
            (Group::Constants, 0) => p.mass[i],
            (Group::Constants, 1 | AT_START) => p.smoothing_length[i],
            (Group::Constants, 2) => numerics.artificial_stress.map_or(0.0, |terms| {
                let at_spacing = numerics.kernel.w(of_body(i).spacing / of_body(i).smoothing_length);
                coefficient(terms.epsilon, at_spacing, terms.exponent)
            }),
            (Group::Constants, 3) => of_body(i).spacing,
            (Group::Constants, 6) => p.mass[i] / model.materials[p.material[i] as usize].density,
            (Group::Constants, 5) => model.materials[p.material[i] as usize].young_modulus(),
            (Group::Constants, _) => model.materials[p.material[i] as usize].equation_of_state.reference_sound_speed(),
            (Group::Packed, 12) => 1.0,
            (Group::Contact, contact::LIMIT) => f64::from(f32::MAX),
            (Group::Reference, _) => reference(p, field, i),
            (Group::Deformation, 0 | 4 | 8) | (Group::Stretch | Group::Springs, 0) => 1.0,
            _ => 0.0,
        };
        let mut numbers = fill(stride, fields, count, number);
        if group == Group::Limits {
            numbers[..limits::LIMITS * stride].fill(f32::MAX);
        }
        columns.insert(group, brought(card, &numbers)?);
    }
    let wall_fields = (walls::FIELDS * model.walls.len()).max(1);
    columns.insert(Group::Walls, card.zeros(wall_fields * stride)?);
    let rows = reduce::rows(stride);
    for (group, rows) in iter::once((Group::Extremes, rows)).chain(reduce::groups(Group::Extremes, rows)) {
        columns.insert(group, card.zeros(limits::EXTREMES * rows)?);
    }
    columns.insert(Group::Step, card.zeros(super::step_numbers::count(model) as usize)?);
    let padded = |mut whole: Vec<u32>| {
        whole.resize(stride, 0);
        card.indices(&whole)
    };
    columns.insert(Group::Motion, padded(motions(model, p))?);
    columns.insert(Group::Body, padded(p.body.clone())?);
    if let Some(laws) = contact::laws(model) {
        columns.insert(Group::ContactLaws, card.numbers(&laws)?);
        if !model.has_faces() {
            columns.insert(Group::Surface, card.indices(&(0..count as u32).collect::<Vec<_>>())?);
        }
    }
    for section in 0..model.sections.len() {
        columns.insert(Group::Section(section), card.zeros(3 * stride)?);
    }
    if model.thermal.conduction {
        columns.insert(Group::HeatLaws, card.numbers(&conduction::laws(model))?);
        columns.insert(Group::Boundaries, card.numbers(&conduction::claims(model, p, stride))?);
        for (group, rows) in iter::once((Group::HeatExtremes, rows)).chain(reduce::groups(Group::HeatExtremes, rows)) {
            columns.insert(group, card.zeros(conduction::EXTREMES * rows)?);
        }
        if model.conducts_between_bodies() {
            columns.insert(Group::Touched, card.zeros(stride)?);
        }
    }
    for k in 0..model.materials.len() {
        columns.insert(Group::Members(k), card.indices(&members(p, k))?);
    }
    let cells = grid.chunks() * grid::CHUNK;
    columns.insert(Group::CellCounts, card.zeros(cells)?);
    columns.insert(Group::CellStarts, card.zeros(cells + 1)?);
    columns.insert(Group::ChunkStarts, card.zeros(grid.sums())?);
    for group in [Group::Slots, Group::Unsorted, Group::Sorted] {
        columns.insert(group, card.zeros(stride)?);
    }
    if model.is_total_lagrangian() {
        // Room is made when it is known how much.
        columns.insert(Group::ListStarts, card.zeros(count + 1)?);
        columns.insert(Group::List, card.zeros(0)?);
    }
    if model.has_faces() {
        columns.insert(Group::Surface, card.zeros(0)?);
        if model.sorts_by_contact_positions() {
            columns.insert(Group::Outward, card.zeros(6 * stride)?);
        }
    }
    if model.has_facets() {
        columns.insert(Group::FacetTable, card.zeros(0)?);
        columns.insert(Group::Facets, card.zeros(facets::FACETS * stride)?);
    }
    if is_shared {
        columns.insert(Group::Sends, card.zeros(0)?);
    }
    if is_shared && model.ghosts_expire() {
        columns.insert(Group::GhostsAt, card.zeros(6 * stride)?);
    }
    if numerics.mls_interval.is_some() {
        columns.insert(Group::Restored, card.zeros(stride)?);
    }
    if model.keeps_lists() {
        // Room is made when it is known how much.
        columns.insert(Group::Kept, card.zeros(0)?);
        columns.insert(Group::Rows, card.zeros(kept::ROWS * stride)?);
        columns.insert(Group::SearchedAt, card.zeros(kept::SEARCHED_AT * stride)?);
        if model.keeps_distances() {
            columns.insert(Group::Stored, card.zeros(0)?);
        }
        if model.adaptive_search().is_some() {
            columns.insert(Group::Patched, card.zeros(stride)?);
            columns.insert(Group::FoundAt, card.zeros(6 * stride)?);
            columns.insert(Group::Candidates, card.zeros(stride)?);
            columns.insert(Group::StrainCorrection, card.zeros((kept::STRAINED + 1) * stride)?);
        }
    }
    if model.keeps_lists() || is_shared {
        for (group, rows) in iter::once((Group::Ways, rows)).chain(reduce::groups(Group::Ways, rows)) {
            columns.insert(group, card.zeros(kept::WAYS * rows)?);
        }
    }
    columns.insert(Group::Around, card.indices(&grid.around())?);
    Ok(columns)
}

/// The source of a kernel of the step in the languages of cards.
#[derive(Clone, Debug)]
pub struct KernelText {
    /// Its name.
    pub name: String,
    /// For Vulkan, Metal and Direct3D 12.
    pub wgsl: String,
    /// For CUDA.
    pub cuda: String,
}

/// Every kernel of the step of a model that [`super::Gpu`] supports.
///
/// # Errors
/// A law cannot be translated for a card.
pub fn kernel_texts(model: &Model, particles: &Particles) -> Result<Vec<KernelText>, KernelFault> {
    let stride = particles.len().div_ceil(limits::CHUNK) * limits::CHUNK;
    let portions = Segments::of(model, particles, particles.len()).portions();
    let rows = Rows { stride, are_shared: false, portions };
    let grid = grid_of(model, particles);
    let of = |references| Plan::of(model, particles, rows, Grids::one(&grid), references);
    let text = |recording: &Recording| KernelText {
        name: recording.kernel.name.clone(),
        wgsl: crate::source::wgsl(&recording.kernel),
        cuda: crate::source::cuda(&recording.kernel),
    };
    let of_plan = |plan: &Plan| -> Vec<_> {
        plan.all().chain(plan.reductions.iter().map(|planned| &planned.kernel)).map(text).collect()
    };
    let mut texts = of_plan(&of(References::Initial)?);
    if model.formulation.renews() {
        // Kernels that change once a body has come apart.
        for mut other in of_plan(&of(References::Renewed)?) {
            if !texts.iter().any(|known| known.cuda == other.cuda) {
                other.name += "_renewed";
                texts.push(other);
            }
        }
    }
    each_kernel_of_ranks(model, particles, stride, &mut |recording| {
        let mut other = text(recording);
        if !texts.iter().any(|known| known.cuda == other.cuda) {
            other.name += "_shared";
            texts.push(other);
        }
    })?;
    Ok(texts)
}

/// Visits the kernels of a model whose particles are shared by several cards, and the kernels of the halo exchange.
fn each_kernel_of_ranks(
    model: &Model,
    p: &Particles,
    stride: usize,
    visit: &mut dyn FnMut(&Recording),
) -> Result<(), KernelFault> {
    let portions = Segments::of(model, p, p.len()).portions();
    let rows = Rows { stride, are_shared: true, portions };
    let plan = Plan::of(model, p, rows, Grids::one(&grid_of(model, p)), References::Initial)?;
    let mut gathered = ColumnSet::new();
    for recording in plan.all() {
        for (group, columns) in Touched::of(recording, stride, false).gathered {
            *gathered.entry(group).or_default() |= columns;
        }
    }
    // Columns whose index is unknown are those of the longest group.
    gathered.values_mut().filter(|columns| **columns == ALL).for_each(|columns| *columns = 1);
    plan.all().chain(&exchange::kernels(&gathered, stride, p.len())?).for_each(visit);
    Ok(())
}

impl GpuEngine {
    /// Binds the kernels of the step to the current columns, with as many threads as there are rows.
    pub(super) fn rebind(&mut self) -> Result<(), RunFailure> {
        let ghosts = self.domain.as_ref().map_or(0, Domain::ghosts);
        let surface = self.columns.array(Group::Surface).map_or(0, Array::count);
        let is_shared = self.domain.is_some();
        let bind = |planned: &Planned| {
            let (threads, runs_over_ghosts) = match planned.threads {
                Threads::Of(count) => (count, false),
                Threads::OfAllHere => (self.initial.len() + ghosts, true),
                // If faces do not follow the deformation, all particles may be in contact.
                Threads::OfSurface if !self.model.has_faces() => (self.initial.len(), false),
                Threads::OfSurface => (self.own_surface.len(), false),
                Threads::OfSurfaceHere => (surface, true),
            };
            let launch = planned.kernel.bind(&self.card, &self.columns, threads).map_err(failure)?;
            let of = || Touched::of(&planned.kernel, self.stride, runs_over_ghosts);
            Ok(Staged { launch, touched: if is_shared { of() } else { Touched::default() } })
        };
        self.stages = self.plan.stages.map(bind)?;
        // Reductions requested before may be bound to former columns.
        self.reductions.take();
        Ok(())
    }
}
