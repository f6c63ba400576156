//! `sphorge run`: files, messages, exit codes.

mod common;

use common::Place;
use std::fs;

#[test]
fn a_run_writes_its_folder_and_says_what_it_did() {
    let place = Place::new();
    let ended = place.run(&["run", "plate.toml"]).expect_code(0);
    for file in ["deck.toml", "fields.pvd", "fields/000004.vtp", "history.csv", "summary.json"] {
        assert!(place.path("out/plate").join(file).is_file(), "{file} is missing");
    }
    let summary = place.summary("out/plate");
    assert_eq!(summary["status"], "completed");
    assert_eq!(summary["particles"], 192);
    assert!(summary["measures"]["height"].as_f64().is_some_and(|height| (0.020..0.024).contains(&height)));
    for text in ["energy drift", "height", " mm", "paraview out/plate/fields.pvd", "sphorge plot out/plate"] {
        assert!(ended.out.contains(text), "`{text}` is not in:\n{}", ended.out);
    }
}

#[test]
fn run_and_check_tell_of_a_spacing_that_does_not_fit() {
    let place = Place::new();
    // Seven layers across 8 mm, 21 along 24 mm: 147 1.15^2 mm^2 where there are 192 mm^2.
    let spacing = ["plate.toml", "--set", "particles.spacing=\"1.15 mm\""];
    for command in ["check", "run"] {
        let ended = place.run(&[&[command], &spacing[..]].concat()).expect_code(0);
        ended.expect_told(&[
            "note: line 15: body `plate`: its particles have 1.3 % more mass than its shape",
            "fit better: 1.1429 mm",
        ]);
        assert!(ended.out.contains("1.254 %"), "{}", ended.out);
    }
    let body = &place.summary("out/plate")["bodies"][0];
    assert_eq!((&body["name"], &body["particles"]), (&"plate".into(), &147.into()));
}

#[test]
fn without_a_terminal_progress_comes_in_plain_lines_of_ten_per_cent() {
    let place = Place::new();
    let ended = place.run(&["run", "plate.toml"]).expect_code(0);
    assert!(!ended.err.contains(['\r', '\u{1b}']), "{:?}", ended.err);
    let lines: Vec<_> = ended.err.lines().filter(|line| line.contains(" %  ")).collect();
    // A machine that is fast enough does several tenths between two reports.
    assert!((1..=11).contains(&lines.len()), "{}", ended.err);
    assert!(lines.last().is_some_and(|line| line.starts_with("100 %")), "{}", ended.err);
    assert!(lines.iter().all(|line| line.contains("particle-steps/s")));
}

#[test]
fn settings_reach_the_run_and_are_kept_with_it() {
    let place = Place::new();
    let settings = ["--set", "particles.spacing=\"2 mm\"", "--set", "body.0.velocity=[\"0 m/s\", \"-50 m/s\"]"];
    let arguments = ["run", "plate.toml", "-o", "coarse", "--precision", "double", "--threads", "1"];
    place.run(&[arguments.as_slice(), settings.as_slice()].concat()).expect_code(0);
    let summary = place.summary("coarse");
    assert_eq!((&summary["particles"], &summary["threads"]), (&48.into(), &1.into()));
    assert_eq!(summary["precision"], "double");
    let deck = fs::read_to_string(place.path("coarse/deck.toml")).unwrap();
    for text in ["2 mm", "-50 m/s", "double"] {
        assert!(deck.contains(text), "`{text}` is not in:\n{deck}");
    }
    // What was run runs again.
    place.run(&["run", "coarse/deck.toml", "-o", "again"]).expect_code(0);
    assert_eq!(place.summary("again")["measures"], summary["measures"]);
}

#[test]
fn a_bad_deck_is_told_by_line_and_nothing_is_written() {
    let place = Place::new();
    let deck = common::DECK.replace("spacing = \"1 mm\"", "spacin = \"1 mm\"");
    fs::write(place.path("bad.toml"), deck).unwrap();
    let ended = place.run(&["run", "bad.toml"]).expect_code(2);
    ended.expect_told(&["bad.toml:6", "spacin", "did you mean `spacing`"]);
    let ended = place.run(&["run", "plate.toml", "--set", "time.end=\"3 kg\""]).expect_code(2);
    ended.expect_told(&["3 kg", "expected a time"]);
    let ended = place.run(&["check", "plate.toml", "--set", "particles.spacing=1e-9"]).expect_code(2);
    ended.expect_told(&["particles"]);
    assert!(!place.path("out").exists());
}

/// Runs the plate with limits that a shell sets.
#[cfg(target_os = "linux")]
fn limited(place: &Place, limit: &str, spacing: &str) -> common::Ended {
    let spacing = format!("particles.spacing={spacing}");
    let mut command = std::process::Command::new("sh");
    command.current_dir(place.path(".")).args(["-c", &format!("ulimit {limit}; exec \"$0\" \"$@\"")]);
    command.args([
        env!("CARGO_BIN_EXE_sphorge"),
        "run",
        "plate.toml",
        "--overwrite",
        "--threads",
        "2",
        "--set",
        &spacing,
    ]);
    common::Ended::from(command.output().unwrap())
}

