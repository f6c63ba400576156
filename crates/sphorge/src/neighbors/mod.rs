//! Neighbour lists and how they are found.

mod brute_force;
mod cells;
mod list;
mod search;

pub use brute_force::brute_force;
pub use cells::CellGrid;
pub(crate) use cells::bounds;
pub use list::{BLOCK, Block, NeighborList, PAD};
pub use search::{Reach, search};
