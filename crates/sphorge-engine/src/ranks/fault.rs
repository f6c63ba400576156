//! Faults of a step, and the rank with the worst one.

use super::Ranks;
use crate::RunFailure;
use crate::particles::COLUMNS;
use crate::persist::Fixed;
use sphorge_physics::flow::FLOW_LAWS;

/// A failure of a step, and how it compares with those of other ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct StepFault {
    pub(crate) failure: RunFailure,
    /// Change over the allowed change; nothing if a value is wrong.
    changed: Option<f64>,
}

impl StepFault {
    /// A value that is wrong.
    pub fn wrong(failure: RunFailure) -> Self {
        Self { failure, changed: None }
    }

    /// A change that is larger than allowed, by this factor.
    pub(crate) fn changed(failure: RunFailure, ratio: f64) -> Self {
        Self { failure, changed: Some(ratio) }
    }

    /// What it is.
    pub fn into_failure(self) -> RunFailure {
        self.failure
    }

    /// A wrong value is worse than a change that is too large; a larger change is worse than a smaller one. Of equals
    /// the first rank has it.
    fn severity(&self) -> (u8, f64) {
        self.changed.map_or((2, 0.0), |ratio| (1, ratio))
    }
}

impl Ranks {
    /// Fails on all ranks if one has a fault, with the worst one.
    ///
    /// # Errors
    /// There is one, or a rank is lost.
    pub fn fail_together(&self, own: Option<StepFault>) -> Result<(), RunFailure> {
        let faults = self.gather_one::<(u8, f64)>(own.as_ref().map_or((0, 0.0), StepFault::severity))?;
        let mut worst: Option<(usize, (u8, f64))> = None;
        for (rank, fault) in faults.into_iter().enumerate().filter(|(_, fault)| fault.0 > 0) {
            let is_worse =
                |(_, other): (usize, (u8, f64))| fault.0 > other.0 || fault.0 == other.0 && fault.1 > other.1;
            if worst.is_none_or(is_worse) {
                worst = Some((rank, fault));
            }
        }
        let Some((rank, _)) = worst else { return Ok(()) };
        let bytes = own.map_or_else(Vec::new, |fault| failure_bytes(&fault.failure));
        let bytes = self.broadcast_from(rank, &bytes)?;
        Err(failure_of(&bytes).unwrap_or_else(|| RunFailure::of_engine(format!("rank {rank} has failed"))))
    }
}

/// A failure of a particle as bytes.
fn failure_bytes(failure: &RunFailure) -> Vec<u8> {
    let mut bytes = Vec::new();
    failure.particle.write(&mut bytes);
    failure.body.write(&mut bytes);
    failure.position.write(&mut bytes);
    failure.step_may_be_smaller.write(&mut bytes);
    failure.field.len().write(&mut bytes);
    bytes.extend_from_slice(failure.field.as_bytes());
    bytes.extend_from_slice(failure.message.as_bytes());
    bytes
}

fn failure_of(bytes: &[u8]) -> Option<RunFailure> {
    let mut at = 0;
    let mut take = |length: usize| {
        at += length;
        bytes.get(at - length..at)
    };
    let particle = Fixed::read(take(<Option<u32>>::SIZE)?)?;
    let body = Fixed::read(take(<Option<u32>>::SIZE)?)?;
    let position = Fixed::read(take(<Option<[f64; 3]>>::SIZE)?)?;
    let step_may_be_smaller = Fixed::read(take(bool::SIZE)?)?;
    let length = usize::read(take(usize::SIZE)?)?;
    let name = std::str::from_utf8(take(length)?).ok()?;
    let message = std::str::from_utf8(bytes.get(at..)?).ok()?.to_owned();
    let histories = FLOW_LAWS.iter().flat_map(|law| law.history).map(|variable| variable.name);
    let others = ["acceleration", ""];
    let field = COLUMNS.iter().map(|column| column.name).chain(histories).chain(others).find(|known| *known == name)?;
    Some(RunFailure { field, particle, body, position, step_may_be_smaller, ..RunFailure::of_engine(message) })
}
