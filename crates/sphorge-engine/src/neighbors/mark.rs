//! What a partial search does with a row: the values of its marks.

/// The row is kept.
pub(crate) const KEEP: u8 = 0;
/// The row is rebuilt.
pub(crate) const REBUILD: u8 = 1;
/// The row gains or loses points whose rows are rebuilt: entries of such points are replaced, the others are kept.
pub(crate) const PATCH: u8 = 2;
