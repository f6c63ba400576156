//! A deck becomes a folder that can be read back, pictured and compared.

use sphorge::{
    deck::load_text,
    engine::ENGINES,
    output::{FrameFile, HistoryTable, RunDirectory, Status, Summary, read_series},
    plot::{FieldPicture, Paper, PictureFormat, plot_field, plot_run},
    run::{Observer, RunError, RunOptions, Silent, execute},
    validate::{Effort, ValidateError, ValidateOptions, Watcher, validate},
};
use std::{fs, path::Path, sync::atomic::AtomicBool};

/// A small plate hits a wall: 12 by 20 particles, 2 microseconds.
const DECK: &str = r#"
title = "A plate hits a wall"
dimensions = "plane-strain"
method = "updated-lagrangian"

[particles]
spacing = "0.5 mm"

[time]
end = "2 us"

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["-3 mm", "0 mm"], max = ["3 mm", "10 mm"] } }
velocity = ["0 m/s", "-200 m/s"]

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }

[[measure]]
name = "height"
extent = { body = "bar", axis = "y" }
"#;

fn run(folder: &Path, threads: usize) -> Result<(RunDirectory, Summary), RunError> {
    let setup = load_text("plate", DECK, &[]).expect("the deck is right");
    let options =
        RunOptions { directory: folder.join(threads.to_string()), threads: Some(threads), ..RunOptions::default() };
    let summary = execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent)?;
    Ok((RunDirectory::open(&options.directory).expect("the folder is there"), summary))
}

#[test]
fn frames_are_compressed_unless_the_deck_says_no() {
    let folder = tempfile::tempdir().unwrap();
    let frames = [None, Some("zlib"), Some("none")].map(|word| {
        let set: Vec<_> = word.map(|word| ("output.compression".to_owned(), word.to_owned())).into_iter().collect();
        let mut setup = load_text("plate", DECK, &set).unwrap();
        setup.model.time.max_steps = Some(3);
        let directory = folder.path().join(word.unwrap_or("default"));
        let options = RunOptions { directory, threads: Some(1), ..RunOptions::default() };
        execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).unwrap();
        let directory = RunDirectory::open(&options.directory).unwrap();
        let (_, last) = read_series(&directory).unwrap().pop().unwrap();
        let bytes = fs::read(&last).unwrap();
        let says_so = String::from_utf8_lossy(&bytes).contains("vtkZLibDataCompressor");
        let mut frame = FrameFile::open(&last).unwrap();
        let values = (frame.positions().unwrap(), frame.column("velocity").unwrap(), frame.column("stress").unwrap());
        (bytes.len(), says_so, format!("{values:?}"))
    });
    let [default, zlib, none] = frames;
    assert_eq!(default, zlib);
    assert!(zlib.1 && !none.1 && zlib.0 < none.0, "{} and {} bytes", zlib.0, none.0);
    assert_eq!(zlib.2, none.2);
}

/// A bar on its way to a wall that repels it from afar, which clumps as it is thrown back.
const THROWN_BACK: &str = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"20 us\" }\n\
    method = \"updated-lagrangian\"\n[[body]]\nname = \"bar\"\nmaterial = \"armco-iron\"\n\
    shape = { box = { min = [\"0 mm\", \"1 mm\"], max = [\"8 mm\", \"17 mm\"] } }\nvelocity = [\"0 m/s\", \"-200 m/s\"]\n\
    [[wall]]\nname = \"anvil\"\nplane = { point = [0, 0], normal = [0, 1] }\ncontact = \"monaghan-kos\"\n";

