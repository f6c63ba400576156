//! The program `sphorge` as a library: arguments, progress and diagnostics over the library of that name, for the executable and for whatever else
//! brings the command line along.

mod arguments;
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

use arguments::Arguments;
use clap::Parser;
use failure::{Ending, Failure};
use std::ffi::OsString;

pub use engine_arguments::engine_of;
pub use memory::{OrEnd, particle_limit};
pub use terminal::text_of;

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
