//! Copies of fields for the rest of the program, in the order of the particles' `id`.

use super::CpuEngine;
use crate::RunFailure;
use crate::engine::Part;
use crate::lanes::PairScalar;
use crate::particles::Column;

impl<T: PairScalar> CpuEngine<T> {
    /// A field, in the order of the particles.
    pub(super) fn field(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        self.particles.column(field).ok_or_else(|| RunFailure::of_engine(format!("no field `{field}`")))
    }

    pub(super) fn read_by_id(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        if self.domain.is_none() {
            return Ok(self.field(field)?.by_id(&self.particles.id));
        }
        let (column, id) = (self.collect(field)?, self.collect("id")?);
        Ok(match &id {
            Column::Integer(id) => column.by_id(id),
            _ => column,
        })
    }
}
