//! Line charts: panels with axes, grid and legend. Margins follow the labels.

use super::{
    PlotError,
    axis::AxisScale,
    color::LINES,
    font::{ASCENT, LEADING, text_width, widest, wrap},
    legend::{Legend, SAMPLE},
    page::{Anchor, Area, FRAME, GRID, MARGIN, Page, SMALL, TEXT},
    paper::Paper,
    walls::PlacedWall,
};

/// Between an axis and its labels.
const GAP: f64 = 8.0;
/// Below the axes: labels and the name of the axis.
const FOOT: f64 = 52.0;
/// Share of a chart that names of curves take beside it, at most; longer ones go below.
const BESIDE: f64 = 0.3;

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
    pub(super) along: (String, String),
    pub(super) quantity: String,
    pub(super) unit: String,
    pub(super) curves: Vec<Curve>,
    /// Ends of the upright axis; to fit if none. Values beyond are drawn at the end.
    pub(super) limits: Option<(f64, f64)>,
    /// Walls across the axis along the page.
    pub(super) walls: Vec<PlacedWall>,
}

/// Time along the page.
pub(super) fn time() -> (String, String) {
    ("time".to_owned(), "s".to_owned())
}

/// The k-th curve; where colours come round again, dashed.
fn stroke(page: &mut Page, points: Vec<(f64, f64)>, width: f64, k: usize, marked: bool) {
    const HALF: f64 = 4.0;
    let color = LINES[k % LINES.len()];
    if marked {
        for (x, y) in points {
            page.outline(Area { x: x - HALF, y: y - HALF, width: 2.0 * HALF, height: 2.0 * HALF }, 1.5, color);
        }
    } else if k < LINES.len() {
        page.polyline(points, width, color);
    } else {
        page.dashed(points, width, color);
    }
}

impl Chart {
    fn names(&self) -> Vec<&str> {
        // The title names a single curve.
        if self.curves.len() < 2 { Vec::new() } else { self.curves.iter().map(|curve| curve.name.as_str()).collect() }
    }

