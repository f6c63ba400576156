//! What can stop a benchmark.

use crate::deck::DeckReport;

/// What can stop a benchmark.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum BenchError {
    /// No pool of threads.
    #[error("cannot start the threads: {0}")]
    #[diagnostic(help("ask for fewer with `--threads N`"))]
    Threads(String),
    /// A case cannot be read with the changes that were asked for.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(DeckReport),
}
