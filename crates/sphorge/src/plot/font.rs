//! The embedded font: how wide a text is, and where its lines break.

use skrifa::{
    FontRef, GlyphId, MetadataProvider,
    instance::{LocationRef, Size},
    outline::{DrawSettings, OutlinePen},
};
use std::sync::OnceLock;

/// Height of a line of text above its baseline, in sizes.
pub(super) const ASCENT: f64 = 0.76;
/// Depth below it.
#[cfg(test)]
pub(super) const DESCENT: f64 = 0.24;
/// From baseline to baseline, in sizes.
pub(super) const LEADING: f64 = 1.3;

fn font() -> &'static FontRef<'static> {
    static FONT: OnceLock<FontRef<'static>> = OnceLock::new();
    FONT.get_or_init(|| {
        FontRef::new(include_bytes!("../../assets/DejaVuSans.ttf")).expect("the embedded font is a font")
    })
}

/// The glyph of a character; a box where the font has none.
fn glyph(character: char) -> GlyphId {
    font().charmap().map(character).unwrap_or_default()
}

/// How far the pen goes for a character, in sizes.
fn advance(character: char) -> f64 {
    // Texts are measured far more often than drawn: most characters are looked up once.
    static COMMON: OnceLock<Vec<f64>> = OnceLock::new();
    let look_up = |character: char| {
        let (font, place) = (font(), LocationRef::default());
        let advance = font.glyph_metrics(Size::unscaled(), place).advance_width(glyph(character)).unwrap_or_default();
        f64::from(advance) / f64::from(font.metrics(Size::unscaled(), place).units_per_em)
    };
    let common = COMMON.get_or_init(|| ('\0'..'\u{100}').map(look_up).collect());
    common.get(character as usize).copied().unwrap_or_else(|| look_up(character))
}

/// Draws the outlines of a text from the origin on: along its line, and up.
pub(super) fn draw(text: &str, size: f64, pen: &mut impl OutlinePen) {
    let outlines = font().outline_glyphs();
    let mut along = 0.0;
    for character in text.chars() {
        if let Some(outline) = outlines.get(glyph(character)) {
            let settings = DrawSettings::unhinted(Size::new(size as f32), LocationRef::default());
            // The font is part of the program: its outlines can be drawn.
            let _ = outline.draw(settings, &mut Moved { pen, along: along as f32 });
        }
        along += size * advance(character);
    }
}

/// Draws farther along the line.
struct Moved<'a, P> {
    pen: &'a mut P,
    along: f32,
}

impl<P: OutlinePen> OutlinePen for Moved<'_, P> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.pen.move_to(x + self.along, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.pen.line_to(x + self.along, y);
    }
    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.pen.quad_to(cx + self.along, cy, x + self.along, y);
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.pen.curve_to(ax + self.along, ay, bx + self.along, by, x + self.along, y);
    }
    fn close(&mut self) {
        self.pen.close();
    }
}

/// Width of a text, in the unit of its size.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    size * text.chars().map(advance).sum::<f64>()
}

/// Width of the widest of some texts.
pub(super) fn widest<'a>(texts: impl IntoIterator<Item = &'a String>, size: f64) -> f64 {
    texts.into_iter().map(|text| text_width(text, size)).fold(0.0, f64::max)
}

/// Breaks a text into lines no wider than `width`: between words, and within a word that is wider by itself. A line holds
/// one character at least.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // What a no-break space joins stays together.
    let words = text.split(|c: char| c.is_whitespace() && c != '\u{a0}');
    for word in words.filter(|word| !word.is_empty()) {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match (longer.filter(|line| text_width(line, size) <= width), lines.last_mut()) {
            (Some(longer), Some(line)) => *line = longer,
            _ => lines.extend(pieces(word, size, width)),
        }
    }
    lines
}

/// A word in pieces that fit.
fn pieces(word: &str, size: f64, width: f64) -> Vec<String> {
    if text_width(word, size) <= width {
        return vec![word.to_owned()];
    }
    let mut pieces = vec![String::new()];
    for character in word.chars() {
        let last = pieces.len() - 1;
        let longer = format!("{}{character}", pieces[last]);
        if pieces[last].is_empty() || text_width(&longer, size) <= width {
            pieces[last] = longer;
        } else {
            pieces.push(character.to_string());
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_breaks_between_words_and_within_those_that_are_too_wide() {
        assert_eq!(wrap("one two three", 10.0, text_width("one two", 10.0) + 0.1), ["one two", "three"]);
        let width = text_width("measure", 10.0) + 0.1;
        let lines = wrap("a measure_of_great_length", 10.0, width);
        assert!(lines.len() > 3 && lines.iter().all(|line| text_width(line, 10.0) <= width), "{lines:?}");
        assert_eq!(wrap("ab", 10.0, 1.0), ["a", "b"]);
        assert_eq!(wrap("t =\u{a0}5 s", 10.0, text_width("t =5", 10.0)).join("|"), "t|=\u{a0}5|s");
        assert!(wrap("", 10.0, 1.0).is_empty());
    }
}
