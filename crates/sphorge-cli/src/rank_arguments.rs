//! Ranks: processes that share one run, as arguments of the commands that make runs.

use clap::Args;

/// How many processes share the run.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct RankArguments {
    /// Number of processes that share the run, started on this machine by `mpirun` (in a program built with `--features mpi`)
    #[arg(long, value_name = "N", value_parser = parse_ranks)]
    ranks: Option<usize>,
}

/// A number of ranks: at least one.
fn parse_ranks(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(ranks @ 1..=4096) => Ok(ranks),
        _ => Err("write a number from 1 to 4096".to_owned()),
    }
}

#[cfg(not(feature = "mpi"))]
impl RankArguments {
    /// Refuses ranks, which this program was built without.
    pub(crate) fn refuse(self) -> Result<(), crate::failure::Failure> {
        match self.ranks {
            None => Ok(()),
            Some(_) => Err(crate::failure::Failure::bad_input(
                "this program has no ranks: it was built without MPI",
                "build it with `cargo build --release --features mpi`; without it `--threads` takes all of one machine",
            )),
        }
    }
}

#[cfg(feature = "mpi")]
mod processes;

#[cfg(feature = "mpi")]
pub(crate) use processes::{Place, start};
