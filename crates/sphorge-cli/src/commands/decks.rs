//! `sphorge decks`: the decks that come with the program.

use crate::{
    failure::{Ending, Failure, Outcome},
    table, terminal,
};
use clap::Args;
use sphorge::deck::did_you_mean;
use sphorge::decks::{self, DECKS};

/// Arguments of `decks`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge decks
  sphorge decks iron-plate > my.toml      start a deck of your own")]
pub(crate) struct DecksArguments {
    /// Shipped deck to print
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

pub(crate) fn execute(arguments: DecksArguments) -> Ending {
    let text = match arguments.name {
        None => {
            let rows = DECKS.iter().map(|deck| vec![deck.name.to_owned(), deck.title()]);
            let table = table::columns(&["name", "case"], &[], rows.collect());
            format!("{table}\n`sphorge run NAME` runs one, `sphorge decks NAME` prints it.\n")
        }
        Some(name) => match decks::find(&name) {
            Some(deck) => deck.text.to_owned(),
            None => {
                let message = format!("there is no shipped deck `{name}`");
                let near = did_you_mean(decks::like(&name));
                return Err(Failure::bad_input(message, format!("{near}`sphorge decks` lists them")));
            }
        },
    };
    terminal::print(&text)?;
    Ok(Outcome::Done)
}
