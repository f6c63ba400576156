//! `sphorge schema`: the JSON schema of decks.

use crate::{
    failure::{Ending, Outcome},
    terminal,
};
use sphorge::deck;

pub(crate) fn execute() -> Ending {
    terminal::print(&format!("{}\n", terminal::json(deck::schema())?))?;
    Ok(Outcome::Done)
}
