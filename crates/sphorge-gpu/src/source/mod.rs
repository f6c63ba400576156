//! Recorded kernels as text in the languages of GPUs, and as instructions for a processor.

mod cuda;
#[cfg(any(test, feature = "device"))]
mod instructions;
mod wgsl;
mod writer;

pub use cuda::cuda;
#[cfg(any(test, feature = "device"))]
pub(crate) use instructions::instructions;
#[cfg(feature = "device")]
pub(crate) use wgsl::WORKGROUP;
pub use wgsl::wgsl;
