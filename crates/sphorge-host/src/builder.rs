//! A program as it is written, and the registers of its values.

use crate::program::{Binary, Instruction, Place, Program, Register, Unary};
use std::collections::HashMap;

/// A value of a program that is being written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Value(u32);

/// A variable of a program that is being written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variable(u32);

/// How long a value is needed.
#[derive(Clone, Copy)]
struct Life {
    /// Instruction that makes it.
    start: Place,
    /// The last one that needs it.
    end: Place,
    /// Whether its register is its own throughout.
    is_constant: bool,
}

/// A branch or a loop that is not closed.
struct Open {
    start: Place,
    is_loop: bool,
    /// Values made before a loop that are needed in it: until its end, as it may go on from its start.
    outer: Vec<u32>,
}

/// Writes a program.
pub struct Builder {
    /// On values, which become registers at the end.
    instructions: Vec<Instruction>,
    lives: Vec<Life>,
    constants: HashMap<u32, u32>,
    thread: Option<u32>,
    open: Vec<Open>,
    buffers: Vec<String>,
}

impl Builder {
    /// For a kernel that is given buffers of these names.
    pub fn new(buffers: &[&str]) -> Self {
        Self {
            instructions: Vec::new(),
            lives: Vec::new(),
            constants: HashMap::new(),
            thread: None,
            open: Vec::new(),
            buffers: buffers.iter().map(|name| (*name).to_owned()).collect(),
        }
    }

    /// Place of the next instruction.
    pub fn place(&self) -> u32 {
        self.here()
    }

    fn here(&self) -> Place {
        self.instructions.len() as Place
    }

    /// A value that the next instruction makes.
    fn new_value(&mut self, is_constant: bool) -> u32 {
        let here = self.here();
        self.lives.push(Life { start: here, end: here, is_constant });
        self.lives.len() as u32 - 1
    }

    /// Notes that the next instruction needs a value.
    fn needs(&mut self, value: u32) {
        let here = self.here();
        let life = &mut self.lives[value as usize];
        life.end = life.end.max(here);
        let start = life.start;
        // The outermost loop that it was made before.
        if let Some(open) = self.open.iter_mut().find(|open| open.is_loop && open.start > start) {
            open.outer.push(value);
        }
    }

    fn all_need<const N: usize>(&mut self, values: [Value; N]) -> [u32; N] {
        values.map(|value| {
            self.needs(value.0);
            value.0
        })
    }

    fn push(&mut self, instruction: Instruction) {
        self.instructions.push(instruction);
    }

    /// The same bits in every thread.
    pub fn constant(&mut self, bits: u32) -> Value {
        if let Some(known) = self.constants.get(&bits) {
            return Value(*known);
        }
        let value = self.new_value(true);
        self.constants.insert(bits, value);
        Value(value)
    }

    /// Which of the threads of the launch this one is, from zero on.
    pub fn thread(&mut self) -> Value {
        let value = self.thread.unwrap_or_else(|| self.new_value(true));
        self.thread = Some(value);
        Value(value)
    }

    /// Of one number.
    pub fn unary(&mut self, operation: Unary, a: Value) -> Value {
        let [a] = self.all_need([a]);
        let to = self.new_value(false);
        self.push(Instruction::Unary(operation, to, a));
        Value(to)
    }

    /// Of two numbers.
    pub fn binary(&mut self, operation: Binary, a: Value, b: Value) -> Value {
        let of = self.all_need([a, b]);
        let to = self.new_value(false);
        self.push(Instruction::Binary(operation, to, of));
        Value(to)
    }

    /// `a b + c`, rounded once.
    pub fn multiply_add(&mut self, a: Value, b: Value, c: Value) -> Value {
        let of = self.all_need([a, b, c]);
        let to = self.new_value(false);
        self.push(Instruction::MultiplyAdd(to, of));
        Value(to)
    }

