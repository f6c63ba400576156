//! The kernels of the step: each gathers what a law needs, calls it, and stores what it gives.

pub(super) mod grid;
pub(super) mod limits;
pub(super) mod motion;
pub(super) mod pairs;
pub(super) mod stress;
pub(super) mod walls;
