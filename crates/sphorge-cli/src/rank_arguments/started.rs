//! What whoever has started this process says of those that were started with it.

use std::env;

/// Number of the process among them, set by what starts processes of MPI: Open MPI, MPICH and its kin, PMIx (Slurm), Slurm without MPI.
const NUMBER: [&str; 4] = ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"];
/// How many they are. Of Slurm those of a step: its job has tasks that may not be started yet.
const COUNT: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"];

fn first(names: &[&str]) -> Option<usize> {
    names.iter().find_map(|name| env::var(name).ok()?.parse().ok())
}

/// Processes that were started together; one where nobody says more.
pub(super) fn count() -> usize {
    first(&COUNT).unwrap_or(1)
}

/// Whether it is the first of them, the one that tells what is wrong with all.
pub(super) fn is_first() -> bool {
    first(&NUMBER).unwrap_or(0) == 0
}

/// Whether this process was started as one of several, or by what starts processes of MPI.
#[cfg(feature = "mpi")]
pub(super) fn by_mpi() -> bool {
    is_known_to_mpi() || count() > 1
}

/// Whether MPI is told which process this is; Slurm does so only on request.
#[cfg(feature = "mpi")]
pub(super) fn is_known_to_mpi() -> bool {
    // A script of Slurm has a number, too.
    first(&NUMBER[..3]).is_some()
}