#[test]
fn what_a_warning_recommends_cures_the_deck_that_raised_it() {
    let folder = tempfile::tempdir().unwrap();
    let warnings = |name: &str, changes: &[(&str, &str)]| {
        let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
        let setup = load_text("bar", THROWN_BACK, &changes).unwrap();
        let options = RunOptions { directory: folder.path().join(name), threads: Some(1), ..RunOptions::default() };
        let summary = execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).unwrap();
        summary.warnings.into_iter().map(|warning| (warning.name, warning.cure)).collect::<Vec<_>>()
    };
    let found = warnings("ill", &[]);
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["wall-energy", "pairing"]);
    assert!(found[0].1.contains("use `contact = \"penalty\"` at the wall"), "{found:?}");
    assert!(found[1].1.contains("use `search = \"total-lagrangian\"`"), "{found:?}");
    // Each for itself, and both.
    let (wall, form) = (("wall.anvil.contact", "penalty"), ("search", "total-lagrangian"));
    assert!(warnings("wall", &[wall]).iter().all(|(name, _)| name != "wall-energy"));
    assert!(warnings("form", &[form]).iter().all(|(name, _)| name != "pairing"));
    assert_eq!(warnings("well", &[wall, form]), []);
}

#[test]
fn a_deck_runs_and_its_folder_tells_the_story() {
    let folder = tempfile::tempdir().unwrap();
    let (directory, summary) = run(folder.path(), 2).unwrap();
    assert_eq!((summary.particles, summary.simulated_time), (240, 2e-6));
    // The repulsion of the wall holds a fifth of the energy of so short a plate.
    let warnings: Vec<&str> = summary.warnings.iter().map(|warning| warning.name.as_str()).collect();
    assert_eq!((summary.status, warnings), (Status::CompletedWithWarnings, vec!["wall-energy"]));
    assert!(summary.steps > 20 && summary.mean_neighbors > 8.0 && summary.searched_fraction > 0.0);
    let height = summary.measures["height"].unwrap();
    assert!(height > 9.5e-3 && height < 10.0e-3, "{height}");

    // The wall has taken momentum, and energy is accounted for.
    let history = HistoryTable::read(&directory).unwrap();
    let (column, momentum) = history.column("body.bar.momentum_y").unwrap();
    assert_eq!(column.unit, "kg m/s/m");
    let (first, last) = (momentum[0], momentum[momentum.len() - 1]);
    assert!((first + 7890.0 * 6e-3 * 10e-3 * 200.0).abs() < 1e-9 && last > 0.95 * first, "{first} {last}");
    let impulse = history.column("external_impulse_y").unwrap().1;
    assert!((impulse[impulse.len() - 1] - (last - first)).abs() < 1e-6 * first.abs());
    assert!(summary.largest_momentum_drift < 1e-6 && summary.energy.largest_relative_drift < 1e-3);

    let series = read_series(&directory).unwrap();
    assert_eq!((series[0].0, series[series.len() - 1].0), (0.0, 2e-6));
    for (time, path) in &series {
        let mut frame = FrameFile::open(path).unwrap();
        assert_eq!((frame.header.time, frame.count), (*time, 240));
        assert_eq!((frame.bodies[0].name.as_str(), frame.bodies[0].material.as_str()), ("bar", "armco-iron"));
        assert!(frame.positions().unwrap().iter().flatten().all(|x| x.is_finite()));
    }

    // A quarter of the pixels, which take a quarter of the time.
    let paper = Paper { dpi: 50, ..Paper::default() };
    let pictures = plot_run(&directory, paper, PictureFormat::Png, &directory.plots()).unwrap();
    assert!(pictures.len() >= 9 && pictures.iter().all(|path| path.metadata().unwrap().len() > 2000), "{pictures:?}");
    let stress = FieldPicture { paper, ..FieldPicture::new("stress.yy") };
    plot_field(&directory, &stress, &folder.path().join("p.png")).unwrap();
}

#[test]
fn the_files_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let (one, _) = run(folder.path(), 1).unwrap();
    let (three, _) = run(folder.path(), 3).unwrap();
    let read = |path: &Path| std::fs::read(path).unwrap();
    assert_eq!(read(&one.history()), read(&three.history()));
    let (a, b) = (read_series(&one).unwrap(), read_series(&three).unwrap());
    assert_eq!(a.len(), b.len());
    for ((_, a), (_, b)) in a.iter().zip(&b) {
        assert_eq!(read(a), read(b), "{}", a.display());
    }
}

