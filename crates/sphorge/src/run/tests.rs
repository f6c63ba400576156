//! Whole runs with an engine that only counts time.

use super::{drive::drive, stepper::Stepper, *};
use crate::{
    engine::{BodyLedger, Energies, Ledger, LimitReason, StageSeconds, StepReport},
    model::{Measure, MeasureKind, Model, ParticleSelection},
    output::{EndReason, FailureRecord, FrameFile, HistoryTable, RunDirectory, Status, Summary, read_series, testing},
    particles::Particles,
};
use std::{
    fs,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
};

/// Two particles; the second flies off at 3 m/s; kinetic energy decays to `exp(-5 t)`.
struct Clockwork {
    model: Model,
    particles: Particles,
    time: f64,
    steps: u64,
    fail_at: Option<f64>,
}

const DT: f64 = 0.0037;

impl Clockwork {
    fn new(model: Model) -> Self {
        let mut particles = Particles::new(2);
        particles.velocity[1][0] = 3.0;
        particles.id[1] = 1;
        Self { model, particles, time: 0.0, steps: 0, fail_at: None }
    }
}

impl Stepper for Clockwork {
    fn prepare(&mut self) -> Result<(f64, LimitReason), Box<FailureRecord>> {
        Ok((DT, LimitReason::SoundSpeed))
    }
    fn step(&mut self, land_on: f64) -> Result<StepReport, Box<FailureRecord>> {
        if self.fail_at.is_some_and(|t| self.time >= t) {
            self.particles.velocity[0][0] = f64::NAN;
            return Err(Box::new(FailureRecord {
                message: "velocity is not a number".into(),
                step: self.steps + 1,
                time: self.time,
                field: Some("velocity".into()),
                particle: Some(0),
                body: Some("bar".into()),
                position: Some([0.0; 3]),
            }));
        }
        let landing = self.time + DT >= land_on;
        let (dt, reason) =
            if landing { (land_on - self.time, LimitReason::Output) } else { (DT, LimitReason::SoundSpeed) };
        self.time = if landing { land_on } else { self.time + dt };
        self.steps += 1;
        self.particles.position[1][0] = 3.0 * self.time;
        let searched_fraction = if self.steps.is_multiple_of(2) { 1.0 } else { 0.0 };
        Ok(StepReport { step: self.steps, time: self.time, dt, reason, searched_fraction, pairs: 2, audit: None })
    }
    fn model(&self) -> &Model {
        &self.model
    }
    fn particles(&self) -> &Particles {
        &self.particles
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn steps(&self) -> u64 {
        self.steps
    }
    fn ledger(&self) -> Ledger {
        let kinetic = (-5.0 * self.time).exp();
        let energies = Energies { kinetic, internal: 1.0 - kinetic, elastic: 0.0, plastic_work: 0.5 };
        let total = BodyLedger { energies, momentum_scale: 2.0, momentum: [1.0, 0.0, 0.0], ..BodyLedger::default() };
        Ledger { bodies: vec![total], total, ..Ledger::default() }
    }
    fn stage_seconds(&self) -> StageSeconds {
        StageSeconds { search: 1.0, ..StageSeconds::default() }
    }
    fn mean_neighbors(&self) -> f64 {
        1.0
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
    let kind = MeasureKind::Extent { selection: ParticleSelection::default(), axis: 0 };
    model.measures = vec![Measure { name: "length".into(), kind }];
    model
}

fn run(folder: &Path, engine: Clockwork) -> Result<Summary, RunError> {
    let options = RunOptions { directory: folder.join("run"), overwrite: false, threads: Some(2) };
    drive("title = \"A test\"\n", &options, &AtomicBool::new(false), &mut Silent, move || engine)
}

fn times(run: &RunDirectory) -> (Vec<f64>, Vec<f64>) {
    let history = HistoryTable::read(run).unwrap();
    let rows = history.column("time").unwrap().1.to_vec();
    (read_series(run).unwrap().into_iter().map(|(time, _)| time).collect(), rows)
}

#[test]
fn a_run_lands_on_its_output_times_and_says_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(folder.path(), Clockwork::new(model())).unwrap();
    let directory = RunDirectory::open(&folder.path().join("run")).unwrap();
    assert_eq!(Summary::read(&directory).unwrap(), summary);
    assert_eq!((summary.status, summary.end_reason), (Status::Completed, EndReason::EndTime));
    assert_eq!((summary.particles, summary.threads, summary.simulated_time), (2, 2, 1.0));
    assert!((summary.measures["length"].unwrap() - 3.1).abs() < 1e-12);
    assert_eq!(summary.measure_units["length"], "m");
    assert_eq!((summary.energy.kinetic, summary.momentum_drift), ((-5.0f64).exp(), 0.0));
    assert!((summary.searched_fraction - 0.5).abs() < 0.01);
    assert!(summary.stage_seconds.output > 0.0 && summary.peak_memory_bytes > 0);

    let (frames, rows) = times(&directory);
    assert_eq!(frames, [0.0, 0.25, 0.5, 0.75, 1.0]);
    // Rows are those of the first step past their times.
    assert_eq!((rows.len(), rows[0], rows[10]), (11, 0.0, 1.0));
    let due = (0..=10).map(|k| f64::from(k) * 0.1 * (1.0 - 1e-12));
    assert!(rows.iter().zip(due).all(|(time, due)| (due..due + 3.7e-3).contains(time)), "{rows:?}");
    let mut frame = FrameFile::open(&read_series(&directory).unwrap()[2].1).unwrap();
    assert_eq!((frame.header.time, frame.positions().unwrap()[1][0]), (0.5, 1.5));
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
    let mut by_energy = Clockwork::new(model());
    by_energy.model.time.stop_kinetic_fraction = Some(0.1);
    let summary = run(folder.path(), by_energy).unwrap();
    // exp(-5 t) < 0.1 from t = 0.4605 on, seen at the row of 0.5.
    assert_eq!((summary.end_reason, summary.simulated_time), (EndReason::KineticEnergy, 0.5));

    let folder = tempfile::tempdir().unwrap();
    let mut by_steps = Clockwork::new(model());
    by_steps.model.time.max_steps = Some(10);
    let summary = run(folder.path(), by_steps).unwrap();
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
    let summary = drive("", &options, &stop, &mut observer, || Clockwork::new(model())).unwrap();
    assert_eq!((summary.status, summary.simulated_time), (Status::Stopped, 0.25));
    assert_eq!(observer.1, summary.steps);
    let (frames, rows) = times(&RunDirectory::open(&options.directory).unwrap());
    assert_eq!((frames, rows.len(), rows[0], rows[3]), (vec![0.0, 0.25], 4, 0.0, 0.25));
}

#[test]
fn a_failed_run_keeps_the_last_good_frame_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let mut engine = Clockwork::new(model());
    engine.fail_at = Some(0.6);
    let error = run(folder.path(), engine).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    let RunError::Failed { failure, .. } = error else { panic!("{error}") };
    let directory = RunDirectory::open(&folder.path().join("run")).unwrap();
    let summary = Summary::read(&directory).unwrap();
    assert_eq!((summary.status, summary.failure), (Status::Failed, Some(failure)));
    assert!((0.6..0.6 + 3.7e-3).contains(&summary.simulated_time), "{}", summary.simulated_time);
    assert!((summary.energy.kinetic - (-5.0 * summary.simulated_time).exp()).abs() < 1e-12);
    assert_eq!(times(&directory).0, [0.0, 0.25, 0.5]);
}

#[test]
fn an_existing_folder_is_refused_before_anything_is_done() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("run")).unwrap();
    let error = run(folder.path(), Clockwork::new(model())).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert_eq!(fs::read_dir(folder.path().join("run")).unwrap().count(), 0);
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
    let error = drive("", &options, &AtomicBool::new(false), &mut observer, || Clockwork::new(model())).unwrap_err();
    assert!(matches!(error, RunError::Output { .. }), "{error}");
    assert_eq!(error.exit_code(), 1);
}
