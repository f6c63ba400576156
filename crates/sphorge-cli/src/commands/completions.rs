//! `sphorge completions`: what makes a shell complete commands and options.

use crate::{
    arguments::Arguments,
    failure::{Ending, Outcome},
    terminal,
};
use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

/// Arguments of `completions`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge completions bash > ~/.local/share/bash-completion/completions/sphorge
  sphorge completions zsh > ~/.zfunc/_sphorge
  sphorge completions fish > ~/.config/fish/completions/sphorge.fish

A new shell uses them; zsh needs ~/.zfunc in its fpath.")]
pub(crate) struct CompletionsArguments {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

pub(crate) fn execute(arguments: CompletionsArguments) -> Ending {
    let mut text = Vec::new();
    generate(arguments.shell, &mut Arguments::command(), "sphorge", &mut text);
    terminal::print(&String::from_utf8_lossy(&text))?;
    Ok(Outcome::Done)
}