    /// Smallest and largest of the finite values.
    fn range(&self, pick: fn(&(f64, f64)) -> f64) -> Option<(f64, f64)> {
        let finite = self.curves.iter().flat_map(|c| &c.points).filter(|p| p.0.is_finite() && p.1.is_finite());
        finite.map(|p| (pick(p), pick(p))).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Ends of the axis along the page; none without a value.
    fn ends(&self) -> Option<(f64, f64)> {
        let (low, high) = self
            .walls
            .iter()
            .filter_map(PlacedWall::across)
            .fold(self.range(|p| p.0)?, |(low, high), x| (low.min(x), high.max(x)));
        Some((low, if high > low { high } else { low + 1.0 }))
    }

    /// Whether there is a value to draw.
    pub(super) fn has_values(&self) -> bool {
        self.range(|p| p.1).is_some()
    }

    /// The upright axis over a height; none without a value.
    fn upright(&self, height: f64) -> Option<AxisScale> {
        let (low, high) = self.range(|p| p.1)?;
        let (low, high) = self.limits.filter(|(low, high)| low < high).unwrap_or_else(|| with_room(low, high));
        Some(AxisScale::upright((low, high), &self.unit, height, SMALL))
    }

    /// Draws the chart into an area of the page.
    fn draw(&self, page: &mut Page, area: Area, plan: &Plan) {
        let (Some(ends), Some(up)) = (self.ends(), self.upright(plan.height)) else { return };
        let heading = wrap(&up.title(&self.quantity), TEXT, area.width);
        let axes = Area {
            x: area.x + plan.left,
            y: area.y + plan.top,
            width: area.width - plan.left - plan.right,
            height: plan.height,
        };
        for (k, line) in heading.iter().enumerate() {
            let lines_below = (heading.len() - 1 - k) as f64;
            page.text((area.x, axes.y - 11.0 - LEADING * TEXT * lines_below), TEXT, Anchor::Left, line);
        }
        let along = AxisScale::level(ends, &self.along.1, axes.width, SMALL);
        let x = |t: f64| axes.x + along.share(t) * axes.width;
        let y = |value: f64| axes.bottom() - up.share(value) * axes.height;
        for (tick, label) in up.ticks.iter().zip(&up.labels) {
            page.line((axes.x, y(*tick)), (axes.right(), y(*tick)), 1.0, GRID);
            page.text((axes.x - GAP, y(*tick) + 0.36 * SMALL), SMALL, Anchor::Right, label);
        }
        for (tick, label) in along.ticks.iter().zip(&along.labels) {
            page.line((x(*tick), axes.y), (x(*tick), axes.bottom()), 1.0, GRID);
            page.text((x(*tick), axes.bottom() + 20.0), SMALL, Anchor::Centre, label);
        }
        let (name, size) = (along.title(&self.along.0), TEXT);
        let half = 0.5 * text_width(&name, size);
        let middle = (axes.x + 0.5 * axes.width).min(area.right() - half).max(area.x + half);
        page.text((middle, axes.bottom() + 42.0), size, Anchor::Centre, &name);
        page.outline(axes, 1.0, FRAME);
        for wall in &self.walls {
            wall.draw(page, axes, |[at, _]| (x(at), axes.y));
        }
        for (k, curve) in self.curves.iter().enumerate() {
            for segment in curve.points.split(|p| !(p.0.is_finite() && p.1.is_finite())) {
                stroke(page, segment.iter().map(|&(t, value)| (x(t), y(value))).collect(), 2.0, k, curve.marked);
            }
        }
        self.draw_legend(page, area, axes, plan);
    }

    fn draw_legend(&self, page: &mut Page, area: Area, axes: Area, plan: &Plan) {
        let names = self.names();
        let (legend, x, y) = match plan.beside {
            true => (Legend::column(&names, SMALL), axes.right() + 14.0, axes.y),
            false => (Legend::flow(&names, SMALL, area.width), area.x, axes.bottom() + FOOT),
        };
        let at = Area { x, y, width: legend.width, height: legend.height };
        for (k, (entry, curve)) in legend.entries.iter().zip(&self.curves).enumerate() {
            let (from, height) = (at.x + entry.x, at.y + entry.y);
            let end = from + SAMPLE - 8.0;
            let middle = (0.5 * (from + end), height);
            let sample = if curve.marked { vec![middle] } else { vec![(from, height), middle, (end, height)] };
            stroke(page, sample, 3.0, k, curve.marked);
            for (line, text) in entry.lines.iter().enumerate() {
                page.text(Legend::baseline(at, entry, line, SMALL), SMALL, Anchor::Left, text);
            }
        }
    }
}

/// Room around the axes of charts beside and below each other, the same for all.
struct Plan {
    left: f64,
    right: f64,
    top: f64,
    /// Of the axes.
    height: f64,
    /// Names of curves stand beside the axes, not below.
    beside: bool,
    /// Height of names below the axes.
    below: f64,
}

impl Plan {
    fn new(charts: &[Chart], width: f64, height: f64) -> Self {
        let columns = charts.iter().map(|chart| Legend::column(&chart.names(), SMALL));
        let (wide, tall) = columns
            .filter(|legend| !legend.entries.is_empty())
            .fold((0.0f64, 0.0f64), |(w, h), legend| (w.max(legend.width), h.max(legend.height)));
        let beside = wide <= BESIDE * width && tall <= height;
        let flows = charts.iter().map(|chart| Legend::flow(&chart.names(), SMALL, width).height);
        let below = if beside { 0.0 } else { flows.fold(0.0, f64::max) };
        let ups: Vec<_> = charts.iter().filter_map(|chart| Some((chart, chart.upright(height)?))).collect();
        let lines = ups.iter().map(|(chart, up)| wrap(&up.title(&chart.quantity), TEXT, width).len());
        let left = ups.iter().map(|(_, up)| widest(&up.labels, SMALL)).fold(0.0, f64::max) + GAP;
        let lasts = charts.iter().filter_map(|chart| {
            let along = AxisScale::level(chart.ends()?, &chart.along.1, width - left, SMALL);
            Some(0.5 * widest(&along.labels, SMALL))
        });
        let label = lasts.fold(0.0, f64::max) + 2.0;
        Self {
            // The first label of time is centred at the corner.
            left: left.max(label),
            right: if beside && wide > 0.0 { (14.0 + wide).max(label) } else { label },
            top: 18.0 + LEADING * TEXT * lines.max().unwrap_or(1) as f64,
            height,
            beside,
            below,
        }
    }

