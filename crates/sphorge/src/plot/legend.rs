//! Names of curves beside or below their chart.

use super::{
    font::{text_width, wrap},
    page::Area,
};

/// Length of the sample before a name, with the gap behind it.
pub(super) const SAMPLE: f64 = 30.0;
/// From line to line.
const LINE: f64 = 20.0;
const BETWEEN: f64 = 18.0;

/// Where a name is: the middle of the first line of its sample, and its lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) lines: Vec<String>,
}

/// Room for names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Legend {
    /// From the corner of the legend.
    pub(super) entries: Vec<Entry>,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Legend {
    /// Names one below the other.
    pub(super) fn column(names: &[&str], size: f64) -> Self {
        let width = names.iter().map(|name| text_width(name, size)).fold(0.0, f64::max);
        Self::flow(names, size, SAMPLE + width + 1.0)
    }

    /// Names beside each other as far as they go in `width`, then below.
    pub(super) fn flow(names: &[&str], size: f64, width: f64) -> Self {
        let (mut x, mut y, mut next) = (0.0, 0.0, 0.0f64);
        let mut entries = Vec::new();
        for name in names {
            let lines = wrap(name, size, (width - SAMPLE).max(size));
            let own = SAMPLE + lines.iter().map(|line| text_width(line, size)).fold(0.0, f64::max);
            if x > 0.0 && x + own > width {
                (x, y) = (0.0, next);
            }
            next = next.max(y + LINE * lines.len().max(1) as f64);
            entries.push(Entry { x, y: y + 0.5 * LINE, lines });
            x += own + BETWEEN;
        }
        Self { entries, width, height: next }
    }

    /// Where line `k` of an entry has its baseline, on a page.
    pub(super) fn baseline(at: Area, entry: &Entry, k: usize, size: f64) -> (f64, f64) {
        (at.x + entry.x + SAMPLE, at.y + entry.y + LINE * k as f64 + 0.36 * size)
    }
}
