//! Smoothing lengths that follow the density.

use crate::engine::columns::{ReadColumns, Recording, WriteColumns, groups, recording};
use crate::record::KernelFault;
use sphorge_engine::model::{Model, SmoothingLength};
use sphorge_physics::kernel::following_smoothing_length;

/// Largest ratio of smoothing lengths to the initial ones.
pub(in crate::engine) fn largest_factor(model: &Model) -> f64 {
    match model.numerics.smoothing_length {
        SmoothingLength::Constant => 1.0,
        SmoothingLength::FollowDensity { factor } => factor,
    }
}

/// Updates them to the current density before a search. They are constant during the step, so that both of its sums see
/// the same kernels.
pub(in crate::engine) fn follow(model: &Model, count: usize) -> Result<Option<Recording>, KernelFault> {
    let SmoothingLength::FollowDensity { factor } = model.numerics.smoothing_length else { return Ok(None) };
    let kernel = recording("follow_density", count, |bind, i| {
        let (constants, density) = (groups::Constants::write(bind), groups::Density::read(bind).density);
        // From the mass and its volume at rest.
        let at_rest = constants.mass.get(i) / constants.volume_at_rest.get(i);
        let at_start = constants.initial_smoothing_length.get(i);
        let now = following_smoothing_length(model.dimensions.into(), at_start, at_rest, density.high().get(i), factor);
        constants.smoothing_length.set(i, now);
    })?;
    Ok(Some(kernel))
}
