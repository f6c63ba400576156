//! What can be recorded.

/// A value, by its place in the list of operations.
pub(crate) type Value = u32;

/// A variable, whose value changes: what a branch or an iteration yields.
pub(crate) type Variable = u32;

/// Of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Unary {
    Negate,
    /// The number itself, through which a compiler does not see.
    Rounded,
    SquareRoot,
    InverseSquareRoot,
    Absolute,
    Logarithm,
    Exponential,
    Cosine,
}

/// Of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Minimum,
    Maximum,
    Power,
}

/// How a value comes about. Equal operations on equal values are one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operation {
    /// The bits of a number in single precision.
    Constant(u32),
    /// A whole number.
    Whole(u32),
    /// Which of the threads of the launch this one is.
    Thread,
    /// The index of a loop over a range.
    Counter(u32),
    Unary(Unary, Value),
    Binary(Binary, Value, Value),
    /// `a * b + c`.
    MultiplyAdd(Value, Value, Value),
    /// The third where the first is below the second, else the fourth.
    SelectLess(Value, Value, Value, Value),
    /// Sum of two whole numbers.
    WholeAdd(Value, Value),
    /// Product of two whole numbers.
    WholeMultiply(Value, Value),
    /// What a variable is now; the second number tells one reading from another.
    Read(Variable, u32),
    /// The bits that two whole numbers have in common.
    WholeAnd(Value, Value),
    /// The largest whole number that is not above a number, negative ones from `2^32` down.
    Floor(Value),
    /// A whole number as a number.
    Number(Value),
    /// An element of a buffer that is only read.
    Load(u32, Value),
    /// An element of a buffer as it is now; the last number tells one reading from another.
    LoadNow(u32, Value, u32),
    /// What an element was before one was added to it.
    Counted(u32),
}

impl Operation {
    /// The values it is made of.
    pub(crate) fn operands(self) -> impl Iterator<Item = Value> {
        let operands = match self {
            Self::Constant(_)
            | Self::Whole(_)
            | Self::Thread
            | Self::Counter(_)
            | Self::Counted(_)
            | Self::Read(..) => [None; 4],
            Self::Unary(_, a) | Self::Load(_, a) | Self::LoadNow(_, a, _) | Self::Floor(a) | Self::Number(a) => {
                [Some(a), None, None, None]
            }
            Self::Binary(_, a, b) | Self::WholeAdd(a, b) | Self::WholeMultiply(a, b) | Self::WholeAnd(a, b) => {
                [Some(a), Some(b), None, None]
            }
            Self::MultiplyAdd(a, b, c) => [Some(a), Some(b), Some(c), None],
            Self::SelectLess(a, b, c, d) => [a, b, c, d].map(Some),
        };
        operands.into_iter().flatten()
    }
}

/// What is done in order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Statement {
    /// Evaluates a value.
    Let(Value),
    /// Makes a variable.
    Declare {
        variable: Variable,
        start: Value,
    },
    Assign {
        variable: Variable,
        value: Value,
    },
    Store {
        buffer: u32,
        at: Value,
        value: Value,
    },
    /// Adds one to an element that other threads count in, too.
    Count {
        result: Value,
        buffer: u32,
        at: Value,
    },
    /// `then` where `a < b`.
    If {
        a: Value,
        b: Value,
        then: Vec<Statement>,
        otherwise: Vec<Statement>,
    },
    /// Once at least, and again while `again` is positive.
    Loop {
        body: Vec<Statement>,
        again: Value,
    },
    /// For `counter` from `first` up to, not including, `end`.
    Range {
        counter: Value,
        first: Value,
        end: Value,
        body: Vec<Statement>,
    },
}

/// What a buffer is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    Number,
    Whole,
    /// Whole numbers that several threads add to.
    Counter,
}

/// What a kernel does with a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Access {
    Read,
    /// Only this way, or beside reading.
    Write,
}

/// An array a kernel is given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Buffer {
    pub(crate) name: String,
    pub(crate) element: Element,
    pub(crate) access: Access,
}
