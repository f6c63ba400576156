//! Neighbour lists and how they are found.

mod brute_force;
mod candidates;
mod cell_points;
mod cells;
mod displacement_bound;
mod foreign;
mod frame;
mod hilbert;
mod list;
pub(crate) mod mark;
mod reach;
mod rows;
mod search;

pub use brute_force::brute_force;
pub(crate) use brute_force::brute_force_rows;
pub use cells::CellGrid;
pub(crate) use cells::{are_places, bounds, is_place};
pub(crate) use displacement_bound::DisplacementBound;
pub(crate) use foreign::{ForeignBlock, ForeignList};
pub(crate) use frame::Frame;
pub use hilbert::hilbert_order;
pub use list::{BLOCK, Block, NeighborList, PAD};
pub use reach::Reach;
pub(crate) use reach::range_of;
pub(crate) use search::{PartialSearch, Searcher};
