//! What becomes of the folder of a run, and of what else is in it, when it is moved, prepared by others or written to twice.
#![cfg(unix)]

mod common;

use common::{Ended, Place, wait_for};
use std::{
    fs,
    os::unix::fs::symlink,
    path::Path,
    process::{Child, Command},
};

/// The plate for longer than any test takes, with frames that come one after the other.
const LONG: [&str; 2] = ["--set", "time.end=\"20 ms\""];

fn start_long(place: &Place, run: &str) -> Child {
    fs::write(place.path("long.toml"), common::DECK.replace("frames = 4", "frame-interval = \"0.2 us\"")).unwrap();
    let child = place.command(&["run", "long.toml", "-o", run, "--threads", "1", LONG[0], LONG[1]]).spawn().unwrap();
    let frame = format!("{run}/fields/000003.vtp");
    wait_for("the fourth frame", || place.path(&frame).exists());
    child
}

fn end(child: Child) -> Ended {
    Ended::from(child.wait_with_output().unwrap())
}

#[test]
fn a_lock_that_leads_elsewhere_is_not_followed() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-o", "run", "--checkpoint-at-end"]).expect_code(0);
    fs::write(place.path("thesis.txt"), "my thesis").unwrap();
    let lock = place.path("run/.sphorge-lock");
    let further = ["resume", "run", "--set", "time.end=\"3 us\""];
    for command in [&further[..], &["run", "plate.toml", "-o", "run", "--overwrite"]] {
        for target in ["../thesis.txt", "../none.txt"] {
            fs::remove_file(&lock).unwrap();
            symlink(target, &lock).unwrap();
            place.run(command).expect_code(2).expect_told(&[
                "because of its `.sphorge-lock`",
                "symbolic link",
                "not followed",
            ]);
        }
        fs::remove_file(&lock).unwrap();
        fs::hard_link(place.path("thesis.txt"), &lock).unwrap();
        let refused = place.run(command).expect_code(2);
        refused.expect_told(&["not written by Sphorge", "remove or rename it"]);
    }
    assert_eq!(fs::read_to_string(place.path("thesis.txt")).unwrap(), "my thesis");
    assert!(!place.path("none.txt").exists());
    fs::remove_file(&lock).unwrap();
    place.run(&further).expect_code(0);
}

#[test]
fn a_run_whose_folder_is_moved_stops_and_leaves_alone_what_is_there_now() {
    let place = Place::new();
    let child = start_long(&place, "run");
    fs::rename(place.path("run"), place.path("moved")).unwrap();
    place.run(&["run", "plate.toml", "-o", "run"]).expect_code(0);
    let told = end(child).expect_code(1);
    told.expect_told(&["cannot write to its folder run any more", "moved"]);
    let names: Vec<_> = fs::read_dir(place.path("run/fields")).unwrap().collect();
    assert_eq!(names.len(), 5);
    assert_eq!(place.summary("run")["status"], "completed");
    assert!(!place.path("moved/summary.json").exists());
}

#[test]
fn a_folder_that_is_taken_by_force_stops_the_run_that_wrote_to_it() {
    let place = Place::new();
    let child = start_long(&place, "run");
    let again = ["run", "plate.toml", "-o", "run", "--overwrite"];
    place.run(&again).expect_code(2).expect_told(&["another run writes to run: process", "--no-lock"]);
    place.run(&[&again[..], &["--no-lock"]].concat()).expect_code(0);
    end(child).expect_code(1).expect_told(&["its lock was removed, or taken by another run"]);
    let names: Vec<_> = fs::read_dir(place.path("run/fields")).unwrap().collect();
    assert_eq!((names.len(), place.summary("run")["status"].as_str()), (5, Some("completed")));
}

#[test]
fn the_deck_in_the_folder_of_its_run_is_never_lost() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-o", "run"]).expect_code(0);
    let deck = fs::read_to_string(place.path("run/deck.toml")).unwrap();
    for microseconds in (0..60).map(|k| 1500 * k) {
        let command = ["run", "run/deck.toml", "-o", "run", "--overwrite", "--threads", "1"];
        let mut child = place.command(&command).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_micros(microseconds));
        let _ = child.kill();
        child.wait().unwrap();
        assert_eq!(fs::read_to_string(place.path("run/deck.toml")).unwrap(), deck, "after {microseconds} us");
    }
}

