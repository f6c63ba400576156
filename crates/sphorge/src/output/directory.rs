//! The folder of a run: names in it, making it, replacing it.

use super::{
    atomic::{Durability, Sink, UNFINISHED_PREFIX, UNFINISHED_SUFFIX},
    checkpoint::is_checkpoint,
    checkpoint_parts::{remove_parts, remove_parts_of_none},
    claim::Claim,
    error::{AtPath, OutputError},
    folder::{Folder, Kind},
    lock::{LOCK, is_locked_by_another, seems_held},
    mark::{MARK, Mark, Marked, add_picture},
    no_run::NoRun,
    pieces::remove_pieces,
    regular_file,
    sum::{Sum, sum_in, sum_of},
    summary::{Status, Summary},
};
use serde::{Deserialize, Serialize};
use std::{
    fs,
    io::{self, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

/// The folder a run writes to, and the files in it:
///
/// | file | content |
/// |---|---|
/// | `deck.toml` | the deck as run |
/// | `fields.pvd` | list of frames with their times; ParaView opens it |
/// | `fields/NNNNNN.vtp` | one frame |
/// | `fields/NNNNNN.pvtp`, `fields/NNNNNN/` | in its place, of a run on many processes: the frame, and the pieces that they have written |
/// | `history.csv` | one row per history time |
/// | `history-columns.json` | name, unit and meaning of each column |
/// | `summary.json` | how the run ended; written last |
/// | `checkpoint-*.zip` | what the run can be resumed from, the last two |
/// | `checkpoint-*-parts-*/` | the parts of one that other processes have written |
/// | `plots/*.png`, `plots/*.svg` | pictures, when asked for |
///
/// | `.sphorge-run` | names of all files above that this run has written: what `--overwrite` may remove |
/// | `.sphorge-lock` | the process that writes to the folder |
///
/// Every file is written aside and renamed into place, so a reader sees a complete file or none. A run that writes does so relative to the folder that
/// it has opened, and follows no link in it; before each file it looks whether the folder is still under its name, and still its own.
#[derive(Clone, Debug)]
pub struct RunDirectory {
    path: PathBuf,
    /// Of a run that writes to it, until the last copy of this is dropped.
    held: Option<Arc<Held>>,
}

/// What a run that writes to its folder holds of it.
#[derive(Debug)]
struct Held {
    claim: Claim,
    mark: Mark,
}

impl Held {
    /// Takes the lock of a folder.
    fn take(
        folder: Folder,
        by_force: bool,
        mark: impl FnOnce(&Folder) -> io::Result<Mark>,
    ) -> Result<Self, OutputError> {
        let claim = Claim::take(folder, by_force)?;
        let unwritable = |source| OutputError::Unwritable { path: claim.folder().path().to_owned(), source };
        let mark = mark(claim.folder()).map_err(unwritable)?;
        Ok(Self { claim, mark })
    }
}

/// Files at the top of the folder, beside deck and checkpoints.
pub(super) const FILES: [&str; 4] = [SERIES, HISTORY, COLUMNS, SUMMARY];
pub(crate) const SERIES: &str = "fields.pvd";
pub(crate) const HISTORY: &str = "history.csv";
pub(super) const COLUMNS: &str = "history-columns.json";
pub(crate) const DECK: &str = "deck.toml";
pub(super) const SUMMARY: &str = "summary.json";
pub(super) const FIELDS: &str = "fields";
/// How frames end that are one file, and those that name pieces.
const IN_ONE: &str = ".vtp";
const IN_PIECES: &str = ".pvtp";
pub(super) const PLOTS: &str = "plots";

impl RunDirectory {
    /// Names an existing run folder for reading.
    ///
    /// # Errors
    /// [`OutputError::NoRun`] if there is no folder or one in which no run has written anything; [`OutputError::Read`] if it cannot be looked into.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        if let Some(found) = NoRun::at(path) {
            return Err(OutputError::NoRun { path: path.to_owned(), found });
        }
        fs::read_dir(path).reading(path)?;
        Ok(Self::at(path))
    }

    /// The same without a look at what is there.
    pub(crate) fn at(path: &Path) -> Self {
        Self { path: path.to_owned(), held: None }
    }

    /// Whether a folder has the mark that only a run writes.
    pub fn is_run(path: &Path) -> bool {
        Folder::open(path).is_ok_and(|folder| Marked::read(&folder).is_some())
    }

    /// What tells the run in a folder from all others, also from a former one in the same folder; nothing where the folder has no mark of a run.
    pub(crate) fn identity(&self) -> Option<String> {
        let folder = Folder::open(&self.path).ok()?;
        Marked::read(&folder).map(|marked| marked.run)
    }

    /// Whether a run seems to write to the folder now.
    pub(crate) fn is_written(&self) -> bool {
        Folder::open(&self.path).is_ok_and(|folder| seems_held(&folder))
    }

    /// Says whether [`RunDirectory::create`] would refuse, without touching anything. Worth asking before a model is
    /// built, which may take long.
    ///
    /// # Errors
    /// As [`RunDirectory::create`], except for what only shows when writing.
    pub fn check(path: &Path, overwrite: bool) -> Result<(), OutputError> {
        match fs::symlink_metadata(path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
            Err(source) => Err(OutputError::Unwritable { path: path.to_owned(), source }),
            Ok(_) if !overwrite && Self::may_be_taken(path) => Ok(()),
            Ok(_) if is_run_or_empty(path) && !overwrite => Err(OutputError::Exists { path: path.to_owned() }),
            Ok(_) if is_run_or_empty(path) => Ok(()),
            Ok(_) => Err(OutputError::NotARun { path: path.to_owned() }),
        }
    }

    /// Whether a new run may write to a folder without being told to overwrite: nothing of anybody's is in it.
    fn may_be_taken(path: &Path) -> bool {
        Folder::open(path).is_ok_and(|folder| is_empty(&folder)) || Self::has_taken_no_step(path)
    }

    /// Whether a folder is that of a run which was stopped before its first step: there is nothing in it to go on from, or to lose.
    pub(crate) fn has_taken_no_step(path: &Path) -> bool {
        let is_unstepped = |run: Self| {
            let ended =
                Summary::read(&run).is_ok_and(|summary| summary.status == Status::Stopped && summary.steps == 0);
            ended && !run.has_checkpoint() && !run.is_written()
        };
        Self::is_run(path) && Self::open(path).is_ok_and(is_unstepped)
    }

    /// Makes the folder of a new run, still without a deck. A run there that has taken no step is replaced. With `overwrite`, the files of a former run in it are removed, and no others.
    ///
    /// # Errors
    /// [`OutputError::Exists`] if the folder of a run is at `path` and `overwrite` is false; [`OutputError::NotARun`] if what is there is
    /// neither empty nor the folder of a run; [`OutputError::Locked`] if another run writes to it; [`OutputError::Unwritable`] if it
    /// cannot be made or written to.
    pub fn create(path: &Path, overwrite: bool) -> Result<Self, OutputError> {
        Self::begin(path, overwrite, false, None)
    }

    /// The same with its deck, which replaces that of a former run before anything of it is removed. `by_force` takes the lock from whoever has it.
    pub(crate) fn begin(path: &Path, overwrite: bool, by_force: bool, deck: Option<&str>) -> Result<Self, OutputError> {
        Self::check(path, overwrite)?;
        let overwrite = overwrite || Self::may_be_taken(path);
        let unwritable = |source| OutputError::Unwritable { path: path.to_owned(), source };
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(unwritable)?;
        }
        match fs::create_dir(path) {
            Ok(()) => {}
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && overwrite => {}
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                return Err(OutputError::Exists { path: path.to_owned() });
            }
            Err(e) => return Err(unwritable(e)),
        }
        let folder = Folder::open(path).map_err(unwritable)?;
        // Before anything is changed: may we write here at all, and does nothing of it lead elsewhere?
        drop(folder.unfinished().map_err(unwritable)?);
        match folder.inside(FIELDS) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            opened => drop(opened.map_err(|source| in_the_way(path, FIELDS, source))?),
        }
        let former = || Marked::read(&folder).map_or_else(Default::default, |marked| marked.names);
        let held = Held::take(folder.clone(), by_force, |folder| {
            // Killed from here on, the folder is that of the new run, and what the former one has left is still named.
            let mut marked = Marked { names: former(), ..Marked::new() };
            marked.names.insert(DECK.to_owned());
            Mark::write(folder, marked)
        })?;
        let directory = Self { path: path.to_owned(), held: Some(Arc::new(held)) };
        if let Some(deck) = deck {
            directory.write(DECK, Durability::Disk, |out| out.write_all(deck.as_bytes()))?;
        }
        directory.remove_former_run(deck.is_some()).map_err(unwritable)?;
        folder.make_inside(FIELDS).map_err(unwritable)?;
        Ok(directory)
    }

    /// Opens the folder of a run that is to go on. Nothing of the run is touched. `by_force` takes the lock from whoever has it.
    ///
    /// # Errors
    /// [`OutputError::Read`] if there is no such folder, [`OutputError::UnwritableRun`] if it cannot be written to, [`OutputError::Locked`] if
    /// another run writes to it.
    pub(crate) fn go_on(path: &Path, by_force: bool) -> Result<Self, OutputError> {
        let Self { path, .. } = Self::open(path)?;
        let unwritable = |source| OutputError::UnwritableRun { path: path.clone(), source };
        let folder = Folder::open(&path).map_err(unwritable)?;
        match folder.inside(FIELDS) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            opened => drop(opened.map_err(|source| in_the_way(&path, FIELDS, source))?),
        }
        let held = Held::take(folder, by_force, Mark::resumed).map_err(|error| match error {
            OutputError::Unwritable { source, .. } => unwritable(source),
            error => error,
        })?;
        Ok(Self { path, held: Some(Arc::new(held)) })
    }

    /// The folder, open, if it is still the one that the run writes to.
    fn folder(&self) -> Result<Folder, OutputError> {
        match &self.held {
            Some(held) => held.claim.check().cloned(),
            None => Folder::open(&self.path).writing(&self.path),
        }
    }

    /// The folder, open, as the run has begun to write to it.
    pub(crate) fn opened(&self) -> Result<Folder, OutputError> {
        match &self.held {
            Some(held) => Ok(held.claim.folder().clone()),
            None => Folder::open(&self.path).writing(&self.path),
        }
    }

    /// Fails where the folder was taken while a file was written, which so does not get its name.
    fn still_held(&self) -> io::Result<()> {
        self.held.as_ref().map_or(Ok(()), |held| held.claim.check().map(drop).map_err(io::Error::other))
    }

    /// Says that the folder is lost where that is why a file cannot be written: it may have been taken since it was looked at.
    pub(crate) fn explain<T>(&self, written: Result<T, OutputError>) -> Result<T, OutputError> {
        if let Some(held) = self.held.as_ref().filter(|_| matches!(written, Err(OutputError::Write { .. }))) {
            held.claim.check()?;
        }
        written
    }

    /// Notes a name that a run gives to a file, or with `/` at its end to a folder of files, before it is there.
    fn note_name(&self, name: &str) -> Result<(), OutputError> {
        match &self.held {
            Some(held) => held.mark.add(name).writing(&self.path.join(MARK)),
            None => Ok(()),
        }
    }

    /// Writes a file of the run, named relative to its folder. Readers see the former one until the new one is complete.
    ///
    /// # Errors
    /// [`OutputError::Lost`] if the folder is no longer the one that the run has begun to write to; [`OutputError::Write`].
    pub(crate) fn write(
        &self,
        name: &str,
        durability: Durability,
        content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
    ) -> Result<(), OutputError> {
        let folder = self.folder()?;
        self.note_name(name)?;
        let content = |out: &mut dyn Sink| content(out).and_then(|()| self.still_held());
        self.explain(folder.write(name, durability, content).writing(&self.path.join(name)))
    }

    /// The same, and the sum by which the file is known again.
    pub(crate) fn write_summed(
        &self,
        name: &str,
        durability: Durability,
        content: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
    ) -> Result<Sum, OutputError> {
        let folder = self.folder()?;
        self.note_name(name)?;
        let content = |out: &mut dyn Sink| content(out).and_then(|()| self.still_held());
        self.explain(folder.write_and(name, durability, content, sum_of).writing(&self.path.join(name)))
    }

    /// Whether a file is the one of this sum, which has at most so many bytes.
    pub(crate) fn has(&self, name: &str, sum: &Sum, most: u64) -> bool {
        self.opened().is_ok_and(|folder| sum_in(&folder, name, most).is_ok_and(|found| found == *sum))
    }

    /// The bytes of a file, of at most so many. Where it is a link, what that leads to is not read: it might be nothing to be shown here.
    pub(crate) fn read(&self, name: &str, most: u64) -> Result<Vec<u8>, OutputError> {
        let file = self.opened()?.open_file(name);
        file.and_then(|file| regular_file::read_all(file, most)).reading(&self.path.join(name))
    }

    /// Gives what has a name in the folder another one, whatever it is.
    pub(crate) fn rename(&self, name: &str, to: &str) -> Result<(), OutputError> {
        self.folder()?.rename(name, to).writing(&self.path.join(to))
    }

    /// Whether a file is these bytes.
    pub(crate) fn is_exactly(&self, name: &str, bytes: &[u8]) -> bool {
        let length = self.opened().and_then(|folder| folder.open_file(name).reading(&self.path.join(name)));
        let length = length.and_then(|file| file.metadata().reading(&self.path.join(name)));
        length.is_ok_and(|of| of.len() == bytes.len() as u64) && self.begins_with(name, bytes)
    }

    /// Whether a file begins with these bytes.
    pub(crate) fn begins_with(&self, name: &str, bytes: &[u8]) -> bool {
        let mut found = Vec::new();
        let file = self.opened().and_then(|folder| folder.open_file(name).reading(&self.path.join(name)));
        file.is_ok_and(|file| file.take(bytes.len() as u64).read_to_end(&mut found).is_ok()) && found == bytes
    }

    /// Whether a name is that of a file, or with `/` at its end of a folder of files, that the run of this folder has written.
    pub(crate) fn is_own(&self, name: &str) -> bool {
        self.held.as_ref().is_none_or(|held| held.mark.has(name))
    }

    /// Removes a file of the run.
    pub(crate) fn remove(&self, name: &str) -> Result<(), OutputError> {
        self.folder()?.remove_file(name).writing(&self.path.join(name))
    }

    /// Removes parts of checkpoints that no checkpoint names.
    pub(super) fn remove_parts_of_none(&self) -> Result<(), OutputError> {
        remove_parts_of_none(&self.folder()?, |name| self.is_own(name))
    }

    /// A folder for files of several processes, and how other processes are told of it.
    pub(super) fn share(&self, name: &str) -> Result<(Folder, Shared), OutputError> {
        let folder = self.folder()?;
        self.note_name(&format!("{name}/"))?;
        let run = std::path::absolute(&self.path).writing(&self.path)?;
        let session = self.held.as_ref().map(|held| held.claim.session().to_owned());
        Ok((folder, Shared { run, session }))
    }

    /// What tells the run from all others; nothing of a folder that is only read.
    pub(crate) fn run(&self) -> Option<String> {
        self.held.as_ref().map(|held| held.mark.run())
    }

    /// Takes the run of a checkpoint for that of the folder, if its mark is lost.
    pub(crate) fn adopt(&self, run: Option<&str>) {
        if let (Some(held), Some(run)) = (&self.held, run) {
            held.mark.adopt(run);
        }
    }

    /// Whether the folder says which run it is of.
    pub(crate) fn has_mark(&self) -> bool {
        self.held.as_ref().is_some_and(|held| held.mark.was_there())
    }

    /// Removes what the folder says of the end of its run, and what was left unfinished.
    pub(crate) fn clear_end(&self) -> Result<(), OutputError> {
        let (folder, fields) = (self.folder()?, self.path.join(FIELDS));
        folder.remove_file(SUMMARY).writing(&self.summary())?;
        folder.remove_matching(is_unfinished).writing(&self.path)?;
        let inside = folder.make_inside(FIELDS).writing(&fields)?;
        inside.remove_matching(is_unfinished).writing(&fields)?;
        for name in folders_of_pieces(&inside).writing(&fields)? {
            let pieces = inside.inside(&name).writing(&fields)?;
            pieces.remove_matching(is_unfinished).writing(&fields.join(name))?;
        }
        Ok(())
    }

    /// Whether there is anything that a run could go on from, or its mark.
    pub(crate) fn is_of_a_run(&self) -> bool {
        Self::is_run(&self.path) || self.has_checkpoint()
    }

    /// Whether there is a state the run can go on from.
    pub fn has_checkpoint(&self) -> bool {
        Self::has_checkpoint_in(&self.path)
    }

    /// The same of a path.
    pub(super) fn has_checkpoint_in(path: &Path) -> bool {
        fs::read_dir(path).is_ok_and(|mut entries| {
            entries.any(|entry| entry.is_ok_and(|entry| entry.file_name().to_str().is_some_and(is_checkpoint)))
        })
    }

    /// Removes frames of the run from this number on: their files first, so that none names pieces that there are no more.
    pub(crate) fn remove_frames(&self, from: usize) -> Result<(), OutputError> {
        let (folder, fields) = (self.folder()?, self.path.join(FIELDS));
        let remove = || {
            let is_late = |name: &str| frame_of(name).is_some_and(|index| index >= from);
            let inside = folder.make_inside(FIELDS)?;
            inside
                .remove_matching(|name| is_frame(name) && is_late(name) && self.is_own(&format!("{FIELDS}/{name}")))?;
            let late = folders_of_pieces(&inside)?.into_iter().filter(|name| is_late(name));
            let folders = late.map(|name| format!("{FIELDS}/{name}"));
            let mut own = folders.filter(|name| self.is_own(&format!("{name}/")));
            own.try_for_each(|name| remove_pieces(&folder, &name))
        };
        remove().writing(&fields)
    }

    /// Notes that a picture in the folder of pictures is one of this run, so that it goes with it. `name` has no folder.
    ///
    /// # Errors
    /// [`OutputError::InTheWay`] if the folder of pictures is a symbolic link, which is not followed; [`OutputError::Write`] if it cannot be made, or
    /// the mark of the run not be written to.
    pub(crate) fn note_picture(&self, name: &str) -> Result<(), OutputError> {
        let folder = Folder::open(&self.path).writing(&self.path)?;
        folder.make_inside(PLOTS).map_err(|source| match folder.inside(PLOTS) {
            Err(_) if folder.has(PLOTS) => in_the_way(&self.path, PLOTS, source),
            _ => OutputError::Write { path: self.plots(), source },
        })?;
        add_picture(&folder, name).writing(&self.path.join(MARK))
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }
    /// The deck as run.
    pub fn deck(&self) -> PathBuf {
        self.path.join(DECK)
    }
    /// The ParaView collection.
    pub fn series(&self) -> PathBuf {
        self.path.join(SERIES)
    }
    /// Frame `index`, one file or in pieces, relative to the folder, with `/` as in the collection.
    pub fn frame_name(index: usize, in_pieces: bool) -> String {
        let ending = if in_pieces { IN_PIECES } else { IN_ONE };
        format!("{FIELDS}/{index:06}{ending}")
    }
    /// Folder of the pieces of frame `index`, relative to the folder.
    pub(super) fn piece_folder(index: usize) -> String {
        format!("{FIELDS}/{index:06}")
    }
    /// Whether frame `index` was written in pieces.
    pub(crate) fn has_pieces(&self, index: usize) -> bool {
        self.path.join(Self::frame_name(index, true)).is_file()
    }
    /// The history.
    pub fn history(&self) -> PathBuf {
        self.path.join(HISTORY)
    }
    /// What the columns of the history are.
    pub fn history_columns(&self) -> PathBuf {
        self.path.join(COLUMNS)
    }
    /// The summary.
    pub fn summary(&self) -> PathBuf {
        self.path.join(SUMMARY)
    }
    /// Where pictures go unless told otherwise.
    pub fn plots(&self) -> PathBuf {
        self.path.join(PLOTS)
    }

    /// Removes what a former run has written, the summary first: without it a folder does not claim to be finished.
    fn remove_former_run(&self, keeps_deck: bool) -> io::Result<()> {
        let Some(held) = &self.held else { return Ok(()) };
        let (folder, mark) = (held.claim.folder(), &held.mark);
        let names = mark.names();
        let has_plots = folder.inside(PLOTS).is_ok();
        let is_removed = |name: &&String| match name.as_str() {
            DECK => !keeps_deck,
            // Pictures behind a link are not in this folder.
            name => has_plots || !name.starts_with(PLOTS),
        };
        let summary_first = |name: &&String| **name != SUMMARY;
        let mut removed: Vec<_> = names.iter().filter(is_removed).collect();
        removed.sort_by_key(summary_first);
        for name in &removed {
            match name.strip_suffix('/') {
                Some(pieces) if pieces.starts_with(FIELDS) => remove_pieces(folder, pieces)?,
                Some(parts) => remove_parts(folder, parts)?,
                None => folder.remove_file(name)?,
            }
        }
        folder.remove_matching(is_unfinished)?;
        for inside in [FIELDS, PLOTS] {
            if let Ok(inside) = folder.inside(inside) {
                inside.remove_matching(is_unfinished)?;
            }
        }
        if removed.is_empty() { Ok(()) } else { mark.forget(|name| name != DECK || !keeps_deck) }
    }
}

