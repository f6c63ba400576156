//! What can go wrong with showing a run.

use crate::{number::quantity, output::OutputError, plot::PlotError};
use std::{io, path::PathBuf};

/// Why a run cannot be shown.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ViewError {
    /// A file of the run cannot be read, or the page cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// The run has no such field, body, column or frame.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Plot(#[from] PlotError),
    /// The port is taken, or not allowed.
    #[error("cannot listen on port {port} of 127.0.0.1")]
    #[diagnostic(code(sphorge::view::port), help("{}", port_help(*port)))]
    Port {
        /// Its number; 0 if any would do.
        port: u16,
        /// What the system said.
        source: io::Error,
    },
    /// The system has no random numbers for the address.
    #[error("the system gives no random numbers for the address: {reason}")]
    #[diagnostic(code(sphorge::view::random))]
    Random {
        /// What the system said.
        reason: String,
    },
    /// The page is there and overwriting was not asked for. Nothing was touched.
    #[error("{} exists already", path.display())]
    #[diagnostic(
        code(sphorge::view::exists),
        help("choose another name with `-o FILE.html`, or pass `--overwrite` to replace it")
    )]
    Exists {
        /// The page.
        path: PathBuf,
    },
    /// The name of the page is that of something that is no file.
    #[error("{} is no file: it will not be replaced", path.display())]
    #[diagnostic(code(sphorge::view::no_file), help("choose another name with `-o FILE.html`"))]
    NoFile {
        /// The name.
        path: PathBuf,
    },
    /// What is to be shown is larger than the file may be.
    #[error("one frame of each run takes {need}, more than the {most} that the file may have")]
    #[diagnostic(
        code(sphorge::view::size),
        help("allow a larger file with `--most`, or name fewer fields with `--field`")
    )]
    Size {
        /// What it takes.
        need: String,
        /// What is allowed.
        most: String,
    },
}

fn port_help(port: u16) -> &'static str {
    if port == 0 {
        "does a firewall forbid it?"
    } else {
        "leave out `--port` to take one that is free, or name another"
    }
}

/// So many bytes for people.
pub(super) fn bytes(count: usize) -> String {
    match count {
        0..100_000 => format!("{:.1} kB", count as f64 / 1e3),
        _ => format!("{:.1} MB", count as f64 / 1e6),
    }
}

/// A time for people.
pub(super) fn time(seconds: f64) -> String {
    quantity(seconds, "s")
}
