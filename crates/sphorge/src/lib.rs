//! Smoothed-particle hydrodynamics for metals that yield, flow and break.
//!
//! A [`deck`] becomes a validated [`model`]; [`run`] takes its [`particles`] through time with an [`engine`], [`measures`] them and
//! writes what happened ([`output`]); [`plot`] and [`compare`] read the files, [`validate`] compares cases with known answers.

pub mod bench;
pub mod compare;
pub mod forecast;
mod machine;
pub mod measures;
mod number;
mod observed;
pub mod output;
pub mod plot;
pub mod run;
pub mod validate;

pub use sphorge_deck as deck;
pub use sphorge_deck::{decks, material};
pub use sphorge_engine as engine;
pub use sphorge_engine::{Model, Particles, geometry, model, particles};