/// A folder that several processes of a run write to, as they are told of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Shared {
    run: PathBuf,
    session: Option<String>,
}

impl Shared {
    /// Of files that are only read.
    pub(super) fn read_only(run: PathBuf) -> Self {
        Self { run, session: None }
    }

    pub(super) fn path(&self) -> &Path {
        &self.run
    }

    /// Opens the folder, in which no other run may have begun since.
    pub(super) fn open(&self) -> Result<Folder, OutputError> {
        let folder = Folder::open(&self.run).writing(&self.run)?;
        // A file system may show the lock to other machines late.
        match &self.session {
            Some(session) if is_locked_by_another(&folder, session) => {
                Err(OutputError::Lost { path: self.run.clone(), reason: "another run has begun in it" })
            }
            _ => Ok(folder),
        }
    }
}

/// Says which name in a folder is in the way.
fn in_the_way(path: &Path, name: &'static str, source: io::Error) -> OutputError {
    OutputError::InTheWay { path: path.to_owned(), name, source }
}

/// A folder that is empty or that a run wrote.
fn is_run_or_empty(path: &Path) -> bool {
    Folder::open(path).is_ok_and(|folder| Marked::read(&folder).is_some() || is_empty(&folder))
}

/// Whether a folder has nothing in it but what a run or a validation that was killed at once may leave.
pub(crate) fn is_empty(folder: &Folder) -> bool {
    // As many entries as there are: of a name that is no text, too.
    let Ok(count) = fs::read_dir(folder.path()).map(Iterator::count) else { return false };
    folder.entries().is_ok_and(|found| found.len() == count && found.iter().all(|e| is_of_no_run_yet(folder, e)))
}

