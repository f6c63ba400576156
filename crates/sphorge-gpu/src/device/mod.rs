//! GPUs that CUDA, Vulkan, Metal and Direct3D 12 reach: what there is, kernels compiled for one, and their launches.

mod card;
mod cuda;
mod deferred_error;
mod fault;
mod found;
mod graphics;
mod host;
mod profile;
#[cfg(target_os = "linux")]
mod vulkan;
mod yardstick;

pub use card::{Array, Card, Launch, Pending, Program, Reservation};
pub use cuda::NVRTC_FOLDER;
pub use fault::CardFault;
pub use found::{Found, Interface, Memory, Missing, Survey, find};
pub use profile::{KernelTime, KernelWork, Profile};
pub use yardstick::Yardstick;
