//! Several runs of a deck: `sweep` and `convergence`.

mod common;

use common::Place;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::SystemTime,
};

const SPACINGS: &str = "particles.spacing=2 mm,1 mm";
const SPEEDS: &str = "body.plate.velocity.1=-50 m/s,-100 m/s";

/// Summaries of the runs in the folder of a sweep, with the times they were written at.
fn written(folder: &Path) -> BTreeMap<PathBuf, SystemTime> {
    let runs = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path().join("summary.json"));
    let ended = runs.filter(|summary| summary.exists());
    ended.map(|summary| (summary.clone(), fs::metadata(&summary).unwrap().modified().unwrap())).collect()
}

/// Lines of a table as cells.
fn cells(text: &str) -> Vec<Vec<String>> {
    // Only names of folders have commas.
    let line = |line: &str| match line.strip_prefix('"').and_then(|rest| rest.split_once("\",")) {
        Some((name, rest)) => [name].into_iter().chain(rest.split(',')).map(str::to_owned).collect(),
        None => line.split(',').map(str::to_owned).collect(),
    };
    text.lines().map(line).collect()
}

#[test]
fn every_combination_is_run_once_and_listed() {
    let place = Place::new();
    let sweep = ["sweep", "plate.toml", "-o", "s", "-j", "2", "--threads", "1", "--vary", SPACINGS, "--vary", SPEEDS];
    let ended = place.run(&[&sweep[..], &["--plot", "height", "--format", "svg"]].concat()).expect_code(0);
    for shown in ["2 mm", "-50 m/s", "completed", "s/sweep.csv", "s/plots/height-over-particles.spacing.svg"] {
        assert!(ended.out.contains(shown), "`{shown}` is not in:\n{}", ended.out);
    }
    assert!(ended.err.contains("4 runs in s; 2 at once, on 1 thread each"), "{}", ended.err);
    let table = cells(&fs::read_to_string(place.path("s/sweep.csv")).unwrap());
    assert_eq!(table.len(), 5);
    assert_eq!(
        table[0][..6],
        ["run", "particles.spacing (m)", "body.plate.velocity.1 (m/s)", "status", "warnings", "height (m)"]
    );
    let found: Vec<_> = table[1..].iter().map(|row| (row[1].as_str(), row[2].as_str(), row[3].as_str())).collect();
    let expected = [("0.002", "-50"), ("0.002", "-100"), ("0.001", "-50"), ("0.001", "-100")];
    assert_eq!(found, expected.map(|(spacing, speed)| (spacing, speed, "completed")));
    // The numbers are those of a run made by hand.
    let by_hand = ["--set", "particles.spacing=1 mm", "--set", "body.plate.velocity.1=-50 m/s"];
    place.run(&[&["run", "plate.toml", "-o", "alone", "--threads", "2"][..], &by_hand].concat()).expect_code(0);
    let height = place.summary("alone")["measures"]["height"].as_f64().unwrap();
    assert_eq!(table[3][5].parse::<f64>().unwrap(), height);
    assert!(fs::read_to_string(place.path("s/plots/height-over-particles.spacing.svg")).unwrap().contains("-50 m/s"));

    // All that is in the folder, as a shell makes of `s/*`: the runs, their decks, the table and the pictures.
    let mut all: Vec<_> = fs::read_dir(place.path("s")).unwrap().map(|e| e.unwrap().file_name()).collect();
    all.sort();
    let all: Vec<String> = all.into_iter().map(|name| format!("s/{}", name.to_str().unwrap())).collect();
    assert!(all.len() > 8, "{all:?}");
    let words: Vec<&str> = ["compare", "alone"].into_iter().chain(all.iter().map(String::as_str)).collect();
    assert_eq!(place.run(&words).expect_code(0).out.matches("completed").count(), 5);

    // Again: nothing is run. With another value: what is missing.
    let before = written(&place.path("s"));
    let again = place.run(&sweep).expect_code(0);
    assert!(again.err.contains("4 of them are there") && !again.err.contains("begins"), "{}", again.err);
    assert_eq!(again.out.lines().next(), ended.out.lines().next());
    let more = ["sweep", "plate.toml", "-o", "s", "--vary", SPEEDS, "--vary", "particles.spacing=1 mm,1.5 mm"];
    let more = place.run(&more).expect_code(0);
    // In another order of keys folders have other names.
    assert!(more.err.contains("4 runs in s;"), "{}", more.err);
    let more = ["sweep", "plate.toml", "-o", "s", "--vary", "particles.spacing=1.5 mm,2 mm", "--vary", SPEEDS];
    let more = place.run(&more).expect_code(0);
    assert!(more.err.contains("2 of them are there") && more.err.matches("begins").count() == 2, "{}", more.err);
    let after = written(&place.path("s"));
    assert!(before.iter().all(|(run, time)| after[run] == *time) && after.len() == 4 + 4 + 2);
}

