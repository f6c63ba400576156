//! The kernels of the step, compiled and bound to columns.

use super::columns::Group;
use super::kernels::reference::References;
use super::plan::{Grids, Plan, Planned, Rows, Threads};
use super::ranks::Domain;
use super::ranks::touched::Touched;
use super::stages::Staged;
use super::{GpuEngine, failure};
use crate::device::Array;
use sphorge_engine::RunFailure;

impl GpuEngine {
    /// The kernels of the step, compiled.
    pub(super) fn plan_of(&self, references: References) -> Result<Plan, RunFailure> {
        let partition = self.segments.partition();
        let rows = Rows { stride: self.stride, are_shared: self.domain.is_some(), partition };
        let grids = Grids { of_kernels: &self.grid, of_facets: &self.grid_of_facets() };
        let plan = Plan::of(&self.model, &self.initial, rows, grids, references).map_err(failure)?;
        self.card.compile_ahead(&plan.all().map(|recording| &recording.kernel).collect::<Vec<_>>());
        if !self.card.found().is_software {
            // With a software renderer, unneeded kernels cost more than they save.
            self.card.compile_ahead(&plan.reductions.iter().map(|of| &of.kernel.kernel).collect::<Vec<_>>());
        }
        Ok(plan)
    }

    /// Binds the kernels of the step to the current columns, with as many threads as there are rows.
    pub(super) fn rebind(&mut self) -> Result<(), RunFailure> {
        let ghosts = self.domain.as_ref().map_or(0, Domain::ghosts);
        let surface = self.columns.array(Group::Surface).map_or(0, Array::count);
        let [at_faces, near_faces] =
            [Group::FaceParticles, Group::NearParticles].map(|group| self.columns.array(group).map_or(0, Array::count));
        let is_shared = self.domain.is_some();
        let bind = |planned: &Planned| {
            let (threads, runs_over_ghosts) = match planned.threads {
                Threads::Of(count) => (count, false),
                Threads::OfAllHere => (self.initial.len() + ghosts, true),
                // If faces do not follow the deformation, all particles may be in contact.
                Threads::OfSurface if !self.model.has_faces() => (self.initial.len(), false),
                Threads::OfSurface => (self.own_surface.len(), false),
                Threads::OfSurfaceHere => (surface, true),
                Threads::OfFaces => (at_faces, false),
                Threads::NearFaces => (near_faces, false),
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
