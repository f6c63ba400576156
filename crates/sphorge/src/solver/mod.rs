//! The engines and the step they share.

mod cpu;
mod engine;
mod failure;
mod report;
mod simulation;
mod step;

pub use engine::{SearchReport, Vote};
pub use failure::RunFailure;
pub use report::{
    Audit, BodyLedger, ContactLedger, Energies, HeatLedger, Ledger, StageSeconds, StepReport, VoteReason,
};
pub use simulation::Simulation;
