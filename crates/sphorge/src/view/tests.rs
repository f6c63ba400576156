//! What the page is given of runs written by hand.

use super::{ViewError, ViewSettings, run::ViewedRun, save_single_page};
use crate::{
    Particles, deck,
    output::{FrameHeader, RunDirectory, SeriesEntry, Status, Summary, testing, write_frame_file, write_series},
    plot::PlotError,
};
use serde_json::json;
use std::{fs, path::Path};

const COUNT: usize = 300;

/// Frames of a lattice that moves by 1 mm along x in each, far from the origin; pressure grows with the frame and along the lattice.
fn run(folder: &Path, name: &str, frames: usize) -> RunDirectory {
    let run = RunDirectory::create(&folder.join(name), false).unwrap();
    let mut particles = Particles::new(COUNT);
    let fields = ["body", "pressure", "velocity", "stress"].map(str::to_owned);
    let mut entries = Vec::new();
    for k in 0..frames {
        for i in 0..COUNT {
            particles.position[i] = [1e3 + 1e-3 * ((i % 20) + k) as f64, 1e-3 * (i / 20) as f64, 0.0];
            particles.pressure[i] = 1e6 * (i as f64 + k as f64);
            particles.velocity[i] = [3.0, 4.0, 0.0];
        }
        let time = 1e-6 * k as f64;
        let header = FrameHeader { time, step: k as u64, dimensions: 2, body_spacing: vec![1e-3] };
        let file = RunDirectory::frame_name(k, false);
        write_frame_file(&run.path().join(&file), &header, &particles, &fields).unwrap();
        entries.push(SeriesEntry { time, file });
    }
    write_series(&run, &entries).unwrap();
    run
}

#[test]
fn arrays_are_those_of_pictures_with_their_ranges() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "run", 2);
    let viewed = ViewedRun::open(run.path()).unwrap();
    let pressure = viewed.array(1, "pressure").unwrap();
    assert_eq!((pressure.width, pressure.values.len(), pressure.values[7]), (1, COUNT, 8e6));
    // Smallest, largest, the same without the outermost half percent, mean, number.
    assert_eq!(pressure.head[..6], [1e6, 300e6, 2e6, 299e6, 150.5e6, 300.0]);
    let bytes = pressure.bytes();
    assert_eq!(bytes.len(), 64 + 4 * COUNT);
    assert_eq!(bytes[64 + 28..64 + 32], 8e6f32.to_le_bytes());
    assert_eq!(viewed.array(0, "velocity").unwrap().values[3], 5.0);
    assert_eq!(viewed.array(0, "velocity.Y").unwrap().values[3], 4.0);
    let moved = viewed.array(1, "displacement.x").unwrap().values[3];
    assert!((moved - 1e-3).abs() < 1e-9, "{moved}");
}

#[test]
fn positions_far_away_keep_their_digits() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "run", 3);
    let viewed = ViewedRun::open(run.path()).unwrap();
    let origin = viewed.origin(&run).unwrap();
    let positions = viewed.array(2, "position").unwrap();
    for axis in 0..2 {
        let place = origin[axis] + f64::from(positions.values[3 * 45 + axis]);
        let exact = [1e3 + 1e-3 * 7.0, 1e-3 * 2.0][axis];
        assert!((place - exact).abs() < 1e-9, "{axis}: {place}");
    }
    let (low, high) = (positions.head[0], positions.head[1]);
    assert!((high - low - 0.019).abs() < 1e-9 && (low + origin[0] - 1000.002).abs() < 1e-9, "{low} {high}");
}

#[test]
fn a_particle_tells_all_its_fields() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "run", 1);
    let particle = ViewedRun::open(run.path()).unwrap().particle(0, 45).unwrap();
    let of = |name: &str| particle.fields.iter().find(|field| field.name == name).map(|field| field.values.clone());
    assert_eq!(particle.position[1], 2e-3);
    assert_eq!(
        (of("pressure"), of("velocity"), of("speed")),
        (Some(vec![45e6]), Some(vec![3.0, 4.0, 0.0]), Some(vec![5.0]))
    );
    assert_eq!(of("stress").map(|values| values.len()), Some(6));
}

