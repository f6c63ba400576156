//! Initial velocities that vary in space.

use super::{check_axis, described, vector, wrong_length};
use crate::fault::{Fault, Problems};
use crate::raw::{RawRadialVelocity, RawVelocityGradient, RawVelocityProfile};
use crate::value::{Given, Kind, Length};
use sphorge_engine::model::{Dimensions, RadialVelocity, VelocityProfile};
use sphorge_physics::parameter::Bound;
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
        problems.push(wrong_length(
            dimensions,
            Some("velocity-gradient.rows"),
            raw.rows.len(),
            at,
            "[\"0 /s\", \"1000 /s\"]",
        ));
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
    let rows = table(&raw.rows, "velocity profile", at, problems, |place, problems| place.si(problems));
    Some(VelocityProfile { along: along?, amplitude: amplitude?, rows: rows? })
}

/// An initial velocity away from a centre or a line; `at` marks the body.
pub(crate) fn radial(
    raw: &RawRadialVelocity,
    dimensions: Dimensions,
    at: Range<usize>,
    problems: &mut Problems,
) -> Option<RadialVelocity> {
    let centre = raw.centre.as_ref().map_or(Some([0.0; 3]), |c| vector(c, dimensions, problems));
    let axis = match (&raw.axis, dimensions) {
        (None, _) => Some(None),
        (Some(word), Dimensions::Three) => word.get(problems).map(Some),
        // Away from a point of the plane is away from a line across it.
        (Some(word), _) => match (word.get(problems), dimensions) {
            (Some(2), Dimensions::PlaneStrain) => Some(None),
            (Some(_), _) => {
                let message = format!("{}: a line across the radius has no axis to choose", described(dimensions));
                let fault = Fault::new("wrong-dimensions", message, word.span(), "this axis");
                problems.push(fault.help("leave `axis` out"));
                None
            }
            (None, _) => None,
        },
    };
    let radius = |radius: &Given<Length>, problems: &mut Problems| radius.within(Bound::NonNegative, problems);
    let rows = table(&raw.rows, "radial velocity", at, problems, radius);
    Some(RadialVelocity { centre: centre?, axis: axis?, rows: rows? })
}

/// Rows of place, as `read`, and value; places increase.
fn table<V: Kind>(
    raw: &[(Given<Length>, Given<V>)],
    what: &str,
    at: Range<usize>,
    problems: &mut Problems,
    read: impl Fn(&Given<Length>, &mut Problems) -> Option<f64>,
) -> Option<Vec<(f64, f64)>> {
    if raw.is_empty() {
        problems.push(Fault::new("empty-table", format!("the {what} has no rows"), at, "empty"));
        return None;
    }
    let mut rows: Vec<(f64, f64)> = Vec::with_capacity(raw.len());
    let mut sound = true;
    for (place, value) in raw {
        let (Some(x), Some(v)) = (read(place, problems), value.si(problems)) else {
            sound = false;
            continue;
        };
        if sound && rows.last().is_some_and(|&(before, _)| x <= before) {
            let message = format!("the coordinates of a {what} must increase");
            problems.push(Fault::new("place-order", message, place.span(), "not beyond the row before"));
            sound = false;
        }
        rows.push((x, v));
    }
    sound.then_some(rows)
}
