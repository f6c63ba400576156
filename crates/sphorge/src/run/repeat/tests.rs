//! Steps of real runs that are taken back.

use super::*;
use crate::{
    deck::{Setup, load_text},
    engine::{ENGINES, Simulation},
    output::{RunDirectory, Summary},
    run::{
        Silent,
        progress::Pace,
        state::{Beginning, tests::told},
    },
};
use std::path::Path;

/// A block that strikes one at rest and slides along a wall. Steps may change little: some of the strike are repeated.
const DECK: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }

[time]
end = "6 us"
step-control = { stretch = 0.002, repeats = 4 }

[output]
frame-interval = "0.9 us"
history-interval = "0.1 us"

[[body]]
name = "hammer"
material = "ofhc-copper"
shape = { box = { min = ["0 mm", "0.5 mm"], max = ["6 mm", "6.5 mm"] } }
velocity = ["120 m/s", "0 m/s"]

[[body]]
name = "anvil"
material = "ofhc-copper"
shape = { box = { min = ["6.3 mm", "0.5 mm"], max = ["12.3 mm", "6.5 mm"] } }

[[wall]]
name = "table"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }
"#;

fn state(deck: &str, folder: &Path, beginning: Beginning) -> RunState {
    let setup = load_text("strike", deck, &[]).unwrap_or_else(|report| panic!("{report:?}"));
    let Setup { model, particles, masses, .. } = setup;
    let simulation = Simulation::start(ENGINES[0], model, particles).unwrap();
    let directory = match beginning {
        Beginning::New => RunDirectory::create(folder, false).unwrap(),
        Beginning::Resumed => RunDirectory::open(folder).unwrap(),
    };
    RunState::new(directory, simulation, &masses, Pace::new(), beginning).unwrap()
}

/// History, list of frames and summary of a run that keeps its state as seldom as that; with a step, it is saved after that one and goes on in
/// another process.
fn story(deck: &str, sparseness: f64, resumed_after: Option<u64>) -> (String, String, Summary) {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("run");
    let mut state = state_begun(deck, &folder);
    let repeater = |state: &RunState| Repeater { sparseness, ..Repeater::new(&state.simulation) };
    let mut own = repeater(&state);
    let reason = loop {
        if let Some(reason) = state.end_reason() {
            break reason;
        }
        let before = state.simulation.steps();
        own.step(&mut Watched { state: &mut state, observer: &mut Silent }).unwrap();
        if state.simulation.steps() <= before {
            // Frames that the run has gone back behind are no longer there.
            state.recorder.flush().unwrap();
        }
        if resumed_after == Some(state.simulation.steps()) {
            let mut archive = MemoryArchive::new();
            state.save(&mut archive).unwrap();
            drop(state);
            state = self::state(deck, &folder, Beginning::Resumed);
            state.load(&mut archive.reader()).unwrap();
            state.recorder.rewrite().unwrap();
            own = repeater(&state);
        }
    };
    told(state, reason, &folder)
}

fn state_begun(deck: &str, folder: &Path) -> RunState {
    let mut state = state(deck, folder, Beginning::New);
    state.begin(&mut Silent).unwrap();
    state
}

#[test]
fn it_does_not_matter_when_states_are_kept_nor_whether_a_run_was_resumed() {
    let whole = story(DECK, f64::INFINITY, None);
    assert!(whole.2.repeated_steps > 3, "{}", whole.2.repeated_steps);
    assert!(whole.0.contains(",repeat,"), "no row has a step that was cut");
    assert_eq!(story(DECK, 0.0, None), whole);
    let middle = whole.2.steps / 2;
    assert_eq!(story(DECK, 0.0, Some(middle)), whole);
    assert_eq!(story(DECK, f64::INFINITY, Some(middle)), whole);
}

#[test]
fn without_step_control_nothing_is_repeated_and_with_the_usual_limits_neither() {
    let deck = |control: &str| DECK.replace("{ stretch = 0.002, repeats = 4 }", control);
    let (usual, never) = (story(&deck("{}"), 0.0, None), story(&deck("{ stretch = 0.006, repeats = 0 }"), 0.0, None));
    assert_eq!(usual.2.repeated_steps, 0);
    assert_eq!(usual, never);
}

#[test]
fn a_step_that_fails_again_and_again_ends_the_run_with_its_name() {
    // A share of the square of the step: 4 halvings are too few.
    let deck = DECK.replace("stretch = 0.002", "jump = 1e-12");
    let place = tempfile::tempdir().unwrap();
    let mut state = state_begun(&deck, &place.path().join("run"));
    let mut repeater = Repeater::new(&state.simulation);
    let failure = loop {
        match repeater.step(&mut Watched { state: &mut state, observer: &mut Silent }) {
            Ok(_) => {}
            Err(Trouble::Engine(failure)) => break failure,
            Err(trouble) => panic!("{trouble:?}"),
        }
    };
    assert_eq!((failure.step, failure.field), (state.simulation.steps() + 1, "position"));
    assert!(failure.particle.is_some() && failure.position.is_some());
    let told = failure.to_string();
    assert!(told.contains("more than the 1e-12 of `time.step-control`"), "{told}");
    assert!(told.contains("of the stable step did not help"), "{told}");
}
