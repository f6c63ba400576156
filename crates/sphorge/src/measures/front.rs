//! Speed of a front; the definition is in [`super`].

use crate::engine::persist_fields;

/// Position of a front over time.
#[derive(Clone, Debug)]
pub(super) struct FrontSpeed {
    level: f64,
    window: (f64, f64),
    /// Whether the material ahead is above the level.
    ahead_is_above: Option<bool>,
    has_left: bool,
    samples: Vec<(f64, f64)>,
}

impl FrontSpeed {
    pub(super) fn new(level: f64, window: (f64, f64)) -> Self {
        Self { level, window, ahead_is_above: None, has_left: false, samples: Vec::new() }
    }

    /// Takes the means of slabs in the order of the front's path: coordinate and field of each, one after the other.
    pub(super) fn sample(&mut self, time: f64, slabs: &[f64]) {
        let (slabs, _) = slabs.as_chunks::<2>();
        let Some(end) = slabs.last() else { return };
        let above = |[_, field]: &[f64; 2]| *field >= self.level;
        let ahead = *self.ahead_is_above.get_or_insert(above(end));
        self.has_left |= above(end) != ahead;
        if self.has_left || !(self.window.0..=self.window.1).contains(&time) {
            return;
        }
        let crossing = slabs.windows(2).rev().find(|pair| above(&pair[0]) != ahead);
        if let Some([behind, before]) = crossing {
            let share = (self.level - behind[1]) / (before[1] - behind[1]);
            self.samples.push((time, behind[0] + share * (before[0] - behind[0])));
        }
    }

    /// Slope of the least-squares line.
    pub(super) fn speed(&self) -> Option<f64> {
        let n = self.samples.len() as f64;
        let mean = |pick: fn(&(f64, f64)) -> f64| self.samples.iter().map(pick).sum::<f64>() / n;
        let (t_mean, x_mean) = (mean(|s| s.0), mean(|s| s.1));
        let (tx, tt) = self
            .samples
            .iter()
            .fold((0.0, 0.0), |(tx, tt), (t, x)| (tx + (t - t_mean) * (x - x_mean), tt + (t - t_mean).powi(2)));
        (tt > 0.0).then(|| tx / tt)
    }
}

// Level and window are those of the model.
persist_fields!(FrontSpeed { ahead_is_above, has_left, samples });
