//! Period of an oscillation; the definition is in [`super`].
//!
//! The time of a noisy crossing is the mean of the first and last crossing on the way, each on the straight line between
//! two samples.

use crate::engine::persist_fields;

/// A signal over time.
#[derive(Clone, Debug, Default)]
pub(super) struct Period {
    samples: Vec<(f64, f64)>,
}

/// Deviation that counts, as a share of the root mean square.
const HYSTERESIS: f64 = 0.2;

impl Period {
    pub(super) fn sample(&mut self, time: f64, value: f64) {
        self.samples.push((time, value));
    }

    pub(super) fn period(&self) -> Option<f64> {
        let crossings = self.upward_crossings();
        let (first, last) = (crossings.first()?, crossings.last()?);
        (crossings.len() > 1).then(|| (last - first) / (crossings.len() - 1) as f64)
    }

    fn upward_crossings(&self) -> Vec<f64> {
        let n = self.samples.len() as f64;
        let middle = self.samples.iter().map(|s| s.1).sum::<f64>() / n;
        let threshold = HYSTERESIS * (self.samples.iter().map(|s| (s.1 - middle).powi(2)).sum::<f64>() / n).sqrt();
        let mut crossings = Vec::new();
        let mut was_below = false;
        // First and last crossing since the signal was last clearly below.
        let mut on_the_way: Option<(f64, f64)> = None;
        for pair in self.samples.windows(2) {
            let [(t0, f0), (t1, f1)] = [pair[0], pair[1]].map(|(t, f)| (t, f - middle));
            if f0 <= -threshold {
                was_below = true;
                on_the_way = None;
            }
            if f0 < 0.0 && f1 >= 0.0 {
                let t = t0 + (t1 - t0) * f0 / (f0 - f1);
                on_the_way = Some((on_the_way.map_or(t, |w| w.0), t));
            }
            if was_below
                && f1 >= threshold
                && let Some((first, last)) = on_the_way.take()
            {
                crossings.push(0.5 * (first + last));
                was_below = false;
            }
        }
        crossings
    }
}

persist_fields!(Period { samples });

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sampled(signal: impl Fn(f64) -> f64) -> Option<f64> {
        let mut period = Period::default();
        for k in 0..=1000 {
            let t = 0.01 * f64::from(k);
            period.sample(t, signal(t));
        }
        period.period()
    }

    /// Pseudo-random in -1..1.
    fn noise(t: f64) -> f64 {
        ((t * 12_345.678).sin() * 43_758.545).fract()
    }

    #[test]
    fn a_sine_with_offset_over_broken_cycles_gives_its_period() {
        let period = sampled(|t| 5.0 + 0.3 * (TAU * (t - 0.4) / 1.7).sin()).unwrap();
        assert!((period - 1.7).abs() < 1e-3, "{period}");
    }

    #[test]
    fn noise_at_the_crossings_is_not_counted() {
        let period = sampled(|t| (TAU * t / 1.7).sin() + 0.1 * noise(t)).unwrap();
        assert!((period - 1.7).abs() < 0.02, "{period}");
    }

    #[test]
    fn less_than_two_crossings_give_none() {
        assert_eq!(sampled(|t| (TAU * t / 12.0).sin()), None);
        assert_eq!(sampled(|_| 1.0), None);
        assert_eq!(Period::default().period(), None);
    }
}
