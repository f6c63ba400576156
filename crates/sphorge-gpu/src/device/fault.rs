//! What can go wrong with a GPU.

/// What can go wrong with a GPU.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CardFault {
    /// There is no GPU, or none of that name.
    #[error("{what}")]
    NotFound {
        /// What was looked for.
        what: String,
        /// The way out.
        help: String,
    },
    /// It does not open.
    #[error("{name} cannot be opened: {why}")]
    DoesNotOpen {
        /// Name of the GPU.
        name: String,
        /// What its driver says.
        why: String,
    },
    /// A kernel is not taken.
    #[error("the driver does not accept kernel `{kernel}`: {why}")]
    Kernel {
        /// Name of the kernel.
        kernel: String,
        /// What the compiler says.
        why: String,
    },
    /// There is not enough memory.
    #[error("{bytes} bytes do not fit in the memory of {name}: {why}")]
    Memory {
        /// Name of the GPU.
        name: String,
        /// What was asked for.
        bytes: u64,
        /// What its driver says.
        why: String,
    },
    /// It does not answer any more.
    #[error("{name} was lost: {why}")]
    Lost {
        /// Name of the GPU.
        name: String,
        /// What its driver says.
        why: String,
    },
}
