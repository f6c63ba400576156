//! Initial velocities that vary in space.

use super::{check_axis, vector, wrong_length};
use crate::raw::{RawVelocityGradient, RawVelocityProfile};
use crate::report::{Fault, Problems};
use sphorge_engine::model::{Dimensions, VelocityProfile};
use std::ops::Range;

/// Gradient and centre of an initial velocity linear in space; `at` marks the body.
pub(crate) fn gradient(
    raw: &RawVelocityGradient,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<([[f64; 3]; 3], [f64; 3])> {
    let centre = raw.centre.as_ref().map_or(Some([0.0; 3]), |c| vector(c, dimensions, problems));
    if raw.rows.len() != dimensions.count() {
        problems.push(wrong_length(dimensions, raw.rows.len(), at, "[\"0 /s\", \"1000 /s\"]"));
        return None;
    }
    let rows: Vec<_> = raw.rows.iter().map(|row| vector(row, dimensions, problems)).collect();
    let mut gradient = [[0.0; 3]; 3];
    for (k, row) in rows.into_iter().enumerate() {
        gradient[k] = row?;
    }
    Some((gradient, centre?))
}

/// An initial velocity by a table along an axis; `at` marks the body.
pub(crate) fn profile(
    raw: &RawVelocityProfile,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<VelocityProfile> {
    let along = raw.along.get(problems).and_then(|axis| check_axis(axis, raw.along.span(), dimensions, problems));
    let amplitude = vector(&raw.amplitude, dimensions, problems);
    if raw.rows.is_empty() {
        problems.push(Fault::new("empty-table", "the velocity profile has no rows", at, "empty"));
        return None;
    }
    let mut rows: Vec<(f64, f64)> = Vec::with_capacity(raw.rows.len());
    let mut sound = true;
    for (place, share) in &raw.rows {
        let (Some(x), Some(s)) = (place.si(problems), share.si(problems)) else {
            sound = false;
            continue;
        };
        if sound && rows.last().is_some_and(|&(before, _)| x <= before) {
            let message = "the places of a velocity profile must increase";
            problems.push(Fault::new("place-order", message, place.span(), "not beyond the row before"));
            sound = false;
        }
        rows.push((x, s));
    }
    sound.then_some(VelocityProfile { along: along?, amplitude: amplitude?, rows })
}
