//! Halo exchange at the points of the step: all fields of a set, for the ghosts of the lists and those of the contact,
//! in one message.

use super::CpuEngine;
use super::conduction::HeatFlow;
use crate::RunFailure;
use crate::halo::{self, ExchangedSets, FieldSet};
use crate::lanes::PairScalar;

impl<T: PairScalar> CpuEngine<T> {
    /// Whether this step exchanges a set.
    fn is_exchanged(&self, fields: FieldSet) -> bool {
        let moves = !self.idle(self.step.dt);
        match fields {
            FieldSet::Search | FieldSet::Audit | FieldSet::Stress => true,
            FieldSet::Motion => moves,
            FieldSet::Density => moves && self.restoration_is_due(),
            FieldSet::Volume => moves && self.formulation.corrects_forces(self),
            FieldSet::Contact | FieldSet::Overlaps => moves && self.contacts.is_some(),
            FieldSet::IntermediateSums => self.heat.as_ref().is_some_and(HeatFlow::is_due),
        }
    }

    /// Packs the fields of a set that ghosts receive, and sends those for other ranks.
    pub(super) fn begin_exchange_of(&mut self, fields: FieldSet) {
        if !self.is_exchanged(fields) {
            return;
        }
        match fields {
            FieldSet::Motion => self.formulation.pack_motion(self),
            FieldSet::Volume => self.formulation.pack_volumes(self),
            _ => {}
        }
        let arrival = halo::begin(&self.exchanged(fields));
        self.arrival = Some(arrival);
    }

    /// Waits for the messages of other ranks, and updates the ghosts.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn finish_exchange_of(&mut self, fields: FieldSet) -> Result<(), RunFailure> {
        let Some(arrival) = self.arrival.take() else { return Ok(()) };
        halo::finish(arrival, self.exchanged(fields));
        if self.reads_records(fields) {
            let (count, ghosts) = (self.particles.len(), &self.ghosts.columns);
            match fields {
                FieldSet::Motion | FieldSet::Volume => self.records.place_kinematic_ghosts(count),
                FieldSet::Stress if self.formulation.is_initial() => {
                    self.records.place_force_ghosts(count, &ghosts.reference_position);
                }
                FieldSet::Stress => self.records.place_force_ghosts(count, &ghosts.position),
                _ => {}
            }
        }
        self.domain.as_ref().map_or(Ok(()), |domain| domain.ranks.check_lost())
    }

    /// Whether packed records of ghosts belong to a set in this step.
    fn reads_records(&self, fields: FieldSet) -> bool {
        let is_packed = matches!(fields, FieldSet::Motion | FieldSet::Volume | FieldSet::Stress);
        is_packed && !self.idle(self.step.dt) && !self.ghosts.halo.is_empty()
    }

    /// The columns of a set, and the ghosts that receive them.
    fn exchanged(&mut self, fields: FieldSet) -> ExchangedSets<'_> {
        let reads_records = self.reads_records(fields);
        let is_of_contact = matches!(fields, FieldSet::Contact | FieldSet::Overlaps);
        let is_alone = self.domain.is_none();
        let Self { particles, ghosts, records, contacts, .. } = self;
        let (count, of_ghosts) = (particles.len(), ghosts.count());
        let contact = contacts.as_mut().and_then(|contacts| {
            // Another rank may read particles of this one.
            let is_met = !(is_alone && contacts.foreign().is_empty());
            Some((contacts.ghosts_of_search()?, is_met))
        });
        let mut exchanged = ExchangedSets::new();
        if !(is_of_contact && contact.is_some()) {
            let mut of_list = ghosts.exchanged(&[fields], particles);
            match fields {
                FieldSet::Motion | FieldSet::Volume if reads_records => {
                    of_list.columns.extend(records.kinematic_of_ghosts(count, of_ghosts));
                }
                FieldSet::Stress if reads_records => of_list.columns.extend(records.forces_of_ghosts(count)),
                _ => {}
            }
            exchanged.push(of_list);
        }
        match contact {
            Some((ghosts, true)) if is_of_contact || matches!(fields, FieldSet::Motion | FieldSet::Stress) => {
                exchanged.push(ghosts.exchanged(&[fields], particles));
            }
            _ => {}
        }
        exchanged
    }
}
