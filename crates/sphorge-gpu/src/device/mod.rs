//! Cards that Vulkan, Metal and Direct3D 12 reach: what there is, kernels compiled for one, and their launches.

mod card;
mod fault;
mod found;
mod program;

pub use card::{Array, Card, Launch};
pub use fault::CardFault;
pub use found::{Found, find};
pub use program::Program;
