//! Materials: published constants shipped with the program, and what makes a complete material of constants.

mod advice;
mod build;
mod catalogue;
mod constants;
mod listing;
mod read;

pub use catalogue::{catalogue, find};
pub use listing::{ConstantLine, LawListing, MaterialListing};

pub(crate) use advice::advice;
pub(crate) use build::{Incomplete, build};
pub(crate) use catalogue::{entries, entry};
pub(crate) use constants::Constants;
pub(crate) use read::constants;

/// Keys a material gives once for all its laws.
fn constants_key(key: &str) -> bool {
    matches!(key, "density" | "young-modulus" | "reference-temperature")
}