    /// `then` where `a < b`, else `otherwise`.
    pub fn select_less(&mut self, a: Value, b: Value, then: Value, otherwise: Value) -> Value {
        let of = self.all_need([a, b, then, otherwise]);
        let to = self.new_value(false);
        self.push(Instruction::SelectLess(to, of));
        Value(to)
    }

    /// An element of a buffer as it is now.
    pub fn load(&mut self, buffer: u32, at: Value) -> Value {
        let [at] = self.all_need([at]);
        let to = self.new_value(false);
        self.push(Instruction::Load { to, buffer, at });
        Value(to)
    }

    /// Overwrites an element of a buffer.
    pub fn store(&mut self, buffer: u32, at: Value, value: Value) {
        let [at, value] = self.all_need([at, value]);
        self.push(Instruction::Store { buffer, at, value });
    }

    /// Adds one to an element of a buffer of whole numbers; what it was before.
    pub fn count(&mut self, buffer: u32, at: Value) -> Value {
        let [at] = self.all_need([at]);
        let to = self.new_value(false);
        self.push(Instruction::Count { to, buffer, at });
        Value(to)
    }

    /// A new variable of the innermost branch or loop.
    pub fn declare(&mut self, start: Value) -> Variable {
        Variable(self.unary(Unary::Copy, start).0)
    }

    /// Makes a variable a value.
    pub fn assign(&mut self, variable: Variable, value: Value) {
        let [variable, value] = self.all_need([Value(variable.0), value]);
        self.push(Instruction::Assign { variable, value });
    }

    /// What a variable is now.
    pub fn read(&mut self, variable: Variable) -> Value {
        self.unary(Unary::Copy, Value(variable.0))
    }

    fn open(&mut self, is_loop: bool) {
        self.open.push(Open { start: self.here(), is_loop, outer: Vec::new() });
    }

    /// The place where the innermost branch or loop started, whose last instruction is the next one.
    fn close(&mut self) -> usize {
        let Some(Open { start, outer, .. }) = self.open.pop() else { panic!("nothing is open") };
        let here = self.here();
        for value in outer {
            let life = &mut self.lives[value as usize];
            life.end = life.end.max(here);
        }
        start as usize
    }

    /// Starts what threads with `a < b` do.
    pub fn begin_if(&mut self, a: Value, b: Value) {
        let [a, b] = self.all_need([a, b]);
        self.open(false);
        self.push(Instruction::If { a, b, otherwise: 0 });
    }

    /// Starts what the other threads do, if only nothing; called once for each branch.
    ///
    /// # Panics
    /// No branch is open.
    pub fn begin_otherwise(&mut self) {
        let here = self.here();
        let Some(open) = self.open.last() else { panic!("no branch is open") };
        let start = open.start as usize;
        if let Instruction::If { otherwise, .. } = &mut self.instructions[start] {
            *otherwise = here;
        }
        self.push(Instruction::Otherwise { end: 0 });
    }

    /// Ends a branch.
    ///
    /// # Panics
    /// No branch is open.
    pub fn end_if(&mut self) {
        let here = self.here();
        let start = self.close();
        match self.instructions[start] {
            Instruction::If { otherwise, .. } if otherwise > 0 => {
                self.instructions[otherwise as usize] = Instruction::Otherwise { end: here };
            }
            _ => panic!("no branch with both its parts is open"),
        }
        self.push(Instruction::EndIf);
    }

    /// Starts a loop.
    pub fn begin_loop(&mut self) {
        self.open(true);
        self.push(Instruction::Loop);
    }

    /// Ends a loop, which goes on while a number is positive.
    ///
    /// # Panics
    /// No loop is open.
    pub fn end_loop(&mut self, again: Value) {
        let [again] = self.all_need([again]);
        let start = self.close() as Place + 1;
        self.push(Instruction::EndLoop { again, start });
    }

