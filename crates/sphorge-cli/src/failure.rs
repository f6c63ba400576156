//! How a command ends, and the exit code scripts see.

use miette::Report;
use sphorge::output::OutputError;

/// A command that ended without failing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All done: exit code 0.
    Done,
    /// The user stopped it, its files are complete: exit code 130.
    Stopped,
}

/// A command that failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// What the user gave cannot be used: exit code 2.
    BadInput(Report),
    /// It was well asked for and went wrong on the way: exit code 1.
    Failed(Report),
    /// As before, and the command has said so itself: exit code 1.
    Told,
    /// Bad input, which another process of the command has told the user of: exit code 2.
    #[cfg(feature = "mpi")]
    ToldOfBadInput,
}

/// What every command returns.
pub(crate) type Ending = Result<Outcome, Failure>;

impl Failure {
    /// Bad input with a message and what to do about it.
    pub(crate) fn bad_input(message: impl std::fmt::Display, help: impl std::fmt::Display) -> Self {
        Self::BadInput(miette::miette!(help = help.to_string(), "{message}"))
    }

    /// The same when the user has been told of it.
    pub(crate) fn told(self) -> Self {
        match self {
            Self::Failed(_) => Self::Told,
            other => other,
        }
    }

    /// The report for people, if it is not told yet.
    pub(crate) fn report(&self) -> Option<&Report> {
        match self {
            Self::BadInput(report) | Self::Failed(report) => Some(report),
            Self::Told => None,
            #[cfg(feature = "mpi")]
            Self::ToldOfBadInput => None,
        }
    }
}

/// What cannot be read, or written at the place that was given, is bad input; a disk that takes no more is a failure.
pub(crate) fn of_output(error: OutputError) -> Failure {
    match error {
        OutputError::Write { .. } if !error.is_of_the_place() => Failure::Failed(error.into()),
        _ => Failure::BadInput(error.into()),
    }
}

/// The exit code of an ending.
pub(crate) fn exit_code(ending: &Ending) -> u8 {
    match ending {
        Ok(Outcome::Done) => 0,
        Err(Failure::Failed(_) | Failure::Told) => 1,
        Err(Failure::BadInput(_)) => 2,
        #[cfg(feature = "mpi")]
        Err(Failure::ToldOfBadInput) => 2,
        Ok(Outcome::Stopped) => 130,
    }
}
