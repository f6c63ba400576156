//! Folders of a short run whose checkpoints have been spoiled.

use super::*;
use crate::{
    deck::load_text,
    engine::{Cpu, ENGINES},
    run::{RunOptions, execute},
};
use sha2::{Digest, Sha256};
use std::{
    fs::{self, File},
    io::{Read, Write},
    sync::Arc,
};
use zip::{CompressionMethod, ZipArchive, ZipWriter, write::SimpleFileOptions};

/// Twelve particles that fly on, twelve steps.
const DECK: &str = r#"
    dimensions = "1d"
    [particles]
    spacing = "1 mm"
    [time]
    end = "100 us"
    max-steps = 12
    [[body]]
    name = "bar"
    material = "ofhc-copper"
    shape = { box = { min = ["0 mm"], max = ["12 mm"] } }
    velocity = ["10 m/s"]
"#;

/// What a run tells.
#[derive(Default)]
struct Listener(Vec<String>);

impl Observer for Listener {
    fn noted(&mut self, note: &str) {
        self.0.push(note.to_owned());
    }
}

/// Runs the deck with checkpoints after about every third step and at the end; the folder of it.
fn run_in(folder: &Path) -> PathBuf {
    run_with(folder, &[])
}

/// The same with other keys.
fn run_with(folder: &Path, overrides: &[(&str, &str)]) -> PathBuf {
    let checkpoints = CheckpointPlan { interval: Some(0.2e-6), at_end: true, ..CheckpointPlan::default() };
    let options = RunOptions { directory: folder.join("run"), threads: Some(1), checkpoints, ..RunOptions::default() };
    let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let setup = load_text("bar", DECK, &overrides).unwrap();
    execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Listener::default()).unwrap();
    options.directory
}

/// Takes away what tells of the end of a run, as if it had been killed just before.
fn forget_end(run: &Path) {
    fs::remove_file(run.join("summary.json")).unwrap();
}

fn go_on_in(folder: &Path) -> (Result<Summary, ResumeError>, Vec<String>) {
    go_on_with(folder, &[])
}

/// The same with changed keys.
fn go_on_with(folder: &Path, overrides: &[(&str, &str)]) -> (Result<Summary, ResumeError>, Vec<String>) {
    let options = ResumeOptions {
        overrides: overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect(),
        most_particles: 1e6,
        by_force: false,
        threads: Some(1),
        checkpoints: CheckpointPlan::default(),
        engines: vec![Arc::new(Cpu)],
    };
    let mut listener = Listener::default();
    let ended = resume(folder, &options, &AtomicBool::new(false), &mut listener);
    (ended, listener.0)
}

/// Writes a checkpoint anew with another value.
fn forge(path: &Path, name: &str, change: impl Fn(&mut Vec<u8>)) {
    forge_by(path, name, change, true);
}

/// The same, with the sum of all values or without.
fn forge_by(path: &Path, name: &str, change: impl Fn(&mut Vec<u8>), with_sum: bool) {
    let mut former = ZipArchive::new(File::open(path).unwrap()).unwrap();
    let mut values = Vec::new();
    for index in 0..former.len() {
        let mut entry = former.by_index(index).unwrap();
        let (name, mut bytes) = (entry.name().unwrap().into_owned(), Vec::new());
        entry.read_to_end(&mut bytes).unwrap();
        values.push((name, bytes));
    }
    drop(former);
    change(&mut values.iter_mut().find(|(known, _)| known == name).unwrap_or_else(|| panic!("{name}")).1);
    // Whoever forges values forges their sum, too.
    let mut sum = Sha256::new();
    for (name, bytes) in values.iter().filter(|(name, _)| name != "sha256") {
        sum.update((name.len() as u64).to_le_bytes());
        sum.update(name);
        sum.update((bytes.len() as u64).to_le_bytes());
        sum.update(bytes);
    }
    let told = values.iter_mut().find(|(name, _)| name == "sha256").unwrap();
    let own = told.1.clone();
    told.1 = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect::<String>().into_bytes();
    if !with_sum {
        told.1 = own;
    }
    let mut forged = ZipWriter::new(File::create(path).unwrap());
    for (name, bytes) in values {
        forged.start_file(name, SimpleFileOptions::default().compression_method(CompressionMethod::Stored)).unwrap();
        forged.write_all(&bytes).unwrap();
    }
    forged.finish().unwrap();
}

