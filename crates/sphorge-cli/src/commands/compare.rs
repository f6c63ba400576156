//! `sphorge compare`: runs side by side.

use crate::{
    failure::{Ending, Failure, Outcome},
    terminal,
};
use clap::Args;
use sphorge::compare::Comparison;
use std::path::PathBuf;

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge compare out/coarse out/fine
  sphorge compare out/every-step out/skin --json

Differences and speed-ups are relative to the first run.")]
pub(crate) struct CompareArguments {
    /// Run folders, of runs that have ended
    #[arg(value_name = "DIR", required = true)]
    directories: Vec<PathBuf>,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(crate) fn execute(arguments: CompareArguments) -> Ending {
    let comparison = Comparison::read(&arguments.directories).map_err(|error| Failure::BadInput(error.into()))?;
    let text = if arguments.json { terminal::json(&comparison)? } else { comparison.to_string() };
    terminal::print(&format!("{text}\n"))?;
    Ok(Outcome::Done)
}
