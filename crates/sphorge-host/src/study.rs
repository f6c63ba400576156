//! Programs whose execution is looked at: which ways threads have taken, and what other rounding makes of the results.

use crate::arithmetic::{Mask, Row, number};
use crate::program::{Binary, Unary};

/// What an execution tells of itself, and lets be changed.
pub(crate) trait Observer {
    /// Whether products that are added to something are rounded once, and the smaller and the larger of two numbers are numbers where one is.
    const AS_GPUS: bool;

    /// Lanes with `a < b` and others, of those that take part in an instruction.
    fn chosen(&mut self, place: usize, lanes: impl FnOnce() -> [Mask; 2]);

    /// What an operation has made.
    fn made(&mut self, operation: Kind, mask: &Mask, row: &mut Row);
}

/// Operations that round alike.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    SumOrProduct,
    QuotientOrFunction,
    Exact,
}

impl From<Unary> for Kind {
    fn from(operation: Unary) -> Self {
        match operation {
            Unary::Negate | Unary::Copy | Unary::Absolute | Unary::Floor | Unary::Number => Self::Exact,
            Unary::SquareRoot | Unary::InverseSquareRoot | Unary::Logarithm | Unary::Exponential | Unary::Cosine => {
                Self::QuotientOrFunction
            }
        }
    }
}

impl From<Binary> for Kind {
    fn from(operation: Binary) -> Self {
        match operation {
            Binary::Add | Binary::Subtract | Binary::Multiply => Self::SumOrProduct,
            Binary::Divide | Binary::Power => Self::QuotientOrFunction,
            Binary::Minimum | Binary::Maximum | Binary::WholeAdd | Binary::WholeMultiply | Binary::WholeAnd => {
                Self::Exact
            }
        }
    }
}

/// Nobody looks.
pub(crate) struct Plain;

impl Observer for Plain {
    const AS_GPUS: bool = true;

    #[inline(always)]
    fn chosen(&mut self, _: usize, _: impl FnOnce() -> [Mask; 2]) {}

    #[inline(always)]
    fn made(&mut self, _: Kind, _: &Mask, _: &mut Row) {}
}

/// Units of the last place by which operations round otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// Of sums, differences and products.
    pub of_sums_and_products: i32,
    /// Of quotients, roots, powers and functions.
    pub of_quotients_and_functions: i32,
}

/// A program looked at while it is executed as laws are on a processor: products that are added to something are rounded twice, and the smaller
/// and the larger of two numbers are the second where one is no number.
#[derive(Debug, Default)]
pub struct Study {
    /// Of each instruction, whether a choice fell this way and that.
    ways: Vec<[bool; 2]>,
    rounding: Option<Rounding>,
}

/// Operations that round at random.
#[derive(Debug)]
struct Rounding {
    state: u64,
    units: Units,
}

impl Rounding {
    fn moved(&mut self, bits: u32, units: i32) -> u32 {
        let before = number(bits);
        if before == 0.0 || !before.is_finite() {
            return bits;
        }
        // A generator of Lehmer.
        self.state = self.state * 48_271 % 2_147_483_647;
        let off = (self.state % (2 * units as u64 + 1)) as i32 - units;
        let moved = bits.wrapping_add_signed(off);
        let after = number(moved);
        if after.is_finite() && after.is_sign_negative() == before.is_sign_negative() { moved } else { bits }
    }
}

impl Study {
    /// Operations round at random, by up to so many units; another seed gives others.
    pub fn rounding_at_random(units: Units, seed: u32) -> Self {
        let state = (u64::from(seed) + 1) * 48_271 % 2_147_483_647;
        Self { rounding: Some(Rounding { state, units }), ..Self::default() }
    }

    /// Whether the choice of an instruction has fallen to `a < b`, and to the other; neither where it was not executed.
    pub fn ways(&self, place: u32) -> [bool; 2] {
        self.ways.get(place as usize).copied().unwrap_or_default()
    }
}

impl Observer for Study {
    const AS_GPUS: bool = false;

