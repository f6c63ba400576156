//! What to validate.

use super::Effort;
use std::path::PathBuf;

/// What to validate, and where to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValidateOptions {
    /// Folder of the report and the runs. A former validation in it is replaced, anything else refused.
    pub directory: PathBuf,
    /// Names of cases; all if empty.
    pub cases: Vec<String>,
    /// Low resolution, minutes rather than an hour.
    pub effort: Effort,
    /// Number of threads; all the machine has if not given.
    pub threads: Option<usize>,
}
