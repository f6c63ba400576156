//! Parts of a checkpoint: files that the processes of a run write side by side, each its own values.
//!
//! The first process has the checkpoint itself; part `k` of another one is `checkpoint-STEP-parts-XXXXXX/000k.zip` beside it. The folder has a name
//! that no other has, so that a checkpoint is never read with parts of another one of the same step, and the checkpoint that names it takes its own
//! name when all parts are on the disk.

use super::{
    RunDirectory,
    atomic::Durability,
    checkpoint::{PREFIX, PartsRecord, Values, Writer, checkpoints, parts_of},
    directory::Shared,
    error::{AtPath, OutputError},
    folder::{Folder, Kind, random_name},
    numbered::{numbered, remove_numbered},
};
use crate::engine::persist::{Archive, ArchiveError, Parts};
use serde::{Deserialize, Serialize};
use std::{
    io,
    ops::Range,
    path::{Path, PathBuf},
};

/// How files of parts end.
const EXTENSION: &str = "zip";
/// What a part says of itself.
const ABOUT: &str = "part.json";
/// Between the step and what makes the name of the folder its own.
const PARTS: &str = "-parts-";
/// Parts at most: ranks there may be.
const MOST: usize = 1 << 20;

/// The parts of one checkpoint.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct PartSet {
    /// Folder of the run.
    run: Shared,
    /// Folder of the parts in it.
    folder: String,
    count: usize,
}

/// Of which set a part is, and which of it.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct AboutPart {
    folder: String,
    number: usize,
    count: usize,
}

impl PartSet {
    /// Makes a folder for so many parts of a checkpoint in the folder of a run.
    pub(super) fn create(directory: &RunDirectory, step: u64, count: usize) -> Result<Self, OutputError> {
        let name = format!("{PREFIX}{step:012}{PARTS}{}", random_name());
        let (folder, run) = directory.share(&name)?;
        folder.make_new(&name).writing(&directory.path().join(&name))?;
        Ok(Self { run, folder: name, count })
    }

    /// The parts that a checkpoint names.
    pub(super) fn named(checkpoint: &Path, record: &PartsRecord) -> Result<Self, String> {
        let PartsRecord { folder, count } = record;
        if !is_parts_folder(folder) || !(1..=MOST).contains(count) {
            return Err(format!("it names {count} parts in `{folder}`, which is not possible"));
        }
        let run = std::path::absolute(checkpoint).map_err(|error| error.to_string())?;
        let run = run.parent().unwrap_or(Path::new("")).to_owned();
        let parts = Self { run: Shared::read_only(run), folder: folder.clone(), count: *count };
        parts.request().map_err(|error| error.to_string())?;
        Ok(parts)
    }

    /// How a checkpoint names them.
    pub(super) fn record(&self) -> PartsRecord {
        PartsRecord { folder: self.folder.clone(), count: self.count }
    }

    /// How other processes are told of them.
    ///
    /// # Errors
    /// Its folder has a name that is no text.
    pub(super) fn request(&self) -> io::Result<Parts> {
        serde_json::to_string(self).map(Parts::Files).map_err(io::Error::other)
    }

    /// Understands what a process is told.
    pub(crate) fn read(request: &str) -> Result<Self, String> {
        serde_json::from_str(request).map_err(|error| error.to_string())
    }

    /// Writes the part of the process of this number, whose values `state` saves.
    pub(crate) fn write(
        &self,
        number: usize,
        state: &mut dyn FnMut(&mut dyn Archive) -> Result<(), ArchiveError>,
    ) -> Result<(), OutputError> {
        let written = self.run.open()?.write(&self.name(number), Durability::Disk, |out| {
            let mut writer = Writer::new(out);
            writer.add(ABOUT, &serde_json::to_vec_pretty(&self.about(number))?);
            state(&mut writer).map_err(io::Error::other)?;
            writer.finish()
        });
        written.writing(&self.path(number))
    }

    /// Opens the parts, but for the first one, that a process of so many is to read, each of them whole.
    pub(super) fn open(&self, process: usize, processes: usize) -> Result<Vec<Values>, OutputError> {
        self.of_process(process, processes).filter(|number| *number > 0).map(|number| self.open_part(number)).collect()
    }