/// Name of a value of a checkpoint, what is done to it, and what a resumed run says of it.
type Change<'a> = (&'a str, Box<dyn Fn(&mut Vec<u8>)>, &'a str);

/// More than there are.
const MANY: u64 = 1_000_000_000_000_000_000;

fn set_count(count: u64) -> impl Fn(&mut Vec<u8>) {
    move |bytes: &mut Vec<u8>| bytes[..8].copy_from_slice(&count.to_le_bytes())
}

/// Resumes a run whose last checkpoint is forged, each way for itself.
fn are_passed_over(run: &Path, forgeries: &[Change<'_>]) {
    let found = checkpoints(run).unwrap();
    let [(12, last), (before, _)] = &found[..] else { panic!("{found:?}") };
    let whole = fs::read(last).unwrap();
    for (name, change, reason) in forgeries {
        fs::write(last, &whole).unwrap();
        forge(last, name, change);
        forget_end(run);
        let (ended, told) = go_on_in(run);
        assert_eq!(ended.unwrap().steps, 12, "{name}");
        assert_eq!(told.len(), 2, "{name}: {told:?}");
        assert!(told[0].contains(reason) && told[0].ends_with("; it is skipped"), "{name}: {told:?}");
        let (from, steps) = (format!("continuing from step {before} at "), 12 - before);
        let repeated = format!("; {steps} step{} repeated", if steps == 1 { " is" } else { "s are" });
        assert!(told[1].starts_with(&from) && told[1].ends_with(&repeated), "{told:?}");
        assert!(!last.exists(), "{name}");
    }
}

#[test]
fn forged_values_are_passed_over_for_the_checkpoint_before() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let set_first = |value: f64| move |bytes: &mut Vec<u8>| bytes[..8].copy_from_slice(&value.to_le_bytes());
    let forgeries: [Change<'_>; 30] = [
        ("state/particles.position", Box::new(set_first(f64::NAN)), "particles.position"),
        // So far out that the cells between would be more than there are numbers.
        ("state/particles.position", Box::new(set_first(-1e300)), "particles.position"),
        ("state/particles.reference_position", Box::new(set_first(1e300)), "particles.reference_position"),
        ("state/lists.points", Box::new(set_first(1e300)), "lists.points"),
        ("state/lists.smoothing_length", Box::new(set_first(-1.0)), "lists.smoothing_length"),
        ("state/lists.searcher.sorted_at", Box::new(set_first(1e300)), "lists.searcher.sorted_at"),
        ("state/particles.smoothing_length", Box::new(set_first(0.0)), "particles.smoothing_length"),
        ("state/particles.energy", Box::new(set_first(f64::NAN)), "`energy` has values that no particle can have"),
        ("state/particles.velocity", Box::new(set_first(f64::INFINITY)), "`velocity` has values"),
        ("state/particles.density", Box::new(set_first(-1.0)), "`density` has values"),
        ("state/particles.position", Box::new(|bytes| bytes.truncate(240)), "particles.position"),
        ("state/particles.id", Box::new(|bytes| bytes.extend([0; 4])), "particles.id"),
        ("state/run.recorder.watch.seen.count", Box::new(set_count(MANY)), "watch.seen"),
        // Later: a step before that of the last report, which a slow run makes at its last step, is found by that.
        ("state/clock.steps", Box::new(set_count(13)), "another step than it says"),
        // Counts that the next step would wrap, and differences below nothing.
        ("state/step.count", Box::new(set_count(u64::MAX)), "step.count"),
        ("state/run.recorder.steps.count", Box::new(set_count(u64::MAX)), "recorder.steps.count"),
        ("state/run.recorder.steps_at_last_row.count", Box::new(set_count(13)), "steps_at_last_row.count"),
        ("state/run.recorder.watch.hopeless_steps", Box::new(set_count(u64::MAX)), "watch.hopeless_steps"),
        ("state/run.pace.last_step", Box::new(set_count(13)), "run.pace.last_step"),
        ("state/run.frames.next", Box::new(set_count(0)), "run.frames.next"),
        // Never again a frame, or a row.
        ("state/run.frames.next", Box::new(set_count(MANY)), "run.frames.next"),
        ("state/run.rows.next", Box::new(set_count(MANY)), "run.rows.next"),
        ("state/run.kinetic", Box::new(set_first(f64::NAN)), "run.kinetic"),
        ("state/run.pace.seconds", Box::new(set_first(-1.0)), "run.pace"),
        ("state/run.recorder.seconds", Box::new(set_first(f64::INFINITY)), "`seconds`"),
        ("state/run.recorder.external_work", Box::new(set_first(f64::NAN)), "`energies`"),
        ("state/run.recorder.frame_times", Box::new(set_first(1e9)), "`frame_times`"),
        ("state/run.recorder.steps.searched", Box::new(set_first(1e9)), "`steps`"),
        ("state/particles.velocity", Box::new(set_first(4e8)), "`velocity` has values"),
        ("state/particles.mass", Box::new(set_first(-1.0)), "`mass` has values"),
    ];
    are_passed_over(&run, &forgeries);
}

