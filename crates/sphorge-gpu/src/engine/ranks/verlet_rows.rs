//! Lists that remain valid when ghosts change: their entries are converted to indices in the common order, which are
//! the same on all ranks.

use super::Domain;
use crate::engine::columns::{Group, Layout, groups};
use crate::engine::kernels::images::Planes;
use crate::engine::read_back::read;
use crate::engine::{GpuEngine, failure};
use sphorge_engine::RunFailure;
use std::collections::{BTreeSet, HashMap};

/// By particle, the entries of its list.
pub(in crate::engine) type Entries = Vec<Vec<u32>>;

impl Domain {
    /// The index in the common order of a particle or ghost here.
    fn place(&self, number: u32) -> u32 {
        let own = self.own();
        match (number as usize).checked_sub(own.len()) {
            None => own.start as u32 + number,
            Some(ghost) => self.places[ghost],
        }
    }

    /// Local indices of particles and ghosts, by their index in the common order.
    fn numbers(&self) -> HashMap<u32, u32> {
        let count = self.own().len() + self.places.len();
        (0..count as u32).map(|number| (self.place(number), number)).collect()
    }

    /// The particles of each other rank in the entries, ascending.
    pub(super) fn named(&self, entries: &Entries) -> Vec<Vec<u32>> {
        let own = self.own();
        let named: BTreeSet<u32> = entries.iter().flatten().map(|entry| Planes::split(*entry).0 as u32).collect();
        let mut of_ranks = vec![Vec::new(); self.ranks.size()];
        for place in named.into_iter().filter(|place| !own.contains(&(*place as usize))) {
            let rank = self.starts.partition_point(|start| *start <= place as usize) - 1;
            of_ranks[rank].push(place);
        }
        of_ranks
    }
}

impl GpuEngine {
    /// The lists of this GPU, column by column; `of` maps the entries of each row.
    fn entries_of(&self, kept: &[f32], number: impl Fn(u32) -> u32) -> Result<Entries, RunFailure> {
        let rows = read(&self.card, &self.columns, Group::Rows)?;
        let length = |i: usize| rows[groups::Rows::layout().length.column() * self.stride + i] as usize;
        let entry = |i: usize, k: usize| {
            let (neighbor, image) = Planes::split(kept[k * self.stride + i].to_bits());
            Planes::join(number(neighbor as u32), image)
        };
        Ok((0..self.initial.len()).map(|i| (0..length(i)).map(|k| entry(i, k)).collect()).collect())
    }

    /// The lists of this GPU with indices in the common order.
    pub(in crate::engine) fn list_entries(&self) -> Result<Entries, RunFailure> {
        let kept = read(&self.card, &self.columns, Group::Kept)?;
        match &self.domain {
            Some(domain) => self.entries_of(&kept, |number| domain.place(number)),
            None => self.entries_of(&kept, |number| number),
        }
    }

    /// The same for loaded lists, which have these indices.
    pub(in crate::engine) fn loaded_entries(&self, kept: &[f32]) -> Result<Entries, RunFailure> {
        self.entries_of(kept, |place| place)
    }

    /// Columns of such lists, as a state has them.
    pub(in crate::engine) fn columns_of(&self, entries: &Entries) -> Vec<f32> {
        let mut kept = vec![0.0; self.lists.capacity as usize * self.stride];
        for (i, row) in entries.iter().enumerate() {
            for (k, entry) in row.iter().enumerate() {
                kept[k * self.stride + i] = f32::from_bits(*entry);
            }
        }
        kept
    }

    /// Copies lists with indices in the common order to the GPU, with local indices.
    pub(super) fn take_entries(&self, entries: &Entries) -> Result<(), RunFailure> {
        let Some(domain) = &self.domain else { return Ok(()) };
        let numbers = domain.numbers();
        let here = |entry: &u32| {
            let (place, image) = Planes::split(*entry);
            let number = numbers.get(&(place as u32)).copied();
            number
                .map(|number| Planes::join(number, image))
                .ok_or_else(|| failure("a list names a particle that this rank does not have"))
        };
        let here = |row: &Vec<u32>| row.iter().map(here).collect::<Result<Vec<u32>, RunFailure>>();
        let entries = entries.iter().map(here).collect::<Result<Entries, RunFailure>>()?;
        let array = self.columns.array(Group::Kept).ok_or_else(|| failure("no lists"))?;
        self.card.write(array, &self.columns_of(&entries));
        Ok(())
    }
}
