//! A GPU as one of several that share the particles of a run.

use crate::engine::supports::supports_in_parts;
use crate::engine::{Gpu, GpuEngine};
use sphorge_engine::ranks::Communicator;
use sphorge_engine::{
    Column, Engine, FieldSource, Model, Part, PartKind, Particles, Reduction, RunFailure, Unsupported,
};
use std::sync::Arc;

impl PartKind for Gpu {
    fn shared_name(&self) -> &'static str {
        "gpu-ranks"
    }

    fn supports_in_parts(&self, model: &Model) -> Result<(), Unsupported> {
        supports_in_parts(model)
    }

    fn start_part(
        &self,
        model: Arc<Model>,
        particles: Particles,
        communicator: Arc<dyn Communicator>,
    ) -> Result<Box<dyn Part>, RunFailure> {
        Ok(Box::new(GpuEngine::new(model, particles, self, Some(communicator))?))
    }
}

impl Part for GpuEngine {
    fn collect(&self, field: &str) -> Result<Column<'static>, RunFailure> {
        let own = self.own_column(field)?;
        match &self.domain {
            Some(domain) => domain.ranks.collect(own, &domain.counts()),
            None => Ok(own.into_owned()),
        }
    }

    fn section_force(&self, section: usize) -> Result<Vec<f64>, RunFailure> {
        let section = self.model.sections.get(section);
        section.map_or(Ok(Vec::new()), |section| self.reduce(&Reduction::SectionForce(section)))
    }

    fn complete(&mut self) -> Result<(), RunFailure> {
        self.complete_state()
    }

    fn total(&self) -> usize {
        self.total_count()
    }

    fn own(&self) -> &dyn FieldSource {
        self
    }
}

/// The particles of this rank, in their common order.
impl FieldSource for GpuEngine {
    fn count(&self) -> usize {
        self.initial.len()
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.own_column(field)
    }
}

impl GpuEngine {
    /// A field of the particles of this GPU, in their common order.
    pub(in crate::engine) fn own_column(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.field(field)
    }
}
