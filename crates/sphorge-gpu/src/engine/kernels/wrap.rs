//! Particles that have left a periodic cell come in again at its other end.

use super::images::split;
use crate::engine::columns::{Fields, Group, Recording, added, recording};
use crate::record::{KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;

/// Before a search: lists and images are those of places within the cell. No particle goes farther than it is long from one to the next.
pub(in crate::engine) fn wrap(model: &Model, count: usize) -> Result<Option<Recording>, KernelFault> {
    if model.periodic.iter().all(Option::is_none) {
        return Ok(None);
    }
    let kernel = recording("wrap", count, |bind, i| {
        let place = bind.write(Group::Place);
        let zero = Recorded::zero();
        for (axis, (low, high)) in model.periodic.iter().enumerate().filter_map(|(a, of)| of.map(|of| (a, of))) {
            let at = place.double(axis, 3 + axis, i);
            let from = |end: f64| {
                let [end, rest] = split(end);
                (at[0] - end) + (at[1] - rest)
            };
            let period = split(high - low);
            let moved = |sign: f64| {
                let [length, rest] = period.map(|part| part * Recorded::of(sign));
                added(added(at, length), rest)
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            for (k, field) in [axis, 3 + axis].into_iter().enumerate() {
                let inside = Recorded::select_lt(from(low), zero, up[k], at[k]);
                place.set(field, i, Recorded::select_lt(from(high), zero, inside, down[k]));
            }
        }
    })?;
    Ok(Some(kernel))
}
