//! Checkpoints: the whole state of a run in one file, from which it goes on to the same bits.
//!
//! A checkpoint is a ZIP file without compression. `checkpoint.json` says what it is, `deck.toml` is the deck as run, and every other
//! entry is one value of [`crate::engine::persist`] under its name, in little-endian bytes. The last entry is the SHA-256 sum of all others,
//! and the directory of a ZIP file stands at its end, so that what is torn, cut short or changed is recognised before anything is loaded. Like
//! every file of a run it is written aside and renamed into place.
//!
//! A sum tells of damage, and of changes by who does not know of it. Whoever writes the sum anew can change a checkpoint at will: values that no
//! state can have are refused, others are used.
//!
//! Of a run on many processes it holds what the first one has, and names the files of the others ([`super::checkpoint_parts`]), which are there
//! before it is.

use super::{
    RunDirectory,
    atomic::{Durability, Sink},
    checkpoint_parts::PartSet,
    directory::name_of,
    error::{AtPath, OutputError},
    regular_file,
    sum::hexadecimal,
};
use crate::{
    deck::without_driven_mark,
    engine::persist::{Archive, ArchiveError, Parts},
};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{self, BufReader, Read, Write},
    path::{Path, PathBuf},
};
use zip::{CompressionMethod, ZipArchive, ZipWriter, write::SimpleFileOptions, write::StreamWriter};

/// Version of the format of checkpoints; that of the values in it is the program's.
const FORMAT: u32 = 3;
/// The same of those in parts.
const FORMAT_IN_PARTS: u32 = 4;
/// Checkpoints that are kept.
const KEPT: usize = 2;

const ABOUT: &str = "checkpoint.json";
const DECK: &str = "deck.toml";
const STATE: &str = "state/";
/// The last entry: sum of all others, in hexadecimal digits.
const SUM: &str = "sha256";
pub(super) const PREFIX: &str = "checkpoint-";
const SUFFIX: &str = ".zip";

/// What a checkpoint says of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct About {
    format: u32,
    /// Of the program that wrote it.
    pub(crate) version: String,
    /// Name of the engine.
    pub(crate) engine: String,
    /// Name of the deck.
    pub(crate) deck_name: String,
    pub(crate) step: u64,
    /// s.
    pub(crate) time: f64,
    /// The run it is of, as the mark of its folder names it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) run: Option<String>,
    /// The deck of the folder it was written to, where that was still to become its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) changed_from: Option<String>,
    /// Sums of the particles of bodies that are listed in files, by the names of the bodies.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) listed: BTreeMap<String, String>,
    /// Where the parts of other processes are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parts: Option<PartsRecord>,
}

/// The parts of a checkpoint, the first of which is the checkpoint itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PartsRecord {
    /// Folder beside the checkpoint.
    pub(super) folder: String,
    pub(super) count: usize,
}

impl About {
    pub(crate) fn new(engine: &str, deck_name: &str, step: u64, time: f64) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let (engine, deck_name) = (engine.to_owned(), deck_name.to_owned());
        let (run, changed_from, parts) = (None, None, None);
        Self {
            format: FORMAT,
            version,
            engine,
            deck_name,
            step,
            time,
            run,
            changed_from,
            listed: BTreeMap::new(),
            parts,
        }
    }
}

/// Writes a checkpoint, of which `state` saves all values, in parts where so many processes share the run. `None` where the engine keeps its state
/// to itself.
pub(crate) fn write_checkpoint(
    directory: &RunDirectory,
    about: &About,
    deck: &str,
    processes: usize,
    state: impl FnOnce(&mut dyn Archive) -> Result<(), ArchiveError>,
) -> Result<Option<PathBuf>, OutputError> {
    let name = format!("{PREFIX}{:012}{SUFFIX}", about.step);
    let parts = if processes > 1 { Some(PartSet::create(directory, about.step, processes)?) } else { None };
    let about = About { run: directory.run(), ..about.clone() };
    let about = match &parts {
        Some(parts) => About { format: FORMAT_IN_PARTS, parts: Some(parts.record()), ..about },
        None => about,
    };
    let mut unsupported = false;
    let written = directory.write(&name, Durability::Disk, |out| {
        let mut writer = Writer::new(out);
        writer.parts = parts.as_ref().map(PartSet::request).transpose()?;
        writer.add(ABOUT, &serde_json::to_vec_pretty(&about)?);
        writer.add(DECK, deck.as_bytes());
        if let Err(error) = state(&mut writer) {
            unsupported = matches!(error, ArchiveError::Unsupported(_));
            return Err(io::Error::other(error));
        }
        writer.finish()
    });
    if let Some(parts) = parts.filter(|_| written.is_err()) {
        // What went wrong with the checkpoint is told; parts of none are removed with the next one, too.
        let _ = parts.remove();
    }
    if unsupported {
        return Ok(None);
    }
    written?;
    Ok(Some(directory.path().join(name)))
}

