//! Collective operations of the ranks: sums in the common order of the particles, extremes, and failures.

use super::Domain;
use crate::engine::GpuEngine;
use sphorge_engine::RunFailure;
use sphorge_engine::persist::Fixed;
use sphorge_engine::ranks::{Ranks, StepFault};
use sphorge_engine::reduction::{Alone, Turns};

/// The result of this rank, if all ranks have succeeded.
///
/// # Errors
/// The failure of the first rank that has failed, on all of them.
pub(in crate::engine) fn made_on_all<T>(ranks: &Ranks, own: Result<T, RunFailure>) -> Result<T, RunFailure> {
    let told = own.as_ref().map(|_| ()).map_err(|failure| failure.message.clone());
    ranks.first_failure(told)?.map_err(RunFailure::of_engine)?;
    own
}

/// Who adds to sums, one after the other in the common order of the particles.
#[derive(Clone, Copy)]
pub(in crate::engine) enum Order<'a> {
    /// This process has all particles.
    Alone,
    Ranks(&'a Ranks),
}

impl Turns for Order<'_> {
    type Lost = RunFailure;
    fn pass(&self, sums: &mut [f64], add: impl FnOnce(&mut [f64])) -> Result<(), RunFailure> {
        match self {
            Self::Alone => {
                let Ok(()) = Alone.pass(sums, add);
                Ok(())
            }
            Self::Ranks(ranks) => ranks.pass(sums, add),
        }
    }
}

impl GpuEngine {
    fn ranks(&self) -> Option<&Ranks> {
        self.domain.as_ref().map(|domain: &Domain| &domain.ranks)
    }

    /// The processes that add to sums.
    pub(in crate::engine) fn order(&self) -> Order<'_> {
        self.ranks().map_or(Order::Alone, Order::Ranks)
    }

    /// Lets each rank add its particles to sums, in their common order.
    pub(in crate::engine) fn reduce_in_order(
        &self,
        sums: &mut [f64],
        add: impl FnOnce(&mut [f64]),
    ) -> Result<(), RunFailure> {
        self.order().pass(sums, add)
    }

    /// The sum of numbers over the particles of all ranks; those of this rank are given.
    pub(in crate::engine) fn sum_in_order(&self, own: impl Iterator<Item = f64>) -> Result<f64, RunFailure> {
        let mut sum = [0.0];
        self.reduce_in_order(&mut sum, |sum| own.for_each(|number| sum[0] += number))?;
        Ok(sum[0])
    }

    /// The maximum of each of several numbers over all ranks.
    pub(in crate::engine) fn largest_of_ranks<const N: usize>(&self, own: [f64; N]) -> Result<[f64; N], RunFailure> {
        let Some(ranks) = self.ranks() else { return Ok(own) };
        let all = ranks.gather_one(own)?;
        Ok(all.into_iter().fold(own, |a, b| core::array::from_fn(|k| a[k].max(b[k]))))
    }

    /// Whether each of several conditions holds on any rank.
    pub(in crate::engine) fn on_any_rank(&self, own: &[bool]) -> Result<Vec<bool>, RunFailure> {
        let Some(ranks) = self.ranks() else { return Ok(own.to_vec()) };
        let all = ranks.gather(own, &vec![own.len(); ranks.size()])?;
        Ok((0..own.len()).map(|k| all.iter().skip(k).step_by(own.len()).any(|is| *is)).collect())
    }

    /// Particles of all ranks.
    pub(in crate::engine) fn total_count(&self) -> usize {
        self.domain.as_ref().map_or(self.initial.len(), Domain::total)
    }

    /// Indices of the particles of this GPU in the common order.
    pub(in crate::engine) fn own_places(&self) -> std::ops::Range<usize> {
        self.domain.as_ref().map_or(0..self.initial.len(), Domain::own)
    }

    /// Values of the particles of all ranks, in their common order.
    pub(in crate::engine) fn of_all_ranks<V: Fixed + Copy>(&self, own: &[V]) -> Result<Vec<V>, RunFailure> {
        self.domain.as_ref().map_or_else(|| Ok(own.to_vec()), |domain| domain.ranks.gather(own, &domain.counts()))
    }

    /// Values of all ranks, with any number on each, in the order of the ranks.
    pub(in crate::engine) fn joined_of_ranks<V: Fixed + Copy>(&self, own: &[V]) -> Result<Vec<V>, RunFailure> {
        self.ranks().map_or_else(|| Ok(own.to_vec()), |ranks| ranks.gather_all(own))
    }

    /// Fails on all ranks if one has a fault.
    pub(in crate::engine) fn fail_together(&self, own: Option<StepFault>) -> Result<(), RunFailure> {
        match self.ranks() {
            Some(ranks) => ranks.fail_together(own),
            None => own.map_or(Ok(()), |fault| Err(fault.into_failure())),
        }
    }
}
