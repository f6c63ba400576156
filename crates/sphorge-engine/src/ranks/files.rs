//! File access of every rank but the first, provided by the program around the engine.

use crate::persist::{Archive, ArchiveError};
use crate::reduction::FieldSource;
use crate::{Model, Particles};
use std::sync::Arc;

/// A model and its particles, as on every rank at the start.
pub type Loaded = (Arc<Model>, Particles);

/// Reads and writes files for a rank on request of the first one, in requests that the program defines.
pub trait RankFiles: Sync {
    /// The model and the particles of a deck, given with its name, which the first rank has checked.
    fn load(&self, name: &str, deck: &str) -> Option<Loaded>;
    /// Writes the particles of the rank with this number.
    ///
    /// # Errors
    /// Why it cannot.
    fn write(&self, request: &str, rank: usize, model: &Model, particles: &dyn FieldSource) -> Result<(), String>;
    /// Writes the part of a saved state of the rank with this number: what `state` saves.
    ///
    /// # Errors
    /// Why it cannot.
    fn save(
        &self,
        request: &str,
        rank: usize,
        state: &mut dyn FnMut(&mut dyn Archive) -> Result<(), ArchiveError>,
    ) -> Result<(), String>;
    /// The parts of a saved state that a rank is to read, given the number of ranks, in contiguous order; none for some
    /// ranks if there are more ranks than parts.
    ///
    /// # Errors
    /// Why they cannot be read.
    fn open(&self, request: &str, rank: usize, size: usize) -> Result<Box<dyn Archive>, String>;
}
