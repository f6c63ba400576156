//! The kernels of the step of a model.

use super::columns::{Group, Layout, Recording, groups};
use super::kernels::reference::References;
use super::kernels::section::Through;
use super::kernels::stress::StressOf;
use super::kernels::sums::Partition;
use super::kernels::{
    audit, conduction, contact, face_sums, facet_forces, facets, grid, leapfrog, ledger, limits, moving_least_squares,
    pair_forces, pairs, predictor_corrector, reduce, reductions, reference, reference_forces, shared_edges, smoothing,
    stress, sums, verlet, walls, wrap,
};
use super::ranks::lifetime::SharedModel;
use super::search::DISPLACEMENT_REDUCTION;
use super::stages::{Stage, Stages};
use crate::record::KernelFault;
use grid::{Grid, Sorted, SortingThreads};
use rayon::prelude::*;
use sphorge_engine::model::{Formulation, Integrator, Search, TemperatureSource, Wall};
use sphorge_engine::{Model, Particles};
use sphorge_physics::Dimension;

/// Number of threads of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Threads {
    Of(usize),
    /// One per particle and ghost on this GPU.
    OfAllHere,
    /// One per surface particle, whose number is known when lists are built; and with ghosts among them.
    OfSurface,
    OfSurfaceHere,
    /// One per particle at a face, or near one, whose number is known when lists are built.
    OfFaces,
    NearFaces,
}

/// Length of the columns, and whether they contain ghosts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    pub(super) stride: usize,
    pub(super) are_shared: bool,
    /// The partition of sums.
    pub(super) partition: Partition,
}

/// A kernel with the number of its threads.
pub(super) struct Planned {
    pub(super) kernel: Recording,
    pub(super) threads: Threads,
}

/// The kernels that sort into cells, for this number of threads.
fn sorting(grid: &Grid, rows: Rows, of: Sorted, threads: Threads) -> Result<Vec<Planned>, KernelFault> {
    let planned = |(kernel, of)| match of {
        SortingThreads::Of(count) => Planned { kernel, threads: Threads::Of(count) },
        SortingThreads::OfSorted => Planned { kernel, threads },
    };
    Ok(grid::sorting(grid, rows.stride, of, rows.are_shared)?.into_iter().map(planned).collect())
}

/// Reduction passes over rows.
fn reduced(passes: Vec<(Recording, usize)>) -> impl Iterator<Item = Planned> {
    passes.into_iter().map(|(kernel, threads)| Planned { kernel, threads: Threads::Of(threads) })
}

/// Kernels that compute these sums over segments: those of lanes, and the one that adds the results of the lanes.
fn summed(kernels: Vec<Recording>, of_lanes: Recording, (partition, sums): (Partition, usize)) -> Vec<Planned> {
    let of_segments = |kernel| Planned { kernel, threads: Threads::Of(partition.segments * partition.lanes()) };
    let last = Planned { kernel: of_lanes, threads: Threads::Of(partition.segments * sums) };
    kernels.into_iter().map(of_segments).chain([last]).collect()
}

/// Every kernel of a run.
#[derive(Default)]
pub(super) struct Plan {
    pub(super) stages: Stages<Planned>,
    /// Reductions that a run of the deck requests, to be compiled with all others.
    pub(super) reductions: Vec<Planned>,
}

/// Kernels for the number of dimensions of a model.
macro_rules! in_dimension {
    ($model:expr, $module:ident::$function:ident, $($argument:expr),*) => {
        match Dimension::from($model.dimensions) {
            Dimension::One => $module::$function::<1>($($argument),*)?,
            Dimension::Two => $module::$function::<2>($($argument),*)?,
            Dimension::Three => $module::$function::<3>($($argument),*)?,
        }
    };
}

/// Cells in which particles are sorted, within the reach of kernels and of facets.
#[derive(Clone, Copy)]
pub(super) struct Grids<'a> {
    pub(super) of_kernels: &'a Grid,
    pub(super) of_facets: &'a Grid,
}

