//! A whole run that is saved and loaded in the middle tells the same story, to the last digit.

use super::*;
use crate::{
    deck::{Setup, load_text},
    engine::{ENGINES, persist::MemoryArchive},
    output::{StageSecondsRecord, Summary},
    run::Silent,
};
use std::{collections::BTreeMap, fs, path::Path};

/// A bar that hits a wall on its way, and a block that swings. Measures of every memory, tracers, audits, two kinds of work.
const DECK: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
particles = { spacing = "0.5 mm" }
audit = 7

[time]
end = "3 us"
stop-kinetic-fraction = 0.6

[output]
frame-interval = "0.7 us"
history-interval = "0.05 us"

[material.tough]
base = "armco-iron"
strength = "elastic"

[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = ["-3 mm", "0 mm"], max = ["3 mm", "10 mm"] } }
velocity = ["0 m/s", "-200 m/s"]

[[body]]
name = "block"
material = "tough"
shape = { box = { min = ["10 mm", "0 mm"], max = ["12 mm", "2 mm"] } }
velocity-profile = { along = "x", amplitude = ["20 m/s", "0 m/s"], rows = [["10 mm", -1.0], ["12 mm", 1.0]] }

[[region]]
name = "half"
body = "block"
shape = { box = { min = ["11 mm", "0 mm"], max = ["12 mm", "2 mm"] } }

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
velocity = ["0 m/s", [["0 us", "0 m/s"], ["3 us", "-60 m/s"]]]

[[measure]]
name = "height"
extent = { body = "bar", axis = "y" }

[[measure]]
name = "peak"
maximum = { body = "bar", field = "pressure", over-time = true }

[[measure]]
name = "front"
front-speed = { body = "bar", field = "velocity", component = "y", axis = "y", level = "-100 m/s", during = ["0.2 us", "1.5 us"] }

[[measure]]
name = "swing"
period = { region = "half", field = "velocity", component = "x" }

[[measure]]
name = "turn"
reversal-time = { region = "half", axis = "x" }

[[tracer]]
name = "tip"
point = ["0 mm", "0 mm"]

[[section]]
name = "waist"
point = ["0 mm", "5 mm"]
normal = [0, 1]
body = "bar"
"#;

fn setup() -> Setup {
    load_text("story", DECK, &[]).unwrap_or_else(|report| panic!("{report:?}"))
}

/// A run that has not begun.
fn new(folder: &Path) -> RunState {
    let Setup { model, particles, masses, .. } = setup();
    let simulation = Simulation::start(ENGINES[0], model, particles).unwrap();
    RunState::new(RunDirectory::create(folder, false).unwrap(), simulation, &masses, Pace::new(), Beginning::New)
        .unwrap()
}

fn saved(state: &mut RunState) -> MemoryArchive {
    let mut archive = MemoryArchive::new();
    state.persist("run", &mut archive).unwrap();
    archive.to_load()
}

/// Goes on to the end; history, list of frames and summary, without the seconds it took.
fn story(mut state: RunState, folder: &Path) -> (String, String, Summary) {
    let reason = loop {
        if let Some(reason) = state.end_reason() {
            break reason;
        }
        state.step(&mut Silent, 0).unwrap();
    };
    told(state, reason, folder)
}

/// History, list of frames and summary of a run that has ended, without the seconds it took.
pub(in crate::run) fn told(mut state: RunState, reason: EndReason, folder: &Path) -> (String, String, Summary) {
    state.close(&mut Silent).unwrap();
    let (summary, written) = state.recorder.summary(&state.simulation, reason, None, 1.0, None);
    written.unwrap();
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    let stage_seconds = StageSecondsRecord::default();
    // Buffers that were loaded are as large as they must be, those that grew are larger.
    let timeless = Summary { stage_seconds, peak_memory_bytes: 0, engine_memory_bytes: 0, ..summary };
    (read("history.csv"), read("fields.pvd"), timeless)
}

