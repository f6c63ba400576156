//! How long ghosts can be used.

use sphorge_engine::model::{Model, Search};

/// When ghosts change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum GhostLifetime {
    /// They belong to each search.
    OneSearch,
    /// Until particles have moved by the margin.
    Margin,
    /// They belong to the reference configuration.
    OneReference,
}

/// What ranks derive from a model.
pub(in crate::engine) trait SharedModel {
    fn ghost_lifetime(&self) -> GhostLifetime;

    /// Whether ghosts have to be chosen again because particles have moved too far.
    fn ghosts_expire(&self) -> bool {
        self.ghost_lifetime() == GhostLifetime::Margin
    }

    /// Whether ghosts can change while lists are kept.
    fn lists_outlast_ghosts(&self) -> bool;
}

impl SharedModel for Model {
    fn ghost_lifetime(&self) -> GhostLifetime {
        // Particles that are searched in the cells besides those in the lists.
        let searches_present = self.has_contact() || self.audit.is_some();
        match self.search {
            Search::Skin { .. } => GhostLifetime::OneSearch,
            Search::Initial if searches_present => GhostLifetime::Margin,
            Search::Initial if self.is_total_lagrangian() => GhostLifetime::OneReference,
            Search::Initial => GhostLifetime::OneSearch,
            Search::EveryStep | Search::Adaptive(_) => GhostLifetime::Margin,
        }
    }

    fn lists_outlast_ghosts(&self) -> bool {
        self.keeps_lists() && self.search != Search::EveryStep && self.ghosts_expire()
    }
}
