//! A whole number that says where something is.

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
