//! The page of a picture of particles: panels, axes, colour bar, texts.

use super::{
    ColorMap, FieldPicture, PlotError,
    canvas::{Anchor, Area, Canvas, FRAME, INK, wrap},
    chart::{Chart, Curve, page},
    color::Rgb,
    scene::{Panel, Scene},
    spans::draw_spans,
    splat::{Dot, splat},
    title::run_title,
};
use crate::{
    number::{four_digits, grouped, quantity, scaled_unit, tick_labels, ticks},
    output::RunDirectory,
};
use std::path::Path;

/// Draws a picture of particles to a PNG file.
///
/// # Errors
/// [`PlotError::Field`] if a frame does not have the field, [`PlotError::Empty`] if there is nothing to see,
/// [`PlotError::Output`] if frames cannot be read or the picture cannot be written.
pub fn plot_field(run: &RunDirectory, picture: &FieldPicture, to: &Path) -> Result<(), PlotError> {
    draw_runs(&[("", run)], picture, to)
}

/// Draws the same picture of several runs, under the given names, at one scale of lengths and colours: side by side, or where each has
/// several frames, a row for each run.
///
/// # Errors
/// As [`plot_field`]; [`PlotError::Empty`] without a run.
pub fn plot_field_of_runs(runs: &[(String, RunDirectory)], picture: &FieldPicture, to: &Path) -> Result<(), PlotError> {
    let runs: Vec<_> = runs.iter().map(|(name, run)| (name.as_str(), run)).collect();
    draw_runs(&runs, picture, to)
}

fn draw_runs(runs: &[(&str, &RunDirectory)], picture: &FieldPicture, to: &Path) -> Result<(), PlotError> {
    let scene = Scene::read(runs, picture)?;
    let title = || runs.first().map_or_else(String::new, |(_, run)| run_title(run));
    let title = picture.title.clone().unwrap_or_else(title);
    let page = if scene.line { draw_line(&scene, picture, &title) } else { draw(&scene, picture, &title) };
    page?.save(to)
}

