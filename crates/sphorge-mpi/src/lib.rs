//! One run on many ranks.
//!
//! The first rank drives the run as if it were alone: it keeps the clock, writes the files and asks for sums. Its engine is a [`Leader`], which
//! has its share of the particles ([`sphorge_engine::Part`]) and tells the other ranks of every step and every question, so that they do with
//! their shares what it does ([`follow`]). Ranks are processes that MPI joins (feature `mpi`), or threads of one process ([`threads`]).

mod follower;
#[cfg(feature = "mpi")]
mod in_flight;
mod leader;
#[cfg(feature = "mpi")]
mod process;
mod protocol;
mod threads;

pub use follower::{follow, follow_with};
pub use leader::Leader;
#[cfg(feature = "mpi")]
pub use process::Processes;
pub use threads::threads;
