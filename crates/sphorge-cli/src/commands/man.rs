//! `sphorge man`: manual pages.

use crate::{
    arguments::Arguments,
    failure::{Ending, Failure, Outcome},
    terminal,
};
use clap::{Args, CommandFactory};
use clap_mangen::Man;
use miette::{IntoDiagnostic, WrapErr};
use sphorge::deck::{did_you_mean, names_like};

/// Arguments of `man`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  mkdir -p ~/.local/share/man/man1
  sphorge man > ~/.local/share/man/man1/sphorge.1
  sphorge man run > ~/.local/share/man/man1/sphorge-run.1
  sphorge man run | man -l -

`man sphorge` and `man sphorge-run` show them then.")]
pub(crate) struct ManArguments {
    /// A command, such as `run` [default: the program]
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
}

pub(crate) fn execute(arguments: ManArguments) -> Ending {
    let mut program = Arguments::command();
    program.build();
    let asked = match &arguments.command {
        None => program,
        Some(name) => {
            let found = program.find_subcommand(name).cloned();
            found.ok_or_else(|| {
                let like = did_you_mean(names_like(name, program.get_subcommands().map(clap::Command::get_name)));
                let help = format!("{like}`sphorge --help` lists the commands");
                Failure::bad_input(format!("there is no command `{name}`"), help)
            })?
        }
    };
    let mut text = Vec::new();
    let written = Man::new(asked).render(&mut text);
    written.into_diagnostic().wrap_err("cannot write the page").map_err(Failure::Failed)?;
    terminal::print(&String::from_utf8_lossy(&text))?;
    Ok(Outcome::Done)
}
