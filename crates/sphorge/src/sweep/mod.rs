//! Sweeps: one deck run with every combination of some values of some keys, each run a process in a folder of its own, and one table of them all.
//!
//! Folders are named by the values, and a sweep looks at what is there before it begins: a run that has ended is not made again, one that was begun
//! goes on from its last checkpoint. More values of a key, or another order of them, thus only add runs. Before the first run begins, the decks of all
//! of them have been read and filled.
//!
//! | file | content |
//! |---|---|
//! | `sweep.csv` | the table: a row for each run; written anew whenever a run ends |
//! | `NAME.toml` | the deck of a run |
//! | `NAME/` | the folder of that run |
//! | `.sphorge-lock` | the process that makes the runs: another study in the folder is refused |

pub mod ballistic;
mod convergence;
mod execute;
mod name;
mod parquet;
mod plan;
mod table;
mod vary;

pub use convergence::{Convergence, MeasureConvergence, SpacedDeck, spaced};
pub use execute::{Process, SweepEvent, execute};
pub use plan::{Planned, Planning, Sweep, SweepError, SweepRun};
pub use table::{SweepColumn, SweepRow, SweepTable};
pub use vary::Varied;