#[test]
fn what_is_wrong_is_told_before_the_first_run() {
    let place = Place::new();
    let sweep =
        |arguments: &[&str]| place.run(&[&["sweep", "plate.toml", "-o", "s"], arguments].concat()).expect_code(2);
    sweep(&["--vary", "time.end=1 us,2 mm"])
        .expect_told(&["run 2 of 2 cannot be run: time.end=2 mm", "found a length"]);
    sweep(&["--vary", "particles.spaceing=1 mm"]).expect_told(&["unknown key `spaceing`", "did you mean `spacing`?"]);
    sweep(&["--vary", "body.plat.velocity.1=1 m/s"])
        .expect_told(&["`body` has no entry `plat`", "did you mean `plate`?"]);
    sweep(&["--vary", "time.end=1 us", "--set", "time.end=2 us"]).expect_told(&["`time.end` is set and varied"]);
    sweep(&["--vary", "\"time\".end=1 us", "--set", "time.end=2 us"])
        .expect_told(&["`time.end` is set, and `\"time\".end`, which is varied, sets the same"]);
    sweep(&["--vary", SPEEDS, "--vary", "body.0.velocity=[0,-1],[0,-2]"])
        .expect_told(&["`body.plate.velocity.1` and `body.0.velocity` set the same"]);
    sweep(&["--vary", SPACINGS, "--plot", "heigt"]).expect_told(&["no measure `heigt`", "did you mean `height`?"]);
    sweep(&["--vary", SPACINGS, "--plot", "height", "--over", "time.end"]).expect_told(&["`time.end` is not varied"]);
    sweep(&["--vary", "search=skin,every-step", "--plot", "height"]).expect_told(&["are not numbers"]);
    if !common::has_gpu() {
        sweep(&["--vary", SPACINGS, "--engine", "gpu"]).expect_told(&["built without the engine for graphics cards"]);
    }
    // Filling is tried, too.
    sweep(&["--vary", "particles.spacing=1 mm,1 m"]).expect_told(&["run 2 of 2 cannot be run"]);
    assert!(!place.path("s").exists());
    place.run(&["run", "plate.toml", "-o", "s", "--set", "time.max-steps=1"]).expect_code(0);
    sweep(&["--vary", SPACINGS]).expect_told(&["s is the folder of a run"]);
    assert!(!place.path("s/sweep.csv").exists());
}

#[test]
fn a_sweep_of_another_deck_is_not_mixed_with_the_first() {
    let place = Place::new();
    let sweep = ["sweep", "plate.toml", "-o", "s", "--vary", SPACINGS];
    place.run(&sweep).expect_code(0);
    let deck = fs::read_to_string(place.path("plate.toml")).unwrap();
    fs::write(place.path("plate.toml"), deck.replace("-100 m/s", "-90 m/s")).unwrap();
    let before = written(&place.path("s"));
    place.run(&sweep).expect_code(2).expect_told(&["contains a run of another deck", "--overwrite"]);
    assert_eq!(written(&place.path("s")), before);
    place.run(&[&sweep[..], &["--overwrite"]].concat()).expect_code(0);
    let deck = fs::read_to_string(place.path("s/particles.spacing=2mm/deck.toml")).unwrap();
    assert!(deck.contains("-90 m/s"), "{deck}");
}

#[test]
fn a_run_that_fails_is_told_and_the_others_are_made() {
    let place = Place::new();
    // A step of that size is beyond the stable one of particles of a quarter of the size alone.
    let sweep = [
        "sweep",
        "plate.toml",
        "-o",
        "s",
        "--vary",
        "particles.spacing=0.5 mm,2 mm",
        "--set",
        "time.fixed-step=300 ns",
    ];
    let ended = place.run(&sweep).expect_code(1);
    ended.expect_told(&["the run failed in", "1 of 2 runs have not reached their end"]);
    let table = cells(&fs::read_to_string(place.path("s/sweep.csv")).unwrap());
    assert_eq!((table[1][2].as_str(), table[2][2].as_str()), ("failed", "completed"));
    assert!(table[1][4].is_empty() && !table[2][4].is_empty(), "{table:?}");
    // It would fail again.
    let again = place.run(&sweep).expect_code(1);
    assert!(!again.err.contains("begins"), "{}", again.err);
    fs::remove_dir_all(place.path("s/particles.spacing=0.5mm")).unwrap();
    assert_eq!(place.run(&sweep).expect_code(1).err.matches("begins").count(), 1);
}

