//! A kernel that counts what its threads do.

use super::kernel::Kernel;
use super::operation::{Access, Binary, Buffer, Element, Operation, Statement, Unary, Value, Variable};

/// What a statement does once, without those inside it.
#[derive(Clone, Copy, Default)]
struct Cost {
    /// Numbers read from memory or written to it.
    numbers: u32,
    /// Arithmetic operations; a product that is added to something is two.
    arithmetic: u32,
}

impl Kernel {
    /// The same kernel with one buffer more, in which thread `i` writes how many numbers it has read or written, at `2 i`, and how
    /// many arithmetic operations it has done, behind it. Both are exact below `2^24`.
    #[must_use]
    pub fn counted(&self) -> Self {
        let mut counted = self.clone();
        let variables = variables(&self.statements);
        let mut counting = Counting {
            operations: std::mem::take(&mut counted.operations),
            numbers: variables,
            arithmetic: variables + 1,
        };
        let mut statements = Vec::new();
        let zero = counting.operation(Operation::Constant(0));
        statements.push(Statement::Let(zero));
        statements.extend([variables, variables + 1].map(|variable| Statement::Declare { variable, start: zero }));
        statements.extend(counting.block(&self.statements));
        let thread = counting.operation(Operation::Thread);
        let two = counting.operation(Operation::Whole(2));
        let one = counting.operation(Operation::Whole(1));
        let first = counting.operation(Operation::WholeMultiply(thread, two));
        let second = counting.operation(Operation::WholeAdd(first, one));
        statements.extend([thread, two, one, first, second].map(Statement::Let));
        let buffer = counted.buffers.len() as u32;
        for (variable, at) in [(variables, first), (variables + 1, second)] {
            let value = counting.operation(Operation::Read(variable, 0));
            statements.extend([Statement::Let(value), Statement::Store { buffer, at, value }]);
        }
        counted.buffers.push(Buffer { name: "counts".to_owned(), element: Element::Number, access: Access::Write });
        counted.operations = counting.operations;
        counted.statements = statements;
        counted
    }
}

struct Counting {
    operations: Vec<Operation>,
    numbers: Variable,
    arithmetic: Variable,
}

impl Counting {
    fn operation(&mut self, operation: Operation) -> Value {
        self.operations.push(operation);
        self.operations.len() as Value - 1
    }

    fn block(&mut self, statements: &[Statement]) -> Vec<Statement> {
        let mut cost = Cost::default();
        for statement in statements {
            let of = self.cost(statement);
            cost.numbers += of.numbers;
            cost.arithmetic += of.arithmetic;
        }
        let mut block = Vec::new();
        for (variable, amount) in [(self.numbers, cost.numbers), (self.arithmetic, cost.arithmetic)] {
            if amount > 0 {
                let before = self.operation(Operation::Read(variable, 0));
                let amount = self.operation(Operation::Constant((amount as f32).to_bits()));
                let value = self.operation(Operation::Binary(Binary::Add, before, amount));
                block.extend([before, amount, value].map(Statement::Let));
                block.push(Statement::Assign { variable, value });
            }
        }
        block.extend(statements.iter().map(|statement| self.statement(statement)));
        block
    }

    fn statement(&mut self, statement: &Statement) -> Statement {
        match statement {
            Statement::If { a, b, then, otherwise } => {
                Statement::If { a: *a, b: *b, then: self.block(then), otherwise: self.block(otherwise) }
            }
            Statement::Loop { body, again } => Statement::Loop { body: self.block(body), again: *again },
            Statement::Range { counter, first, end, body } => {
                Statement::Range { counter: *counter, first: *first, end: *end, body: self.block(body) }
            }
            simple => simple.clone(),
        }
    }

    fn cost(&self, statement: &Statement) -> Cost {
        match statement {
            Statement::Store { .. } => Cost { numbers: 1, arithmetic: 0 },
            Statement::Count { .. } => Cost { numbers: 2, arithmetic: 0 },
            Statement::Let(value) => match self.operations[*value as usize] {
                Operation::Load(..) | Operation::LoadNow(..) => Cost { numbers: 1, arithmetic: 0 },
                Operation::MultiplyAdd(..) => Cost { numbers: 0, arithmetic: 2 },
                Operation::Binary(..) => Cost { numbers: 0, arithmetic: 1 },
                Operation::Unary(Unary::Negate | Unary::Rounded | Unary::Absolute, _) => Cost::default(),
                Operation::Unary(..) => Cost { numbers: 0, arithmetic: 1 },
                _ => Cost::default(),
            },
            _ => Cost::default(),
        }
    }
}

/// One more than the largest variable.
fn variables(statements: &[Statement]) -> Variable {
    let of = |statement: &Statement| match statement {
        Statement::Declare { variable, .. } => variable + 1,
        Statement::If { then, otherwise, .. } => variables(then).max(variables(otherwise)),
        Statement::Loop { body, .. } | Statement::Range { body, .. } => variables(body),
        _ => 0,
    };
    statements.iter().map(of).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::{Evaluation, whole};
    use crate::record::{Index, Recorded};
    use sphorge_physics::{Elementary, Real};

    #[test]
    fn operations_are_counted_in_branches_and_loops_without_side_effects() {
        let kernel = Kernel::record("sums", |scope| {
            let (lengths, x, y) = (scope.indices("lengths"), scope.input("x"), scope.output("y"));
            let i = scope.thread();
            let sum = scope.fold(Index::of(0), lengths.at(i), Recorded::zero(), |_, sum, k| {
                // One number, and two operations in one.
                x.at(k).mul_add(x.at(k), sum)
            });
            let rooted = Elementary::if_lt(Recorded::of(10.0), sum, || sum.sqrt() + sum, || sum);
            y.set(i, rooted);
        });
        let kernel = kernel.unwrap();
        let buffers = || vec![whole(&[0, 2, 4]), vec![1.0, 2.0, 3.0, 4.0], vec![0.0; 3]];
        let mut plain = buffers();
        Evaluation::default().run(&kernel, &mut plain, 3);
        let mut counted = buffers();
        counted.push(vec![f32::NAN; 6]);
        Evaluation::default().run(&kernel.counted(), &mut counted, 3);
        assert_eq!(plain[2], counted[2]);
        // The length and the result, and one number for each that is summed; two operations for each, and two more beyond ten.
        assert_eq!(counted[3], [2.0, 0.0, 4.0, 4.0, 6.0, 10.0]);
    }
}
