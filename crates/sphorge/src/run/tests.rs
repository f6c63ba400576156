//! Whole runs with an engine that only counts time.

mod rows;

use super::{drive::execute, *};
use crate::{
    deck::Setup,
    engine::{
        BodyLedger, Column, Energies, Engine, EngineKind, FieldSource, Ledger, LimitReason, Reduction, RunFailure,
        SearchReport, Simulation, TimeStepLimit, Unsupported,
        persist::{Archive, ArchiveError, Persist},
        reduction::{self, QueuedSums},
    },
    geometry::FilledMass,
    model::{Measure, MeasureKind, Model, ParticleSelection, WarningKind},
    output::{EndReason, FrameFile, HistoryTable, RunDirectory, Status, Summary, read_series, testing},
    particles::Particles,
};
use std::{
    fs,
    ops::ControlFlow,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// An engine that only counts time: two particles, the second of which flies off at 3 m/s; kinetic energy decays to `exp(-5 t)`.
struct Clockwork {
    model: Arc<Model>,
    particles: Particles,
    time: f64,
    steps: u64,
    fail_at: Option<f64>,
    /// Where frames are copied out while it goes on: from when on those of a tenth of a second are lost.
    copies_lost_from: Option<f64>,
    /// Where rows are summed while it goes on.
    rows: Option<rows::Rows>,
    /// Of the last step.
    dt: f64,
}

/// Starts [`Clockwork`]; with a time, fails there.
#[derive(Debug)]
struct ClockworkKind(Option<f64>);

const DT: f64 = 0.0037;

impl EngineKind for ClockworkKind {
    fn name(&self) -> &'static str {
        "clockwork"
    }
    fn supports(&self, model: &Model) -> Result<(), Unsupported> {
        let what = || Unsupported { what: "gravity".into(), help: "leave `gravity` out".into() };
        if model.gravity == [0.0; 3] { Ok(()) } else { Err(what()) }
    }
    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        Ok(Box::new(Clockwork {
            model,
            particles,
            time: 0.0,
            steps: 0,
            fail_at: self.0,
            copies_lost_from: None,
            rows: None,
            dt: 0.0,
        }))
    }
}

/// The same, which lets fields be read while it goes on: when it fails, and from when on copies are lost.
#[derive(Debug)]
struct CopyingKind(Option<f64>, f64);

impl EngineKind for CopyingKind {
    fn name(&self) -> &'static str {
        "clockwork"
    }
    fn supports(&self, _: &Model) -> Result<(), Unsupported> {
        Ok(())
    }
    fn start(&self, model: Arc<Model>, particles: Particles) -> Result<Box<dyn Engine>, RunFailure> {
        let (fail_at, copies_lost_from) = (self.0, Some(self.1));
        Ok(Box::new(Clockwork {
            model,
            particles,
            time: 0.0,
            steps: 0,
            fail_at,
            copies_lost_from,
            rows: None,
            dt: 0.0,
        }))
    }
}

/// Fields that arrive when the run has long gone on, or never.
struct Copied {
    particles: Particles,
    is_lost: bool,
}

impl FieldSource for Copied {
    fn count(&self) -> usize {
        self.particles.len()
    }
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        std::thread::sleep(Duration::from_millis(5));
        if self.is_lost { Err(RunFailure::of_engine("lost".into())) } else { self.particles.read(field) }
    }
}

