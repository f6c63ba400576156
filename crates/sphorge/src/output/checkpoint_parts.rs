//! Parts of a checkpoint: files that the processes of a run write side by side, each its own values.
//!
//! The first process has the checkpoint itself; part `k` of another one is `checkpoint-STEP-parts-XXXXXX/000k.zip` beside it. The folder has a name
//! that no other has, so that a checkpoint is never read with parts of another one of the same step, and the checkpoint that names it takes its own
//! name when all parts are on the disk.

use super::{
    atomic::{Durability, write_file},
    checkpoint::{PREFIX, PartsRecord, Values, Writer, checkpoints, parts_of},
    directory::name_of,
    error::{AtPath, OutputError},
    numbered::{numbered, remove_numbered},
};
use crate::engine::persist::{Archive, ArchiveError, Parts};
use serde::{Deserialize, Serialize};
use std::{
    fs, io,
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
    folder: PathBuf,
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
    pub(super) fn create(run: &Path, step: u64, count: usize) -> Result<Self, OutputError> {
        let run = std::path::absolute(run).writing(run)?;
        let prefix = format!("{PREFIX}{step:012}{PARTS}");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        #[cfg(unix)]
        {
            // As readable as any other folder of the user.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o777));
        }
        let folder = builder.tempdir_in(&run).writing(&run)?.keep();
        Ok(Self { folder, count })
    }

    /// The parts that a checkpoint names.
    pub(super) fn named(checkpoint: &Path, record: &PartsRecord) -> Result<Self, String> {
        let PartsRecord { folder, count } = record;
        if !is_parts_folder(folder) || !(1..=MOST).contains(count) {
            return Err(format!("it names {count} parts in `{folder}`, which is not possible"));
        }
        let run = std::path::absolute(checkpoint).map_err(|error| error.to_string())?;
        let parts = Self { folder: run.with_file_name(folder), count: *count };
        parts.request().map_err(|error| error.to_string())?;
        Ok(parts)
    }

    /// How a checkpoint names them.
    pub(super) fn record(&self) -> PartsRecord {
        PartsRecord { folder: name_of(&self.folder), count: self.count }
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
        write_file(&self.path(number), Durability::Disk, |out| {
            let mut writer = Writer::new(out);
            writer.add(ABOUT, &serde_json::to_vec_pretty(&self.about(number))?);
            state(&mut writer).map_err(io::Error::other)?;
            writer.finish()
        })
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
        AboutPart { folder: name_of(&self.folder), number, count: self.count }
    }

    fn path(&self, number: usize) -> PathBuf {
        self.folder.join(numbered(number, EXTENSION))
    }

    /// Removes the parts and their folder.
    pub(super) fn remove(&self) -> Result<(), OutputError> {
        remove_numbered(&self.folder, EXTENSION).writing(&self.folder)
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
fn folders(run: &Path) -> io::Result<Vec<PathBuf>> {
    let mut folders = Vec::new();
    for entry in fs::read_dir(run)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() && is_parts_folder(&name_of(&entry.path())) {
            folders.push(entry.path());
        }
    }
    Ok(folders)
}

/// Removes all parts in the folder of a run.
pub(super) fn remove_all_parts(run: &Path) -> io::Result<()> {
    folders(run)?.iter().try_for_each(|folder| remove_numbered(folder, EXTENSION))
}

/// Removes parts that no checkpoint names, as one that was not completed or was written anew leaves them.
pub(super) fn remove_parts_of_none(run: &Path) -> Result<(), OutputError> {
    let all = folders(run).reading(run)?;
    if all.is_empty() {
        return Ok(());
    }
    // A checkpoint that cannot be read may name any of its step.
    let mut named = Vec::new();
    for (step, checkpoint) in checkpoints(run)? {
        named.push(match parts_of(&checkpoint) {
            Ok(record) => record.map_or_else(String::new, |record| record.folder),
            Err(_) => format!("{PREFIX}{step:012}{PARTS}"),
        });
    }
    let is_named = |folder: &&PathBuf| named.iter().any(|name| !name.is_empty() && name_of(folder).starts_with(name));
    all.iter()
        .filter(|folder| !is_named(folder))
        .try_for_each(|folder| remove_numbered(folder, EXTENSION).writing(folder))
}
