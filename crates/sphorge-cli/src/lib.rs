//! The program `sphorge` as a library: arguments, progress and diagnostics over the library of that name, for the executable and for whatever else
//! brings the command line along.

mod arguments;
mod browser;
mod checkpoint_arguments;
mod commands;
mod deck_arguments;
#[cfg(test)]
mod documents;
mod engine_arguments;
mod failure;
mod memory;
mod progress;
mod rank_arguments;
mod readable;
mod signals;
mod sweep_arguments;
mod table;
mod terminal;

use arguments::{Arguments, Command};
use clap::{
    CommandFactory, Parser,
    error::{ContextKind, ContextValue},
};
use failure::{Ending, Failure};
use std::{ffi::OsString, path::PathBuf};

pub use commands::run::report;
pub use engine_arguments::engine_of;
pub use memory::{OrEnd, particle_limit};
pub use terminal::{text_of, text_of_in};

/// Executes a command line, of which the first argument is the name of the program, and returns the exit code. `program` is the command that starts
/// this program once more, to which arguments are added.
pub fn execute(arguments: Vec<OsString>, program: &[OsString]) -> u8 {
    signals::meet_file_size_limits_as_errors();
    let command = match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => arguments.command,
        Err(error) => return arguments::refuse(&error, &arguments),
    };
    // A fault of ours still ends with an exit code scripts know.
    let ending: Ending = std::panic::catch_unwind(|| command.execute(program)).unwrap_or_else(|_| {
        terminal::note("This is a bug in Sphorge, not in the deck. Please report it together with the deck.");
        Err(Failure::Told)
    });
    if let Some(report) = ending.as_ref().err().and_then(Failure::report) {
        terminal::report(report);
    }
    failure::exit_code(&ending)
}

/// Draws what the arguments of `sphorge plot` ask for, and returns the files.
///
/// # Errors
/// In the words of the command line.
pub fn draw(arguments: Vec<OsString>) -> Result<Vec<PathBuf>, miette::Report> {
    let line = ["sphorge", "plot"].map(OsString::from).into_iter().chain(arguments);
    match Arguments::try_parse_from(line) {
        Ok(Arguments { command: Command::Plot(arguments) }) => {
            commands::plot::draw(&arguments).map_err(|failure| match failure {
                Failure::BadInput(report) | Failure::Failed(report) => report,
                _ => miette::miette!("the picture could not be drawn"),
            })
        }
        Ok(_) => Err(miette::miette!("these are not arguments of `plot`")),
        Err(error) => Err(refused(&error)),
    }
}

/// Long names of the options of `sphorge plot`, without their dashes.
pub fn plot_options() -> Vec<String> {
    let command = Arguments::command();
    let plot = command.find_subcommand("plot").into_iter().flat_map(clap::Command::get_arguments);
    let named = plot.filter_map(|argument| argument.get_long()).filter(|name| !matches!(*name, "help" | "output"));
    named.map(str::to_owned).collect()
}

/// An argument that was refused, in one sentence.
fn refused(error: &clap::Error) -> miette::Report {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    match (text(ContextKind::InvalidArg), text(ContextKind::InvalidValue)) {
        (Some(option), Some(value)) => {
            let why = std::error::Error::source(error).map_or_else(String::new, |why| format!(": {why}"));
            let known = match error.get(ContextKind::ValidValue) {
                Some(ContextValue::Strings(known)) => format!(": there are {}", known.join(", ")),
                _ => String::new(),
            };
            miette::miette!("`{option}` cannot be `{value}`{why}{known}")
        }
        _ => miette::miette!("{}", error.render().to_string().trim_end()),
    }
}
