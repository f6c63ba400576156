//! Smoothed-particle hydrodynamics for metals that yield, flow and break.
//!
//! A deck becomes a validated [`model`], an engine ([`solver`]) steps its [`particles`], sinks write what happened, analysis
//! measures, plots and compares.

pub mod analysis;
pub mod bench;
pub mod boundary;
pub mod deck;
pub mod decks;
pub mod forecast;
pub mod geometry;
mod lanes;
pub mod material;
pub mod model;
pub mod neighbors;
pub mod output;
pub mod particles;
pub mod run;
pub mod solver;

pub use model::Model;
pub use particles::Particles;
