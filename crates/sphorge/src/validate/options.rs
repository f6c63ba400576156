//! What to validate.

use super::Effort;
use std::path::PathBuf;

/// What to validate, and where to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValidateOptions {
    /// Folder of the report and the runs. A former validation in it is replaced or gone on with, anything else refused.
    pub directory: PathBuf,
    /// Takes over the runs that a former validation by the same program finished, and goes on with the one it was stopped in.
    pub resume: bool,
    /// Names of cases; all if empty.
    pub cases: Vec<String>,
    /// Low resolution, minutes rather than hours.
    pub effort: Effort,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
}
