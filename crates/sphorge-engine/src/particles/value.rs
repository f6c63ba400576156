//! Types a column can hold.

use super::{Column, ColumnKind};
use crate::halo::{GhostColumn, Mirror};
use crate::persist::Fixed;
use sphorge_physics::{SymmetricTensor, Tensor, Vector};
use std::borrow::Cow;

/// A value a column can hold.
pub(super) trait Value: Copy + Fixed {
    const KIND: ColumnKind;
    fn borrowed(values: &[Self]) -> Column<'_>;
    /// Takes over the values of a column of this kind.
    fn copy_from(column: &Column<'_>, values: &mut Vec<Self>);
    /// A column of particles and that of the ghosts that follows from it.
    fn ghosts<'a>(mirror: Mirror, own: &'a [Self], ghosts: &'a mut [Self]) -> GhostColumn<'a>;
    fn is_finite(&self) -> bool;
    /// Finite and above zero; of what has no order, finite.
    fn is_above_zero(&self) -> bool {
        self.is_finite()
    }
}

impl Value for f64 {
    const KIND: ColumnKind = ColumnKind::Scalar;
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Scalar(Cow::Borrowed(values))
    }
    fn copy_from(column: &Column<'_>, values: &mut Vec<Self>) {
        if let Column::Scalar(from) = column {
            values.clear();
            values.extend_from_slice(from);
        }
    }
    fn ghosts<'a>(_: Mirror, own: &'a [Self], ghosts: &'a mut [Self]) -> GhostColumn<'a> {
        GhostColumn::Scalar(own, ghosts)
    }
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
    fn is_above_zero(&self) -> bool {
        f64::is_finite(*self) && *self > 0.0
    }
}

impl Value for u32 {
    const KIND: ColumnKind = ColumnKind::Integer;
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Integer(Cow::Borrowed(values))
    }
    fn copy_from(column: &Column<'_>, values: &mut Vec<Self>) {
        if let Column::Integer(from) = column {
            values.clear();
            values.extend_from_slice(from);
        }
    }
    fn ghosts<'a>(_: Mirror, own: &'a [Self], ghosts: &'a mut [Self]) -> GhostColumn<'a> {
        GhostColumn::Integer(own, ghosts)
    }
    fn is_finite(&self) -> bool {
        true
    }
}

impl Value for Vector<f64> {
    const KIND: ColumnKind = ColumnKind::Vector;
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Vector(Cow::Borrowed(values))
    }
    fn copy_from(column: &Column<'_>, values: &mut Vec<Self>) {
        if let Column::Vector(from) = column {
            values.clear();
            values.extend_from_slice(from);
        }
    }
    fn ghosts<'a>(mirror: Mirror, own: &'a [Self], ghosts: &'a mut [Self]) -> GhostColumn<'a> {
        if mirror == Mirror::Point { GhostColumn::Point(own, ghosts) } else { GhostColumn::Vector(own, ghosts) }
    }
    fn is_finite(&self) -> bool {
        self.iter().all(|c| c.is_finite())
    }
}

impl Value for SymmetricTensor<f64> {
    const KIND: ColumnKind = ColumnKind::Symmetric;
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Symmetric(Cow::Borrowed(values))
    }
    fn copy_from(column: &Column<'_>, values: &mut Vec<Self>) {
        if let Column::Symmetric(from) = column {
            values.clear();
            values.extend_from_slice(from);
        }
    }
    fn ghosts<'a>(_: Mirror, own: &'a [Self], ghosts: &'a mut [Self]) -> GhostColumn<'a> {
        GhostColumn::Symmetric(own, ghosts)
    }
    fn is_finite(&self) -> bool {
        self.to_array().iter().all(|c| c.is_finite())
    }
}

impl Value for Tensor<f64> {
    const KIND: ColumnKind = ColumnKind::Tensor;
    fn borrowed(values: &[Self]) -> Column<'_> {
        Column::Tensor(Cow::Borrowed(values))
    }
    fn copy_from(column: &Column<'_>, values: &mut Vec<Self>) {
        if let Column::Tensor(from) = column {
            values.clear();
            values.extend_from_slice(from);
        }
    }
    fn ghosts<'a>(_: Mirror, own: &'a [Self], ghosts: &'a mut [Self]) -> GhostColumn<'a> {
        GhostColumn::Tensor(own, ghosts)
    }
    fn is_finite(&self) -> bool {
        self.iter().flatten().all(|c| c.is_finite())
    }
}
