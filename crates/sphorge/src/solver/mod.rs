//! The engines and the step they share.

mod report;

pub use report::{BodyLedger, Energies, Ledger, StageSeconds, StepReport, VoteReason};
