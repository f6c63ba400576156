//! The page of a picture of particles: panels, axes, colour bar, texts. Margins follow the labels.

use super::{
    FieldPicture, PlotError,
    axis::AxisScale,
    cell::{HalfSpace, dot},
    chart::{draw_title, title_size},
    color_bar::Colors,
    font::{LEADING, text_width, widest, wrap},
    page::{Anchor, Area, FRAME, INK, MARGIN, Page, SMALL, TEXT},
    paper::Paper,
    scene::{Panel, Scene},
    spans::draw_spans,
    splat::{BALL, Dot, Facet, LEAST_RADIUS, splat},
};
use crate::number::{four_digits, grouped, quantity, ticks};

/// Area of all panels of a page whose width is not given.
const FIT: f64 = 5.0e5;
/// Slim figures side by side.
const ABREAST: usize = 4;
/// On narrower pages the colour bar goes below the panels.
const NARROW: f64 = 560.0;
/// Least width of a panel beside others on a page of a given width.
const LEAST_PANEL: f64 = 110.0;
/// Between panels and the colour bar.
const BAR_GAP: f64 = 22.0;

/// Where everything is.
pub(super) struct Layout {
    paper: Paper,
    width: f64,
    height: f64,
    title: Vec<String>,
    panels: Vec<Area>,
    columns: usize,
    /// Units of the page per metre.
    scale: f64,
    /// Width of a caption, and lines there is room for.
    caption: (f64, usize),
    bar: Bar,
}

/// Where the colour bar is.
enum Bar {
    Beside { x: f64, top: f64, height: f64 },
    Below { x: f64, y: f64, width: f64 },
}

/// What takes room around panels, as far as it depends on their size.
#[derive(Clone, Copy)]
struct Room {
    left: f64,
    right: f64,
    /// Above the first row of panels, without the title.
    above: f64,
    /// Below the last one, with a colour bar there.
    below: f64,
    /// Between panels: across, down.
    gap: (f64, f64),
    caption: (f64, usize),
}

impl Layout {
    /// A page for all panels of a scene.
    ///
    /// # Errors
    /// [`PlotError::Size`] where the page that is asked for has no room for them.
    pub(super) fn new(scene: &Scene, picture: &FieldPicture, title: &str, colors: &Colors) -> Result<Self, PlotError> {
        let plane = scene.look.view.axes().is_some();
        let pad = 0.04 * scene.extent.window.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let [across, up] = scene.extent.window.map(|(low, high)| (high - low + 2.0 * pad).max(f64::MIN_POSITIVE));
        let given = picture.size.map(|size| f64::from(size.0)).or(picture.paper.units());
        let tall = picture.size.map(|size| f64::from(size.1));
        let count = scene.panels.len();
        let columns = columns(scene, across, up, given);
        let rows = count.div_ceil(columns);
        let beside = given.is_none_or(|width| width >= NARROW);
        let (many, lines) = (columns as f64, rows as f64);

        let mut room = Room {
            left: MARGIN + if plane { 60.0 } else { 0.0 },
            right: MARGIN + if beside { 110.0 } else { 0.0 },
            above: 30.0,
            below: 70.0,
            gap: (26.0, 40.0),
            caption: (200.0, 1),
        };
        let (mut scale, mut width, mut top) = (0.0, 0.0, 0.0);
        let mut head = Vec::new();
        // Labels depend on the scale and the scale on the room of the labels: a few rounds settle it.
        for _ in 0..5 {
            let side = room.left + room.right + (many - 1.0) * room.gap.0;
            scale = match given {
                Some(given) => ((given - side) / (many * across)).min(2.2 * given / (lines * up)),
                None => {
                    let scale = (FIT / (count as f64 * across * up)).sqrt();
                    scale.min(1000.0 / (many * across)).min(900.0 / (lines * up))
                }
            };
            width = given.unwrap_or((many * across * scale + side).max(NARROW));
            head = wrap(title, title_size(width), width - 2.0 * MARGIN);
            top = MARGIN + LEADING * title_size(width) * head.len() as f64;
            if let Some(tall) = tall {
                let rest = top + room.above + room.below + (lines - 1.0) * room.gap.1;
                scale = scale.min((tall - rest) / (lines * up));
            }
            if !(scale * across * many > 40.0 || scale * up * lines > 40.0) || scale <= 0.0 {
                let height = tall.unwrap_or(0.0);
                return Err(PlotError::Size { width: width.max(0.0) as u32, height: height.max(0.0) as u32 });
            }
            let block = lines * up * scale + (lines - 1.0) * room.gap.1;
            room = Room::around(
                scene,
                colors,
                [across, up].map(|side| side * scale),
                scale,
                block,
                columns,
                beside,
                width,
            );
        }
        let (w, h) = (across * scale, up * scale);
        let block = (many * w + (many - 1.0) * room.gap.0, lines * h + (lines - 1.0) * room.gap.1);
        // A bar beside is taller than flat panels, and stands beside what is above and below them, too.
        let around = 2.0 * room.above.min(foot(plane));
        let body = if beside { block.1.max(colors.least_height() - around) } else { block.1 };
        let height = tall.unwrap_or(top + room.above + body + room.below);
        let body = body.max(height - top - room.above - room.below).min(body.max(block.1));
        // The block of panels with its colour bar stands in the middle of the room left for it.
        let left = room.left + 0.5 * (width - room.left - room.right - block.0).max(0.0);
        let over = top + room.above + 0.5 * (height - top - room.above - room.below - block.1).max(0.0);
        let panels = (0..count)
            .map(|k| {
                let (column, row) = ((k % columns) as f64, (k / columns) as f64);
                Area {
                    x: (left + column * (w + room.gap.0)).round(),
                    y: (over + row * (h + room.gap.1)).round(),
                    width: w.round().max(1.0),
                    height: h.round().max(1.0),
                }
            })
            .collect();
        let bar = if beside {
            let overhang = 0.5 * (room.caption.0 - w).max(0.0);
            Bar::Beside {
                x: (left + block.0 + overhang + BAR_GAP).round(),
                top: over + 0.5 * (block.1 - body),
                height: body,
            }
        } else {
            let length = (width - 2.0 * MARGIN).min(460.0);
            let y = over + block.1 + foot(plane);
            Bar::Below { x: 0.5 * (width - length), y, width: length }
        };
        let paper = picture.paper;
        Ok(Self { paper, width, height, title: head, panels, columns, scale, caption: room.caption, bar })
    }

