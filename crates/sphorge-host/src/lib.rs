//! Kernels of GPUs on the processor that starts them, without a compiler.
//!
//! A [`Program`] is a list of instructions on registers. A register holds a number of each of [`LANES`] threads, and an
//! instruction is executed for all of them before the next one, so that choosing it costs little beside what it does.
//! Threads that have not taken a branch, or have left a loop, are masked. Numbers are in single precision, products that
//! are added to something are rounded once, and every access to memory is checked.
//!
//! ```
//! use sphorge_host::{Binary, Builder, memory};
//!
//! let mut builder = Builder::new(&["x", "y"]);
//! let i = builder.thread();
//! let x = builder.load(0, i);
//! let twice = builder.binary(Binary::Add, x, x);
//! builder.store(1, i, twice);
//! let program = builder.finish();
//! let (x, y) = (memory(&[1.5, 2.5]), memory(&[0.0; 2]));
//! program.run(&[&x, &y], 2)?;
//! assert_eq!(y[1].load(std::sync::atomic::Ordering::Relaxed), 5.0f32.to_bits());
//! # Ok::<(), sphorge_host::Beyond>(())
//! ```

mod arithmetic;
mod builder;
mod execute;
mod program;
mod study;

pub use builder::{Builder, Value, Variable};
pub use program::{Beyond, Binary, Program, Unary};
pub use study::{Study, Units};

use std::sync::atomic::AtomicU32;

/// Threads that a register has numbers of.
pub const LANES: usize = 64;

/// Memory with these numbers, as their bits.
pub fn memory(numbers: &[f32]) -> Vec<AtomicU32> {
    numbers.iter().map(|number| AtomicU32::new(number.to_bits())).collect()
}
