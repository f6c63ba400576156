//! `sphorge resume`: goes on with a run from its last checkpoint.

use super::run::{conclude, failure, parse_threads};
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
use sphorge::run::{ResumeError, ResumeOptions};
use std::path::PathBuf;

/// Arguments of `resume`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge resume out/taylor-bar
  sphorge resume out/taylor-bar --set time.end=\"120 us\" --threads 8

The run goes on from the last whole checkpoint in its folder, to the same
frames, history and summary as if it had never been broken, on any number
of threads. Of the deck only the end and the output can change. A run that
has reached its end goes on beyond it if it was made with
--checkpoint-at-end.")]
pub(crate) struct ResumeArguments {
    /// Folder of the run
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// Set a key of the deck that may change: `time.end`, `time.max-steps`, `time.stop-kinetic-fraction`, or one of `output`; repeatable
    #[arg(long = "set", value_name = "path=value", value_parser = parse_override)]
    overrides: Vec<(String, String)>,
    /// Number of threads [default: all of the machine]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
    /// Words of the name of the graphics card, of a run on one [default: the first that `sphorge devices` lists]
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    #[command(flatten)]
    ranks: RankArguments,
    /// End with exit code 1 if a check found the run broken
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    checkpoints: CheckpointArguments,
}

pub(crate) fn execute(arguments: ResumeArguments) -> Ending {
    let engines = engines_to_resume(arguments.device.as_deref())?;
    let Some(role) = arguments.ranks.join(arguments.threads, arguments.device.as_deref())? else {
        return Ok(Outcome::Done);
    };
    let mut display = ProgressDisplay::new();
    let stop = display.stop_flag()?;
    if let Err(ending) = role.launch((), &arguments.directory, &mut display, &stop) {
        return ending;
    }
    let options = ResumeOptions {
        overrides: arguments.overrides,
        most_particles: memory::particle_limit(),
        threads: role.threads(arguments.threads),
        checkpoints: arguments.checkpoints.plan()?,
        engines: role.engines(engines),
    };
    let result = sphorge::run::resume(&arguments.directory, &options, stop.flag(), &mut display);
    stop.finish();
    drop(display);
    let summary = result.map_err(|error| match error {
        ResumeError::Run(error) => failure(error),
        error => Failure::BadInput(error.into()),
    })?;
    conclude(&summary, &arguments.directory, arguments.strict)
}