    /// Lines above a panel: as much as there is room for.
    fn caption(&self, scene: &Scene, panel: &Panel) -> Vec<String> {
        let mut lines = caption(scene, panel, self.caption.0);
        lines.truncate(self.caption.1);
        lines
    }
}

/// Height of axis labels, or of the triad and scale, below panels.
fn foot(plane: bool) -> f64 {
    if plane { 56.0 } else { 78.0 }
}

/// Panels beside each other.
fn columns(scene: &Scene, across: f64, up: f64, width: Option<f64>) -> usize {
    let count = scene.panels.len();
    let fit = width.map_or(usize::MAX, |width| ((width - 80.0) / LEAST_PANEL).max(1.0) as usize);
    if scene.frames > 1 && scene.frames < count && scene.frames <= fit {
        scene.frames
    } else if across < 1.4 * up {
        // Slim figures stand side by side, flat ones on top of each other.
        count.min(ABREAST).min(fit)
    } else {
        1
    }
}

impl Room {
    fn around(
        scene: &Scene,
        colors: &Colors,
        panel: [f64; 2],
        scale: f64,
        block: f64,
        columns: usize,
        beside: bool,
        width: f64,
    ) -> Self {
        let plane = scene.look.view.axes().is_some();
        let [right, up] = axes(scene, panel, scale);
        let level = if plane { widest(&right.labels, SMALL) } else { 0.0 };
        let gap = (level + 14.0).max(26.0);
        let caption_width = match (columns, beside) {
            (1, true) => panel[0].max(LEAST_PANEL),
            (1, false) => width - 2.0 * MARGIN,
            _ => panel[0] + gap - 10.0,
        };
        let lines = scene.panels.iter().map(|panel| caption(scene, panel, caption_width).len());
        let lines = lines.max().unwrap_or(1);
        let above = LEADING * TEXT * lines as f64 + 14.0;
        let overhang = 0.5 * (caption_width - panel[0]).max(0.0);
        let body = block.max(colors.least_height());
        let half_label = 0.5 * level;
        Self {
            left: if plane {
                MARGIN + TEXT + 14.0 + widest(&up.labels, SMALL) + 9.0
            } else {
                MARGIN + overhang.min(60.0)
            },
            right: if beside { overhang + BAR_GAP + colors.width(body) + MARGIN } else { MARGIN.max(half_label) },
            above,
            below: foot(plane) + MARGIN + if beside { 0.0 } else { colors.height((width - 2.0 * MARGIN).min(460.0)) },
            gap: (gap, above + 16.0),
            caption: (caption_width, lines),
        }
    }
}

/// Axes of a panel, right and up.
fn axes(scene: &Scene, panel: [f64; 2], scale: f64) -> [AxisScale; 2] {
    let side = |k: usize| {
        let (low, high) = scene.extent.window[k];
        let (middle, half) = (0.5 * (low + high), 0.5 * panel[k] / scale);
        (middle - half, middle + half)
    };
    [AxisScale::level(side(0), "m", panel[0], SMALL), AxisScale::upright(side(1), "m", panel[1], SMALL)]
}

