//! Going on with a run from what it saved.

use super::{
    checkpoint::{CheckpointPlan, Keeper},
    drive::{conclude, go_on},
    error::RunError,
    listed,
    progress::{Observer, Pace, RunStart},
    schedule::arrived,
    state::{Beginning, RunState},
};
use crate::{
    deck::{DeckReport, Setup, load_text_within},
    engine::{EngineKind, FieldSource, Simulation},
    model::{Model, Solid, TimeControl},
    number::plain_quantity,
    output::{
        Checkpoint, DECK, Durability, EndReason, OutputError, RunDirectory, Status, Summary, checkpoints, last_step,
        regular_file::{self, most},
    },
};
use std::{
    io,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

/// How to resume a run, beside what was saved.
#[derive(Clone, Debug)]
pub struct ResumeOptions {
    /// Changes of the deck: end and output alone, see [`CHANGEABLE`].
    pub overrides: Vec<(String, String)>,
    /// Most particles the deck may make.
    pub most_particles: f64,
    /// Take the folder from a run that writes to it, or seems to: that one stops before its next file.
    pub by_force: bool,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
    /// When it saves its state.
    pub checkpoints: CheckpointPlan,
    /// Engines the run may have been computed by.
    pub engines: Vec<Arc<dyn EngineKind>>,
}

/// Keys of the deck that may change when a run is resumed, with all that begin with those ending in a point.
pub const CHANGEABLE: [&str; 4] = ["time.end", "time.max-steps", "time.stop-kinetic-fraction", "output."];

/// Why a run was not resumed, or failed when it was.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ResumeError {
    /// There is nothing to go on from.
    #[error("there is no checkpoint in {} from which the run can continue", path.display())]
    #[diagnostic(
        code(sphorge::run::no_checkpoint),
        help("{}", way_out(*has_ended))
    )]
    NoCheckpoint {
        /// The folder.
        path: PathBuf,
        /// Whether the run in it has reached its end.
        has_ended: bool,
    },
    /// It was stopped before its first step.
    #[error("the run in {} has taken no step from which it could continue", path.display())]
    #[diagnostic(code(sphorge::run::unstepped), help("run the deck again: its folder is free for that"))]
    Unstepped {
        /// The folder.
        path: PathBuf,
    },
    /// A change that would make another run of it.
    #[error("`{key}` cannot change when a run is resumed")]
    #[diagnostic(
        code(sphorge::run::not_changeable),
        help(
            "only `time.end`, `time.max-steps`, `time.stop-kinetic-fraction` and `output` can; start a new run for other changes"
        )
    )]
    NotChangeable {
        /// The key.
        key: String,
    },
    /// The run has reached its end, and no more of it is asked for.
    #[error("the run in {} has ended: {} at {}, step {steps}", path.display(), status.name(), plain_quantity(*time, "s"))]
    #[diagnostic(code(sphorge::run::ended), help("{}", how_to_go_further(*reason, *saved_at)))]
    Ended {
        /// The folder.
        path: PathBuf,
        /// How it ended.
        status: Status,
        /// What ended it.
        reason: EndReason,
        /// When, s.
        time: f64,
        /// Steps done.
        steps: u64,
        /// Time of the last checkpoint, s, if it is not of the end.
        saved_at: Option<f64>,
    },
    /// An end before the time that has been reached.
    #[error("the run has reached {}, its end cannot be {}", plain_quantity(*reached, "s"), plain_quantity(*end, "s"))]
    #[diagnostic(code(sphorge::run::end_passed), help("set `time.end` to a later time"))]
    EndPassed {
        /// Asked for, s.
        end: f64,
        /// Reached, s.
        reached: f64,
    },
    /// It was saved under loads or velocities that a program gave.
    #[error("a program gave loads or velocities to the run in {}", path.display())]
    #[diagnostic(
        code(sphorge::run::driven),
        help("resume it by that program: from the command line nothing would give them; or run the deck again")
    )]
    Driven {
        /// The folder.
        path: PathBuf,
    },
    /// A file of particles is not what it was.
    #[error("the particles of `{body}` in {} have changed since the run began", file.display())]
    #[diagnostic(code(sphorge::run::listed), help("bring the file back to what it was, or run the deck again"))]
    Listed {
        /// The body.
        body: String,
        /// The file.
        file: PathBuf,
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

fn way_out(has_ended: bool) -> &'static str {
    if has_ended {
        "the run has reached its end and its state was not saved; run the deck again to a later end, or with `--checkpoint-at-end` so that \
         it can be continued beyond its end"
    } else {
        "a run saves its state every ten minutes and when it is stopped, unless `--checkpoint-minutes 0` was given; run the deck again"
    }
}

