//! A kernel: what every thread of a launch does.

use super::needed::keep_needed;
use super::number::{assign, declare, read};
use super::operation::{Access, Buffer, Element, Operation, Statement};
use super::recorder::{nested, record, with};
use super::{Index, Recorded};
use sphorge_physics::Numbers;

/// What every thread of a launch does, as it was recorded.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub(crate) name: String,
    pub(crate) buffers: Vec<Buffer>,
    pub(crate) operations: Vec<Operation>,
    pub(crate) statements: Vec<Statement>,
}

/// Why something cannot be recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KernelFault {
    /// Name of the kernel.
    pub kernel: String,
    /// What it asks for.
    pub what: &'static str,
}

impl core::fmt::Display for KernelFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "kernel `{}` cannot be written for a card: {}", self.kernel, self.what)
    }
}

impl core::error::Error for KernelFault {}

/// What a kernel that is being recorded can ask for.
#[derive(Debug)]
pub struct Scope(());

/// A buffer of numbers a kernel reads.
#[derive(Clone, Copy, Debug)]
pub struct Input(u32);

/// A buffer of whole numbers a kernel reads.
#[derive(Clone, Copy, Debug)]
pub struct Indices(u32);

/// A buffer of numbers a kernel writes, and may read what it has written.
#[derive(Clone, Copy, Debug)]
pub struct Output(u32);

/// A buffer of whole numbers a kernel writes.
#[derive(Clone, Copy, Debug)]
pub struct IndexOutput(u32);

/// A buffer of whole numbers that threads count in.
#[derive(Clone, Copy, Debug)]
pub struct Counters(u32);

impl Kernel {
    /// Records a kernel. `name` is one of the languages of GPUs: letters, digits and underscores.
    ///
    /// # Errors
    /// It asks for what a GPU cannot do.
    pub fn record(name: &str, body: impl FnOnce(&mut Scope)) -> Result<Self, KernelFault> {
        let (recorder, statements) = record(|| body(&mut Scope(())));
        if let Some(what) = recorder.fault {
            return Err(KernelFault { kernel: name.to_owned(), what });
        }
        if has_aliases(&recorder.buffers) {
            return Err(KernelFault { kernel: name.to_owned(), what: "an array that is written under two names" });
        }
        let statements = keep_needed(statements, &recorder.operations);
        Ok(Self { name: name.to_owned(), buffers: recorder.buffers, operations: recorder.operations, statements })
    }
}

/// Whether one that is written is also there a second time, which Vulkan refuses, and compilers may take for another array.
fn has_aliases(buffers: &[Buffer]) -> bool {
    let is_alias = |(k, of): (usize, &Buffer)| {
        let mut others = buffers.iter().enumerate().filter(|(other, _)| *other != k);
        of.access == Access::Write && others.any(|(_, other)| other.name == of.name)
    };
    buffers.iter().enumerate().any(is_alias)
}

fn buffer(name: &str, element: Element, access: Access) -> u32 {
    with(|recorder| {
        recorder.buffers.push(Buffer { name: name.to_owned(), element, access });
        recorder.buffers.len() as u32 - 1
    })
}

impl Scope {
    /// The next buffer of the launch: numbers that are read.
    pub fn input(&mut self, name: &str) -> Input {
        Input(buffer(name, Element::Number, Access::Read))
    }

    /// The next buffer of the launch: whole numbers that are read.
    pub fn indices(&mut self, name: &str) -> Indices {
        Indices(buffer(name, Element::Whole, Access::Read))
    }

    /// The next buffer of the launch: numbers that are written.
    pub fn output(&mut self, name: &str) -> Output {
        Output(buffer(name, Element::Number, Access::Write))
    }

    /// The next buffer of the launch: whole numbers that are written.
    pub fn index_output(&mut self, name: &str) -> IndexOutput {
        IndexOutput(buffer(name, Element::Whole, Access::Write))
    }

    /// The next buffer of the launch: whole numbers that threads count in.
    pub fn counters(&mut self, name: &str) -> Counters {
        Counters(buffer(name, Element::Counter, Access::Write))
    }

    /// Which of the threads of the launch this one is, from zero on.
    pub fn thread(&self) -> Index {
        Index(with(|recorder| recorder.value(Operation::Thread)))
    }

    /// Takes a state through `step` for each index from `first` up to, not including, `end`, in this order.
    pub fn fold<S: Numbers<Recorded>>(
        &mut self,
        first: Index,
        end: Index,
        start: S,
        step: impl FnOnce(&mut Self, S, Index) -> S,
    ) -> S {
        let mut state = start;
        let variables = declare(&mut state);
        let counter = with(|recorder| recorder.counter());
        let ((), body) = nested(|| {
            read(&mut state, &variables);
            let mut next = step(self, state, Index(counter));
            assign(&mut next, &variables);
        });
        with(|recorder| recorder.push(Statement::Range { counter, first: first.0, end: end.0, body }));
        read(&mut state, &variables);
        state
    }
}

impl Input {
    /// An element.
    pub fn at(self, index: Index) -> Recorded {
        Recorded(with(|recorder| recorder.value(Operation::Load(self.0, index.0))))
    }
}

impl Indices {
    /// An element.
    pub fn at(self, index: Index) -> Index {
        Index(with(|recorder| recorder.value(Operation::Load(self.0, index.0))))
    }
}

impl Output {
    /// An element as it is now.
    pub fn at(self, index: Index) -> Recorded {
        Recorded(with(|recorder| recorder.load_now(self.0, index.0)))
    }

    /// Makes an element a number.
    pub fn set(self, index: Index, number: Recorded) {
        with(|recorder| recorder.push(Statement::Store { buffer: self.0, at: index.0, value: number.0 }));
    }
}

impl IndexOutput {
    /// An element as it is now.
    pub fn at(self, index: Index) -> Index {
        Index(with(|recorder| recorder.load_now(self.0, index.0)))
    }

    /// Makes an element a whole number.
    pub fn set(self, index: Index, whole: Index) {
        with(|recorder| recorder.push(Statement::Store { buffer: self.0, at: index.0, value: whole.0 }));
    }
}

impl Counters {
    /// Adds one to an element; what it was before, in the order threads happen to come.
    pub fn count(self, index: Index) -> Index {
        Index(with(|recorder| recorder.count(self.0, index.0)))
    }
}