#[test]
fn a_run_resumed_anywhere_tells_the_same_story() {
    let root = tempfile::tempdir().unwrap();
    let folder = |name: &str| root.path().join(name);
    let mut whole = new(&folder("whole"));
    let mut archives = vec![("before".to_owned(), saved(&mut whole))];
    whole.begin(&mut Silent).unwrap();
    archives.push(("begun".to_owned(), saved(&mut whole)));
    for stop in [1, 6, 20, 45, 80] {
        while whole.simulation.steps() < stop {
            whole.step(&mut Silent, 0).unwrap();
        }
        archives.push((stop.to_string(), saved(&mut whole)));
    }
    let (history, frames, summary) = story(whole, &folder("whole"));
    assert!(summary.steps > 70 && frames.matches("DataSet").count() > 4, "{summary:?}");
    assert_eq!(summary.end_reason, EndReason::KineticEnergy);
    assert!(summary.measures.values().all(Option::is_some), "{summary:?}");
    assert!(summary.audit.is_some_and(|audit| audit.audits > 10));

    for (stop, mut archive) in archives {
        let mut state = new(&folder(&stop));
        // A run that has begun forgets that it has.
        if stop == "45" {
            state.begin(&mut Silent).unwrap();
        }
        state.persist("run", &mut archive).unwrap();
        if stop == "before" {
            state.begin(&mut Silent).unwrap();
        }
        let resumed = story(state, &folder(&stop));
        let rows = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        for (row, expected) in rows(&resumed.0).iter().zip(rows(&history)) {
            assert_eq!(*row, expected, "resumed at {stop}");
        }
        assert_eq!((resumed.0.len(), &resumed.1), (history.len(), &frames), "resumed at {stop}");
        assert_eq!(resumed.2, summary, "resumed at {stop}");
    }
}

#[test]
fn seconds_go_on_from_those_of_the_run_that_was_saved() {
    let root = tempfile::tempdir().unwrap();
    let mut pace = Pace::new();
    let mut archive = MemoryArchive::new();
    while pace.report(3, 0.5, true).is_none() {}
    let before = pace.seconds();
    pace.persist("pace", &mut archive).unwrap();
    let mut resumed = new(&root.path().join("run")).pace;
    resumed.persist("pace", &mut archive.to_load()).unwrap();
    assert!(resumed.seconds() > before && before > 0.0);
    // Speed is that since the last report, not since the first step.
    assert!(resumed.report(3, 0.5, true).is_none());
}

/// Values by name, of which one is spoiled.
struct Spoiled<'a> {
    values: &'a BTreeMap<String, Vec<u8>>,
    name: &'a str,
    /// In place of it; `None` for nothing at all.
    value: Option<Vec<u8>>,
}

impl Archive for Spoiled<'_> {
    fn is_saving(&self) -> bool {
        false
    }
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        let value = if name == self.name { self.value.as_ref() } else { self.values.get(name) };
        value.cloned().ok_or_else(|| ArchiveError::Missing(name.to_owned()))
    }
}

/// Takes every value.
#[derive(Default)]
struct Values(BTreeMap<String, Vec<u8>>);

impl Archive for Values {
    fn is_saving(&self) -> bool {
        true
    }
    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        assert!(self.0.insert(name.to_owned(), bytes).is_none(), "`{name}` is saved twice");
    }
    fn load(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        Err(ArchiveError::Missing(name.to_owned()))
    }
}

fn values_of(state: &mut RunState) -> BTreeMap<String, Vec<u8>> {
    let mut values = Values::default();
    state.persist("run", &mut values).unwrap();
    values.0
}

#[test]
fn what_an_archive_lacks_or_has_in_another_size_is_named() {
    let root = tempfile::tempdir().unwrap();
    let mut state = new(&root.path().join("whole"));
    state.begin(&mut Silent).unwrap();
    for _ in 0..8 {
        state.step(&mut Silent, 0).unwrap();
    }
    let values = values_of(&mut state);
    let of_the_run: Vec<&String> = values.keys().filter(|name| name.starts_with("run.")).collect();
    assert!(of_the_run.len() > 50, "{of_the_run:?}");
    for (k, name) in of_the_run.into_iter().enumerate() {
        let longer = [&values[name][..], &[0]].concat();
        let shorter = values[name].split_last().map(|(_, rest)| rest.to_vec());
        for value in [None, Some(longer), shorter] {
            let mut state = new(&root.path().join(format!("{k}-{}", value.as_ref().map_or(0, |v| 1 + v.len()))));
            let expected = match value {
                None => ArchiveError::Missing(name.clone()),
                Some(_) => ArchiveError::Mismatch(name.clone()),
            };
            let mut archive = Spoiled { values: &values, name, value };
            assert_eq!(state.persist("run", &mut archive), Err(expected));
        }
    }
}
