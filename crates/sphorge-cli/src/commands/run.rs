//! `sphorge run`: a deck becomes a folder of results.

use super::view;
use crate::{
    checkpoint_arguments::CheckpointArguments,
    deck_arguments::DeckArguments,
    engine_arguments::EngineArguments,
    failure::{Ending, Failure, Outcome},
    progress::ProgressDisplay,
    rank_arguments::RankArguments,
    readable, table, terminal,
};
use clap::Args;
use sphorge::{
    output::{BodyRecord, EndReason, MemoryOf, RunDirectory, Status, Summary},
    run::{RunError, RunOptions},
    view::Viewer,
};
use std::{
    path::{Path, PathBuf},
    sync::atomic::Ordering,
    thread,
    time::Duration,
};

/// Arguments of `run`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge run iron-plate
  sphorge run my.toml -o out/fine --set particles.spacing=\"0.15 mm\" --threads 8
  sphorge run taylor-bar --precision double --set time.end=\"20 us\" --overwrite
  sphorge run iron-plate --view

Ctrl-C stops the run after the current step and saves its state. All files
are complete up to that point, and the exit code is 130; before the first
step nothing is written. `sphorge resume` continues the run, after a crash
from the last checkpoint. SIGUSR1 writes a checkpoint at once.

Checks during the run warn if it is numerically broken, for example by more
plastic work than energy supplied or by particles that cluster in pairs.
summary.json lists the warnings; [warnings] in the deck sets their limits.")]
pub(crate) struct RunArguments {
    #[command(flatten)]
    deck: DeckArguments,
    /// Output folder [default: out/<deck name>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Number of threads; with `--ranks`, of each process [default: all processors]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
    #[command(flatten)]
    engine: EngineArguments,
    #[command(flatten)]
    ranks: RankArguments,
    /// Replace an existing run in the output folder
    #[arg(long)]
    overwrite: bool,
    /// With `--overwrite`, take the folder from a run that writes to it, or seems to; that one stops before its next file
    #[arg(long)]
    no_lock: bool,
    /// Exit with code 1 if a check finds the run broken
    #[arg(long)]
    strict: bool,
    /// Open a page that shows the run while it goes on, as `sphorge view` does; the program stays until Ctrl-C
    #[arg(long)]
    view: bool,
    /// With `--view`, print the address of the page and open no browser
    #[arg(long, requires = "view")]
    no_open: bool,
    #[command(flatten)]
    checkpoints: CheckpointArguments,
    #[command(flatten)]
    told: ToldArguments,
}

/// What is told of a run.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct ToldArguments {
    /// Print neither progress nor notes, nor the table at the end; warnings and errors are printed
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Print the summary as JSON, as in summary.json, in place of the table
    #[arg(long)]
    json: bool,
}

impl ToldArguments {
    /// Prints the summary as JSON, if that was asked for.
    pub(crate) fn print_json(self, summary: &Summary) -> Result<(), Failure> {
        if self.json { terminal::print(&format!("{}\n", terminal::json(summary)?)) } else { Ok(()) }
    }
}

/// A number of threads: at least one.
pub(crate) fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=4096) => Ok(threads),
        _ => Err("write a number from 1 to 4096".to_owned()),
    }
}

/// What is said of more threads than there are processors, which wait for each other at every sum.
pub(crate) fn too_many_threads(threads: usize) -> Option<String> {
    let processors = std::thread::available_parallelism().ok()?.get();
    (threads > processors).then(|| {
        format!("note: {threads} threads on {processors} processors are slower than {processors}: leave out `--threads` to use all processors")
    })
}

