//! The command line as a whole; each command declares its own arguments in [`crate::commands`].

use crate::{commands::*, deck_arguments::is_typographic_quote, failure::Ending, terminal};
use clap::{
    Parser, Subcommand,
    error::{ContextKind, ContextValue, ErrorKind},
};
use sphorge::deck::moves_the_cursor;
use std::ffi::OsString;

/// Says what is wrong with the arguments, or the help that was asked for.
pub(crate) fn refuse(error: &clap::Error, given: &[OsString]) -> u8 {
    let is_plain = |text: &str| !text.contains(moves_the_cursor);
    if given.iter().all(|argument| argument.to_str().is_some_and(is_plain)) {
        // In colours, where the terminal has them. There is nobody left to tell if that fails.
        let _ = error.print();
    } else {
        // The message quotes what was given.
        let text = error.render().to_string();
        terminal::note_lines(text.trim_end());
    }
    if let Some(tip) = unquoted(error, given) {
        terminal::note(&tip);
    }
    u8::try_from(error.exit_code()).unwrap_or(2)
}

/// What to say where the shell has taken apart what belongs to one `--set` or `--vary`: a value with blanks, or blanks around `=`.
fn unquoted(error: &clap::Error, given: &[OsString]) -> Option<String> {
    let pieces = given.iter().map(|piece| piece.to_str()).collect::<Option<Vec<_>>>()?;
    let word = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.as_str()),
        _ => None,
    };
    let at = match error.kind() {
        // A word is left over. Of a negative number clap gives the first digit, as if it were a short option.
        ErrorKind::UnknownArgument => {
            let word = word(ContextKind::InvalidArg)?;
            let is_it =
                |text: &&str| *text == word || (word.len() == 2 && !text.starts_with("--") && text.starts_with(word));
            pieces.iter().position(is_it)?
        }
        // A key stands alone, and what follows has not been looked at.
        ErrorKind::ValueValidation => {
            let word = word(ContextKind::InvalidValue)?;
            1 + pieces
                .iter()
                .position(|text| *text == word || text.split_once('=').is_some_and(|(_, of)| of == word))?
        }
        _ => return None,
    };
    let (from, option) = pieces[..at].iter().enumerate().rev().find_map(|(from, text)| {
        let option = ["--set", "--vary"]
            .into_iter()
            .find(|option| text.strip_prefix(option).is_some_and(|rest| rest.is_empty() || rest.starts_with('=')));
        option.map(|option| (from, option))
    })?;
    // To the next option; what the word follows is the value, if no option lies between.
    let is_option = |piece: &&str| piece.starts_with('-') && !piece.contains(char::is_numeric);
    let end = pieces.iter().skip(from + 1).position(is_option).map_or(pieces.len(), |k| from + 1 + k);
    if at >= end {
        return None;
    }
    let joined = pieces[from..end].join(" ");
    let text = joined.strip_prefix(option)?.trim_start_matches(['=', ' ']);
    let (key, value) = text.split_once('=').or_else(|| text.split_once(' '))?;
    let (key, value) = (key.trim(), value.trim());
    let plain = value.replace(is_typographic_quote, "");
    let reason = if plain != value {
        "The shell does not know typographic quotes"
    } else if text.starts_with(&format!("{key}={value}")) {
        "A value with blanks needs quotes, or the shell takes it apart"
    } else {
        "A key, `=` and its value are one word"
    };
    Some(format!("{reason}: {option} '{key}={plain}'"))
}

/// The program `sphorge`.
#[derive(Debug, Parser)]
#[command(
    name = "sphorge",
    version,
    arg_required_else_help = true,
    about = "Smoothed-particle hydrodynamics for metals that yield, flow and break",
    after_help = "\
Getting started:
  sphorge run iron-plate              run a Taylor impact, a few seconds
  sphorge plot out/iron-plate         draw pictures of it
  sphorge view out/iron-plate         look at it in a browser
  sphorge decks                       list all shipped decks
  sphorge decks iron-plate > my.toml  start a deck of your own

Exit codes: 0 completed; 1 the run failed (results up to that point are
kept), a validation check failed, or --strict found the run broken; 2 bad
input; 130 stopped by the user."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a deck and write fields, history and summary to a folder
    Run(run::RunArguments),
    /// Continue a run that was stopped or killed; results are bit-identical to an uninterrupted run
    Resume(resume::ResumeArguments),
    /// Check a deck and estimate its cost: particles, mass, time step, memory, run time
    Check(check::CheckArguments),
    /// List the shipped decks, or print one
    Decks(decks::DecksArguments),
    /// List the material catalogue, or print the constants and sources of one material
    Materials(materials::MaterialsArguments),
    /// Draw pictures of runs: particles and history curves
    // It has by far the most options.
    Plot(Box<plot::PlotArguments>),
    /// Look at runs in a browser, also while they go on: fields, sections, history, single particles
    View(Box<view::ViewArguments>),
    /// List what has broken off in a run: mass, velocity, spin and size of every fragment
    Fragments(fragments::FragmentsArguments),
    /// Run a deck with every combination of some values of some keys, and list what was measured
    Sweep(sweep::SweepArguments),
    /// Run a deck at several particle spacings: order of convergence and limit of every measure
    Convergence(convergence::ConvergenceArguments),
    /// Run a deck at several impact speeds: the speed at which a projectile gets through, and how fast it then leaves
    BallisticLimit(Box<ballistic_limit::BallisticLimitArguments>),
    /// Compare runs side by side: status, measures, cost, conservation
    Compare(compare::CompareArguments),
    /// Run the validation cases and compare the results with published and exact ones
    Validate(validate::ValidateArguments),
    /// List the graphics cards that `--engine gpu` can use
    Devices(devices::DevicesArguments),
    /// Measure the speed of this program on this machine
    Bench(bench::BenchArguments),
    /// Print the JSON schema of decks, for completion in an editor
    #[command(after_help = "\
Example:
  sphorge schema > deck.schema.json")]
    Schema,
    /// Print what makes a shell complete commands and options
    Completions(completions::CompletionsArguments),
    /// Print the manual page of the program or of a command
    Man(man::ManArguments),
}

impl Command {
    pub(crate) fn execute(self, program: &[OsString]) -> Ending {
        match self {
            Self::Run(arguments) => run::execute(arguments),
            Self::Resume(arguments) => resume::execute(arguments),
            Self::Check(arguments) => check::execute(arguments),
            Self::Decks(arguments) => decks::execute(arguments),
            Self::Materials(arguments) => materials::execute(arguments),
            Self::Plot(arguments) => plot::execute(&arguments),
            Self::View(arguments) => view::execute(&arguments),
            Self::Fragments(arguments) => fragments::execute(arguments),
            Self::Sweep(arguments) => sweep::execute(arguments, program),
            Self::Convergence(arguments) => convergence::execute(arguments, program),
            Self::BallisticLimit(arguments) => ballistic_limit::execute(*arguments, program),
            Self::Compare(arguments) => compare::execute(arguments),
            Self::Validate(arguments) => validate::execute(arguments),
            Self::Devices(arguments) => devices::execute(arguments),
            Self::Bench(arguments) => bench::execute(arguments),
            Self::Schema => schema::execute(),
            Self::Completions(arguments) => completions::execute(arguments),
            Self::Man(arguments) => man::execute(arguments),
        }
    }
}