impl Engine for Clockwork {
    fn detach(&self) -> Result<Option<Box<dyn FieldSource + Send>>, RunFailure> {
        let Some(lost_from) = self.copies_lost_from else { return Ok(None) };
        Ok(Some(Box::new(Copied {
            particles: self.particles.clone(),
            is_lost: (lost_from..lost_from + 0.1).contains(&self.time),
        })))
    }
    fn queue_sums(&self, asked: &[Reduction<'_>]) -> Result<Option<Box<dyn QueuedSums>>, RunFailure> {
        self.rows.as_ref().map_or(Ok(None), |rows| rows.queue(self, asked))
    }
    fn begin(&mut self, dt: f64) -> Result<(), RunFailure> {
        self.note(rows::Event::Step);
        self.time += dt;
        self.dt = dt;
        self.steps += u64::from(dt > 0.0);
        self.particles.position[1][0] = 3.0 * self.time;
        Ok(())
    }
    fn refresh_neighbors(&mut self) -> Result<SearchReport, RunFailure> {
        Ok(SearchReport { searched_fraction: if self.steps.is_multiple_of(2) { 1.0 } else { 0.0 } })
    }
    fn kinematics(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn stress(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn forces(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn finish(&mut self) -> Result<(), RunFailure> {
        Ok(())
    }
    fn guard(&self) -> Result<(), RunFailure> {
        if self.fail_at.is_none_or(|t| self.time < t + DT) || self.rows.as_ref().is_some_and(|rows| rows.passes(self)) {
            return Ok(());
        }
        Err(RunFailure {
            step_may_be_smaller: self.rows.is_some(),
            field: "velocity",
            particle: Some(0),
            body: Some(0),
            position: Some([0.0; 3]),
            ..RunFailure::of_engine("velocity is not a number".into())
        })
    }
    fn time_step_limit(&self) -> Result<TimeStepLimit, RunFailure> {
        Ok(TimeStepLimit { dt: DT, reason: LimitReason::SoundSpeed })
    }
    fn count(&self) -> usize {
        self.particles.len()
    }
    fn pairs(&self) -> u64 {
        2
    }
    fn ledger(&self) -> Result<Ledger, RunFailure> {
        let kinetic = (-5.0 * self.time).exp();
        let energies = Energies { kinetic, internal: 1.0 - kinetic, elastic: 0.0, plastic_work: 0.5 };
        let total = BodyLedger { energies, momentum_scale: 2.0, momentum: [1.0, 0.0, 0.0], ..BodyLedger::default() };
        Ok(Ledger { bodies: vec![total], total, ..Ledger::default() })
    }
    fn reduce(&self, reduction: &Reduction<'_>) -> Result<Vec<f64>, RunFailure> {
        Ok(reduction::evaluate(reduction, &self.model, &self.particles))
    }
    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.particles.read(field)
    }
    fn persist(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        if self.rows.is_some() {
            self.note(rows::Event::Save);
            self.time.persist("clockwork.time", archive)?;
            self.steps.persist("clockwork.steps", archive)?;
            return self.particles.position[1][0].persist("clockwork.place", archive);
        }
        Err(ArchiveError::Unsupported("a clockwork saves nothing".into()))
    }
    fn memory_bytes(&self) -> u64 {
        7
    }
}

/// A second with frames every 0.25 s and rows every 0.1 s, measuring the extent.
fn model() -> Model {
    let mut model = testing::model(&["bar"]);
    model.output.frame_interval = 0.25;
    model.output.history_interval = 0.1;
    // The two particles start at one place.
    model.warnings.set(WarningKind::Pairing, None);
    let kind = MeasureKind::Extent { selection: ParticleSelection::default(), axis: 0 };
    model.measures = vec![Measure { name: "length".into(), kind }];
    model
}

/// What a run of [`Clockwork`] starts from.
fn setup(model: Model) -> Setup {
    let mut particles = Particles::new(2);
    particles.velocity[1][0] = 3.0;
    particles.id[1] = 1;
    let masses = vec![FilledMass { particles: 2, mass: 3.0, shape_mass: 4.0, is_estimate: false }];
    Setup {
        model,
        particles,
        masses,
        deck_text: "title = \"A test\"\n".into(),
        notes: Vec::new(),
        notes_unless_driven: Vec::new(),
        catalogue_notes: Vec::new(),
    }
}

fn run(folder: &Path, model: Model, fail_at: Option<f64>) -> Result<Summary, RunError> {
    let options = RunOptions { directory: folder.join("run"), threads: Some(2), ..RunOptions::default() };
    execute(setup(model), &ClockworkKind(fail_at), &options, &AtomicBool::new(false), &mut Silent)
}

fn times(run: &RunDirectory) -> (Vec<f64>, Vec<f64>) {
    let history = HistoryTable::read(run).unwrap();
    let rows = history.column("time").unwrap().1.to_vec();
    (read_series(run).unwrap().into_iter().map(|(time, _)| time).collect(), rows)
}

#[test]
fn a_run_lands_on_its_output_times_and_says_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(folder.path(), model(), None).unwrap();
    let directory = RunDirectory::open(&folder.path().join("run")).unwrap();
    assert_eq!(Summary::read(&directory).unwrap(), summary);
    assert_eq!((summary.status, summary.end_reason), (Status::Completed, EndReason::EndTime));
    assert_eq!((summary.particles, summary.threads, summary.simulated_time), (2, 2, 1.0));
    assert_eq!(summary.engine, "clockwork");
    let [bar] = &summary.bodies[..] else { panic!("{:?}", summary.bodies) };
    assert_eq!((bar.name.as_str(), bar.particles, bar.mass, bar.shape_mass), ("bar", 2, 3.0, 4.0));
    assert!((summary.measures["length"].unwrap() - 3.1).abs() < 1e-12);
    assert_eq!(summary.measure_units["length"], "m");
    assert_eq!((summary.energy.kinetic, summary.momentum_drift), ((-5.0f64).exp(), 0.0));
    assert!((summary.searched_fraction - 0.5).abs() < 0.01);
    assert!(summary.stage_seconds.output > 0.0 && summary.peak_memory_bytes == 7);

    let (frames, rows) = times(&directory);
    assert_eq!(frames, [0.0, 0.25, 0.5, 0.75, 1.0]);
    // Rows are those of the first step past their times.
    assert_eq!((rows.len(), rows[0], rows[10]), (11, 0.0, 1.0));
    let due = (0..=10).map(|k| f64::from(k) * 0.1 * (1.0 - 1e-12));
    assert!(rows.iter().zip(due).all(|(time, due)| (due..due + 3.7e-3).contains(time)), "{rows:?}");
    let mut frame = FrameFile::open(&read_series(&directory).unwrap()[2].1).unwrap();
    assert_eq!((frame.header.time, frame.positions().unwrap()[1][0]), (0.5, 1.5));
    assert_eq!(frame.bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>(), ["bar"]);
    assert_eq!(fs::read_to_string(directory.deck()).unwrap(), "title = \"A test\"\n");

    // The column tells the step the physics allows, not the one cut for a frame.
    let text = fs::read_to_string(directory.history()).unwrap();
    assert!(text.lines().skip(1).all(|line| line.contains(",3.7e-3,sound-speed,")), "{text}");
    let history = HistoryTable::read(&directory).unwrap();
    let (column, lengths) = history.column("length").unwrap();
    assert_eq!((column.unit.as_str(), lengths[0], lengths[10]), ("m", 0.1, summary.measures["length"].unwrap()));
    assert!(history.column("body.bar.momentum_x").is_some());
    assert!(history.column("searched_fraction").unwrap().1[0].is_nan());
}

#[test]
fn rules_of_the_deck_end_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut by_energy = model();
    by_energy.time.stop_kinetic_fraction = Some(0.1);
    let summary = run(folder.path(), by_energy, None).unwrap();
    // exp(-5 t) < 0.1 from t = 0.4605 on, seen at the row of 0.5.
    assert_eq!((summary.end_reason, summary.simulated_time), (EndReason::KineticEnergy, 0.5));

    let folder = tempfile::tempdir().unwrap();
    let mut by_steps = model();
    by_steps.time.max_steps = Some(10);
    let summary = run(folder.path(), by_steps, None).unwrap();
    assert_eq!((summary.status, summary.end_reason, summary.steps), (Status::Completed, EndReason::MaxSteps, 10));
    let (frames, rows) = times(&RunDirectory::open(&folder.path().join("run")).unwrap());
    assert_eq!((frames.len(), rows.len()), (2, 2));
}

/// Stops the run when it first hears of progress.
struct Impatient<'a>(&'a AtomicBool, u64);