    /// Starts a loop over whole numbers from `first` up to, not including, `end`; the number.
    pub fn begin_range(&mut self, first: Value, end: Value) -> Value {
        let [first, end] = self.all_need([first, end]);
        self.open(true);
        let counter = self.new_value(false);
        self.push(Instruction::Range { counter, first, end, exit: 0 });
        Value(counter)
    }

    /// Ends a loop over whole numbers.
    ///
    /// # Panics
    /// No loop is open.
    pub fn end_range(&mut self) {
        let start = self.open.last().map_or(0, |open| open.start as usize);
        if let Instruction::Range { counter, end, .. } = self.instructions[start] {
            self.all_need([Value(counter), Value(end)]);
            let exit = self.here() + 1;
            if let Instruction::Range { exit: of, .. } = &mut self.instructions[start] {
                *of = exit;
            }
            let start = self.close() as Place + 1;
            self.push(Instruction::EndRange { counter, end, start });
        } else {
            panic!("no loop over whole numbers is open");
        }
    }

    /// The program, whose values have registers: one that is needed no more is given to another value.
    ///
    /// # Panics
    /// A branch or a loop is open.
    pub fn finish(mut self) -> Program {
        assert!(self.open.is_empty(), "a branch or a loop is open");
        let thread = self.thread().0;
        let mut registers: Vec<Register> = vec![0; self.lives.len()];
        let mut count = 0;
        let mut new = || {
            count += 1;
            count - 1
        };
        for (_, register) in self.lives.iter().zip(&mut registers).filter(|(life, _)| life.is_constant) {
            *register = new();
        }
        // Values by the instructions that make them and that need them last.
        let mut made = vec![Vec::new(); self.instructions.len()];
        let mut ended = vec![Vec::new(); self.instructions.len()];
        for (value, life) in self.lives.iter().enumerate().filter(|(_, life)| !life.is_constant) {
            made[life.start as usize].push(value);
            ended[life.end as usize].push(value);
        }
        let mut free = Vec::new();
        for (made, ended) in made.iter().zip(&ended) {
            // What an instruction makes is never where something is that it needs.
            for value in made {
                registers[*value] = free.pop().unwrap_or_else(&mut new);
            }
            free.extend(ended.iter().map(|value| registers[*value]));
        }
        let of = |value: u32| registers[value as usize];
        let instructions = self.instructions.iter().map(|instruction| renamed(*instruction, of)).collect();
        let constants = self.constants.iter().map(|(bits, value)| (of(*value), *bits)).collect();
        Program { instructions, constants, thread: of(thread), registers: count as usize, buffers: self.buffers }
    }
}

/// An instruction on registers instead of values.
fn renamed(instruction: Instruction, of: impl Fn(u32) -> Register) -> Instruction {
    use Instruction::{
        Assign, Binary, Count, EndIf, EndLoop, EndRange, If, Load, Loop, MultiplyAdd, Otherwise, Range, SelectLess,
        Store, Unary,
    };
    match instruction {
        Unary(operation, to, a) => Unary(operation, of(to), of(a)),
        Binary(operation, to, a) => Binary(operation, of(to), a.map(of)),
        MultiplyAdd(to, a) => MultiplyAdd(of(to), a.map(of)),
        SelectLess(to, a) => SelectLess(of(to), a.map(of)),
        Load { to, buffer, at } => Load { to: of(to), buffer, at: of(at) },
        Assign { variable, value } => Assign { variable: of(variable), value: of(value) },
        Store { buffer, at, value } => Store { buffer, at: of(at), value: of(value) },
        Count { to, buffer, at } => Count { to: of(to), buffer, at: of(at) },
        If { a, b, otherwise } => If { a: of(a), b: of(b), otherwise },
        Range { counter, first, end, exit } => Range { counter: of(counter), first: of(first), end: of(end), exit },
        EndLoop { again, start } => EndLoop { again: of(again), start },
        EndRange { counter, end, start } => EndRange { counter: of(counter), end: of(end), start },
        Otherwise { .. } | EndIf | Loop => instruction,
    }
}