    #[inline(always)]
    fn chosen(&mut self, place: usize, lanes: impl FnOnce() -> [Mask; 2]) {
        if self.ways.len() <= place {
            self.ways.resize(place + 1, [false; 2]);
        }
        for (way, lanes) in self.ways[place].iter_mut().zip(lanes()) {
            *way |= !lanes.is_empty;
        }
    }

    #[inline(always)]
    fn made(&mut self, operation: Kind, mask: &Mask, row: &mut Row) {
        let Some(rounding) = &mut self.rounding else { return };
        let units = match operation {
            Kind::SumOrProduct => rounding.units.of_sums_and_products,
            Kind::QuotientOrFunction => rounding.units.of_quotients_and_functions,
            Kind::Exact => 0,
        };
        if units > 0 {
            for (bits, _) in row.iter_mut().zip(mask.lanes).filter(|(_, lane)| *lane != 0) {
                *bits = rounding.moved(*bits, units);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, memory};
    use std::sync::atomic::Ordering;

    #[test]
    fn the_ways_of_choices_are_those_of_threads_that_take_part() {
        let mut b = Builder::new(&["y"]);
        let (i, half) = (b.thread(), b.constant(0.5f32.to_bits()));
        let number = b.unary(Unary::Number, i);
        let outer = b.place();
        b.begin_if(half, number);
        // Of the threads from one on, which are all above a half.
        let inner = b.place();
        let chosen = b.select_less(number, half, half, number);
        b.store(0, i, chosen);
        b.begin_otherwise();
        b.end_if();
        let program = b.finish();
        let mut study = Study::default();
        program.study(&[&memory(&[0.0; 3])], &[2, 0, 1], &mut study).unwrap();
        assert_eq!((study.ways(outer), study.ways(inner)), ([true, true], [false, true]));
        let mut study = Study::default();
        program.study(&[&memory(&[0.0; 3])], &[0], &mut study).unwrap();
        assert_eq!((study.ways(outer), study.ways(inner)), ([false, true], [false, false]));
    }

    #[test]
    fn products_are_rounded_before_they_are_added_to_something() {
        let mut b = Builder::new(&["a", "fused"]);
        let i = b.thread();
        let a = b.load(0, i);
        let minus = b.binary(Binary::Multiply, a, a);
        let minus = b.unary(Unary::Negate, minus);
        let left = b.multiply_add(a, a, minus);
        b.store(1, i, left);
        let program = b.finish();
        let a = memory(&[1.000_000_1]);
        let left = memory(&[7.0]);
        let found = || f32::from_bits(left[0].load(Ordering::Relaxed));
        program.study(&[&a, &left], &[0], &mut Study::default()).unwrap();
        assert_eq!(found(), 0.0);
        program.run(&[&a, &left], 1).unwrap();
        assert!(found() > 0.0);
    }

    #[test]
    fn operations_round_within_their_units() {
        let mut b = Builder::new(&["x", "sum", "quotient"]);
        let i = b.thread();
        let x = b.load(0, i);
        let (sum, quotient) = (b.binary(Binary::Add, x, x), b.binary(Binary::Divide, x, x));
        b.store(1, i, sum);
        b.store(2, i, quotient);
        let program = b.finish();
        let count = 200;
        let x = memory(&vec![1.25; count]);
        let units = Units { of_sums_and_products: 0, of_quotients_and_functions: 2 };
        let found = |seed: u32| {
            let (sum, quotient) = (memory(&vec![0.0; count]), memory(&vec![0.0; count]));
            let mut study = Study::rounding_at_random(units, seed);
            let threads: Vec<u32> = (0..count as u32).collect();
            program.study(&[&x, &sum, &quotient], &threads, &mut study).unwrap();
            assert!(sum.iter().all(|bits| bits.load(Ordering::Relaxed) == 2.5f32.to_bits()));
            let off =
                |bits: &std::sync::atomic::AtomicU32| bits.load(Ordering::Relaxed) as i64 - i64::from(1.0f32.to_bits());
            quotient.iter().map(off).collect::<Vec<_>>()
        };
        let first = found(0);
        assert_eq!((first.iter().min(), first.iter().max()), (Some(&-2), Some(&2)));
        assert!(first == found(0) && first != found(1));
    }
}
