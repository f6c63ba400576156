//! Frames that ranks write in pieces.

use super::{Files, led, results, setup};
use sphorge::engine::persist::{Archive, ArchiveError};
use sphorge::engine::ranks::{Loaded, RankFiles};
use sphorge::engine::{Cpu, EngineKind, FieldSource, Model};
use sphorge::output::{FrameFile, RunDirectory, read_series};
use sphorge::plot::{Paper, PictureFormat, plot_run};
use sphorge::run::{FilesOfRank, RunError, RunOptions, Silent, execute};
use sphorge_mpi::{Leader, follow, threads};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::{fs, thread};

const DECK: &str = "taylor-plate";
/// Without `id`, which pieces have all the same.
const SHORT: [(&str, &str); 4] = [
    ("particles.spacing", "\"0.4 mm\""),
    ("time.end", "\"4 us\""),
    ("output.frames", "2"),
    ("output.fields", "[\"body\", \"velocity\", \"stress\", \"plastic_strain\"]"),
];

fn run(kind: &dyn EngineKind, directory: &Path, changes: &[(&str, &str)]) -> Result<(), RunError> {
    let changes: Vec<_> = SHORT.iter().chain(changes).copied().collect();
    let options = RunOptions { directory: directory.to_owned(), threads: Some(1), ..RunOptions::default() };
    execute(setup(DECK, &changes), kind, &options, &AtomicBool::new(false), &mut Silent).map(drop)
}

/// Names of the files and folders under a folder.
fn names(folder: &Path) -> BTreeSet<String> {
    let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    fs::read_dir(folder).unwrap().map(|entry| name(entry.unwrap())).collect()
}

fn set(names: &[&str]) -> BTreeSet<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Names and bytes of the standard pictures of a run.
fn pictures(directory: &Path) -> Files {
    let run = RunDirectory::open(directory).unwrap();
    let files = plot_run(&run, Paper::default(), PictureFormat::Png, &run.plots()).unwrap();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), fs::read(path).unwrap())).collect()
}

#[test]
fn pieces_hold_what_one_file_does_and_give_the_same_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let [alone, pieces, one] = ["alone", "pieces", "one"].map(|name| folder.path().join(name));
    run(&Cpu, &alone, &[]).unwrap();
    led(3, 1, |leader| run(leader, &pieces, &[])).unwrap();
    assert_eq!(
        names(&pieces.join("fields")),
        set(&["000000", "000000.pvtp", "000001", "000001.pvtp", "000002", "000002.pvtp"])
    );
    assert_eq!(names(&pieces.join("fields/000002")), set(&["0000.vtp", "0001.vtp", "0002.vtp"]));
    assert!(!pictures(&alone).is_empty());
    assert!(pictures(&alone) == pictures(&pieces));

    // Where one file is asked for, it is that of one process, byte by byte.
    led(2, 1, |leader| run(leader, &one, &[("output.pieces", "\"one\"")])).unwrap();
    assert_eq!(names(&one.join("fields")), set(&["000000.vtp", "000001.vtp", "000002.vtp"]));
    for name in names(&one.join("fields")) {
        let [found, expected] = [&one, &alone].map(|run| fs::read(run.join("fields").join(&name)).unwrap());
        assert!(found == expected, "{name}");
    }
    // Another run in the folder leaves none of the pieces.
    let again = RunOptions { directory: pieces.clone(), overwrite: true, ..RunOptions::default() };
    execute(setup(DECK, &SHORT), &Cpu, &again, &AtomicBool::new(false), &mut Silent).unwrap();
    assert_eq!(names(&pieces.join("fields")), set(&["000000.vtp", "000001.vtp", "000002.vtp"]));
    assert!(results(&pieces) == results(&alone));
}

#[test]
fn pieces_that_are_not_those_of_one_frame_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("run");
    led(2, 1, |leader| run(leader, &directory, &[])).unwrap();
    let fields = directory.join("fields");
    let refused = |name: &str| {
        let error = FrameFile::open(&fields.join("000001.pvtp")).map(drop).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    };
    FrameFile::open(&fields.join("000001.pvtp")).unwrap();
    let [first, second] = ["000001/0000.vtp", "000001/0001.vtp"].map(|name| fields.join(name));
    let whole = fs::read(&second).unwrap();
    fs::copy(fields.join("000002/0001.vtp"), &second).unwrap();
    refused("belongs to another frame");
    fs::copy(&first, &second).unwrap();
    refused("each particle exactly once");
    fs::write(&second, &whole[..whole.len() / 2]).unwrap();
    let mut frame = FrameFile::open(&fields.join("000001.pvtp")).unwrap();
    frame.column("plastic_strain").unwrap_err();
    fs::remove_file(&second).unwrap();
    refused("0001.vtp");
}

/// A rank that cannot write its second piece.
struct Full {
    files: FilesOfRank,
    written: AtomicBool,
}

impl RankFiles for Full {
    fn load(&self, name: &str, deck: &str) -> Option<Loaded> {
        self.files.load(name, deck)
    }
    fn write(&self, request: &str, rank: usize, model: &Model, particles: &dyn FieldSource) -> Result<(), String> {
        if rank == 2 && self.written.swap(true, std::sync::atomic::Ordering::Relaxed) {
            return Err("the disk is full".to_owned());
        }
        self.files.write(request, rank, model, particles)
    }
    fn save(
        &self,
        request: &str,
        rank: usize,
        state: &mut dyn FnMut(&mut dyn Archive) -> Result<(), ArchiveError>,
    ) -> Result<(), String> {
        self.files.save(request, rank, state)
    }
    fn open(&self, request: &str, rank: usize, size: usize) -> Result<Box<dyn Archive>, String> {
        self.files.open(request, rank, size)
    }
}

#[test]
fn a_frame_of_which_a_piece_cannot_be_written_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("run");
    let mut communicators = threads(3);
    let ended = thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            scope.spawn(move || {
                let files = Full { files: FilesOfRank::new(1e9), written: AtomicBool::new(false) };
                follow(communicator, Some(1), &files).unwrap();
            });
        }
        run(&Leader::new(communicators.remove(0)), &directory, &[])
    });
    let error = ended.unwrap_err();
    let RunError::Output { source } = &error else { panic!("{error}") };
    let why = std::error::Error::source(source).unwrap().to_string();
    assert_eq!(why, "rank 2: the disk is full");
    let series = read_series(&RunDirectory::open(&directory).unwrap()).unwrap();
    assert_eq!(series.len(), 1);
    FrameFile::open(&series[0].1).unwrap();
    assert_eq!(names(&directory.join("fields")), set(&["000000", "000000.pvtp"]));
}
