//! The shipped materials, read once from the text they are written in.

use super::constants::Constants;
use super::listing::{MaterialListing, listing};
use std::sync::LazyLock;

const TEXT: &str = include_str!("catalogue.toml");

static ENTRIES: LazyLock<Vec<(String, Constants)>> =
    LazyLock::new(|| match crate::deck::read_materials("catalogue", TEXT) {
        Ok(entries) => entries,
        // The text is part of the program; a test reads it.
        Err(report) => panic!("the material catalogue cannot be read: {report}"),
    });

/// Every material of the catalogue, by name.
pub(crate) fn entries() -> &'static [(String, Constants)] {
    &ENTRIES
}

/// Constants of a material of the catalogue.
pub(crate) fn entry(name: &str) -> Option<&'static Constants> {
    entries().iter().find(|(n, _)| n == name).map(|(_, constants)| constants)
}

/// All materials of the catalogue, in alphabetic order.
pub fn catalogue() -> Vec<MaterialListing> {
    entries().iter().map(|(name, constants)| listing(name, constants)).collect()
}

/// One material of the catalogue; otherwise the name most like the one asked for, if any is.
///
/// # Errors
/// The nearest name.
pub fn find(name: &str) -> Result<MaterialListing, Option<&'static str>> {
    match entry(name) {
        Some(constants) => Ok(listing(name, constants)),
        None => Err(crate::deck::nearest(name, entries().iter().map(|(n, _)| n.as_str()))),
    }
}
