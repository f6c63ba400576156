//! What a GPU can do at most, measured on the spot.

use super::{Card, CardFault};
use crate::record::{Index, Kernel, KernelFault, Recorded};
use sphorge_physics::Real;

/// What a GPU can do at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yardstick {
    /// Bytes that a copy reads and writes in a second.
    pub bytes_per_second: f64,
    /// Operations per second of products that are added to something, two each, in single precision.
    pub operations_per_second: f64,
    /// Seconds of a launch that does next to nothing, waited for.
    pub launch_seconds: f64,
}

/// What a measurement takes at least, s.
const LONG_ENOUGH: f64 = 0.02;
/// Numbers of the largest.
const MOST: usize = 1 << 26;
/// Numbers that a thread copies: with one each a GPU spends its time on starting threads. Threads beside each other, as many as a GPU executes
/// together, read numbers beside each other.
const COPIED: usize = 16;
const TOGETHER: usize = 32;
/// Independent sums of a thread, and additions to each.
const SUMS: usize = 16;
const ADDITIONS: u32 = 256;

/// Every thread copies so many numbers.
fn copy() -> Result<Kernel, KernelFault> {
    Kernel::record("copy", |scope| {
        let (x, y) = (scope.input("x"), scope.output("y"));
        let thread = scope.thread();
        let place = thread.and(Index::of(TOGETHER as u32 - 1));
        let first = thread.and(Index::of(!(TOGETHER as u32 - 1))) * Index::of(COPIED as u32) + place;
        let at: [_; COPIED] = std::array::from_fn(|k| first + Index::of((k * TOGETHER) as u32));
        // All are on their way before the first is written.
        let numbers = at.map(|i| x.at(i));
        at.into_iter().zip(numbers).for_each(|(i, number)| y.set(i, number));
    })
}

impl Card {
    /// Measures what it can do.
    ///
    /// # Errors
    /// It does not answer, or has no room.
    pub fn yardstick(&self) -> Result<Yardstick, CardFault> {
        let recorded = |kernel: Result<Kernel, KernelFault>| {
            kernel.map_err(|fault| CardFault::Kernel { kernel: fault.kernel, why: fault.what.to_owned() })
        };
        let copy = recorded(copy())?;
        let multiply = recorded(Kernel::record("multiply", |scope| {
            let (x, y) = (scope.input("x"), scope.output("y"));
            let i = scope.thread();
            let factor = x.at(i);
            // Each another, so that no compiler finds that one would do.
            let start: [_; SUMS] = std::array::from_fn(|k| Recorded::of(k as f64));
            let sums = scope.fold(Index::of(0), Index::of(ADDITIONS), start, |_, sums, _| {
                sums.map(|sum| sum.mul_add(factor, factor))
            });
            y.set(i, sums.into_iter().reduce(|a, b| a + b).unwrap_or(factor));
        }))?;
        let most = MOST.min(self.found().largest_buffer as usize / 4);
        let (copying, seconds) = self.largest(&copy, COPIED, most)?;
        let (threads, multiplying) = self.largest(&multiply, 1, most)?;
        let (_, launch_seconds) = self.largest(&copy, COPIED, 1)?;
        Ok(Yardstick {
            bytes_per_second: 8.0 * (COPIED * copying) as f64 / seconds,
            operations_per_second: 2.0 * (SUMS * threads) as f64 * f64::from(ADDITIONS) / multiplying,
            launch_seconds,
        })
    }

    /// Threads of a launch that takes long enough, or as many as there may be of so many numbers each, and the least seconds of a few.
    fn largest(&self, kernel: &Kernel, each: usize, most: usize) -> Result<(usize, f64), CardFault> {
        let program = self.compile(kernel)?;
        // Some threads together, or one alone.
        let most = if most < TOGETHER * each { 1 } else { most / (TOGETHER * each) * TOGETHER };
        let mut threads = most.min(1 << 14);
        loop {
            let numbers = each * threads.next_multiple_of(TOGETHER);
            let (x, y) = (self.zeros(numbers)?, self.zeros(numbers)?);
            let launch = self.bind(&program, &[&x, &y], threads as u32)?;
            let mut least = f64::INFINITY;
            // The first touches memory for the first time.
            for _ in 0..5 {
                least = least.min(self.time([&launch])?);
            }
            if least >= LONG_ENOUGH || threads >= most {
                return Ok((threads, least));
            }
            threads = most.min(4 * threads);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Evaluation;

    #[test]
    fn every_number_is_copied() {
        let threads = 3 * TOGETHER;
        let numbers: Vec<f32> = (1..=threads * COPIED).map(|k| k as f32).collect();
        let mut buffers = [numbers.clone(), vec![0.0; numbers.len()]];
        Evaluation::default().run(&copy().unwrap(), &mut buffers, threads as u32);
        assert_eq!(buffers[1], numbers);
    }
}
