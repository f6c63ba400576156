//! The facets of bodies that meet there, found in double precision in the initial configuration.

use super::columns::{Group, Handles, groups};
use super::kernels::facets::FACETS;
use super::kernels::grid::Grid;
use super::kernels::limits;
use super::{GpuEngine, failure};
use sphorge_engine::geometry::{Beside, CellFacet, ReferenceFacets};
use sphorge_engine::persist::{Archive, ArchiveError, Persist};
use sphorge_engine::{Model, RunFailure};
use sphorge_physics::tensor::dot;

/// How much wider cells are than facets of two particles reach, so that they need not be made wider in every step.
const SPARE: f64 = 1.25;

/// Least edge of a cell over what facets of two particles reach: they may reach farther after the next step.
const LEAST: f64 = 1.1;

/// Numbers of a facet.
const FACET: usize = <groups::FacetTable<()> as Handles<()>>::LENGTH;

/// Numbers of a row of what is beside cells.
const BESIDE: usize = <groups::BesideTable<()> as Handles<()>>::LENGTH;

/// The facets of a run.
pub(super) struct Facets {
    /// In the initial configuration.
    reference: ReferenceFacets,
    /// Edge of the cells in which particles with facets are sorted, m, unless those of the kernels are wider.
    edge: f64,
}

impl Facets {
    /// Nothing for bodies that do not meet there.
    pub(super) fn of(model: &Model) -> Option<Self> {
        let facets = || Self { reference: ReferenceFacets::new(model), edge: 0.0 };
        model.has_facets().then(facets)
    }
}

/// Numbers of the facets of a particle in the table.
fn numbers(facets: &[CellFacet]) -> Vec<f32> {
    let mut numbers = Vec::with_capacity(FACET * facets.len());
    for (k, CellFacet { side, facet }) in facets.iter().enumerate() {
        let parts_before = facets[..k].iter().rev().take_while(|before| before.side == *side).count();
        numbers.extend(facet.corners.as_flattened());
        numbers.extend(facet.middle.into_iter().chain(facet.normal).chain(facet.curvature.to_array()));
        numbers.extend([facet.depth, f64::from(*side), parts_before as f64]);
        numbers.extend(facet.free);
        numbers.extend(facet.across.as_flattened());
    }
    numbers.into_iter().map(|number: f64| number as f32).collect()
}

/// Numbers of what is beside a cell.
fn numbers_of_beside(beside: &Beside) -> impl Iterator<Item = f32> {
    let ways = (0..beside.facing.len()).flat_map(|side| *beside.ways.on(side));
    ways.chain(beside.facing.map(f64::from)).map(|number| number as f32)
}

impl GpuEngine {
    /// Cells of particles with facets, which reach farther than kernels where bodies are stretched.
    pub(super) fn grid_of_facets(&self) -> Grid {
        let edge = self.facets.as_ref().map_or(0.0, |facets| facets.edge);
        Grid { edge: edge.max(self.grid.edge), ..self.grid.clone() }
    }

    /// Makes cells wider if facets have come to reach farther.
    pub(super) fn widen_cells_of_facets(&mut self) -> Result<(), RunFailure> {
        let reach = 2.0 * self.extremes[limits::REACH];
        if LEAST * reach <= self.grid_of_facets().edge {
            return Ok(());
        }
        self.widen_cells_to(SPARE * reach)
    }

    fn widen_cells_to(&mut self, edge: f64) -> Result<(), RunFailure> {
        let before = self.grid_of_facets().edge;
        let Some(facets) = &mut self.facets else { return Ok(()) };
        facets.edge = edge;
        if self.grid_of_facets().edge != before {
            self.plan = self.plan_of(self.references())?;
        }
        self.rebind()?;
        if edge > self.grid.edge && self.domain.is_some() {
            // Those of other GPUs may reach as far.
            self.choose_ghosts()?;
            self.make_lists_anew()?;
        }
        Ok(())
    }

    /// Finds the facets of the initial configuration.
    pub(super) fn find_facets(&mut self) -> Result<(), RunFailure> {
        let Some(facets) = &self.facets else { return Ok(()) };
        let corners = self.initial.id.iter().flat_map(|id| facets.reference.of(*id)).flat_map(|of| of.facet.corners);
        let farthest = corners.map(|corner| dot(corner, corner)).fold(0.0, f64::max).sqrt();
        let [farthest] = self.largest_of_ranks([farthest])?;
        self.write_facets()?;
        self.widen_cells_to(SPARE * 2.0 * farthest)
    }

    /// Copies the facets of the particles and ghosts of this GPU there, and who has any; kernels are to be bound again.
    pub(super) fn write_facets(&mut self) -> Result<(), RunFailure> {
        let Some(facets) = &self.facets else { return Ok(()) };
        let p = &self.initial;
        let ids = self.with_ghosts(&p.id.iter().map(|id| [f64::from(*id)]).collect::<Vec<_>>())?;
        let stride = self.stride;
        let (mut table, mut of_particles) = (Vec::new(), vec![0u32; FACETS * stride]);
        let (mut have, mut beside) = (Vec::new(), vec![0.0; BESIDE]);
        for (i, [id]) in ids.iter().enumerate() {
            let id = *id as u32;
            let of_particle = facets.reference.of(id);
            of_particles[i] = (table.len() / FACET) as u32;
            table.extend(numbers(of_particle));
            of_particles[stride + i] = (table.len() / FACET) as u32;
            of_particles[2 * stride + i] = id;
            if let Some(of_particle) = facets.reference.beside(id) {
                of_particles[3 * stride + i] = (beside.len() / BESIDE) as u32;
                beside.extend(numbers_of_beside(of_particle));
            }
            if !of_particle.is_empty() {
                have.push(i as u32);
            }
        }
        self.columns.insert(Group::FacetTable, self.card.numbers(&table).map_err(failure)?);
        self.columns.insert(Group::BesideTable, self.card.numbers(&beside).map_err(failure)?);
        self.columns.insert(Group::Facets, self.card.indices(&of_particles).map_err(failure)?);
        // Heat flows between particles that have none, too.
        if !self.model.conducts_across_contact() {
            let own = have.partition_point(|i| (*i as usize) < p.len());
            self.columns.insert(Group::Surface, self.card.indices(&have).map_err(failure)?);
            self.own_surface = have[..own].to_vec();
        }
        Ok(())
    }

    /// Saves or loads how wide cells of facets are.
    pub(super) fn persist_facets(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let Some(facets) = &mut self.facets else { return Ok(()) };
        let before = facets.edge;
        facets.edge.persist("facets.edge", archive)?;
        if archive.is_saving() || before == facets.edge {
            return Ok(());
        }
        let take = |engine: &mut Self| -> Result<(), RunFailure> {
            engine.plan = engine.plan_of(engine.references())?;
            engine.rebind()
        };
        take(self).map_err(|fault| ArchiveError::Unsupported(fault.to_string()))
    }
}
