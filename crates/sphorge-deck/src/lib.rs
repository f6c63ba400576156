//! Decks: from the text a user writes to a model and its particles, or to diagnostics that name the line and the cure.
//!
//! Text, with `--set` overrides worked in -> raw structs (`raw`, the only place a key is declared) -> model in SI units
//! (`interpret`) -> particles ([`sphorge_engine::geometry`]).

mod advice;
mod argument;
mod bonds;
mod choice;
mod closeness;
mod coefficients;
pub mod decks;
mod declare;
pub(crate) mod defaults;
mod driven;
mod drives;
mod expected;
mod falls;
mod fault;
mod foreign;
mod heat;
mod impacts;
mod interpret;
mod keys;
mod linear_law;
mod load;
pub mod material;
mod method;
mod overrides;
mod placement;
mod printable;
pub(crate) mod quantity;
mod quarters;
pub(crate) mod raw;
mod reach;
mod report;
mod scalar;
mod schema;
mod slips;
mod splashes;
mod strategy;
mod suggest;
mod unit;
mod value;
mod written;

#[cfg(test)]
mod tests;

pub use advice::{Advice, advice};
pub use argument::{quantity_of_key, read_difference, read_quantity};
pub use driven::{is_marked_as_driven, marked_as_driven, without_driven_mark};
pub use load::{
    Setup, load, load_model, load_text, load_text_model, load_text_of, load_text_within, overlapping_keys, read_deck,
    undone_by, with_overrides,
};
pub use printable::moves_the_cursor;
pub use report::{DeckReport, Problem};
pub use schema::schema;
pub use suggest::{did_you_mean, like as names_like};
pub use unit::unit_symbols;

/// The words of the key `search`, one for each neighbour search.
pub fn search_words() -> Vec<&'static str> {
    use value::Choices;
    choice::SearchWord::table().into_iter().map(|row| row.0).collect()
}
