//! `sphorge convergence`: a deck at several particle spacings.

use crate::{
    deck_arguments::DeckArguments,
    failure::{Ending, Failure},
    sweep_arguments::{SweepRunArguments, conclude, failure},
    terminal,
};
use clap::Args;
use sphorge::sweep::{Convergence, Planning, spaced};
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

/// Arguments of `convergence`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge convergence iron-plate --spacing \"1.2 mm,0.6 mm,0.3 mm\"
  sphorge convergence my.toml --spacing \"2 mm,1 mm,0.5 mm\" -j 2

Order and limit come from the three finest spacings, by Richardson's
extrapolation; `finest off by` is the finest value against the limit. They
say what refinement alone would give, if the values are on their way there:
four spacings tell more than three. A body with a spacing of its own keeps
its ratio to particles.spacing. As with `sphorge sweep`, the same command
with more spacings makes only the runs that are missing. The table is also
written to convergence.csv, that of the runs to sweep.csv.")]
pub(crate) struct ConvergenceArguments {
    #[command(flatten)]
    deck: DeckArguments,
    /// Values of `particles.spacing`, with commas between them
    #[arg(long, value_name = "SPACINGS", value_delimiter = ',', required = true)]
    spacing: Vec<String>,
    /// Output folder [default: out/<deck name>-convergence]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    runs: SweepRunArguments,
}

pub(crate) fn execute(arguments: ConvergenceArguments, program: &[OsString]) -> Ending {
    let ConvergenceArguments { deck, spacing, output, runs } = arguments;
    let engine = runs.engine.find()?;
    let deck = deck.find()?;
    deck.refuse_set_keys(["particles.spacing"].into_iter())?;
    let folder = output.unwrap_or_else(|| Path::new("out").join(format!("{}-convergence", deck.name())));
    let spacings: Vec<String> = spacing.iter().map(|text| text.trim().to_owned()).collect();
    // Nothing is written meanwhile: Ctrl-C ends the program.
    let planning = Planning { folder: &folder, engine: &*engine, again: runs.overwrite, stop: &AtomicBool::new(false) };
    let spaced = spaced(|set| deck.load_with(set), &spacings, &planning).map_err(failure)?;
    for body in &spaced.in_proportion {
        terminal::note(&format!("note: the spacing of `{body}` keeps its ratio to `particles.spacing`"));
    }
    let (table, is_stopped) = match runs.execute(&spaced.sweep, program) {
        Ok(table) => table,
        Err(ending) => return ending,
    };
    let convergence = Convergence::of(&table);
    convergence.write(&folder).map_err(|error| Failure::Failed(error.into()))?;
    terminal::print(&format!(
        "{table}\n{convergence}\ntables: {}: sweep.csv, convergence.csv\n",
        terminal::path(&folder)
    ))?;
    conclude(&table, is_stopped)
}
