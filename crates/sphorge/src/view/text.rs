//! Errors in words, for the page.

use super::ViewError;
use miette::Diagnostic;

/// What went wrong, what caused it, and what to do.
pub(super) fn explained(error: &ViewError) -> String {
    let mut text = error.to_string();
    let mut cause = std::error::Error::source(error);
    while let Some(source) = cause {
        text.push_str(&format!(": {source}"));
        cause = source.source();
    }
    match error.help() {
        Some(help) => format!("{text} ({help})"),
        None => text,
    }
}
