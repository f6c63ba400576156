//! A kernel as it is executed.

use std::fmt;

/// A register, by its number.
pub(crate) type Register = u32;

/// An instruction, by its place in the list.
pub(crate) type Place = u32;

/// Of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unary {
    /// `-a`.
    Negate,
    /// The number itself.
    Copy,
    /// The square root.
    SquareRoot,
    /// One over the square root.
    InverseSquareRoot,
    /// `|a|`.
    Absolute,
    /// The natural logarithm.
    Logarithm,
    /// The exponential function.
    Exponential,
    /// The cosine of radians.
    Cosine,
    /// The largest whole number that is not above a number, negative ones from `2^32` down.
    Floor,
    /// A whole number as a number.
    Number,
}

/// Of two numbers, or of two whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// The smaller one, or the one that is a number.
    Minimum,
    /// The larger one, or the one that is a number.
    Maximum,
    /// `a^b`.
    Power,
    /// The sum of whole numbers, modulo `2^32`.
    WholeAdd,
    /// The product of whole numbers, modulo `2^32`.
    WholeMultiply,
    /// The bits that whole numbers have in common.
    WholeAnd,
}

/// What is done for all lanes at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Instruction {
    Unary(Unary, Register, Register),
    Binary(Binary, Register, [Register; 2]),
    /// `a b + c`, rounded once.
    MultiplyAdd(Register, [Register; 3]),
    /// The third where the first is below the second, else the fourth.
    SelectLess(Register, [Register; 4]),
    Load {
        to: Register,
        buffer: u32,
        at: Register,
    },
    /// Where the lane is not masked.
    Assign {
        variable: Register,
        value: Register,
    },
    Store {
        buffer: u32,
        at: Register,
        value: Register,
    },
    /// Adds one to an element, lane by lane; what it was before.
    Count {
        to: Register,
        buffer: u32,
        at: Register,
    },
    /// Lanes with `a < b` go on, if there are any; otherwise those of the other branch from there on.
    If {
        a: Register,
        b: Register,
        otherwise: Place,
    },
    /// The other lanes go on, if there are any; otherwise all from the end of the branch on.
    Otherwise {
        end: Place,
    },
    EndIf,
    Loop,
    /// Lanes whose number is positive go on from the start of the loop.
    EndLoop {
        again: Register,
        start: Place,
    },
    /// Lanes whose range is not empty go on, if there are any.
    Range {
        counter: Register,
        first: Register,
        end: Register,
        exit: Place,
    },
    /// Lanes whose counter is below the end after it was incremented go on from the start of the loop.
    EndRange {
        counter: Register,
        end: Register,
        start: Place,
    },
}

/// What every thread of a launch does.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) instructions: Vec<Instruction>,
    /// Registers that hold the same bits throughout.
    pub(crate) constants: Vec<(Register, u32)>,
    /// The register of the index of the thread.
    pub(crate) thread: Register,
    pub(crate) registers: usize,
    /// Names of the buffers.
    pub(crate) buffers: Vec<String>,
}

impl Program {
    /// Number of buffers that it is given.
    pub fn buffers(&self) -> usize {
        self.buffers.len()
    }

    /// Number of instructions.
    pub fn length(&self) -> usize {
        self.instructions.len()
    }
}

/// An access beyond the end of a buffer. The kernel ends with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beyond {
    /// Name of the buffer.
    pub buffer: String,
    /// Its number of elements.
    pub length: usize,
    /// Index of the element.
    pub index: u32,
    /// Thread that asks for it.
    pub thread: u32,
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { buffer, length, index, thread } = self;
        write!(f, "thread {thread} asks for element {index} of `{buffer}`, which has {length}")
    }
}

impl std::error::Error for Beyond {}
