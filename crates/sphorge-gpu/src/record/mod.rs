//! Kernels recorded by running Rust: numbers that remember what is done with them.
//!
//! [`Recorded`] implements the number traits of the laws, so that a law that is generic over them is written down by calling it. What
//! comes of it is a list of operations in an order they can be executed in, with the branches and iterations of
//! [`sphorge_physics::Elementary`]; [`crate::source`] writes it in the language of a GPU.

mod counted;
mod double;
mod index;
mod kernel;
mod needed;
mod number;
mod operation;
mod recorder;

pub use double::Double;
pub use index::Index;
pub use kernel::{Counters, IndexOutput, Indices, Input, Kernel, KernelFault, Output, Scope};
pub use number::Recorded;
#[cfg(any(test, feature = "device"))]
pub(crate) use operation::Variable;
pub(crate) use operation::{Access, Binary, Element, Operation, Statement, Unary, Value};
