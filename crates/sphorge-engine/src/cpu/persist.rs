//! What a run must survive with: everything the steps to come depend on.

use super::CpuEngine;
use crate::lanes::PairScalar;
use crate::persist::{Archive, ArchiveError, Persist};

impl<T: PairScalar> CpuEngine<T> {
    /// Saves or loads the state of the engine. Motions, records and scratch follow from it in the next step.
    pub(super) fn persist_all(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.particles.persist("particles", archive)?;
        self.ghosts.halo.persist("halo", archive)?;
        self.walls.persist("walls", archive)?;
        self.external.persist("external", archive)?;
        self.step.persist("step", archive)?;
        self.reference_corrected.persist("reference_corrected", archive)?;
        if let Some(contacts) = &mut self.contacts {
            contacts.persist("contacts", archive)?;
        }
        if let Some(heat) = &mut self.heat {
            heat.persist("heat", archive)?;
        }
        self.records.frame.persist("frame", archive)?;
        self.constants.unit = T::of(self.records.frame.unit);
        self.lists.persist("lists", archive)
    }
}
