//! Time of a reversal; the definition is in [`super`].

use crate::engine::persist_fields;

/// A velocity over time, until it changes sign.
#[derive(Clone, Debug, Default)]
pub(super) struct Reversal {
    last: Option<(f64, f64)>,
    time: Option<f64>,
}

impl Reversal {
    pub(super) fn sample(&mut self, t: f64, v: f64) {
        if self.time.is_some() || v == 0.0 {
            // Zero has no sign: the line from the last sample to the next one runs through it.
            return;
        }
        if let Some((t0, v0)) = self.last
            && v0.signum() != v.signum()
        {
            self.time = Some(t0 + (t - t0) * v0 / (v0 - v));
        }
        self.last = Some((t, v));
    }

    pub(super) fn time(&self) -> Option<f64> {
        self.time
    }
}

persist_fields!(Reversal { last, time });
