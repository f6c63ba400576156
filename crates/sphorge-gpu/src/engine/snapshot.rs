//! Particles of a GPU, read back in double precision.

use super::columns::Group;
use super::initial_columns::motions;
use super::read_back::Group64;
use super::stored_fields::{FieldReader, changing_fields, stored_field};
use super::{GpuEngine, failure};
use sphorge_engine::model::{Model, Search};
use sphorge_engine::particles::{HistoryVariables, stored_behind};
use sphorge_engine::{Column, Particles, RunFailure};
use std::borrow::Cow;
use std::sync::Arc;

/// Converts groups that are read back to particles, with the additional data for this.
pub(super) struct ColumnReader<'a> {
    pub(super) model: Arc<Model>,
    /// The initial particles.
    pub(super) initial: Cow<'a, Particles>,
    pub(super) stride: usize,
    /// Number of steps begun, and the step of the last full search.
    pub(super) steps: u32,
    pub(super) last_searched: u32,
    /// Duration of the last step, s.
    pub(super) dt: f64,
    pub(super) is_renewed: bool,
}

impl ColumnReader<'_> {
    /// A stored field from groups that `read` returns; none if a model does not have it.
    fn column(
        &self,
        field: &str,
        read: &mut dyn FnMut(Group) -> Result<Arc<Vec<f32>>, RunFailure>,
    ) -> Result<Option<Column<'static>>, RunFailure> {
        let all = |number: u32| Column::Integer(vec![number; self.initial.len()].into());
        let variable = || HistoryVariables::of(&self.model).variables.iter().position(|of| of.name == field);
        if let Some(stored) = stored_field(field).filter(|stored| (stored.is_stored)(self)) {
            let group = Group64::new(read(stored.group)?, self.stride);
            return Ok(Some((stored.read)(&FieldReader { reader: self, group })));
        }
        Ok(match field {
            // Without adaptive search all particles are searched together.
            "adapted" => Some(all(u32::from(self.steps == self.last_searched))),
            "last_searched" => Some(all(self.last_searched)),
            "motion" => Some(Column::Integer(motions(&self.model, &self.initial).into())),
            _ => match variable() {
                Some(k) => {
                    let group = Group64::new(read(Group::History)?, self.stride);
                    Some(FieldReader { reader: self, group }.history(k))
                }
                None => self.initial.column(field).map(Column::into_owned),
            },
        })
    }

    /// All of the particles.
    pub(super) fn particles(
        &self,
        read: &mut dyn FnMut(Group) -> Result<Arc<Vec<f32>>, RunFailure>,
    ) -> Result<Particles, RunFailure> {
        let mut p = Particles::clone(&self.initial);
        let variables = HistoryVariables::of(&self.model).variables.into_iter().map(|variable| variable.name);
        for field in changing_fields().chain(variables) {
            if let Some(column) = self.column(field, read)? {
                p.set_column(field, &column);
            }
        }
        Ok(p)
    }
}

impl GpuEngine {
    pub(super) fn column_reader(&self) -> ColumnReader<'_> {
        let last_searched = match self.model.search {
            Search::EveryStep => self.steps,
            Search::Skin { .. } | Search::Adaptive(_) | Search::Initial => self.lists.last_searched,
        };
        ColumnReader {
            model: self.model.clone(),
            initial: Cow::Borrowed(&self.initial),
            stride: self.stride,
            steps: self.steps,
            last_searched,
            dt: self.dt,
            is_renewed: self.is_renewed(),
        }
    }

    /// A field, read only from the groups it consists of.
    pub(super) fn field(&self, field: &str) -> Result<Column<'static>, RunFailure> {
        let (reader, mut read) = (self.column_reader(), |group| self.read_once(group));
        let missing = || failure(format!("no field `{field}`"));
        let stored = stored_behind(field);
        if stored == [field] {
            return reader.column(field, &mut read)?.ok_or_else(missing);
        }
        let mut particles = Particles::new(self.initial.len());
        for stored in stored {
            particles.set_column(stored, &reader.column(stored, &mut read)?.ok_or_else(missing)?);
        }
        particles.column(field).map(Column::into_owned).ok_or_else(missing)
    }

    /// All particle data on the GPU.
    pub(super) fn snapshot(&self) -> Result<Particles, RunFailure> {
        self.column_reader().particles(&mut |group| self.read_once(group))
    }
}
