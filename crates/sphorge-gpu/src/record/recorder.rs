//! The recording that is under way on this thread.

use super::operation::{Buffer, Operation, Statement, Value, Variable};
use std::cell::RefCell;
use std::collections::HashMap;

/// What has been recorded so far.
#[derive(Default)]
pub(super) struct Recorder {
    pub(super) operations: Vec<Operation>,
    pub(super) buffers: Vec<Buffer>,
    /// Innermost last.
    scopes: Vec<Block>,
    variables: u32,
    readings: u32,
    counters: u32,
    /// The first thing that cannot be recorded.
    pub(super) fault: Option<&'static str>,
}

/// The statements of a block, and the values that are known in it.
#[derive(Default)]
struct Block {
    statements: Vec<Statement>,
    known: HashMap<Operation, Value>,
}

thread_local! {
    static RECORDER: RefCell<Option<Recorder>> = const { RefCell::new(None) };
}

/// Records what `body` does, and gives back all of it with the statements in order.
pub(super) fn record(body: impl FnOnce()) -> (Recorder, Vec<Statement>) {
    let outer = RECORDER.replace(Some(Recorder { scopes: vec![Block::default()], ..Recorder::default() }));
    body();
    let mut recorder = RECORDER.replace(outer).unwrap_or_default();
    let statements = recorder.scopes.pop().map(|block| block.statements).unwrap_or_default();
    (recorder, statements)
}

/// Asks the recording that is under way.
///
/// # Panics
/// There is none: a number of a kernel was made outside of it.
pub(super) fn with<R>(ask: impl FnOnce(&mut Recorder) -> R) -> R {
    RECORDER.with_borrow_mut(|recorder| match recorder {
        Some(recorder) => ask(recorder),
        None => panic!("a number of a kernel is made while none is recorded"),
    })
}

/// Records what `body` does as a block of its own.
pub(super) fn nested<R>(body: impl FnOnce() -> R) -> (R, Vec<Statement>) {
    begin();
    let result = body();
    (result, end())
}

/// Records what follows as a block of its own.
pub(super) fn begin() {
    with(|recorder| recorder.scopes.push(Block::default()));
}

/// Ends the innermost block.
pub(super) fn end() -> Vec<Statement> {
    with(|recorder| recorder.scopes.pop()).unwrap_or_default().statements
}

impl Recorder {
    /// The value of an operation: a known one, or a new one.
    pub(super) fn value(&mut self, operation: Operation) -> Value {
        if let Some(known) = self.scopes.iter().rev().find_map(|block| block.known.get(&operation)) {
            return *known;
        }
        let value = self.operations.len() as Value;
        self.operations.push(operation);
        if let Some(block) = self.scopes.last_mut() {
            block.known.insert(operation, value);
        }
        self.push(Statement::Let(value));
        value
    }

    /// A number that is the same in every thread and known now.
    pub(super) fn constant(&self, value: Value) -> Option<f32> {
        match self.operations.get(value as usize) {
            Some(Operation::Constant(bits)) => Some(f32::from_bits(*bits)),
            _ => None,
        }
    }

    pub(super) fn push(&mut self, statement: Statement) {
        if let Some(block) = self.scopes.last_mut() {
            block.statements.push(statement);
        }
    }

    /// A new variable that starts as a value.
    pub(super) fn declare(&mut self, start: Value) -> Variable {
        let variable = self.variables;
        self.variables += 1;
        self.push(Statement::Declare { variable, start });
        variable
    }

    /// What a variable is from here on.
    pub(super) fn read(&mut self, variable: Variable) -> Value {
        self.readings += 1;
        self.value(Operation::Read(variable, self.readings))
    }

    /// An element of a buffer as it is now.
    pub(super) fn load_now(&mut self, buffer: u32, at: Value) -> Value {
        self.readings += 1;
        self.value(Operation::LoadNow(buffer, at, self.readings))
    }

    /// Adds one to an element; what it was before.
    pub(super) fn count(&mut self, buffer: u32, at: Value) -> Value {
        self.readings += 1;
        let result = self.operations.len() as Value;
        self.operations.push(Operation::Counted(self.readings));
        self.push(Statement::Count { result, buffer, at });
        result
    }

    /// The index of a new loop.
    pub(super) fn counter(&mut self) -> Value {
        self.counters += 1;
        let value = self.operations.len() as Value;
        self.operations.push(Operation::Counter(self.counters));
        value
    }
}