/// What a run that was killed before it had its mark may leave.
fn is_of_no_run_yet(folder: &Folder, (name, kind): &(String, Kind)) -> bool {
    match (name.as_str(), kind) {
        (FIELDS, Kind::Folder) => folder.inside(FIELDS).and_then(|fields| fields.entries()).is_ok_and(|e| e.is_empty()),
        (name, Kind::File) => name == LOCK || is_unfinished(name),
        _ => false,
    }
}

/// Number of the frame that a file is, or a folder holds the pieces of.
fn frame_of(name: &str) -> Option<usize> {
    let stem = name.strip_suffix(IN_PIECES).or_else(|| name.strip_suffix(IN_ONE)).unwrap_or(name);
    (stem.len() >= 6 && stem.bytes().all(|b| b.is_ascii_digit())).then(|| stem.parse().ok())?
}

/// Whether a file in the folder of frames has the name of one.
pub(super) fn is_frame(name: &str) -> bool {
    (name.ends_with(IN_ONE) || name.ends_with(IN_PIECES)) && frame_of(name).is_some()
}

/// Whether a folder in the folder of frames has the name of one that holds pieces.
pub(super) fn is_frame_folder(name: &str) -> bool {
    !name.contains('.') && frame_of(name).is_some()
}

/// Folders that hold pieces of frames.
fn folders_of_pieces(fields: &Folder) -> io::Result<Vec<String>> {
    let folders = fields.entries()?.into_iter().filter(|(name, kind)| *kind == Kind::Folder && is_frame_folder(name));
    Ok(folders.map(|(name, _)| name).collect())
}

/// The last part of a path.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Removes what was left unfinished in a folder and so many levels of folders in it.
pub(crate) fn remove_unfinished(folder: &Folder, levels: usize) -> io::Result<()> {
    folder.remove_matching(is_unfinished)?;
    if levels == 0 {
        return Ok(());
    }
    let inside = folder.entries()?.into_iter().filter(|(_, kind)| *kind == Kind::Folder);
    inside.map(|(name, _)| name).try_for_each(|name| remove_unfinished(&folder.inside(&name)?, levels - 1))
}

pub(super) fn is_unfinished(name: &str) -> bool {
    name.starts_with(UNFINISHED_PREFIX) && name.ends_with(UNFINISHED_SUFFIX)
}

#[cfg(test)]
mod tests;
