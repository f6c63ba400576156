//! Runs that are killed, stopped and resumed come to the same end, to the bit.
#![cfg(unix)]

mod common;

use common::{Ended, Place, files, wait_for};
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Child, Command},
    thread,
    time::{Duration, Instant},
};

/// A block that strikes a bar over a wall: a second or two of contact, friction, heat and measures with a memory.
const STRIKE: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
contact = { penalty = { friction = 0.2 } }

[time]
end = "40 us"

[output]
frame-interval = "1 us"
history-interval = "0.1 us"

[[body]]
name = "bar"
material = "ofhc-copper"
shape = { box = { min = ["-8 mm", "0 mm"], max = ["8 mm", "6 mm"] } }

[[body]]
name = "hammer"
material = "armco-iron"
shape = { box = { min = ["-3 mm", "6.2 mm"], max = ["3 mm", "12.2 mm"] } }
velocity = ["40 m/s", "-250 m/s"]

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }

[[measure]]
name = "peak"
maximum = { body = "bar", field = "pressure", over-time = true }

[[tracer]]
name = "tip"
point = ["0 mm", "3 mm"]
"#;

/// Keys of a run that does not end before a signal comes, on a busy machine neither: seconds.
const LONG: [&str; 2] = ["--set", "time.end=\"160 us\""];

/// Starts a long run and waits for its tenth frame.
fn start_long(place: &Place, run: &str, others: &[&str]) -> Child {
    let child = place.command(&[["run", "strike.toml", "-o", run].as_slice(), &LONG, others].concat()).spawn().unwrap();
    let frame = format!("{run}/fields/000009.vtp");
    wait_for("the tenth frame", || place.path(&frame).exists());
    child
}

/// Whether children of this process end by SIGHUP, the first of the signals, unless they catch it.
fn hears_of_closed_terminals() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.is_none_or(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 1 == 0)
}

fn place() -> Place {
    let place = Place::new();
    fs::write(place.path("strike.toml"), STRIKE).unwrap();
    place
}

/// What a run leaves, but for the seconds it took and the memory: by name of the file.
fn story(place: &Place, run: &str) -> BTreeMap<String, Vec<u8>> {
    let root = place.path(run);
    let mut story = BTreeMap::new();
    for file in files(&root) {
        let name = file.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
        if !name.starts_with(".sphorge-") && !name.starts_with("checkpoint-") {
            story.insert(name, fs::read(&file).unwrap());
        }
    }
    let mut summary = place.summary(run);
    for of_the_machine in [
        "wall_seconds",
        "threads",
        "stage_seconds",
        "particle_steps_per_second",
        "pairs_per_second",
        "peak_memory_bytes",
        "engine_memory_bytes",
    ] {
        assert!(summary.as_object_mut().unwrap().remove(of_the_machine).is_some(), "{of_the_machine}");
    }
    story.insert("summary.json".into(), summary.to_string().into_bytes());
    story
}

fn same(what: &str, expected: &BTreeMap<String, Vec<u8>>, found: &BTreeMap<String, Vec<u8>>) {
    let names = |story: &BTreeMap<String, Vec<u8>>| story.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(expected), names(found), "{what}");
    let differing: Vec<_> =
        expected.iter().filter(|(name, bytes)| found[*name] != **bytes).map(|(name, _)| name).collect();
    assert!(differing.is_empty(), "{what}: {differing:?} differ");
}

/// Whatever is there after a kill is whole: rows, frames, the list of them.
fn is_readable(root: &Path) {
    for file in files(root) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = fs::read(&file).unwrap();
        if name.ends_with(".unfinished") {
            continue;
        }
        match name.rsplit('.').next() {
            Some("vtp" | "pvd") => assert!(bytes.ends_with(b"</VTKFile>\n"), "{name}"),
            Some("csv") => {
                let text = String::from_utf8(bytes).unwrap();
                let cells = |line: &str| line.split(',').count();
                assert!(
                    text.ends_with('\n') && text.lines().all(|line| cells(line) == cells(text.lines().next().unwrap()))
                );
            }
            Some("json") => drop(serde_json::from_slice::<serde_json::Value>(&bytes).unwrap()),
            _ => {}
        }
    }
}

