//! A page as pixels.

use super::{
    PlotError,
    color::Rgb,
    font,
    page::{Image, Item, Page, Text},
};
use skrifa::outline::OutlinePen;
use tiny_skia::{Color, FillRule, LineCap, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

/// Pixels in rows, the upper left first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgb: Vec<Rgb>,
}

impl Pixels {
    /// Draws a page.
    pub(super) fn of(page: &Page) -> Result<Self, PlotError> {
        let [width, height] = page.pixels().map(|side| side as u32);
        let mut pixmap = Pixmap::new(width, height).ok_or(PlotError::Size { width, height })?;
        pixmap.fill(Color::WHITE);
        let scale = page.paper.scale();
        for item in &page.items {
            draw(&mut pixmap, item, scale);
        }
        let rgb = pixmap.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
        Ok(Self { width, height, rgb })
    }

    /// A PNG file of them: without filter or with, whichever is smaller. Flat colours are smaller without, shades with.
    pub(super) fn png(&self, dpi: u32) -> Result<Vec<u8>, PlotError> {
        let packed = |filter: png::Filter| -> Result<Vec<u8>, PlotError> {
            let mut bytes = Vec::new();
            let mut encoder = encoder(&mut bytes, self.width, self.height, dpi);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_filter(filter);
            encoder.write_header()?.write_image_data(self.rgb.as_flattened())?;
            Ok(bytes)
        };
        let (plain, filtered) = (packed(png::Filter::NoFilter)?, packed(png::Filter::Adaptive)?);
        Ok(if plain.len() < filtered.len() { plain } else { filtered })
    }
}

/// An encoder of pictures that know their printed size.
pub(super) fn encoder(bytes: &mut Vec<u8>, width: u32, height: u32, dpi: u32) -> png::Encoder<'_, &mut Vec<u8>> {
    let mut encoder = png::Encoder::new(bytes, width, height);
    let per_meter = (f64::from(dpi) / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_meter, yppu: per_meter, unit: png::Unit::Meter }));
    encoder.set_depth(png::BitDepth::Eight);
    encoder
}

fn draw(pixmap: &mut Pixmap, item: &Item, scale: f64) {
    let transform = Transform::from_scale(scale as f32, scale as f32);
    match item {
        Item::Line { points, width, color, dashed } => {
            let Some(path) = path(points, false) else { return };
            let stroke = Stroke {
                width: *width as f32,
                line_join: tiny_skia::LineJoin::Round,
                line_cap: if *dashed { LineCap::Butt } else { LineCap::Round },
                dash: if *dashed { StrokeDash::new(vec![9.0, 6.0], 0.0) } else { None },
                ..Stroke::default()
            };
            pixmap.stroke_path(&path, &paint(*color), &stroke, transform, None);
        }
        Item::Polygon { points, color } => {
            if let Some(path) = path(points, true) {
                pixmap.fill_path(&path, &paint(*color), FillRule::Winding, transform, None);
            }
        }
        Item::Text(text) => write(pixmap, text, scale),
        Item::Image(image) => lay(pixmap, image, scale),
    }
}

