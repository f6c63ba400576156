//! Which particles a picture shows.

use super::{FieldPicture, PlotError};
use crate::{
    deck::{did_you_mean, names_like},
    output::FrameFile,
};

/// A condition on a field: a picture shows the particles that meet it.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Field, or a component as in `stress.xy`; of a vector or tensor the norm.
    pub field: String,
    /// Whether its value is to be above the bound, else below.
    pub is_above: bool,
    /// Bound, SI.
    pub bound: f64,
}

impl Condition {
    fn holds(&self, value: f64) -> bool {
        if self.is_above { value > self.bound } else { value < self.bound }
    }
}

/// Whether each particle of a frame is to be shown; `values` reads a field of the frame. None where all are.
pub(super) fn kept(
    frame: &mut FrameFile,
    picture: &FieldPicture,
    mut values: impl FnMut(&mut FrameFile, &str) -> Result<Vec<f64>, PlotError>,
) -> Result<Option<Vec<bool>>, PlotError> {
    if picture.bodies.is_empty() && picture.conditions.is_empty() {
        return Ok(None);
    }
    let mut kept = vec![true; frame.count];
    if !picture.bodies.is_empty() {
        let chosen = picture.bodies.iter().map(|name| body_number(frame, name)).collect::<Result<Vec<_>, _>>()?;
        let column = frame.column("body")?;
        let of = |i: usize| column.as_ref().map_or(0, |column| column.values[i] as usize);
        kept.iter_mut().enumerate().for_each(|(i, kept)| *kept = chosen.contains(&of(i)));
    }
    for condition in &picture.conditions {
        let values = values(frame, &condition.field)?;
        kept.iter_mut().zip(values).for_each(|(kept, value)| *kept &= condition.holds(value));
    }
    Ok(Some(kept))
}

/// The number of a body in a frame.
pub(crate) fn body_number(frame: &FrameFile, name: &str) -> Result<usize, PlotError> {
    let names = || frame.bodies.iter().map(|body| body.name.as_str());
    names().position(|known| known == name).ok_or_else(|| PlotError::Body {
        name: name.to_owned(),
        near: did_you_mean(names_like(name, names())),
        available: names().collect::<Vec<_>>().join(", "),
    })
}
