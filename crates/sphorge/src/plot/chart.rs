//! Line charts: panels with axes, grid and legend.

use super::{
    PlotError,
    canvas::{Anchor, Area, Canvas, FRAME, GRID, INK},
    color::{LINES, Rgb},
};
use crate::number::{scaled_unit, tick_labels, ticks};

const TEXT: f64 = 15.0;
const SMALL: f64 = 13.0;
/// Room a panel needs around its axes: left, top, bottom.
const LEFT: f64 = 74.0;
const TOP: f64 = 34.0;
const BOTTOM: f64 = 56.0;

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub(super) name: String,
    /// Points in SI; gaps where one is not finite.
    pub(super) points: Vec<(f64, f64)>,
    /// Hollow squares at the points instead of a line through them: someone else's numbers.
    pub(super) marked: bool,
}

/// Curves of one quantity over another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    /// Name and SI unit along the page.
    pub(super) along: (&'static str, &'static str),
    pub(super) quantity: String,
    pub(super) unit: String,
    pub(super) curves: Vec<Curve>,
    /// Ends of the upright axis; to fit if none. Values beyond are drawn at the end.
    pub(super) limits: Option<(f64, f64)>,
}

/// Time along the page.
pub(super) const TIME: (&str, &str) = ("time", "s");

/// Colour of the k-th curve.
fn line_color(k: usize) -> Rgb {
    LINES[k % LINES.len()]
}

/// The k-th curve; where colours come round again, dashed.
fn stroke(canvas: &mut Canvas, points: &[(f64, f64)], width: f64, k: usize, marked: bool) {
    const HALF: f64 = 4.0;
    let color = line_color(k);
    if marked {
        for (x, y) in points {
            canvas.outline(Area { x: x - HALF, y: y - HALF, width: 2.0 * HALF, height: 2.0 * HALF }, 1.5, color);
        }
    } else if k < LINES.len() {
        canvas.polyline(points, width, color);
    } else {
        canvas.dashed(points, width, color);
    }
}

impl Chart {
    /// Width of the legend; none for a single curve, which the title names.
    fn legend_width(&self) -> f64 {
        if self.curves.len() < 2 {
            return 24.0;
        }
        60.0 + self.curves.iter().map(|c| Canvas::text_width(&c.name, SMALL)).fold(0.0, f64::max)
    }