    fn outer_height(&self) -> f64 {
        self.top + self.height + FOOT + self.below
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

/// Size of a title on a page of that width.
pub(super) fn title_size(width: f64) -> f64 {
    if width < 560.0 { 16.0 } else { 19.0 }
}

/// Draws charts in rows of `columns` and returns the page.
/// The page has `size` units, or is as wide as the paper, or as charts fit.
pub(super) fn page(
    charts: &[Chart],
    columns: usize,
    title: &str,
    size: Option<(u32, u32)>,
    paper: Paper,
) -> Result<Page, PlotError> {
    const BETWEEN: f64 = 26.0;
    let given = size.map(|size| f64::from(size.0)).or(paper.units());
    let columns = if given.is_some_and(|width| width < 700.0) { 1 } else { columns.clamp(1, charts.len().max(1)) };
    let rows = charts.len().div_ceil(columns).max(1);
    let width = given.unwrap_or(if columns == 1 { 900.0 } else { 1080.0 });
    let panel_width = (width - 2.0 * MARGIN - (columns - 1) as f64 * BETWEEN) / columns as f64;
    let title_size = title_size(width);
    let lines = wrap(title, title_size, width - 2.0 * MARGIN);
    let top = MARGIN + LEADING * title_size * lines.len() as f64;
    let outer = |plan: &Plan| top + rows as f64 * plan.outer_height() + MARGIN;
    let too_small = |height: f64| PlotError::Size { width: width.max(0.0) as u32, height: height.max(0.0) as u32 };
    if panel_width < 120.0 {
        return Err(too_small(size.map_or(0.0, |size| f64::from(size.1))));
    }
    let mut plan = Plan::new(charts, panel_width, (0.55 * panel_width).clamp(160.0, 330.0));
    if let Some((_, height)) = size {
        let room = plan.height + (f64::from(height) - outer(&plan)) / rows as f64;
        plan = Plan::new(charts, panel_width, room);
        let missing = outer(&plan) - f64::from(height);
        plan = Plan::new(charts, panel_width, room - missing / rows as f64);
    }
    let height = size.map_or_else(|| outer(&plan).ceil(), |size| f64::from(size.1));
    if panel_width - plan.left - plan.right < 80.0 || plan.height < 60.0 {
        return Err(too_small(height));
    }
    let mut page = Page::new(width, height, paper)?;
    draw_title(&mut page, &lines, title_size);
    for (k, chart) in charts.iter().enumerate() {
        let area = Area {
            x: MARGIN + (k % columns) as f64 * (panel_width + BETWEEN),
            y: top + (k / columns) as f64 * plan.outer_height(),
            width: panel_width,
            height: plan.outer_height(),
        };
        chart.draw(&mut page, area, &plan);
    }
    Ok(page)
}

/// Writes lines of a title in the upper left corner of a page.
pub(super) fn draw_title(page: &mut Page, lines: &[String], size: f64) {
    for (k, line) in lines.iter().enumerate() {
        page.text((MARGIN, MARGIN + size * (ASCENT + LEADING * k as f64)), size, Anchor::Left, line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::page::misplaced;

    fn chart(names: &[&str], values: &[f64], unit: &str) -> Chart {
        let points: Vec<_> = values.iter().enumerate().map(|(k, value)| (1e-6 * k as f64, *value)).collect();
        let curve = |name: &&str| Curve { name: (*name).to_owned(), points: points.clone(), marked: false };
        Chart {
            along: time(),
            quantity: names.join(", "),
            unit: unit.into(),
            curves: names.iter().map(curve).collect(),
            limits: None,
            walls: Vec::new(),
        }
    }

    #[test]
    fn ranges_have_room_and_are_never_empty() {
        assert_eq!(with_room(0.0, 0.0), (-1.0, 1.0));
        assert_eq!(with_room(5.0, 5.0), (4.5, 5.5));
        assert_eq!(with_room(2.0, 10.0), (0.0, 10.4));
        assert_eq!(with_room(-10.0, -2.0), (-10.4, 0.0));
        assert_eq!(with_room(100.0, 120.0), (99.0, 121.0));
    }

    #[test]
    fn no_label_leaves_the_page_or_covers_another_whatever_the_numbers_and_names() {
        let long = "tracer.a_point_with_a_very_long_name_indeed.equivalent_strain_rate";
        let names: [&[&str]; 3] = [&["drift"], &["total", "kinetic", "internal", "plastic work"], &[long, "b", long]];
        let values: [&[f64]; 6] = [
            &[-1_323_746.112, -1_323_746.11],
            &[0.0, 1.0],
            &[-1e-17, 1e-17],
            &[1e300, -1e300],
            &[123_456.7, 123_456.7],
            &[0.001_234_5, 0.001_234_51, f64::NAN],
        ];
        let title = "A title that goes on and on until it no longer fits the width of a page of any sensible size";
        for names in names {
            for values in values {
                let charts = ["J", "1/s", ""].map(|unit| chart(names, values, unit));
                for width in [None, Some(0.085), Some(0.099), Some(0.17)] {
                    let page = page(&charts, 2, title, None, Paper { dpi: 100, width }).unwrap();
                    assert_eq!(misplaced(&page), Vec::<String>::new(), "{names:?} {values:?} {width:?}");
                }
                let page = page(&charts, 1, title, Some((900, 1400)), Paper::default()).unwrap();
                assert_eq!(misplaced(&page), Vec::<String>::new(), "{names:?} {values:?}");
            }
        }
    }

    #[test]
    fn curves_with_gaps_or_nothing_are_drawn_without_harm() {
        let (nothing, gap) = (chart(&[], &[], ""), chart(&["a"], &[1.0, f64::NAN, 3.0], ""));
        let charts = [nothing, gap];
        assert!(!charts[0].has_values() && charts[1].has_values());
        page(&charts, 2, "Title", None, Paper::default()).unwrap();
        let small = page(&charts, 2, "Title", Some((300, 200)), Paper::default());
        assert!(matches!(small, Err(PlotError::Size { .. })));
    }
}