/// How many kills; `SPHORGE_KILLS=200` for the whole test.
fn kills() -> u64 {
    std::env::var("SPHORGE_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(12)
}

#[test]
fn a_run_killed_again_and_again_ends_as_one_that_was_not() {
    let place = place();
    let start = Instant::now();
    place.run(&["run", "strike.toml", "-o", "whole", "--threads", "2"]).expect_code(0);
    let (whole, seconds) = (story(&place, "whole"), start.elapsed().as_secs_f64());
    let often = ["--checkpoint-minutes", "0.001"];
    let (mut done, mut runs, mut resumed) = (0, 0, 0);
    while done < kills() {
        runs += 1;
        let run = format!("run{runs}");
        let mut command = place.command(&[["run", "strike.toml", "-o", &run].as_slice(), &often].concat());
        // It comes to an end at last, since it goes on from where it was.
        loop {
            let mut child = command.spawn().unwrap();
            // Moments that a golden ratio spreads over the time a run takes.
            let moment = 0.7 * (0.05 + 0.618_034 * done as f64).fract() * seconds;
            thread::sleep(Duration::from_secs_f64(moment));
            let is_over = done >= kills() || child.try_wait().unwrap().is_some();
            if is_over {
                Ended::from(child.wait_with_output().unwrap()).expect_code(0);
                break;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            done += 1;
            if place.path(&run).join("summary.json").exists() {
                // It had come to its end before it was killed.
                break;
            }
            let threads = if done % 2 == 0 { "1" } else { "2" };
            let is_begun = place.path(&run).exists();
            if is_begun {
                is_readable(&place.path(&run));
            }
            let has_state =
                is_begun && files(&place.path(&run)).iter().any(|file| file.to_string_lossy().contains("checkpoint-"));
            command = if has_state {
                resumed += 1;
                place.command(&[["resume", &run, "--threads", threads].as_slice(), &often].concat())
            } else {
                let told = place.run(&["resume", &run]).expect_code(2).err;
                // Killed before its mark, the folder is not that of a run yet.
                let why = ["there is no checkpoint in", "is not the folder of a run"];
                assert!(why.iter().any(|why| told.contains(why)), "{told}");
                place.command(&[["run", "strike.toml", "--overwrite", "-o", &run].as_slice(), &often].concat())
            };
        }
        same(&format!("run {runs} after {done} kills"), &whole, &story(&place, &run));
    }
    println!("{done} kills of {runs} runs, {resumed} resumed");
    assert!(resumed * 2 > done, "{resumed} of {done}");
}

#[test]
fn a_run_that_is_stopped_goes_on_and_beyond_its_end() {
    let place = place();
    place.run(&[["run", "strike.toml", "-o", "whole"].as_slice(), &LONG].concat()).expect_code(0);
    let child = start_long(&place, "run", &[]);
    // A terminal that is closed says so twice; tests run by `nohup` do not hear of it, nor do their children.
    let signals = if hears_of_closed_terminals() { ["-HUP"; 2].as_slice() } else { &["-TERM"] };
    for signal in signals {
        Command::new("kill").args([signal, child.id().to_string().as_str()]).status().unwrap();
    }
    let stopped = Ended::from(child.wait_with_output().unwrap()).expect_code(130);
    assert!(stopped.out.contains("sphorge resume run"), "{}", stopped.out);
    place
        .run(&["resume", "run", "--set", "body.bar.temperature=\"300 K\""])
        .expect_code(2)
        .expect_told(&["`body.bar.temperature` cannot change when a run is resumed"]);
    place.run(&["resume", "run", "--checkpoint-at-end"]).expect_code(0);
    same("resumed", &story(&place, "whole"), &story(&place, "run"));

    // Beyond its end, it is the run that had that end from the start, but for the rounding of the time it landed on.
    place.run(&["resume", "run", "--set", "time.end=\"30 us\""]).expect_code(2).expect_told(&["its end cannot be"]);
    let longer = ["--set", "time.end=\"164 us\""];
    let further = ["--set", "time.end=\"162 us\"", "--checkpoint-at-end"];
    place.run(&[["resume", "run"].as_slice(), &further].concat()).expect_code(0);
    let ended = place.run(&[["resume", "run"].as_slice(), &longer].concat()).expect_code(0);
    assert!(ended.out.contains("reached its end time at 164 us"), "{}", ended.out);
    place.run(&[["run", "strike.toml", "-o", "long"].as_slice(), &longer].concat()).expect_code(0);
    let (long, run) = (story(&place, "long"), story(&place, "run"));
    assert!(long.keys().eq(run.keys()));
    let kinetic = |run: &str| place.summary(run)["energy"]["kinetic"].as_f64().unwrap();
    assert!((kinetic("run") / kinetic("long") - 1.0).abs() < 1e-3, "{} {}", kinetic("run"), kinetic("long"));
    let rows = |story: &BTreeMap<String, Vec<u8>>| story["history.csv"].iter().filter(|&&byte| byte == b'\n').count();
    assert!(rows(&long).abs_diff(rows(&run)) <= 2, "{} {}", rows(&long), rows(&run));
}

#[test]
fn a_checkpoint_is_made_on_request_and_a_damaged_one_is_passed_over() {
    let place = place();
    let child = start_long(&place, "asked", &[]);
    Command::new("kill").args(["-USR1", &child.id().to_string()]).status().unwrap();
    let ended = Ended::from(child.wait_with_output().unwrap()).expect_code(0);
    assert_eq!(ended.err.matches("saved at step").count(), 1, "{}", ended.err);

    let ended = place.run(&["run", "strike.toml", "-o", "run", "--checkpoint-interval", "3 us"]).expect_code(0);
    assert_eq!(ended.err.matches("saved at step").count(), 13, "{}", ended.err);
    let whole = story(&place, "run");
    let mut kept: Vec<_> =
        files(&place.path("run")).into_iter().filter(|f| f.to_string_lossy().contains("checkpoint-")).collect();
    kept.sort();
    assert_eq!(kept.len(), 2);
    let mut last = fs::read(&kept[1]).unwrap();
    let middle = last.len() / 2;
    last[middle] ^= 1;
    fs::write(&kept[1], &last).unwrap();
    place.run(&["resume", "run"]).expect_code(2).expect_told(&[
        "the run in run has ended: completed at 40 us, step ",
        "to continue it from its last checkpoint, at 36",
        "a later `--set time.end=...`",
    ]);
    assert!(story(&place, "run") == whole, "a run that has ended was touched");
    // Of one that was killed before it could tell of its end, the rest is computed again.
    fs::remove_file(place.path("run/summary.json")).unwrap();
    place.run(&["resume", "run"]).expect_code(0).expect_told(&[
        "is damaged or not written by Sphorge",
        "it is skipped",
        "continuing from step",
        "are repeated",
    ]);
    same("resumed from the one before", &whole, &story(&place, "run"));

    // With another deck in the folder the run is still that of its checkpoints.
    let other = STRIKE.replace("40 us", "41 us");
    fs::write(place.path("run/deck.toml"), &other).unwrap();
    fs::remove_file(place.path("run/summary.json")).unwrap();
    let told = place.run(&["resume", "run"]).expect_code(0);
    told.expect_told(&["deck.toml is not the deck of the run", "kept as deck-found.toml"]);
    assert_eq!(fs::read_to_string(place.path("run/deck-found.toml")).unwrap(), other);
    fs::remove_file(place.path("run/deck-found.toml")).unwrap();
    same("resumed with another deck in its folder", &whole, &story(&place, "run"));
    place.run(&["resume", "nowhere"]).expect_code(2).expect_told(&["nowhere is not the folder of a run"]);
}

#[test]
fn a_state_that_cannot_be_written_ends_no_run_and_changes_no_deck() {
    let place = place();
    let short = ["--set", "time.max-steps=20", "--checkpoint-at-end"];
    let run = [["run", "strike.toml", "-o", "run", "--overwrite"].as_slice(), &short].concat();
    place.run(&run).expect_code(0).expect_told(&["saved at step 20"]);
    // A run that has ended and saved nothing says how it could go on.
    place.run(&["run", "strike.toml", "-o", "ended", "--set", "time.max-steps=3"]).expect_code(0);
    place.run(&["resume", "ended"]).expect_code(2).expect_told(&["has reached its end", "`--checkpoint-at-end`"]);
    // A folder is in the way of the next one.
    fs::remove_file(place.path("run/checkpoint-000000000020.zip")).unwrap();
    fs::create_dir_all(place.path("run/checkpoint-000000000020.zip/in-the-way")).unwrap();
    place.run(&run).expect_code(0).expect_told(&["could not be saved", "checkpoint-000000000020.zip", "is kept"]);
    assert_eq!(place.summary("run")["steps"], 20);

    // One of a changed deck is needed before anything else changes.
    fs::remove_dir_all(place.path("run")).unwrap();
    place.run(&run).expect_code(0);
    let everything = || -> BTreeMap<_, _> {
        files(&place.path("run")).into_iter().map(|file| (file.clone(), fs::read(file).unwrap())).collect()
    };
    let before = everything();
    let changed = ["resume", "run", "--set", "time.max-steps=30", "--checkpoint-minutes", "0"];
    let limited = "ulimit -f 64; exec \"$0\" \"$@\"";
    let mut command = Command::new("sh");
    command.current_dir(place.path(".")).args(["-c", limited, env!("CARGO_BIN_EXE_sphorge")]).args(changed);
    Ended::from(command.output().unwrap()).expect_code(1).expect_told(&["checkpoint-000000000020.zip", "resume"]);
    let without_lock = |mut files: BTreeMap<std::path::PathBuf, Vec<u8>>| {
        files.retain(|file, _| !file.ends_with(".sphorge-lock"));
        files
    };
    assert!(without_lock(before) == without_lock(everything()));
    let [deck, summary] = ["run/deck.toml", "run/summary.json"].map(|file| (file, fs::read(place.path(file)).unwrap()));
    place.run(&changed).expect_code(0);
    assert_eq!(place.summary("run")["steps"], 30);

    // What was changed and saved goes on also if the rest of the folder was not changed any more.
    for (file, bytes) in [deck, summary] {
        fs::write(place.path(file), bytes).unwrap();
    }
    place.run(&["resume", "run"]).expect_code(0);
    assert_eq!(place.summary("run")["steps"], 30);
    assert!(fs::read_to_string(place.path("run/deck.toml")).unwrap().contains("max-steps = 30"));
}

#[test]
fn a_request_makes_a_checkpoint_of_a_run_that_makes_none_by_itself() {
    let place = place();
    let child = start_long(&place, "run", &["--checkpoint-minutes", "0"]);
    Command::new("kill").args(["-USR1", &child.id().to_string()]).status().unwrap();
    let ended = Ended::from(child.wait_with_output().unwrap()).expect_code(0);
    assert_eq!(ended.err.matches("saved at step").count(), 1, "{}", ended.err);
}

#[test]
fn two_runs_do_not_share_a_folder() {
    let place = place();
    let mut child = start_long(&place, "run", &[]);
    let owner = format!("another run writes to run: process {}", child.id());
    place.run(&["run", "strike.toml", "-o", "run", "--overwrite"]).expect_code(2).expect_told(&[&owner]);
    child.kill().unwrap();
    child.wait().unwrap();
    place.run(&["run", "strike.toml", "-o", "run", "--overwrite", "--set", "time.max-steps=2"]).expect_code(0);
}