fn path(points: &[(f64, f64)], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (k, &(x, y)) in points.iter().enumerate() {
        if k == 0 { path.move_to(x as f32, y as f32) } else { path.line_to(x as f32, y as f32) }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn paint(color: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(color[0], color[1], color[2], 255);
    paint.anti_alias = true;
    paint
}

fn write(pixmap: &mut Pixmap, text: &Text, scale: f64) {
    let at = ((text.at.0 * scale) as f32, (text.at.1 * scale) as f32);
    let mut pen = Pen { path: PathBuilder::new(), at, is_upwards: text.upwards };
    font::draw(&text.text, text.size * scale, &mut pen);
    // A text of spaces has no outline.
    if let Some(path) = pen.path.finish() {
        pixmap.fill_path(&path, &paint(text.color), FillRule::Winding, Transform::identity(), None);
    }
}

/// Outlines of glyphs as a path on the page, whose second axis points down.
struct Pen {
    path: PathBuilder,
    at: (f32, f32),
    is_upwards: bool,
}

impl Pen {
    /// Where a point is that lies so far along the line of the text, and above it.
    fn place(&self, along: f32, above: f32) -> (f32, f32) {
        let (x, y) = self.at;
        if self.is_upwards { (x - above, y - along) } else { (x + along, y - above) }
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }
    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let ((cx, cy), (x, y)) = (self.place(cx, cy), self.place(x, y));
        self.path.quad_to(cx, cy, x, y);
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let ((ax, ay), (bx, by), (x, y)) = (self.place(ax, ay), self.place(bx, by), self.place(x, y));
        self.path.cubic_to(ax, ay, bx, by, x, y);
    }
    fn close(&mut self) {
        self.path.close();
    }
}

fn blend(pixmap: &mut Pixmap, (x, y): (i64, i64), color: Rgb, coverage: f32) {
    let (width, height) = (i64::from(pixmap.width()), i64::from(pixmap.height()));
    if !(0..width).contains(&x) || !(0..height).contains(&y) {
        return;
    }
    let pixel = &mut pixmap.pixels_mut()[(y * width + x) as usize];
    let mix = |under: u8, over: u8| {
        (f32::from(under) + coverage.clamp(0.0, 1.0) * (f32::from(over) - f32::from(under))).round() as u8
    };
    let mixed = [mix(pixel.red(), color[0]), mix(pixel.green(), color[1]), mix(pixel.blue(), color[2])];
    if let Some(mixed) = tiny_skia::PremultipliedColorU8::from_rgba(mixed[0], mixed[1], mixed[2], 255) {
        *pixel = mixed;
    }
}

/// Lays an image on the page, each pixel taking the nearest point of it.
fn lay(pixmap: &mut Pixmap, image: &Image, scale: f64) {
    let (left, top) = ((image.area.x * scale).round(), (image.area.y * scale).round());
    let (width, height) = ((image.area.width * scale).round(), (image.area.height * scale).round());
    let nearest = |k: usize, of: f64, count: usize| (((k as f64 + 0.5) / of * count as f64) as usize).min(count - 1);
    if image.columns == 0 || image.rows == 0 {
        return;
    }
    for row in 0..height as usize {
        for column in 0..width as usize {
            let at = nearest(row, height, image.rows) * image.columns + nearest(column, width, image.columns);
            let [r, g, b, opacity] = image.pixels[at];
            if opacity > 0 {
                let place = (left as i64 + column as i64, top as i64 + row as i64);
                blend(pixmap, place, [r, g, b], f32::from(opacity) / 255.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{
        page::{Anchor, Area},
        paper::Paper,
    };

    #[test]
    fn text_is_drawn_where_it_is_anchored_at_any_fineness() {
        for (dpi, scale) in [(100, 1), (300, 3)] {
            let mut page = Page::new(200.0, 100.0, Paper { dpi, width: None }).unwrap();
            page.text((150.0, 60.0), 40.0, Anchor::Right, "Wg");
            let area = page.texts().next().unwrap().area();
            let pixels = Pixels::of(&page).unwrap();
            assert_eq!((pixels.width, pixels.height), (200 * scale, 100 * scale));
            let dark = |x: u32, y: u32| pixels.rgb[(y * pixels.width + x) as usize][0] < 128;
            let columns: Vec<u32> = (0..pixels.width).filter(|&x| (0..pixels.height).any(|y| dark(x, y))).collect();
            let rows: Vec<u32> = (0..pixels.height).filter(|&y| (0..pixels.width).any(|x| dark(x, y))).collect();
            let inside = |k: u32, from: f64, to: f64| (from..=to).contains(&(f64::from(k) / f64::from(scale)));
            assert!(columns.iter().all(|&x| inside(x, area.x - 1.0, area.right() + 1.0)), "{columns:?}");
            assert!(rows.iter().all(|&y| inside(y, area.y - 1.0, area.bottom() + 1.0)), "{rows:?}");
            // A capital reaches 0.73 em above the baseline, the g 0.21 em below.
            assert!(rows[0].abs_diff(scale * (60 - 29)) <= scale && rows[rows.len() - 1].abs_diff(scale * 68) <= scale);
        }
    }

    #[test]
    fn images_cover_their_area_and_leave_what_is_clear() {
        let mut page = Page::new(20.0, 10.0, Paper::default()).unwrap();
        let area = Area { x: 2.0, y: 3.0, width: 4.0, height: 2.0 };
        page.image(Image { area, columns: 2, rows: 1, pixels: vec![[9, 8, 7, 255], [0, 0, 0, 0]] });
        let pixels = Pixels::of(&page).unwrap();
        let set: Vec<_> = (0..200).filter(|&k| pixels.rgb[k] == [9, 8, 7]).map(|k| (k % 20, k / 20)).collect();
        assert_eq!(set, [(2, 3), (3, 3), (2, 4), (3, 4)]);
        assert_eq!(pixels.rgb.iter().filter(|p| **p == [255; 3]).count(), 196);
        let png = pixels.png(300).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        assert_eq!(reader.info().pixel_dims.unwrap().xppu, 11_811);
    }
}
