//! What a program has given to a run so far.

use crate::{
    engine::{
        Drive,
        persist::{Archive, ArchiveError, Persist, require},
    },
    model::Model,
    output::DrivenRecord,
};

/// Bodies that had a load, and motions that had a velocity of a program, at any step so far.
pub(super) struct DrivenParts {
    loads: Vec<bool>,
    motions: Vec<bool>,
}

impl DrivenParts {
    /// Of a run that nothing has been given to.
    pub(super) fn new(model: &Model) -> Self {
        Self { loads: vec![false; model.bodies.len()], motions: vec![false; model.motions.len()] }
    }

    pub(super) fn is_driven(&self) -> bool {
        self.loads.iter().chain(&self.motions).any(|is| *is)
    }

    pub(super) fn take(&mut self, drive: &Drive) {
        let loads = self.loads.iter_mut().zip(drive.forces.iter().map(Option::is_some));
        let motions = self.motions.iter_mut().zip(drive.velocities.iter().map(Option::is_some));
        loads.chain(motions).for_each(|(known, given)| *known |= given);
    }

    /// For the summary; none if nothing was given.
    pub(super) fn record(&self, model: &Model) -> Option<DrivenRecord> {
        let loaded = model.bodies.iter().zip(&self.loads).filter(|(_, is)| **is);
        let moved = model.motions.iter().zip(&self.motions).filter(|(_, is)| **is);
        self.is_driven().then(|| DrivenRecord {
            loads: loaded.map(|(body, _)| body.name.clone()).collect(),
            motions: moved.map(|(motion, _)| model.regions[motion.region].name.clone()).collect(),
        })
    }
}

impl Persist for DrivenParts {
    /// Saved where there is something, so that the saved states of other runs stay as they are.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let counts = (self.loads.len(), self.motions.len());
        if archive.is_saving() && !self.is_driven() {
            return Ok(());
        }
        match self.loads.persist(&format!("{name}.loads"), archive) {
            Err(ArchiveError::Missing(_)) if !archive.is_saving() => {
                self.loads = vec![false; counts.0];
                self.motions = vec![false; counts.1];
                return Ok(());
            }
            other => other?,
        }
        self.motions.persist(&format!("{name}.motions"), archive)?;
        require((self.loads.len(), self.motions.len()) == counts, name)
    }
}
