//! A folder that this process alone writes to.

use super::{
    error::OutputError,
    folder::Folder,
    lock::{LOCK, Lock, Refusal},
};

/// A folder that is open and locked.
#[derive(Debug)]
pub(crate) struct Claim {
    folder: Folder,
    lock: Lock,
}

impl Claim {
    /// Takes the lock of a folder, by force whoever has it.
    ///
    /// # Errors
    /// [`OutputError::Locked`] if another process writes to it; [`OutputError::InTheWay`] if what has the name of the lock is none;
    /// [`OutputError::Unwritable`].
    pub(crate) fn take(folder: Folder, by_force: bool) -> Result<Self, OutputError> {
        let lock = Lock::take(&folder, by_force).map_err(|refusal| {
            let path = folder.path().to_owned();
            match refusal {
                Refusal::Held(owner) => OutputError::Locked { path, owner },
                // Not the file is in the way where nothing in the folder may be written.
                Refusal::InTheWay(source) if folder.unfinished().is_err() => OutputError::Unwritable { path, source },
                Refusal::InTheWay(source) => OutputError::InTheWay { path, name: LOCK, source },
                Refusal::Failed(source) => OutputError::Unwritable { path, source },
            }
        })?;
        Ok(Self { folder, lock })
    }

    /// The folder, whatever has become of it.
    pub(crate) fn folder(&self) -> &Folder {
        &self.folder
    }

    /// The folder, if it is still under the name it was claimed by, and nobody else writes to it.
    ///
    /// # Errors
    /// [`OutputError::Lost`].
    pub(crate) fn check(&self) -> Result<&Folder, OutputError> {
        let reason = if !self.folder.is_in_place() {
            "it was moved, removed or replaced"
        } else if !self.lock.is_held() {
            "its lock was removed, or taken by another run"
        } else {
            return Ok(&self.folder);
        };
        Err(OutputError::Lost { path: self.folder.path().to_owned(), reason })
    }

    /// What tells the lock from all others.
    pub(super) fn session(&self) -> &str {
        self.lock.session()
    }
}
