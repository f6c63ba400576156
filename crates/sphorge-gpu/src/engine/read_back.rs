//! Groups of columns as they are read back, in double precision.

use super::columns::{Columns, Compensated, Group, Number};
use super::{GpuEngine, failure};
use crate::device::Card;
use sphorge_engine::RunFailure;
use std::sync::Arc;

/// A group that has been read back; copies share it.
#[derive(Clone)]
pub(super) struct Group64 {
    numbers: Arc<Vec<f32>>,
    stride: usize,
}

impl Group64 {
    pub(super) fn new(numbers: Arc<Vec<f32>>, stride: usize) -> Self {
        Self { numbers, stride }
    }

    /// A number of a column by its index.
    pub(super) fn at(&self, column: usize, i: usize) -> f64 {
        f64::from(self.numbers[column * self.stride + i])
    }

    pub(super) fn number(&self, of: Number<()>, i: usize) -> f64 {
        self.at(of.column(), i)
    }

    /// A number with its low part.
    pub(super) fn double(&self, of: Compensated<()>, i: usize) -> f64 {
        let [number, rest] = of.columns();
        self.at(number, i) + self.at(rest, i)
    }
}

/// The numbers of a group.
pub(super) fn read(card: &Card, columns: &Columns, group: Group) -> Result<Vec<f32>, RunFailure> {
    let array = columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
    card.read(array).map_err(failure)
}

impl GpuEngine {
    pub(super) fn group(&self, group: Group) -> Result<Group64, RunFailure> {
        let numbers = Arc::new(read(&self.card, &self.columns, group)?);
        Ok(Group64::new(numbers, self.stride))
    }

    /// Contents of a group after a step: copied back once, and kept until the next one.
    pub(super) fn read_once(&self, group: Group) -> Result<Arc<Vec<f32>>, RunFailure> {
        let known = self.read_back.borrow().iter().find(|(of, _)| *of == group).map(|(_, numbers)| numbers.clone());
        if let Some(numbers) = known {
            return Ok(numbers);
        }
        let numbers = Arc::new(read(&self.card, &self.columns, group)?);
        self.read_back.borrow_mut().push((group, numbers.clone()));
        Ok(numbers)
    }
}