/// A problem of one dimension is a curve over x for each frame.
fn draw_line(scene: &Scene, picture: &FieldPicture, title: &str) -> Result<Canvas, PlotError> {
    let curve = |panel: &Panel| {
        let mut points: Vec<_> = panel.marks.iter().map(|mark| (mark.right, mark.value)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some([(low, high), _]) = picture.window {
            points.retain(|(x, _)| (low..=high).contains(x));
        }
        Curve { name: panel.heading(), points, marked: false }
    };
    let curves: Vec<_> = scene.panels.iter().map(curve).collect();
    let title = match &curves[..] {
        [only] => format!("{title},  {}", only.name),
        _ => title.to_owned(),
    };
    let (quantity, unit) = (scene.label.clone(), scene.unit.to_owned());
    page(&[Chart { along: ("x", "m"), quantity, unit, curves, limits: picture.range }], 1, &title, picture.size)
}

const TITLE: f64 = 19.0;
const TEXT: f64 = 15.0;
const SMALL: f64 = 13.0;
const MARGIN: f64 = 22.0;
const BAR_WIDTH: f64 = 20.0;
/// Colour of particles without a finite value.
const NO_VALUE: Rgb = [160, 160, 160];
/// Pixels of all panels together on a page made to fit.
const FIT: f64 = 5.0e5;
/// Slim figures side by side.
const ABREAST: usize = 4;
/// Colours of a field that is zero or one.
const FLAG_COLORS: [Rgb; 2] = [[176, 190, 204], [213, 94, 0]];

/// Where everything is.
struct Layout {
    width: u32,
    height: u32,
    title: Vec<String>,
    panels: Vec<Area>,
    bar: Area,
    /// Pixels per metre.
    scale: f64,
}

/// Room around panels.
struct Margins {
    left: f64,
    right: f64,
    bottom: f64,
    /// Between panels: across, down.
    gap: (f64, f64),
}

fn draw(scene: &Scene, picture: &FieldPicture, title: &str) -> Result<Canvas, PlotError> {
    let colors = Colors::new(scene, picture);
    let plane = scene.view.axes();
    let margins = Margins {
        left: if plane.is_some() { 84.0 } else { MARGIN },
        right: 128.0,
        bottom: if plane.is_some() { 62.0 } else { 74.0 },
        gap: (if plane.is_some() { 84.0 } else { 26.0 }, if plane.is_some() { 78.0 } else { 44.0 }),
    };
    let layout = layout(scene, picture, title, &margins)?;
    let mut canvas = Canvas::new(layout.width, layout.height)?;

    for (k, line) in layout.title.iter().enumerate() {
        let y = MARGIN + TITLE * (0.8 + 1.3 * k as f64);
        canvas.text((MARGIN, y), TITLE, Anchor::Left, INK, line);
    }
    for (panel, area) in scene.panels.iter().zip(&layout.panels) {
        draw_panel(&mut canvas, scene, panel, *area, layout.scale, &colors);
    }
    if plane.is_none()
        && let Some(first) = layout.panels.first()
    {
        let foot = layout.height as f64 - 30.0;
        triad(&mut canvas, scene, (first.x + 26.0, foot - 4.0));
        scale_bar(&mut canvas, (first.x + 92.0, foot), layout.scale);
    }
    colors.draw_bar(&mut canvas, layout.bar, scene);
    Ok(canvas)
}

fn layout(scene: &Scene, picture: &FieldPicture, title: &str, margins: &Margins) -> Result<Layout, PlotError> {
    let pad = 0.03 * scene.window.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let [across, up] = scene.window.map(|(low, high)| (high - low + 2.0 * pad).max(f64::MIN_POSITIVE));
    let count = scene.panels.len();
    let (columns, rows) = if scene.frames > 1 && scene.frames < count {
        (scene.frames, count / scene.frames)
    } else if across < 1.4 * up {
        // Slim figures stand side by side, flat ones on top of each other.
        (count.min(ABREAST), count.div_ceil(ABREAST))
    } else {
        (1, count)
    };
    let abreast = columns;
    let (columns, rows, count) = (columns as f64, rows as f64, count as f64);
    let side = margins.left + margins.right + (columns - 1.0) * margins.gap.0;

    let (scale, size) = match picture.size {
        Some(size) => (0.0, size),
        None => {
            let scale = (FIT / (count * across * up)).sqrt();
            let scale = scale.min(1100.0 / (columns * across)).min(900.0 / (rows * up));
            let width = (columns * across * scale + side).max(640.0);
            (scale, (width.round() as u32, 0))
        }
    };
    let width = f64::from(size.0);
    let title = wrap(title, TITLE, width - 2.0 * MARGIN);
    let top = MARGIN + title.len() as f64 * 1.3 * TITLE + 34.0;
    let rest = top + margins.bottom + (rows - 1.0) * margins.gap.1;
    let (scale, height) = if scale > 0.0 {
        (scale, (rows * up * scale).max(170.0) + rest)
    } else {
        let (room_across, room_up) = (width - side, f64::from(size.1) - rest);
        if room_across < 80.0 || room_up < 80.0 {
            return Err(PlotError::Size { width: size.0, height: size.1 });
        }
        ((room_across / (columns * across)).min(room_up / (rows * up)), f64::from(size.1))
    };

    let (w, h) = (across * scale, up * scale);
    let block = (columns * w + (columns - 1.0) * margins.gap.0, rows * h + (rows - 1.0) * margins.gap.1);
    // The block of panels with its colour bar stands in the middle of the room left for it.
    let left = margins.left + 0.5 * (width - side - columns * w).max(0.0);
    let over = top + 0.5 * (height - rest - rows * h).max(0.0);
    let panels = (0..scene.panels.len())
        .map(|k| {
            let (column, row) = ((k % abreast) as f64, (k / abreast) as f64);
            Area {
                x: (left + column * (w + margins.gap.0)).round(),
                y: (over + row * (h + margins.gap.1)).round(),
                width: w.round(),
                height: h.round(),
            }
        })
        .collect();
    // Room for the extremes above and below.
    let bar_height = (block.1 - 70.0).clamp(150.0, 460.0);
    let bar = Area {
        x: (left + block.0 + 26.0).round(),
        y: (over + 0.5 * (block.1 - bar_height)).round(),
        width: BAR_WIDTH,
        height: bar_height.round(),
    };
    Ok(Layout { width: size.0, height: height.round() as u32, title, panels, bar, scale })
}

fn draw_panel(canvas: &mut Canvas, scene: &Scene, panel: &Panel, area: Area, scale: f64, colors: &Colors) {
    let centre = scene.window.map(|(low, high)| 0.5 * (low + high));
    let place = |right: f64, up: f64| {
        (0.5 * area.width + (right - centre[0]) * scale, 0.5 * area.height - (up - centre[1]) * scale)
    };
    let dots = panel.marks.iter().map(|mark| {
        let (x, y) = place(mark.right, mark.up);
        let share = radius_share(mark.spacing * scale, scene.deep);
        let radius = share * mark.spacing * scale;
        Dot { x, y, depth: mark.towards * scale, radius, color: colors.of(mark.value), light: mark.light }
    });
    splat(canvas, area, dots, scene.deep);
    if scene.view.axes().is_some() {
        draw_spans(canvas, &panel.spans, |end| {
            let [right, up, _] = scene.projection.apply(end);
            let (x, y) = place(right, up);
            (area.x + x, area.y + y)
        });
    }

    let heading = panel.heading();
    let long = match scene.flag {
        // Three digits say all there is.
        Some([_, one]) => format!("{heading},  {} % {one}", four_digits((1000.0 * panel.mean).round() / 10.0)),
        None => format!("{heading},  {} particles", grouped(panel.marks.len())),
    };
    let short = if panel.name.is_empty() { &heading } else { &panel.name };
    let fits = |text: &&String| Canvas::text_width(text, TEXT) <= area.width;
    let caption = [&long, &heading].into_iter().find(fits).unwrap_or(short);
    canvas.text((area.x + 0.5 * area.width, area.y - 12.0), TEXT, Anchor::Centre, INK, caption);

    if let Some(names) = scene.view.axes() {
        canvas.outline(area, 1.0, FRAME);
        let (low, high) = (-0.5 * area.width / scale, 0.5 * area.width / scale);
        let across = Axis::new((centre[0] + low, centre[0] + high), area.width, 80.0);
        across.draw_below(canvas, area, names[0], |x| area.x + place(x, 0.0).0);
        let (low, high) = (-0.5 * area.height / scale, 0.5 * area.height / scale);
        let up = Axis::new((centre[1] + low, centre[1] + high), area.height, 60.0);
        up.draw_left(canvas, area, names[1], |y| area.y + place(0.0, y).1);
    }
}

impl Panel {
    /// Run and time.
    fn heading(&self) -> String {
        let time = format!("t = {}", quantity(self.time, "s"));
        if self.name.is_empty() { time } else { format!("{},  {time}", self.name) }
    }
}

/// Radius over spacing: discs leave small gaps, balls in space close the surface, small ones close it always.
fn radius_share(spacing_in_pixels: f64, deep: bool) -> f64 {
    match (deep, spacing_in_pixels < 4.0) {
        (_, true) => 0.75,
        (true, false) => 0.71,
        (false, false) => 0.58,
    }
}

/// Ticks of a length axis.
struct Axis {
    ticks: Vec<f64>,
    labels: Vec<String>,
    unit: String,
}

impl Axis {
    fn new((low, high): (f64, f64), pixels: f64, apart: f64) -> Self {
        let ticks = ticks(low, high, (pixels / apart).floor().max(2.0) as usize);
        let (scale, unit) = scaled_unit(low.abs().max(high.abs()), "m");
        Self { labels: tick_labels(&ticks, scale), ticks, unit }
    }

    fn draw_below(&self, canvas: &mut Canvas, area: Area, name: &str, place: impl Fn(f64) -> f64) {
        let bottom = area.y + area.height;
        for (tick, label) in self.ticks.iter().zip(&self.labels) {
            let x = place(*tick);
            canvas.line((x, bottom), (x, bottom + 5.0), 1.0, FRAME);
            canvas.text((x, bottom + 20.0), SMALL, Anchor::Centre, INK, label);
        }
        let label = format!("{name} ({})", self.unit);
        canvas.text((area.x + 0.5 * area.width, bottom + 42.0), TEXT, Anchor::Centre, INK, &label);
    }

    fn draw_left(&self, canvas: &mut Canvas, area: Area, name: &str, place: impl Fn(f64) -> f64) {
        let mut widest = 0.0f64;
        for (tick, label) in self.ticks.iter().zip(&self.labels) {
            let y = place(*tick);
            canvas.line((area.x, y), (area.x - 5.0, y), 1.0, FRAME);
            canvas.text((area.x - 9.0, y + 0.36 * SMALL), SMALL, Anchor::Right, INK, label);
            widest = widest.max(Canvas::text_width(label, SMALL));
        }
        let label = format!("{name} ({})", self.unit);
        let x = area.x - 9.0 - widest - 12.0;
        canvas.text_upwards((x, area.y + 0.5 * area.height), TEXT, INK, &label);
    }
}

/// A line of round length with its length written beside it.
fn scale_bar(canvas: &mut Canvas, (x, y): (f64, f64), scale: f64) {
    let Some(&length) = ticks(0.0, 150.0 / scale, 2).get(1) else { return };
    let end = x + length * scale;
    canvas.line((x, y), (end, y), 2.0, INK);
    canvas.line((x, y - 4.0), (x, y + 4.0), 2.0, INK);
    canvas.line((end, y - 4.0), (end, y + 4.0), 2.0, INK);
    canvas.text((0.5 * (x + end), y - 8.0), SMALL, Anchor::Centre, INK, &quantity(length, "m"));
}

/// The directions of the axes, where the view is along none of them.
fn triad(canvas: &mut Canvas, scene: &Scene, (x, y): (f64, f64)) {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut unit = [0.0; 3];
        unit[axis] = 1.0;
        let [right, up, _] = scene.projection.apply(unit);
        let at = |length: f64| (x + length * right, y - length * up);
        canvas.line((x, y), at(26.0), 1.6, INK);
        let (tx, ty) = at(36.0);
        canvas.text((tx, ty + 0.3 * SMALL), SMALL, Anchor::Centre, INK, name);
    }
}