#[test]
fn what_is_found_broken_does_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    // Every check says something.
    let limits = "{ plastic-work = 0, wall-energy = 0, pairing = 0, compression = 0, expansion = 2, cold = \"1000 K\", hot = 0, \
                  time-step = 2, steps-left = 0 }";
    let warnings = |threads: usize| {
        let setup = load_text("plate", DECK, &[("warnings".to_owned(), limits.to_owned())]).expect("the deck is right");
        let directory = folder.path().join(format!("w{threads}"));
        let options = RunOptions { directory, threads: Some(threads), ..RunOptions::default() };
        execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).unwrap().warnings
    };
    let one = warnings(1);
    let names: Vec<&str> = one.iter().map(|warning| warning.name.as_str()).collect();
    for name in ["plastic-work", "cold", "hot", "wall-energy", "compression", "expansion", "time-step", "steps-left"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    assert_eq!(one, warnings(3));
}

#[test]
fn metal_that_a_shock_melts_without_a_temperature_is_told_with_both_temperatures() {
    let deck = r#"
        dimensions = "1d"
        particles = { spacing = "0.1 mm" }
        time = { end = "0.4 us" }
        output = { history-interval = "20 ns", frames = 1 }
        [[body]]
        name = "flyer"
        material = "ofhc-copper"
        shape = { box = { min = ["-3 mm"], max = ["0 mm"] } }
        velocity = ["4000 m/s"]
        [[body]]
        name = "target"
        material = "ofhc-copper"
        shape = { box = { min = ["0 mm"], max = ["3 mm"] } }
    "#;
    let folder = tempfile::tempdir().unwrap();
    let warned = |speed: &str, source: &str, method: &str| {
        let changes = [("body.flyer.velocity.0", speed), ("numerics.temperature", source), ("method", method)];
        let changes: Vec<_> = changes.map(|(path, value)| (path.to_owned(), value.to_owned())).to_vec();
        let setup = load_text("shock", deck, &changes).unwrap_or_else(|report| panic!("{report}"));
        let directory = folder.path().join(format!("{speed}-{source}-{method}"));
        let options = RunOptions { directory, threads: Some(1), ..RunOptions::default() };
        let warnings = execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).unwrap().warnings;
        warnings.into_iter().find(|warning| warning.name == "missing-heat")
    };
    for method in ["total-lagrangian", "updated-lagrangian"] {
        let warning = warned("4000 m/s", "plastic-work", method).expect("a warning");
        // "... (2349 K over 317 K)"
        let kelvins = warning.meaning.split(&['(', ')'][..]).nth(1).unwrap();
        let kelvins: Vec<f64> = kelvins.split(" over ").map(|k| k.trim_end_matches(" K").parse().unwrap()).collect();
        // It melts at 1356 K; all of the motion would heat by 4000^2/(2 383) K.
        assert!((1356.0..293.15 + 20_888.0).contains(&kelvins[0]), "{}", warning.meaning);
        assert!((290.0..700.0).contains(&kelvins[1]), "{}", warning.meaning);
        assert!((warning.value / (kelvins[0] / kelvins[1]) - 1.0).abs() < 0.01, "{warning:?}");
        assert!(warning.cure.contains("numerics.temperature = \"energy\""), "{}", warning.cure);
        // What it says cures it, and a weak shock is not told of.
        assert!(warned("4000 m/s", "energy", method).is_none(), "{method}");
        assert!(warned("300 m/s", "plastic-work", method).is_none(), "{method}");
    }
}

/// Stops nobody and prints nothing.
struct Quiet;

impl Observer for Quiet {}
impl Watcher for Quiet {}

