//! The kernels of the step: each gathers the input of a law, calls it, and stores its result.

pub(super) mod audit;
pub(super) mod conduction;
pub(super) mod contact;
pub(super) mod facets;
pub(super) mod grid;
pub(super) mod images;
pub(super) mod kept;
mod kick;
pub(super) mod leapfrog;
pub(super) mod ledger;
pub(super) mod limits;
mod motion;
pub(super) mod moving_least_squares;
mod neighbors;
pub(super) mod pairs;
pub(super) mod predictor_corrector;
pub(super) mod quantities;
pub(super) mod reduce;
pub(super) mod reductions;
pub(super) mod reference;
pub(super) mod reference_forces;
pub(super) mod section;
pub(super) mod smoothing;
pub(super) mod stress;
pub(super) mod sums;
pub(super) mod walls;
pub(super) mod wrap;