#[test]
fn the_deck_of_a_run_is_run_under_the_name_of_the_run() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-o", "first", "--set", "time.max-steps=1"]).expect_code(0);
    place.run(&["run", "first/deck.toml"]).expect_code(0);
    assert!(place.path("out/first/summary.json").is_file() && !place.path("out/deck").exists());
    // Not where somebody has named a deck so.
    fs::create_dir(place.path("mine")).unwrap();
    fs::copy(place.path("first/deck.toml"), place.path("mine/deck.toml")).unwrap();
    place.run(&["run", "mine/deck.toml"]).expect_code(0);
    assert!(place.path("out/deck/summary.json").is_file());
}

#[test]
fn a_file_with_the_name_of_one_of_a_run_is_not_removed() {
    let place = Place::new();
    fs::create_dir(place.path("mine")).unwrap();
    for name in ["history.csv", "deck.toml", "pressure-last.png"] {
        fs::write(place.path("mine").join(name), "mine").unwrap();
    }
    let refused = place.run(&["run", "plate.toml", "-o", "mine", "--overwrite"]).expect_code(2);
    refused.expect_told(&["mine is not the folder of a run"]);
    place.run(&["run", "plate.toml", "-o", "run"]).expect_code(0);
    place.run(&["plot", "run", "--field", "pressure"]).expect_code(0);
    let drawn = || fs::read_dir(place.path("run/plots")).unwrap().count();
    assert_eq!(drawn(), 1);
    fs::write(place.path("run/plots/pressure-mine.png"), "mine").unwrap();
    place.run(&["run", "plate.toml", "-o", "run", "--overwrite"]).expect_code(0);
    assert_eq!(drawn(), 1);
    assert_eq!(fs::read_to_string(place.path("run/plots/pressure-mine.png")).unwrap(), "mine");
}

/// A driver of the system's locks that says of each call that there are none, as network file systems do.
fn without_locks(place: &Place) -> Option<String> {
    let source = place.path("none.c");
    fs::write(
        &source,
        "#include <errno.h>\nint flock(int f, int o) { (void)f; (void)o; errno = ENOLCK; return -1; }\n",
    )
    .unwrap();
    let library = place.path("none.so");
    let compiled = Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&library, &source]).status();
    compiled.is_ok_and(|status| status.success()).then(|| library.to_string_lossy().into_owned())
}

#[test]
#[cfg(target_os = "linux")]
fn two_runs_do_not_share_a_folder_on_a_file_system_without_locks() {
    let place = Place::new();
    let Some(library) = without_locks(&place) else {
        println!("skipped: no C compiler");
        return;
    };
    fs::write(place.path("long.toml"), common::DECK.replace("frames = 4", "frame-interval = \"0.2 us\"")).unwrap();
    let start = |arguments: &[&str]| {
        let mut command = place.command(arguments);
        command.env("LD_PRELOAD", &library);
        command
    };
    let long = ["run", "long.toml", "-o", "run", "--threads", "1", LONG[0], LONG[1]];
    let mut first = start(&long).spawn().unwrap();
    wait_for("the first frame", || place.path("run/fields/000000.vtp").exists());
    let again = ["run", "plate.toml", "-o", "run", "--overwrite"];
    let second = || Ended::from(start(&again).output().unwrap());
    second().expect_code(2).expect_told(&["another run writes to run: process"]);
    // One that was killed has ended, as the system tells.
    first.kill().unwrap();
    first.wait().unwrap();
    second().expect_code(0);
    second().expect_code(0);
}

#[test]
fn two_runs_share_a_folder_by_no_name_of_it() {
    let place = Place::new();
    let child = start_long(&place, "run");
    symlink("run", place.path("link")).unwrap();
    fs::create_dir(place.path("beside")).unwrap();
    let whole = place.path("run").to_string_lossy().into_owned();
    for name in ["run", "./run", "run/", "run/.", "beside/../run", "link", "link/", &whole] {
        let told = place.run(&["run", "plate.toml", "-o", name, "--overwrite"]).expect_code(2);
        told.expect_told(&["another run writes to", "process"]);
        place.run(&["resume", name]).expect_code(2).expect_told(&["another run writes to"]);
    }
    // Without its lock anybody may write to the folder: the run that had it does not any more.
    fs::remove_file(place.path("run/.sphorge-lock")).unwrap();
    place.run(&["run", "plate.toml", "-o", "link", "--overwrite"]).expect_code(0);
    end(child).expect_code(1).expect_told(&["its lock was removed, or taken by another run"]);
    assert_eq!(fs::read_dir(place.path("run/fields")).unwrap().count(), 5);
}

