//! The execution of a program.

use crate::LANES;
use crate::arithmetic::{Mask, Row, assign, binary, multiply_add, select_less, unary};
use crate::program::{Beyond, Binary, Instruction, Program, Register};
use crate::study::{Kind, Observer, Plain, Study};
use std::sync::atomic::{AtomicU32, Ordering};

/// A buffer of a launch. Other programs may work on it, but nothing that another thread does is waited for.
type Buffer<'a> = &'a [AtomicU32];

impl Program {
    /// Executes it for so many threads on buffers in their order.
    ///
    /// # Errors
    /// A thread asks for what is beyond the end of a buffer; what was done before stays done.
    ///
    /// # Panics
    /// There are more buffers or fewer than the program has.
    pub fn run(&self, buffers: &[Buffer<'_>], threads: u32) -> Result<(), Beyond> {
        self.observed(buffers, 0..threads, &mut Plain)
    }

    /// Executes it for some of the threads, as laws are on a processor, and looks at what they do.
    ///
    /// # Errors
    /// As above.
    ///
    /// # Panics
    /// As above.
    pub fn study(&self, buffers: &[Buffer<'_>], threads: &[u32], study: &mut Study) -> Result<(), Beyond> {
        self.observed(buffers, threads.iter().copied(), study)
    }

    fn observed<O: Observer>(
        &self,
        buffers: &[Buffer<'_>],
        mut threads: impl Iterator<Item = u32>,
        observer: &mut O,
    ) -> Result<(), Beyond> {
        assert_eq!(buffers.len(), self.buffers(), "buffers of the launch, and of the program");
        let mut machine = Machine::new(self, buffers);
        while machine.start(threads.by_ref().take(LANES)) {
            machine.execute_by_best_instructions(observer).map_err(|fault| machine.described(fault))?;
        }
        Ok(())
    }
}

/// A lane that asks for an element beyond the end of a buffer.
struct Fault {
    buffer: u32,
    index: u32,
    lane: usize,
}

/// Writes a register of a machine that is none of those that are read; `spare` stands for it meanwhile. No closure: one is compiled by itself, and then
/// without the instructions of the processor.
macro_rules! write_register {
    ($own:ident, $spare:ident, $register:expr, |$to:ident| $write:expr) => {{
        std::mem::swap(&mut $own.registers[$register as usize], &mut $spare);
        {
            let $to: &mut Row = &mut $spare;
            $write;
        }
        std::mem::swap(&mut $own.registers[$register as usize], &mut $spare);
    }};
}

struct Machine<'a> {
    program: &'a Program,
    buffers: &'a [Buffer<'a>],
    /// Each by itself, so that one is taken out, written and put back.
    #[expect(clippy::vec_box, reason = "a register is taken out by its pointer, without a copy")]
    registers: Vec<Box<Row>>,
    mask: Mask,
    /// Masks of what is around the innermost branch or loop; with a branch, that of its other part too.
    outer: Vec<Mask>,
}

impl<'a> Machine<'a> {
    fn new(program: &'a Program, buffers: &'a [Buffer<'a>]) -> Self {
        let mut registers = vec![Box::new([0; LANES]); program.registers];
        for (register, bits) in &program.constants {
            *registers[*register as usize] = [*bits; LANES];
        }
        let mask = Mask::first(0);
        Self { program, buffers, registers, mask, outer: Vec::new() }
    }

    /// Makes it ready for the next threads, as many as there are lanes, or fewer; whether there are any.
    fn start(&mut self, threads: impl Iterator<Item = u32>) -> bool {
        let mut count = 0;
        let lanes = &mut self.registers[self.program.thread as usize];
        for (lane, thread) in lanes.iter_mut().zip(threads) {
            *lane = thread;
            count += 1;
        }
        self.mask = Mask::first(count);
        count > 0
    }

    fn described(&self, fault: Fault) -> Beyond {
        Beyond {
            buffer: self.program.buffers[fault.buffer as usize].clone(),
            length: self.buffers[fault.buffer as usize].len(),
            index: fault.index,
            thread: self.registers[self.program.thread as usize][fault.lane],
        }
    }

    /// With the instructions of this processor; results are the same with all.
    fn execute_by_best_instructions<O: Observer>(&mut self, observer: &mut O) -> Result<(), Fault> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            // SAFETY: the processor has these instructions.
            return unsafe { self.execute_avx2(observer) };
        }
        self.execute(observer)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn execute_avx2<O: Observer>(&mut self, observer: &mut O) -> Result<(), Fault> {
        self.execute(observer)
    }

    #[inline(always)]
    fn row(&self, register: Register) -> &Row {
        &self.registers[register as usize]
    }