pub(crate) fn execute(arguments: RunArguments) -> Ending {
    let engine = arguments.engine.find()?;
    let Some(role) = arguments.ranks.join(arguments.threads, arguments.engine.device())? else {
        return Ok(Outcome::Done);
    };
    let engine = role.engine(engine)?;
    let deck = arguments.deck.find()?;
    let directory = arguments.output.unwrap_or_else(|| Path::new("out").join(deck.name()));
    // Filling large bodies takes a while: say so before if the folder is in the way.
    RunDirectory::check(&directory, arguments.overwrite).map_err(|error| Failure::BadInput(error.into()))?;
    let mut display = ProgressDisplay::new(arguments.told.quiet);
    let stop = display.stop_flag()?;
    let options = RunOptions {
        directory: directory.clone(),
        overwrite: arguments.overwrite,
        by_force: arguments.no_lock,
        threads: role.threads(arguments.threads),
        checkpoints: arguments.checkpoints.plan()?,
    };
    let setup = deck.load()?;
    let setup = match role.launch(setup, &directory, &mut display, &stop) {
        Ok(setup) => setup,
        Err(ending) => return ending,
    };
    if !arguments.told.quiet {
        setup.all_notes().iter().for_each(|note| terminal::note(&format!("note: {note}")));
        if let Some(note) = arguments.checkpoints.note(setup.model.time.end) {
            terminal::note(&note);
        }
        if let Some(note) = arguments.threads.and_then(too_many_threads) {
            terminal::note(&note);
        }
    }
    let viewer = if arguments.view { Some(view(&directory, !arguments.no_open)?) } else { None };
    let result = sphorge::run::execute(setup, &*engine, &options, stop.flag(), &mut display);
    stop.finish();
    drop(display);
    if let Err(RunError::Failed { summary, .. }) = &result {
        arguments.told.print_json(summary)?;
    }
    let ending =
        result.map_err(failure).and_then(|summary| conclude(&summary, &directory, arguments.strict, arguments.told));
    // Who has stopped the run has seen enough, and of one that was refused there is nothing to see.
    let stays = viewer.is_some() && !stop.flag().load(Ordering::Relaxed);
    if stays && !matches!(ending, Err(Failure::BadInput(_))) {
        stop.be_quiet();
        if let Some(report) = ending.as_ref().err().and_then(Failure::report) {
            terminal::report(report);
        }
        terminal::note("the page shows the run until Ctrl-C");
        while !stop.flag().load(Ordering::Relaxed) {
            thread::sleep(Duration::from_millis(50));
        }
        return ending.map_err(Failure::told);
    }
    ending
}

/// Shows a run that is about to write to a folder.
fn view(directory: &Path, opens: bool) -> Result<Viewer, Failure> {
    let viewer = Viewer::await_run(directory, 0).map_err(view::failure)?;
    viewer.start().map_err(view::failure)?;
    // Standard output holds the result alone.
    terminal::note(viewer.address());
    view::open(&viewer, opens);
    Ok(viewer)
}

/// What a run that could not be made or failed is for the user.
pub(crate) fn failure(error: RunError) -> Failure {
    if error.exit_code() == 2 { Failure::BadInput(error.into()) } else { Failure::Failed(error.into()) }
}

/// Tells how a run ended.
pub(crate) fn conclude(summary: &Summary, directory: &Path, strict: bool, told: ToldArguments) -> Ending {
    told.print_json(summary)?;
    if !told.json && !told.quiet {
        terminal::print(&report_with_files(summary, directory))?;
    }
    match summary.status {
        Status::Stopped => Ok(Outcome::Stopped),
        Status::CompletedWithWarnings if strict => {
            let names: Vec<&str> = summary.warnings.iter().map(|warning| warning.name.as_str()).collect();
            terminal::note(&format!("--strict: the run has warnings: {}", names.join(", ")));
            Err(Failure::Told)
        }
        _ => Ok(Outcome::Done),
    }
}

/// How far the particles of each body are from the mass of its shape.
fn masses(bodies: &[BodyRecord]) -> String {
    let off = |body: &BodyRecord| body.mass / body.shape_mass - 1.0;
    let told: Vec<String> = bodies
        .iter()
        .filter(|body| off(body).abs() > 1e-9)
        .map(|body| format!("`{}` {}", body.name, readable::percent(off(body))))
        .collect();
    let of_shapes = if told.is_empty() {
        "equal to that of the shapes".to_owned()
    } else {
        format!("difference from the shape: {}", told.join(", "))
    };
    let added = bodies.iter().filter(|body| body.added_mass > 0.0);
    let added: Vec<String> = added
        .map(|body| format!("`{}` {}", body.name, readable::percent(body.added_mass / (body.mass - body.added_mass))))
        .collect();
    if added.is_empty() { of_shapes } else { format!("{of_shapes}; added by mass scaling: {}", added.join(", ")) }
}

