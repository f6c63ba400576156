//! The neighbour lists of the reference configuration, built on the GPU at the start and when it is renewed.

use super::columns::{Group, Layout, groups};
use super::read_back::read;
use super::search::SPARE;
use super::stages::Stage;
use super::{GpuEngine, failure};
use sphorge_engine::RunFailure;

impl GpuEngine {
    /// Builds the lists of the particles if sums are those of the reference configuration: counts neighbours, allocates
    /// memory and finds them again. Then finds the surfaces that meet.
    pub(super) fn make_lists(&mut self) -> Result<(), RunFailure> {
        if self.plan.stages.is_empty(Stage::CountLists) {
            return Ok(());
        }
        self.fill_lists(0.0)?;
        if self.model.has_faces() {
            self.find_surfaces()?;
        }
        Ok(())
    }

    /// Builds them again, with some more memory than needed if there was too little.
    pub(super) fn make_lists_anew(&mut self) -> Result<(), RunFailure> {
        if self.plan.stages.is_empty(Stage::CountLists) { Ok(()) } else { self.fill_lists(SPARE) }
    }

    /// Finds the neighbours of the current reference configuration; `spare` is additional capacity as a share.
    fn fill_lists(&mut self, spare: f64) -> Result<(), RunFailure> {
        self.launch(Stage::CountLists)?;
        let starts = self.list_starts()?;
        let total = starts.last().map_or(0, |total| *total as usize);
        let of_starts = self.columns.array(Group::ListStarts).ok_or_else(|| failure("no lists"))?;
        self.card.write_indices(of_starts, &starts);
        if self.columns.array(Group::List).is_none_or(|list| list.count() < total) {
            let capacity = total + (spare * total as f64) as usize;
            self.columns.insert(Group::List, self.card.zeros(capacity).map_err(failure)?);
            self.rebind()?;
        }
        self.launch(Stage::FillLists)?;
        self.find_faces()
    }

    /// Start of the list of each particle, followed by the total number of neighbours.
    fn list_starts(&self) -> Result<Vec<u32>, RunFailure> {
        let weights = read(&self.card, &self.columns, Group::Weight)?;
        let first = groups::Weight::layout().neighbors.column() * self.stride;
        let mut starts: Vec<u32> = vec![0];
        let mut total: u32 = 0;
        for neighbors in &weights[first..][..self.initial.len()] {
            let longer = total.checked_add(*neighbors as u32);
            total = longer.ok_or_else(|| failure("more than 4 294 967 295 pairs, which the card cannot index"))?;
            starts.push(total);
        }
        Ok(starts)
    }
}