/// What is written above a panel.
fn caption(scene: &Scene, panel: &Panel, width: f64) -> Vec<String> {
    let heading = panel.heading();
    let long = match scene.flag {
        // Three digits say all there is.
        Some([_, one]) => format!("{heading},  {} % {one}", four_digits((1000.0 * panel.mean).round() / 10.0)),
        // A section, a body or a condition leaves some out.
        None if panel.count < panel.of => {
            format!("{heading},  {} of {} particles", grouped(panel.count), grouped(panel.of))
        }
        None => format!("{heading},  {} particles", grouped(panel.count)),
    };
    // What is in one line where it can be.
    match [long, heading.clone()].into_iter().find(|text| text_width(text, TEXT) <= width) {
        Some(text) => vec![text],
        None => wrap(&heading, TEXT, width),
    }
}

impl Panel {
    /// Run and time.
    pub(super) fn heading(&self) -> String {
        let time = format!("t = {}", quantity(self.time, "s")).replace(' ', "\u{a0}");
        if self.name.is_empty() { time } else { format!("{}, {time}", self.name) }
    }
}

/// Draws a scene.
pub(super) fn draw(scene: &Scene, colors: &Colors, layout: &Layout) -> Result<Page, PlotError> {
    let mut page = Page::new(layout.width, layout.height, layout.paper)?;
    draw_title(&mut page, &layout.title, title_size(layout.width));
    for k in 0..scene.panels.len() {
        draw_panel(&mut page, scene, k, colors, layout);
    }
    if scene.look.view.axes().is_none()
        && let (Some(first), Some(last)) = (layout.panels.first(), layout.panels.last())
    {
        let foot = last.bottom() + foot(false) - 26.0;
        let from = first.x.min(layout.width - 280.0).max(MARGIN);
        triad(&mut page, scene, (from + 26.0, foot - 4.0));
        let room = (layout.width - from - 92.0 - 2.0 * MARGIN).min(150.0);
        scale_bar(&mut page, (from + 92.0, foot), layout.scale, room);
    }
    match layout.bar {
        Bar::Beside { x, top, height } => colors.draw_beside(&mut page, x, top, height),
        Bar::Below { x, y, width } => colors.draw_below(&mut page, (x, y), width),
    }
    Ok(page)
}

fn draw_panel(page: &mut Page, scene: &Scene, k: usize, colors: &Colors, layout: &Layout) {
    let (panel, area, scale) = (&scene.panels[k], layout.panels[k], layout.scale);
    let centre = scene.extent.window.map(|(low, high)| 0.5 * (low + high));
    let place = |[right, up]: [f64; 2]| {
        (0.5 * area.width + (right - centre[0]) * scale, 0.5 * area.height - (up - centre[1]) * scale)
    };
    let on_page = |at: [f64; 2]| {
        let (x, y) = place(at);
        (area.x + x, area.y + y)
    };
    for wall in panel.walls.iter().filter(|wall| wall.is_behind()) {
        wall.draw(page, area, on_page);
    }
    let solid = &panel.solid;
    let down = |[right, up, towards]: [f64; 3]| [right, -up, towards];
    let corners: Vec<[f64; 3]> = solid
        .corners
        .iter()
        .map(|[right, up, towards]| {
            let (x, y) = place([*right, *up]);
            [x, y, towards * scale]
        })
        .collect();
    let facets = solid.polygons.iter().map(|polygon| {
        let mark = &panel.marks[polygon.mark as usize];
        Facet {
            corners: &corners[polygon.corners.clone()],
            outward: polygon.outward.map(down),
            edges: polygon.edges,
            color: colors.of(mark.value),
            body: mark.body,
            spacing: mark.spacing * scale,
        }
    });
    let order: Vec<u32> = if scene.look.deep {
        // Those whose cells are drawn are balls only where they stand alone and are too small to be seen.
        let is_ball = |k: &u32| {
            let mark = &panel.marks[*k as usize];
            let is_small = || mark.spacing * scale < 2.0 * LEAST_RADIUS;
            mark.cell.is_none() || is_small() && solid.alone.binary_search(k).is_ok()
        };
        // The nearest first: what is behind them is passed over.
        let mut order: Vec<u32> = (0..panel.marks.len() as u32).filter(is_ball).collect();
        let depth = |k: &u32| panel.marks[*k as usize].towards;
        order.sort_unstable_by(|a, b| depth(b).total_cmp(&depth(a)).then(a.cmp(b)));
        order
    } else {
        (0..panel.marks.len() as u32).collect()
    };
    let dots = order.into_iter().map(|k| {
        let mark = &panel.marks[k as usize];
        let (x, y) = place([mark.right, mark.up]);
        let radius = if mark.spacing * scale < 4.0 { 0.75 } else { BALL } * mark.spacing * scale;
        let down = |[right, up, towards]: [f32; 3]| [right, -up, towards].map(|x| x * scale as f32);
        Dot {
            x,
            y,
            depth: mark.towards * scale,
            radius,
            color: colors.of(mark.value),
            light: mark.light,
            body: mark.body,
            spacing: mark.spacing * scale,
            cell: mark.cell.filter(|_| !scene.look.deep).map(|corners| corners.map(down)),
        }
    });
    let cut = panel.cut.map(|HalfSpace { normal: [right, up, towards], offset }| {
        let (x, y) = place([right * offset, up * offset]);
        let normal = [right, -up, towards];
        HalfSpace { normal, offset: dot(normal, [x, y, towards * offset * scale]) }
    });
    page.image(splat(area, layout.paper.scale(), facets, dots, scene.look.deep, cut));
    for wall in panel.walls.iter().filter(|wall| !wall.is_behind()) {
        wall.draw(page, area, on_page);
    }
    let lines = layout.caption(scene, panel);
    for (k, line) in lines.iter().enumerate() {
        let above = 12.0 + LEADING * TEXT * (lines.len() - 1 - k) as f64;
        page.text((area.x + 0.5 * area.width, area.y - above), TEXT, Anchor::Centre, line);
    }
    let Some(names) = scene.look.view.axes() else { return };
    draw_spans(page, area, &panel.spans, |end| {
        let [right, up, _] = scene.projection.apply(end);
        on_page([right, up])
    });
    page.outline(area, 1.0, FRAME);
    let [right, up] = axes(scene, [area.width, area.height], scale);
    // Panels have the same axes: numbers stand at the first of a row and the last of a column.
    let (first, last) = (k.is_multiple_of(layout.columns), k + layout.columns >= scene.panels.len());
    draw_below(page, area, names[0], &right, last);
    draw_left(page, area, names[1], &up, first);
}

