//! The folder of a run: names in it, making it, replacing it.

use super::{
    atomic::{UNFINISHED_PREFIX, UNFINISHED_SUFFIX},
    checkpoint::is_checkpoint,
    checkpoint_parts::remove_all_parts,
    error::{AtPath, OutputError},
    pieces::remove_pieces,
    regular_file,
};
use crate::particles::FIELDS as FIELD_TABLE;
use std::{
    fs::{self, File, TryLockError},
    io::{self, Write},
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
/// Every file is written aside and renamed into place, so a reader sees a complete file or none.
#[derive(Clone, Debug)]
pub struct RunDirectory {
    path: PathBuf,
    /// Held by a run that writes to it, until the last copy of this is dropped.
    #[expect(dead_code, reason = "held, not read")]
    lock: Option<Arc<File>>,
}

/// Top-level files a run writes, the marks of a run folder first.
const MARKS: [&str; 4] = ["fields.pvd", "history.csv", "history-columns.json", "summary.json"];
const DECK: &str = "deck.toml";
const FIELDS: &str = "fields";
/// How frames end that are one file, and those that name pieces.
const IN_ONE: &str = ".vtp";
const IN_PIECES: &str = ".pvtp";
const PLOTS: &str = "plots";

impl RunDirectory {
    /// Names an existing run folder for reading.
    ///
    /// # Errors
    /// [`OutputError::Read`] if there is no such folder.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        if fs::metadata(path).reading(path)?.is_dir() {
            Ok(Self { path: path.to_owned(), lock: None })
        } else {
            Err(io::Error::new(io::ErrorKind::NotADirectory, "not a folder")).reading(path)
        }
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
            Ok(_) if !overwrite => Err(OutputError::Exists { path: path.to_owned() }),
            Ok(_) if is_run_or_empty(path) => Ok(()),
            Ok(_) => Err(OutputError::NotARun { path: path.to_owned() }),
        }
    }

    /// Makes the folder of a new run. With `overwrite`, the files of a former run in it are removed, and no others.
    ///
    /// # Errors
    /// [`OutputError::Exists`] if there is anything at `path` and `overwrite` is false; [`OutputError::NotARun`] if it is
    /// neither empty nor the folder of a run; [`OutputError::Unwritable`] if it cannot be made or written to.
    pub fn create(path: &Path, overwrite: bool) -> Result<Self, OutputError> {
        Self::check(path, overwrite)?;
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
        // Before anything is removed: may we write here at all?
        tempfile::Builder::new()
            .prefix(UNFINISHED_PREFIX)
            .suffix(UNFINISHED_SUFFIX)
            .tempfile_in(path)
            .map_err(unwritable)?;
        let directory = Self { path: path.to_owned(), lock: Some(lock(path)?) };
        directory.remove_former_run().map_err(unwritable)?;
        fs::create_dir_all(directory.path.join(FIELDS)).map_err(unwritable)?;
        Ok(directory)
    }

    /// Opens the folder of a run that is to go on. Nothing is touched.
    ///
    /// # Errors
    /// [`OutputError::Read`] if there is no such folder, [`OutputError::Unwritable`] if it cannot be written to, [`OutputError::Locked`] if
    /// another run writes to it.
    pub(crate) fn go_on(path: &Path) -> Result<Self, OutputError> {
        Ok(Self { path: Self::open(path)?.path, lock: Some(lock(path)?) })
    }

    /// Removes what the folder says of the end of its run, and what was left unfinished.
    pub(crate) fn clear_end(&self) -> Result<(), OutputError> {
        let (summary, fields) = (self.summary(), self.path.join(FIELDS));
        match fs::remove_file(&summary) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e).writing(&summary),
            _ => {}
        }
        fs::create_dir_all(&fields).writing(&fields)?;
        remove_matching(&self.path, is_unfinished).writing(&self.path)?;
        remove_matching(&fields, is_unfinished).writing(&fields)?;
        for folder in folders_of_pieces(&fields).writing(&fields)? {
            remove_matching(&folder, is_unfinished).writing(&folder)?;
        }
        Ok(())
    }

    /// Whether there is a state the run can go on from.
    pub fn has_checkpoint(&self) -> bool {
        fs::read_dir(&self.path).is_ok_and(|mut entries| {
            entries.any(|entry| entry.is_ok_and(|entry| entry.file_name().to_str().is_some_and(is_checkpoint)))
        })
    }

    /// Removes frames from this number on.
    pub(crate) fn remove_frames(&self, from: usize) -> Result<(), OutputError> {
        let fields = self.path.join(FIELDS);
        remove_frames(&fields, |index| index >= from).writing(&fields)
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
        self.path.join("fields.pvd")
    }
    /// Frame `index`, one file or in pieces, relative to the folder, with `/` as in the collection.
    pub fn frame_name(index: usize, in_pieces: bool) -> String {
        let ending = if in_pieces { IN_PIECES } else { IN_ONE };
        format!("{FIELDS}/{index:06}{ending}")
    }
    /// Whether frame `index` was written in pieces.
    pub(crate) fn has_pieces(&self, index: usize) -> bool {
        self.path.join(Self::frame_name(index, true)).is_file()
    }
    /// The history.
    pub fn history(&self) -> PathBuf {
        self.path.join("history.csv")
    }
    /// What the columns of the history are.
    pub fn history_columns(&self) -> PathBuf {
        self.path.join("history-columns.json")
    }
    /// The summary.
    pub fn summary(&self) -> PathBuf {
        self.path.join("summary.json")
    }
    /// Where pictures go unless told otherwise.
    pub fn plots(&self) -> PathBuf {
        self.path.join(PLOTS)
    }

    /// Removes what a run and its plots write, the summary first: without it a folder does not claim to be finished.
    fn remove_former_run(&self) -> io::Result<()> {
        for name in MARKS.iter().rev().chain([&DECK]) {
            match fs::remove_file(self.path.join(name)) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
                _ => {}
            }
        }
        remove_matching(&self.path, |name| is_unfinished(name) || is_checkpoint(name))?;
        remove_all_parts(&self.path)?;
        remove_frames(&self.path.join(FIELDS), |_| true)?;
        remove_matching(&self.path.join(FIELDS), is_unfinished)?;
        remove_matching(&self.path.join(PLOTS), |name| is_picture(name) || is_unfinished(name))
    }
}