/// Removes the checkpoints of the run before the last two, and parts that are of none.
pub(crate) fn remove_former_checkpoints(directory: &RunDirectory) -> Result<(), OutputError> {
    let names = checkpoints(directory.path())?.into_iter().map(|(_, path)| name_of(&path));
    for former in names.filter(|name| directory.is_own(name)).skip(KEPT) {
        directory.remove(&former)?;
    }
    directory.remove_parts_of_none()
}

/// The parts of the checkpoint in a file; an error where it cannot be understood.
pub(super) fn parts_of(path: &Path) -> Result<Option<PartsRecord>, OutputError> {
    let damaged = |error: &dyn std::fmt::Display| OutputError::damaged(path, error.to_string());
    let file = BufReader::new(regular_file::open(path).reading(path)?);
    let about = read(&mut ZipArchive::new(file).map_err(|error| damaged(&error))?, ABOUT);
    let about: About =
        serde_json::from_slice(&about.map_err(|error| damaged(&error))?).map_err(|error| damaged(&error))?;
    Ok(about.parts)
}

impl Checkpoint {
    /// Whether the run in a folder is another one, as far as both say which they are.
    pub(crate) fn is_of_another_run(&self, directory: &RunDirectory) -> bool {
        directory.has_mark() && self.about.run.is_some() && self.about.run != directory.run()
    }

    /// Whether it is of the run in a folder with that deck.
    pub(crate) fn is_of(&self, deck: &str) -> bool {
        // The deck says that a program drives the run from its first load on, which may come later than the checkpoint.
        let is = |known: &str| without_driven_mark(known) == without_driven_mark(deck);
        is(&self.deck) || self.about.changed_from.as_deref().is_some_and(is)
    }
}

/// The checkpoints in a folder with their steps, the last one first.
pub(crate) fn checkpoints(folder: &Path) -> Result<Vec<(u64, PathBuf)>, OutputError> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).reading(folder)? {
        let entry = entry.reading(folder)?;
        if let Some(step) = entry.file_name().to_str().and_then(step_of) {
            found.push((step, entry.path()));
        }
    }
    found.sort_by_key(|(step, _)| std::cmp::Reverse(*step));
    Ok(found)
}

/// The step in the name of a checkpoint.
fn step_of(name: &str) -> Option<u64> {
    let digits = name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
    (digits.len() >= 12 && digits.bytes().all(|b| b.is_ascii_digit())).then(|| digits.parse().ok())?
}

/// Whether a file has the name of a checkpoint.
pub(crate) fn is_checkpoint(name: &str) -> bool {
    step_of(name).is_some()
}

/// Writes values into a file.
pub(super) struct Writer<'a> {
    zip: ZipWriter<StreamWriter<&'a mut dyn Sink>>,
    sum: Sha256,
    failure: Option<io::Error>,
    parts: Option<Parts>,
}

impl<'a> Writer<'a> {
    pub(super) fn new(out: &'a mut dyn Sink) -> Self {
        Self { zip: ZipWriter::new_stream(out), sum: Sha256::new(), failure: None, parts: None }
    }

    pub(super) fn add(&mut self, name: &str, bytes: &[u8]) {
        if self.failure.is_none() {
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Stored)
                .large_file(bytes.len() as u64 >= u64::from(u32::MAX));
            add_entry(&mut self.sum, name, bytes.len() as u64);
            self.sum.update(bytes);
            let started = self.zip.start_file(name, options).map_err(io::Error::other);
            self.failure = started.and_then(|()| self.zip.write_all(bytes)).err();
        }
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        let sum = hexadecimal(&self.sum.clone().finalize());
        self.add(SUM, sum.as_bytes());
        match self.failure {
            Some(error) => Err(error),
            None => self.zip.finish().map(drop).map_err(io::Error::other),
        }
    }
}

