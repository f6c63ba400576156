//! The kernels of the step of a model.

use super::columns::{Group, Recording};
use super::kernels::reference::References;
use super::kernels::section::Through;
use super::kernels::stress::StressOf;
use super::kernels::sums::Portions;
use super::kernels::{
    audit, conduction, contact, facets, grid, kept, leapfrog, ledger, limits, moving_least_squares, pairs,
    predictor_corrector, reduce, reductions, reference, reference_forces, smoothing, stress, sums, walls, wrap,
};
use super::ranks::wears_out;
use super::search::WAYS_TOGETHER;
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
    /// One per particle and ghost on this card.
    OfAllHere,
    /// One per surface particle, whose number is known when lists are built; and with ghosts among them.
    OfSurface,
    OfSurfaceHere,
}

/// Length of the columns, and whether they contain ghosts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows {
    pub(super) stride: usize,
    pub(super) are_shared: bool,
    /// The partition of sums.
    pub(super) portions: Portions,
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
fn summed(kernels: Vec<Recording>, of_lanes: Recording, (portions, sums): (Portions, usize)) -> Vec<Planned> {
    let of_segments = |kernel| Planned { kernel, threads: Threads::Of(portions.segments * portions.lanes()) };
    let last = Planned { kernel: of_lanes, threads: Threads::Of(portions.segments * sums) };
    kernels.into_iter().map(of_segments).chain([last]).collect()
}