/// Who writes to the folder.
const LOCK: &str = ".sphorge-lock";

/// Takes the lock of a folder, which the system gives back when the process ends, however it does; its file names the process. File systems
/// without locks go without.
fn lock(path: &Path) -> Result<Arc<File>, OutputError> {
    let unwritable = |source| OutputError::Unwritable { path: path.to_owned(), source };
    let name = path.join(LOCK);
    let file = File::options().read(true).write(true).create(true).truncate(false).open(&name).map_err(unwritable)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let owner = regular_file::read_to_string(&name).unwrap_or_default();
            Err(OutputError::Locked { path: path.to_owned(), owner: owner.trim().to_owned() })
        }
        Ok(()) | Err(TryLockError::Error(_)) => {
            let written = file.set_len(0).and_then(|()| writeln!(&file, "process {}", std::process::id()));
            written.map(|()| Arc::new(file)).map_err(unwritable)
        }
    }
}

/// A folder that is empty or that a run wrote.
fn is_run_or_empty(path: &Path) -> bool {
    let Ok(mut entries) = fs::read_dir(path) else { return false };
    entries.all(|entry| entry.is_ok_and(|entry| is_of_no_run_yet(&entry)))
        || MARKS.iter().any(|name| path.join(name).is_file())
        // A run that was killed before its first frame.
        || (path.join(DECK).is_file() && path.join(FIELDS).is_dir())
}

/// What a run that was killed before its deck was written may leave.
fn is_of_no_run_yet(entry: &fs::DirEntry) -> bool {
    let is_empty = |folder: &Path| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    match entry.file_name().to_str() {
        Some(FIELDS) => is_empty(&entry.path()),
        Some(name) => name == LOCK || is_unfinished(name),
        None => false,
    }
}

/// Number of the frame that a file is, or a folder holds the pieces of.
fn frame_of(name: &str) -> Option<usize> {
    let stem = name.strip_suffix(IN_PIECES).or_else(|| name.strip_suffix(IN_ONE)).unwrap_or(name);
    (stem.len() >= 6 && stem.bytes().all(|b| b.is_ascii_digit())).then(|| stem.parse().ok())?
}

/// Removes the frames of some numbers: their files first, so that none names pieces that there are no more.
fn remove_frames(fields: &Path, are_removed: impl Fn(usize) -> bool) -> io::Result<()> {
    let is_removed = |name: &str| frame_of(name).is_some_and(&are_removed);
    remove_matching(fields, |name| name.ends_with("vtp") && is_removed(name))?;
    for folder in folders_of_pieces(fields)?.into_iter().filter(|folder| is_removed(&name_of(folder))) {
        remove_pieces(&folder)?;
    }
    Ok(())
}

/// Folders that hold pieces of frames.
fn folders_of_pieces(fields: &Path) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(fields) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other?,
    };
    let mut folders = Vec::new();
    for entry in entries {
        let entry = entry?;
        if entry.file_type()?.is_dir() && frame_of(&name_of(&entry.path())).is_some() {
            folders.push(entry.path());
        }
    }
    Ok(folders)
}