#[test]
fn forged_lists_of_an_adaptive_search_are_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_with(folder.path(), &[("method", "\"updated-lagrangian\""), ("search", "\"adaptive\"")]);
    let forgeries: [Change<'_>; 4] = [
        ("state/lists.list.rooms", Box::new(set_count(MANY)), "lists.list"),
        // Cells of no size, or so many that there is no end to them.
        (
            "state/lists.searcher.sorted_for",
            Box::new(|bytes| bytes.copy_from_slice(&5e-324f64.to_le_bytes())),
            "sorted_for",
        ),
        (
            "state/lists.searcher.sorted_for",
            Box::new(|bytes| bytes.copy_from_slice(&1e-20f64.to_le_bytes())),
            "sorted_for",
        ),
        // The padding behind a row of two is not the particle itself.
        (
            "state/lists.list.indices",
            Box::new(|bytes| bytes[12..16].copy_from_slice(&7u32.to_le_bytes())),
            "lists.list",
        ),
    ];
    are_passed_over(&run, &forgeries);
}

#[test]
fn what_is_changed_without_its_sum_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let (_, last) = checkpoints(&run).unwrap().swap_remove(0);
    // The sum of a part alone is right: that of the values is another.
    forge_by(&last, "state/particles.temperature", |bytes| bytes[3] ^= 1, false);
    forget_end(&run);
    let (ended, told) = go_on_in(&run);
    assert_eq!(ended.unwrap().steps, 12);
    assert!(told[0].contains("its SHA-256 sum is another") && told[0].ends_with("it is skipped"), "{told:?}");
}

#[test]
fn a_deck_that_was_damaged_or_lost_is_that_of_the_checkpoint_again() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let deck = fs::read(run.join("deck.toml")).unwrap();
    let mut damaged = deck.clone();
    damaged[40] ^= 1;
    // Longer than any deck.
    let long = vec![b'#'; 9 << 20];
    for (found, note) in [
        (
            Some(&damaged[..]),
            "deck.toml is not the deck of the run; the one in the checkpoint is used, and deck.toml is kept as deck-found.toml",
        ),
        (Some(b"\xff\xfe"), "deck.toml is not the deck of the run"),
        (
            Some(&long),
            "deck.toml cannot be read; the one in the checkpoint is used, and deck.toml is kept as deck-found.toml",
        ),
        (None, "there is no deck.toml; the one in the checkpoint is used"),
    ] {
        forget_end(&run);
        match found {
            Some(found) => fs::write(run.join("deck.toml"), found).unwrap(),
            None => fs::remove_file(run.join("deck.toml")).unwrap(),
        }
        let (ended, told) = go_on_in(&run);
        assert_eq!(ended.unwrap().steps, 12);
        assert!(told.len() == 2 && told[1].contains(note), "{told:?}");
        assert_eq!(fs::read(run.join("deck.toml")).unwrap(), deck);
        if let Some(found) = found {
            assert!(fs::read(run.join("deck-found.toml")).unwrap() == found);
        }
    }
}

