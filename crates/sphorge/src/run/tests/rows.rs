//! Rows whose sums an engine takes while it goes on.

use super::*;
use crate::{
    engine::reduction::{Answers, Question},
    model::{StepControl, TimeControl},
    run::CheckpointPlan,
};
use sphorge_physics::step_control::StepChange;
use std::sync::{Mutex, PoisonError};

/// What the engine is asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Step,
    /// The sums of a row are asked for, and waited for.
    Ask,
    Wait,
    /// Its state is saved.
    Save,
}

/// What happened, and what goes otherwise than it should.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    events: Arc<Mutex<Vec<Event>>>,
    /// From when on sums are lost.
    lost_from: Option<f64>,
    /// Sums are waited for as on a processor.
    are_waited_for: bool,
    /// Where frames are copied out while it goes on, too: from when on they are lost.
    copies_lost_from: Option<f64>,
    /// When steps that fail go well once they are smaller, or it is later than this.
    fails_until: Option<f64>,
}

/// Sums that were taken when they were asked for.
struct Queued {
    rows: Rows,
    answers: Option<Answers>,
}

impl Rows {
    fn note(&self, event: Event) {
        self.events.lock().unwrap_or_else(PoisonError::into_inner).push(event);
    }

    fn events(&self) -> Vec<Event> {
        self.events.lock().unwrap().clone()
    }

    /// Whether a step of an engine that is to fail goes well.
    pub(super) fn passes(&self, engine: &Clockwork) -> bool {
        self.fails_until.is_some_and(|end| engine.dt < 0.6 * DT || engine.time > end)
    }

    pub(super) fn queue(
        &self,
        engine: &Clockwork,
        asked: &[Reduction<'_>],
    ) -> Result<Option<Box<dyn QueuedSums>>, RunFailure> {
        if self.are_waited_for {
            return Ok(None);
        }
        self.note(Event::Ask);
        let found = asked.iter().map(|of| Ok((Question::of(of), engine.reduce(of)?)));
        let found = found.collect::<Result<Vec<_>, RunFailure>>()?;
        let is_there = self.lost_from.is_none_or(|lost| engine.time < lost);
        let answers = Answers::new(engine.count(), engine.ledger()?, found);
        Ok(Some(Box::new(Queued { rows: self.clone(), answers: is_there.then_some(answers) })))
    }
}

impl QueuedSums for Queued {
    fn wait(self: Box<Self>) -> Result<Answers, RunFailure> {
        self.rows.note(Event::Wait);
        std::thread::sleep(Duration::from_millis(2));
        self.answers.ok_or_else(|| RunFailure::of_engine("the sums are lost".into()))
    }
}

impl Clockwork {
    pub(super) fn note(&self, event: Event) {
        self.rows.iter().for_each(|rows| rows.note(event));
    }
}

/// Starts [`Clockwork`] with rows that are summed while it goes on; with a time, fails there.
#[derive(Debug)]
struct GoingOn(Option<f64>, Rows);

impl EngineKind for GoingOn {
    fn name(&self) -> &'static str {
        "clockwork"
    }
    fn supports(&self, _: &Model) -> Result<(), Unsupported> {
        Ok(())
    }
    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let (fail_at, rows) = (self.0, Some(self.1.clone()));
        Ok(Box::new(Clockwork {
            model,
            particles,
            time: 0.0,
            steps: 0,
            fail_at,
            copies_lost_from: self.1.copies_lost_from,
            rows,
            dt: 0.0,
        }))
    }
}

/// Runs the engine; the rows that there are then.
fn history(kind: &dyn EngineKind, model: Model, checkpoints: CheckpointPlan) -> (String, Result<Summary, RunError>) {
    let folder = tempfile::tempdir().unwrap();
    let options =
        RunOptions { directory: folder.path().join("run"), threads: Some(2), checkpoints, ..RunOptions::default() };
    let ended = execute(setup(model), kind, &options, &AtomicBool::new(false), &mut Silent);
    let directory = RunDirectory::open(&options.directory).unwrap();
    (fs::read_to_string(directory.history()).unwrap(), ended)
}

/// The same of an engine that waits for its rows, and of one that goes on; what happened to this.
fn compare(
    model: &Model,
    fail_at: Option<f64>,
    checkpoints: CheckpointPlan,
) -> (Vec<Event>, Result<Summary, RunError>) {
    let (waiting, _) = history(&ClockworkKind(fail_at), model.clone(), CheckpointPlan::default());
    let rows = Rows::default();
    let (going_on, ended) = history(&GoingOn(fail_at, rows.clone()), model.clone(), checkpoints);
    assert_eq!(going_on, waiting);
    assert!(waiting.lines().count() > 5, "{waiting}");
    let events = rows.events();
    assert_eq!(events.iter().filter(|of| **of == Event::Ask).count(), waiting.lines().count() - 2);
    (events, ended)
}

/// What comes after each time that sums are asked for.
fn after_asking(events: &[Event]) -> Vec<[Event; 2]> {
    let places = (0..events.len()).filter(|k| events[*k] == Event::Ask);
    places.map(|k| [events[k + 1], events.get(k + 2).copied().unwrap_or(Event::Step)]).collect()
}

#[test]
fn sums_of_a_row_are_looked_at_when_the_next_step_is_taken() {
    let (events, ended) = compare(&model(), None, CheckpointPlan::default());
    let after = after_asking(&events);
    // The last row is that of the end.
    let (last, others) = after.split_last().unwrap();
    assert!(others.iter().all(|after| *after == [Event::Step, Event::Wait]), "{after:?}");
    assert_eq!(last[0], Event::Wait);
    assert_eq!(ended.unwrap().energy.kinetic, (-5.0f64).exp());
}

