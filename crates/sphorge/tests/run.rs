//! A deck becomes a folder that can be read back, pictured and compared.

use sphorge::{
    deck::load_text,
    engine::ENGINES,
    output::{FrameFile, HistoryTable, RunDirectory, Status, Summary, read_series},
    plot::{FieldPicture, plot_field, plot_run},
    run::{RunError, RunOptions, Silent, execute},
};
use std::{path::Path, sync::atomic::AtomicBool};

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
        assert!(frame.positions().unwrap().iter().flatten().all(|x| x.is_finite()));
    }

    let pictures = plot_run(&directory).unwrap();
    assert!(pictures.len() >= 9 && pictures.iter().all(|path| path.metadata().unwrap().len() > 5000), "{pictures:?}");
    let section = FieldPicture { section: true, ..FieldPicture::new("stress.yy") };
    plot_field(&directory, &section, &folder.path().join("p.png")).unwrap();
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