#[test]
#[cfg(target_os = "linux")]
fn more_particles_than_the_process_may_hold_are_refused() {
    // A million particles, in 300 MB of addresses.
    let ended = limited(&Place::new(), "-v 300000", "\"0.0138 mm\"").expect_code(2);
    ended.expect_told(&["too-many-particles", "the available memory is enough for"]);
}

#[test]
#[cfg(target_os = "linux")]
fn without_memory_or_room_for_a_file_a_run_ends_with_a_message() {
    let place = Place::new();
    let within = |mb: u32| limited(&place, &format!("-v {mb}000"), "\"0.2 mm\"");
    // Below some 40 MB the system cannot even start the program, with the libraries of MPI below some 70.
    let has_started = |ended: &common::Ended| ended.code.is_some_and(|code| code <= 2);
    let first = (20..200).step_by(2).find(|mb| has_started(&within(*mb))).unwrap();
    // From where the deck is refused to where it runs.
    let ended: Vec<_> = (first..first + 40).step_by(2).map(within).collect();
    let out_of_memory =
        ended.iter().filter(|ended| ended.code == Some(1) && ended.err.contains("error: out of memory: "));
    assert!(out_of_memory.count() > 0, "{:?}", ended.iter().map(|ended| ended.code).collect::<Vec<_>>());
    assert!(ended.iter().all(has_started), "{ended:?}");
    limited(&place, "-f 20", "\"0.4 mm\"").expect_code(1).expect_told(&["File too large"]);
}

#[test]
fn an_existing_folder_is_left_alone_unless_overwriting_is_asked_for() {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-o", "run"]).expect_code(0);
    let before = fs::read(place.path("run/summary.json")).unwrap();
    let ended = place.run(&["run", "plate.toml", "-o", "run", "--set", "time.end=\"1 us\""]).expect_code(2);
    ended.expect_told(&["exists already", "--overwrite"]);
    assert_eq!(fs::read(place.path("run/summary.json")).unwrap(), before);
    place.run(&["run", "plate.toml", "-o", "run", "--set", "time.end=\"1 us\"", "--overwrite"]).expect_code(0);
    assert_eq!(place.summary("run")["simulated_time"], 1e-6);

    fs::create_dir(place.path("mine")).unwrap();
    fs::write(place.path("mine/thesis.tex"), "").unwrap();
    let ended = place.run(&["run", "plate.toml", "-o", "mine", "--overwrite"]).expect_code(2);
    ended.expect_told(&["not the folder of a run"]);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_made_is_bad_input() {
    let place = Place::new();
    let ended = place.run(&["run", "plate.toml", "-o", "plate.toml/run"]).expect_code(2);
    ended.expect_told(&["cannot write to the output folder"]);
}

#[test]
fn a_run_that_breaks_down_keeps_what_it_has_and_exits_with_1() {
    let place = Place::new();
    // Far beyond the stable step once the wall is met, within the margin the first step is given. Slower, it may survive as debris.
    let settings = ["--set", "numerics.viscosity=false", "--set", "time.courant=1", "--set", "time.end=\"200 us\""];
    let faster =
        ["--set", "body.0.velocity=[\"0 m/s\", \"-50000 m/s\"]", "--set", "time.max-steps=5000", "-o", "broken"];
    let ended = place.run(&[["run", "plate.toml"].as_slice(), &settings, &faster].concat()).expect_code(1);
    ended.expect_told(&["the run failed in step", "particle", "broken"]);
    let summary = place.summary("broken");
    assert_eq!(summary["status"], "failed");
    assert!(summary["failure"]["field"].is_string());
    assert!(place.path("broken/fields/000000.vtp").is_file());
}

#[test]
fn an_engine_that_is_not_there_is_said_to_be_missing() {
    if common::has_gpu() {
        return;
    }
    let place = Place::new();
    let ended = place.run(&["run", "plate.toml", "--engine", "gpu"]).expect_code(2);
    ended.expect_told(&["built without the engine for graphics cards", "--engine cpu"]);
    assert!(!place.path("out").exists());
}

/// A strip of aluminium, 20 by 20 particles, that is pulled at both ends: it falls into pairs of rows.
const STRIP: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "1 mm" }
time = { end = "100 us" }

[output]
frames = 1

[[body]]
name = "strip"
material = "2024-t351-aluminium"
shape = { box = { min = ["-10 mm", "-10 mm"], max = ["10 mm", "10 mm"] } }

[[region]]
name = "left"
shape = { box = { min = ["-10 mm", "-10 mm"], max = ["-7 mm", "10 mm"] } }

[[region]]
name = "right"
shape = { box = { min = ["7 mm", "-10 mm"], max = ["10 mm", "10 mm"] } }

