//! The command line as a whole; each command declares its own arguments in [`crate::commands`].

use crate::{commands::*, failure::Ending};
use clap::{Parser, Subcommand};

/// The program `sphorge`.
#[derive(Debug, Parser)]
#[command(
    name = "sphorge",
    version,
    arg_required_else_help = true,
    about = "Smoothed-particle hydrodynamics for metals that yield, flow and break",
    after_help = "\
Start with
  sphorge run iron-plate            a Taylor impact, a few seconds
  sphorge plot out/iron-plate       pictures of it
  sphorge decks                     what else is shipped

Exit codes: 0 done, 1 the run failed (what was computed is kept) or, with
--strict, is broken, 2 bad input, 130 stopped by the user."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a deck: write fields, history and summary to a folder
    Run(run::RunArguments),
    /// Resume a run that was stopped or killed; results are bit-identical to an unbroken run
    Resume(resume::ResumeArguments),
    /// Preview a deck's size and cost: particles, mass, time step, memory, run time
    Check(check::CheckArguments),
    /// List the shipped decks, or print one
    Decks(decks::DecksArguments),
    /// List the materials of the catalogue, or print one with its constants and reference
    Materials(materials::MaterialsArguments),
    /// Plot particles before and after, and history curves, of runs
    Plot(plot::PlotArguments),
    /// Compare runs side by side: time, speed, conservation, measures
    Compare(compare::CompareArguments),
    /// Run the cases with known answers and compare results with the references
    Validate(validate::ValidateArguments),
    /// List the graphics cards that `--engine gpu` can run on
    Devices(devices::DevicesArguments),
    /// Benchmark this program on this machine
    Bench(bench::BenchArguments),
    /// Print the JSON schema of decks, for completion in an editor
    Schema,
}

impl Command {
    pub(crate) fn execute(self) -> Ending {
        match self {
            Self::Run(arguments) => run::execute(arguments),
            Self::Resume(arguments) => resume::execute(arguments),
            Self::Check(arguments) => check::execute(arguments),
            Self::Decks(arguments) => decks::execute(arguments),
            Self::Materials(arguments) => materials::execute(arguments),
            Self::Plot(arguments) => plot::execute(arguments),
            Self::Compare(arguments) => compare::execute(arguments),
            Self::Validate(arguments) => validate::execute(arguments),
            Self::Devices(arguments) => devices::execute(arguments),
            Self::Bench(arguments) => bench::execute(arguments),
            Self::Schema => schema::execute(),
        }
    }
}
