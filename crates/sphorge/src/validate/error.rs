//! Why a validation could not be done.

use crate::{output::OutputError, run::RunError};
use std::path::PathBuf;

/// Why there is no report.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ValidateError {
    /// There is no case of that name.
    #[error("there is no case `{name}`")]
    #[diagnostic(
        code(sphorge::validate::unknown_case),
        help("{}the cases are: {known}", nearest.as_ref().map_or(String::new(), |n| format!("did you mean `{n}`? ")))
    )]
    UnknownCase {
        /// The name.
        name: String,
        /// The most similar name, if any is similar.
        nearest: Option<String>,
        /// All names.
        known: String,
    },
    /// The folder holds something that is not a validation.
    #[error("{} is neither empty nor the folder of a validation", path.display())]
    #[diagnostic(code(sphorge::validate::folder), help("choose another folder; nothing was changed"))]
    NotAValidation {
        /// The folder.
        path: PathBuf,
    },
    /// There is nothing in the folder that this program could go on with.
    #[error("{} does not contain runs of exactly this program, so it cannot be resumed", path.display())]
    #[diagnostic(
        code(sphorge::validate::another_program),
        help(
            "results of two programs cannot be combined in one report: run it again without `--resume`; nothing was changed"
        )
    )]
    AnotherProgram {
        /// The folder.
        path: PathBuf,
    },
    /// Another validation writes to the folder. Nothing was changed.
    #[error("another validation writes to {}: {owner}", path.display())]
    #[diagnostic(
        code(sphorge::validate::locked),
        help(
            "wait until it has ended, or choose another folder with `-o DIR`; one of another machine that was killed is recognised after a minute. If \
             you know that it has ended, remove `.sphorge-lock` from the folder"
        )
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// The process, as it calls itself.
        owner: String,
    },
    /// The folder is not the one any more that the validation has begun to write to. Nothing was written to what is there now.
    #[error("the validation cannot write to its folder {} any more: {reason}", path.display())]
    #[diagnostic(
        code(sphorge::validate::lost),
        help(
            "do not move or replace the folder of a validation that is not finished, nor remove its `.sphorge-lock`; `--resume` continues it from what \
             it had, wherever its folder is now"
        )
    )]
    Lost {
        /// The folder.
        path: PathBuf,
        /// What has happened to it.
        reason: &'static str,
    },
    /// The folder cannot be used.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(OutputError),
    /// The report could not be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Report(OutputError),
    /// A run could not be started, or not be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(RunError),
    /// The user stopped it.
    #[error("the validation was stopped; finished runs are in {}", directory.display())]
    #[diagnostic(code(sphorge::validate::stopped))]
    Stopped {
        /// Folder of the validation.
        directory: PathBuf,
    },
}

/// Names less similar than this are not worth suggesting.
const SIMILAR: f64 = 0.7;

impl From<OutputError> for ValidateError {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Locked { path, owner } => Self::Locked { path, owner },
            OutputError::Lost { path, reason } => Self::Lost { path, reason },
            other => Self::Output(other),
        }
    }
}

impl ValidateError {
    /// No case of the `known` names is called `name`.
    pub(super) fn unknown(name: &str, known: &[&str]) -> Self {
        let similarity = |case: &str| strsim::jaro_winkler(name, case);
        let nearest = match name {
            // It had one bar of what is many in the other.
            "copper-bar" => Some("taylor-bars"),
            _ => known.iter().copied().max_by(|a, b| similarity(a).total_cmp(&similarity(b))),
        };
        Self::UnknownCase {
            name: name.to_owned(),
            nearest: nearest.filter(|case| *case == "taylor-bars" || similarity(case) > SIMILAR).map(str::to_owned),
            known: known.join(", "),
        }
    }
}
