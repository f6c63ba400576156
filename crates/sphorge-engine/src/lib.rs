//! The model of a problem, the particles it becomes, and the engines that take them through time.
//!
//! [`model`] is the problem in SI units, [`geometry`] fills its bodies with [`particles`], an [`Engine`] carries out the stages of
//! the step, and a [`Simulation`] keeps the clock and chooses the step sizes.

mod approach;
mod box_tree;
mod contact_laws;
mod cpu;
mod drive;
mod engine;
mod facet_laws;
mod failure;
pub mod geometry;
pub mod halo;
mod heat_clock;
mod lanes;
pub mod model;
pub mod neighbors;
pub mod particles;
pub mod persist;
pub mod ranks;
pub mod reduction;
mod report;
mod simulation;
mod step;

pub use contact_laws::ContactLaws;
pub use cpu::{
    AuditedRow, ConductionTable, ContactCandidates, Cpu, FaceConfiguration, FaceNeighbor, FaceTerm, FaceTerms,
    SearchedMaterial, audit_of, check_values, complete_initial_state, face_terms, heat_of_released, largest_change,
};
pub use drive::Drive;
pub use engine::{Engine, EngineKind, InPieces, Part, PartKind, SearchReport, TimeStepLimit, Unsupported};
pub use facet_laws::{COINCIDENCE, FacetLaws};
pub use failure::RunFailure;
pub use heat_clock::HeatClock;
pub use model::Model;
pub use particles::{Column, Particles};
pub use reduction::{FieldSource, ParticleSource, Quantity, Reduction};
pub use report::{
    Audit, BodyLedger, ContactLedger, Energies, HeatLedger, Ledger, LimitReason, StageSeconds, StepReport, WallLedger,
};
pub use simulation::Simulation;
pub use step::{Advance, advance};

/// The engines of this crate; the first is the default.
pub const ENGINES: &[&dyn EngineKind] = &[&Cpu];
