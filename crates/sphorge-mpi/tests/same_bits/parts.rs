//! Checkpoints of which each rank writes its part.

use super::{Files, led, results, setup};
use sphorge::engine::{Cpu, EngineKind};
use sphorge::run::{CheckpointPlan, Observer, ResumeOptions, RunOptions, Silent, execute, resume};
use sphorge_mpi::Leader;
use std::path::{Path, PathBuf};
use std::sync::{Arc, atomic::AtomicBool};
use std::{fs, thread};

/// A bullet and a plate, contact of both, walls of none; states are kept in memory, too, for steps that may have to be repeated.
const DECK: &str = "bullet";
const SHORT: [(&str, &str); 5] = [
    ("particles.spacing", "\"24 mm\""),
    ("body.1.spacing", "\"12 mm\""),
    ("contact", "{ penalty = { friction = 0.1 } }"),
    ("time.end", "\"80 us\""),
    ("output.frames", "4"),
];

/// Runs so many steps and saves the state then.
fn run(kind: &dyn EngineKind, directory: &Path, steps: Option<&str>) {
    let changes: Vec<_> = SHORT.iter().copied().chain(steps.map(|steps| ("time.max-steps", steps))).collect();
    let checkpoints = CheckpointPlan { at_end: steps.is_some(), ..CheckpointPlan::default() };
    let directory = directory.to_owned();
    let options = RunOptions { directory, threads: Some(1), checkpoints, ..RunOptions::default() };
    execute(setup(DECK, &changes), kind, &options, &AtomicBool::new(false), &mut Silent).unwrap();
}

/// What a run tells.
#[derive(Default)]
struct Told(Vec<String>);

impl Observer for Told {
    fn noted(&mut self, note: &str) {
        self.0.push(note.to_owned());
    }
}

/// Goes on to so many steps, or to the end, and saves the state then; returns what was told.
fn go_on(kind: Arc<dyn EngineKind>, directory: &Path, steps: &str) -> Vec<String> {
    let options = ResumeOptions {
        by_force: false,
        overrides: vec![("time.max-steps".to_owned(), steps.to_owned())],
        most_particles: 1e9,
        threads: Some(1),
        checkpoints: CheckpointPlan { at_end: true, ..CheckpointPlan::default() },
        engines: vec![kind],
    };
    let mut told = Told::default();
    resume(directory, &options, &AtomicBool::new(false), &mut told).unwrap();
    told.0
}

/// The same on ranks, each a thread.
fn go_on_ranks(ranks: usize, directory: &Path, steps: &str) -> Vec<String> {
    let mut communicators = sphorge_mpi::threads(ranks);
    thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            let follow = || sphorge_mpi::follow(communicator, Some(1), &sphorge::run::FilesOfRank::new(1e9)).unwrap();
            scope.spawn(follow);
        }
        go_on(Arc::new(Leader::new(communicators.remove(0))), directory, steps)
    })
}

/// Files and folders of checkpoints in the folder of a run, by their steps.
fn saved(directory: &Path, is_folder: bool) -> Vec<PathBuf> {
    let of = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().unwrap();
        (name.starts_with("checkpoint-") && entry.path().is_dir() == is_folder).then(|| entry.path())
    };
    let mut found: Vec<_> = fs::read_dir(directory).unwrap().filter_map(|entry| of(entry.unwrap())).collect();
    found.sort();
    found
}

/// Removes what a run of other numbers of steps has more than one that was never broken.
fn without_last_frames(files: Files, expected: &Files) -> Files {
    files.into_iter().filter(|(name, _)| expected.contains_key(name)).collect()
}

#[test]
fn parts_of_some_ranks_are_gone_on_with_by_others_and_by_one_process() {
    let folder = tempfile::tempdir().unwrap();
    let [unbroken, broken] = ["unbroken", "broken"].map(|name| folder.path().join(name));
    run(&Cpu, &unbroken, None);
    let expected = results(&unbroken);
    let steps = expected["history.csv"].iter().filter(|&&byte| byte == b'\n').count();
    assert!(steps > 100, "{steps}");

    led(3, 1, |leader| run(leader, &broken, Some("20")));
    let parts = saved(&broken, true);
    assert_eq!((saved(&broken, false).len(), parts.len()), (1, 1));
    assert_eq!(fs::read_dir(&parts[0]).unwrap().count(), 2);
    for (ranks, steps) in [(2, "40"), (5, "55"), (1, "70"), (4, "85")] {
        let told = go_on_ranks(ranks, &broken, steps);
        assert!(told[0].starts_with("continuing from step"), "{ranks}: {told:?}");
        // The last two are kept, and of these parts where there were several ranks.
        let (files, folders) = (saved(&broken, false), saved(&broken, true));
        assert!(files.len() == 2 && folders.len() <= 2, "{files:?} {folders:?}");
    }
    let told = go_on(Arc::new(Cpu), &broken, "1000000");
    assert!(told[0].starts_with("continuing from step 85"), "{told:?}");
    // Frames and rows where the run was broken are additional.
    let found = results(&broken);
    let last = |files: &Files| files["history.csv"].split(|byte| *byte == b'\n').rev().nth(1).map(<[u8]>::to_vec);
    assert!(last(&found) == last(&expected));
    let found = without_last_frames(found, &expected);
    assert!(found.len() == expected.len());
}

#[test]
fn a_checkpoint_of_which_a_part_is_missing_or_spoiled_or_of_another_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("run");
    led(3, 1, |leader| run(leader, &directory, Some("10")));
    go_on_ranks(3, &directory, "20");
    let folders = saved(&directory, true);
    let [before, last] = &folders[..] else { panic!("{folders:?}") };
    let part = last.join("0002.zip");
    let whole = fs::read(&part).unwrap();
    let spoil: [(&str, &dyn Fn()); 3] = [
        ("0002.zip", &|| fs::remove_file(&part).unwrap()),
        ("is damaged", &|| {
            let mut spoiled = whole.clone();
            spoiled[whole.len() / 2] ^= 1;
            fs::write(&part, spoiled).unwrap();
        }),
        ("belongs to another checkpoint", &|| {
            fs::copy(before.join("0002.zip"), &part).unwrap();
        }),
    ];
    let spare = folder.path().join("spare");
    for (why, spoil) in spoil {
        spoil();
        for ranks in [0, 2, 3] {
            copy(&directory, &spare);
            let told = match ranks {
                0 => go_on(Arc::new(Cpu), &spare, "30"),
                ranks => go_on_ranks(ranks, &spare, "30"),
            };
            assert!(told[0].contains(why) && told[0].ends_with("; it is skipped"), "{why}, {ranks}: {told:?}");
            assert!(told[1].starts_with("continuing from step 10"), "{why}, {ranks}: {told:?}");
            fs::remove_dir_all(&spare).unwrap();
        }
        fs::write(&part, &whole).unwrap();
    }
    let told = go_on_ranks(2, &directory, "30");
    assert!(told[0].starts_with("continuing from step 20"), "{told:?}");
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}