impl Observer for Impatient<'_> {
    fn frame_written(&mut self, index: usize, _time: f64) {
        if index == 1 {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    fn progressed(&mut self, progress: &Progress) {
        self.1 = progress.step;
    }
}

#[test]
fn a_stopped_run_is_complete_up_to_where_it_was_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions { directory: folder.path().join("run"), ..RunOptions::default() };
    let stop = AtomicBool::new(false);
    let mut observer = Impatient(&stop, 0);
    let summary = execute(setup(model()), &ClockworkKind(None), &options, &stop, &mut observer).unwrap();
    assert_eq!((summary.status, summary.simulated_time), (Status::Stopped, 0.25));
    assert_eq!(observer.1, summary.steps);
    let (frames, rows) = times(&RunDirectory::open(&options.directory).unwrap());
    assert_eq!((frames, rows.len(), rows[0], rows[3]), (vec![0.0, 0.25], 4, 0.0, 0.25));
}

#[test]
fn whoever_watches_reads_the_state_between_all_steps_and_can_end_the_run_there() {
    struct Reader(Vec<(u64, f64)>, u64);
    impl Observer for Reader {
        fn between_steps(&mut self, state: &Simulation) -> ControlFlow<()> {
            self.0.push((state.steps(), state.read("position").unwrap().component(1, 0)));
            if state.steps() == self.1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let read = |name: &str, until: u64| {
        let options = RunOptions { directory: folder.path().join(name), ..RunOptions::default() };
        let mut reader = Reader(Vec::new(), until);
        let summary = execute(setup(model()), &ClockworkKind(None), &options, &stop, &mut reader).unwrap();
        (summary, reader.0)
    };
    let (stopped, states) = read("stopped", 5);
    assert_eq!((stopped.status, stopped.end_reason, stopped.steps), (Status::Stopped, EndReason::User, 5));
    let expected: Vec<_> = (0..=5).map(|step| (step, 3.0 * DT * step as f64)).collect();
    assert!(states.iter().zip(&expected).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-12), "{states:?}");
    assert_eq!(states.len(), expected.len());
    // At the end of the deck it is the deck that ends the run.
    let (whole, states) = read("whole", u64::MAX);
    assert_eq!(states.len() as u64, whole.steps + 1);
    let (ended, _) = read("ended", whole.steps);
    assert_eq!((ended.status, ended.end_reason), (Status::Completed, EndReason::EndTime));
}

#[test]
fn a_failed_run_keeps_the_last_good_frame_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let error = run(folder.path(), model(), Some(0.6)).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    let RunError::Failed { failure, .. } = error else { panic!("{error}") };
    let directory = RunDirectory::open(&folder.path().join("run")).unwrap();
    let summary = Summary::read(&directory).unwrap();
    assert_eq!((summary.status, summary.failure), (Status::Failed, Some(failure)));
    assert!((0.6..0.6 + 3.7e-3).contains(&summary.simulated_time), "{}", summary.simulated_time);
    assert!((summary.energy.kinetic - (-5.0 * summary.simulated_time).exp()).abs() < 1e-12);
    assert_eq!(times(&directory).0, [0.0, 0.25, 0.5]);
}

