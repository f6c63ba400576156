//! The command line.

use crate::{errors, guard};
use pyo3::prelude::*;
use std::{ffi::OsString, path::PathBuf};

/// Executes a command line, of which the first argument is the name of the program; `program` starts it once more. Returns the exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<OsString>, program: Vec<OsString>) -> PyResult<u8> {
    guard::detached(py, || sphorge_cli::execute(arguments, &program))
}

/// Names of the options of `sphorge plot`, without dashes before them.
#[pyfunction]
pub(crate) fn plot_options() -> Vec<String> {
    sphorge_cli::plot_options()
}

/// Draws what the arguments of `sphorge plot` ask for, and returns the files.
#[pyfunction]
pub(crate) fn draw(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<Vec<PathBuf>> {
    guard::in_pool(py, || sphorge_cli::draw(arguments))?.map_err(|report| errors::report(py, &report))
}
