//! `sphorge resume`: goes on with a run from its last checkpoint.

use super::run::{ToldArguments, conclude, failure, parse_threads};
use crate::{
    checkpoint_arguments::CheckpointArguments,
    deck_arguments::parse_override,
    engine_arguments::engines_to_resume,
    failure::{Ending, Failure, Outcome},
    memory,
    progress::ProgressDisplay,
    rank_arguments::RankArguments,
};
use clap::Args;
use sphorge::run::{ResumeError, ResumeOptions, RunError};
use std::path::PathBuf;

/// Arguments of `resume`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge resume out/taylor-bar
  sphorge resume out/taylor-bar --set time.end=\"120 us\" --threads 8

The run continues from the last complete checkpoint in its folder, on any
number of threads. Frames and history are bit-identical to those of an
uninterrupted run. Only the end and the output of the deck can be changed.
A run that has reached its end is not changed, unless it is extended, for
example by a later time.end. If it was started with --checkpoint-at-end, it
continues from its end, otherwise from its last checkpoint.")]
pub(crate) struct ResumeArguments {
    /// Run folder
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// Set one of the keys that may change: `time.end`, `time.max-steps`, `time.stop-kinetic-fraction` and those of `output`; can be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<(String, String)>,
    /// Number of threads; with `--ranks`, of each process [default: all processors]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
    /// For a run on a graphics card, the card to use, by words of its name or interface [default: the first that `sphorge devices` lists]
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    #[command(flatten)]
    ranks: RankArguments,
    /// Take the folder from a run that writes to it, or seems to; that one stops before its next file
    #[arg(long)]
    no_lock: bool,
    /// Exit with code 1 if a check finds the run broken
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    checkpoints: CheckpointArguments,
    #[command(flatten)]
    told: ToldArguments,
}

pub(crate) fn execute(arguments: ResumeArguments) -> Ending {
    let engines = engines_to_resume(arguments.device.as_deref())?;
    let Some(role) = arguments.ranks.join(arguments.threads, arguments.device.as_deref())? else {
        return Ok(Outcome::Done);
    };
    let mut display = ProgressDisplay::new(arguments.told.quiet);
    let stop = display.stop_flag()?;
    if let Err(ending) = role.launch((), &arguments.directory, &mut display, &stop) {
        return ending;
    }
    let options = ResumeOptions {
        by_force: arguments.no_lock,
        overrides: arguments.overrides,
        most_particles: memory::particle_limit(),
        threads: role.threads(arguments.threads),
        checkpoints: arguments.checkpoints.plan()?,
        engines: role.engines(engines),
    };
    let result = sphorge::run::resume(&arguments.directory, &options, stop.flag(), &mut display);
    stop.finish();
    drop(display);
    if let Err(ResumeError::Run(RunError::Failed { summary, .. })) = &result {
        arguments.told.print_json(summary)?;
    }
    let summary = result.map_err(|error| match error {
        ResumeError::Run(error) => failure(error),
        error => Failure::BadInput(error.into()),
    })?;
    conclude(&summary, &arguments.directory, arguments.strict, arguments.told)
}