/// Runs an engine that lets fields be read while it goes on; times of the frames there are, with the x of the second particle in each.
fn run_copying(folder: &Path, kind: &CopyingKind) -> (Result<Summary, RunError>, Vec<(f64, f64)>) {
    run_copying_and_saving(folder, kind, CheckpointPlan::default())
}

fn run_copying_and_saving(
    folder: &Path,
    kind: &CopyingKind,
    checkpoints: CheckpointPlan,
) -> (Result<Summary, RunError>, Vec<(f64, f64)>) {
    let options = RunOptions { directory: folder.join("run"), threads: Some(1), checkpoints, ..RunOptions::default() };
    let ended = execute(setup(model()), kind, &options, &AtomicBool::new(false), &mut Silent);
    let directory = RunDirectory::open(&folder.join("run")).unwrap();
    let frames = read_series(&directory).unwrap().into_iter().map(|(time, path)| {
        let mut frame = FrameFile::open(&path).unwrap();
        assert_eq!(frame.header.time, time);
        (time, frame.positions().unwrap()[1][0])
    });
    (ended, frames.collect())
}

#[test]
fn frames_that_are_written_while_steps_go_on_are_those_of_their_times() {
    let folder = tempfile::tempdir().unwrap();
    let (ended, frames) = run_copying(folder.path(), &CopyingKind(None, f64::INFINITY));
    assert_eq!(ended.unwrap().status, Status::Completed);
    assert_eq!(frames, [0.0, 0.25, 0.5, 0.75, 1.0].map(|time| (time, 3.0 * time)));
}

#[test]
fn an_engine_that_is_lost_keeps_the_frames_that_were_complete() {
    let is_gone = |folder: &Path| !folder.join("run").join(RunDirectory::frame_name(2, false)).exists();
    // The engine is lost when the frame of 0.5 s is under way: it is what failed, not that frame.
    let folder = tempfile::tempdir().unwrap();
    let (ended, frames) = run_copying(folder.path(), &CopyingKind(Some(0.52), 0.5));
    let RunError::Failed { failure, .. } = ended.unwrap_err() else { panic!("an engine that failed") };
    assert_eq!((failure.message.as_str(), frames.len()), ("velocity is not a number", 2));
    assert!(is_gone(folder.path()));
    // Only copies are lost: what could not be written ends the run, and is in no list.
    let folder = tempfile::tempdir().unwrap();
    let (ended, frames) = run_copying(folder.path(), &CopyingKind(None, 0.5));
    let RunError::Output { source } = ended.unwrap_err() else { panic!("a frame that is not there") };
    assert!(source.chain().contains("lost"), "{}", source.chain());
    assert_eq!(frames.len(), 2);
    assert!(is_gone(folder.path()));
}

