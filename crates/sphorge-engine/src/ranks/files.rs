//! What every rank but the first does with files, as the program around it does.

use crate::persist::{Archive, ArchiveError};
use crate::reduction::FieldSource;
use crate::{Model, Particles};
use std::sync::Arc;

/// A model and its particles as every rank has them at the start.
pub type Loaded = (Arc<Model>, Particles);

/// Reads and writes for a rank what the first one asks for, in words of the program that both are of.
pub trait RankFiles: Sync {
    /// The model and the particles of a deck, given with its name, that the first rank has found in order.
    fn load(&self, name: &str, deck: &str) -> Option<Loaded>;
    /// Writes the particles of the rank of this number.
    ///
    /// # Errors
    /// Why it cannot.
    fn write(&self, request: &str, rank: usize, model: &Model, particles: &dyn FieldSource) -> Result<(), String>;
    /// Writes the part of a saved state that the rank of this number has: what `state` saves.
    ///
    /// # Errors
    /// Why it cannot.
    fn save(
        &self,
        request: &str,
        rank: usize,
        state: &mut dyn FnMut(&mut dyn Archive) -> Result<(), ArchiveError>,
    ) -> Result<(), String>;
    /// The parts of a saved state that a rank of so many is to read, those of one behind the other; none for some where ranks are more than parts.
    ///
    /// # Errors
    /// Why they cannot be read.
    fn open(&self, request: &str, rank: usize, size: usize) -> Result<Box<dyn Archive>, String>;
}