#[test]
fn runs_are_listed_without_being_made() {
    let place = Place::new();
    let sweep = ["sweep", "plate.toml", "-o", "s", "--vary", SPACINGS, "--dry-run"];
    let listed = place.run(&sweep).expect_code(0).out;
    assert_eq!(listed, "run        s/particles.spacing=2mm\nrun        s/particles.spacing=1mm\n");
    assert!(!place.path("s").exists());
}

#[cfg(unix)]
#[test]
fn a_sweep_that_is_stopped_goes_on_where_it_was() {
    let place = Place::new();
    let sweep =
        ["sweep", "plate.toml", "-o", "s", "--vary", "particles.spacing=0.4 mm,0.41 mm", "--set", "output.frames=40"];
    let sweep = [&sweep[..], &["-j", "1", "--threads", "1"]].concat();
    let child = place.command(&sweep).spawn().unwrap();
    let first = place.path("s/particles.spacing=0.4mm");
    common::wait_for("the first frames", || first.join("fields/000002.vtp").exists());
    std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    let ended = common::Ended::from(child.wait_with_output().unwrap()).expect_code(130);
    ended.expect_told(&["the same command goes on"]);
    assert_eq!(place.summary("s/particles.spacing=0.4mm")["status"], "stopped");
    assert!(!place.path("s/particles.spacing=0.41mm").exists());
    let table = cells(&fs::read_to_string(place.path("s/sweep.csv")).unwrap());
    assert_eq!((table[1][2].as_str(), table[2][2].as_str()), ("stopped", "unfinished"));

    // What was computed is not computed again.
    let written = || fs::metadata(first.join("fields/000001.vtp")).unwrap().modified().unwrap();
    let before = written();
    let ended = place.run(&sweep).expect_code(0);
    assert_eq!(written(), before);
    assert!(ended.err.contains("goes on: particles.spacing=0.4mm"), "{}", ended.err);
    // To the bits of a run that nobody has stopped.
    place.run(&["run", "s/particles.spacing=0.4mm.toml", "-o", "whole", "--threads", "1"]).expect_code(0);
    let history = |run: &str| fs::read(place.path(run).join("history.csv")).unwrap();
    assert!(history("whole") == history("s/particles.spacing=0.4mm"));
}

#[test]
fn measures_over_spacings_have_an_order_and_a_limit() {
    let place = Place::new();
    let ended =
        place.run(&["convergence", "plate.toml", "--spacing", "1 mm,4 mm,2 mm", "-o", "c", "-q"]).expect_code(0);
    assert!(
        ended.out.contains("finest off by") && ended.out.contains("c: sweep.csv, convergence.csv"),
        "{}",
        ended.out
    );
    let table = cells(&fs::read_to_string(place.path("c/convergence.csv")).unwrap());
    assert_eq!(table[0], ["measure", "unit", "4 mm", "2 mm", "1 mm", "order", "limit", "why_not"]);
    assert_eq!(table[1][..2], ["height", "m"]);
    let number = |k: usize| table[1][k].parse::<f64>().ok();
    let [coarse, middle, fine] = [2, 3, 4].map(|k| number(k).unwrap());
    let name = |spacing: &str| format!("c/particles.spacing={spacing}mm");
    let height = |spacing: &str| place.summary(&name(spacing))["measures"]["height"].as_f64().unwrap();
    assert_eq!([coarse, middle, fine], ["4", "2", "1"].map(height));
    match (number(5), number(6)) {
        (Some(order), Some(limit)) => {
            let ratio = (coarse - middle) / (middle - fine);
            assert!(
                (order - ratio.log2()).abs() < 1e-6 && (limit - fine - (fine - middle) / (ratio - 1.0)).abs() < 1e-9
            );
        }
        _ => assert!(!table[1][7].is_empty(), "{table:?}"),
    }
    let wrong =
        |spacing: &str| place.run(&["convergence", "plate.toml", "--spacing", spacing, "-o", "d"]).expect_code(2);
    wrong("1 mm").expect_told(&["one spacing only"]);
    wrong("1 mm,2 s").expect_told(&["not all lengths"]);
    wrong("1 mm,0 mm").expect_told(&["not above zero"]);
    wrong("1 mm,1000 um").expect_told(&["`1000 um` is given twice"]);
    let without = ["convergence", "plate.toml", "--spacing", "1 mm,2 mm", "-o", "d", "--set", "measure=[]"];
    place.run(&without).expect_code(2).expect_told(&["the deck has no measure", "add a [[measure]]"]);
    assert!(!place.path("d").exists());
}