#[test]
fn frames_that_are_not_listed_yet_are_listed_when_another_file_cannot_be_written() {
    /// Puts a folder in the place of a file, or of the next frame, once there is a frame that the list does not name yet.
    struct Obstructor(std::path::PathBuf, Option<&'static str>);
    impl Observer for Obstructor {
        fn frame_written(&mut self, index: usize, _time: f64) {
            let list = fs::read_to_string(self.0.join("fields.pvd")).unwrap();
            if list.matches("DataSet").count() <= index {
                let next = RunDirectory::frame_name(index + 1, false);
                let place = self.0.join(self.1.unwrap_or(&next));
                let _ = fs::remove_file(&place);
                let _ = fs::create_dir(&place);
            }
        }
    }
    // So many of both that the list is not replaced at each of them.
    let mut model = model();
    model.output.frame_interval = 1e-3;
    model.output.history_interval = 1e-3;
    for obstructed in [None, Some("history.csv")] {
        let folder = tempfile::tempdir().unwrap();
        let options = RunOptions { directory: folder.path().join("run"), ..RunOptions::default() };
        let mut observer = Obstructor(options.directory.clone(), obstructed);
        let (kind, stop) = (ClockworkKind(None), AtomicBool::new(false));
        let error = execute(setup(model.clone()), &kind, &options, &stop, &mut observer).unwrap_err();
        assert!(matches!(error, RunError::Output { .. }), "{error}");
        let directory = RunDirectory::open(&options.directory).unwrap();
        let summary = Summary::read(&directory).unwrap();
        assert_eq!(summary.status, Status::Failed);
        let found = fs::read_dir(options.directory.join("fields")).unwrap();
        let frames = found.filter(|entry| entry.as_ref().unwrap().file_type().unwrap().is_file()).count();
        assert_eq!(read_series(&directory).unwrap().len(), frames);
        if obstructed.is_none() {
            // The row of the last step was there before its frame.
            assert_eq!((frames as u64, times(&directory).1.len() as u64), (summary.steps, summary.steps + 1));
        }
    }
}

#[test]
fn a_frame_that_is_lost_while_the_state_is_saved_ends_the_run() {
    // Saved after each step, the frame of 0.5 s under way.
    let folder = tempfile::tempdir().unwrap();
    let plan = CheckpointPlan { interval: Some(1e-3), ..CheckpointPlan::default() };
    let (ended, frames) = run_copying_and_saving(folder.path(), &CopyingKind(None, 0.5), plan);
    let RunError::Output { source } = ended.unwrap_err() else { panic!("a frame that is not there") };
    assert!(source.chain().contains("lost"), "{}", source.chain());
    assert_eq!(frames.len(), 2);
}

#[test]
fn what_an_engine_cannot_do_is_refused_before_anything_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let mut heavy = model();
    heavy.gravity = [0.0, -9.81, 0.0];
    let error = run(folder.path(), heavy, None).unwrap_err();
    assert_eq!(
        (error.exit_code(), error.to_string()),
        (2, "the engine `clockwork` does not run this deck: gravity".into())
    );
    assert!(!folder.path().join("run").exists());
}

#[test]
fn there_is_no_folder_until_all_is_ready_for_the_first_step() {
    /// Looks for the folder when the run is prepared.
    struct Watcher(std::path::PathBuf, Option<bool>);
    impl Observer for Watcher {
        fn prepared(&mut self) {
            self.1 = Some(self.0.exists());
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions { directory: folder.path().join("run"), ..RunOptions::default() };
    let mut watcher = Watcher(options.directory.clone(), None);
    execute(setup(model()), &ClockworkKind(None), &options, &AtomicBool::new(false), &mut watcher).unwrap();
    assert_eq!(watcher.1, Some(false));
}

#[test]
fn an_existing_folder_is_refused_before_anything_is_done() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("run")).unwrap();
    fs::write(folder.path().join("run/notes.txt"), "mine").unwrap();
    let error = run(folder.path(), model(), None).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert_eq!(fs::read_dir(folder.path().join("run")).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn a_folder_that_vanishes_ends_the_run_with_an_error() {
    /// Removes the folder after the first frame.
    struct Vandal(std::path::PathBuf);
    impl Observer for Vandal {
        fn frame_written(&mut self, _index: usize, _time: f64) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let options = RunOptions { directory: folder.path().join("run"), ..RunOptions::default() };
    let mut observer = Vandal(options.directory.clone());
    let stop = AtomicBool::new(false);
    let error = execute(setup(model()), &ClockworkKind(None), &options, &stop, &mut observer).unwrap_err();
    assert!(matches!(error, RunError::Output { .. }), "{error}");
    assert_eq!(error.exit_code(), 1);
}
