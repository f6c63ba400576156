//! Recorded kernels executed in memory as laws are on a processor: what a GPU has to do. Which ways their choices fall, and what other rounding makes
//! of the results.

use crate::record::{Kernel, Operation, Value};
use crate::source::instructions;
use sphorge_host::{Program, Study, memory};
use std::collections::HashMap;
use std::sync::atomic::{AtomicU32, Ordering};

pub(crate) use sphorge_host::Units;

/// Elements of a buffer, whole numbers as their bits.
pub(crate) type Contents = Vec<f32>;

/// What threads have chosen so far: of each branch and choice, whether it fell this way and that; and how operations round.
#[derive(Default)]
pub(crate) struct Evaluation {
    choices: HashMap<(Value, Value), [bool; 2]>,
    study: Study,
}

/// A kernel with its buffers in memory.
pub(crate) struct Loaded {
    program: Program,
    choices: Vec<(u32, (Value, Value))>,
    buffers: Vec<Vec<AtomicU32>>,
}

impl Loaded {
    pub(crate) fn new(kernel: &Kernel, buffers: &[Contents]) -> Self {
        let instructions = instructions(kernel);
        let buffers = buffers.iter().map(|numbers| memory(numbers)).collect();
        Self { program: instructions.program, choices: instructions.choices, buffers }
    }

    /// An element of a buffer.
    pub(crate) fn number(&self, buffer: usize, index: usize) -> f32 {
        f32::from_bits(self.buffers[buffer][index].load(Ordering::Relaxed))
    }
}

impl Evaluation {
    /// Operations round at random, by up to so many units; another number gives others.
    pub(crate) fn rounding_at_random(units: Units, number: u32) -> Self {
        Self { study: Study::rounding_at_random(units, number), ..Self::default() }
    }

    /// Runs `threads` threads over the buffers of a kernel.
    pub(crate) fn run(&mut self, kernel: &Kernel, buffers: &mut [Contents], threads: u32) {
        let loaded = Loaded::new(kernel, buffers);
        self.run_loaded(&loaded, &(0..threads).collect::<Vec<_>>());
        for (k, numbers) in buffers.iter_mut().enumerate() {
            numbers.iter_mut().enumerate().for_each(|(i, number)| *number = loaded.number(k, i));
        }
    }

    /// Some threads of a kernel that is in memory.
    pub(crate) fn run_loaded(&mut self, loaded: &Loaded, threads: &[u32]) {
        let buffers: Vec<_> = loaded.buffers.iter().map(Vec::as_slice).collect();
        loaded.program.study(&buffers, threads, &mut self.study).unwrap();
        for (place, compared) in &loaded.choices {
            let ways = self.study.ways(*place);
            if ways != [false; 2] {
                let known = self.choices.entry(*compared).or_default();
                *known = [known[0] || ways[0], known[1] || ways[1]];
            }
        }
    }

    /// What was compared where a choice always fell the same way.
    pub(crate) fn one_way(&self, kernel: &Kernel) -> Vec<(Operation, Operation)> {
        let one_way = self.choices.iter().filter(|(_, taken)| **taken != [true; 2]);
        one_way.map(|((a, b), _)| (kernel.operations[*a as usize], kernel.operations[*b as usize])).collect()
    }
}

/// Whole numbers as the contents of a buffer.
pub(crate) fn whole(values: &[u32]) -> Contents {
    values.iter().map(|value| f32::from_bits(*value)).collect()
}
