//! Ranks: processes that share one run, as arguments of the commands that make runs.

use clap::Args;

/// How many processes share the run.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct RankArguments {
    /// Number of MPI processes that share the run, started on this machine by `mpirun` (only in programs built with `--features mpi`)
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
mod alone;
#[cfg(feature = "mpi")]
mod processes;
mod started;