/// What the run did, for people.
pub fn report(summary: &Summary) -> String {
    table::facts(&facts(summary))
}

/// The same with where its files are and what can be done with them.
fn report_with_files(summary: &Summary, directory: &Path) -> String {
    let mut facts = facts(summary);
    let folder = terminal::path_in_command(directory);
    facts.push(("files", format!("{}: summary.json, history.csv, deck.toml, fields/", terminal::path(directory))));
    let fields = terminal::path_in_command(&directory.join("fields.pvd"));
    facts.push(("in ParaView", format!("paraview {fields}")));
    facts.push(("pictures", format!("sphorge plot {folder}")));
    // What a program drove does not go on without it.
    let can_go_on = summary.status == Status::Stopped && summary.driven.is_none();
    if can_go_on && RunDirectory::open(directory).is_ok_and(|run| run.has_checkpoint()) {
        let ranks = if summary.ranks > 1 { format!(" --ranks {}", summary.ranks) } else { String::new() };
        facts.push(("to continue", format!("sphorge resume {folder}{ranks}")));
    }
    table::facts(&facts)
}

fn facts(summary: &Summary) -> Vec<(&str, String)> {
    let end = match summary.end_reason {
        EndReason::EndTime => "reached its end time",
        EndReason::KineticEnergy => "reached `time.stop-kinetic-fraction`",
        EndReason::MaxSteps => "reached `time.max-steps`",
        EndReason::User => "stopped by the user",
        EndReason::Program => "stopped by the program that drives it",
        EndReason::Failure => "failed",
    };
    let drift =
        |last: f64, largest: f64| format!("{} (largest {})", readable::percent(last), readable::percent(largest));
    let energy = &summary.energy;
    let masses = masses(&summary.bodies);
    let memory = format!(
        "{}{}",
        readable::bytes(summary.peak_memory_bytes as f64),
        match summary.peak_memory_of {
            MemoryOf::Engine => " as the engine counts it",
            MemoryOf::Process if summary.ranks > 1 => " on the first rank",
            MemoryOf::Process => "",
        }
    );
    let mut facts = vec![
        ("run", format!("{end} at {}", readable::quantity(summary.simulated_time, "s"))),
        (
            "work",
            format!(
                "{} particles x {} steps in {} on {}",
                readable::count(summary.particles),
                readable::count(summary.steps),
                readable::duration(summary.wall_seconds),
                readable::computer(summary.device.as_deref(), summary.ranks, summary.threads),
            ),
        ),
        ("speed", format!("{} particle-steps/s", readable::large(summary.particle_steps_per_second))),
        ("memory", memory),
        ("mass", masses),
        ("energy drift", drift(energy.relative_drift, energy.largest_relative_drift)),
        ("momentum drift", drift(summary.momentum_drift, summary.largest_momentum_drift)),
    ];
    if let Some(driven) = &summary.driven {
        facts.push(("driven", format!("{driven}; its deck alone is another run")));
    }
    if let Some(by) = &summary.stopped_by {
        facts.push(("stopped by", by.clone()));
    }
    let warnings: Vec<&str> = summary.warnings.iter().map(|warning| warning.name.as_str()).collect();
    let warnings = format!("{}: explained in summary.json", warnings.join(", "));
    if !summary.warnings.is_empty() {
        facts.push(("warnings", warnings));
    }
    for (name, value) in &summary.measures {
        let unit = summary.measure_units.get(name).map_or("", String::as_str);
        let value = value.map_or_else(|| "no value yet".to_owned(), |value| readable::quantity(value, unit));
        facts.push((name, value));
    }
    facts
}
