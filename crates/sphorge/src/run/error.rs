//! How a run can fail.

use crate::output::{FailureRecord, OutputError, Summary};
use std::path::PathBuf;

/// Why [`super::execute`] did not return a summary.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    /// The folder was refused; nothing was written or computed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Directory(OutputError),
    /// The threads could not be started; nothing was computed.
    #[error("cannot start {} threads", threads.map_or("the".to_owned(), |n| n.to_string()))]
    #[diagnostic(code(sphorge::run::threads), help("ask for fewer with `--threads N`"))]
    Threads {
        /// Threads asked for.
        threads: Option<usize>,
        /// What the thread pool said.
        source: rayon::ThreadPoolBuildError,
    },
    /// The solution broke down. All frames and rows up to then are on the disk, `summary.json` says `failed`.
    #[error("the run failed in {failure}")]
    #[diagnostic(
        code(sphorge::run::failed),
        help("frames and history up to that time are in {}; look at the last frame near the place", directory.display())
    )]
    Failed {
        /// What happened.
        failure: Box<FailureRecord>,
        /// Folder of the run.
        directory: PathBuf,
        /// What is also in `summary.json`.
        summary: Box<Summary>,
    },
    /// The run was going well but its files could not be written any more.
    #[error("the run stopped because its output could not be written")]
    #[diagnostic(code(sphorge::run::output), help("free space or repair the folder, then run again"))]
    Output {
        /// What could not be written.
        #[source]
        #[diagnostic_source]
        source: OutputError,
    },
}

impl RunError {
    /// Exit code for a program: 2 if nothing was begun, 1 if a run was under way.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Directory(_) | Self::Threads { .. } => 2,
            Self::Failed { .. } | Self::Output { .. } => 1,
        }
    }
}