/// From values to colours.
struct Colors {
    map: ColorMap,
    low: f64,
    high: f64,
    /// Words for zero and one of a field that has no other values.
    flag: Option<[&'static str; 2]>,
}

impl Colors {
    fn new(scene: &Scene, picture: &FieldPicture) -> Self {
        let (extremes, bulk) = (scene.extremes, scene.bulk);
        let inside = bulk.1 - bulk.0;
        let stretched = extremes.1 - extremes.0 > 1.5 * inside && inside > 0.0;
        // An end that outliers move little is the extreme itself.
        let end = |bulk: f64, extreme: f64| {
            if stretched && (extreme - bulk).abs() > 0.2 * inside { bulk } else { extreme }
        };
        let (low, high) = (end(bulk.0, extremes.0), end(bulk.1, extremes.1));
        // Zero is worth a colour of its own where both signs matter.
        let both_signs = low < -0.2 * high.abs() && high > -0.2 * low;
        let map = picture.color_map.unwrap_or(if both_signs { ColorMap::Diverging } else { ColorMap::Viridis });
        let (low, high) = match picture.range {
            Some(range) => range,
            None if map == ColorMap::Diverging => (-high.abs().max(low.abs()), high.abs().max(low.abs())),
            None => (low, high),
        };
        // A field that is the same everywhere still has a place on a bar: in its middle.
        let least = 1e-6 * low.abs().max(high.abs()).max(f64::MIN_POSITIVE);
        let flag = scene.flag;
        if high - low > least {
            Self { map, low, high, flag }
        } else {
            let half = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            Self { map, low: low - half, high: high + half, flag }
        }
    }

