//! What a partial search does to a row: the values of its marks.

/// The row stays.
pub(crate) const KEEP: u8 = 0;
/// The row is made anew.
pub(crate) const SEARCH: u8 = 1;
/// A neighbour of one that is searched: entries that are searched are made anew, the others stay.
pub(crate) const MEND: u8 = 2;
