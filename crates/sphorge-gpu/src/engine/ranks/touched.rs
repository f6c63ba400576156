//! Column access of kernels, from their recorded text: columns of other particles that a kernel reads, and columns that
//! it writes.

use crate::engine::columns::{Group, Recording};
use crate::record::{Operation, Statement, Value, Variable};
use std::collections::{BTreeMap, HashSet};

/// Columns of groups, a bit each.
pub(in crate::engine) type ColumnSet = BTreeMap<Group, u128>;

/// Every column of a group.
pub(in crate::engine) const ALL: u128 = u128::MAX;

/// Access of a kernel to the columns of particles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::engine) struct Touched {
    /// Read from neighbours.
    pub(in crate::engine) gathered: ColumnSet,
    /// Written for the own particle.
    pub(in crate::engine) written: ColumnSet,
    /// Whether neighbours are marked whose rows are to be patched.
    pub(in crate::engine) marks_neighbors: bool,
}

impl Touched {
    /// For a kernel over columns of a length, which runs over rows of ghosts too, or only over those of the own
    /// particles.
    pub(in crate::engine) fn of(recording: &Recording, stride: usize, runs_over_ghosts: bool) -> Self {
        let reader = Reader::new(recording, stride);
        let mut touched = Self::default();
        for operation in &recording.kernel.operations {
            if let Operation::Load(buffer, at) | Operation::LoadNow(buffer, at, _) = *operation
                && (runs_over_ghosts || reader.is_of_neighbor[at as usize])
            {
                reader.add(&mut touched.gathered, buffer, at);
            }
        }
        reader.add_stores(&recording.kernel.statements, &mut touched);
        touched
    }
}

/// Properties of the values of a kernel.
struct Reader<'a> {
    recording: &'a Recording,
    stride: usize,
    /// By value, whether it depends on the indices of neighbours.
    is_of_neighbor: Vec<bool>,
}

impl<'a> Reader<'a> {
    fn new(recording: &'a Recording, stride: usize) -> Self {
        let operations = &recording.kernel.operations;
        let mut is_of_neighbor = vec![false; operations.len()];
        let mut variables = HashSet::new();
        // The value assigned to a variable in a loop can depend on others assigned after it: repeat until nothing is
        // added.
        loop {
            let before = variables.len();
            for value in 0..operations.len() {
                is_of_neighbor[value] |= match operations[value] {
                    Operation::Load(buffer, at) | Operation::LoadNow(buffer, at, _) => {
                        names_neighbors(recording.groups[buffer as usize]) || is_of_neighbor[at as usize]
                    }
                    Operation::Read(variable, _) => variables.contains(&variable),
                    operation => operation.operands().any(|operand| is_of_neighbor[operand as usize]),
                };
            }
            assigned(&recording.kernel.statements, &is_of_neighbor, &mut variables);
            if variables.len() == before {
                return Self { recording, stride, is_of_neighbor };
            }
        }
    }

    /// Adds the column of an element of a buffer, or the whole group if the column is not a constant.
    fn add(&self, columns: &mut ColumnSet, buffer: u32, at: Value) {
        let group = self.recording.groups[buffer as usize];
        if group.of_particles().is_some() {
            *columns.entry(group).or_default() |= self.column(at).map_or(ALL, |column| 1 << column);
        }
    }

    /// The column of an index: a whole number of columns is added to the row, or nothing.
    fn column(&self, at: Value) -> Option<usize> {
        let operations = &self.recording.kernel.operations;
        let whole = |value: Value| match operations[value as usize] {
            Operation::Whole(number) => Some(number as usize),
            _ => None,
        };
        let is_sum = |value: Value| matches!(operations[value as usize], Operation::WholeAdd(..));
        match operations[at as usize] {
            Operation::WholeAdd(a, b) => {
                let (start, row) = whole(a).map(|start| (start, b)).or_else(|| whole(b).map(|start| (start, a)))?;
                let column = start / self.stride;
                (start % self.stride == 0 && !is_sum(row) && column < ALL.count_ones() as usize).then_some(column)
            }
            // A constant is a row that all threads share.
            Operation::Whole(_) => None,
            _ => Some(0),
        }
    }

    fn add_stores(&self, statements: &[Statement], touched: &mut Touched) {
        for statement in statements {
            match statement {
                Statement::Store { buffer, at, .. } => {
                    let is_marked = self.recording.groups[*buffer as usize] == Group::Patched;
                    touched.marks_neighbors |= is_marked && self.is_of_neighbor[*at as usize];
                    self.add(&mut touched.written, *buffer, *at);
                }
                Statement::If { then, otherwise, .. } => {
                    self.add_stores(then, touched);
                    self.add_stores(otherwise, touched);
                }
                Statement::Loop { body, .. } | Statement::Range { body, .. } => self.add_stores(body, touched),
                Statement::Let(_) | Statement::Declare { .. } | Statement::Assign { .. } | Statement::Count { .. } => {}
            }
        }
    }
}

/// Adds the variables whose values depend on the indices of neighbours.
fn assigned(statements: &[Statement], is_of_neighbor: &[bool], variables: &mut HashSet<Variable>) {
    for statement in statements {
        match statement {
            Statement::Declare { variable, start: value } | Statement::Assign { variable, value } => {
                if is_of_neighbor[*value as usize] {
                    variables.insert(*variable);
                }
            }
            Statement::If { then, otherwise, .. } => {
                assigned(then, is_of_neighbor, variables);
                assigned(otherwise, is_of_neighbor, variables);
            }
            Statement::Loop { body, .. } | Statement::Range { body, .. } => assigned(body, is_of_neighbor, variables),
            Statement::Let(_) | Statement::Store { .. } | Statement::Count { .. } => {}
        }
    }
}

/// Whether the elements of a group are indices of neighbours.
fn names_neighbors(group: Group) -> bool {
    matches!(group, Group::List | Group::Kept | Group::Sorted | Group::Unsorted)
}
