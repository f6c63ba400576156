//! What is done with the numbers of all lanes. Everything here is inlined into functions that are compiled for the
//! instructions of a processor.

use crate::LANES;
use crate::program::{Binary, Unary};

/// The bits of a number of every lane.
pub(crate) type Row = [u32; LANES];

/// The lanes that take part: all bits set, or none.
#[derive(Clone)]
pub(crate) struct Mask {
    pub(crate) lanes: Row,
    pub(crate) is_full: bool,
    pub(crate) is_empty: bool,
}

impl Mask {
    #[inline(always)]
    fn new(lanes: Row) -> Self {
        let (mut all, mut any) = (u32::MAX, 0);
        for lane in lanes {
            all &= lane;
            any |= lane;
        }
        Self { lanes, is_full: all != 0, is_empty: any == 0 }
    }

    /// The first lanes, so many.
    #[inline(always)]
    pub(crate) fn first(count: usize) -> Self {
        let mut lanes = [0; LANES];
        for (k, lane) in lanes.iter_mut().enumerate() {
            *lane = bits(k < count);
        }
        Self::new(lanes)
    }

    /// Of these lanes those for which something is true.
    #[inline(always)]
    fn with(&self, of: impl Fn(usize) -> bool) -> Self {
        let mut lanes = self.lanes;
        for (k, lane) in lanes.iter_mut().enumerate() {
            *lane &= bits(of(k));
        }
        Self::new(lanes)
    }

    /// Lanes with `a < b`, and the others.
    #[inline(always)]
    pub(crate) fn less(&self, a: &Row, b: &Row) -> [Self; 2] {
        let less = self.with(|k| number(a[k]) < number(b[k]));
        let mut others = self.lanes;
        for (other, lane) in others.iter_mut().zip(less.lanes) {
            *other &= !lane;
        }
        [less, Self::new(others)]
    }

    /// Lanes whose number is positive.
    #[inline(always)]
    pub(crate) fn positive(&self, a: &Row) -> Self {
        self.with(|k| number(a[k]) > 0.0)
    }

    /// Lanes with a whole number below another.
    #[inline(always)]
    pub(crate) fn below(&self, a: &Row, b: &Row) -> Self {
        self.with(|k| a[k] < b[k])
    }
}

#[inline(always)]
fn bits(is_set: bool) -> u32 {
    if is_set { u32::MAX } else { 0 }
}

/// One of two, without a branch: those of many lanes are chosen together.
#[inline(always)]
fn either(takes_first: bool, first: u32, second: u32) -> u32 {
    first & bits(takes_first) | second & !bits(takes_first)
}

#[inline(always)]
pub(crate) fn number(bits: u32) -> f32 {
    f32::from_bits(bits)
}

/// For every lane.
#[inline(always)]
fn each(to: &mut Row, of: impl Fn(usize) -> u32) {
    for (k, to) in to.iter_mut().enumerate() {
        *to = of(k);
    }
}

/// A function of the library of C, for the lanes that take part: it costs more than to look.
#[inline(always)]
fn call(to: &mut Row, mask: &Mask, of: impl Fn(usize) -> f32) {
    for (k, to) in to.iter_mut().enumerate() {
        if mask.lanes[k] != 0 {
            *to = of(k).to_bits();
        }
    }
}

#[inline(always)]
pub(crate) fn unary(operation: Unary, to: &mut Row, mask: &Mask, a: &Row) {
    match operation {
        Unary::Negate => each(to, |k| (-number(a[k])).to_bits()),
        Unary::Copy => *to = *a,
        Unary::SquareRoot => each(to, |k| number(a[k]).sqrt().to_bits()),
        Unary::InverseSquareRoot => each(to, |k| (1.0 / number(a[k]).sqrt()).to_bits()),
        Unary::Absolute => each(to, |k| number(a[k]).abs().to_bits()),
        Unary::Logarithm => call(to, mask, |k| number(a[k]).ln()),
        Unary::Exponential => call(to, mask, |k| number(a[k]).exp()),
        Unary::Cosine => call(to, mask, |k| number(a[k]).cos()),
        Unary::Floor => each(to, |k| number(a[k]).floor() as i32 as u32),
        Unary::Number => each(to, |k| (a[k] as f32).to_bits()),
    }
}

#[inline(always)]
pub(crate) fn binary<const AS_GPUS: bool>(operation: Binary, to: &mut Row, mask: &Mask, [a, b]: [&Row; 2]) {
    match operation {
        Binary::Add => each(to, |k| (number(a[k]) + number(b[k])).to_bits()),
        Binary::Subtract => each(to, |k| (number(a[k]) - number(b[k])).to_bits()),
        Binary::Multiply => each(to, |k| (number(a[k]) * number(b[k])).to_bits()),
        Binary::Divide => each(to, |k| (number(a[k]) / number(b[k])).to_bits()),
        // On GPUs as `fminf` and `fmaxf` have it.
        Binary::Minimum => each(to, |k| {
            let takes_first = (number(a[k]) < number(b[k])) | (AS_GPUS & number(b[k]).is_nan());
            either(takes_first, a[k], b[k])
        }),
        Binary::Maximum => each(to, |k| {
            let takes_first = (number(a[k]) > number(b[k])) | (AS_GPUS & number(b[k]).is_nan());
            either(takes_first, a[k], b[k])
        }),
        Binary::Power => call(to, mask, |k| number(a[k]).powf(number(b[k]))),
        Binary::WholeAdd => each(to, |k| a[k].wrapping_add(b[k])),
        Binary::WholeMultiply => each(to, |k| a[k].wrapping_mul(b[k])),
        Binary::WholeAnd => each(to, |k| a[k] & b[k]),
    }
}

#[inline(always)]
pub(crate) fn multiply_add(to: &mut Row, [a, b, c]: [&Row; 3]) {
    each(to, |k| number(a[k]).mul_add(number(b[k]), number(c[k])).to_bits());
}

#[inline(always)]
pub(crate) fn select_less(to: &mut Row, [a, b, then, otherwise]: [&Row; 4]) {
    each(to, |k| either(number(a[k]) < number(b[k]), then[k], otherwise[k]));
}

/// Overwrites lanes that take part.
#[inline(always)]
pub(crate) fn assign(to: &mut Row, mask: &Mask, value: &Row) {
    if mask.is_full {
        *to = *value;
    } else {
        for (k, to) in to.iter_mut().enumerate() {
            *to = *to & !mask.lanes[k] | value[k] & mask.lanes[k];
        }
    }
}