#[test]
fn what_is_not_there_is_named_with_what_is_near() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "run", 2);
    let viewed = ViewedRun::open(run.path()).unwrap();
    let Err(ViewError::Plot(PlotError::Field { near, available, .. })) = viewed.array(0, "presure") else { panic!() };
    assert!(near.contains("`pressure`") && available.contains("speed"), "{near} {available}");
    assert!(matches!(viewed.array(2, "pressure"), Err(ViewError::Plot(PlotError::Frame { .. }))));
    assert!(matches!(viewed.particle(0, COUNT), Err(ViewError::Plot(PlotError::Empty { .. }))));
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    for none in [&empty, &folder.path().join("none")] {
        assert!(matches!(ViewedRun::open(none), Err(ViewError::Output(crate::output::OutputError::NoRun { .. }))));
    }
}

#[test]
fn frames_that_are_written_meanwhile_are_there_and_another_run_is_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let first = run(folder.path(), "run", 2);
    let path = first.path().to_owned();
    let viewed = ViewedRun::open(&path).unwrap();
    let told = || serde_json::to_value(viewed.describe(None)).unwrap();
    let before = told();
    assert_eq!(
        (before["times"].as_array().unwrap().len(), &before["is_open"], &before["error"]),
        (2, &true.into(), &().into())
    );
    drop(first);
    fs::remove_dir_all(&path).unwrap();
    let gone = told();
    assert!(gone["error"].as_str().unwrap().contains("it does not exist"), "{gone}");
    let _other = run(folder.path(), "run", 5);
    let after = told();
    assert_eq!(after["times"].as_array().unwrap().len(), 5);
    assert_ne!(after["identity"], before["identity"]);
}

#[test]
fn a_run_that_is_written_goes_on_and_one_that_nobody_writes_does_not() {
    let folder = tempfile::tempdir().unwrap();
    let written = run(folder.path(), "run", 2);
    let viewed = ViewedRun::open(written.path()).unwrap();
    let status = || serde_json::to_value(viewed.describe(None)).unwrap()["status"].clone();
    assert_eq!(status(), "running");
    drop(written);
    assert_eq!(status(), "interrupted");
}

#[test]
fn a_run_that_goes_on_has_warned_as_its_history_says_by_the_names_that_are_known() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "run", 2);
    let viewed = ViewedRun::open(run.path()).unwrap();
    let told = || {
        let told = serde_json::to_value(viewed.describe(None)).unwrap();
        (told["warnings"].clone(), told["warned"].as_u64().unwrap())
    };
    let rows = |counts: &str| fs::write(run.history(), format!("time,warnings\n{counts}")).unwrap();
    rows("0,0\n1e-6,0\n");
    assert_eq!(told(), (json!([]), 0));
    rows("0,0\n1e-6,2\n");
    assert_eq!(told(), (json!([]), 2));
    // It stops, and goes on.
    let warnings = ["hot", "wall-energy"].map(testing::warning).to_vec();
    let stopped = Summary { status: Status::Stopped, warnings, ..testing::summary(1.0) };
    stopped.write(&run).unwrap();
    assert_eq!(told(), (json!(["hot", "wall-energy"]), 2));
    fs::remove_file(run.summary()).unwrap();
    assert_eq!(told(), (json!(["hot", "wall-energy"]), 2));
    rows("0,0\n1e-6,3\n");
    assert_eq!(told(), (json!(["hot", "wall-energy"]), 3));
    // From a state before the second.
    rows("0,0\n1e-6,1\n");
    assert_eq!(told(), (json!(["hot"]), 1));
}

#[test]
fn what_of_a_run_cannot_be_read_is_told_by_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "run", 2);
    let folders = [run.path().to_owned()];
    let to = folder.path().join("page.html");
    let save = || {
        let page = save_single_page(&folders, &ViewSettings::default(), 10_000_000, &to, true).unwrap();
        let text = fs::read_to_string(&to).unwrap();
        assert!(page.damaged.iter().all(|words| text.contains(&words.replace('<', "\\u003c"))), "{:?}", page.damaged);
        (page.damaged, text.contains("with a damaged summary"))
    };
    let _ = fs::remove_file(run.history());
    let told = |history: Option<&str>, summary: Option<&str>| {
        if let Some(text) = history {
            fs::write(run.history(), text).unwrap();
        }
        if let Some(text) = summary {
            fs::write(run.summary(), text).unwrap();
        }
        save()
    };
    let (damaged, _) = told(None, None);
    assert!(damaged.len() == 1 && damaged[0].contains("no curves"), "{damaged:?}");
    let (damaged, is_damaged) = told(Some("step,time\n0,0\n"), None);
    assert!(damaged.is_empty() && !is_damaged, "{damaged:?}");
    for text in ["", "\n", "step,time\n0\n"] {
        let (damaged, _) = told(Some(text), None);
        assert!(damaged.len() == 1 && damaged[0].contains("no curves"), "{damaged:?}");
    }
    let (damaged, is_damaged) = told(None, Some("{ \"status\""));
    assert!(is_damaged && damaged.len() == 2 && damaged[0].contains("how the run ended is not known"), "{damaged:?}");
}

