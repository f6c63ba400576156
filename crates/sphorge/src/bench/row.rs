//! One measurement, as reported.

use super::{KernelRow, StageShares};
use serde::Serialize;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BenchRow {
    /// Name of the deck.
    pub case: String,
    /// `mixed` or `double`.
    pub precision: String,
    /// Search strategy.
    pub search: String,
    /// Number of particles.
    pub particles: usize,
    /// Neighbours a particle has on average.
    pub mean_neighbors: f64,
    /// Steps measured.
    pub steps: u64,
    /// Wall-clock seconds they took.
    pub wall_seconds: f64,
    /// Particle-steps per second and core.
    pub particle_steps_per_second_per_core: f64,
    /// Ordered pairs per second and core over those of the bare loop; none without the loop or in plane strain.
    pub share_of_bare_loop: Option<f64>,
    /// Ordered pairs per second and core.
    pub pairs_per_second_per_core: f64,
    /// Share of the particles whose neighbour lists were rebuilt, mean over the steps.
    pub searched_fraction: f64,
    /// Share of the time by stage.
    pub stage_shares: StageShares,
    /// Bytes of columns, lists and scratch for one particle.
    pub bytes_per_particle: f64,
    /// Name of the device that computed, where that is not the processor; rates are of the whole of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<String>,
    /// Kernels of the device, the longest first, where they were timed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub kernels: Vec<KernelRow>,
}