    /// Smallest and largest of the finite values.
    fn range(&self, pick: fn(&(f64, f64)) -> f64) -> Option<(f64, f64)> {
        let finite = self.curves.iter().flat_map(|c| &c.points).filter(|p| p.0.is_finite() && p.1.is_finite());
        finite.map(|p| (pick(p), pick(p))).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Whether there is a value to draw.
    pub(super) fn has_values(&self) -> bool {
        self.range(|p| p.1).is_some()
    }

    /// Draws the chart into an area of the page.
    pub(super) fn draw(&self, canvas: &mut Canvas, area: Area, legend: f64) {
        let axes = Area {
            x: area.x + LEFT,
            y: area.y + TOP,
            width: (area.width - LEFT - legend).max(40.0),
            height: (area.height - TOP - BOTTOM).max(40.0),
        };
        let (Some((t_low, t_high)), Some((low, high))) = (self.range(|p| p.0), self.range(|p| p.1)) else { return };
        let (t_low, t_high) = if t_high > t_low { (t_low, t_high) } else { (t_low, t_low + 1.0) };
        let (low, high) = self.limits.filter(|(low, high)| low < high).unwrap_or_else(|| with_room(low, high));
        let x = |t: f64| axes.x + (t - t_low) / (t_high - t_low) * axes.width;
        let y = |value: f64| axes.y + axes.height - (value.clamp(low, high) - low) / (high - low) * axes.height;

        let (scale, unit) = scaled_unit(low.abs().max(high.abs()), &self.unit);
        let up = ticks(low, high, (axes.height / 45.0) as usize);
        for (tick, label) in up.iter().zip(tick_labels(&up, scale)) {
            canvas.line((axes.x, y(*tick)), (axes.x + axes.width, y(*tick)), 1.0, GRID);
            canvas.text((axes.x - 8.0, y(*tick) + 0.36 * SMALL), SMALL, Anchor::Right, INK, &label);
        }
        let (t_scale, t_unit) = scaled_unit(t_low.abs().max(t_high.abs()), self.along.1);
        let along = ticks(t_low, t_high, (axes.width / 80.0) as usize);
        for (tick, label) in along.iter().zip(tick_labels(&along, t_scale)) {
            canvas.line((x(*tick), axes.y), (x(*tick), axes.y + axes.height), 1.0, GRID);
            canvas.text((x(*tick), axes.y + axes.height + 20.0), SMALL, Anchor::Centre, INK, &label);
        }
        let foot = (axes.x + 0.5 * axes.width, axes.y + axes.height + 42.0);
        canvas.text(foot, TEXT, Anchor::Centre, INK, &format!("{} ({t_unit})", self.along.0));
        let heading = if unit.is_empty() { self.quantity.clone() } else { format!("{} ({unit})", self.quantity) };
        canvas.text((axes.x, axes.y - 11.0), TEXT, Anchor::Left, INK, &heading);
        canvas.outline(axes, 1.0, FRAME);

        for (k, curve) in self.curves.iter().enumerate() {
            for segment in curve.points.split(|p| !(p.0.is_finite() && p.1.is_finite())) {
                let points: Vec<_> = segment.iter().map(|&(t, value)| (x(t), y(value))).collect();
                stroke(canvas, &points, 2.0, k, curve.marked);
            }
            if self.curves.len() > 1 {
                let (from, height) = (axes.x + axes.width + 14.0, axes.y + 10.0 + 22.0 * k as f64);
                let sample = [(from, height), (from + 11.0, height), (from + 22.0, height)];
                stroke(canvas, if curve.marked { &sample[1..2] } else { &sample }, 3.0, k, curve.marked);
                canvas.text((from + 30.0, height + 0.36 * SMALL), SMALL, Anchor::Left, INK, &curve.name);
            }
        }
    }
}

/// A range a little wider than the values, with zero in it where it is near, and never empty.
fn with_room(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if high - low <= 1e-9 * size || size == 0.0 {
        let half = if size == 0.0 { 1.0 } else { 0.1 * size };
        return (low - half, high + half);
    }
    let room = 0.05 * (high - low);
    let near_zero = |end: f64| end.abs() < 0.5 * (high - low);
    let low = if low >= 0.0 && near_zero(low) { 0.0 } else { low - room };
    let high = if high <= 0.0 && near_zero(high) { 0.0 } else { high + room };
    (low, high)
}

/// Draws charts in rows of `columns` and returns the page.
/// The page has `size` pixels, or as many as fit.
pub(super) fn page(
    charts: &[Chart],
    columns: usize,
    title: &str,
    size: Option<(u32, u32)>,
) -> Result<Canvas, PlotError> {
    const MARGIN: f64 = 22.0;
    const TITLE: f64 = 19.0;
    let columns = columns.clamp(1, charts.len().max(1));
    let rows = charts.len().div_ceil(columns);
    let legend = charts.iter().map(Chart::legend_width).fold(24.0, f64::max);
    let (panel_width, panel_height) =
        if columns == 1 { (720.0 + LEFT + legend, 420.0) } else { (420.0 + LEFT + legend, 330.0) };
    let width = size.map_or(2.0 * MARGIN + columns as f64 * panel_width, |size| f64::from(size.0));
    let panel_width = (width - 2.0 * MARGIN) / columns as f64;
    let lines = super::canvas::wrap(title, TITLE, width - 2.0 * MARGIN);
    let top = MARGIN + 1.3 * TITLE * lines.len() as f64 + 6.0;
    let height = size.map_or(top + rows as f64 * panel_height + 8.0, |size| f64::from(size.1));
    let panel_height = (height - top - 8.0) / rows.max(1) as f64;
    if panel_width < LEFT + legend + 80.0 || panel_height < TOP + BOTTOM + 60.0 {
        return Err(PlotError::Size { width: width as u32, height: height as u32 });
    }
    let mut canvas = Canvas::new(width.round() as u32, height.round() as u32)?;
    for (k, line) in lines.iter().enumerate() {
        canvas.text((MARGIN, MARGIN + TITLE * (0.8 + 1.3 * k as f64)), TITLE, Anchor::Left, INK, line);
    }
    for (k, chart) in charts.iter().enumerate() {
        let area = Area {
            x: MARGIN + (k % columns) as f64 * panel_width,
            y: top + (k / columns) as f64 * panel_height,
            width: panel_width,
            height: panel_height,
        };
        chart.draw(&mut canvas, area, legend);
    }
    Ok(canvas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_room_and_are_never_empty() {
        assert_eq!(with_room(0.0, 0.0), (-1.0, 1.0));
        assert_eq!(with_room(5.0, 5.0), (4.5, 5.5));
        assert_eq!(with_room(2.0, 10.0), (0.0, 10.4));
        assert_eq!(with_room(-10.0, -2.0), (-10.4, 0.0));
        assert_eq!(with_room(100.0, 120.0), (99.0, 121.0));
    }

    #[test]
    fn curves_with_gaps_or_nothing_are_drawn_without_harm() {
        let nothing =
            Chart { along: TIME, quantity: "q".into(), unit: String::new(), curves: Vec::new(), limits: None };
        let points = vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 3.0)];
        let gap = Curve { name: "a".into(), points, marked: false };
        let charts = [nothing.clone(), Chart { curves: vec![gap], ..nothing }];
        assert!(!charts[0].has_values() && charts[1].has_values());
        page(&charts, 2, "Title", None).unwrap();
        assert!(matches!(page(&charts, 2, "Title", Some((300, 300))), Err(PlotError::Size { .. })));
    }
}