impl<'a> Grids<'a> {
    /// The same cells for both.
    pub(super) fn one(grid: &'a Grid) -> Self {
        Self { of_kernels: grid, of_facets: grid }
    }
}

impl Plan {
    /// Columns are `stride` long.
    pub(super) fn of(
        model: &Model,
        p: &Particles,
        rows: Rows,
        grids: Grids<'_>,
        references: References,
    ) -> Result<Self, KernelFault> {
        let mut planner = Planner { model, p, rows, grids, references, stages: Stages::default() };
        planner.integrate()?;
        match model.formulation {
            Formulation::UpdatedLagrangian => planner.sum_in_current_configuration()?,
            Formulation::TotalLagrangian { renewal, .. } => planner.sum_in_reference_configuration(renewal)?,
        }
        planner.audit()?;
        planner.push_faces()?;
        planner.stress()?;
        planner.forces()?;
        for (number, section) in model.sections.iter().enumerate() {
            planner.section(Through { number, section })?;
        }
        planner.ledger()?;
        planner.conduct_heat()?;
        planner.limit_step()?;
        planner.reduce_displacements()?;
        let reductions = reductions::of_deck(model, references, (rows.partition, rows.stride))?;
        let reductions = reductions.into_iter().map(|kernel| planner.of_particles(kernel)).collect();
        Ok(Self { stages: planner.stages, reductions })
    }

    /// All of them but reductions, in the order of a run.
    pub(super) fn all(&self) -> impl Iterator<Item = &Recording> {
        self.stages.all().map(|planned| &planned.kernel)
    }
}

/// What a plan is made from, and the stages so far.
struct Planner<'a> {
    model: &'a Model,
    p: &'a Particles,
    rows: Rows,
    grids: Grids<'a>,
    references: References,
    stages: Stages<Planned>,
}

