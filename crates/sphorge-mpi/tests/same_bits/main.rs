//! A run on ranks writes what a run without them writes, bit by bit.

mod adaptive;
mod audits;
mod balance;
mod contact;
mod faces;
mod heat;
mod inner;
mod messages;
mod parts;
mod pieces;
mod reductions;
mod saved;
mod sections;
mod shipped;
mod symmetry;

use sphorge::deck::{Setup, load_text};
use sphorge::engine::{Cpu, EngineKind};
use sphorge::output::{FrameFile, RunDirectory, read_series};
use sphorge::run::{FilesOfRank, RunOptions, Silent, execute};
use sphorge_mpi::{Leader, follow, threads};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::{fs, thread};

/// Names and contents of the files of a run that hold results.
type Files = BTreeMap<String, Vec<u8>>;

/// A shipped deck by its name, or the text of one.
fn setup(deck: &str, changes: &[(&str, &str)]) -> Setup {
    let text = sphorge::decks::find(deck).map_or(deck, |shipped| shipped.text);
    let changes: Vec<_> = changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    load_text("a-deck", text, &changes).unwrap_or_else(|report| panic!("{report:?}"))
}

/// The history, and what frames hold, in one file or in pieces.
fn results(directory: &Path) -> Files {
    let mut files = Files::new();
    files.insert("history.csv".to_owned(), fs::read(directory.join("history.csv")).unwrap());
    for (time, path) in read_series(&RunDirectory::open(directory).unwrap()).unwrap() {
        files.insert(path.file_stem().unwrap().to_string_lossy().into_owned(), content(time, &path));
    }
    files
}

/// All that a frame holds in the order of `id`, to the bit; whole numbers are those of few particles. Pieces have the `id` itself unasked.
fn content(time: f64, path: &Path) -> Vec<u8> {
    let mut frame = FrameFile::open(path).unwrap();
    let arrays: Vec<_> = frame.arrays().iter().filter(|array| array.name != "id").cloned().collect();
    let mut bytes = format!("{time:e} {:?} {:?} {arrays:?}", frame.header, frame.bodies).into_bytes();
    bytes.extend(frame.positions().unwrap().iter().flatten().flat_map(|x| x.to_le_bytes()));
    for array in arrays {
        bytes.extend(frame.column(&array.name).unwrap().unwrap().values.iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes
}

/// A column of the history by how its name begins; what is empty is no number.
fn column(files: &Files, name: &str) -> Vec<f64> {
    let text = String::from_utf8(files["history.csv"].clone()).unwrap();
    let lines: Vec<Vec<&str>> =
        text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect()).collect();
    let place = lines[0].iter().position(|column| column.starts_with(name)).unwrap();
    lines[1..].iter().map(|line| line[place].parse().unwrap_or(f64::NAN)).collect()
}

/// The files of a run, or how it failed.
fn try_run(kind: &dyn EngineKind, setup: Setup, threads: usize) -> Result<Files, String> {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("run");
    let options = RunOptions { directory: directory.clone(), threads: Some(threads), ..RunOptions::default() };
    let done = execute(setup, kind, &options, &AtomicBool::new(false), &mut Silent);
    done.map(|_| results(&directory)).map_err(|error| error.to_string())
}

/// The same on ranks, each a thread.
fn try_run_on_ranks(deck: &str, changes: &[(&str, &str)], ranks: usize, threads_each: usize) -> Result<Files, String> {
    led(ranks, threads_each, |leader| try_run(leader, setup(deck, changes), threads_each))
}

/// What the first of some ranks makes of them, each a thread.
fn led<T>(ranks: usize, threads_each: usize, lead: impl FnOnce(&Leader) -> T) -> T {
    let mut communicators = threads(ranks);
    thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            scope.spawn(move || {
                follow(communicator, Some(threads_each), &FilesOfRank::new(1e9)).unwrap();
            });
        }
        lead(&Leader::new(communicators.remove(0)))
    })
}

/// Numbers of ranks that are tried: two and the most of these, or all of them where `SPHORGE_ALL_RANKS` is set, as `scripts/nightly.sh` does.
fn tried(ranks: &[usize]) -> Vec<usize> {
    let most = ranks.iter().max();
    let all = std::env::var_os("SPHORGE_ALL_RANKS").is_some();
    ranks.iter().filter(|&ranks| all || *ranks == 2 || Some(ranks) == most).copied().collect()
}

/// Compares a run on each number of ranks with one without ranks, whose files it returns.
fn compare(deck: &str, changes: &[(&str, &str)], ranks: &[usize]) -> Files {
    let expected = try_run(&Cpu, setup(deck, changes), 1).unwrap();
    assert!(expected.len() > 2, "{:?}", expected.keys());
    let rows = expected["history.csv"].iter().filter(|&&byte| byte == b'\n').count();
    assert!(rows > 2, "{rows} rows");
    for ranks in tried(ranks) {
        let found = try_run_on_ranks(deck, changes, ranks, if ranks == 2 { 2 } else { 1 }).unwrap();
        assert!(found.keys().eq(expected.keys()));
        for (name, bytes) in &found {
            assert!(*bytes == expected[name], "`{name}` of `{deck:.60}` on {ranks} ranks differs");
        }
    }
    expected
}