[[motion]]
region = "left"
velocity = ["-10 m/s", "0 m/s"]

[[motion]]
region = "right"
velocity = ["10 m/s", "0 m/s"]
"#;

#[test]
fn a_broken_run_says_so_everywhere() {
    let place = Place::new();
    fs::write(place.path("strip.toml"), STRIP).unwrap();
    let ended = place.run(&["run", "strip.toml"]).expect_code(0);
    assert_eq!(ended.err.matches("warning: pairing").count(), 1, "{}", ended.err);
    ended.expect_told(&["of `strip` at (", "numerical fracture"]);
    assert!(ended.out.contains("pairing"), "{}", ended.out);
    let summary = place.summary("out/strip");
    assert_eq!(summary["status"], "completed with warnings");
    let warning = summary["warnings"].as_array().unwrap().iter().find(|w| w["name"] == "pairing").unwrap();
    assert_eq!((&warning["limit"], &warning["body"]), (&0.1.into(), &"strip".into()));
    let (first, value) = (warning["time"].as_f64().unwrap(), warning["value"].as_f64().unwrap());
    assert!(first > 20e-6 && first < 100e-6 && value > 0.1 && value <= 1.0, "{warning}");
    let history = fs::read_to_string(place.path("out/strip/history.csv")).unwrap();
    let mut rows = history.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = rows.next().unwrap().iter().position(|name| *name == "warnings").unwrap();
    let counts: Vec<&str> = rows.map(|cells| cells[column]).collect();
    assert_eq!(counts[0], "0");
    assert_eq!(counts[counts.len() - 1], summary["warnings"].as_array().unwrap().len().to_string());

    let compared = place.run(&["compare", "out/strip", "out/strip"]).expect_code(0);
    assert!(compared.out.contains("completed with warnings") && compared.out.contains("pairing"), "{}", compared.out);
}

#[test]
fn strict_fails_a_broken_run_and_limits_are_those_of_the_deck() {
    let place = Place::new();
    fs::write(place.path("strip.toml"), STRIP).unwrap();
    let ended = place.run(&["run", "strip.toml", "--strict", "-o", "strict"]).expect_code(1);
    ended.expect_told(&["--strict: the run has warnings:", "pairing"]);
    assert_eq!(place.summary("strict")["status"], "completed with warnings");
    let names = "[\"pairing\", \"tearing\", \"expansion\", \"lost-neighbors\", \"plastic-work\", \"hot\"]";
    let off = format!("warnings.off={names}");
    place.run(&["run", "strip.toml", "--strict", "-o", "quiet", "--set", &off]).expect_code(0);
    assert_eq!(place.summary("quiet")["status"], "completed");
    let ended = place.run(&["run", "strip.toml", "--set", "warnings.of=3"]).expect_code(2);
    ended.expect_told(&["did you mean `off`"]);
    let ended = place.run(&["run", "strip.toml", "--set", "warnings.pairing=-0.1"]).expect_code(2);
    ended.expect_told(&["must be zero or above"]);
}

#[test]
fn a_run_that_would_not_end_is_stopped() {
    let place = Place::new();
    let ended = place.run(&["run", "plate.toml", "--set", "time.courant=1e-300"]).expect_code(1);
    ended.expect_told(&["warning: steps-left", "the run would not end", "raise", "time.courant"]);
    let summary = place.summary("out/plate");
    assert_eq!((&summary["status"], &summary["failure"]["field"]), (&"failed".into(), &"time step".into()));
    assert_eq!(summary["warnings"][0]["name"], "steps-left");
    // So many steps are asked for, and no more.
    let settings = ["--set", "time.courant=1e-300", "--set", "time.max-steps=150", "-o", "few"];
    place.run(&[["run", "plate.toml"].as_slice(), &settings].concat()).expect_code(0);
}

#[test]
fn a_run_whose_numbers_are_not_finite_fails_and_constants_of_no_matter_are_told() {
    let place = Place::new();
    let deck = common::DECK.replace("armco-iron", "odd");
    let with = |constants: &str| {
        let text = format!("{deck}\n[material.odd]\nbase = \"armco-iron\"\n{constants}\n");
        fs::write(place.path("odd.toml"), text).unwrap();
        place.run(&["run", "odd.toml", "--overwrite"])
    };
    let told = with("specific-heat = 1e-300").expect_code(1);
    told.expect_told(&[
        "specific heat of 1e-300 J/(kg K): no material has such a specific heat",
        "`temperature` is not finite",
    ]);
    let summary = place.summary("out/odd");
    assert_eq!((&summary["status"], &summary["failure"]["field"]), (&"failed".into(), &"temperature".into()));
    assert!(summary["failure"]["particle"].is_u64(), "{summary}");
    let hot = place.run(&["run", "plate.toml", "--set", "body.0.temperature=\"1e30 K\""]);
    hot.expect_told(&["starts at 1e30 K, far above the boiling point of any metal"]);
}