    #[inline(always)]
    fn execute<O: Observer>(&mut self, observer: &mut O) -> Result<(), Fault> {
        let program = self.program;
        let (mut place, mut spare) = (0, Box::new([0; LANES]));
        while let Some(instruction) = program.instructions.get(place) {
            place += 1;
            match *instruction {
                Instruction::Unary(operation, to, a) => write_register!(self, spare, to, |to| {
                    unary(operation, to, &self.mask, self.row(a));
                    observer.made(operation.into(), &self.mask, to);
                }),
                Instruction::Binary(operation, to, [a, b]) => write_register!(self, spare, to, |to| {
                    let of = [self.row(a), self.row(b)];
                    if O::AS_GPUS {
                        binary::<true>(operation, to, &self.mask, of);
                    } else {
                        binary::<false>(operation, to, &self.mask, of);
                    }
                    observer.made(operation.into(), &self.mask, to);
                }),
                Instruction::MultiplyAdd(to, [a, b, c]) if O::AS_GPUS => {
                    write_register!(self, spare, to, |to| multiply_add(to, [self.row(a), self.row(b), self.row(c)]));
                }
                Instruction::MultiplyAdd(to, [a, b, c]) => write_register!(self, spare, to, |to| {
                    binary::<false>(Binary::Multiply, to, &self.mask, [self.row(a), self.row(b)]);
                    observer.made(Kind::SumOrProduct, &self.mask, to);
                    let product = *to;
                    binary::<false>(Binary::Add, to, &self.mask, [&product, self.row(c)]);
                    observer.made(Kind::SumOrProduct, &self.mask, to);
                }),
                Instruction::SelectLess(to, [a, b, c, d]) => {
                    observer.chosen(place - 1, || self.mask.less(self.row(a), self.row(b)));
                    write_register!(self, spare, to, |to| select_less(
                        to,
                        [self.row(a), self.row(b), self.row(c), self.row(d)]
                    ));
                }
                Instruction::Assign { variable, value } => {
                    write_register!(self, spare, variable, |to| assign(to, &self.mask, self.row(value)));
                }
                Instruction::Load { to, buffer, at } => {
                    let is_beyond;
                    write_register!(self, spare, to, |to| is_beyond = self.load(to, buffer, at));
                    if is_beyond {
                        return Err(self.fault(buffer, at));
                    }
                }
                Instruction::Store { buffer, at, value } => {
                    for lane in self.lanes() {
                        let index = self.row(at)[lane];
                        match self.buffers[buffer as usize].get(index as usize) {
                            Some(element) => element.store(self.row(value)[lane], Ordering::Relaxed),
                            None => return Err(Fault { buffer, index, lane }),
                        }
                    }
                }
                Instruction::Count { to, buffer, at } => {
                    for lane in self.lanes() {
                        let index = self.row(at)[lane];
                        match self.buffers[buffer as usize].get(index as usize) {
                            Some(element) => {
                                let before = element.fetch_add(1, Ordering::Relaxed);
                                self.registers[to as usize][lane] = before;
                            }
                            None => return Err(Fault { buffer, index, lane }),
                        }
                    }
                }
                Instruction::If { a, b, otherwise } => {
                    let [then, others] = self.mask.less(self.row(a), self.row(b));
                    observer.chosen(place - 1, || [then.clone(), others.clone()]);
                    if then.is_empty {
                        place = otherwise as usize;
                    }
                    self.outer.push(std::mem::replace(&mut self.mask, then));
                    self.outer.push(others);
                }
                Instruction::Otherwise { end } => {
                    self.mask = self.popped();
                    if self.mask.is_empty {
                        place = end as usize;
                    }
                }
                Instruction::EndIf => self.mask = self.popped(),
                Instruction::Loop => self.outer.push(self.mask.clone()),
                Instruction::EndLoop { again, start } => {
                    self.mask = self.mask.positive(self.row(again));
                    if self.mask.is_empty {
                        self.mask = self.popped();
                    } else {
                        place = start as usize;
                    }
                }
                Instruction::Range { counter, first, end, exit } => {
                    let going_on = self.mask.below(self.row(first), self.row(end));
                    if going_on.is_empty {
                        place = exit as usize;
                    } else {
                        write_register!(self, spare, counter, |to| *to = *self.row(first));
                        self.outer.push(std::mem::replace(&mut self.mask, going_on));
                    }
                }
                Instruction::EndRange { counter, end, start } => {
                    self.registers[counter as usize].iter_mut().for_each(|index| *index = index.wrapping_add(1));
                    self.mask = self.mask.below(self.row(counter), self.row(end));
                    if self.mask.is_empty {
                        self.mask = self.popped();
                    } else {
                        place = start as usize;
                    }
                }
            }
        }
        Ok(())
    }

    /// The mask that was put aside last.
    #[inline(always)]
    fn popped(&mut self) -> Mask {
        // Every program ends what it begins.
        self.outer.pop().unwrap_or_else(|| Mask::first(0))
    }

    /// The lanes that take part, in ascending order.
    #[inline(always)]
    fn lanes(&self) -> impl Iterator<Item = usize> + use<> {
        let lanes = self.mask.lanes;
        (0..LANES).filter(move |lane| lanes[*lane] != 0)
    }

    /// Elements of a buffer; whether a lane that takes part asks for one that is beyond its end.
    #[inline(always)]
    fn load(&self, to: &mut Row, buffer: u32, at: Register) -> bool {
        let (buffer, at) = (self.buffers[buffer as usize], self.row(at));
        let Some(last) = buffer.len().checked_sub(1) else { return true };
        let mut is_beyond = false;
        for (k, to) in to.iter_mut().enumerate() {
            let index = (at[k] & self.mask.lanes[k]) as usize;
            is_beyond |= index > last;
            *to = buffer[index.min(last)].load(Ordering::Relaxed);
        }
        is_beyond
    }

    #[cold]
    fn fault(&self, buffer: u32, at: Register) -> Fault {
        let length = self.buffers[buffer as usize].len();
        let at = self.row(at);
        let lane = self.lanes().find(|lane| at[*lane] as usize >= length).unwrap_or(0);
        Fault { buffer, index: at[lane], lane }
    }
}

#[cfg(test)]
mod tests;
