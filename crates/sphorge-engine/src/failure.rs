//! A run that went wrong.

use std::fmt;

/// The field of a failure that is the engine's, not a particle's.
const ENGINE: &str = "engine";

/// Why a run cannot go on, with the particle, the step and the field.
#[derive(Clone, Debug, PartialEq)]
pub struct RunFailure {
    /// Step that failed.
    pub step: u64,
    /// Time at the start of that step, s.
    pub time: f64,
    /// Field that went wrong.
    pub field: &'static str,
    /// Stable id of the first such particle.
    pub particle: Option<u32>,
    /// Its body.
    pub body: Option<u32>,
    /// Its last finite position, m: that of the step before, or of the start, where the position itself went wrong.
    pub position: Option<[f64; 3]>,
    /// What was wrong and what may help.
    pub message: String,
    /// Whether a smaller step may go well.
    pub step_may_be_smaller: bool,
}

impl fmt::Display for RunFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // What ends an engine before its first step, such as a device that is not there, has no step.
        if self.step > 0 || self.field != ENGINE {
            write!(f, "step {} at {:.6e} s: ", self.step, self.time)?;
        }
        write!(f, "{}", self.message)?;
        if let Some(particle) = self.particle {
            write!(f, " (field `{}`, particle {particle}", self.field)?;
            if let Some([x, y, z]) = self.position {
                write!(f, " at ({x:.6e}, {y:.6e}, {z:.6e}) m")?;
            }
            write!(f, ")")?;
        }
        Ok(())
    }
}

impl std::error::Error for RunFailure {}

impl RunFailure {
    /// A failure of the engine rather than of a particle.
    pub fn of_engine(message: String) -> Self {
        let step_may_be_smaller = false;
        Self {
            step: 0,
            time: 0.0,
            field: ENGINE,
            particle: None,
            body: None,
            position: None,
            message,
            step_may_be_smaller,
        }
    }
}
