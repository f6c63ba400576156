//! Forces files onto the disk now and then, so that a power cut costs seconds, not the run.

use super::{
    error::{AtPath, OutputError},
    folder::Folder,
};
use std::{
    collections::BTreeMap,
    path::PathBuf,
    time::{Duration, Instant},
};

/// Lets something slow happen as often as it costs at most about a fiftieth of the time.
#[derive(Debug)]
pub(super) struct Pacing {
    last: Instant,
    duration: Duration,
}

impl Pacing {
    pub(super) fn new() -> Self {
        Self { last: Instant::now(), duration: Duration::ZERO }
    }

    /// Whether fifty times the duration of the last time has passed since.
    pub(super) fn is_due(&self) -> bool {
        self.last.elapsed() >= 50 * self.duration
    }

    /// Does it and notes how long it took.
    pub(super) fn run<T>(&mut self, slow: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = slow();
        self.duration = start.elapsed();
        self.last = Instant::now();
        result
    }
}

/// Files written since the disk was last forced to take them.
#[derive(Debug)]
pub(crate) struct DiskSync {
    pending: BTreeMap<PathBuf, (Folder, String)>,
    pacing: Pacing,
}

impl DiskSync {
    pub(crate) fn new() -> Self {
        Self { pending: BTreeMap::new(), pacing: Pacing::new() }
    }

    /// A file in a folder has been written; this is a good moment to sync if it is time.
    pub(crate) fn written(&mut self, folder: &Folder, name: &str) -> Result<(), OutputError> {
        self.pending.insert(folder.path().join(name), (folder.clone(), name.to_owned()));
        if self.pacing.is_due() { self.sync() } else { Ok(()) }
    }

    /// Files that are no longer there need not come to the disk.
    pub(crate) fn forget_missing(&mut self) {
        self.pending.retain(|_, (folder, name)| folder.open_file(name).is_ok());
    }

    /// Everything written is on the disk when this returns.
    pub(crate) fn sync(&mut self) -> Result<(), OutputError> {
        let pending = std::mem::take(&mut self.pending);
        self.pacing.run(|| {
            let mut folders = BTreeMap::new();
            for (path, (folder, name)) in &pending {
                folder.open_file(name).and_then(|file| file.sync_all()).writing(path)?;
                let inside = name.rsplit_once('/').map_or("", |(inside, _)| inside);
                folders.insert(path.parent(), (folder, inside));
            }
            for (folder, inside) in folders.into_values() {
                match inside {
                    "" => folder.sync(),
                    inside => drop(folder.inside(inside).map(|folder| folder.sync())),
                }
            }
            Ok(())
        })
    }
}