#[test]
fn a_run_that_slept_while_its_folder_was_taken_writes_nothing_when_it_wakes() {
    let place = Place::new();
    let child = start_long(&place, "run");
    let signal = |name: &str| {
        Command::new("kill").args([name, child.id().to_string().as_str()]).status().unwrap();
    };
    signal("-STOP");
    place.run(&["run", "plate.toml", "-o", "run", "--overwrite", "--no-lock"]).expect_code(0);
    let left = common::files(&place.path("run")).len();
    signal("-CONT");
    end(child).expect_code(1).expect_told(&["cannot write to its folder"]);
    assert_eq!(common::files(&place.path("run")).len(), left);
}

#[test]
fn a_run_whose_folder_is_removed_and_begun_anew_leaves_the_new_one_alone() {
    let place = Place::new();
    let child = start_long(&place, "run");
    fs::remove_dir_all(place.path("run")).or_else(|_| fs::remove_dir_all(place.path("run"))).unwrap();
    place.run(&["run", "plate.toml", "-o", "run"]).expect_code(0);
    end(child).expect_code(1);
    assert_eq!(fs::read_dir(place.path("run/fields")).unwrap().count(), 5);
    // The folder above is moved.
    fs::create_dir(place.path("above")).unwrap();
    let child = start_long(&place, "above/run");
    fs::rename(place.path("above"), place.path("elsewhere")).unwrap();
    end(child).expect_code(1).expect_told(&["moved"]);
    assert!(!place.path("above").exists());
}

/// A copy whose files are links to those of another folder, as `cp -al` and backups make it.
fn copy_by_links(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, copy) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if path.is_dir() { copy_by_links(&path, &copy) } else { fs::hard_link(&path, &copy).unwrap() }
    }
}

#[test]
fn a_copy_by_links_is_a_run_of_its_own_and_leaves_the_other_as_it_is() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-o", "run", "--checkpoint-at-end"]).expect_code(0);
    let whole: Vec<_> =
        common::files(&place.path("run")).into_iter().map(|path| (fs::read(&path).unwrap(), path)).collect();
    for (copy, command) in [
        ("first", &["resume", "first", "--set", "time.end=\"3 us\""][..]),
        ("second", &["run", "plate.toml", "-o", "second", "--overwrite"]),
        ("third", &["plot", "third", "--column", "height"]),
    ] {
        copy_by_links(&place.path("run"), &place.path(copy));
        place.run(command).expect_code(0);
        place.run(command).expect_code(if copy == "first" { 2 } else { 0 });
        assert!(whole.iter().all(|(bytes, path)| fs::read(path).unwrap() == *bytes), "{copy}");
    }
    // One that is copied while it goes on notices nothing, and the copy can go on when it has ended.
    let child = start_long(&place, "long");
    copy_by_links(&place.path("long"), &place.path("copy"));
    let told = place.run(&["run", "plate.toml", "-o", "copy", "--overwrite"]).expect_code(2);
    told.expect_told(&["another run writes to copy"]);
    wait_for("the twentieth frame", || place.path("long/fields/000020.vtp").exists());
    Command::new("kill").args(["-INT", child.id().to_string().as_str()]).status().unwrap();
    end(child).expect_code(130);
    place.run(&["run", "plate.toml", "-o", "copy", "--overwrite"]).expect_code(0);
    let mark = fs::read_to_string(place.path("long/.sphorge-run")).unwrap();
    assert!(mark.contains("fields/000020.vtp\n") && mark.contains("summary.json\n"), "{mark}");
}

#[test]
fn two_validations_do_not_write_into_one_folder() {
    let place = Place::new();
    let first =
        place.command(&["validate", "--quick", "taylor-bars", "-o", "valid", "--threads", "1"]).spawn().unwrap();
    wait_for("the first run", || place.path("valid/taylor-bars").exists());
    for more in [&[][..], &["--resume"]] {
        let again = [&["validate", "--quick", "plate-impact", "-o", "valid"], more].concat();
        let told = place.run(&again).expect_code(2);
        told.expect_told(&["another validation writes to valid: process", "-o DIR"]);
    }
    assert!(!place.path("valid/plate-impact").exists());
    fs::rename(place.path("valid"), place.path("moved")).unwrap();
    place.run(&["validate", "--quick", "plate-impact", "-o", "valid"]).expect_code(0);
    let told = end(first).expect_code(1);
    told.expect_told(&["cannot write to its folder"]);
    assert!(!place.path("valid/taylor-bars").exists() && place.path("valid/report.html").exists());
}