impl Archive for Writer<'_> {
    fn is_saving(&self) -> bool {
        true
    }
    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        self.add(&format!("{STATE}{name}"), &bytes);
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        Err(ArchiveError::Missing(name.to_owned()))
    }
    fn parts(&self) -> Option<Parts> {
        self.parts.clone()
    }
}

/// Takes an entry into the sum, before its bytes: where it begins and ends is part of it.
fn add_entry(sum: &mut Sha256, name: &str, length: u64) {
    sum.update((name.len() as u64).to_le_bytes());
    sum.update(name.as_bytes());
    sum.update(length.to_le_bytes());
}

/// Takes what is written to it into a sum.
struct Summed<'a>(&'a mut Sha256);

impl Write for Summed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A file of values that is whole.
pub(super) struct Values(ZipArchive<BufReader<File>>);

impl Values {
    /// Opens a file and reads it through, so that what is not whole is found before any of it is used.
    pub(super) fn open(path: &Path) -> Result<Self, OutputError> {
        let damaged = |error: &dyn std::fmt::Display| OutputError::damaged(path, error.to_string());
        let file = BufReader::with_capacity(1 << 17, regular_file::open(path).reading(path)?);
        let file_bytes = file.get_ref().metadata().reading(path)?.len();
        let mut zip = ZipArchive::new(file).map_err(|error| damaged(&error))?;
        check_sizes(&mut zip, file_bytes).map_err(|reason| damaged(&reason))?;
        let mut sum = Sha256::new();
        for index in 0..zip.len() {
            let mut entry = zip.by_index(index).map_err(|error| damaged(&error))?;
            let name = entry.name().map_err(|error| damaged(&error))?.into_owned();
            if name != SUM {
                add_entry(&mut sum, &name, entry.size());
                io::copy(&mut entry, &mut Summed(&mut sum)).map_err(|error| damaged(&error))?;
            }
        }
        match read(&mut zip, SUM) {
            Ok(told) if told == hexadecimal(&sum.finalize()).as_bytes() => Ok(Self(zip)),
            Ok(_) => Err(damaged(&"its SHA-256 sum is another")),
            Err(_) => Err(damaged(&"it has no SHA-256 sum")),
        }
    }

    /// The bytes of an entry.
    pub(super) fn read(&mut self, name: &str) -> io::Result<Vec<u8>> {
        read(&mut self.0, name)
    }

    /// A value of the state, behind what is there already.
    pub(super) fn append(&mut self, name: &str, bytes: &mut Vec<u8>) -> Result<(), ArchiveError> {
        let missing = |_| ArchiveError::Missing(name.to_owned());
        let mut entry = self.0.by_name(&format!("{STATE}{name}")).map_err(missing)?;
        entry.read_to_end(bytes).map(drop).map_err(|_| ArchiveError::Missing(name.to_owned()))
    }

    /// Whether the state has a value of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.0.index_for_name(&format!("{STATE}{name}")).is_some()
    }
}

/// A checkpoint that is whole.
pub(crate) struct Checkpoint {
    values: Values,
    pub(crate) about: About,
    pub(crate) deck: String,
    parts: Option<PartSet>,
    /// Those that this process reads beside the first.
    others: Vec<Values>,
}

impl Checkpoint {
    /// Opens a checkpoint that is whole, but for its parts.
    ///
    /// # Errors
    /// It cannot be read, is damaged, or of another version of the format.
    pub(crate) fn open(path: &Path) -> Result<Self, OutputError> {
        let damaged = |error: &dyn std::fmt::Display| OutputError::damaged(path, error.to_string());
        let mut values = Values::open(path)?;
        let about = values.read(ABOUT).map_err(|error| damaged(&error))?;
        let about: About = serde_json::from_slice(&about).map_err(|error| damaged(&error))?;
        let known = if about.parts.is_some() { FORMAT_IN_PARTS } else { FORMAT };
        if about.format != known {
            return Err(damaged(&format!("its format is {}, this program reads {known}", about.format)));
        }
        let parts = match &about.parts {
            Some(record) => Some(PartSet::named(path, record).map_err(|reason| damaged(&reason))?),
            None => None,
        };
        let deck = values.read(DECK).map_err(|error| damaged(&error))?;
        let deck = String::from_utf8(deck).map_err(|error| damaged(&error))?;
        Ok(Self { values, about, deck, parts, others: Vec::new() })
    }

