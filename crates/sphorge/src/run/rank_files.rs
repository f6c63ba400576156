//! What ranks beside the first write and read.

use crate::{
    deck::load_text_within,
    engine::{
        FieldSource,
        persist::{Archive, ArchiveError},
        ranks::{Loaded, RankFiles},
    },
    model::Model,
    output::{DiskSync, OutputError, PartSet, PieceRequest},
};
use std::sync::{Arc, Mutex, PoisonError};

/// Reads decks, and writes pieces of frames and parts of checkpoints, for a rank of a run whose first one is driven by [`super::execute`] or
/// [`super::resume`].
#[derive(Debug)]
pub struct FilesOfRank {
    most_particles: f64,
    disk: Mutex<DiskSync>,
}

impl FilesOfRank {
    /// Of a rank whose deck may make so many particles.
    pub fn new(most_particles: f64) -> Self {
        Self { most_particles, disk: Mutex::new(DiskSync::new()) }
    }

    fn on_disk(&self, act: impl FnOnce(&mut DiskSync) -> Result<(), OutputError>) -> Result<(), String> {
        act(&mut self.disk.lock().unwrap_or_else(PoisonError::into_inner)).map_err(|error| error.chain())
    }
}

impl RankFiles for FilesOfRank {
    fn load(&self, name: &str, deck: &str) -> Option<Loaded> {
        let setup = load_text_within(name, deck, &[], self.most_particles).ok()?;
        Some((Arc::new(setup.model), setup.particles))
    }

    fn write(&self, request: &str, rank: usize, model: &Model, particles: &dyn FieldSource) -> Result<(), String> {
        let (run, name) = PieceRequest::read(request)?.write(model, rank, particles).map_err(|error| error.chain())?;
        self.on_disk(|disk| disk.written(&run, &name))
    }

    fn save(
        &self,
        request: &str,
        rank: usize,
        state: &mut dyn FnMut(&mut dyn Archive) -> Result<(), ArchiveError>,
    ) -> Result<(), String> {
        // Frames that a state counts on come to the disk before it.
        self.on_disk(|disk| {
            disk.forget_missing();
            disk.sync()
        })?;
        PartSet::read(request)?.write(rank, state).map_err(|error| error.chain())
    }

    fn open(&self, request: &str, rank: usize, size: usize) -> Result<Box<dyn Archive>, String> {
        PartSet::read(request)?.archive(rank, size).map_err(|error| error.chain())
    }
}

impl Drop for FilesOfRank {
    fn drop(&mut self) {
        // Nobody is left to be told.
        let _ = self.on_disk(|disk| {
            disk.forget_missing();
            disk.sync()
        });
    }
}
