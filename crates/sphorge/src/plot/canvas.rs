//! A white page to draw on: smooth lines, filled shapes, text in the embedded font.

use super::{PlotError, color::Rgb};
use crate::output::{Durability, write_file};
use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use std::{path::Path, sync::OnceLock};
use tiny_skia::{
    Color, FillRule, LineCap, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Rect, Stroke, StrokeDash, Transform,
};

pub(super) const INK: Rgb = [38, 38, 38];
pub(super) const FRAME: Rgb = [110, 110, 110];
pub(super) const GRID: Rgb = [226, 226, 226];

/// Which point of a text is at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
}

/// A page of pixels; the origin is the upper left corner.
pub(super) struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// A white page.
    ///
    /// # Errors
    /// [`PlotError::Size`] for a page without pixels or larger than 20 000 pixels a side.
    pub(super) fn new(width: u32, height: u32) -> Result<Self, PlotError> {
        let pixmap = Some((width, height)).filter(|_| width.max(height) <= 20_000).and_then(|(w, h)| Pixmap::new(w, h));
        let mut pixmap = pixmap.ok_or(PlotError::Size { width, height })?;
        pixmap.fill(Color::WHITE);
        Ok(Self { pixmap })
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), width: f64, color: Rgb) {
        self.polyline(&[from, to], width, color);
    }

    pub(super) fn polyline(&mut self, points: &[(f64, f64)], width: f64, color: Rgb) {
        self.stroke(points, width, color, None);
    }

    pub(super) fn dashed(&mut self, points: &[(f64, f64)], width: f64, color: Rgb) {
        self.stroke(points, width, color, StrokeDash::new(vec![9.0, 6.0], 0.0));
    }

    fn stroke(&mut self, points: &[(f64, f64)], width: f64, color: Rgb, dash: Option<StrokeDash>) {
        let mut path = PathBuilder::new();
        for (k, &(x, y)) in points.iter().enumerate() {
            if k == 0 { path.move_to(x as f32, y as f32) } else { path.line_to(x as f32, y as f32) }
        }
        let Some(path) = path.finish() else { return };
        let stroke = Stroke {
            width: width as f32,
            line_join: tiny_skia::LineJoin::Round,
            line_cap: if dash.is_some() { LineCap::Butt } else { LineCap::Round },
            dash,
            ..Stroke::default()
        };
        self.pixmap.stroke_path(&path, &paint(color), &stroke, Transform::identity(), None);
    }

    pub(super) fn polygon(&mut self, points: &[(f64, f64)], color: Rgb) {
        let mut path = PathBuilder::new();
        for (k, &(x, y)) in points.iter().enumerate() {
            if k == 0 { path.move_to(x as f32, y as f32) } else { path.line_to(x as f32, y as f32) }
        }
        path.close();
        if let Some(path) = path.finish() {
            self.pixmap.fill_path(&path, &paint(color), FillRule::Winding, Transform::identity(), None);
        }
    }

    pub(super) fn fill(&mut self, area: Area, color: Rgb) {
        if let Some(rect) = Rect::from_xywh(area.x as f32, area.y as f32, area.width as f32, area.height as f32) {
            self.pixmap.fill_rect(rect, &paint(color), Transform::identity(), None);
        }
    }

    pub(super) fn outline(&mut self, area: Area, width: f64, color: Rgb) {
        let (x0, y0, x1, y1) = (area.x, area.y, area.x + area.width, area.y + area.height);
        self.polyline(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)], width, color);
    }

    /// Sets one pixel; pixels outside are ignored.
    pub(super) fn set(&mut self, x: u32, y: u32, [r, g, b]: Rgb) {
        let width = self.pixmap.width();
        if x < width
            && let Some(pixel) = self.pixmap.pixels_mut().get_mut((y * width + x) as usize)
            && let Some(color) = PremultipliedColorU8::from_rgba(r, g, b, 255)
        {
            *pixel = color;
        }
    }

    /// Writes `text` with its baseline at `y`.
    pub(super) fn text(&mut self, (x, y): (f64, f64), size: f64, anchor: Anchor, color: Rgb, text: &str) {
        let (glyphs, width) = layout(text, size);
        let shift = match anchor {
            Anchor::Left => 0.0,
            Anchor::Centre => -0.5 * width,
            Anchor::Right => -width,
        };
        for mut glyph in glyphs {
            glyph.position.x += (x + shift) as f32;
            glyph.position.y += y as f32;
            let Some(outline) = font().outline_glyph(glyph) else { continue };
            let bounds = outline.px_bounds();
            outline.draw(|dx, dy, coverage| {
                self.blend(bounds.min.x as i64 + i64::from(dx), bounds.min.y as i64 + i64::from(dy), color, coverage);
            });
        }
    }

    /// Writes `text` from the bottom to the top, centred at `y`, with its baseline at `x`.
    pub(super) fn text_upwards(&mut self, (x, y): (f64, f64), size: f64, color: Rgb, text: &str) {
        let (glyphs, width) = layout(text, size);
        for glyph in glyphs {
            let Some(outline) = font().outline_glyph(glyph) else { continue };
            let bounds = outline.px_bounds();
            let (x, y) = (x.round() as i64, (y + 0.5 * width).round() as i64);
            outline.draw(|dx, dy, coverage| {
                let (along, across) = (bounds.min.x as i64 + i64::from(dx), bounds.min.y as i64 + i64::from(dy));
                self.blend(x + across, y - along, color, coverage);
            });
        }
    }

    /// Width of a text in pixels.
    pub(super) fn text_width(text: &str, size: f64) -> f64 {
        layout(text, size).1
    }

    fn blend(&mut self, x: i64, y: i64, color: Rgb, coverage: f32) {
        let (width, height) = (i64::from(self.pixmap.width()), i64::from(self.pixmap.height()));
        if !(0..width).contains(&x) || !(0..height).contains(&y) {
            return;
        }
        let under = self.pixmap.pixels()[(y * width + x) as usize];
        let mix =
            |under: u8, over: u8| (f32::from(under) + coverage.min(1.0) * (f32::from(over) - f32::from(under))) as u8;
        self.set(
            x as u32,
            y as u32,
            [mix(under.red(), color[0]), mix(under.green(), color[1]), mix(under.blue(), color[2])],
        );
    }

    /// Writes the page as PNG, complete or not at all. Missing folders are made.
    pub(super) fn save(&self, path: &Path) -> Result<(), PlotError> {
        let bytes = self.pixmap.encode_png().map_err(|e| PlotError::Encode { reason: e.to_string() })?;
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)
                .map_err(|source| PlotError::Output(crate::output::OutputError::Write { path: path.into(), source }))?;
        }
        Ok(write_file(path, Durability::Process, |out| out.write_all(&bytes))?)
    }
}

