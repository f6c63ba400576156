//! What every engine can do: the stages of a step, and a view of the particles.

use super::{Audit, RunFailure, VoteReason};
use crate::Particles;

/// Proposal for the next time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vote {
    /// Largest stable step, s.
    pub dt: f64,
    /// The rule that set it.
    pub reason: VoteReason,
}

/// Share of the work a search did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SearchReport {
    /// Share of the particles searched in this step.
    pub searched_fraction: f64,
}

/// An engine owns the particle columns and carries out the stages; [`super::step::advance`] puts them in order.
pub(super) trait Engine: Send {
    /// Opens a step of size `dt`: boundary motion, prediction or kick and drift.
    fn begin(&mut self, dt: f64);
    /// Makes neighbour lists valid for the positions just reached.
    fn refresh_neighbors(&mut self) -> SearchReport;
    /// Comparison of the lists with an exact search, if one is due.
    fn audit(&mut self) -> Option<Audit>;
    /// Velocity gradient and density.
    fn kinematics(&mut self);
    /// Trial stress, equation of state, return mapping, temperature.
    fn stress(&mut self);
    /// Momentum, energy, viscosity, artificial stress, XSPH, walls, gravity.
    fn forces(&mut self);
    /// Closes the step: correction or second kick.
    fn finish(&mut self);
    /// Every value finite, every density positive.
    fn guard(&self) -> Result<(), RunFailure>;
    /// Largest stable next step.
    fn vote(&self) -> Vote;
    /// Ordered pairs inside the kernel support at the last kinematics stage.
    fn pairs(&self) -> u64;

    /// The particles; a device engine copies them here first.
    fn particles(&self) -> &Particles;
    /// Conservation sums.
    fn ledger(&self) -> super::Ledger;
    /// Bytes held by columns, lists and scratch.
    fn memory_bytes(&self) -> u64;
}
