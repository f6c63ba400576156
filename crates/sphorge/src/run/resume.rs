//! Going on with a run from what it saved.

use super::{
    checkpoint::{CheckpointPlan, Keeper},
    drive::{conclude, go_on},
    error::RunError,
    progress::{Observer, Pace, RunStart},
    state::{Beginning, RunState},
};
use crate::{
    deck::{DeckReport, Setup, load_text_within},
    engine::{ENGINES, EngineKind, FieldSource, Simulation},
    output::{Checkpoint, Durability, OutputError, RunDirectory, Summary, checkpoints, write_file},
};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

/// How to resume a run, beside what was saved.
#[derive(Clone, Debug)]
pub struct ResumeOptions {
    /// Changes of the deck: end and output alone, see [`CHANGEABLE`].
    pub overrides: Vec<(String, String)>,
    /// Most particles the deck may make.
    pub most_particles: f64,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
    /// When it saves its state.
    pub checkpoints: CheckpointPlan,
}

/// Keys of the deck that may change when a run is resumed, with all that begin with those ending in a point.
pub const CHANGEABLE: [&str; 4] = ["time.end", "time.max-steps", "time.stop-kinetic-fraction", "output."];

/// Why a run was not resumed, or failed when it was.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ResumeError {
    /// There is nothing to go on from.
    #[error("there is no checkpoint in {} from which a run can go on", path.display())]
    #[diagnostic(
        code(sphorge::run::no_checkpoint),
        help("a run saves its state every ten minutes and when it is stopped; run its deck again: `sphorge run {}`", path.join("deck.toml").display())
    )]
    NoCheckpoint {
        /// The folder.
        path: PathBuf,
    },
    /// A change that would make another run of it.
    #[error("`{key}` cannot change in a run that goes on")]
    #[diagnostic(
        code(sphorge::run::not_changeable),
        help(
            "only `time.end`, `time.max-steps`, `time.stop-kinetic-fraction` and `output` can; start a new run for the rest"
        )
    )]
    NotChangeable {
        /// The key.
        key: String,
    },
    /// The changes do not fit the deck.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(#[from] DeckReport),
    /// The folder cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Directory(#[from] OutputError),
    /// The run could not go on, or failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(RunError),
}

/// Goes on with the run in a folder from its last checkpoint that is whole and its own, to the same bits as if it had never been broken.
/// Deck and engine are those of the checkpoint.
///
/// # Errors
/// See [`ResumeError`]. A stop by the user is no error: the summary says so.
pub fn resume(
    path: &Path,
    options: &ResumeOptions,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Summary, ResumeError> {
    let may_change =
        |key: &str| CHANGEABLE.iter().any(|known| key == *known || known.ends_with('.') && key.starts_with(known));
    if let Some((key, _)) = options.overrides.iter().find(|(key, _)| !may_change(key)) {
        return Err(ResumeError::NotChangeable { key: key.clone() });
    }
    let threads = options.threads;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()
        .map_err(|source| ResumeError::Run(RunError::Threads { threads, source }))?;
    let deck = fs::read_to_string(RunDirectory::open(path)?.deck()).ok();
    for (_, file) in checkpoints(path)? {
        let checkpoint = match Checkpoint::open(&file) {
            Ok(checkpoint) => checkpoint,
            Err(error) => {
                observer.noted(&format!("{error}; the checkpoint before it is used"));
                continue;
            }
        };
        if deck.as_ref().is_some_and(|deck| *deck != checkpoint.deck) {
            observer
                .noted(&format!("{} is of a run of another deck; the checkpoint before it is used", file.display()));
            continue;
        }
        let known = ENGINES.iter().find(|engine| engine.name() == checkpoint.about.engine);
        let Some(kind) = known else {
            observer.noted(&format!(
                "{} is of the engine `{}`, which this program has not",
                file.display(),
                checkpoint.about.engine
            ));
            continue;
        };
        let name = checkpoint.about.deck_name.clone();
        let setup = load_text_within(&name, &checkpoint.deck, &options.overrides, options.most_particles)?;
        match pool.install(|| go_on_from(path, checkpoint, setup, *kind, options, stop, observer))? {
            Ok(summary) => return Ok(summary),
            Err(why) => observer.noted(&format!("{}: {why}; the checkpoint before it is used", file.display())),
        }
    }
    Err(ResumeError::NoCheckpoint { path: path.to_owned() })
}

/// Goes on from one checkpoint; why it is none of this program, if it is not.
fn go_on_from(
    path: &Path,
    mut checkpoint: Checkpoint,
    setup: Setup,
    kind: &dyn EngineKind,
    options: &ResumeOptions,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Result<Summary, String>, ResumeError> {
    let Setup { model, particles, masses, deck_text, .. } = setup;
    let directory = RunDirectory::go_on(path)?;
    let simulation = Simulation::start(kind, model, particles)
        .map_err(|failure| ResumeError::Run(RunError::Start { engine: kind.name(), failure }))?;
    let pace = Pace::new();
    let mut state = RunState::new(directory.clone(), simulation, &masses, pace, Beginning::Resumed)?;
    if let Err(error) = state.load(&mut checkpoint) {
        return Ok(Err(error.to_string()));
    }
    state.recorder.rewrite()?;
    if deck_text != checkpoint.deck {
        write_file(&directory.deck(), Durability::Disk, |out| out.write_all(deck_text.as_bytes()))?;
    }
    observer.started(&RunStart {
        directory: path.to_owned(),
        title: state.simulation.model().title.clone(),
        particles: state.simulation.count(),
        threads: rayon::current_num_threads(),
        end: state.simulation.model().time.end,
    });
    let (name, time) = (checkpoint.about.deck_name.clone(), state.simulation.time());
    let mut keeper = Keeper::new(options.checkpoints.clone(), name, deck_text, time);
    let ended = go_on(&mut state, &mut keeper, stop, observer);
    conclude(state, path.to_owned(), ended, observer).map(Ok).map_err(ResumeError::Run)
}
