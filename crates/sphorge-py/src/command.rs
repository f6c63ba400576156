//! The command line.

use crate::guard;
use pyo3::prelude::*;
use std::ffi::OsString;

/// Executes a command line, of which the first argument is the name of the program; `program` starts it once more. Returns the exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<OsString>, program: Vec<OsString>) -> PyResult<u8> {
    guard::detached(py, || sphorge_cli::execute(arguments, &program))
}
