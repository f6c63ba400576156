//! A run that Python drives.
//!
//! The run has a thread of its own, and goes on only while Python waits for it in [`Driver::go`], without the lock of the interpreter. Where it pauses,
//! between two steps, it answers what is asked of its state. All that crosses between the threads are messages, so nothing of Python is ever reached from
//! the thread of the run, and nothing of the state from Python.

use crate::{
    deck::Deck,
    errors,
    guard::{self, POLL},
    values::Packed,
    words::of_python,
};
use pyo3::{exceptions::PyKeyError, prelude::*, types::PyBytes};
use sphorge::{
    deck::{did_you_mean, names_like},
    engine::{Drive, EngineKind, FieldSource, Simulation},
    output::{RunDirectory, Summary, WarningRecord},
    particles::{FIELDS, find_field},
    run::{CheckpointPlan, Observer, ResumeError, ResumeOptions, RunError, RunOptions, execute, resume},
};
use sphorge_cli::{engine_of, particle_limit};
use std::{
    ops::ControlFlow,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    process,
    sync::{
        Arc, Mutex, MutexGuard, TryLockError,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// What is asked of a run that pauses.
enum Order {
    /// To go on.
    Go(Until),
    /// A field.
    Read(&'static str),
    /// Loads and velocities from the next step on.
    Drive(Drive),
    /// What of the program ends the run, which is told to stop next.
    EndBy(String),
}

/// Where a run is to pause: wherever one of these is first reached.
#[derive(Clone, Copy, Default)]
struct Until {
    step: Option<u64>,
    time: Option<f64>,
    frame: bool,
    /// Seconds of the clock on the wall.
    seconds: Option<f64>,
}

/// What a run says.
enum News {
    Noted(String),
    Warned { name: String, text: String },
    Frame { index: usize, time: f64 },
    Ready(Box<Whole>),
    Paused(Moment),
    Read(Result<Packed, String>),
    Ended(Result<Box<Summary>, Failure>),
}

/// Where a run is.
#[derive(Clone, Copy, Default)]
struct Moment {
    step: u64,
    time: f64,
    /// Size of the last step, s.
    dt: f64,
    particles: usize,
}

/// What of a run does not change.
struct Whole {
    /// s.
    end: f64,
    most_steps: Option<u64>,
    dimensions: usize,
    can_be_driven: bool,
    /// Bodies and motions with loads and velocities of a program in the state that the run goes on from.
    driven: (Vec<bool>, Vec<bool>),
    bodies: Vec<String>,
    /// Name of the region of each prescribed motion.
    motions: Vec<String>,
}

impl Whole {
    fn of(state: &Simulation) -> Self {
        let model = state.model();
        Self {
            end: model.time.end,
            most_steps: model.time.max_steps,
            dimensions: model.dimensions.count(),
            can_be_driven: state.can_be_driven(),
            driven: state.driven().unwrap_or_default(),
            bodies: model.bodies.iter().map(|body| body.name.clone()).collect(),
            motions: model.motions.iter().map(|motion| model.regions[motion.region].name.clone()).collect(),
        }
    }
}

/// What threads that do not drive a run may ask of it at any time.
#[derive(Default)]
struct Live {
    /// Tells the run to end after its step.
    stop: AtomicBool,
    step: AtomicU64,
    /// Bits of the time, s.
    time: AtomicU64,
    particles: AtomicU64,
}

impl Live {
    fn note(&self, step: u64, time: f64, particles: usize) {
        self.step.store(step, Ordering::Relaxed);
        self.time.store(time.to_bits(), Ordering::Relaxed);
        self.particles.store(particles as u64, Ordering::Relaxed);
    }
}

/// How a run did not end well.
enum Failure {
    Run(RunError),
    Resume(ResumeError),
    Panic(String),
}

/// The end of the messages in the thread of the run.
struct Watch {
    orders: Receiver<Order>,
    news: Sender<News>,
    until: Until,
    /// When it went on.
    since: Instant,
    has_frame: bool,
    last_time: f64,
    last_step: u64,
    /// What is given to the next step.
    drive: Option<Drive>,
    /// Notes that hold unless the program drives the run, until it goes on.
    unless_driven: Vec<String>,
    stopped_by: Option<String>,
    is_told: bool,
    live: Arc<Live>,
}

impl Watch {
    fn tell(&self, news: News) {
        // Nobody listens any more where the object of Python is gone; the run learns it at its next pause.
        let _ = self.news.send(news);
    }
}

impl Observer for Watch {
    fn between_steps(&mut self, state: &Simulation) -> ControlFlow<()> {
        if !self.is_told {
            self.is_told = true;
            self.tell(News::Ready(Box::new(Whole::of(state))));
        }
        let (step, time) = (state.steps(), state.time());
        self.live.note(step, time, state.count());
        let dt = (time - self.last_time).max(0.0);
        self.last_time = time;
        let until = self.until;
        // Steps that were taken back come again, each as it was asked for.
        let went_back = step <= std::mem::replace(&mut self.last_step, step) && step > 0;
        let is_due = until.step.is_some_and(|asked| step >= asked)
            || until.time.is_some_and(|asked| time >= asked * (1.0 - 1e-12))
            || until.frame && self.has_frame
            || until.step.is_some() && went_back
            || until.seconds.is_some_and(|seconds| self.since.elapsed().as_secs_f64() > seconds);
        if !is_due {
            return ControlFlow::Continue(());
        }
        self.has_frame = false;
        self.tell(News::Paused(Moment { step, time, dt, particles: state.count() }));
        loop {
            match self.orders.recv() {
                Ok(Order::Go(until)) => {
                    let notes = std::mem::take(&mut self.unless_driven);
                    if self.drive.is_none() {
                        notes.iter().for_each(|note| self.tell(News::Noted(of_python(note))));
                    }
                    self.until = until;
                    self.since = Instant::now();
                    return ControlFlow::Continue(());
                }
                Ok(Order::Drive(drive)) => self.drive = Some(drive),
                Ok(Order::EndBy(what)) => self.stopped_by = Some(what),
                Ok(Order::Read(field)) => {
                    let read = state.read(field).map(|column| Packed::of(&column));
                    self.tell(News::Read(read.map_err(|failure| failure.to_string())));
                }
                Err(_) => return ControlFlow::Break(()),
            }
        }
    }

    fn drive(&mut self) -> Option<Drive> {
        self.drive.take()
    }

    fn drives(&self) -> bool {
        // The program may: a run that goes on under loads of another one asks for them before its first step.
        true
    }

    fn stopped_by(&mut self) -> Option<String> {
        self.stopped_by.take()
    }

    fn frame_written(&mut self, index: usize, time: f64) {
        self.has_frame = true;
        self.tell(News::Frame { index, time });
    }

    fn noted(&mut self, note: &str) {
        self.tell(News::Noted(of_python(note)));
    }

    fn warned(&mut self, warning: &WarningRecord) {
        self.tell(News::Warned { name: warning.name.clone(), text: of_python(&warning.to_string()) });
    }
}

/// What Python has not been told yet.
#[derive(Default)]
struct Untold {
    frames: Vec<(usize, f64)>,
    notes: Vec<String>,
    warnings: Vec<(String, String)>,
}

/// The end of the messages on the side of Python.
struct Link {
    /// The process that the thread is of: one that forks has no copy of it.
    process: u32,
    orders: Option<Sender<Order>>,
    news: Receiver<News>,
    thread: Option<JoinHandle<()>>,
    live: Arc<Live>,
    whole: Option<Box<Whole>>,
    moment: Moment,
    is_paused: bool,
    ended: Option<Result<Box<Summary>, Failure>>,
    untold: Untold,
}

impl Link {
    /// Starts a run on a thread of its own.
    fn start(
        run: impl FnOnce(&AtomicBool, &mut Watch) -> Result<Summary, Failure> + Send + 'static,
    ) -> std::io::Result<Self> {
        let (order, orders) = channel();
        let (tell, news) = channel();
        let live = Arc::new(Live::default());
        let shared = Arc::clone(&live);
        let thread = thread::Builder::new().name("sphorge".to_owned()).spawn(move || {
            let until = Until { step: Some(0), ..Until::default() };
            let mut watch = Watch {
                orders,
                news: tell,
                until,
                since: Instant::now(),
                has_frame: false,
                last_time: 0.0,
                last_step: 0,
                drive: None,
                unless_driven: Vec::new(),
                stopped_by: None,
                is_told: false,
                live: Arc::clone(&shared),
            };
            let ended = catch_unwind(AssertUnwindSafe(|| run(&shared.stop, &mut watch)));
            let ended = ended.unwrap_or_else(|panic| Err(Failure::Panic(guard::message(&*panic))));
            watch.tell(News::Ended(ended.map(Box::new)));
        })?;
        Ok(Self {
            process: process::id(),
            orders: Some(order),
            news,
            thread: Some(thread),
            live,
            whole: None,
            moment: Moment::default(),
            is_paused: false,
            ended: None,
            untold: Untold::default(),
        })
    }

    fn order(&self, order: Order) {
        // A run that listens no more has ended, which it has said.
        let _ = self.orders.as_ref().map(|orders| orders.send(order));
    }

    /// Waits a moment for news.
    fn wait(&mut self, py: Python<'_>, most: Duration) -> Result<News, RecvTimeoutError> {
        py.detach(move || {
            let link = self;
            link.news.recv_timeout(most)
        })
    }

    /// Waits until the run pauses or ends, or for what was read. Ctrl-C stops it, and waits until it has saved its state; a second one does not.
    fn listen(&mut self, py: Python<'_>) -> PyResult<Option<Result<Packed, String>>> {
        let mut interrupt = None;
        loop {
            match self.wait(py, POLL) {
                Ok(News::Noted(note)) => self.untold.notes.push(note),
                Ok(News::Warned { name, text }) => self.untold.warnings.push((name, text)),
                Ok(News::Frame { index, time }) => self.untold.frames.push((index, time)),
                Ok(News::Ready(whole)) => self.whole = Some(whole),
                Ok(News::Paused(moment)) => {
                    (self.moment, self.is_paused) = (moment, true);
                    if interrupt.is_none() {
                        return Ok(None);
                    }
                    // It pauses before it sees that it is to stop.
                    self.is_paused = false;
                    self.order(Order::Go(Until::default()));
                }
                // Whoever asked while Ctrl-C came gets that: the run is told to stop already.
                Ok(News::Read(read)) => return interrupt.map_or(Ok(Some(read)), Err),
                Ok(News::Ended(ended)) => {
                    if let Ok(summary) = &ended {
                        (self.moment.step, self.moment.time) = (summary.steps, summary.simulated_time);
                    }
                    self.ended = Some(ended);
                    return interrupt.map_or(Ok(None), Err);
                }
                Err(RecvTimeoutError::Timeout) => {
                    let Err(signal) = py.check_signals() else { continue };
                    if interrupt.is_some() {
                        return Err(signal);
                    }
                    self.live.stop.store(true, Ordering::Relaxed);
                    interrupt = Some(signal);
                }
                Err(RecvTimeoutError::Disconnected) => {
                    self.ended = Some(Err(Failure::Panic("the thread of the run is gone".to_owned())));
                    return interrupt.map_or(Ok(None), Err);
                }
            }
        }
    }

    /// Lets the run end where it is, and waits for it.
    fn finish(&mut self, py: Python<'_>) -> PyResult<()> {
        self.live.stop.store(true, Ordering::Relaxed);
        while self.ended.is_none() {
            if self.is_paused {
                self.is_paused = false;
                self.order(Order::Go(Until::default()));
            }
            self.listen(py)?;
        }
        Ok(())
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.live.stop.store(true, Ordering::Relaxed);
        self.orders = None;
        let thread = self.thread.take();
        if self.process == process::id() {
            // It saves its state and needs nothing of Python for that. What it panicked with has been told.
            let _ = thread.map(JoinHandle::join);
        } else {
            // The thread is another process's.
            std::mem::forget(thread);
        }
    }
}

/// A run under way: where it is, and what happened since the last time.
type Progress = (bool, u64, f64, f64, Vec<(usize, f64)>, Vec<String>, Vec<(String, String)>);

/// What [`Driver::whole`] tells.
type Told = (f64, Option<u64>, (bool, Vec<bool>, Vec<bool>), usize, Vec<String>, Vec<String>);

/// Drives a run.
#[pyclass(module = "sphorge._sphorge", frozen)]
pub(crate) struct Driver {
    link: Mutex<Link>,
    live: Arc<Live>,
}

impl Driver {
    /// Starts a run and waits until it is ready for its first step.
    fn start(
        py: Python<'_>,
        run: impl FnOnce(&AtomicBool, &mut Watch) -> Result<Summary, Failure> + Send + 'static,
    ) -> PyResult<Self> {
        let mut link = Link::start(run).map_err(|error| errors::internal(py, &error.to_string()))?;
        link.listen(py)?;
        match &link.ended {
            Some(Err(failure)) if link.moment.particles == 0 => Err(raise(py, failure)),
            _ => Ok(Self { live: Arc::clone(&link.live), link: Mutex::new(link) }),
        }
    }

    /// The link, of one thread at a time, of the process that has started the run.
    fn link(&self) -> PyResult<MutexGuard<'_, Link>> {
        let link = match self.link.try_lock() {
            Ok(link) => link,
            Err(TryLockError::Poisoned(link)) => link.into_inner(),
            Err(TryLockError::WouldBlock) => {
                return Err(errors::misuse(
                    "another thread drives this simulation: use it from one thread at a time; `stop()` asks it to end",
                ));
            }
        };
        if link.process != process::id() {
            return Err(errors::misuse(
                "a simulation stays with the process that started it: this one is a fork of it",
            ));
        }
        Ok(link)
    }
}

/// The exception of a failure.
fn raise(py: Python<'_>, failure: &Failure) -> PyErr {
    match failure {
        Failure::Run(error) => errors::run(py, error),
        Failure::Resume(error) => errors::resume(py, error),
        Failure::Panic(message) => errors::internal(py, message),
    }
}

/// When a run saves its state.
fn plan(minutes: f64, at_end: bool) -> PyResult<CheckpointPlan> {
    if !(0.0..1e6).contains(&minutes) {
        return Err(pyo3::exceptions::PyValueError::new_err(
            "checkpoint_minutes: give minutes from 0, for never, to a million",
        ));
    }
    let every = (minutes > 0.0).then(|| Duration::from_secs_f64(60.0 * minutes));
    Ok(CheckpointPlan { every, at_end, ..CheckpointPlan::default() })
}

/// The engine of a name.
fn engine(py: Python<'_>, name: &str, device: Option<&str>) -> PyResult<Arc<dyn EngineKind>> {
    engine_of(name, device).map_err(|report| errors::report(py, &report))
}

#[pymethods]
impl Driver {
    /// Begins the run of a deck.
    #[new]
    #[pyo3(signature = (deck, folder, *, threads, engine_name, device, overwrite, checkpoint_minutes, checkpoint_at_end))]
    fn new(
        py: Python<'_>,
        deck: PyRef<'_, Deck>,
        folder: PathBuf,
        threads: Option<usize>,
        engine_name: &str,
        device: Option<&str>,
        overwrite: bool,
        checkpoint_minutes: f64,
        checkpoint_at_end: bool,
    ) -> PyResult<Self> {
        let kind = engine(py, engine_name, device)?;
        let checkpoints = plan(checkpoint_minutes, checkpoint_at_end)?;
        RunDirectory::check(&folder, overwrite).map_err(|error| errors::output(py, &error))?;
        let own = deck.clone();
        let setup = guard::in_pool(py, move || own.load())?.map_err(|report| errors::deck(py, &report))?;
        let options = RunOptions { directory: folder, overwrite, by_force: false, threads, checkpoints };
        Self::start(py, move |stop, watch| {
            setup.notes.iter().for_each(|note| watch.noted(note));
            watch.unless_driven.clone_from(&setup.notes_unless_driven);
            execute(setup, &*kind, &options, stop, watch).map_err(Failure::Run)
        })
    }

    /// Goes on with the run in a folder.
    #[staticmethod]
    #[pyo3(signature = (folder, overrides, *, threads, device, checkpoint_minutes, checkpoint_at_end))]
    fn resume(
        py: Python<'_>,
        folder: PathBuf,
        overrides: Vec<(String, String)>,
        threads: Option<usize>,
        device: Option<&str>,
        checkpoint_minutes: f64,
        checkpoint_at_end: bool,
    ) -> PyResult<Self> {
        let engines = match device {
            Some(_) => vec![engine(py, "gpu", device)?],
            None => [engine_of("cpu", None), engine_of("gpu", None)].into_iter().flatten().collect(),
        };
        let checkpoints = plan(checkpoint_minutes, checkpoint_at_end)?;
        let most_particles = particle_limit();
        let options = ResumeOptions { overrides, most_particles, by_force: false, threads, checkpoints, engines };
        Self::start(py, move |stop, watch| resume(&folder, &options, stop, watch).map_err(Failure::Resume))
    }

    /// Goes on until a step, a time (s), the next frame, or for some seconds, whichever is first, or to the end: whether it has ended, where it is, and what has happened.
    #[pyo3(signature = (*, step=None, time=None, frame=false, seconds=None))]
    fn go(
        &self,
        py: Python<'_>,
        step: Option<u64>,
        time: Option<f64>,
        frame: bool,
        seconds: Option<f64>,
    ) -> PyResult<Progress> {
        let mut link = self.link()?;
        if link.ended.is_none() {
            link.is_paused = false;
            link.order(Order::Go(Until { step, time, frame, seconds }));
            link.listen(py)?;
        }
        let Untold { frames, notes, warnings } = std::mem::take(&mut link.untold);
        let Moment { step, time, dt, .. } = link.moment;
        Ok((link.ended.is_some(), step, time, dt, frames, notes, warnings))
    }

    /// What has happened since the last time, without going on.
    fn news(&self) -> PyResult<Progress> {
        let mut link = self.link()?;
        let Untold { frames, notes, warnings } = std::mem::take(&mut link.untold);
        let Moment { step, time, dt, .. } = link.moment;
        Ok((link.ended.is_some(), step, time, dt, frames, notes, warnings))
    }

    /// Stops the run where it is, which saves its state, unless it has ended; `by` is what of the program ends it, if not its user.
    #[pyo3(signature = (by=None))]
    fn stop(&self, py: Python<'_>, by: Option<String>) -> PyResult<()> {
        let mut link = self.link()?;
        if let Some(by) = by.filter(|_| link.is_paused && link.ended.is_none()) {
            link.order(Order::EndBy(by));
        }
        link.finish(py)
    }

    /// Tells the run to end after its step, whichever thread waits for it.
    fn ask_to_stop(&self) {
        self.live.stop.store(true, Ordering::Relaxed);
    }

    /// Steps and time (s) of the run, whichever thread waits for it.
    #[getter]
    fn at(&self) -> (u64, f64) {
        (self.live.step.load(Ordering::Relaxed), f64::from_bits(self.live.time.load(Ordering::Relaxed)))
    }

    /// Number of particles, whichever thread waits for the run.
    #[getter]
    fn particles(&self) -> u64 {
        self.live.particles.load(Ordering::Relaxed)
    }

    /// End time, s, most steps, whether loads and velocities can be given, for which bodies and motions they were before, dimensions, and names of bodies and of the regions with a prescribed motion.
    fn whole(&self) -> PyResult<Option<Told>> {
        let link = self.link()?;
        let of = |whole: &Whole| {
            let Whole { end, most_steps, dimensions, can_be_driven, driven: (loads, velocities), bodies, motions } =
                whole;
            let driven = (*can_be_driven, loads.clone(), velocities.clone());
            (*end, *most_steps, driven, *dimensions, bodies.clone(), motions.clone())
        };
        Ok(link.whole.as_deref().map(of))
    }

    /// Gives the force on each body and the velocities of each prescribed motion, from the next step on.
    fn drive(&self, forces: Vec<Option<[f64; 3]>>, velocities: Vec<Option<[Option<f64>; 3]>>) -> PyResult<()> {
        let link = self.link()?;
        if link.is_paused && link.ended.is_none() {
            link.order(Order::Drive(Drive { forces, velocities }));
        }
        Ok(())
    }

    /// The summary of a run that has ended, in JSON; none while it has not. Raises what it failed by.
    fn summary(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let link = self.link()?;
        match &link.ended {
            None => Ok(None),
            Some(Ok(summary)) => {
                serde_json::to_string(summary).map(Some).map_err(|error| errors::internal(py, &error.to_string()))
            }
            Some(Err(failure)) => Err(raise(py, failure)),
        }
    }

    /// A field of all particles in the order of their ids, as it is now.
    fn read<'py>(&self, py: Python<'py>, field: &str) -> PyResult<(Bound<'py, PyBytes>, &'static str, usize)> {
        let known = find_field(field).ok_or_else(|| {
            let names = || FIELDS.iter().map(|field| field.name);
            let near = did_you_mean(names_like(field, names()));
            let all = names().collect::<Vec<_>>().join(", ");
            PyKeyError::new_err(format!("there is no field `{field}`; {near}there are: {all}"))
        })?;
        let mut link = self.link()?;
        if !link.is_paused || link.ended.is_some() {
            return Err(errors::misuse("the simulation has ended: its frames have its fields"));
        }
        link.order(Order::Read(known.name));
        match link.listen(py)? {
            Some(Ok(column)) => Ok(column.read_only(py)),
            Some(Err(message)) => Err(errors::bad_input(py, &message, "")),
            None => Err(errors::misuse("the simulation has ended: its frames have its fields")),
        }
    }
}

/// Name, unit, numbers per particle and meaning of every field.
#[pyfunction]
pub(crate) fn fields() -> Vec<(&'static str, &'static str, usize, &'static str)> {
    FIELDS.iter().map(|field| (field.name, field.unit, field.kind.width(), field.meaning)).collect()
}
