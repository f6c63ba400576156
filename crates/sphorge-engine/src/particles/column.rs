//! A field of all particles, by value type.

use sphorge_physics::{SymmetricTensor, Tensor, Vector};
use std::borrow::Cow;

/// Value type of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// One number.
    Scalar,
    /// One whole number.
    Integer,
    /// Three components.
    Vector,
    /// Six components xx, yy, zz, xy, yz, xz.
    Symmetric,
    /// Nine components row by row.
    Tensor,
}

impl ColumnKind {
    /// Components per particle.
    pub fn width(self) -> usize {
        match self {
            Self::Scalar | Self::Integer => 1,
            Self::Vector => 3,
            Self::Symmetric => 6,
            Self::Tensor => 9,
        }
    }
}

/// Values of one field, one entry per particle.
#[derive(Clone, Debug)]
pub enum Column<'a> {
    /// One number.
    Scalar(Cow<'a, [f64]>),
    /// One whole number.
    Integer(Cow<'a, [u32]>),
    /// Three components.
    Vector(Cow<'a, [Vector<f64>]>),
    /// Symmetric tensor.
    Symmetric(Cow<'a, [SymmetricTensor<f64>]>),
    /// General tensor.
    Tensor(Cow<'a, [Tensor<f64>]>),
}

impl Column<'_> {
    /// Value type.
    pub fn kind(&self) -> ColumnKind {
        match self {
            Self::Scalar(_) => ColumnKind::Scalar,
            Self::Integer(_) => ColumnKind::Integer,
            Self::Vector(_) => ColumnKind::Vector,
            Self::Symmetric(_) => ColumnKind::Symmetric,
            Self::Tensor(_) => ColumnKind::Tensor,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        match self {
            Self::Scalar(c) => c.len(),
            Self::Integer(c) => c.len(),
            Self::Vector(c) => c.len(),
            Self::Symmetric(c) => c.len(),
            Self::Tensor(c) => c.len(),
        }
    }

    /// The values in the order of the particles' `id`, which counts them from zero on.
    #[must_use]
    pub fn by_id(&self, id: &[u32]) -> Column<'static> {
        fn sorted<V: Copy>(values: &[V], id: &[u32]) -> Cow<'static, [V]> {
            let mut sorted = values.to_vec();
            for (value, id) in values.iter().zip(id) {
                sorted[*id as usize] = *value;
            }
            Cow::Owned(sorted)
        }
        match self {
            Self::Scalar(c) => Column::Scalar(sorted(c, id)),
            Self::Integer(c) => Column::Integer(sorted(c, id)),
            Self::Vector(c) => Column::Vector(sorted(c, id)),
            Self::Symmetric(c) => Column::Symmetric(sorted(c, id)),
            Self::Tensor(c) => Column::Tensor(sorted(c, id)),
        }
    }

    /// The same values, held by the column itself.
    #[must_use]
    pub fn into_owned(self) -> Column<'static> {
        match self {
            Self::Scalar(c) => Column::Scalar(Cow::Owned(c.into_owned())),
            Self::Integer(c) => Column::Integer(Cow::Owned(c.into_owned())),
            Self::Vector(c) => Column::Vector(Cow::Owned(c.into_owned())),
            Self::Symmetric(c) => Column::Symmetric(Cow::Owned(c.into_owned())),
            Self::Tensor(c) => Column::Tensor(Cow::Owned(c.into_owned())),
        }
    }

    /// No particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Component `k` of particle `i`; `k` counts as in [`ColumnKind`].
    pub fn component(&self, i: usize, k: usize) -> f64 {
        match self {
            Self::Scalar(c) => c[i],
            Self::Integer(c) => f64::from(c[i]),
            Self::Vector(c) => c[i][k],
            Self::Symmetric(c) => c[i].to_array()[k],
            Self::Tensor(c) => c[i][k / 3][k % 3],
        }
    }

    /// One number for particle `i`: the value itself, or the Euclidean (Frobenius) norm of a vector or tensor.
    pub fn magnitude(&self, i: usize) -> f64 {
        match self {
            Self::Scalar(c) => c[i],
            Self::Integer(c) => f64::from(c[i]),
            Self::Vector(c) => c[i].iter().map(|v| v * v).sum::<f64>().sqrt(),
            Self::Symmetric(c) => c[i].double_dot(c[i]).sqrt(),
            Self::Tensor(c) => c[i].iter().flatten().map(|v| v * v).sum::<f64>().sqrt(),
        }
    }
}
