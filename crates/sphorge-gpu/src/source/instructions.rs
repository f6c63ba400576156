//! The processor, which executes kernels itself.

use crate::record::{self, Kernel, Operation, Statement};
use sphorge_host::{Binary, Builder, Program, Unary, Value, Variable};
use std::collections::HashMap;

/// A kernel for the processor.
pub(crate) struct Instructions {
    pub(crate) program: Program,
    /// Places of the instructions that choose, with the values that are compared there.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests ask which ways choices fall"))]
    pub(crate) choices: Vec<(u32, (record::Value, record::Value))>,
}

/// A kernel as instructions for the processor.
pub(crate) fn instructions(kernel: &Kernel) -> Instructions {
    let names: Vec<&str> = kernel.buffers.iter().map(|buffer| buffer.name.as_str()).collect();
    let mut translation = Translation {
        kernel,
        builder: Builder::new(&names),
        values: vec![None; kernel.operations.len()],
        variables: HashMap::new(),
        choices: Vec::new(),
    };
    translation.statements(&kernel.statements);
    Instructions { program: translation.builder.finish(), choices: translation.choices }
}

struct Translation<'a> {
    kernel: &'a Kernel,
    builder: Builder,
    /// Of each operation that was reached.
    values: Vec<Option<Value>>,
    variables: HashMap<record::Variable, Variable>,
    choices: Vec<(u32, (record::Value, record::Value))>,
}

impl Translation<'_> {
    /// # Panics
    /// It is used before it is made, which no recorder writes.
    fn value(&self, value: record::Value) -> Value {
        self.values[value as usize].expect("a value that was made before")
    }

    fn variable(&self, variable: record::Variable) -> Variable {
        self.variables[&variable]
    }

    fn statements(&mut self, statements: &[Statement]) {
        for statement in statements {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Let(value) => self.values[*value as usize] = Some(self.operation(*value)),
            Statement::Declare { variable, start } => {
                let start = self.value(*start);
                self.variables.insert(*variable, self.builder.declare(start));
            }
            Statement::Assign { variable, value } => {
                self.builder.assign(self.variable(*variable), self.value(*value));
            }
            Statement::Store { buffer, at, value } => {
                self.builder.store(*buffer, self.value(*at), self.value(*value));
            }
            Statement::Count { result, buffer, at } => {
                let before = self.builder.count(*buffer, self.value(*at));
                self.values[*result as usize] = Some(before);
            }
            Statement::If { a, b, then, otherwise } => {
                self.choices.push((self.builder.place(), (*a, *b)));
                self.builder.begin_if(self.value(*a), self.value(*b));
                self.statements(then);
                self.builder.begin_otherwise();
                self.statements(otherwise);
                self.builder.end_if();
            }
            Statement::Loop { body, again } => {
                self.builder.begin_loop();
                self.statements(body);
                self.builder.end_loop(self.value(*again));
            }
            Statement::Range { counter, first, end, body } => {
                let index = self.builder.begin_range(self.value(*first), self.value(*end));
                self.values[*counter as usize] = Some(index);
                self.statements(body);
                self.builder.end_range();
            }
        }
    }

    fn operation(&mut self, value: record::Value) -> Value {
        let of = |value: record::Value| self.values[value as usize].expect("a value that was made before");
        match self.kernel.operations[value as usize] {
            Operation::Constant(bits) | Operation::Whole(bits) => self.builder.constant(bits),
            Operation::Thread => self.builder.thread(),
            // Made by their loop and by the statement that counts.
            Operation::Counter(_) | Operation::Counted(_) => of(value),
            Operation::Read(variable, _) => self.builder.read(self.variables[&variable]),
            Operation::Load(buffer, at) | Operation::LoadNow(buffer, at, _) => self.builder.load(buffer, of(at)),
            Operation::Unary(operation, a) => self.builder.unary(unary(operation), of(a)),
            Operation::Floor(a) => self.builder.unary(Unary::Floor, of(a)),
            Operation::Number(a) => self.builder.unary(Unary::Number, of(a)),
            Operation::Binary(operation, a, b) => self.builder.binary(binary(operation), of(a), of(b)),
            Operation::WholeAdd(a, b) => self.builder.binary(Binary::WholeAdd, of(a), of(b)),
            Operation::WholeMultiply(a, b) => self.builder.binary(Binary::WholeMultiply, of(a), of(b)),
            Operation::WholeAnd(a, b) => self.builder.binary(Binary::WholeAnd, of(a), of(b)),
            Operation::MultiplyAdd(a, b, c) => self.builder.multiply_add(of(a), of(b), of(c)),
            Operation::SelectLess(a, b, then, otherwise) => {
                self.choices.push((self.builder.place(), (a, b)));
                self.builder.select_less(of(a), of(b), of(then), of(otherwise))
            }
        }
    }
}

fn unary(operation: record::Unary) -> Unary {
    match operation {
        record::Unary::Negate => Unary::Negate,
        // Nothing here sees through it.
        record::Unary::Rounded => Unary::Copy,
        record::Unary::SquareRoot => Unary::SquareRoot,
        record::Unary::InverseSquareRoot => Unary::InverseSquareRoot,
        record::Unary::Absolute => Unary::Absolute,
        record::Unary::Logarithm => Unary::Logarithm,
        record::Unary::Exponential => Unary::Exponential,
        record::Unary::Cosine => Unary::Cosine,
    }
}

fn binary(operation: record::Binary) -> Binary {
    match operation {
        record::Binary::Add => Binary::Add,
        record::Binary::Subtract => Binary::Subtract,
        record::Binary::Multiply => Binary::Multiply,
        record::Binary::Divide => Binary::Divide,
        record::Binary::Minimum => Binary::Minimum,
        record::Binary::Maximum => Binary::Maximum,
        record::Binary::Power => Binary::Power,
    }
}
