//! What can go wrong with files of a run.

use super::{RunDirectory, directory::DECK, no_run::NoRun};
use crate::engine::RunFailure;
use std::{
    io,
    path::{Path, PathBuf},
};

/// Trouble with a run folder or a file in it.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum OutputError {
    /// A run is there and overwriting was not asked for. Nothing was touched.
    #[error("a run in the folder {} exists already", path.display())]
    #[diagnostic(
        code(sphorge::output::exists),
        help("choose another folder with `-o DIR`, or pass `--overwrite` to replace the run; `sphorge resume {}` continues it", path.display())
    )]
    Exists {
        /// The folder.
        path: PathBuf,
    },
    /// Something is there that no run wrote, whether overwriting was asked for or not. Nothing was touched.
    #[error("{} is not the folder of a run, it will not be overwritten", path.display())]
    #[diagnostic(code(sphorge::output::not_a_run), help("choose a folder that does not exist yet with `-o DIR`"))]
    NotARun {
        /// The folder.
        path: PathBuf,
    },
    /// The folder cannot be made or written to.
    #[error("cannot write to the output folder {}", path.display())]
    #[diagnostic(
        code(sphorge::output::unwritable),
        help("choose a folder you may write to with `-o DIR`, or change its permissions")
    )]
    Unwritable {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The folder of a run that is to go on cannot be written to. Nothing was touched.
    #[error("cannot write to the folder of the run {}", path.display())]
    #[diagnostic(
        code(sphorge::output::unwritable),
        help("change its permissions, or copy it to a place that you may write to and continue the copy")
    )]
    UnwritableRun {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Something in the folder has the name of what a run needs and is no file or folder that a run may use. Nothing was touched.
    #[error("cannot write to the folder {}, because of its `{name}`", path.display())]
    #[diagnostic(
        code(sphorge::output::in_the_way),
        help("nothing was changed; if you do not need `{name}`, remove or rename it, or choose another folder")
    )]
    InTheWay {
        /// The folder.
        path: PathBuf,
        /// Name in it.
        name: &'static str,
        /// What is wrong with it.
        source: io::Error,
    },
    /// Another run writes to the folder. Nothing was touched.
    #[error("another run writes to {}: {owner}", path.display())]
    #[diagnostic(
        code(sphorge::output::locked),
        help(
            "wait until that run has ended, or choose another folder; a run of another machine that was killed is recognised after a minute. If you \
             know that it has ended, or want it to stop, pass `--no-lock`"
        )
    )]
    Locked {
        /// The folder.
        path: PathBuf,
        /// The process, as it calls itself.
        owner: String,
    },
    /// The folder is not the one any more that the run has begun to write to. Nothing was written to what is there now.
    #[error("the run cannot write to its folder {} any more: {reason}", path.display())]
    #[diagnostic(
        code(sphorge::output::lost),
        help(
            "do not move or replace the folder of a run that is not finished, nor remove its `.sphorge-lock`; `sphorge resume` continues the run from its last checkpoint, wherever its folder is now"
        )
    )]
    Lost {
        /// The folder.
        path: PathBuf,
        /// What has happened to it.
        reason: &'static str,
    },
    /// A file could not be written.
    #[error("cannot write {}", path.display())]
    #[diagnostic(code(sphorge::output::write), help("{}", cure_of_write(source)))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A run without a summary.
    #[error("the run in {} has not ended", path.display())]
    #[diagnostic(code(sphorge::output::not_ended), help("{}", way_on(path)))]
    NotEnded {
        /// The folder.
        path: PathBuf,
    },
    /// Where the folder of a run was expected is none.
    #[error("{} is not the folder of a run: {}", path.display(), found.what())]
    #[diagnostic(code(sphorge::output::no_run), help("{}", found.help()))]
    NoRun {
        /// Where.
        path: PathBuf,
        /// What is there in its place.
        found: NoRun,
    },
    /// A file could not be read.
    #[error("cannot read {}", path.display())]
    #[diagnostic(code(sphorge::output::read), help("is this the folder of a run?"))]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file is not what a run writes.
    #[error("{} is damaged or not written by Sphorge: {reason}", path.display())]
    #[diagnostic(code(sphorge::output::damaged), help("run the deck again, or remove the file"))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