    /// Opens the parts that the first of so many processes is to read: all, if it is the only one.
    ///
    /// # Errors
    /// One of them is not there, not whole, or of another checkpoint.
    pub(crate) fn open_parts(&mut self, processes: usize) -> Result<(), OutputError> {
        if let Some(parts) = &self.parts {
            self.others = parts.open(0, processes)?;
        }
        Ok(())
    }
}

/// Refuses entries that hold more than there is: what they take to read, in memory and time, is bounded by the length of the file then.
fn check_sizes(zip: &mut ZipArchive<BufReader<File>>, file_bytes: u64) -> Result<(), String> {
    let mut bytes = 0u64;
    for index in 0..zip.len() {
        let entry = zip.by_index_raw(index).map_err(|error| error.to_string())?;
        if entry.compression() != CompressionMethod::Stored || entry.compressed_size() != entry.size() {
            return Err("a value in it is compressed, which checkpoints never are".to_owned());
        }
        bytes = bytes.saturating_add(entry.size());
        if bytes > file_bytes {
            return Err(format!("its values take more than the {file_bytes} bytes of the file"));
        }
    }
    Ok(())
}

/// The bytes of an entry.
fn read(zip: &mut ZipArchive<BufReader<File>>, name: &str) -> io::Result<Vec<u8>> {
    let mut entry = zip.by_name(name).map_err(io::Error::other)?;
    let mut bytes = Vec::new();
    entry.read_to_end(&mut bytes)?;
    Ok(bytes)
}