#[cfg(unix)]
#[test]
fn a_deck_that_leads_elsewhere_brings_nothing_from_there_into_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let (deck, own) = (fs::read(run.join("deck.toml")).unwrap(), folder.path().join("own.txt"));
    fs::write(&own, "secret").unwrap();
    fs::remove_file(run.join("deck.toml")).unwrap();
    std::os::unix::fs::symlink(&own, run.join("deck.toml")).unwrap();
    forget_end(&run);
    let (ended, told) = go_on_in(&run);
    assert_eq!(ended.unwrap().steps, 12);
    assert!(told[1].contains("deck.toml cannot be read"), "{told:?}");
    assert!(fs::symlink_metadata(run.join("deck-found.toml")).unwrap().is_symlink());
    assert_eq!((fs::read(run.join("deck.toml")).unwrap(), fs::read(&own).unwrap()), (deck, b"secret".to_vec()));
}

#[test]
fn a_folder_that_is_no_run_is_left_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["history.csv", "deck.toml"] {
        fs::write(folder.path().join(name), "mine").unwrap();
    }
    let ended = go_on_in(folder.path()).0;
    assert!(matches!(ended, Err(ResumeError::NoCheckpoint { .. })), "{ended:?}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_checkpoint_whose_deck_does_not_load_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let found = checkpoints(&run).unwrap();
    forge(&found[0].1, "deck.toml", |deck| deck.truncate(60));
    forget_end(&run);
    let (ended, told) = go_on_in(&run);
    assert_eq!(ended.unwrap().steps, 12);
    assert!(told[0].contains("the deck in ") && told[0].contains(" cannot be used: "), "{told:?}");
    assert!(told[1].starts_with(&format!("continuing from step {} ", found[1].0)), "{told:?}");
    // Where there is none that loads, what is wrong with the deck is told.
    for (_, file) in checkpoints(&run).unwrap() {
        forge(&file, "deck.toml", |deck| deck.truncate(60));
    }
    forget_end(&run);
    assert!(matches!(go_on_in(&run).0, Err(ResumeError::Deck(_))));
}

#[test]
fn the_checkpoints_of_another_run_are_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    forget_end(&run);
    // As a run leaves the folder that is killed just when it has begun to overwrite another one.
    let mark = fs::read_to_string(run.join(".sphorge-run")).unwrap();
    let (head, names) = mark.split_once('\n').unwrap();
    let other = if head.ends_with('0') { '1' } else { '0' };
    fs::write(run.join(".sphorge-run"), format!("{}{other}\n{names}", &head[..head.len() - 1])).unwrap();
    let (ended, told) = go_on_in(&run);
    assert!(matches!(ended, Err(ResumeError::NoCheckpoint { .. })), "{ended:?}");
    assert!(told[0].contains("belongs to another run"), "{told:?}");
    // Without a mark nobody knows better.
    fs::remove_file(run.join(".sphorge-run")).unwrap();
    assert_eq!(go_on_in(&run).0.unwrap().steps, 12);
    assert_eq!(fs::read_to_string(run.join(".sphorge-run")).unwrap().lines().next(), Some(head));
}

