//! Which of the recorded operations a result depends on.

use super::operation::{Operation, Statement, Value, Variable};
use std::collections::HashSet;

/// What the stores of a kernel depend on.
#[derive(Default)]
struct Needed {
    values: HashSet<Value>,
    variables: HashSet<Variable>,
}

/// Leaves out what no store depends on, such as the slope of a law that is asked for its value.
pub(super) fn keep_needed(statements: Vec<Statement>, operations: &[Operation]) -> Vec<Statement> {
    let mut needed = Needed::default();
    // What a variable is assigned in a loop can depend on others assigned after it: as long as something is added.
    while needed.add(&statements, operations) {}
    needed.keep(statements)
}

impl Needed {
    /// Adds what the statements need that are needed themselves; whether there was any.
    fn add(&mut self, statements: &[Statement], operations: &[Operation]) -> bool {
        let before = (self.values.len(), self.variables.len());
        // Backwards, so that what is used later is known.
        for statement in statements.iter().rev() {
            if !self.has(statement) {
                continue;
            }
            match statement {
                Statement::Let(value) => self.add_operands(operations[*value as usize]),
                Statement::Declare { start: value, .. } | Statement::Assign { value, .. } => {
                    self.values.insert(*value);
                }
                Statement::Store { at, value, .. } => self.values.extend([at, value]),
                Statement::Count { at, .. } => {
                    self.values.insert(*at);
                }
                Statement::If { a, b, then, otherwise } => {
                    self.values.extend([a, b]);
                    self.add(then, operations);
                    self.add(otherwise, operations);
                }
                Statement::Loop { body, again } => {
                    self.values.insert(*again);
                    self.add(body, operations);
                }
                Statement::Range { first, end, body, .. } => {
                    self.values.extend([first, end]);
                    self.add(body, operations);
                }
            }
        }
        before != (self.values.len(), self.variables.len())
    }

    fn add_operands(&mut self, operation: Operation) {
        self.values.extend(operation.operands());
        if let Operation::Read(variable, _) = operation {
            self.variables.insert(variable);
        }
    }

    /// Whether a statement does something that is needed.
    fn has(&self, statement: &Statement) -> bool {
        let any = |statements: &[Statement]| statements.iter().any(|statement| self.has(statement));
        match statement {
            Statement::Let(value) => self.values.contains(value),
            Statement::Declare { variable, .. } | Statement::Assign { variable, .. } => {
                self.variables.contains(variable)
            }
            Statement::Store { .. } | Statement::Count { .. } => true,
            Statement::If { then, otherwise, .. } => any(then) || any(otherwise),
            Statement::Loop { body, .. } | Statement::Range { body, .. } => any(body),
        }
    }

    fn keep(&self, statements: Vec<Statement>) -> Vec<Statement> {
        let keep = |statement: Statement| match statement {
            Statement::If { a, b, then, otherwise } => {
                Statement::If { a, b, then: self.keep(then), otherwise: self.keep(otherwise) }
            }
            Statement::Loop { body, again } => Statement::Loop { body: self.keep(body), again },
            Statement::Range { counter, first, end, body } => {
                Statement::Range { counter, first, end, body: self.keep(body) }
            }
            simple => simple,
        };
        statements.into_iter().filter(|statement| self.has(statement)).map(keep).collect()
    }
}
