//! `sphorge compare`: runs side by side.

use crate::{
    failure::{Ending, Failure, Outcome},
    terminal,
};
use clap::Args;
use sphorge::compare::Comparison;
use std::path::{Path, PathBuf};

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge compare out/coarse out/fine
  sphorge compare out/every-step out/skin --json
  sphorge compare out/iron-plate out/study/*

Differences and speed-ups are relative to the first run.")]
pub(crate) struct CompareArguments {
    /// Run folders, of runs that have ended
    #[arg(value_name = "DIR", required = true)]
    directories: Vec<PathBuf>,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// Whether a path is what a study has beside its runs, as `out/study/*` names it: its table, the decks of its runs, its pictures.
fn is_of_a_study(path: &Path) -> bool {
    let is_beside_runs = path.parent().is_some_and(|folder| folder.join("sweep.csv").is_file());
    is_beside_runs && (path.is_file() || path.file_name().is_some_and(|name| name == "plots"))
}

pub(crate) fn execute(arguments: CompareArguments) -> Ending {
    let runs: Vec<PathBuf> = arguments.directories.iter().filter(|path| !is_of_a_study(path)).cloned().collect();
    // Nothing but such files is no comparison.
    let runs = if runs.is_empty() { arguments.directories } else { runs };
    let comparison = Comparison::read(&runs).map_err(|error| Failure::BadInput(error.into()))?;
    let text = if arguments.json { terminal::json(&comparison)? } else { comparison.to_string() };
    terminal::print(&format!("{text}\n"))?;
    Ok(Outcome::Done)
}