#[test]
fn files_that_were_damaged_are_named_and_written_again_where_they_can_be() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_with(folder.path(), &[("output.frames", "6")]);
    let listed: Vec<PathBuf> = ["history.csv", "history-columns.json", "fields.pvd"].map(|name| run.join(name)).into();
    let whole: Vec<_> = listed.iter().map(|path| fs::read(path).unwrap()).collect();
    let (ended, told) = {
        forget_end(&run);
        go_on_in(&run)
    };
    assert_eq!((ended.unwrap().steps, told.len()), (12, 1), "{told:?}");
    for (path, whole) in listed.iter().zip(&whole) {
        let mut damaged = whole.clone();
        damaged[whole.len() / 2] ^= 1;
        fs::write(path, damaged).unwrap();
    }
    let frame = run.join("fields/000000.vtp");
    let mut bytes = fs::read(&frame).unwrap();
    let last = bytes.len() - 60;
    bytes[last] ^= 1;
    fs::write(&frame, bytes).unwrap();
    // Not read: it takes no room, and would take hours.
    fs::File::options().write(true).open(run.join("fields/000001.vtp")).unwrap().set_len(1 << 42).unwrap();
    forget_end(&run);
    let (ended, told) = go_on_in(&run);
    assert_eq!(ended.unwrap().steps, 12);
    let all = told.join("\n");
    let damaged = "earlier frames are missing or damaged: fields/000000.vtp, fields/000001.vtp\n";
    assert!(all.contains(damaged), "{told:?}");
    for name in ["history.csv", "history-columns.json", "fields.pvd"] {
        assert!(all.contains(&format!("{name} was not what the run had written; it is written again")), "{told:?}");
    }
    for (path, whole) in listed.iter().zip(&whole) {
        assert!(fs::read(path).unwrap() == *whole, "{path:?}");
    }
    // What is behind the end is of nobody, too.
    fs::write(&listed[1], [&whole[1][..], b"x"].concat()).unwrap();
    forget_end(&run);
    assert!(go_on_in(&run).1.iter().any(|note| note.starts_with("history-columns.json was not what")));
    assert!(fs::read(&listed[1]).unwrap() == whole[1]);
}

#[test]
fn many_checkpoints_of_no_use_are_told_in_few_words() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let mut mark = fs::read_to_string(run.join(".sphorge-run")).unwrap();
    for step in 100..150 {
        let name = format!("checkpoint-{step:012}.zip");
        fs::write(run.join(&name), "").unwrap();
        // The last one is of somebody else.
        mark += &if step < 149 { name + "\n" } else { String::new() };
    }
    fs::write(run.join(".sphorge-run"), mark).unwrap();
    // One that was killed tells of its steps by its history alone.
    forget_end(&run);
    let history = fs::read_to_string(run.join("history.csv")).unwrap();
    let last = history.lines().last().unwrap().replacen(",12,", ",13,", 1);
    fs::write(run.join("history.csv"), format!("{history}{last}\n")).unwrap();
    let (ended, told) = go_on_in(&run);
    assert_eq!(ended.unwrap().steps, 12);
    assert_eq!(told.len(), 5, "{told:?}");
    assert!(told[..3].iter().all(|note| note.ends_with("it is skipped")), "{told:?}");
    assert_eq!(told[3], "47 more checkpoints are skipped for similar reasons");
    assert!(told[4].starts_with("continuing from step 12 at ") && told[4].ends_with("1 step is repeated"), "{told:?}");
    let steps: Vec<u64> = checkpoints(&run).unwrap().into_iter().map(|(step, _)| step).collect();
    assert_eq!((steps[0], steps.len()), (149, 3), "{steps:?}");
    fs::remove_file(run.join("checkpoint-000000000149.zip")).unwrap();

    fs::remove_file(run.join("checkpoint-000000000012.zip")).unwrap();
    for (_, path) in checkpoints(&run).unwrap() {
        fs::write(path, "").unwrap();
    }
    let (ended, told) = go_on_in(&run);
    assert!(matches!(ended, Err(ResumeError::NoCheckpoint { .. })), "{ended:?}");
    assert_eq!(told.len(), 1, "{told:?}");
}

