//! Ranks that are processes of MPI.

use mpi::Threading;
use mpi::environment::{Universe, initialize_with_threading};
use mpi::request::{WaitGuard, scope};
use mpi::topology::Communicator as _;
use mpi::traits::{Destination, Source};
use sphorge_engine::ranks::Communicator;
use std::env;
use std::sync::Arc;

/// Bytes of a message at most: MPI counts them in 32 bits.
const LARGEST_MESSAGE: usize = 1 << 30;

/// Variables that those who start processes of MPI set in each of them: Open MPI, MPICH and its kin, PMIx (Slurm).
const STARTED_BY: [&str; 3] = ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"];

/// How many processes are on this machine, by whom says so.
const ON_THIS_MACHINE: [&str; 3] = ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"];

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
    /// Whether this process was started as one of several.
    pub fn are_there() -> bool {
        STARTED_BY.iter().any(|name| env::var_os(name).is_some())
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

/// Ranks on this machine, where whoever started them says so.
pub fn ranks_on_this_machine() -> Option<usize> {
    ON_THIS_MACHINE.iter().find_map(|name| env::var(name).ok()?.parse().ok()).filter(|&ranks| ranks > 0)
}

impl Communicator for Processes {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn exchange(&self, to: &[Vec<u8>], from: &mut [Vec<u8>]) -> Result<(), String> {
        let world = self.universe.world();
        scope(|scope| {
            let mut guards = Vec::new();
            for (rank, bytes) in from.iter_mut().enumerate().filter(|(rank, _)| *rank != self.rank) {
                for part in bytes.chunks_mut(LARGEST_MESSAGE) {
                    let request = world.process_at_rank(rank as i32).immediate_receive_into(scope, part);
                    guards.push(WaitGuard::from(request));
                }
            }
            let mut sent = Vec::new();
            for (rank, bytes) in to.iter().enumerate().filter(|(rank, _)| *rank != self.rank) {
                for part in bytes.chunks(LARGEST_MESSAGE) {
                    sent.push(WaitGuard::from(world.process_at_rank(rank as i32).immediate_send(scope, part)));
                }
            }
        });
        Ok(())
    }
}