impl Archive for Checkpoint {
    fn is_saving(&self) -> bool {
        false
    }
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        let mut bytes = Vec::new();
        self.values.append(name, &mut bytes)?;
        // What is the same on all ranks is in the first part alone, pieces are in all.
        let others = self.others.iter_mut().filter(|part| part.has(name));
        for part in others {
            part.append(name, &mut bytes)?;
        }
        Ok(bytes)
    }
    fn parts(&self) -> Option<Parts> {
        // That it can be told was seen when it was opened.
        self.parts.as_ref().and_then(|parts| parts.request().ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::persist::Persist;

    /// Column of a state.
    fn column() -> Vec<f64> {
        (0..1000).map(|i| f64::from(i).sin()).collect()
    }

    fn written(folder: &Path, mut step: u64) -> PathBuf {
        let directory = RunDirectory::at(folder);
        let about = About::new("cpu", "bar", step, 1e-6);
        let state = |archive: &mut dyn Archive| {
            column().persist("column", archive)?;
            step.persist("clock.steps", archive)
        };
        write_checkpoint(&directory, &about, "title = \"A bar\"\n", 1, state).unwrap().unwrap()
    }

    #[test]
    fn what_is_written_is_read_and_the_last_two_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        for step in [7, 90, 100_000] {
            written(folder.path(), step);
            remove_former_checkpoints(&RunDirectory::at(folder.path())).unwrap();
        }
        let kept = checkpoints(folder.path()).unwrap();
        assert_eq!(kept.iter().map(|(step, _)| *step).collect::<Vec<_>>(), [100_000, 90]);
        let mut checkpoint = Checkpoint::open(&kept[0].1).unwrap();
        assert_eq!((checkpoint.about.step, checkpoint.deck.as_str()), (100_000, "title = \"A bar\"\n"));
        let (mut loaded, mut step) = (Vec::<f64>::new(), 0u64);
        loaded.persist("column", &mut checkpoint).unwrap();
        step.persist("clock.steps", &mut checkpoint).unwrap();
        assert_eq!((loaded, step), (column(), 100_000));
        assert_eq!(step.persist("clock", &mut checkpoint), Err(ArchiveError::Missing("clock".into())));
    }

    #[test]
    fn what_is_cut_short_or_changed_anywhere_is_recognised_or_does_not_matter() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), 12);
        let whole = fs::read(&path).unwrap();
        for length in [0, 1, 100, whole.len() / 2, whole.len() - 1] {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(Checkpoint::open(&path).is_err(), "cut to {length}");
        }
        let mut recognised = 0;
        for at in (0..whole.len()).step_by(7) {
            let mut changed = whole.clone();
            changed[at] ^= 0x10;
            fs::write(&path, &changed).unwrap();
            // What is opened all the same, as times of entries may be changed, holds what was written.
            match Checkpoint::open(&path) {
                Err(_) => recognised += 1,
                Ok(mut checkpoint) => {
                    let mut loaded = Vec::<f64>::new();
                    if loaded.persist("column", &mut checkpoint).is_ok() {
                        assert_eq!(loaded, column(), "byte {at}");
                    }
                }
            }
        }
        assert!(recognised > whole.len() / 7 * 9 / 10, "{recognised} of {}", whole.len() / 7);
    }

    /// Why a file is no checkpoint.
    fn refused(path: &Path, bytes: &[u8]) -> String {
        fs::write(path, bytes).unwrap();
        match Checkpoint::open(path) {
            Err(OutputError::Damaged { reason, .. }) => reason,
            Err(error) => panic!("{error}"),
            Ok(_) => panic!("it is opened"),
        }
    }

    /// Changes the bytes at `at` behind the last `mark`.
    fn with_bytes(file: &[u8], mark: &[u8], at: usize, bytes: &[u8]) -> Vec<u8> {
        let place = file.windows(mark.len()).rposition(|w| w == mark).unwrap() + at;
        let mut changed = file.to_vec();
        changed[place..place + bytes.len()].copy_from_slice(bytes);
        changed
    }

    #[test]
    fn what_promises_more_than_the_file_holds_is_refused_before_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), 12);
        let whole = fs::read(&path).unwrap();
        // Fields of the directory of a ZIP file and of its end: method, sizes, number of entries.
        let (entry, end): (&[u8], &[u8]) = (b"PK\x01\x02", b"PK\x05\x06");
        let deflated = with_bytes(&whole, entry, 10, &8u16.to_le_bytes());
        assert!(refused(&path, &deflated).contains("is compressed"));
        let huge = [0xf0u8, 0xff, 0xff, 0xf0].repeat(2);
        assert!(refused(&path, &with_bytes(&whole, entry, 20, &huge)).contains("take more than"));
        let bomb = with_bytes(&whole, entry, 24, &huge[..4]);
        assert!(refused(&path, &bomb).contains("is compressed"));
        for count in [0u16, 1, 0xfffe] {
            let bytes = [count.to_le_bytes(), count.to_le_bytes()].concat();
            refused(&path, &with_bytes(&whole, end, 8, &bytes));
        }
        // An end of the long form that tells of 2^60 entries, and of a directory as long.
        let at = whole.windows(4).rposition(|w| w == end).unwrap();
        let many = (1u64 << 60).to_le_bytes();
        let long =
            [b"PK\x06\x06".as_slice(), &44u64.to_le_bytes(), &[45, 0, 45, 0], &[0; 8], &many, &many, &many, &[0; 8]];
        let locator = [b"PK\x06\x07".as_slice(), &[0; 4], &(at as u64).to_le_bytes(), &1u32.to_le_bytes()];
        let mut short = whole[at..].to_vec();
        short[8..20].fill(0xff);
        refused(&path, &[&whole[..at], &long.concat(), &locator.concat(), &short].concat());
    }

    #[test]
    fn another_format_and_other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let directory = RunDirectory::at(folder.path());
        let about = About { format: FORMAT + 1, ..About::new("cpu", "bar", 3, 0.0) };
        let path = write_checkpoint(&directory, &about, "", 1, |_| Ok(())).unwrap().unwrap();
        let Err(OutputError::Damaged { reason, .. }) = Checkpoint::open(&path) else { panic!("it is opened") };
        assert!(reason.contains("format is 4"), "{reason}");
        let none = write_checkpoint(&directory, &About::new("cpu", "bar", 4, 0.0), "", 1, |_| {
            Err(ArchiveError::Unsupported("no state".into()))
        });
        assert_eq!((none.unwrap(), checkpoints(folder.path()).unwrap().len()), (None, 1));
        fs::write(folder.path().join("checkpoint-12.zip"), "mine").unwrap();
        fs::write(folder.path().join("checkpoint-old.zip"), "mine").unwrap();
        assert_eq!(checkpoints(folder.path()).unwrap().len(), 1);
    }
}