    fn of(&self, value: f64) -> Rgb {
        if self.flag.is_some() && value.is_finite() {
            return FLAG_COLORS[usize::from(value > 0.5)];
        }
        if value.is_finite() { self.map.color((value - self.low) / (self.high - self.low)) } else { NO_VALUE }
    }

    fn draw_key(&self, canvas: &mut Canvas, area: Area, words: [&str; 2]) {
        let middle = area.y + 0.5 * area.height;
        for (k, word) in words.into_iter().enumerate() {
            // One above zero.
            let top = middle - 26.0 * k as f64;
            let swatch = Area { x: area.x, y: top, width: 16.0, height: 16.0 };
            canvas.fill(swatch, FLAG_COLORS[k]);
            canvas.outline(swatch, 1.0, FRAME);
            canvas.text((area.x + 24.0, top + 8.0 + 0.36 * SMALL), SMALL, Anchor::Left, INK, word);
        }
    }

    fn draw_bar(&self, canvas: &mut Canvas, area: Area, scene: &Scene) {
        if let Some(words) = self.flag {
            return self.draw_key(canvas, area, words);
        }
        let rows = area.height as usize;
        for row in 0..rows {
            let share = 1.0 - (row as f64 + 0.5) / rows as f64;
            canvas.fill(Area { y: area.y + row as f64, height: 1.0, ..area }, self.map.color(share));
        }
        let (left, right, top, bottom) = (area.x, area.x + area.width, area.y, area.y + area.height);
        canvas.outline(area, 1.0, FRAME);
        let (scale, unit) = scaled_unit(self.low.abs().max(self.high.abs()), scene.unit);
        let ticks = ticks(self.low, self.high, (area.height / 55.0) as usize);
        let mut widest = 0.0f64;
        for (tick, label) in ticks.iter().zip(tick_labels(&ticks, scale)) {
            let y = bottom - (tick - self.low) / (self.high - self.low) * area.height;
            canvas.line((right, y), (right + 5.0, y), 1.0, FRAME);
            canvas.text((right + 9.0, y + 0.36 * SMALL), SMALL, Anchor::Left, INK, &label);
            widest = widest.max(Canvas::text_width(&label, SMALL));
        }
        // Values beyond the ends: an arrow with the extreme.
        let (least, most) = scene.extremes;
        let slack = 1e-6 * (self.high - self.low);
        let middle = 0.5 * (left + right);
        if most > self.high + slack {
            canvas.polygon(&[(left, top - 2.0), (right, top - 2.0), (middle, top - 13.0)], self.map.color(1.0));
            let label = format!("max {}", four_digits(most / scale));
            canvas.text((left, top - 19.0), SMALL, Anchor::Left, INK, &label);
        }
        if least < self.low - slack {
            canvas
                .polygon(&[(left, bottom + 2.0), (right, bottom + 2.0), (middle, bottom + 13.0)], self.map.color(0.0));
            let label = format!("min {}", four_digits(least / scale));
            canvas.text((left, bottom + 29.0), SMALL, Anchor::Left, INK, &label);
        }
        let label = if unit.is_empty() { scene.label.clone() } else { format!("{} ({unit})", scene.label) };
        canvas.text_upwards((right + 9.0 + widest + 20.0, top + 0.5 * area.height), TEXT, INK, &label);
    }
}
