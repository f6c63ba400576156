//! A white page: what is drawn on it in the order it is drawn, before it becomes pixels or SVG.

use super::{PlotError, color::Rgb, font::text_width, paper::Paper};

pub(super) const INK: Rgb = [38, 38, 38];
pub(super) const FRAME: Rgb = [110, 110, 110];
pub(super) const GRID: Rgb = [226, 226, 226];
pub(super) const WHITE: Rgb = [255, 255, 255];

/// Size of the texts of titles and names, and of numbers.
pub(super) const TEXT: f64 = 15.0;
pub(super) const SMALL: f64 = 13.0;
/// Along the edges of a page.
pub(super) const MARGIN: f64 = 16.0;

/// Most pixels along a side.
const MOST_PIXELS: f64 = 20_000.0;

/// Which point of a text is at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
}

/// A rectangle on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Area {
    pub(super) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub(super) fn contains(&self, (x, y): (f64, f64)) -> bool {
        (self.x..=self.right()).contains(&x) && (self.y..=self.bottom()).contains(&y)
    }

    /// Whether two rectangles share more than an edge.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.x < other.right() && other.x < self.right() && self.y < other.bottom() && other.y < self.bottom()
    }
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Text {
    /// Left end of the baseline; of a text upwards, its lower end.
    pub(super) at: (f64, f64),
    pub(super) width: f64,
    pub(super) size: f64,
    pub(super) color: Rgb,
    pub(super) text: String,
    /// From the bottom to the top of the page.
    pub(super) upwards: bool,
}

#[cfg(test)]
impl Text {
    /// The rectangle the line takes.
    pub(super) fn area(&self) -> Area {
        use super::font::{ASCENT, DESCENT};
        let ((x, y), width) = (self.at, self.width);
        let (above, height) = (ASCENT * self.size, (ASCENT + DESCENT) * self.size);
        if self.upwards {
            Area { x: x - above, y: y - width, width: height, height: width }
        } else {
            Area { x, y: y - above, width, height }
        }
    }
}

/// Points of colour in rows, the upper left first; the last number is opacity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Image {
    pub(super) area: Area,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) pixels: Vec<[u8; 4]>,
}

/// Something drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    Line { points: Vec<(f64, f64)>, width: f64, color: Rgb, dashed: bool },
    Polygon { points: Vec<(f64, f64)>, color: Rgb },
    Text(Text),
    Image(Image),
}

/// A page in units of a hundredth of an inch; the origin is the upper left corner.
#[derive(Clone, Debug)]
pub(super) struct Page {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) paper: Paper,
    pub(super) items: Vec<Item>,
}

impl Page {
    /// A white page.
    ///
    /// # Errors
    /// [`PlotError::Size`] for a page without pixels or larger than 20 000 pixels a side.
    pub(super) fn new(width: f64, height: f64, paper: Paper) -> Result<Self, PlotError> {
        let page = Self { width, height, paper, items: Vec::new() };
        let [across, down] = page.pixels();
        if across.min(down) >= 1.0 && across.max(down) <= MOST_PIXELS {
            Ok(page)
        } else {
            Err(PlotError::Size { width: across as u32, height: down as u32 })
        }
    }

    /// Pixels across and down.
    pub(super) fn pixels(&self) -> [f64; 2] {
        [self.width, self.height].map(|side| (side * self.paper.scale()).round())
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), width: f64, color: Rgb) {
        self.polyline(vec![from, to], width, color);
    }

    pub(super) fn polyline(&mut self, points: Vec<(f64, f64)>, width: f64, color: Rgb) {
        self.items.push(Item::Line { points, width, color, dashed: false });
    }

    pub(super) fn dashed(&mut self, points: Vec<(f64, f64)>, width: f64, color: Rgb) {
        self.items.push(Item::Line { points, width, color, dashed: true });
    }

    pub(super) fn polygon(&mut self, points: Vec<(f64, f64)>, color: Rgb) {
        self.items.push(Item::Polygon { points, color });
    }

    pub(super) fn fill(&mut self, area: Area, color: Rgb) {
        self.polygon(corners(area), color);
    }

    pub(super) fn outline(&mut self, area: Area, width: f64, color: Rgb) {
        let mut points = corners(area);
        points.push(points[0]);
        self.polyline(points, width, color);
    }

    pub(super) fn image(&mut self, image: Image) {
        self.items.push(Item::Image(image));
    }

    /// Writes `text` with its baseline at `y`.
    pub(super) fn text(&mut self, (x, y): (f64, f64), size: f64, anchor: Anchor, text: &str) {
        let width = text_width(text, size);
        let shift = match anchor {
            Anchor::Left => 0.0,
            Anchor::Centre => -0.5 * width,
            Anchor::Right => -width,
        };
        let at = (x + shift, y);
        self.items.push(Item::Text(Text { at, width, size, color: INK, text: text.to_owned(), upwards: false }));
    }

    /// Writes `text` from the bottom to the top, centred at `y`, with its baseline at `x`.
    pub(super) fn text_upwards(&mut self, (x, y): (f64, f64), size: f64, text: &str) {
        let width = text_width(text, size);
        let at = (x, y + 0.5 * width);
        self.items.push(Item::Text(Text { at, width, size, color: INK, text: text.to_owned(), upwards: true }));
    }

    /// The texts on the page.
    #[cfg(test)]
    pub(super) fn texts(&self) -> impl Iterator<Item = &Text> {
        self.items.iter().filter_map(|item| match item {
            Item::Text(text) => Some(text),
            Item::Line { .. } | Item::Polygon { .. } | Item::Image(_) => None,
        })
    }
}

fn corners(area: Area) -> Vec<(f64, f64)> {
    let (right, bottom) = (area.right(), area.bottom());
    vec![(area.x, area.y), (right, area.y), (right, bottom), (area.x, bottom)]
}

/// What is wrong with the texts of a page: none may leave it or cover another.
#[cfg(test)]
pub(super) fn misplaced(page: &Page) -> Vec<String> {
    let texts: Vec<_> = page.texts().map(|text| (text.text.as_str(), text.area())).collect();
    let mut faults = Vec::new();
    for (k, (text, area)) in texts.iter().enumerate() {
        if area.x < 0.0 || area.y < 0.0 || area.right() > page.width || area.bottom() > page.height {
            faults.push(format!("`{text}` at {area:?} leaves the page of {} x {}", page.width, page.height));
        }
        for (other, at) in &texts[..k] {
            if area.meets(at) {
                faults.push(format!("`{text}` at {area:?} covers `{other}` at {at:?}"));
            }
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_of_no_or_absurd_size_is_an_error() {
        let paper = Paper::default();
        assert!(Page::new(0.0, 10.0, paper).is_err() && Page::new(100.0, 3e9, paper).is_err());
        assert!(Page::new(10_000.0, 100.0, paper).is_ok());
        assert!(Page::new(10_000.0, 100.0, Paper { dpi: 300, ..paper }).is_err());
    }

    #[test]
    fn texts_that_leave_the_page_or_meet_are_found() {
        let mut page = Page::new(100.0, 50.0, Paper::default()).unwrap();
        page.text((10.0, 20.0), 10.0, Anchor::Left, "one");
        page.text_upwards((90.0, 25.0), 10.0, "two");
        assert!(misplaced(&page).is_empty());
        page.text((20.0, 22.0), 10.0, Anchor::Left, "three");
        page.text((5.0, 40.0), 10.0, Anchor::Centre, "four");
        assert_eq!(misplaced(&page).len(), 2);
    }
}