fn draw_below(page: &mut Page, area: Area, name: &str, axis: &AxisScale, labelled: bool) {
    let bottom = area.bottom();
    for (tick, label) in axis.ticks.iter().zip(&axis.labels) {
        let x = area.x + axis.share(*tick) * area.width;
        page.line((x, bottom), (x, bottom + 5.0), 1.0, FRAME);
        if labelled {
            page.text((x, bottom + 20.0), SMALL, Anchor::Centre, label);
        }
    }
    if labelled {
        page.text((area.x + 0.5 * area.width, bottom + 42.0), TEXT, Anchor::Centre, &axis.title(name));
    }
}

fn draw_left(page: &mut Page, area: Area, name: &str, axis: &AxisScale, labelled: bool) {
    for (tick, label) in axis.ticks.iter().zip(&axis.labels) {
        let y = area.bottom() - axis.share(*tick) * area.height;
        page.line((area.x, y), (area.x - 5.0, y), 1.0, FRAME);
        if labelled {
            page.text((area.x - 9.0, y + 0.36 * SMALL), SMALL, Anchor::Right, label);
        }
    }
    if labelled {
        let x = area.x - 9.0 - widest(&axis.labels, SMALL) - 10.0;
        page.text_upwards((x, area.y + 0.5 * area.height), TEXT, &axis.title(name));
    }
}

/// A line of round length, at most `room`, with its length written beside it.
fn scale_bar(page: &mut Page, (x, y): (f64, f64), scale: f64, room: f64) {
    let Some(&length) = ticks(0.0, room / scale, 2).get(1) else { return };
    let end = x + length * scale;
    page.line((x, y), (end, y), 2.0, INK);
    page.line((x, y - 4.0), (x, y + 4.0), 2.0, INK);
    page.line((end, y - 4.0), (end, y + 4.0), 2.0, INK);
    page.text((0.5 * (x + end), y - 8.0), SMALL, Anchor::Centre, &quantity(length, "m"));
}

/// The directions of the axes, where the view is along none of them.
fn triad(page: &mut Page, scene: &Scene, (x, y): (f64, f64)) {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut unit = [0.0; 3];
        unit[axis] = 1.0;
        let [right, up, _] = scene.projection.apply(unit);
        let at = |length: f64| (x + length * right, y - length * up);
        page.line((x, y), at(26.0), 1.6, INK);
        let (tx, ty) = at(36.0);
        page.text((tx, ty + 0.3 * SMALL), SMALL, Anchor::Centre, name);
    }
}
