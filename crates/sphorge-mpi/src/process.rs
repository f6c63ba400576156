//! Ranks that are processes of MPI.

use crate::in_flight::InFlight;
use mpi::Threading;
use mpi::environment::{Universe, initialize_with_threading};
use mpi::topology::Communicator as _;
use sphorge_engine::ranks::{Communicator, Messages};
use std::sync::Arc;

/// All processes that were started together.
pub struct Processes {
    universe: Universe,
    rank: usize,
    size: usize,
}

impl std::fmt::Debug for Processes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Processes").field("rank", &self.rank).field("size", &self.size).finish_non_exhaustive()
    }
}

impl Processes {
    /// Name and version of the MPI that this program is linked to, as it calls itself.
    pub fn library() -> String {
        let told = mpi::environment::library_version().unwrap_or_default();
        told.split(&[',', '\n', '\0'][..]).next().unwrap_or_default().trim().to_owned()
    }

    /// Joins the others; to be called once, on the thread that ends last. Where a process ends without saying so, MPI ends all.
    ///
    /// # Errors
    /// MPI cannot be started, or does not let threads of a rank take turns.
    pub fn join() -> Result<Arc<dyn Communicator>, String> {
        let Some((universe, provided)) = initialize_with_threading(Threading::Serialized) else {
            return Err("MPI was started before".to_owned());
        };
        if provided < Threading::Serialized {
            return Err("this MPI serves a single thread of a process alone".to_owned());
        }
        let world = universe.world();
        let (rank, size) = (world.rank() as usize, world.size() as usize);
        Ok(Arc::new(Self { universe, rank, size }))
    }
}

impl Drop for Processes {
    fn drop(&mut self) {
        // Others may wait for this one: they would wait for good.
        if std::thread::panicking() {
            self.universe.world().abort(1);
        }
    }
}

impl Communicator for Processes {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Box<dyn Messages>, String> {
        Ok(Box::new(InFlight::begin(&self.universe.world(), to, lengths)))
    }
}
