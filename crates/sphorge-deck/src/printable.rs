//! Text of a user as it can be shown.

use std::borrow::Cow;

/// Longest text that is shown, in characters.
const LONGEST: usize = 800;

/// Text of a user within a sentence: what would break the line, move the cursor or turn the direction of a terminal is written out, and what
/// no one would read is cut.
pub(crate) fn printable(text: &str) -> Cow<'_, str> {
    let text = text.char_indices().nth(LONGEST).map_or(text, |(end, _)| &text[..end]);
    if is_printable(text) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if moves_the_cursor(c) { c.escape_default().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(shown).collect())
}

/// Whether a text can be shown as it is.
pub(crate) fn is_printable(text: &str) -> bool {
    !text.chars().any(moves_the_cursor)
}

/// Whether a character of a text would do something to a terminal: controls, and marks that turn the direction of what follows.
pub fn moves_the_cursor(c: char) -> bool {
    c.is_control() || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The same for a text of lines that labels point into: every byte stays in its place.
pub(crate) fn printable_in_place(text: &str) -> Option<String> {
    let mut rest = text.chars().peekable();
    let mut is_changed = false;
    let mut shown = String::with_capacity(text.len());
    while let Some(c) = rest.next() {
        let ends_a_line = c == '\n' || c == '\r' && rest.peek() == Some(&'\n');
        if ends_a_line || c == '\t' || !moves_the_cursor(c) {
            shown.push(c);
            continue;
        }
        is_changed = true;
        shown.push(['?', '\u{b7}', '\u{fffd}'][c.len_utf8() - 1]);
    }
    is_changed.then_some(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_move_the_cursor_is_written_out_and_keeps_its_place() {
        assert_eq!(printable("a\u{1b}[2J\rb\u{202e}"), "a\\u{1b}[2J\\rb\\u{202e}");
        let text = "a\r\n\u{1b}\u{85}\u{202e}\rb\t";
        let shown = printable_in_place(text).unwrap();
        assert_eq!(shown, "a\r\n?\u{b7}\u{fffd}?b\t");
        assert_eq!(shown.len(), text.len());
        assert_eq!(printable_in_place("plain\r\n\ttext"), None);
    }
}
