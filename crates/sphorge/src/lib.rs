//! Smoothed-particle hydrodynamics for metals that yield, flow and break.
//!
//! A [`deck`] becomes a validated [`model`]; [`run`] takes its [`particles`] through time with an [`engine`], [`measures`] them and
//! writes what happened ([`output`]); [`plot`], [`fragments`] and [`compare`] read the files, [`sweep`] varies keys of a deck,
//! [`validate`] compares cases with known answers, [`view`] shows runs in a browser.
//!
//! ```
//! use sphorge::{deck::load_text, decks, engine::ENGINES, output::{RunDirectory, Summary}, run::{RunOptions, Silent, execute}};
//! use std::{path::PathBuf, sync::atomic::AtomicBool};
//!
//! let plate = decks::find("iron-plate").ok_or("a shipped deck")?;
//! // As `sphorge run iron-plate --set time.max-steps=3`.
//! let setup = load_text(plate.name, plate.text, &[("time.max-steps".into(), "3".into())])?;
//! let directory = PathBuf::from("out/iron-plate");
//! # let folder = tempfile::tempdir()?;
//! # let directory = folder.path().join("run");
//! let options = RunOptions { directory, ..RunOptions::default() };
//! execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent)?;
//!
//! let summary = Summary::read(&RunDirectory::open(&options.directory)?)?;
//! assert_eq!(summary.steps, 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The folder `examples` of the crate has longer ones: running a deck with progress and pictures, varying a parameter, reading a run.

pub mod bench;
mod cells;
pub mod compare;
pub mod forecast;
pub mod fragments;
mod machine;
pub mod measures;
mod number;
mod observed;
pub mod output;
pub mod plot;
pub mod run;
pub mod sweep;
pub mod validate;
pub mod view;

pub use sphorge_deck as deck;
pub use sphorge_deck::{decks, material};
pub use sphorge_engine as engine;
pub use sphorge_engine::{Model, Particles, geometry, model, particles};