#[test]
fn a_row_is_written_though_the_next_step_fails() {
    // Rows are those of the first steps past the tenths of a second; the step behind one of them fails.
    let row = (0.5 / DT).ceil() * DT;
    let mut model = model();
    model.output.frame_interval = 2.0;
    let (events, ended) = compare(&model, Some(row - 0.5 * DT), CheckpointPlan::default());
    assert!(ended.is_err());
    assert_eq!(events[events.len() - 3..], [Event::Ask, Event::Step, Event::Wait]);
}

#[test]
fn a_rule_of_the_kinetic_energy_waits_for_its_row() {
    let model = model();
    let model = Model { time: TimeControl { stop_kinetic_fraction: Some(0.05), ..model.time.clone() }, ..model };
    let (events, ended) = compare(&model, None, CheckpointPlan::default());
    assert_eq!(ended.unwrap().end_reason, EndReason::KineticEnergy);
    assert!(after_asking(&events).iter().all(|after| after[0] == Event::Wait));
}

#[test]
fn a_state_is_saved_with_all_rows() {
    let saved_with_all = |events: &[Event]| {
        let mut is_owed = false;
        for event in events {
            match event {
                Event::Ask => is_owed = true,
                Event::Wait => is_owed = false,
                Event::Save => assert!(!is_owed, "{events:?}"),
                Event::Step => {}
            }
        }
    };
    let some_right_after_a_row = |events: &[Event]| {
        let right_after = |of: &[Event]| of == [Event::Ask, Event::Wait, Event::Save];
        assert!(events.windows(3).any(right_after), "{events:?}");
    };
    // Checkpoints at the times of rows.
    let plan = CheckpointPlan { interval: Some(0.1), ..CheckpointPlan::default() };
    let (events, ended) = compare(&model(), None, plan);
    ended.unwrap();
    saved_with_all(&events);
    some_right_after_a_row(&events);
    // States to go back to where a step fails, at any times: how long saving takes decides.
    let largest = StepChange { density: 1.0, stretch: 1.0, energy: 1.0, jump: 1.0 };
    let mut controlled = model();
    controlled.time.step_control = Some(StepControl { largest, repeats: 3 });
    controlled.output.history_interval = 1e-3;
    let (events, ended) = compare(&controlled, None, CheckpointPlan::default());
    ended.unwrap();
    saved_with_all(&events);
    // One is kept before a step that has failed comes again; this one is behind a row.
    let row = (0.5 / DT).ceil() * DT;
    controlled.output.frame_interval = 2.0;
    controlled.output.history_interval = 0.1;
    let rows = Rows { fails_until: Some(row + 2.5 * DT), ..Rows::default() };
    let (_, ended) = history(&GoingOn(Some(row - 0.5 * DT), rows.clone()), controlled, CheckpointPlan::default());
    assert!(ended.unwrap().repeated_steps > 0);
    saved_with_all(&rows.events());
    some_right_after_a_row(&rows.events());
}

#[test]
fn a_run_that_goes_back_from_a_step_behind_a_row_has_each_row_once() {
    let row = (0.5 / DT).ceil() * DT;
    let largest = StepChange { density: 1.0, stretch: 1.0, energy: 1.0, jump: 1.0 };
    let mut model = model();
    model.output.frame_interval = 2.0;
    model.time.step_control = Some(StepControl { largest, repeats: 3 });
    let [going_on, waiting] = [false, true].map(|are_waited_for| {
        let rows = Rows { are_waited_for, fails_until: Some(row + 2.5 * DT), ..Rows::default() };
        let (text, ended) = history(&GoingOn(Some(row - 0.5 * DT), rows), model.clone(), CheckpointPlan::default());
        assert!(ended.unwrap().repeated_steps > 0);
        text
    });
    assert_eq!(going_on, waiting);
    assert_eq!(waiting.lines().count(), 12, "{waiting}");
}

#[test]
fn an_engine_that_is_lost_keeps_the_rows_that_were_there() {
    let rows = Rows { lost_from: Some(0.45), ..Rows::default() };
    let (text, ended) = history(&GoingOn(None, rows), model(), CheckpointPlan::default());
    assert!(ended.unwrap_err().to_string().contains("the sums are lost"));
    // Of 0, 0.1, ... 0.4 s.
    assert_eq!(text.lines().count(), 6, "{text}");
}

#[test]
fn a_frame_that_is_lost_when_a_run_goes_back_takes_none_before_it_along() {
    let folder = tempfile::tempdir().unwrap();
    let largest = StepChange { density: 1.0, stretch: 1.0, energy: 1.0, jump: 1.0 };
    let mut model = model();
    model.time.step_control = Some(StepControl { largest, repeats: 3 });
    // The frame of 0.5 s is under way when the second step behind it fails.
    let rows = Rows { copies_lost_from: Some(0.5), fails_until: Some(0.52), ..Rows::default() };
    let options = RunOptions { directory: folder.path().join("run"), threads: Some(2), ..RunOptions::default() };
    let kind = GoingOn(Some(0.5 + 0.5 * DT), rows);
    let ended = execute(setup(model), &kind, &options, &AtomicBool::new(false), &mut Silent);
    let RunError::Output { source } = ended.unwrap_err() else { panic!("a frame that is not there") };
    assert!(source.chain().contains("lost"), "{}", source.chain());
    let frames = read_series(&RunDirectory::open(&options.directory).unwrap()).unwrap();
    assert_eq!(frames.iter().map(|(time, _)| *time).collect::<Vec<_>>(), [0.0, 0.25]);
    assert!(frames.iter().all(|(_, file)| FrameFile::is_whole(file, false)));
}