/// A rectangle on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

fn paint(color: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(color[0], color[1], color[2], 255);
    paint.anti_alias = true;
    paint
}

fn font() -> &'static FontRef<'static> {
    static FONT: OnceLock<FontRef<'static>> = OnceLock::new();
    FONT.get_or_init(|| {
        FontRef::try_from_slice(include_bytes!("../../assets/DejaVuSans.ttf")).expect("the embedded font is a font")
    })
}

/// Glyphs from a pen at the origin, and how far the pen went.
fn layout(text: &str, size: f64) -> (Vec<Glyph>, f64) {
    let font = font();
    // `size` is that of the em square; the crate scales by ascent plus descent.
    let height = font.height_unscaled() / font.units_per_em().unwrap_or(1000.0);
    let scale = PxScale::from(size as f32 * height);
    let scaled = font.as_scaled(scale);
    let mut pen = 0.0;
    let mut glyphs = Vec::with_capacity(text.len());
    let mut last = None;
    for character in text.chars() {
        let id = font.glyph_id(character);
        if let Some(last) = last {
            pen += scaled.kern(last, id);
        }
        glyphs.push(id.with_scale_and_position(scale, point(pen, 0.0)));
        pen += scaled.h_advance(id);
        last = Some(id);
    }
    (glyphs, f64::from(pen))
}

/// Breaks a text into lines no wider than `width`, between words.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match longer.filter(|line| Canvas::text_width(line, size) <= width) {
            Some(line) => *lines.last_mut().expect("a line was made longer") = line,
            None => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_drawn_where_it_is_anchored() {
        let width = Canvas::text_width("Wg", 40.0);
        let mut canvas = Canvas::new(200, 100).unwrap();
        canvas.text((150.0, 60.0), 40.0, Anchor::Right, INK, "Wg");
        let dark = |x: u32, y: u32| canvas.pixmap.pixel(x, y).unwrap().red() < 128;
        let columns: Vec<u32> = (0..200).filter(|&x| (0..100).any(|y| dark(x, y))).collect();
        let rows: Vec<u32> = (0..100).filter(|&y| (0..200).any(|x| dark(x, y))).collect();
        assert!(columns[0] as f64 >= 149.0 - width && *columns.last().unwrap() < 151);
        // A capital reaches 0.73 em above the baseline, the g 0.21 em below.
        assert!(rows[0].abs_diff(60 - 29) <= 1 && rows.last().unwrap().abs_diff(60 + 8) <= 1, "{rows:?}");
    }

    #[test]
    fn wrapping_breaks_between_words() {
        assert_eq!(wrap("one two three", 10.0, Canvas::text_width("one two", 10.0) + 0.1), ["one two", "three"]);
        assert_eq!(wrap("unbreakable", 10.0, 1.0), ["unbreakable"]);
        assert!(wrap("", 10.0, 1.0).is_empty());
    }

    #[test]
    fn a_page_of_no_or_absurd_size_is_an_error() {
        assert!(Canvas::new(0, 10).is_err() && Canvas::new(100, 3_000_000_000).is_err());
    }
}