/// The last part of a path.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A picture under a name that plotting gives: the field or the kind of history first.
fn is_picture(name: &str) -> bool {
    let ours = |prefix: &str| name.strip_prefix(prefix).is_some_and(|rest| rest.starts_with(['.', '-']));
    [".png", ".svg"].iter().any(|ending| name.ends_with(ending))
        && (ours("history") || FIELD_TABLE.iter().any(|field| ours(field.name)))
}

pub(super) fn is_unfinished(name: &str) -> bool {
    name.starts_with(UNFINISHED_PREFIX) && name.ends_with(UNFINISHED_SUFFIX)
}

pub(super) fn remove_matching(folder: &Path, ours: impl Fn(&str) -> bool) -> io::Result<()> {
    let entries = match fs::read_dir(folder) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        other => other?,
    };
    for entry in entries {
        let entry = entry?;
        if entry.file_name().to_str().is_some_and(&ours) && !entry.file_type()?.is_dir() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn an_existing_folder_is_refused_untouched() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("summary.json"), "old").unwrap();
        let refused = RunDirectory::create(folder.path(), false);
        assert!(matches!(refused, Err(OutputError::Exists { .. })));
        assert_eq!(names(folder.path()), ["summary.json"]);
    }

    #[test]
    fn overwriting_removes_the_former_run_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir(root.join("fields")).unwrap();
        fs::create_dir(root.join("plots")).unwrap();
        let ours =
            ["summary.json", "deck.toml", "fields/000003.vtp", "plots/history-energy.svg", "plots/pressure-last.png"];
        let foreign = ["notes.txt", "fields/mine.vtp", "fields/000003.txt", "plots/paper.png", "plots/sketch.svg"];
        for name in ours.iter().chain(&foreign) {
            fs::write(root.join(name), "x").unwrap();
        }
        RunDirectory::create(root, true).unwrap();
        assert_eq!(names(root), [".sphorge-lock", "fields", "notes.txt", "plots"]);
        assert_eq!(names(&root.join("fields")), ["000003.txt", "mine.vtp"]);
        assert_eq!(names(&root.join("plots")), ["paper.png", "sketch.svg"]);
    }

    #[test]
    fn what_was_killed_before_its_deck_was_written_is_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir(root.join("fields")).unwrap();
        for name in [".sphorge-lock", ".sphorge-a1.unfinished"] {
            fs::write(root.join(name), "").unwrap();
        }
        drop(RunDirectory::create(root, true).unwrap());
        fs::write(root.join("fields/mine.vtp"), "").unwrap();
        assert!(matches!(RunDirectory::create(root, true), Err(OutputError::NotARun { .. })));
    }

    #[test]
    fn two_runs_do_not_write_into_one_folder() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("run");
        let first = RunDirectory::create(&root, false).unwrap();
        fs::write(root.join("summary.json"), "first").unwrap();
        for refused in [RunDirectory::create(&root, true), RunDirectory::go_on(&root)] {
            let Err(OutputError::Locked { owner, .. }) = refused else { panic!("{refused:?}") };
            assert_eq!(owner, format!("process {}", std::process::id()));
        }
        assert_eq!(fs::read_to_string(root.join("summary.json")).unwrap(), "first");
        drop(first);
        RunDirectory::create(&root, true).unwrap();
    }

    #[test]
    fn a_run_that_goes_on_keeps_the_frames_it_had() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir(root.join("fields")).unwrap();
        for name in ["summary.json", "fields/000001.vtp", "fields/000002.vtp", "fields/000003.vtp", "fields/mine.vtp"] {
            fs::write(root.join(name), "x").unwrap();
        }
        let directory = RunDirectory::go_on(root).unwrap();
        assert!(directory.summary().exists() && !directory.has_checkpoint());
        directory.clear_end().unwrap();
        directory.remove_frames(2).unwrap();
        assert_eq!(names(&root.join("fields")), ["000001.vtp", "mine.vtp"]);
        assert_eq!(names(root), [".sphorge-lock", "fields"]);
    }

    #[test]
    fn a_folder_that_is_no_run_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("deck.toml"), "the only copy").unwrap();
        assert!(matches!(RunDirectory::create(folder.path(), true), Err(OutputError::NotARun { .. })));
        assert_eq!(names(folder.path()), ["deck.toml"]);
        let file = folder.path().join("deck.toml");
        assert!(matches!(RunDirectory::create(&file, true), Err(OutputError::NotARun { .. })));
    }

    #[test]
    fn missing_parents_are_made_and_a_file_in_the_way_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        RunDirectory::create(&folder.path().join("a/b/c"), false).unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        let blocked = RunDirectory::create(&folder.path().join("file/run"), false);
        assert!(matches!(blocked, Err(OutputError::Unwritable { .. })), "{blocked:?}");
    }
}