impl Planner<'_> {
    /// Rows of the first pass of a reduction.
    fn parts(&self) -> usize {
        reduce::rows(self.rows.stride)
    }

    fn of_particles(&self, kernel: Recording) -> Planned {
        Planned { kernel, threads: Threads::Of(self.p.len()) }
    }

    /// Adds a kernel with a thread for every particle.
    fn add(&mut self, stage: Stage, kernel: Recording) {
        let planned = self.of_particles(kernel);
        self.stages.push(stage, planned);
    }

    /// Adds a kernel with a thread for every row of the first pass of a reduction.
    fn add_of_parts(&mut self, stage: Stage, kernel: Recording) {
        self.stages.push(stage, Planned { kernel, threads: Threads::Of(self.parts()) });
    }

    /// Adds a kernel with a thread for every surface particle.
    fn add_of_surface(&mut self, stage: Stage, kernel: Recording) {
        self.stages.push(stage, Planned { kernel, threads: Threads::OfSurface });
    }

    /// Adds a kernel with a thread for every particle at a face, or near one.
    fn add_near_faces(&mut self, stage: Stage, threads: Threads, kernel: Recording) {
        self.stages.push(stage, Planned { kernel, threads });
    }

    fn add_sorting(&mut self, stage: Stage, grid: &Grid, of: Sorted, threads: Threads) -> Result<(), KernelFault> {
        self.stages.extend(stage, sorting(grid, self.rows, of, threads)?);
        Ok(())
    }

    /// Begin and end of the step.
    fn integrate(&mut self) -> Result<(), KernelFault> {
        let (model, stride) = (self.model, self.rows.stride);
        let (begin, finish) = match model.numerics.integrator {
            Integrator::Leapfrog => (leapfrog::begin(model, stride)?, leapfrog::finish(model, stride)?),
            Integrator::PredictorCorrector => {
                (predictor_corrector::predict(model, stride)?, predictor_corrector::correct(model, stride)?)
            }
        };
        self.add(Stage::Begin, begin);
        self.add(Stage::Finish, finish);
        Ok(())
    }

    /// Search and gradients in the current configuration.
    fn sum_in_current_configuration(&mut self) -> Result<(), KernelFault> {
        let (model, stride) = (self.model, self.rows.stride);
        if let Some(follow) = smoothing::follow(model, stride)? {
            self.add(Stage::Follow, follow);
        }
        if let Some(wrap) = wrap::wrap(model, stride)? {
            self.add(Stage::Wrap, wrap);
        }
        self.add_sorting(Stage::Sorting, self.grids.of_kernels, Sorted::Particles, Threads::OfAllHere)?;
        if model.keeps_lists() {
            self.search()?;
        }
        self.add(Stage::Gradients, pairs::weigh(model, stride)?);
        self.add(Stage::Gradients, in_dimension!(model, pairs::gradients, model, false, stride));
        if model.corrects_current_gradients() && model.numerics.integrator == Integrator::Leapfrog {
            self.add(Stage::Correct, in_dimension!(model, pairs::correct, model, stride));
        }
        if model.numerics.mls_interval.is_some() {
            self.add(Stage::Restore, in_dimension!(model, moving_least_squares::estimate, model, stride));
            self.add(Stage::Restore, moving_least_squares::restore(model, stride)?);
        }
        Ok(())
    }

    /// Stored lists, and when they are searched.
    fn search(&mut self) -> Result<(), KernelFault> {
        let (model, stride, count) = (self.model, self.rows.stride, self.p.len());
        let grid = self.grids.of_kernels;
        let rule = model.adaptive_search();
        let is_guarded = rule.is_some_and(|rule| rule.guard.is_some());
        let since = if is_guarded { Group::FoundAt } else { Group::SearchedAt };
        if model.search != Search::EveryStep {
            self.add_of_parts(Stage::Displacements, verlet::displacements(model, since, count, stride)?);
        }
        if rule.is_some() && model.periodic.iter().any(Option::is_some) {
            self.add_of_parts(
                Stage::DisplacementsSinceSearch,
                verlet::displacements(model, Group::SearchedAt, count, stride)?,
            );
        }
        if let Some(rule) = rule {
            self.add(Stage::Mark, verlet::mark(rule, stride)?);
            self.add_of_parts(Stage::Mark, verlet::count_marked(count, stride)?);
            let search_marked = in_dimension!(model, verlet::search_marked, model, grid, is_guarded, stride);
            self.add(Stage::SearchMarked, search_marked);
            if is_guarded {
                self.add(Stage::SearchMarked, in_dimension!(model, verlet::patch, model, grid, stride));
            }
            self.add_of_parts(Stage::SearchMarked, verlet::longest_rows(stride)?);
        }
        if is_guarded && !model.corrects_current_gradients() {
            self.add(Stage::CorrectedGradients, pairs::weigh(model, stride)?);
            self.add(Stage::CorrectedGradients, in_dimension!(model, pairs::gradients, model, true, stride));
        }
        self.add(Stage::Search, in_dimension!(model, verlet::search, model, grid, stride));
        self.add_of_parts(Stage::Search, verlet::longest_rows(stride)?);
        Ok(())
    }

    /// Lists and gradients in the reference configuration.
    fn sum_in_reference_configuration(&mut self, renewal: Option<f64>) -> Result<(), KernelFault> {
        let (model, stride, references) = (self.model, self.rows.stride, self.references);
        let grid = self.grids.of_kernels;
        if references == References::Renewed {
            if let Some(wrap) = wrap::wrap(model, stride)? {
                self.add(Stage::Renew, wrap);
            }
            self.add(Stage::Renew, reference::renew(model, stride)?);
        }
        self.add_sorting(Stage::CountLists, grid, Sorted::Reference, Threads::OfAllHere)?;
        self.add(Stage::CountLists, in_dimension!(model, reference::count, model, grid, stride));
        self.add(Stage::FillLists, in_dimension!(model, reference::list, model, grid, stride));
        self.add(Stage::FillLists, in_dimension!(model, reference::correct, model, references, stride));
        if model.formulation.is_quadratic_at_faces() {
            self.add(Stage::Gradients, in_dimension!(model, face_sums::sum, model, stride));
            self.add_near_faces(
                Stage::Gradients,
                Threads::OfFaces,
                in_dimension!(model, face_sums::take, model, stride),
            );
        }
        self.add(Stage::Gradients, in_dimension!(model, reference::deform, model, (renewal, references), stride));
        Ok(())
    }

    fn audit(&mut self) -> Result<(), KernelFault> {
        let (model, stride, references) = (self.model, self.rows.stride, self.references);
        if model.audit.is_none() {
            return Ok(());
        }
        let grid = self.grids.of_kernels;
        // From the current positions of the particles.
        self.add_sorting(Stage::Audit, grid, Sorted::Particles, Threads::OfAllHere)?;
        self.add(Stage::Audit, in_dimension!(model, audit::of_lists, model, stride));
        self.add(Stage::Audit, in_dimension!(model, audit::exact, model, grid, references, stride));
        Ok(())
    }

    /// Whether neither walls nor gravity act.
    fn is_alone(&self) -> bool {
        self.model.walls.is_empty() && self.model.gravity == [0.0; 3]
    }

    /// Contact positions, and the particles sorted by them.
    fn contact_positions(&mut self, stage: Stage) -> Result<(), KernelFault> {
        self.add_of_surface(stage, contact::contact_positions(self.references, self.rows.stride)?);
        self.add_sorting(stage, self.grids.of_kernels, Sorted::Surface, Threads::OfSurfaceHere)
    }

    /// Contact, walls and gravity.
    fn push_faces(&mut self) -> Result<(), KernelFault> {
        let (model, stride, references) = (self.model, self.rows.stride, self.references);
        let Grids { of_kernels: grid, of_facets } = self.grids;
        let (meets, has_facets) = (model.has_contact(), model.has_facets());
        if has_facets {
            if model.formulation.is_quadratic_at_faces() {
                let sum = in_dimension!(model, face_sums::sum_evaluated, model, stride);
                self.add_near_faces(Stage::Push, Threads::NearFaces, sum);
            }
            self.add_of_surface(Stage::Push, in_dimension!(model, facets::follow, model, references, stride));
            self.add_of_surface(Stage::Push, in_dimension!(model, shared_edges::shift, model, references, stride));
            self.add_sorting(Stage::Push, of_facets, Sorted::WithFacets, Threads::OfSurfaceHere)?;
            if model.contact.has_friction() {
                let slip = in_dimension!(model, facet_forces::slip, model, of_facets, references, stride);
                self.add_of_surface(Stage::Push, slip);
            }
        } else if meets {
            if model.has_faces() {
                self.contact_positions(Stage::Push)?;
            }
            let overlap = in_dimension!(model, contact::overlap, model, grid, references, stride);
            self.add_of_surface(Stage::Push, overlap);
        }
        if meets || !self.is_alone() {
            self.add(Stage::Push, walls::push(model, references, stride)?);
        }
        self.contact_forces(Stage::Push, None)
    }

    /// Forces of the contact, or those through a section.
    fn contact_forces(&mut self, stage: Stage, through: Option<Through<'_>>) -> Result<(), KernelFault> {
        let (model, stride, references) = (self.model, self.rows.stride, self.references);
        let Grids { of_kernels: grid, of_facets } = self.grids;
        if model.has_facets() {
            let forces = in_dimension!(model, facet_forces::forces, model, of_facets, through, references, stride);
            self.add_of_surface(stage, forces);
            if through.is_some() {
                self.add_of_surface(stage, in_dimension!(model, shared_edges::share, model, through, stride));
            } else {
                self.add_of_surface(stage, in_dimension!(model, shared_edges::pull, model, references, stride));
            }
        } else if model.has_contact() {
            let forces = in_dimension!(model, contact::forces, model, grid, through, references, stride);
            self.add_of_surface(stage, forces);
        }
        Ok(())
    }

    /// The stress of the particles of each material, and data of neighbours that forces read.
    fn stress(&mut self) -> Result<(), KernelFault> {
        let (model, stride, references) = (self.model, self.rows.stride, self.references);
        let rubs = model.has_contact() || model.walls.iter().any(Wall::rubs);
        for k in 0..model.materials.len() {
            let threads = members(self.p, k).len();
            let of_material = |kernel| (threads > 0).then_some(Planned { kernel, threads: Threads::Of(threads) });
            let stress = |of| stress::stress(model, (k, references), stride, of);
            match model.numerics.integrator {
                Integrator::Leapfrog => self.stages.extend(Stage::Stress, of_material(stress(StressOf::Leapfrog)?)),
                Integrator::PredictorCorrector => {
                    self.stages.extend(Stage::Stress, of_material(stress(StressOf::Middle)?));
                    self.stages.extend(Stage::Finish, of_material(stress(StressOf::End)?));
                }
            }
            let is_warmed = model.materials[k].heats() && model.numerics.temperature == TemperatureSource::PlasticWork;
            if is_warmed && rubs {
                self.stages.extend(Stage::Finish, of_material(stress::warm(model, k, stride)?));
            }
        }
        match model.formulation {
            Formulation::UpdatedLagrangian => {
                if model.corrects_current_gradients() {
                    self.add(Stage::Stress, pairs::correct_stress(stride)?);
                }
            }
            Formulation::TotalLagrangian { hourglass, faces, .. } => {
                if model.formulation.is_quadratic_at_faces() {
                    let spread = in_dimension!(model, face_sums::spread_stress, model, stride);
                    self.add_near_faces(Stage::Stress, Threads::OfFaces, spread);
                    let share = in_dimension!(model, face_sums::share, model, stride);
                    self.add_near_faces(Stage::Stress, Threads::NearFaces, share);
                }
                let counted = faces.counted();
                self.add(Stage::Stress, reference_forces::pull_back(model, (hourglass, counted), stride)?);
            }
        }
        Ok(())
    }

    fn forces(&mut self) -> Result<(), KernelFault> {
        let stride = self.rows.stride;
        self.sum_forces(Stage::Forces, None)?;
        if self.model.has_facets() {
            let share = in_dimension!(self.model, shared_edges::share, self.model, None, stride);
            self.add_of_surface(Stage::Forces, share);
        }
        if self.model.has_contact() {
            self.add_of_surface(Stage::Forces, contact::add(stride)?);
        }
        if !self.is_alone() {
            self.add(Stage::Forces, walls::add(stride)?);
        }
        Ok(())
    }

    /// Pair forces, or those through a section.
    fn sum_forces(&mut self, stage: Stage, through: Option<Through<'_>>) -> Result<(), KernelFault> {
        let (model, stride) = (self.model, self.rows.stride);
        match model.formulation {
            Formulation::UpdatedLagrangian => {
                self.add(stage, in_dimension!(model, pair_forces::forces, model, through, stride));
            }
            Formulation::TotalLagrangian { hourglass, .. } => {
                self.add(stage, in_dimension!(model, reference_forces::forces, model, through, stride));
                if hourglass != 0.0 {
                    self.add(stage, in_dimension!(model, reference_forces::springs, model, through, stride));
                }
                if model.numerics.viscosity_of_shocks > 0.0 {
                    self.add(stage, in_dimension!(model, reference_forces::shocks, model, through, stride));
                }
            }
        }
        Ok(())
    }

    /// The force through a section, and its sum.
    fn section(&mut self, through: Through<'_>) -> Result<(), KernelFault> {
        let Rows { stride, partition, .. } = self.rows;
        let stage = Stage::Section(through.number);
        self.sum_forces(stage, Some(through))?;
        self.contact_forces(stage, Some(through))?;
        let force = groups::Section::layout().force;
        let terms = [0, 1, 2].map(|a| sums::Term::from(force.axis(a)));
        let sums = sums::of_columns(Group::Section(through.number), &terms, (partition, 0), stride)?;
        let summed = summed(sums, sums::of_lanes(partition.lanes(), stride)?, (partition, terms.len()));
        self.stages.extend(Stage::SectionSums(through.number), summed);
        Ok(())
    }

    fn ledger(&mut self) -> Result<(), KernelFault> {
        let Rows { stride, partition, .. } = self.rows;
        let (sums, lanes) = ledger::ledger(self.model, self.references, partition, stride)?;
        let count = ledger::LedgerSums::of(self.model).count;
        self.stages.extend(Stage::Ledger, summed(sums, lanes, (partition, count)));
        Ok(())
    }

    fn conduct_heat(&mut self) -> Result<(), KernelFault> {
        let (model, stride) = (self.model, self.rows.stride);
        if !model.thermal.conduction {
            return Ok(());
        }
        if model.has_facets() && model.conducts_across_contact() {
            // In place of the cells of the contact.
            self.contact_positions(Stage::LookForHeat)?;
        }
        for kernel in in_dimension!(model, conduction::surroundings, model, self.grids.of_kernels, stride) {
            self.add(Stage::LookForHeat, kernel);
        }
        for kernel in in_dimension!(model, conduction::sums, model, self.grids.of_kernels, stride) {
            self.add(Stage::SumHeat, kernel);
        }
        self.add(Stage::FlowHeat, conduction::flow(model, stride)?);
        self.add_of_parts(Stage::HeatExtremes, conduction::extremes(self.p.len(), stride)?);
        let passes = reduce::reduce(Group::HeatExtremes, self.parts(), conduction::TOGETHER)?;
        self.stages.extend(Stage::HeatExtremes, reduced(passes));
        Ok(())
    }

    /// Limits of the next step, and changes by this one.
    fn limit_step(&mut self) -> Result<(), KernelFault> {
        let stride = self.rows.stride;
        self.add(Stage::Finish, limits::of_particles(self.model, stride)?);
        self.add_of_parts(Stage::Finish, limits::extremes(stride)?);
        let passes = reduce::reduce(Group::Extremes, self.parts(), limits::together())?;
        self.stages.extend(Stage::Finish, reduced(passes));
        Ok(())
    }

    /// Reduces what stages find in rows of particles about lists and ghosts.
    fn reduce_displacements(&mut self) -> Result<(), KernelFault> {
        let (model, are_shared) = (self.model, self.rows.are_shared);
        if are_shared && model.ghosts_expire() {
            let displacements = verlet::displacements(model, Group::GhostsAt, self.p.len(), self.rows.stride)?;
            self.add_of_parts(Stage::GhostDisplacements, displacements);
        }
        if !(model.keeps_lists() || are_shared) {
            return Ok(());
        }
        let stages = [
            Stage::GhostDisplacements,
            Stage::Displacements,
            Stage::DisplacementsSinceSearch,
            Stage::Mark,
            Stage::Search,
            Stage::SearchMarked,
        ];
        for stage in stages.into_iter().filter(|stage| !self.stages.is_empty(*stage)).collect::<Vec<_>>() {
            let passes = reduce::reduce(Group::Ways, self.parts(), DISPLACEMENT_REDUCTION)?;
            self.stages.extend(stage, reduced(passes));
        }
        Ok(())
    }
}

/// Particles of a material.
pub(super) fn members(p: &Particles, material: usize) -> Vec<u32> {
    (0..p.len() as u32).into_par_iter().filter(|i| p.material[*i as usize] as usize == material).collect()
}
