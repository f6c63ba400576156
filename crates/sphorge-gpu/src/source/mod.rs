//! Recorded kernels as text in the languages of GPUs.

mod cuda;
mod wgsl;
mod writer;

pub use cuda::cuda;
#[cfg(feature = "device")]
pub(crate) use wgsl::WORKGROUP;
pub use wgsl::wgsl;