#[test]
fn a_checkpoint_of_another_version_goes_on_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    let (_, last) = checkpoints(&run).unwrap().swap_remove(0);
    let own = format!("\"{}\"", env!("CARGO_PKG_VERSION"));
    let other = |bytes: &mut Vec<u8>| {
        *bytes = String::from_utf8_lossy(bytes).replace(&own, "\"9.9.9\"").into_bytes();
    };
    forge(&last, "checkpoint.json", other);
    forget_end(&run);
    let (ended, told) = go_on_in(&run);
    assert_eq!(ended.unwrap().steps, 12);
    assert!(
        told[0].contains("was written by version 9.9.9") && told[0].contains("may not be bit-identical"),
        "{told:?}"
    );
    assert!(told[1].starts_with("continuing from step 12 at "), "{told:?}");
}

/// What a run that has ended is refused with: message and help.
fn refusal(ended: &Result<Summary, ResumeError>) -> (String, String) {
    let Err(error @ ResumeError::Ended { .. }) = ended else { panic!("{ended:?}") };
    (error.to_string(), miette::Diagnostic::help(error).unwrap().to_string())
}

/// All files of a folder but the mark of who writes to it.
fn files_in(run: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let paths = fs::read_dir(run).unwrap().map(|entry| entry.unwrap().path());
    let files = paths.filter(|path| path.is_file() && !path.ends_with(".sphorge-lock"));
    let mut files: Vec<_> = files.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
    files.sort();
    files
}

#[test]
fn a_run_that_has_ended_is_left_alone_unless_more_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path());
    // Without the checkpoint of its end there is an older one.
    fs::remove_file(run.join("checkpoint-000000000012.zip")).unwrap();
    let before = files_in(&run);
    for overrides in [&[][..], &[("time.end", "\"90 us\"")], &[("time.max-steps", "12")], &[("output.frames", "3")]] {
        let (ended, told) = go_on_with(&run, overrides);
        let (message, help) = refusal(&ended);
        assert!(message.contains("has ended: completed at ") && message.ends_with(", step 12"), "{message}");
        let ways = ["a larger `--set time.max-steps=...`", "from its last checkpoint, at ", "`--overwrite`"];
        assert!(ways.iter().all(|way| help.contains(way)), "{help}");
        assert!(told.is_empty() && files_in(&run) == before, "{overrides:?}: {told:?}");
    }
    let (ended, told) = go_on_with(&run, &[("time.max-steps", "14")]);
    assert_eq!((ended.unwrap().steps, told.len()), (14, 1));
    assert!(told[0].starts_with("continuing from step ") && told[0].contains("; "), "{told:?}");
}

#[test]
fn a_run_that_came_to_rest_goes_on_to_a_smaller_fraction_alone() {
    let folder = tempfile::tempdir().unwrap();
    // The bar runs into a wall.
    let stop = "[{ name = \"stop\", plane = { point = [\"12.5 mm\"], normal = [-1] } }]";
    let key = "time.stop-kinetic-fraction";
    let run = run_with(folder.path(), &[("wall", stop), (key, "0.9"), ("time.max-steps", "1000")]);
    let summary = Summary::read(&RunDirectory::open(&run).unwrap()).unwrap();
    assert_eq!(summary.end_reason, EndReason::KineticEnergy);
    let before = files_in(&run);
    for overrides in [&[][..], &[(key, "0.9")], &[(key, "0.95")], &[("time.end", "\"200 us\"")]] {
        let (_, help) = refusal(&go_on_with(&run, overrides).0);
        assert!(help.contains("to continue it, give a smaller `--set time.stop-kinetic-fraction=...`"), "{help}");
        assert!(files_in(&run) == before, "{overrides:?}");
    }
    let ended = go_on_with(&run, &[(key, "0.5")]).0.unwrap();
    assert!(ended.end_reason == EndReason::KineticEnergy && ended.steps > summary.steps, "{ended:?}");
}
