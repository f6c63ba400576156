//! How a run can fail.

use crate::{
    engine::{RunFailure, Unsupported},
    model::Model,
    output::{FailureRecord, OutputError, Summary},
};
use std::path::{Path, PathBuf};

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
    /// The engine does not run such a model; nothing was written or computed.
    #[error("the engine `{engine}` does not run this deck: {unsupported}")]
    #[diagnostic(code(sphorge::run::engine), help("{}", unsupported.help))]
    Unsupported {
        /// Name of the engine.
        engine: &'static str,
        /// What it cannot do.
        unsupported: Unsupported,
    },
    /// The engine did not start; nothing was computed.
    #[error("the engine `{engine}` did not start: {failure}")]
    #[diagnostic(code(sphorge::run::engine))]
    Start {
        /// Name of the engine.
        engine: &'static str,
        /// Why.
        failure: Box<RunFailure>,
    },
    /// The solution broke down. All frames and rows up to then are on the disk, `summary.json` says `failed`.
    #[error("the run failed in {failure}")]
    #[diagnostic(code(sphorge::run::failed), help("{}", what_is_kept(directory)))]
    Failed {
        /// What happened.
        failure: Box<FailureRecord>,
        /// Folder of the run.
        directory: PathBuf,
        /// What is also in `summary.json`.
        summary: Box<Summary>,
    },
    /// The run was going well but its files could not be written any more. Frames that were complete are listed, as far as the list could be written.
    #[error("the run stopped because its output could not be written")]
    #[diagnostic(
        code(sphorge::run::output),
        help("free space or repair the folder; `sphorge resume` continues from the last checkpoint, if there is one")
    )]
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
            Self::Directory(_) | Self::Threads { .. } | Self::Unsupported { .. } => 2,
            Self::Start { .. } | Self::Failed { .. } | Self::Output { .. } => 1,
        }
    }
}

/// What a run that failed has left.
fn what_is_kept(directory: &Path) -> String {
    let place = directory.display();
    // The list of frames is there with the first of them.
    if directory.join("fields.pvd").exists() {
        format!("frames and history up to that time are in {place}; look at the last frame there")
    } else {
        format!("it failed before the first frame: {place} contains only the deck and `summary.json`")
    }
}

/// What ends the loop over time before its end.
#[derive(Debug)]
pub(super) enum Trouble {
    /// The solution broke down, or the engine is lost.
    Engine(Box<RunFailure>),
    /// Files cannot be written.
    Output(OutputError),
}

impl From<RunFailure> for Trouble {
    fn from(failure: RunFailure) -> Self {
        Self::Engine(Box::new(failure))
    }
}

impl From<OutputError> for Trouble {
    /// A file that the engine has given no value for is a failure of the solution, as far as it says so.
    fn from(error: OutputError) -> Self {
        match error.into_failure() {
            Ok(failure) => Self::Engine(failure),
            Err(error) => Self::Output(error),
        }
    }
}

/// A failure with names for numbers.
pub(super) fn failure_record(model: &Model, failure: RunFailure) -> Box<FailureRecord> {
    let body = failure.body.and_then(|body| model.bodies.get(body as usize));
    Box::new(FailureRecord {
        message: failure.message,
        step: failure.step,
        time: failure.time,
        field: Some(failure.field.to_owned()),
        particle: failure.particle,
        body: body.map(|body| body.name.clone()),
        // JSON has no words for what is not finite.
        position: failure.position.filter(|position| position.iter().all(|x| x.is_finite())),
    })
}
