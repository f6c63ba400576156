//! How much a validation computes.

use serde::{Deserialize, Serialize};

/// How much to compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effort {
    /// Coarse spacings: every check in all about two minutes on two cores.
    Quick,
    /// The spacings of the sources, and convergence studies.
    #[default]
    Full,
}
