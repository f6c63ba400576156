//! The model of a problem, the particles it becomes, and the engines that take them through time.
//!
//! [`model`] is the problem in SI units, [`geometry`] fills its bodies with [`particles`], an engine carries out the stages of
//! the step, and a [`Simulation`] keeps the clock and chooses the step sizes.

mod cpu;
mod engine;
mod failure;
pub mod geometry;
mod lanes;
pub mod model;
pub mod neighbors;
pub mod particles;
mod report;
mod simulation;
mod step;

pub use engine::{SearchReport, Vote};
pub use failure::RunFailure;
pub use model::Model;
pub use particles::Particles;
pub use report::{
    Audit, BodyLedger, ContactLedger, Energies, HeatLedger, Ledger, StageSeconds, StepReport, VoteReason,
};
pub use simulation::Simulation;
