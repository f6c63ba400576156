//! Ctrl-C and SIGTERM.
#![cfg(unix)]

mod common;

use common::{Ended, Place, files, wait_for};
use std::{fs, io::Read, process::Command};

/// Starts a run of half a million steps, sends it a signal when it is under way, and looks at what it leaves.
fn stopped_by(signal: &str) {
    let place = Place::new();
    let far = ["--set", "time.end=\"50 ms\"", "--set", "output.frames=50000"];
    let rows = ["--set", "output.history-interval=\"0.1 us\""];
    let rest = ["--set", "body.0.velocity=[\"0 m/s\", \"0 m/s\"]"];
    let arguments = [["run", "plate.toml", "-o", "run"].as_slice(), &far, &rows, &rest].concat();
    let child = place.command(&arguments).spawn().unwrap();
    wait_for("the third frame", || place.path("run/fields/000002.vtp").exists());
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let ended = Ended::from(child.wait_with_output().unwrap()).expect_code(130);
    assert!(ended.err.contains("stopping"), "{}", ended.err);
    assert!(ended.out.contains("stopped by the user"), "{}", ended.out);

    let summary = place.summary("run");
    assert_eq!((&summary["status"], &summary["end_reason"]), (&"stopped".into(), &"user".into()));
    // Every file is complete, none is left half-way, and the last frame and row are those of the end.
    let steps = summary["steps"].as_u64().unwrap();
    for file in files(&place.path("run")) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        assert!(!name.contains("unfinished"), "{name} was left behind");
        if name.ends_with(".vtp") || name.ends_with(".pvd") {
            assert!(fs::read(&file).unwrap().ends_with(b"</VTKFile>\n"), "{name} is not complete");
        }
    }
    let history = fs::read_to_string(place.path("run/history.csv")).unwrap();
    let column = history.lines().next().unwrap().split(',').position(|name| name == "step").unwrap();
    assert!(history.ends_with('\n'));
    assert_eq!(history.lines().last().unwrap().split(',').nth(column), Some(steps.to_string().as_str()));
    let series = fs::read_to_string(place.path("run/fields.pvd")).unwrap();
    let frames = files(&place.path("run/fields")).len();
    assert_eq!(series.matches("<DataSet").count(), frames);
}

#[test]
fn ctrl_c_leaves_complete_files() {
    stopped_by("-INT");
}

#[test]
fn termination_leaves_complete_files() {
    stopped_by("-TERM");
}

#[test]
fn a_second_ctrl_c_ends_at_once_and_leaves_no_broken_file() {
    let place = Place::new();
    // Enough particles that writing takes a while.
    let size =
        ["run", "plate.toml", "-o", "run", "--set", "particles.spacing=\"0.05 mm\"", "--set", "time.end=\"1 s\""];
    let child = place.command(&size).spawn().unwrap();
    wait_for("the first frame", || place.path("run/fields/000000.vtp").exists());
    for _ in 0..2 {
        // The second may come when all is over.
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    }
    Ended::from(child.wait_with_output().unwrap()).expect_code(130);
    for frame in files(&place.path("run/fields")) {
        let name = frame.file_name().unwrap().to_string_lossy().into_owned();
        let complete = fs::read(&frame).unwrap().ends_with(b"</VTKFile>\n");
        assert!(complete || name.contains("unfinished"), "{name} is not complete");
    }
}

#[test]
fn a_run_that_is_ended_while_it_is_set_up_leaves_nothing() {
    let place = Place::new();
    let block = [
        "dimensions = \"3d\"",
        "particles = { spacing = \"1 mm\" }",
        "time = { end = \"1 us\" }",
        "[[body]]",
        "name = \"block\"",
        "material = \"armco-iron\"",
        "shape = { box = { min = [\"0 mm\", \"0 mm\", \"0 mm\"], max = [\"60 mm\", \"60 mm\", \"60 mm\"] } }",
        // The deck's own iron, with a doubt that is told before the first search, which takes seconds on one thread.
        "[material.armco-iron]",
        "density = \"7891 kg/m^3\"",
    ];
    fs::write(place.path("block.toml"), block.join("\n")).unwrap();
    let mut child = place.command(&["run", "block.toml", "-o", "run", "--threads", "1"]).spawn().unwrap();
    let mut told = [0; 5];
    child.stderr.as_mut().unwrap().read_exact(&mut told).unwrap();
    assert_eq!(&told, b"note:");
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    Ended::from(child.wait_with_output().unwrap()).expect_code(130);
    assert!(!place.path("run").exists());
}
