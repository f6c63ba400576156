//! Energy that viscosity, artificial stress and hourglass springs have converted to internal energy.
//!
//! The powers of pairs are parts of the energy rate of the particles and are integrated like it: those of the last
//! force sum over the time of a kick. The bulk viscosity is a pressure of the particle; its power follows from the
//! deformation of a step and counts for that step. Works are kept per block of particles and added up on request, so
//! the sum depends on neither threads nor ranks, and no step waits for it.

use super::domain::Domain;
use crate::RunFailure;
use crate::neighbors::BLOCK;
use crate::persist::{Archive, ArchiveError, Persist, persist_pieces};

/// The work of one numerical force, block by block.
#[derive(Clone, Debug, Default)]
pub(super) struct WorkSum {
    /// Power at the last force sum, W.
    pub(super) power: Vec<f64>,
    /// Work since the start, J.
    pub(super) work: Vec<f64>,
}

impl WorkSum {
    fn new(count: usize) -> Self {
        let zero = vec![0.0; count.div_ceil(BLOCK)];
        Self { power: zero.clone(), work: zero }
    }

    fn book(&mut self, dt: f64) {
        for (work, power) in self.work.iter_mut().zip(&self.power) {
            *work += dt * power;
        }
    }

    /// Work on the particles of all ranks since the start, J.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn total(&self, domain: Option<&Domain>) -> Result<f64, RunFailure> {
        let all = domain.map(|domain| domain.gather_blocks(&self.work, 1)).transpose()?;
        Ok(all.as_ref().unwrap_or(&self.work).iter().fold(0.0, |sum, work| sum + work))
    }
}

/// Works of all such forces.
#[derive(Clone, Debug, Default)]
pub(super) struct NumericalWork {
    /// Of the hourglass springs.
    pub(super) hourglass: WorkSum,
    /// Of the viscosity, of pairs or of single particles.
    pub(super) viscous: WorkSum,
    /// Of the artificial stress.
    pub(super) artificial_stress: WorkSum,
}

impl NumericalWork {
    /// For that many particles.
    pub(super) fn new(count: usize) -> Self {
        let of = || WorkSum::new(count);
        Self { hourglass: of(), viscous: of(), artificial_stress: of() }
    }

    /// Adds the last powers times `dt`, s, to the works.
    pub(super) fn book(&mut self, dt: f64) {
        for work in [&mut self.hourglass, &mut self.viscous, &mut self.artificial_stress] {
            work.book(dt);
        }
    }
}

impl Persist for WorkSum {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        persist_pieces(&mut self.power, &format!("{name}.power"), archive)?;
        persist_pieces(&mut self.work, &format!("{name}.work"), archive)
    }
}

crate::persist_fields!(NumericalWork { hourglass, viscous, artificial_stress });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_the_last_sum_work_over_the_time_that_is_booked() {
        let mut works = NumericalWork::new(2 * BLOCK + 1);
        assert_eq!(works.viscous.power.len(), 3);
        let totals = |works: &NumericalWork| {
            [&works.viscous, &works.hourglass, &works.artificial_stress].map(|work| work.total(None).unwrap())
        };
        works.viscous.power.copy_from_slice(&[1.0, 2.0, 4.0]);
        works.hourglass.power.copy_from_slice(&[0.5, -2.5, 0.0]);
        works.artificial_stress.power.copy_from_slice(&[0.0, 0.0, -4.0]);
        works.book(0.5);
        works.book(0.25);
        assert_eq!(totals(&works), [5.25, -1.5, -3.0]);
        works.viscous.power.fill(1.0);
        works.book(2.0);
        assert_eq!(totals(&works), [11.25, -5.5, -11.0]);
    }
}
