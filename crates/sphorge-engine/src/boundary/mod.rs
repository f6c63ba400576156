//! Rigid walls: where they are and how they push.

mod wall;

pub use wall::{WallState, wall_acceleration};
