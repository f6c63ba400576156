//! Numbers as bytes.

use pyo3::{
    prelude::*,
    types::{PyByteArray, PyBytes},
};
use sphorge::engine::Column;

/// A field as it crosses: bytes of numbers in the order of the machine, their kind as numpy names it, and numbers per particle.
pub(crate) struct Packed {
    pub(crate) bytes: Vec<u8>,
    pub(crate) kind: &'static str,
    pub(crate) width: usize,
}

impl Packed {
    pub(crate) fn of(column: &Column<'_>) -> Self {
        let width = column.kind().width();
        let (kind, bytes) = match column {
            Column::Integer(values) => ("u4", values.iter().flat_map(|x| x.to_ne_bytes()).collect()),
            Column::Scalar(values) => ("f8", values.iter().flat_map(|x| x.to_ne_bytes()).collect()),
            _ => {
                let mut bytes = Vec::with_capacity(8 * width * column.len());
                for i in 0..column.len() {
                    (0..width).for_each(|k| bytes.extend(column.component(i, k).to_ne_bytes()));
                }
                ("f8", bytes)
            }
        };
        Self { bytes, kind, width }
    }

    /// For an array that nobody writes to.
    pub(crate) fn read_only<'py>(&self, py: Python<'py>) -> (Bound<'py, PyBytes>, &'static str, usize) {
        (PyBytes::new(py, &self.bytes), self.kind, self.width)
    }

    /// For an array of one's own.
    pub(crate) fn owned<'py>(&self, py: Python<'py>) -> (Bound<'py, PyByteArray>, &'static str, usize) {
        (PyByteArray::new(py, &self.bytes), self.kind, self.width)
    }
}