#[test]
fn a_validation_goes_on_with_the_runs_that_the_same_program_finished() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("validate");
    let seconds = |resume: bool| -> Result<Vec<Option<f64>>, ValidateError> {
        let cases = vec!["heat-slab".to_owned()];
        let options =
            ValidateOptions { directory: folder.clone(), resume, cases, effort: Effort::Quick, threads: Some(1) };
        let report = validate(&options, &AtomicBool::new(false), &mut Quiet)?;
        assert!(report.passed, "{report}");
        Ok(report.cases[0].runs.iter().map(|run| run.seconds).collect())
    };
    seconds(false).unwrap();
    // Runs are known by the time they took.
    let mut runs: Vec<_> = fs::read_dir(folder.join("heat-slab")).unwrap().map(|entry| entry.unwrap().path()).collect();
    runs.retain(|run| run.join("summary.json").is_file());
    runs.sort();
    for run in &runs {
        let path = run.join("summary.json");
        let mut summary: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        summary["wall_seconds"] = 12345.0.into();
        fs::write(&path, summary.to_string()).unwrap();
    }
    // Of three: one was stopped before its end, one is of another deck.
    let stopped = fs::read_to_string(runs[0].join("summary.json")).unwrap().replace("\"completed\"", "\"stopped\"");
    fs::write(runs[0].join("summary.json"), stopped).unwrap();
    let deck = runs[1].join("deck.toml");
    fs::write(&deck, fs::read_to_string(&deck).unwrap() + "# changed\n").unwrap();

    let kept = |seconds: Vec<Option<f64>>| seconds.iter().filter(|&&s| s == Some(12345.0)).count();
    assert_eq!(kept(seconds(true).unwrap()), runs.len() - 2);
    assert_eq!(kept(seconds(false).unwrap()), 0);

    // A validation that has only begun takes nothing from the one before, however alike the runs are.
    let mark = folder.join("validation.txt");
    let begun = fs::read_to_string(&mark).unwrap();
    let program: String =
        begun.lines().filter(|line| !line.starts_with("heat-slab/")).map(|l| format!("{l}\n")).collect();
    for run in &runs {
        let path = run.join("summary.json");
        let mut summary: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        summary["wall_seconds"] = 12345.0.into();
        fs::write(&path, summary.to_string()).unwrap();
    }
    fs::write(&mark, program).unwrap();
    assert_eq!(kept(seconds(true).unwrap()), 0);

    fs::write(&mark, "Written by another program.\n").unwrap();
    assert!(matches!(seconds(true), Err(ValidateError::AnotherProgram { .. })));
    assert!(folder.join("report.json").is_file(), "nothing was changed");
}

#[test]
fn steps_that_are_too_long_are_repeated_and_the_answer_is_that_of_short_ones() {
    let folder = tempfile::tempdir().unwrap();
    let run = |courant: &str, more: &[(&str, &str)]| {
        let usual = [("time.courant", courant), ("particles.spacing", "\"0.5 mm\""), ("time.end", "\"1 us\"")];
        let settings: Vec<_> =
            usual.iter().chain(more).map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let text = sphorge::deck::decks::find("disc-on-plate").unwrap().text;
        let setup = load_text("disc-on-plate", text, &settings).unwrap();
        let directory = folder.path().join(format!("{courant}-{}", more.len()));
        let options = RunOptions { directory, ..RunOptions::default() };
        execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent)
    };
    let short = run("0.3", &[]).unwrap();
    let long = run("1.0", &[]).unwrap();
    assert!(
        short.repeated_steps == 0 && long.repeated_steps > 0 && long.steps < short.steps,
        "{}",
        long.repeated_steps
    );
    let ratio = |name: &str| long.measures[name].unwrap() / short.measures[name].unwrap();
    // The disc loses a fifteenth of its speed. The pressure is that of the first contact, which the long steps see less often.
    assert!((ratio("residual_velocity") - 1.0).abs() < 3e-3, "{}", ratio("residual_velocity"));
    assert!((ratio("max_pressure") - 1.0).abs() < 0.06, "{}", ratio("max_pressure"));
    assert!(long.energy.largest_relative_drift < 1e-8 && long.largest_momentum_drift < 1e-8);

    // Without, all goes on as if nothing were wrong.
    let wrong = run("1.0", &[("time.step-control.repeats", "0")]).unwrap();
    assert_eq!(wrong.repeated_steps, 0);
    let ratio = wrong.measures["max_pressure"].unwrap() / short.measures["max_pressure"].unwrap();
    assert!(ratio > 1.5, "{ratio}");
}
