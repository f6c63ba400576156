//! Sums over particles that several processes may share, in the order of the particles whoever has them.

use crate::RunFailure;
use crate::ranks::Ranks;
use std::convert::Infallible;

/// Processes that share the particles sums are taken over.
pub trait Turns {
    /// What can go wrong.
    type Lost;
    /// Has every process add its particles to `sums`, one after the other in the order of the particles. All get the sums.
    ///
    /// # Errors
    /// A process is lost.
    fn pass(&self, sums: &mut [f64], add: impl FnOnce(&mut [f64])) -> Result<(), Self::Lost>;
}

/// One process that has all particles.
#[derive(Clone, Copy, Debug)]
pub struct Alone;

impl Turns for Alone {
    type Lost = Infallible;
    fn pass(&self, sums: &mut [f64], add: impl FnOnce(&mut [f64])) -> Result<(), Infallible> {
        add(sums);
        Ok(())
    }
}

impl Turns for Ranks {
    type Lost = RunFailure;
    fn pass(&self, sums: &mut [f64], add: impl FnOnce(&mut [f64])) -> Result<(), RunFailure> {
        self.sum_in_turn(sums, add)
    }
}

/// The best of the numbers of all particles, where `better` says which of two is; none where there is no particle.
///
/// # Errors
/// A process is lost.
pub(super) fn best<R: Turns>(
    turns: &R,
    better: impl Fn(f64, f64) -> f64,
    numbers: impl Iterator<Item = f64>,
) -> Result<Option<f64>, R::Lost> {
    let mut sums = [0.0; 2];
    turns.pass(&mut sums, |sums| {
        for number in numbers {
            sums[1] = if sums[0] > 0.0 { better(sums[1], number) } else { number };
            sums[0] = 1.0;
        }
    })?;
    Ok((sums[0] > 0.0).then_some(sums[1]))
}
