//! The embedded font: how wide a text is, and where its lines break.

use ab_glyph::{Font, FontRef, Glyph, PxScale, point};
use std::sync::OnceLock;

/// Height of a line of text above its baseline, in sizes.
pub(super) const ASCENT: f64 = 0.76;
/// Depth below it.
#[cfg(test)]
pub(super) const DESCENT: f64 = 0.24;
/// From baseline to baseline, in sizes.
pub(super) const LEADING: f64 = 1.3;

pub(super) fn font() -> &'static FontRef<'static> {
    static FONT: OnceLock<FontRef<'static>> = OnceLock::new();
    FONT.get_or_init(|| {
        FontRef::try_from_slice(include_bytes!("../../assets/DejaVuSans.ttf")).expect("the embedded font is a font")
    })
}

/// How far the pen goes for a character, in sizes.
fn advance(character: char) -> f64 {
    // Texts are measured far more often than drawn: most characters are looked up once.
    static COMMON: OnceLock<Vec<f64>> = OnceLock::new();
    let look_up = |character: char| {
        let font = font();
        f64::from(font.h_advance_unscaled(font.glyph_id(character)) / font.units_per_em().unwrap_or(1000.0))
    };
    let common = COMMON.get_or_init(|| ('\0'..'\u{100}').map(look_up).collect());
    common.get(character as usize).copied().unwrap_or_else(|| look_up(character))
}

/// Glyphs from a pen at the origin.
pub(super) fn glyphs(text: &str, size: f64) -> Vec<Glyph> {
    let font = font();
    // `size` is that of the em square; the crate scales by ascent plus descent.
    let height = font.height_unscaled() / font.units_per_em().unwrap_or(1000.0);
    let scale = PxScale::from(size as f32 * height);
    let mut pen = 0.0;
    let place = |character: char| {
        let glyph = font.glyph_id(character).with_scale_and_position(scale, point(pen as f32, 0.0));
        pen += size * advance(character);
        glyph
    };
    text.chars().map(place).collect()
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
