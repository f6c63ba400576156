//! The laws on GPUs.
//!
//! A formula has one text, that of `sphorge-physics`, generic over its number. On a processor the number is `f64` or a SIMD vector; here it
//! is [`record::Recorded`], which writes down what is done with it. The kernels of this crate gather what a law needs, call it, and
//! store what it gives, in Rust; [`source`] writes them as WGSL (Vulkan, Metal, Direct3D 12 through wgpu) and as CUDA C++.
//!
//! ```
//! use sphorge_gpu::{record::Kernel, source};
//! use sphorge_physics::kernel::{KernelShape, WendlandC2};
//!
//! let kernel = Kernel::record("shape", |scope| {
//!     let (q, w) = (scope.input("q"), scope.output("w"));
//!     let i = scope.thread();
//!     w.set(i, WendlandC2::w(q.at(i)));
//! })?;
//! assert!(source::wgsl(&kernel).contains("fn shape("));
//! # Ok::<(), sphorge_gpu::record::KernelFault>(())
//! ```

#[cfg(feature = "device")]
pub mod device;
#[cfg(feature = "device")]
mod engine;
pub mod record;
pub mod source;

#[cfg(feature = "device")]
pub use engine::{Gpu, KernelText, kernel_texts};

#[cfg(test)]
mod evaluate;
#[cfg(test)]
mod tests;