/// What to do with a run that has ended.
fn how_to_go_further(reason: EndReason, saved_at: Option<f64>) -> String {
    let change = match reason {
        EndReason::KineticEnergy => "a smaller `--set time.stop-kinetic-fraction=...`",
        EndReason::MaxSteps => "a larger `--set time.max-steps=...`",
        EndReason::EndTime | EndReason::User | EndReason::Program | EndReason::Failure => {
            "a later `--set time.end=...`"
        }
    };
    let from = saved_at
        .map_or_else(String::new, |time| format!(" from its last checkpoint, at {}", plain_quantity(time, "s")));
    format!("to continue it{from}, give {change}; to compute it again, use `sphorge run` with `--overwrite`")
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
    if !RunDirectory::open(path)?.is_of_a_run() {
        return Err(ResumeError::NoCheckpoint { path: path.to_owned(), has_ended: false });
    }
    if RunDirectory::has_taken_no_step(path) {
        return Err(ResumeError::Unstepped { path: path.to_owned() });
    }
    let directory = RunDirectory::go_on(path, options.by_force)?;
    let mut passed_over = Vec::new();
    let mut unusable = None;
    for (_, file) in checkpoints(path)? {
        let why = match Checkpoint::open(&file) {
            Err(error) => error.to_string(),
            // As a former run leaves it whose folder a new one was overwriting when it was killed.
            Ok(checkpoint) if checkpoint.is_of_another_run(&directory) => {
                format!("{} belongs to another run", file.display())
            }
            Ok(checkpoint) => {
                match options.engines.iter().find(|engine| engine.saved_as() == checkpoint.about.engine) {
                    None => {
                        let known: Vec<_> =
                            options.engines.iter().map(|engine| format!("`{}`", engine.saved_as())).collect();
                        let (file, engine) = (file.display(), &checkpoint.about.engine);
                        format!("{file} was written by the engine `{engine}`, not by {}", known.join(" or "))
                    }
                    Some(kind) => {
                        let own = env!("CARGO_PKG_VERSION");
                        if checkpoint.about.version != own {
                            let version = &checkpoint.about.version;
                            observer.noted(&format!(
                            "{} was written by version {version}, this is {own}: it is used if all values fit, but the results may not be \
                             bit-identical",
                            file.display()
                        ));
                        }
                        let name = checkpoint.about.deck_name.clone();
                        let load = |overrides: &[(String, String)]| {
                            load_text_within(&name, &checkpoint.deck, overrides, options.most_particles)
                        };
                        match load(&[]) {
                            Err(report) => {
                                let why = format!("the deck in {} cannot be used: {report}", file.display());
                                unusable.get_or_insert(report);
                                why
                            }
                            Ok(own) => {
                                let setup = if options.overrides.is_empty() { own } else { load(&options.overrides)? };
                                let (directory, passed_over) = (directory.clone(), passed_over.clone());
                                let saved = Saved { directory, checkpoint, setup, passed_over };
                                match pool.install(|| go_on_from(saved, &**kind, options, stop, observer))? {
                                    Ok(summary) => return Ok(summary),
                                    Err(why) => format!("{}: {why}", file.display()),
                                }
                            }
                        }
                    }
                }
            }
        };
        if passed_over.len() < MOST_TOLD {
            observer.noted(&format!("{why}; it is skipped"));
        }
        passed_over.extend(file.file_name().map(|name| name.to_string_lossy().into_owned()));
    }
    tell_others(passed_over.len(), observer);
    if let Some(report) = unusable {
        return Err(report.into());
    }
    Err(ResumeError::NoCheckpoint { path: path.to_owned(), has_ended: summary_of_end(&directory).is_some() })
}

/// The summary of a run that has reached its end.
fn summary_of_end(directory: &RunDirectory) -> Option<Summary> {
    let has_ended = |summary: &Summary| matches!(summary.status, Status::Completed | Status::CompletedWithWarnings);
    Summary::read(directory).ok().filter(has_ended)
}

