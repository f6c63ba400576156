//! Forces through sections, summed on the GPU when asked for.

use super::made::Made;
use super::reductions::Launched;
use super::stages::Stage;
use super::{GpuEngine, failure};
use sphorge_engine::RunFailure;
use sphorge_engine::model::{Integrator, Section};

impl GpuEngine {
    /// Whether forces through sections are summed with those of the step: the predictor-corrector leaves the places that they were evaluated at.
    pub(super) fn sums_sections_with_forces(&self) -> bool {
        self.model.numerics.integrator == Integrator::PredictorCorrector
    }

    /// Launches the force of what is ahead of a section of the model on what is behind it, N.
    pub(super) fn launch_section(&self, section: &Section) -> Result<Launched, RunFailure> {
        let number = self.model.sections.iter().position(|of| of == section);
        let number = number.ok_or_else(|| failure(format!("no section `{}`", section.name)))?;
        if !self.sums_sections_with_forces() {
            self.launch(Stage::Section(number))?;
        }
        self.launch_own(Stage::SectionSums(number));
        Ok(Launched { count: self.segments.numbers_of(3), made: Made::Force })
    }
}
