//! One file per command: its arguments, the call into the library, what is printed.

pub(crate) mod ballistic_limit;
pub(crate) mod bench;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod convergence;
pub(crate) mod decks;
pub(crate) mod devices;
pub(crate) mod fragments;
pub(crate) mod man;
pub(crate) mod materials;
mod picture_arguments;
mod picture_names;
pub(crate) mod plot;
mod plot_quantities;
pub(crate) mod resume;
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod sweep;
pub(crate) mod validate;
pub(crate) mod view;
