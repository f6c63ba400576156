//! Numbers along an axis: round places, labels that tell them apart and never run into each other.

use super::font::widest;
use crate::number::{scaled_unit, tick_labels, ticks};

/// Most digits of a label; beyond, labels say how far a value is from a round one.
const MOST_DIGITS: usize = 6;
/// Least distance of labels beside each other, in their size.
const APART: f64 = 1.0;

/// A range with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AxisScale {
    pub(super) low: f64,
    pub(super) high: f64,
    /// SI.
    pub(super) ticks: Vec<f64>,
    pub(super) labels: Vec<String>,
    /// Unit of the labels.
    pub(super) unit: String,
    /// The value, with its unit, that labels count from.
    pub(super) origin: Option<String>,
    /// Divisor of SI values.
    pub(super) scale: f64,
}

impl AxisScale {
    /// A range of an SI `unit` with at most so many steps.
    pub(super) fn new((low, high): (f64, f64), unit: &str, most: usize) -> Self {
        let (scale, text) = scaled_unit(low.abs().max(high.abs()), unit);
        let places = ticks(low, high, most);
        let labels = tick_labels(&places, scale);
        let digits =
            |label: &String| label.trim_start_matches(['−', '0', '.']).chars().filter(char::is_ascii_digit).count();
        let long = labels.iter().map(digits).max().unwrap_or(0) > MOST_DIGITS;
        let plain = Self { low, high, ticks: places, labels, unit: text.clone(), origin: None, scale };
        if !long || high <= low {
            return plain;
        }
        // A power of ten not below the range divides by any round step, so that ticks stay round from there.
        let grain = 10f64.powi((high - low).log10().ceil() as i32);
        let origin = (0.5 * (low + high) / grain).round() * grain;
        let (from, to) = (low - origin, high - origin);
        let (fine, fine_text) = scaled_unit(from.abs().max(to.abs()), unit);
        let decimals = (scale / grain).log10().ceil().max(0.0) as usize;
        let number = format!("{:.decimals$}", origin / scale).replace('-', "−");
        let steps = ticks(from, to, most);
        Self {
            labels: tick_labels(&steps, fine),
            ticks: steps.iter().map(|step| origin + step).collect(),
            unit: fine_text,
            origin: Some(if text.starts_with("10") {
                format!("{number} × {text}")
            } else {
                format!("{number} {text}").trim_end().to_owned()
            }),
            ..plain
        }
    }

    /// A range along `length` of the page, upwards, with as many labels of a `size` above each other as keep apart.
    pub(super) fn upright(range: (f64, f64), unit: &str, length: f64, size: f64) -> Self {
        Self::fitting(range, unit, length, 45.0, |_| 1.3 * size)
    }

    /// A range along `length` of the page, with as many labels of a `size` beside each other as keep apart.
    pub(super) fn level(range: (f64, f64), unit: &str, length: f64, size: f64) -> Self {
        Self::fitting(range, unit, length, 60.0, |labels| widest(labels, size) + APART * size)
    }

    /// About a label every `rough`, and no two nearer than `need` says of the labels.
    fn fitting(range: (f64, f64), unit: &str, length: f64, rough: f64, need: impl Fn(&[String]) -> f64) -> Self {
        let most = (length / rough).clamp(2.0, 14.0) as usize;
        let keeps_apart = |scale: &Self| {
            let step = scale.ticks.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
            need(&scale.labels) <= step / (scale.high - scale.low) * length
        };
        let of = |most: usize| Some(Self::new(range, unit, most)).filter(keeps_apart);
        // One number alone says little: rather two that are nearer.
        let dense = || (most + 1..=most + 4).filter_map(of).find(|scale| scale.ticks.len() > 1);
        let sparse = (2..=most).rev().find_map(of);
        sparse.filter(|scale| scale.ticks.len() > 1).or_else(dense).unwrap_or_else(|| {
            // Where the coarsest ticks are too near, the outermost may not be; or else one stands alone.
            let mut scale = Self::new(range, unit, 2);
            if scale.ticks.len() > 2 {
                scale.ticks.drain(1..scale.ticks.len() - 1);
                scale.labels.drain(1..scale.labels.len() - 1);
            }
            if !keeps_apart(&scale) {
                scale.ticks.truncate(1);
                scale.labels.truncate(1);
            }
            scale
        })
    }

    /// What a quantity is called beside the axis: with its unit, and what labels count from.
    pub(super) fn title(&self, quantity: &str) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        match &self.origin {
            Some(origin) => format!("{quantity}, from {origin}{unit}"),
            None => format!("{quantity}{unit}"),
        }
    }

    /// Share of the axis before a value; beyond its ends, the end.
    pub(super) fn share(&self, value: f64) -> f64 {
        (value.clamp(self.low, self.high) - self.low) / (self.high - self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_close_together_are_counted_from_a_round_one() {
        let axis = AxisScale::new((-1_323_746.112, -1_323_746.108), "J", 4);
        assert_eq!(axis.title("energy"), "energy, from −1.32374611 MJ (mJ)");
        assert_eq!(axis.labels, ["−2", "−1", "0", "1", "2"]);
        for (tick, millis) in axis.ticks.iter().zip([-2.0, -1.0, 0.0, 1.0, 2.0]) {
            assert!((tick - (-1_323_746.11 + 1e-3 * millis)).abs() < 1e-9, "{tick}");
        }
        let axis = AxisScale::new((-1_400_000.0, -1_300_000.0), "J", 5);
        assert_eq!((axis.title("energy"), axis.labels[0].as_str()), ("energy (MJ)".to_owned(), "−1.40"));
        assert_eq!(AxisScale::new((0.0, 2.0), "", 2).title("strain"), "strain");
    }

    #[test]
    fn labels_beside_each_other_keep_apart() {
        for range in [(0.0, 9e-5), (-1e4, 1e4), (0.123_456, 0.123_457), (1e-12, 2e-12)] {
            for length in [30.0, 60.0, 120.0, 400.0, 1200.0] {
                let axis = AxisScale::level(range, "kg", length, 13.0);
                let place = |k: usize| axis.share(axis.ticks[k]) * length;
                let half = |k: usize| 0.5 * widest([&axis.labels[k]], 13.0);
                for k in 1..axis.ticks.len() {
                    assert!(place(k) - half(k) > place(k - 1) + half(k - 1), "{range:?} {length} {:?}", axis.labels);
                }
                let upright = AxisScale::upright(range, "kg", length, 13.0);
                let places: Vec<_> = upright.ticks.iter().map(|tick| upright.share(*tick) * length).collect();
                assert!(places.windows(2).all(|pair| pair[1] - pair[0] > 13.0), "{range:?} {length} {places:?}");
                assert!(length < 100.0 || axis.ticks.len() >= 2, "{range:?} {length} {:?}", axis.labels);
            }
        }
    }
}
