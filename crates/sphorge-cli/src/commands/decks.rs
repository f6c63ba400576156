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
  sphorge decks iron-plate > my.toml      start a deck of your own
  sphorge schema > deck.schema.json       beside it: an editor that knows the
                                          first line of the deck completes keys")]
pub(crate) struct DecksArguments {
    /// Shipped deck to print
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// What tells editors which schema a deck has: that of `sphorge schema`, in the same folder.
const SCHEMA: &str = "#:schema deck.schema.json";

pub(crate) fn execute(arguments: DecksArguments) -> Ending {
    let text = match arguments.name {
        None => {
            let rows = DECKS.iter().map(|deck| vec![deck.name.to_owned(), deck.title()]);
            let table = table::columns(&["name", "case"], &[], rows.collect());
            format!("{table}\n`sphorge run NAME` runs one, `sphorge decks NAME` prints it.\n")
        }
        Some(name) => match decks::find(&name) {
            Some(deck) => format!("{SCHEMA}\n{}", deck.text),
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