/// What to do about a run without a summary.
fn way_on(path: &Path) -> String {
    let run = path.display();
    let resumed = if RunDirectory::has_checkpoint_in(path) {
        format!("`sphorge resume {run}` continues the run")
    } else {
        let deck = path.join(DECK);
        format!(
            "there is no checkpoint to continue it from: `sphorge run {} -o {run} --overwrite` runs its deck again",
            deck.display()
        )
    };
    format!("if its process has ended, {resumed}; `sphorge plot` draws what it has written")
}

/// What to do where a file could not be written.
fn cure_of_write(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "you may not write there: name another place, as by `-o`, or change the permissions"
        }
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
            "a part of this path is no folder: name another place, as by `-o`"
        }
        io::ErrorKind::IsADirectory => "this is a folder: name a file in it",
        _ => "check that the disk is not full and the folder is still there; files written before are complete",
    }
}

impl OutputError {
    /// Whether nothing can be written at the place that was asked for: it is not there, is no folder, or nobody may write there.
    pub fn is_of_the_place(&self) -> bool {
        use io::ErrorKind::{
            AlreadyExists, IsADirectory, NotADirectory, NotFound, PermissionDenied, ReadOnlyFilesystem,
        };
        match self {
            Self::Write { source, .. } => {
                matches!(
                    source.kind(),
                    PermissionDenied | ReadOnlyFilesystem | NotFound | NotADirectory | IsADirectory | AlreadyExists
                )
            }
            Self::Unwritable { .. } | Self::UnwritableRun { .. } => true,
            _ => false,
        }
    }

    /// What went wrong, with what caused it.
    pub(crate) fn chain(&self) -> String {
        fn of(error: &dyn std::error::Error) -> String {
            error.source().map_or_else(|| error.to_string(), |source| format!("{error}: {}", of(source)))
        }
        of(self)
    }

    /// Whether a file could not be written because the engine did not give what belongs into it.
    pub(crate) fn is_of_the_engine(&self) -> bool {
        let Self::Write { source, .. } = self else { return false };
        source.get_ref().is_some_and(|cause| cause.is::<RunFailure>())
    }

    /// The failure of a particle that a file could not be written for, or the error as it is: an engine that is lost is another matter.
    pub(crate) fn into_failure(self) -> Result<Box<RunFailure>, Self> {
        let is_of_a_particle = |source: &io::Error| {
            let failure = source.get_ref().and_then(|cause| cause.downcast_ref::<RunFailure>());
            failure.is_some_and(|failure| failure.particle.is_some())
        };
        match self {
            Self::Write { path, source } if is_of_a_particle(&source) => {
                let cause = source.into_inner().map(|cause| cause.downcast::<RunFailure>());
                match cause {
                    Some(Ok(failure)) => Ok(failure),
                    _ => Err(Self::Write { path, source: io::Error::other("the engine gave no value") }),
                }
            }
            other => Err(other),
        }
    }

    pub(crate) fn damaged(path: &std::path::Path, reason: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_owned(), reason: reason.into() }
    }
}

/// Turns an input or output error into one that names the file.
pub(crate) trait AtPath<T> {
    /// The write of `path` failed.
    fn writing(self, path: &std::path::Path) -> Result<T, OutputError>;
    /// The read of `path` failed.
    fn reading(self, path: &std::path::Path) -> Result<T, OutputError>;
}

impl<T> AtPath<T> for io::Result<T> {
    fn writing(self, path: &std::path::Path) -> Result<T, OutputError> {
        self.map_err(|source| OutputError::Write { path: path.to_owned(), source })
    }
    fn reading(self, path: &std::path::Path) -> Result<T, OutputError> {
        self.map_err(|source| OutputError::Read { path: path.to_owned(), source })
    }
}
