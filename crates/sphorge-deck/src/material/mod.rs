//! Materials: published constants shipped with the program, and what makes a complete material of constants.

mod advice;
mod breaking;
mod build;
mod catalogue;
mod constants;
mod listing;
mod plausible;
mod poisson;
mod read;

pub use catalogue::{catalogue, find};
pub use listing::{ConstantLine, LawListing, MaterialListing};

pub(crate) use advice::{advice, is_of_moduli};
pub(crate) use build::{Incomplete, Missing, build};
pub(crate) use catalogue::{entries, entry};
pub(crate) use constants::Constants;
pub(crate) use read::{constants, places};

/// Keys a material gives once for all its laws.
fn constants_key(key: &str) -> bool {
    matches!(key, "density" | "young-modulus" | "reference-temperature")
}

/// A value with its SI unit, for people, to six digits.
pub(crate) fn shown(value: f64, unit: &str) -> String {
    let value = format!("{value:.5e}").parse().unwrap_or(value);
    let is_short = value == 0.0 || (1e-3..1e5).contains(&value.abs());
    let text = if is_short { format!("{value} {unit}") } else { format!("{value:e} {unit}") };
    text.trim_end().to_owned()
}
