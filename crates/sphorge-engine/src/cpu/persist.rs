//! Saved state: everything that the following steps depend on.

use super::CpuEngine;
use super::face_sums::FaceSums;
use crate::drive::Driven;
use crate::engine::Part;
use crate::lanes::PairScalar;
use crate::neighbors::{are_places, is_place};
use crate::particles::Owner;
use crate::persist::{Archive, ArchiveError, Persist, require};

impl<T: PairScalar> CpuEngine<T> {
    /// Saves or loads the state of the engine. Ranks together save what one process would, in the common order of the
    /// particles, and load it with the shares they have then.
    ///
    /// - columns of the particles in their current order, with rates, base values and the marks of searches;
    /// - the list of images; their columns and the ghosts of a rank follow from it;
    /// - positions of walls; prescribed motions follow from their tables and the time;
    /// - loads and velocities that a program has given, if it has;
    /// - work, impulse, energy of density restorations, works and powers of viscosity, artificial stress and hourglass springs, steps begun, pairs;
    /// - which bodies have come apart;
    /// - contacts: pairs, powers and works; heat: the last flow, its age, its accounts and limits;
    /// - positions at the last search and the order of the cells, from which rows follow; for strategies that do not
    ///   search all rows at once also rows, contact candidates and stored distances; the displacement bounds that
    ///   decide when lists are renewed;
    /// - the frame of the records. Records and working memory are computed again in every step.
    pub(super) fn persist_all(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.has_come_apart.persist("has_come_apart", archive)?;
        require(self.has_come_apart.len() == self.model.bodies.len(), "has_come_apart")?;
        if self.has_come_apart.contains(&true) {
            // Its columns exist from the first renewal on.
            self.particles.allocate(Owner::Renewal);
        } else {
            self.particles.release(Owner::Renewal);
        }
        self.particles.persist("particles", archive)?;
        match &mut self.domain {
            None => self.ghosts.halo.persist("halo", archive)?,
            Some(domain) => domain.persist("halo", archive)?,
        }
        self.walls.persist("walls", archive)?;
        Driven::persist(&mut self.driven, &self.model, archive)?;
        if self.domain.is_some() && self.driven.take().is_some() {
            let what = "a program gave loads or velocities to its run, which a run on ranks does not take";
            return Err(ArchiveError::Unsupported(what.to_owned()));
        }
        self.external.persist("external", archive)?;
        // Without loads there is none, and nothing of it in the saved state.
        if self.driven.is_some() {
            self.external.load_work.persist("external.load_work", archive)?;
        } else {
            self.external.load_work = 0.0;
        }
        self.numerical_work.persist("numerical_work", archive)?;
        self.step.persist("step", archive)?;
        self.reference_corrected.persist("reference_corrected", archive)?;
        if let Some(contacts) = &mut self.contacts {
            contacts.persist(self.particles.len(), self.domain.as_deref(), "contacts", archive)?;
        }
        if let Some(heat) = &mut self.heat {
            heat.persist("heat", archive)?;
        }
        self.records.frame.persist("frame", archive)?;
        self.constants.unit = T::of(self.records.frame.unit);
        if !archive.is_saving() {
            self.face_sums.iter_mut().for_each(FaceSums::forget);
            self.check_places("particles", "halo")?;
        }
        self.persist_lists("lists", archive)?;
        if !archive.is_saving() && self.domain.is_none() {
            self.complete_state().map_err(|failure| ArchiveError::Unsupported(failure.message))?;
        }
        Ok(())
    }

    /// Refuses loaded particles with invalid indices.
    fn check_places(&self, particles: &str, halo: &str) -> Result<(), ArchiveError> {
        let (model, p) = (&*self.model, &self.particles);
        let below = |column: &[u32], end: usize, name: &str| {
            require(column.iter().all(|&k| (k as usize) < end), &format!("{particles}.{name}"))
        };
        below(&p.body, model.bodies.len(), "body")?;
        below(&p.material, model.materials.len(), "material")?;
        below(&p.motion, model.motions.len() + 1, "motion")?;
        for (column, name) in [
            (&p.position, "position"),
            (&p.base_position, "base_position"),
            (&p.reference_position, "reference_position"),
            (&p.contact_shift, "contact_shift"),
        ] {
            require(are_places(column), &format!("{particles}.{name}"))?;
        }
        let is_length = |&h: &f64| h > 0.0 && is_place(h);
        require(p.smoothing_length.iter().all(is_length), &format!("{particles}.smoothing_length"))?;
        let total = self.total();
        below(&p.id, total, "id")?;
        let mut seen = vec![false; total];
        p.id.iter().for_each(|&id| seen[id as usize] = true);
        // No two are the same.
        require(seen.into_iter().filter(|seen| *seen).count() == p.len(), &format!("{particles}.id"))?;
        let sources = self.domain.as_ref().map_or_else(|| self.ghosts.halo.sources(), |domain| domain.image_sources());
        require(sources.iter().all(|&source| (source as usize) < total), halo)
    }
}