/// Whether a run is to go on from the end that its summary tells of. `former_fraction` is the share of kinetic energy of the deck it ended by.
fn goes_beyond(end: &Summary, asked: &TimeControl, former_fraction: impl FnOnce() -> Option<f64>) -> bool {
    if arrived(end.simulated_time, asked.end) || asked.max_steps.is_some_and(|most| end.steps >= most) {
        return false;
    }
    // One that came to rest goes on if it is to come closer to rest.
    let Some(fraction) = asked.stop_kinetic_fraction else { return true };
    end.end_reason != EndReason::KineticEnergy || former_fraction().is_some_and(|former| fraction < former)
}

/// What stood in the place of the deck of a run, and is not it.
const FOUND_DECK: &str = "deck-found.toml";

/// Checkpoints of no use, and frames, that are told one by one.
const MOST_TOLD: usize = 3;

/// Tells how many more checkpoints of no use there are.
fn tell_others(passed_over: usize, observer: &mut dyn Observer) {
    if passed_over > MOST_TOLD {
        observer.noted(&format!("{} more checkpoints are skipped for similar reasons", passed_over - MOST_TOLD));
    }
}

/// Steps that the files of a run know of: its summary or, of one that was killed, the last row of its history.
fn steps_done(directory: &RunDirectory) -> u64 {
    let of_summary = Summary::read(directory).map(|summary| summary.steps);
    of_summary.ok().or_else(|| last_step(directory)).unwrap_or(0)
}

/// The first body whose particles are listed in a file that is not what it was, and the file.
fn changed_list(checkpoint: &Checkpoint, model: &Model) -> Option<(String, PathBuf)> {
    let saved = &checkpoint.about.listed;
    if saved.is_empty() {
        return None;
    }
    let sums = listed::sums(model);
    model.bodies.iter().find_map(|body| match &body.shape.solid {
        Solid::Cloud { file, .. } if saved.get(&body.name).is_some_and(|sum| sums.get(&body.name) != Some(sum)) => {
            Some((body.name.clone(), file.clone()))
        }
        _ => None,
    })
}

/// What a run goes on from.
struct Saved {
    directory: RunDirectory,
    checkpoint: Checkpoint,
    setup: Setup,
    /// Later checkpoints of no use.
    passed_over: Vec<String>,
}