#[test]
fn a_plate_at_a_wall_with_a_search_every_step() {
    compare(
        "taylor-plate",
        &[("particles.spacing", "\"0.4 mm\""), ("time.end", "\"6 us\""), ("output.frames", "2")],
        &[1, 2, 3, 4, 5, 7],
    );
}

#[test]
fn smoothing_lengths_that_follow_the_density() {
    compare(
        "taylor-plate",
        &[
            ("particles.spacing", "\"0.4 mm\""),
            ("numerics.smoothing-length", "\"follow-density\""),
            ("body.0.velocity", "[\"0 m/s\", \"-900 m/s\"]"),
            ("search", "\"skin\""),
            ("time.end", "\"4 us\""),
            ("output.frames", "2"),
        ],
        &[3],
    );
}

#[test]
fn a_bullet_in_a_plate_with_lists_that_are_kept() {
    compare(
        "bullet",
        &[
            ("particles.spacing", "\"24 mm\""),
            ("body.1.spacing", "\"12 mm\""),
            ("time.end", "\"250 us\""),
            ("output.frames", "2"),
        ],
        &[1, 2, 3, 4, 7],
    );
}

#[test]
fn a_bar_that_is_pulled_with_smoothing_lengths_that_follow_and_densities_restored() {
    compare(
        "tensile",
        &[
            ("particles.spacing", "\"12 mm\""),
            ("numerics.precision", "\"double\""),
            ("numerics.mls-interval", "4"),
            ("numerics.gradient-correction", "\"linear\""),
            ("numerics.smoothing-length", "\"follow-density\""),
            ("time.end", "\"0.2 ms\""),
            ("output.frames", "2"),
        ],
        &[3],
    );
}

/// A block strikes a wall and slides along it while its other end is drawn away: it comes apart, and steps are taken back.
const IN_THE_INITIAL_CONFIGURATION: &str = r#"
dimensions = "plane-strain"
search = { total-lagrangian = { self-contact = false, renewal = 1.1 } }
particles = { spacing = "0.5 mm" }

[time]
end = "12 us"
step-control = { stretch = 0.02, repeats = 6 }

[output]
frame-interval = "4 us"
history-interval = "0.5 us"

[[body]]
name = "block"
material = "ofhc-copper"
shape = { box = { min = ["0 mm", "0.2 mm"], max = ["12 mm", "20.2 mm"] } }
velocity = ["40 m/s", "-150 m/s"]

[[region]]
name = "end"
body = "block"
shape = { box = { min = ["0 mm", "18 mm"], max = ["12 mm", "21 mm"] } }

[[motion]]
region = "end"
velocity = ["0 m/s", "500 m/s"]

[[wall]]
name = "table"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
contact = { penalty = { friction = 0.2 } }

[[measure]]
name = "width"
extent = { body = "block", axis = "x" }

[[measure]]
name = "stress"
mean = { body = "block", field = "von_mises_stress" }
"#;

#[test]
fn a_block_in_the_initial_configuration_that_is_renewed_and_steps_that_are_repeated() {
    compare(IN_THE_INITIAL_CONFIGURATION, &[], &[2, 4]);
}

#[test]
fn a_block_that_breaks() {
    let damage = ("material.ofhc-copper.damage", "{ cockcroft-latham = { work = \"20 MPa\" } }");
    let energy = ("material.ofhc-copper.fracture-energy", "\"5 kJ/m^2\"");
    let files = compare(IN_THE_INITIAL_CONFIGURATION, &[damage, energy], &[2, 4]);
    let taken = column(&files, "fracture_energy");
    assert!(taken.last().is_some_and(|last| *last > 100.0) && taken.is_sorted(), "{taken:?}");
}

#[test]
fn a_failure_is_that_of_one_rank_whichever_has_the_particle() {
    // The end that is drawn away changes most; it is with the last rank.
    for changes in [
        [("time.step-control.stretch", "0.001"), ("time.step-control.repeats", "1")],
        [("time.step-control.stretch", "1.0"), ("body.0.velocity", "[\"0 m/s\", \"-9000 m/s\"]")],
    ] {
        let alone = try_run(&Cpu, setup(IN_THE_INITIAL_CONFIGURATION, &changes), 1).unwrap_err();
        assert!(alone.contains("particle"), "{alone}");
        for ranks in [1, 2, 5] {
            let together = try_run_on_ranks(IN_THE_INITIAL_CONFIGURATION, &changes, ranks, 1).unwrap_err();
            assert_eq!(together, alone, "{ranks} ranks");
        }
    }
}

#[test]
fn too_few_particles_for_the_ranks_are_refused() {
    let message = try_run_on_ranks("taylor-plate", &[("particles.spacing", "\"2 mm\"")], 2, 1)
        .map(|files| files.len())
        .unwrap_err();
    assert!(message.contains("are too few for 2 ranks") && message.contains("use `--ranks 1`"), "{message}");
}

#[test]
fn kernel_values_of_the_start() {
    let frozen = ("search", "{ total-lagrangian = { form = \"frozen\" } }");
    let short = [("particles.spacing", "\"0.4 mm\""), ("time.end", "\"6 us\""), ("output.frames", "2"), frozen];
    compare("taylor-plate", &short, &[1, 2, 3, 4, 7]);
    compare(symmetry::CORNER, &[frozen], &[3]);
}
