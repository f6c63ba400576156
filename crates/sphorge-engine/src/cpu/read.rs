//! Copies of fields for the rest of the program, in the order of the particles' `id`.

use super::CpuEngine;
use crate::RunFailure;
use crate::lanes::PairScalar;
use crate::particles::Column;
use std::borrow::Cow;

/// Values in the order of `id`, which counts particles from zero on.
fn by_id<'a, V: Copy>(values: &[V], id: &[u32]) -> Cow<'a, [V]> {
    let mut sorted = values.to_vec();
    for (value, id) in values.iter().zip(id) {
        sorted[*id as usize] = *value;
    }
    Cow::Owned(sorted)
}

impl<T: PairScalar> CpuEngine<T> {
    pub(super) fn read_by_id(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        let id = &self.particles.id;
        let column =
            self.particles.column(field).ok_or_else(|| RunFailure::of_engine(format!("no field `{field}`")))?;
        Ok(match column {
            Column::Scalar(values) => Column::Scalar(by_id(&values, id)),
            Column::Integer(values) => Column::Integer(by_id(&values, id)),
            Column::Vector(values) => Column::Vector(by_id(&values, id)),
            Column::Symmetric(values) => Column::Symmetric(by_id(&values, id)),
            Column::Tensor(values) => Column::Tensor(by_id(&values, id)),
        })
    }
}