/// Goes on from one checkpoint; why it is none of this program, if it is not.
fn go_on_from(
    saved: Saved,
    kind: &dyn EngineKind,
    options: &ResumeOptions,
    stop: &AtomicBool,
    observer: &mut dyn Observer,
) -> Result<Result<Summary, String>, ResumeError> {
    let Saved { directory, mut checkpoint, setup, passed_over } = saved;
    let Setup { model, particles, masses, deck_text, .. } = setup;
    let path = directory.path().to_owned();
    if let Err(error) = checkpoint.open_parts(kind.ranks()) {
        return Ok(Err(error.chain()));
    }
    let (end, reached) = (model.time.end, checkpoint.about.time);
    if end < reached * (1.0 - 1e-12) {
        return Err(ResumeError::EndPassed { end, reached });
    }
    if let Some(summary) = summary_of_end(&directory) {
        let former_fraction = || {
            let deck =
                regular_file::read_to_string(&directory.deck(), most::DECK).ok().filter(|deck| *deck != deck_text)?;
            let former = load_text_within(&checkpoint.about.deck_name, &deck, &[], options.most_particles).ok()?;
            former.model.time.stop_kinetic_fraction
        };
        if !goes_beyond(&summary, &model.time, former_fraction) {
            let Summary { status, end_reason: reason, simulated_time: time, steps, .. } = summary;
            let saved_at = (checkpoint.about.step != steps).then_some(reached);
            return Err(ResumeError::Ended { path, status, reason, time, steps, saved_at });
        }
    }
    if let Some((body, file)) = changed_list(&checkpoint, &model) {
        return Err(ResumeError::Listed { body, file });
    }
    kind.supports(&model)
        .map_err(|unsupported| ResumeError::Run(RunError::Unsupported { engine: kind.name(), unsupported }))?;
    kind.take_deck(&checkpoint.about.deck_name, &deck_text);
    let simulation = Simulation::start(kind, model, particles)
        .map_err(|failure| ResumeError::Run(RunError::Start { engine: kind.name(), failure: Box::new(failure) }))?;
    let pace = Pace::new();
    let mut state = RunState::new(directory.clone(), simulation, &masses, pace, Beginning::Resumed)?;
    if let Err(error) = state.load(&mut checkpoint) {
        return Ok(Err(error.to_string()));
    }
    let about = &checkpoint.about;
    if (state.simulation.steps(), state.simulation.time()) != (about.step, about.time) {
        return Ok(Err("its values belong to another step than it says".to_owned()));
    }
    if let Some(field) = state.broken_field() {
        return Ok(Err(format!("its `{field}` has values that no particle can have")));
    }
    if let Some(name) = state.impossible_number(deck_text == checkpoint.deck) {
        return Ok(Err(format!("its `{name}` is not that of a run")));
    }
    if state.simulation.is_driven() && !observer.drives() {
        return Err(ResumeError::Driven { path });
    }
    tell_others(passed_over.len(), observer);
    let repeated = match steps_done(&directory).saturating_sub(about.step) {
        0 => String::new(),
        1 => "; 1 step is repeated".to_owned(),
        steps => format!("; {steps} steps are repeated"),
    };
    observer.noted(&format!("continuing from step {} at {}{repeated}", about.step, plain_quantity(about.time, "s")));
    observer.prepared();
    let output = |source| ResumeError::Run(RunError::Output { source });
    let name = checkpoint.about.deck_name.clone();
    let mut keeper = Keeper::new(options.checkpoints.clone(), name, deck_text.clone(), reached);
    let found = directory.read(DECK, most::DECK);
    let deck = found.as_ref().map_or_else(|_| String::new(), |deck| String::from_utf8_lossy(deck).into_owned());
    if deck_text != checkpoint.deck {
        // Nothing in the folder changes if the run cannot be saved with its changed deck: no checkpoint would be of that.
        state.align_output();
        keeper.save_changed(&mut state, deck.clone(), observer).map_err(output)?;
    }
    directory.adopt(checkpoint.about.run.as_deref());
    // From here on the folder is that of the run that goes on.
    let spoiled = state.recorder.spoiled_frames();
    if !spoiled.is_empty() {
        let few = spoiled[..spoiled.len().min(MOST_TOLD)].join(", ");
        let more = match spoiled.len().saturating_sub(MOST_TOLD) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        observer.noted(&format!("earlier frames are missing or damaged: {few}{more}"));
    }
    for name in state.recorder.rewrite().map_err(output)? {
        observer.noted(&format!("{name} was not what the run had written; it is written again"));
    }
    match found {
        Ok(_) if checkpoint.is_of(&deck) => {}
        Ok(bytes) => {
            directory.write(FOUND_DECK, Durability::Disk, |out| out.write_all(&bytes)).map_err(output)?;
            observer.noted(&format!(
                "{DECK} is not the deck of the run; the one in the checkpoint is used, and {DECK} is kept as {FOUND_DECK}"
            ));
        }
        Err(OutputError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
            observer.noted(&format!("there is no {DECK}; the one in the checkpoint is used"));
        }
        Err(_) => {
            directory.rename(DECK, FOUND_DECK).map_err(output)?;
            observer.noted(&format!(
                "{DECK} cannot be read; the one in the checkpoint is used, and {DECK} is kept as {FOUND_DECK}"
            ));
        }
    }
    if deck != deck_text {
        directory.write(DECK, Durability::Disk, |out| out.write_all(deck_text.as_bytes())).map_err(output)?;
    }
    // Checkpoints that others have put there are theirs.
    for file in passed_over.into_iter().filter(|file| directory.is_own(file)) {
        directory.remove(&file).map_err(output)?;
    }
    observer.started(&RunStart {
        directory: path.clone(),
        title: state.simulation.model().title.clone(),
        particles: state.simulation.count(),
        ranks: state.simulation.ranks(),
        threads: rayon::current_num_threads(),
        device: state.simulation.device(),
        end,
    });
    let ended = go_on(&mut state, &mut keeper, stop, observer);
    conclude(state, path, ended, observer).map(Ok).map_err(ResumeError::Run)
}

#[cfg(test)]
mod tests;
