//! What a run must survive with: everything the steps to come depend on.

use super::CpuEngine;
use crate::engine::Part;
use crate::halo::FieldSet;
use crate::lanes::PairScalar;
use crate::particles::Owner;
use crate::persist::{Archive, ArchiveError, Persist, require};

impl<T: PairScalar> CpuEngine<T> {
    /// Saves or loads the state of the engine:
    ///
    /// - columns of the particles in their present order, with rates, base values and the marks of searches;
    /// - who the ghosts are; their columns follow;
    /// - where walls stand; what prescribed motions are is in their tables and the time;
    /// - work, impulse, energy of density restorations, steps begun, pairs;
    /// - which bodies have come apart;
    /// - contacts: pairs, powers and works; heat: the last flow, its age, its accounts and limits;
    /// - lists with their kept distances, the displacement bounds and positions that say when they are renewed, who is among strangers,
    ///   and the order of the cells, which is that of the rows;
    /// - the frame of the records. Records and scratch are made anew in every step.
    pub(super) fn persist_all(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.has_come_apart.persist("has_come_apart", archive)?;
        require(self.has_come_apart.len() == self.model.bodies.len(), "has_come_apart")?;
        if self.has_come_apart.contains(&true) {
            // Its columns are there from the first renewal on.
            self.particles.allocate(Owner::Renewal);
        } else {
            self.particles.release(Owner::Renewal);
        }
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
        self.lists.persist("lists", archive)?;
        if !archive.is_saving() {
            self.check_places("particles", "halo")?;
            if let Some(search) = self.contacts.as_mut().and_then(|contacts| contacts.search.as_mut()) {
                search.complete(&self.particles, "contacts.search")?;
            }
            self.check_lists("lists")?;
            if self.domain.is_none() {
                // Ghosts take what does not change between searches with each search, and the next one may be far.
                self.ghosts.exchange(FieldSet::Search, &self.particles);
            }
        }
        Ok(())
    }

    /// Refuses particles that were loaded and say of themselves what there is not.
    fn check_places(&self, particles: &str, halo: &str) -> Result<(), ArchiveError> {
        let (model, p) = (&*self.model, &self.particles);
        let below = |column: &[u32], end: usize, name: &str| {
            require(column.iter().all(|&k| (k as usize) < end), &format!("{particles}.{name}"))
        };
        below(&p.body, model.bodies.len(), "body")?;
        below(&p.material, model.materials.len(), "material")?;
        below(&p.motion, model.motions.len() + 1, "motion")?;
        let total = self.total();
        below(&p.id, total, "id")?;
        let mut seen = vec![false; total];
        p.id.iter().for_each(|&id| seen[id as usize] = true);
        // No two are the same.
        require(seen.into_iter().filter(|seen| *seen).count() == p.len(), &format!("{particles}.id"))?;
        require(self.ghosts.halo.rows().iter().all(|&row| (row as usize) < p.len()), halo)
    }
}
