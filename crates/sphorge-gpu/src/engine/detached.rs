//! Fields of all particles that are copied from a GPU while its engine continues.

use super::columns::Group;
use super::snapshot::ColumnReader;
use super::stored_fields::groups_of_particles;
use super::{GpuEngine, failure};
use crate::device::Pending;
use sphorge_engine::{Column, FieldSource, Particles, RunFailure};
use std::borrow::Cow;
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

impl GpuEngine {
    /// A copy of the current particles in flight; none if there is no memory for copies during the run.
    pub(super) fn detached(&self) -> Result<Option<DetachedColumns>, RunFailure> {
        let reader = self.column_reader();
        let reader = ColumnReader { initial: Cow::Owned(self.initial.clone()), ..reader };
        let queued = groups_of_particles().into_iter().filter_map(|group| Some((group, self.columns.array(group)?)));
        let pending =
            queued.map(|(group, array)| Ok(self.card.queue_read(array).map_err(failure)?.map(|copy| (group, copy))));
        let Some(groups) = pending.collect::<Result<Option<Vec<_>>, RunFailure>>()? else { return Ok(None) };
        Ok(Some(DetachedColumns {
            count: self.initial.len(),
            pending: RefCell::new(Some(OnTheirWay { reader, groups })),
            particles: OnceCell::new(),
        }))
    }
}

/// Fields of all particles in flight from a GPU that continues meanwhile.
pub(super) struct DetachedColumns {
    count: usize,
    /// The groups, until particles are made from them.
    pending: RefCell<Option<OnTheirWay>>,
    particles: OnceCell<Particles>,
}

/// Groups that are copied, and their conversion to particles.
struct OnTheirWay {
    reader: ColumnReader<'static>,
    groups: Vec<(Group, Pending)>,
}

impl DetachedColumns {
    fn particles(&self) -> Result<&Particles, RunFailure> {
        if let Some(OnTheirWay { reader, groups }) = self.pending.take() {
            let mut arrived = Vec::new();
            for (group, pending) in groups {
                arrived.push((group, Arc::new(pending.wait().map_err(failure)?)));
            }
            let mut find = |wanted: Group| {
                let found = arrived.iter().find(|(group, _)| *group == wanted).map(|(_, numbers)| numbers.clone());
                found.ok_or_else(|| failure(format!("no column {wanted:?}")))
            };
            // Nothing else sets it, because its source exists only once.
            let _ = self.particles.set(reader.particles(&mut find)?);
        }
        self.particles.get().ok_or_else(|| failure("the card was lost while its fields were copied"))
    }
}

impl FieldSource for DetachedColumns {
    fn count(&self) -> usize {
        self.count
    }

    fn read(&self, field: &str) -> Result<Column<'_>, RunFailure> {
        let p = self.particles()?;
        Ok(p.column(field).ok_or_else(|| failure(format!("no field `{field}`")))?.by_id(&p.id))
    }
}
