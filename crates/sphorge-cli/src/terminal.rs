//! Writing to the terminal without ever panicking: a reader that goes away (`sphorge materials | head -1`) is no error.

use crate::failure::Failure;
use miette::{IntoDiagnostic, Report, WrapErr};
use std::io::{self, Write};

/// Prints text to standard output.
///
/// # Errors
/// Anything but a closed pipe, such as a full disk behind a redirection.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Failed(
            Err::<(), _>(error).into_diagnostic().wrap_err("cannot write to standard output").unwrap_err(),
        )),
        _ => Ok(()),
    }
}

/// Prints a line to standard error; there is nobody left to tell if that fails.
pub(crate) fn note(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Prints a diagnostic to standard error.
pub(crate) fn report(report: &Report) {
    let _ = write!(io::stderr(), "{report:?}");
}

/// A value as readable JSON.
///
/// # Errors
/// It cannot be written as JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).into_diagnostic().wrap_err("cannot write JSON").map_err(Failure::Failed)
}