    /// The same as an archive.
    pub(crate) fn archive(&self, process: usize, processes: usize) -> Result<Box<dyn Archive>, OutputError> {
        Ok(Box::new(SomeParts(self.open(process, processes)?)))
    }

    /// Parts of a process: consecutive ones, as many as of any other or one less, the first with the first process.
    fn of_process(&self, process: usize, processes: usize) -> Range<usize> {
        let start = |process: usize| (process * self.count).div_ceil(processes);
        start(process)..start(process + 1)
    }

    fn open_part(&self, number: usize) -> Result<Values, OutputError> {
        let path = self.path(number);
        let mut values = Values::open(&path)?;
        let about = values.read(ABOUT).ok().and_then(|about| serde_json::from_slice::<AboutPart>(&about).ok());
        match about {
            Some(about) if about == self.about(number) => Ok(values),
            _ => Err(OutputError::damaged(&path, "it belongs to another checkpoint")),
        }
    }

    fn about(&self, number: usize) -> AboutPart {
        AboutPart { folder: self.folder.clone(), number, count: self.count }
    }

    /// Name of a part in the folder of the run.
    fn name(&self, number: usize) -> String {
        format!("{}/{}", self.folder, numbered(number, EXTENSION))
    }

    fn path(&self, number: usize) -> PathBuf {
        self.run.path().join(self.name(number))
    }

    /// Removes the parts and their folder.
    pub(super) fn remove(&self) -> Result<(), OutputError> {
        remove_parts(&self.run.open()?, &self.folder).writing(&self.run.path().join(&self.folder))
    }
}

/// Parts, one behind the other.
struct SomeParts(Vec<Values>);

impl Archive for SomeParts {
    fn is_saving(&self) -> bool {
        false
    }
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        let mut bytes = Vec::new();
        self.0.iter_mut().try_for_each(|part| part.append(name, &mut bytes))?;
        Ok(bytes)
    }
}

/// Whether a folder has the name of one that holds parts.
pub(super) fn is_parts_folder(name: &str) -> bool {
    let parts = name.strip_prefix(PREFIX).and_then(|rest| rest.split_once(PARTS));
    parts.is_some_and(|(step, own)| {
        step.len() >= 12
            && step.bytes().all(|b| b.is_ascii_digit())
            && !own.is_empty()
            && own.bytes().all(|b| b.is_ascii_alphanumeric())
    })
}

/// Folders of parts in the folder of a run.
fn folders(run: &Folder) -> io::Result<Vec<String>> {
    let folders = run.entries()?.into_iter().filter(|(name, kind)| *kind == Kind::Folder && is_parts_folder(name));
    Ok(folders.map(|(name, _)| name).collect())
}

/// Removes a folder of parts with the parts that are in it.
pub(super) fn remove_parts(run: &Folder, name: &str) -> io::Result<()> {
    remove_numbered(run, name, EXTENSION)
}

/// Removes parts that no checkpoint names, as one that was not completed or was written anew leaves them, if they are of this run.
pub(super) fn remove_parts_of_none(run: &Folder, is_own: impl Fn(&str) -> bool) -> Result<(), OutputError> {
    let mut all = folders(run).reading(run.path())?;
    all.retain(|folder| is_own(&format!("{folder}/")));
    if all.is_empty() {
        return Ok(());
    }
    // A checkpoint that cannot be read may name any of its step.
    let mut named = Vec::new();
    for (step, checkpoint) in checkpoints(run.path())? {
        named.push(match parts_of(&checkpoint) {
            Ok(record) => record.map_or_else(String::new, |record| record.folder),
            Err(_) => format!("{PREFIX}{step:012}{PARTS}"),
        });
    }
    let is_named = |folder: &&String| named.iter().any(|name| !name.is_empty() && folder.starts_with(name));
    all.iter()
        .filter(|folder| !is_named(folder))
        .try_for_each(|folder| remove_parts(run, folder).writing(&run.path().join(folder)))
}
