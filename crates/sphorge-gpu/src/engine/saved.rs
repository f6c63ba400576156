//! The saved state: columns of the particles in their common order, on any number of ranks.
//!
//! Lists that follow from the saved data are not saved: those of a skin are searched again at the positions of the last
//! search, and those of the reference configuration are built from it.

use super::GpuEngine;
use super::columns::Group;
use super::read_back::read;
use rayon::prelude::*;
use sphorge_engine::RunFailure;
use sphorge_engine::model::Search;
use sphorge_engine::persist::{Archive, ArchiveError, Persist, persist_pieces};

/// Groups on which the following steps depend.
const STATE: &[Group] = &[
    Group::Place,
    Group::Velocity,
    Group::Evaluated,
    Group::Ahead,
    Group::Density,
    Group::Gradient,
    Group::Weight,
    Group::Energy,
    Group::Rates,
    Group::External,
    Group::Deviator,
    Group::Pressure,
    Group::Plastic,
    Group::History,
    Group::Temperature,
    Group::Accounts,
    Group::Walls,
    Group::Limits,
    Group::Reference,
    Group::Deformation,
    Group::Earlier,
    Group::Stretch,
    Group::Springs,
    Group::FaceExcess,
    Group::Contact,
    Group::Meetings,
    Group::FacetMotion,
    Group::SharedEdges,
    Group::EdgePulls,
    Group::Slips,
    Group::Kept,
    Group::Rows,
    Group::SearchedAt,
    Group::Stored,
    Group::FoundAt,
    Group::Candidates,
    Group::StrainCorrection,
    Group::Heat,
    Group::Boundaries,
    Group::Constants,
];

/// Those among them that are lists, and the positions at which they were built.
const LISTS: &[Group] = &[Group::Kept, Group::Rows, Group::SearchedAt];

impl GpuEngine {
    /// Saves or loads everything that the following steps depend on. On ranks [`Self::complete_state`] completes a
    /// loaded state.
    pub(super) fn persist_state(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.read_back.take();
        self.time.persist("time", archive)?;
        self.dt.persist("dt", archive)?;
        self.steps.persist("steps", archive)?;
        let mut extremes = self.extremes.to_vec();
        extremes.persist("extremes", archive)?;
        self.extremes = extremes.try_into().map_err(|_| ArchiveError::Mismatch("extremes".to_owned()))?;
        self.persist_lists(archive)?;
        self.persist_references(archive)?;
        self.persist_facets(archive)?;
        if let Some(clock) = &mut self.heat {
            clock.persist("heat", archive)?;
        }
        self.persist_columns(archive)?;
        if !archive.is_saving() && self.domain.is_none() {
            return self.complete_state().map_err(|fault| ArchiveError::Unsupported(fault.to_string()));
        }
        Ok(())
    }

    /// Whether a group belongs to the saved state and does not follow from it.
    fn is_saved(&self, group: Group) -> bool {
        match group {
            // The initial configuration is that of the deck.
            Group::Reference => self.is_renewed(),
            Group::Constants => self.model.smoothing_follows_density(),
            Group::SearchedAt => self.model.search != Search::EveryStep,
            _ => self.saves_lists() || !LISTS.contains(&group),
        }
    }

    /// Whether rows of the lists were built at different times.
    pub(super) fn saves_lists(&self) -> bool {
        matches!(self.model.search, Search::Adaptive(_) | Search::Initial)
    }

    fn persist_columns(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let (own, stride) = (self.initial.len(), self.stride);
        let sections = (0..self.model.sections.len()).map(Group::Section);
        let groups: Vec<Group> = STATE.iter().copied().chain(sections).filter(|of| self.is_saved(*of)).collect();
        for group in groups {
            let Some(array) = self.columns.array(group) else { continue };
            let lost = |fault: RunFailure| ArchiveError::Unsupported(fault.to_string());
            // Entries behind the particles do not change. The lists of a state that is replaced have lengths that the
            // loaded ones need not have: a step that is repeated may be the first one, before any list.
            let mut numbers = match group {
                Group::Kept if archive.is_saving() => self.columns_of(&self.list_entries().map_err(lost)?),
                Group::Kept => self.columns_of(&Vec::new()),
                _ => read(&self.card, &self.columns, group).map_err(lost)?,
            };
            for (k, column) in numbers.chunks_exact_mut(stride).enumerate() {
                let name = format!("{group:?}.{k}").to_lowercase();
                let mut values: Vec<f32> = column[..own].par_iter().with_min_len(1 << 16).copied().collect();
                persist_pieces(&mut values, &name, archive)?;
                if !archive.is_saving() {
                    column[..own].copy_from_slice(&values);
                }
            }
            match group {
                _ if archive.is_saving() => {}
                Group::Kept if self.domain.is_some() => self.loaded_lists = Some(numbers),
                _ => self.card.write(array, &numbers),
            }
        }
        Ok(())
    }

    /// Computes what follows from a loaded state: ghosts and lists.
    pub(super) fn complete_state(&mut self) -> Result<(), RunFailure> {
        if let Some(domain) = &self.domain {
            domain.forget(&self.columns, self.stride);
            self.choose_ghosts()?;
        }
        if self.domain.is_some() || self.is_renewed() || self.lists.had_other_references {
            self.lists.had_other_references = false;
            self.make_lists_anew()?;
        }
        match self.model.search {
            Search::Skin { .. } if self.lists.is_made => self.search_again(),
            _ => Ok(()),
        }
    }
}