/// Every kernel of a run, in groups that are launched together.
#[derive(Default)]
pub(super) struct Plan {
    /// For renewed references: the new ones.
    pub(super) renew: Vec<Planned>,
    /// With lists of the reference configuration: before their lengths are known, and after memory is allocated for
    /// them.
    pub(super) count_lists: Vec<Planned>,
    pub(super) fill_lists: Vec<Planned>,
    /// For shared particles: how far they have moved since ghosts were chosen.
    pub(super) ghost_ways: Vec<Planned>,
    pub(super) begin: Vec<Planned>,
    /// Smoothing lengths that follow the density.
    pub(super) follow: Vec<Planned>,
    /// Before a search: wrapping of positions along periodic axes.
    pub(super) wrap: Vec<Planned>,
    pub(super) sorting: Vec<Planned>,
    /// With stored lists: how far particles have moved, and the search.
    pub(super) ways: Vec<Planned>,
    /// In adaptive search along periodic axes: how far particles have moved since the last full search.
    pub(super) strayed: Vec<Planned>,
    pub(super) search: Vec<Planned>,
    /// In adaptive search: the particles to be searched, and their search.
    pub(super) mark: Vec<Planned>,
    pub(super) search_marked: Vec<Planned>,
    /// Audit of the lists.
    pub(super) audit: Vec<Planned>,
    pub(super) gradients: Vec<Planned>,
    /// The same with the corrections of the strain that the guard of adaptive search counts.
    pub(super) corrected_gradients: Vec<Planned>,
    /// For forces evaluated at other positions than gradients, which are corrected.
    pub(super) correct: Vec<Planned>,
    /// Moving least squares.
    pub(super) restore: Vec<Planned>,
    pub(super) push: Vec<Planned>,
    pub(super) stress: Vec<Planned>,
    pub(super) forces: Vec<Planned>,
    pub(super) finish: Vec<Planned>,
    /// The force through each section.
    pub(super) sections: Vec<Vec<Planned>>,
    /// The sum of each over all particles.
    pub(super) section_sums: Vec<Vec<Planned>>,
    /// Heat conduction: its sums if they are due, the exchange, and the extremes of both.
    pub(super) sum_heat: Vec<Planned>,
    pub(super) flow_heat: Vec<Planned>,
    pub(super) heat_extremes: Vec<Planned>,
    /// The sums of the ledger.
    pub(super) ledger: Vec<Planned>,
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
        let Grids { of_kernels: grid, of_facets } = grids;
        let (all, all_here) = (Threads::Of(p.len()), Threads::OfAllHere);
        let Rows { stride, portions, .. } = rows;
        let parts = reduce::rows(stride);
        let of_parts = |kernel| Planned { kernel, threads: Threads::Of(parts) };
        let of_particles = |kernel| Planned { kernel, threads: all };
        let of_surface = |kernel| Planned { kernel, threads: Threads::OfSurface };
        let mut plan = Self::default();
        let (begin, finish) = match model.numerics.integrator {
            Integrator::Leapfrog => (leapfrog::begin(model, stride)?, leapfrog::finish(model, stride)?),
            Integrator::PredictorCorrector => {
                (predictor_corrector::predict(model, stride)?, predictor_corrector::correct(model, stride)?)
            }
        };
        plan.begin.push(of_particles(begin));
        match model.formulation {
            Formulation::UpdatedLagrangian => {
                plan.follow.extend(smoothing::follow(model, stride)?.map(of_particles));
                plan.wrap.extend(wrap::wrap(model, stride)?.map(of_particles));
                plan.sorting = sorting(grid, rows, Sorted::Particles, all_here)?;
                if keeps_lists(model) {
                    let rule = kept::adaptive(model);
                    let is_guarded = rule.is_some_and(|rule| rule.guard.is_some());
                    let since = if is_guarded { Group::FoundAt } else { Group::SearchedAt };
                    if model.search != Search::EveryStep {
                        plan.ways.push(of_parts(kept::ways(model, since, p.len(), stride)?));
                    }
                    if rule.is_some() && model.periodic.iter().any(Option::is_some) {
                        plan.strayed.push(of_parts(kept::ways(model, Group::SearchedAt, p.len(), stride)?));
                    }
                    if let Some(rule) = rule {
                        plan.mark.push(of_particles(kept::mark(rule, stride)?));
                        plan.mark.push(of_parts(kept::count_marked(p.len(), stride)?));
                        let marked = &mut plan.search_marked;
                        marked.push(of_particles(in_dimension!(
                            model,
                            kept::search_marked,
                            model,
                            grid,
                            is_guarded,
                            stride
                        )));
                        if is_guarded {
                            marked.push(of_particles(in_dimension!(model, kept::patch, model, grid, stride)));
                        }
                        marked.push(of_parts(kept::longest_rows(stride)?));
                    }
                    if is_guarded && !pairs::is_corrected(model) {
                        let due = &mut plan.corrected_gradients;
                        due.push(of_particles(pairs::weigh(model, stride)?));
                        due.push(of_particles(in_dimension!(model, pairs::gradients, model, true, stride)));
                    }
                    plan.search.push(of_particles(in_dimension!(model, kept::search, model, grid, stride)));
                    plan.search.push(of_parts(kept::longest_rows(stride)?));
                }
                plan.gradients.push(of_particles(pairs::weigh(model, stride)?));
                plan.gradients.push(of_particles(in_dimension!(model, pairs::gradients, model, false, stride)));
                if pairs::is_corrected(model) && model.numerics.integrator == Integrator::Leapfrog {
                    plan.correct.push(of_particles(in_dimension!(model, pairs::correct, model, stride)));
                }
                if model.numerics.mls_interval.is_some() {
                    let estimate = in_dimension!(model, moving_least_squares::estimate, model, stride);
                    plan.restore.push(of_particles(estimate));
                    plan.restore.push(of_particles(moving_least_squares::restore(model, stride)?));
                }
            }
            Formulation::TotalLagrangian { renewal, .. } => {
                if references == References::Renewed {
                    plan.renew.extend(wrap::wrap(model, stride)?.map(of_particles));
                    plan.renew.push(of_particles(reference::renew(model, stride)?));
                }
                plan.count_lists = sorting(grid, rows, Sorted::Reference, all_here)?;
                plan.count_lists.push(of_particles(in_dimension!(model, reference::count, model, grid, stride)));
                plan.fill_lists.push(of_particles(in_dimension!(model, reference::list, model, grid, stride)));
                plan.fill_lists.push(of_particles(in_dimension!(model, reference::correct, model, references, stride)));
                let renewal = (renewal, references);
                plan.gradients.push(of_particles(in_dimension!(model, reference::deform, model, renewal, stride)));
            }
        }
        if model.audit.is_some() {
            // From the current positions of the particles.
            plan.audit = sorting(grid, rows, Sorted::Particles, all_here)?;
            plan.audit.push(of_particles(in_dimension!(model, audit::of_lists, model, stride)));
            plan.audit.push(of_particles(in_dimension!(model, audit::exact, model, grid, references, stride)));
        }
        let is_alone = model.walls.is_empty() && model.gravity == [0.0; 3];
        let meets = contact::meets(model);
        let has_facets = model.has_facets();
        let of_contact_positions = || -> Result<Vec<Planned>, KernelFault> {
            let mut planned = vec![of_surface(contact::stand(references, stride)?)];
            planned.extend(sorting(grid, rows, Sorted::Surface, Threads::OfSurfaceHere)?);
            Ok(planned)
        };
        if has_facets {
            let follow = in_dimension!(model, facets::follow, model, references, stride);
            plan.push.push(of_surface(follow));
            plan.push.extend(sorting(of_facets, rows, Sorted::WithFacets, Threads::OfSurfaceHere)?);
            if model.contact.has_friction() {
                let slip = in_dimension!(model, facets::slip, model, of_facets, references, stride);
                plan.push.push(of_surface(slip));
            }
        } else if meets {
            if model.has_faces() {
                plan.push.extend(of_contact_positions()?);
            }
            plan.push.push(of_surface(in_dimension!(model, contact::overlap, model, grid, references, stride)));
        }
        if meets || !is_alone {
            plan.push.push(of_particles(walls::push(model, references, stride)?));
        }
        if has_facets {
            let press = in_dimension!(model, facets::press, model, of_facets, None, references, stride);
            plan.push.push(of_surface(press));
        } else if meets {
            plan.push.push(of_surface(in_dimension!(model, contact::press, model, grid, None, references, stride)));
        }
        for k in 0..model.materials.len() {
            let threads = members(p, k).len();
            let of_material = |kernel| (threads > 0).then_some(Planned { kernel, threads: Threads::Of(threads) });
            let stress = |of| stress::stress(model, (k, references), stride, of);
            match model.numerics.integrator {
                Integrator::Leapfrog => plan.stress.extend(of_material(stress(StressOf::Leapfrog)?)),
                Integrator::PredictorCorrector => {
                    plan.stress.extend(of_material(stress(StressOf::Middle)?));
                    plan.finish.extend(of_material(stress(StressOf::End)?));
                }
            }
            let is_warmed = model.materials[k].heats() && model.numerics.temperature == TemperatureSource::PlasticWork;
            if is_warmed && (meets || model.walls.iter().any(Wall::rubs)) {
                plan.finish.extend(of_material(stress::warm(model, k, stride)?));
            }
        }
        match model.formulation {
            Formulation::UpdatedLagrangian => {
                if pairs::is_corrected(model) {
                    plan.stress.push(of_particles(pairs::correct_stress(stride)?));
                }
                plan.forces.push(of_particles(in_dimension!(model, pairs::forces, model, None, stride)));
            }
            Formulation::TotalLagrangian { hourglass, .. } => {
                plan.stress.push(of_particles(reference_forces::pull_back(model, hourglass, stride)?));
                plan.forces.push(of_particles(in_dimension!(model, reference_forces::forces, model, None, stride)));
                if hourglass != 0.0 {
                    plan.forces.push(of_particles(in_dimension!(
                        model,
                        reference_forces::springs,
                        model,
                        None,
                        stride
                    )));
                }
            }
        }
        if meets {
            plan.forces.push(of_surface(contact::add(stride)?));
        }
        if !is_alone {
            plan.forces.push(of_particles(walls::add(stride)?));
        }
        for (number, section) in model.sections.iter().enumerate() {
            let through = Some(Through { number, section });
            let mut kernels = Vec::new();
            match model.formulation {
                Formulation::UpdatedLagrangian => {
                    kernels.push(of_particles(in_dimension!(model, pairs::forces, model, through, stride)));
                }
                Formulation::TotalLagrangian { hourglass, .. } => {
                    let forces = in_dimension!(model, reference_forces::forces, model, through, stride);
                    kernels.push(of_particles(forces));
                    if hourglass != 0.0 {
                        let springs = in_dimension!(model, reference_forces::springs, model, through, stride);
                        kernels.push(of_particles(springs));
                    }
                }
            }
            if has_facets {
                let through = in_dimension!(model, facets::press, model, of_facets, through, references, stride);
                kernels.push(of_surface(through));
            } else if meets {
                kernels.push(of_surface(in_dimension!(
                    model,
                    contact::press,
                    model,
                    grid,
                    through,
                    references,
                    stride
                )));
            }
            plan.sections.push(kernels);
            let terms = [0, 1, 2].map(|column| sums::Term { column, rest: None });
            let sums = sums::of_columns(Group::Section(number), &terms, (portions, 0), stride)?;
            plan.section_sums.push(summed(sums, sums::of_lanes(portions.lanes(), stride)?, (portions, terms.len())));
        }
        let (sums, lanes) = ledger::ledger(model, references, portions, stride)?;
        let reductions = reductions::of_deck(model, references, (portions, stride))?;
        plan.reductions = reductions.into_iter().map(|kernel| Planned { kernel, threads: all }).collect();
        plan.ledger = summed(sums, lanes, (portions, ledger::LedgerSums::of(model).count));
        if model.thermal.conduction {
            if has_facets && conduction::meets_others(model) {
                // In place of the cells of the contact.
                plan.sum_heat.extend(of_contact_positions()?);
            }
            let sums = in_dimension!(model, conduction::sums, model, grid, stride);
            plan.sum_heat.extend(sums.into_iter().map(of_particles));
            plan.flow_heat.push(of_particles(conduction::flow(model, stride)?));
            plan.heat_extremes.push(of_parts(conduction::extremes(p.len(), stride)?));
            plan.heat_extremes.extend(reduced(reduce::reduce(Group::HeatExtremes, parts, conduction::TOGETHER)?));
        }
        plan.finish.insert(0, of_particles(finish));
        plan.finish.push(of_particles(limits::of_particles(model, stride)?));
        plan.finish.push(of_parts(limits::extremes(stride)?));
        plan.finish.extend(reduced(reduce::reduce(Group::Extremes, parts, limits::together())?));
        if rows.are_shared && wears_out(model) {
            plan.ghost_ways.push(of_parts(kept::ways(model, Group::GhostsAt, p.len(), stride)?));
        }
        if keeps_lists(model) || rows.are_shared {
            let Self { ghost_ways, ways, strayed, mark, search, search_marked, .. } = &mut plan;
            for stage in [ghost_ways, ways, strayed, mark, search, search_marked] {
                if !stage.is_empty() {
                    stage.extend(reduced(reduce::reduce(Group::Ways, parts, WAYS_TOGETHER)?));
                }
            }
        }
        Ok(plan)
    }

    /// All of them but reductions, in the order of a run.
    pub(super) fn all(&self) -> impl Iterator<Item = &Recording> {
        let groups = [
            &self.renew,
            &self.count_lists,
            &self.fill_lists,
            &self.ghost_ways,
            &self.begin,
            &self.follow,
            &self.wrap,
            &self.sorting,
            &self.ways,
            &self.strayed,
            &self.search,
            &self.mark,
            &self.search_marked,
            &self.audit,
            &self.gradients,
            &self.corrected_gradients,
            &self.restore,
            &self.correct,
            &self.push,
            &self.stress,
            &self.forces,
            &self.finish,
            &self.sum_heat,
            &self.flow_heat,
            &self.heat_extremes,
            &self.ledger,
        ];
        groups.into_iter().chain(&self.sections).chain(&self.section_sums).flatten().map(|planned| &planned.kernel)
    }
}

/// Whether sums use lists of the current configuration, which are kept from one search to the next, so that two sums
/// share one search.
pub(super) fn keeps_lists(model: &Model) -> bool {
    model.formulation == Formulation::UpdatedLagrangian
}

/// Particles of a material.
pub(super) fn members(p: &Particles, material: usize) -> Vec<u32> {
    (0..p.len() as u32).into_par_iter().filter(|i| p.material[*i as usize] as usize == material).collect()
}
