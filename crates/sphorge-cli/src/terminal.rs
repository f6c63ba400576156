//! Writing to the terminal without ever panicking: a reader that goes away (`sphorge materials | head -1`) is no error.

use crate::failure::Failure;
use miette::{IntoDiagnostic, Report, WrapErr};
use sphorge::deck::moves_the_cursor;
use std::{
    borrow::Cow,
    io::{self, IsTerminal, Write},
};

/// Prints text to standard output.
///
/// # Errors
/// Anything but a closed pipe, such as a full disk behind a redirection.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    // Files and pipes get the text as it is.
    let shown = if out.is_terminal() { Cow::Owned(plain(text)) } else { Cow::Borrowed(text) };
    match out.write_all(shown.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Failed(
            Err::<(), _>(error).into_diagnostic().wrap_err("cannot write to standard output").unwrap_err(),
        )),
        _ => Ok(()),
    }
}

/// Prints a line to standard error; there is nobody left to tell if that fails.
pub(crate) fn note(line: &str) {
    let _ = writeln!(io::stderr(), "{}", plain(line));
}

/// Prints a diagnostic to standard error.
pub(crate) fn report(report: &Report) {
    let _ = write!(io::stderr(), "{}", plain(&format!("{report:?}")));
}

/// The text with a mark for every control character but the ends of lines and what sets colours: names of files, and what is told of
/// damaged ones, may hold some that move the cursor.
fn plain(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = color_length(rest).unwrap_or(c.len_utf8());
        let is_plain = length > c.len_utf8() || c == '\n' || !moves_the_cursor(c);
        shown.push_str(if is_plain { &rest[..length] } else { "\u{fffd}" });
        rest = &rest[length..];
    }
    shown
}

/// Bytes of the sequence that sets a colour or a style, if the text begins with one.
fn color_length(text: &str) -> Option<usize> {
    let numbers = text.strip_prefix("\u{1b}[")?;
    let end = numbers.find(|c: char| !c.is_ascii_digit() && c != ';')?;
    numbers[end..].starts_with('m').then_some(2 + end + 1)
}

/// A value as readable JSON.
///
/// # Errors
/// It cannot be written as JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).into_diagnostic().wrap_err("cannot write JSON").map_err(Failure::Failed)
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn colours_stay_and_what_moves_the_cursor_does_not() {
        let text = "\u{1b}[1;31mred\u{1b}[0m\n\u{1b}[2J\r\u{7}\u{202e}é\u{1b}";
        assert_eq!(plain(text), "\u{1b}[1;31mred\u{1b}[0m\n\u{fffd}[2J\u{fffd}\u{fffd}\u{fffd}é\u{fffd}");
    }
}
