//! The program `sphorge`: arguments, progress and diagnostics over the library of the same name.

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
mod table;
mod terminal;

use arguments::Arguments;
use clap::Parser;
use failure::{Ending, Failure};
use std::process::ExitCode;

#[global_allocator]
static MEMORY: memory::OrEnd = memory::OrEnd;

fn main() -> ExitCode {
    signals::meet_file_size_limits_as_errors();
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(error) => return arguments::refuse(&error),
    };
    // A fault of ours still ends with an exit code scripts know.
    let ending: Ending = std::panic::catch_unwind(|| command.execute()).unwrap_or_else(|_| {
        terminal::note("This is a bug in Sphorge, not in the deck. Please report it together with the deck.");
        Err(Failure::Told)
    });
    if let Some(report) = ending.as_ref().err().and_then(Failure::report) {
        terminal::report(report);
    }
    failure::exit_code(&ending)
}