#[test]
fn a_single_page_stays_below_its_size_and_tells_what_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let run = run(folder.path(), "a<!--b", 40);
    let folders = [run.path().to_owned()];
    let settings = ViewSettings { fields: vec!["velocity.x".into(), "pressure".into()], ..ViewSettings::default() };
    let to = folder.path().join("page.html");
    let whole = save_single_page(&folders, &settings, 10_000_000, &to, false).unwrap();
    let text = fs::read_to_string(&to).unwrap();
    assert_eq!(whole.bytes, text.len());
    assert!(text.contains("a\\u003c!--b") && !text.contains("a<!--b"));
    let data = text.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["runs"][0]["times"].as_array().unwrap().len(), 40);
    let names: Vec<&str> =
        data["runs"][0]["fields"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["velocity.x", "pressure", "body"]);
    // Half of the room that the numbers take.
    let own = super::parts::page_with_parts("").len();
    let most = own + (whole.bytes - own) / 2;
    let half = save_single_page(&folders, &settings, most, &to, true).unwrap();
    assert!(half.bytes <= most && half.bytes > own + (most - own) * 3 / 4, "{} of {most}", half.bytes);
    assert!(half.left_out[0].contains("of 40 frames, at most"), "{:?}", half.left_out);
    assert!(matches!(save_single_page(&folders, &settings, 50_000, &to, true), Err(ViewError::Size { .. })));
}

#[test]
fn the_page_has_the_units_of_decks() {
    let script = include_str!("page/units.js");
    let table = script.split_once("const UNITS = {\n").unwrap().1.split_once("\n};").unwrap().0;
    let symbol_of = |line: &str| line.trim().split_once(": [").unwrap().0.trim_matches('"').to_owned();
    let symbols: Vec<String> = table.lines().map(symbol_of).collect();
    assert_eq!(symbols, deck::unit_symbols().collect::<Vec<_>>());
    for (line, symbol) in table.lines().zip(symbols) {
        // `Pa: [1, [-1, 1, -2, 0], true],`: the factor, the powers of metre, kilogram, second and kelvin, and whether it takes prefixes.
        let (factor, rest) = line.split_once(": [").unwrap().1.split_once(", [").unwrap();
        let (powers, prefixes) = rest.split_once("], ").unwrap();
        let terms = factor.split(" * ").flat_map(|product| product.split(" / ")).map(|number| match number {
            "Math.PI" => std::f64::consts::PI,
            number => number.parse().unwrap(),
        });
        let terms: Vec<f64> = terms.collect();
        let factor = match (&terms[..], factor.contains('/')) {
            (&[number], false) => number,
            (&[a, b], false) => a * b,
            (&[a, b], true) => a / b,
            _ => panic!("{line}"),
        };
        let powers: Vec<i32> = powers.split(", ").map(|power| power.parse().unwrap()).collect();
        let base = ["m", "kg", "s", "K"].iter().zip(&powers).filter(|(_, power)| **power != 0);
        let own = base.map(|(unit, power)| format!("{unit}^{power}")).collect::<Vec<_>>().join(" ");
        let value = deck::read_quantity(&format!("1 {symbol}"), &own).unwrap();
        assert!((value / factor - 1.0).abs() < 1e-12, "{line}: {value}");
        let prefixed = deck::read_quantity(&format!("1 G{symbol}"), &own);
        assert_eq!(prefixed.is_ok(), prefixes.starts_with("true"), "{line}: {prefixed:?}");
    }
}
