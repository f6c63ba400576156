//! A whole number that says where something is.

use super::Recorded;
use super::operation::{Operation, Value};
use super::recorder::with;
use core::ops::{Add, Mul};

/// A place in a buffer, or a number of elements, of a kernel that is being recorded; below `2^32`.
#[derive(Clone, Copy, Debug)]
pub struct Index(pub(super) Value);

impl Index {
    /// A known one.
    pub fn of(value: u32) -> Self {
        Self(with(|recorder| recorder.value(Operation::Whole(value))))
    }
}

impl Index {
    /// The bits both have in common: the remainder of the division by a power of two, which is that less one.
    pub fn and(self, mask: Self) -> Self {
        Self(with(|recorder| recorder.value(Operation::WholeAnd(self.0, mask.0))))
    }

    /// The largest that is not above a number between `-2^31` and `2^31`; negative ones count from `2^32` down, so that sums come out right.
    pub fn floor(number: Recorded) -> Self {
        Self(with(|recorder| recorder.value(Operation::Floor(number.0))))
    }

    /// As a number, exact below `2^24`.
    pub fn number(self) -> Recorded {
        Recorded(with(|recorder| recorder.value(Operation::Number(self.0))))
    }
}

impl Add for Index {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(with(|recorder| recorder.value(Operation::WholeAdd(self.0, other.0))))
    }
}

impl Mul for Index {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(with(|recorder| recorder.value(Operation::WholeMultiply(self.0, other.0))))
    }
}
