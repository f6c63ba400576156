//! Several GPUs that share the particles of a run, one to each rank.
//!
//! Particles have one common order, that of a space-filling curve through their initial positions. Each GPU has a
//! range of it for the whole run, followed by ghosts: copies of particles of other GPUs that its own may have as
//! neighbours. Ghosts of ranks behind this one come before those of ranks before it, and cells sort them by their index
//! in the common order, so that every sum is that of a single GPU, to the bit.
//!
//! The columns that ghosts receive are not listed anywhere: the recorded text of a kernel shows which columns of
//! neighbours it reads ([`touched`]). A column that was written since its last exchange is exchanged before the first
//! kernel that reads it from neighbours ([`GpuEngine::launch`]).

pub(super) mod agreement;
pub(super) mod exchange;
mod ghosts;
pub(super) mod lifetime;
mod part;
pub(super) mod touched;
pub(super) mod verlet_rows;

use super::columns::{Columns, Group, Layout, groups};
use super::initial_columns::make_columns;
use super::kernels::limits::CHUNK;
use super::kernels::sums::chunk_of;
use super::stages::Stage;
use super::{GpuEngine, failure};
use crate::device::Card;
use exchange::{Counts, Exchange, Marks};
use ghosts::{Cells, read_by_others};
use lifetime::{GhostLifetime, SharedModel};
use sphorge_engine::model::Dimensions;
use sphorge_engine::ranks::Ranks;
use sphorge_engine::{Model, Particles, RunFailure};
use sphorge_physics::Vector;
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use touched::{ALL, ColumnSet, Touched};

/// How much farther than neighbours ghosts are searched, as a share, if they are used until particles have moved.
const MARGIN: f64 = 0.25;

/// Additional capacity for ghosts, as a share.
const SPARE: f64 = 0.25;

/// The particles of a rank and its ghosts.
pub(super) struct Domain {
    pub(super) ranks: Ranks,
    /// Indices in the common order of the first particle of each rank, and the number of particles.
    starts: Vec<usize>,
    /// Particles of this rank that each other one reads, ascending.
    read_by: Vec<Vec<u32>>,
    /// Ghosts that each other rank fills.
    filled_by: Vec<usize>,
    /// Indices of the ghosts in the common order.
    places: Vec<u32>,
    /// Columns that were written since their last exchange.
    stale: RefCell<ColumnSet>,
    exchanges: RefCell<HashMap<ColumnSet, Exchange>>,
    /// Transfers marks of ghosts back.
    marks: RefCell<Option<Marks>>,
}

impl Domain {
    /// The share of a rank, given the number of particles: whole chunks, so that sums by chunks are those of one GPU.
    ///
    /// # Errors
    /// There are too few particles for so many ranks.
    pub(super) fn new(ranks: Ranks, count: usize) -> Result<Self, RunFailure> {
        let size = ranks.size();
        let chunk = chunk_of(count);
        if count < chunk * size {
            return Err(failure(format!(
                "{count} particles are too few for {size} ranks, which get whole chunks of {chunk} particles: use `--ranks {}`",
                (count / chunk).max(1)
            )));
        }
        let starts =
            (0..=size).map(|rank| if rank == size { count } else { count * rank / size / chunk * chunk }).collect();
        Ok(Self {
            read_by: vec![Vec::new(); size],
            filled_by: vec![0; size],
            places: Vec::new(),
            ranks,
            starts,
            stale: RefCell::default(),
            exchanges: RefCell::default(),
            marks: RefCell::default(),
        })
    }

    /// Indices of the particles of this rank in the common order.
    pub(super) fn own(&self) -> Range<usize> {
        let rank = self.ranks.rank();
        self.starts[rank]..self.starts[rank + 1]
    }

    /// Particles of all ranks.
    pub(super) fn total(&self) -> usize {
        self.starts[self.ranks.size()]
    }

    /// Number of particles of each rank.
    pub(super) fn counts(&self) -> Vec<usize> {
        self.starts.windows(2).map(|ends| ends[1] - ends[0]).collect()
    }

    pub(super) fn ghosts(&self) -> usize {
        self.filled_by.iter().sum()
    }

    /// Number of ghosts that follow the own particles in the common order; the others come after them.
    pub(super) fn ghosts_behind(&self) -> usize {
        self.filled_by[self.ranks.rank() + 1..].iter().sum()
    }

    /// Ranks in the order of their ghosts.
    fn in_order_of_ghosts(&self) -> impl Iterator<Item = usize> + use<> {
        let (rank, size) = (self.ranks.rank(), self.ranks.size());
        (rank + 1..size).chain(0..rank)
    }

    /// The particles that other ranks read, rank after rank.
    fn sends(&self) -> Vec<u32> {
        self.read_by.concat()
    }

    /// Informs each rank which of its particles each other rank reads, if all search neighbours of their own in these
    /// sets of positions, and some have listed particles of each other rank, by their index in the common order.
    fn choose(&mut self, cells: &Cells, sets: &[Vec<Vector<f64>>], named: &[Vec<u32>]) -> Result<(), RunFailure> {
        let own = self.own();
        let asked = self.exchange_lists(named)?;
        self.read_by = read_by_others(&self.ranks, cells, sets)?;
        for (read, asked) in self.read_by.iter_mut().zip(asked) {
            read.extend(asked.into_iter().map(|place| place - own.start as u32));
            read.sort_unstable();
            read.dedup();
        }
        let place = |of: &Vec<u32>| of.iter().map(|i| own.start as u32 + i).collect();
        let places = self.exchange_lists(&self.read_by.iter().map(place).collect::<Vec<_>>())?;
        self.filled_by = places.iter().map(Vec::len).collect();
        self.places = self.in_order_of_ghosts().flat_map(|rank| places[rank].iter().copied()).collect();
        self.exchanges.borrow_mut().clear();
        *self.marks.borrow_mut() = None;
        Ok(())
    }

    /// Sends each other rank a list of any length; returns the lists of all others.
    fn exchange_lists(&self, to: &[Vec<u32>]) -> Result<Vec<Vec<u32>>, RunFailure> {
        let (rank, size) = (self.ranks.rank(), self.ranks.size());
        let counts: Vec<u64> = to.iter().map(|of| of.len() as u64).collect();
        let all = self.ranks.gather(&counts, &vec![size; size])?;
        let lengths: Vec<usize> = (0..size).map(|from| 4 * all[from * size + rank] as usize).collect();
        let bytes = to.iter().map(|of| bytemuck::cast_slice(of).to_vec()).collect();
        let from = self.ranks.exchange(bytes, &lengths)?;
        Ok(from.iter().map(|bytes| bytemuck::pod_collect_to_vec(bytes)).collect())
    }

    /// The values of the ghosts of this rank, given those of the own particles.
    pub(super) fn of_ghosts<const N: usize>(&self, own: &[[f64; N]]) -> Result<Vec<[f64; N]>, RunFailure> {
        let message =
            |of: &Vec<u32>| of.iter().flat_map(|i| own[*i as usize].map(f64::to_le_bytes)).flatten().collect();
        let come = self.send(self.read_by.iter().map(message).collect(), 8 * N)?;
        let number = |bytes: &[u8]| f64::from_le_bytes(core::array::from_fn(|k| bytes[k]));
        Ok(come.chunks_exact(8 * N).map(|of| core::array::from_fn(|k| number(&of[8 * k..8 * k + 8]))).collect())
    }

    /// Sends a message to each other rank; returns the received values of the ghosts in their order, with this number
    /// of bytes each.
    fn send(&self, to: Vec<Vec<u8>>, width: usize) -> Result<Vec<u8>, RunFailure> {
        let lengths: Vec<usize> = self.filled_by.iter().map(|ghosts| ghosts * width).collect();
        let from = self.ranks.exchange(to, &lengths)?;
        Ok(self.in_order_of_ghosts().flat_map(|rank| from[rank].iter().copied()).collect())
    }

    /// Marks columns as changed since their last exchange.
    fn wrote(&self, columns: &Columns, written: &ColumnSet, stride: usize) {
        let mut stale = self.stale.borrow_mut();
        for (group, set) in written {
            *stale.entry(*group).or_default() |= set & existing(columns, *group, stride);
        }
    }

    /// Marks all columns of ghosts as not exchanged.
    pub(super) fn forget(&self, columns: &Columns, stride: usize) {
        let of_particles = columns.all().filter(|(group, _)| group.of_particles().is_some());
        let all = of_particles.map(|(group, _)| (*group, ALL)).collect();
        self.wrote(columns, &all, stride);
    }

    /// The columns of neighbours that kernels read and that have to be exchanged before the first of them, including
    /// those that only later kernels read and that are not written before.
    fn wanted(&self, kernels: &[&Touched]) -> ColumnSet {
        let stale = self.stale.borrow();
        let mut wanted = ColumnSet::new();
        let mut written = ColumnSet::new();
        for (k, kernel) in kernels.iter().enumerate() {
            for (group, set) in &kernel.gathered {
                let of = |of: &ColumnSet| of.get(group).copied().unwrap_or(0);
                let due = set & of(&stale) & !of(&written);
                if due != 0 {
                    *wanted.entry(*group).or_default() |= due;
                }
            }
            if k == 0 && wanted.is_empty() {
                return wanted;
            }
            for (group, set) in &kernel.written {
                *written.entry(*group).or_default() |= set;
            }
        }
        wanted
    }

    /// Exchanges columns.
    fn exchange(&self, card: &Card, columns: &Columns, set: ColumnSet, stride: usize) -> Result<(), RunFailure> {
        let mut known = self.exchanges.borrow_mut();
        if !known.contains_key(&set) {
            let counts = self.counts_of_exchange();
            known.insert(set.clone(), Exchange::new(card, columns, &set, counts, stride)?);
        }
        let Some(exchange) = known.get(&set) else { return Ok(()) };
        let packed = exchange.packed(card)?;
        let mut rest = &packed[..];
        let message = |of: &Vec<u32>| {
            let (own, behind) = rest.split_at(of.len() * exchange.width());
            rest = behind;
            bytemuck::cast_slice(own).to_vec()
        };
        let come = self.send(self.read_by.iter().map(message).collect(), 4 * exchange.width())?;
        exchange.unpack(card, &bytemuck::pod_collect_to_vec::<u8, f32>(&come));
        let mut stale = self.stale.borrow_mut();
        for (group, taken) in set {
            if let Some(columns) = stale.get_mut(&group) {
                *columns &= !taken;
            }
        }
        Ok(())
    }
}

impl Domain {
    fn counts_of_exchange(&self) -> Counts {
        Counts { sent: self.sends().len(), ghosts: self.ghosts(), own: self.own().len() }
    }

    /// Marks the particles whose ghosts were marked on other GPUs, and removes the marks of the ghosts here.
    fn return_marks(&self, card: &Card, columns: &Columns, stride: usize) -> Result<(), RunFailure> {
        let mut known = self.marks.borrow_mut();
        let marks = match &mut *known {
            Some(marks) => marks,
            none => none.insert(Marks::new(card, columns, self.counts_of_exchange(), stride)?),
        };
        let of_ghosts = marks.taken(card)?;
        let mut rest = &of_ghosts[..];
        let mut to = vec![Vec::new(); self.ranks.size()];
        for rank in self.in_order_of_ghosts() {
            let (of_rank, behind) = rest.split_at(self.filled_by[rank]);
            rest = behind;
            to[rank] = bytemuck::cast_slice(of_rank).to_vec();
        }
        let lengths: Vec<usize> = self.read_by.iter().map(|of| 4 * of.len()).collect();
        let from = self.ranks.exchange(to, &lengths)?;
        marks.set(card, &bytemuck::pod_collect_to_vec::<u8, f32>(&from.concat()));
        Ok(())
    }
}

/// Copies the first rows of columns to columns of another length.
fn copy_rows(from: &[f32], from_stride: usize, to: &mut [f32], to_stride: usize, rows: usize) {
    for (from, to) in from.chunks_exact(from_stride).zip(to.chunks_exact_mut(to_stride)) {
        to[..rows].copy_from_slice(&from[..rows]);
    }
}

/// The columns of a group.
fn existing(columns: &Columns, group: Group, stride: usize) -> u128 {
    let count = columns.array(group).map_or(0, |array| array.count() / stride);
    if count >= ALL.count_ones() as usize { ALL } else { (1 << count) - 1 }
}

/// Length of the columns of a rank with these numbers of particles and ghosts.
pub(super) fn stride_for(own: usize, ghosts: usize) -> usize {
    (own + ghosts + (SPARE * ghosts as f64) as usize).div_ceil(CHUNK) * CHUNK
}

impl GpuEngine {
    /// Launches the kernels of a stage, and before each exchanges the columns that it reads from ghosts.
    pub(super) fn launch(&self, stage: Stage) -> Result<(), RunFailure> {
        let stage = self.stages.of(stage);
        let Some(domain) = &self.domain else {
            self.card.launch(stage.iter().map(|staged| &staged.launch));
            return Ok(());
        };
        let touched: Vec<&Touched> = stage.iter().map(|staged| &staged.touched).collect();
        let mut first = 0;
        for k in 0..stage.len() {
            let wanted = domain.wanted(&touched[k..]);
            if !wanted.is_empty() {
                self.card.launch(stage[first..k].iter().map(|staged| &staged.launch));
                first = k;
                domain.exchange(&self.card, &self.columns, wanted, self.stride)?;
            }
            domain.wrote(&self.columns, &touched[k].written, self.stride);
            if touched[k].marks_neighbors {
                self.card.launch(stage[first..=k].iter().map(|staged| &staged.launch));
                first = k + 1;
                domain.return_marks(&self.card, &self.columns, self.stride)?;
            }
        }
        self.card.launch(stage[first..].iter().map(|staged| &staged.launch));
        Ok(())
    }

    /// Marks a group that was not written by a kernel of a stage as changed.
    pub(super) fn wrote(&self, group: Group) {
        if let Some(domain) = &self.domain {
            domain.wrote(&self.columns, &ColumnSet::from([(group, ALL)]), self.stride);
        }
    }

    /// Chooses ghosts again if particles have moved so far that others may have become neighbours. Lists of the
    /// reference configuration are then built again.
    pub(super) fn refresh_ghosts(&mut self) -> Result<(), RunFailure> {
        if self.domain.is_none() || !self.model.ghosts_expire() {
            return Ok(());
        }
        self.launch(Stage::GhostDisplacements)?;
        let displacements = self.displacements_of_all()?;
        let margin = MARGIN * self.grid.edge;
        let has_images = self.model.has_images();
        if displacements.longest > 0.25 * margin * margin && (has_images || displacements.diagonal > margin * margin) {
            self.choose_ghosts()?;
            self.make_lists_anew()?;
        }
        Ok(())
    }

    /// The same before a search whose ghosts are used until the next one.
    pub(super) fn choose_ghosts_of_search(&mut self) -> Result<(), RunFailure> {
        if self.domain.is_some() && self.model.ghost_lifetime() == GhostLifetime::OneSearch {
            self.choose_ghosts()?;
        }
        Ok(())
    }

    /// Chooses ghosts by the current positions of particles and those in the reference configuration.
    pub(super) fn choose_ghosts(&mut self) -> Result<(), RunFailure> {
        if self.domain.is_none() {
            return Ok(());
        }
        let places = |group: Group| -> Result<Vec<Vector<f64>>, RunFailure> {
            let numbers = self.group(group)?;
            let of = groups::Place::layout().position;
            Ok((0..self.initial.len()).map(|i| [0, 1, 2].map(|a| numbers.double(of.axis(a), i))).collect())
        };
        let sets = sets(&self.model, || places(Group::Place), || places(Group::Reference))?;
        let cells = cells(&self.model, self.grid_of_facets().edge);
        let entries = match self.loaded_lists.take() {
            Some(kept) => Some(self.loaded_entries(&kept)?),
            None if self.model.lists_outlast_ghosts() && self.lists.is_made => Some(self.list_entries()?),
            None => None,
        };
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let named = entries.as_ref().map_or_else(|| vec![Vec::new(); domain.ranks.size()], |of| domain.named(of));
        domain.choose(&cells, &sets, &named)?;
        let fits = self.initial.len() + domain.ghosts() <= self.stride;
        if !fits {
            self.grow()?;
        }
        if let Some(entries) = entries {
            self.take_entries(&entries)?;
        }
        self.take_ghosts()
    }

    /// Applies the choice of ghosts: particles to be sent, kernels for their number, and positions of the particles at
    /// this time.
    pub(super) fn take_ghosts(&mut self) -> Result<(), RunFailure> {
        let Some(domain) = &self.domain else { return Ok(()) };
        domain.forget(&self.columns, self.stride);
        let sends = self.card.indices(&domain.sends()).map_err(failure)?;
        self.columns.insert(Group::Sends, sends);
        if self.model.ghosts_expire() {
            let place = super::read_back::read(&self.card, &self.columns, Group::Place)?;
            if let Some(array) = self.columns.array(Group::GhostsAt) {
                self.card.write(array, &place);
            }
        }
        self.find_surface_ghosts()?;
        self.rebind()?;
        self.set_step()
    }

    /// Extends columns to the current length; ghosts are not exchanged yet.
    pub(super) fn as_long_as_columns(&self, numbers: Vec<f32>, before: usize) -> Vec<f32> {
        if before == self.stride {
            return numbers;
        }
        let mut longer = vec![0.0; numbers.len() / before * self.stride];
        copy_rows(&numbers, before, &mut longer, self.stride, self.initial.len());
        longer
    }

    /// Extends the columns, for more ghosts. Other ranks need not.
    fn grow(&mut self) -> Result<(), RunFailure> {
        let Some(domain) = &self.domain else { return Ok(()) };
        let (own, before, stride) = (self.initial.len(), self.stride, stride_for(self.initial.len(), domain.ghosts()));
        let longer =
            make_columns(&self.card, (&self.model, &self.initial), stride, &self.grid, true).map_err(failure)?;
        let shorter = std::mem::replace(&mut self.columns, longer);
        self.stride = stride;
        for (group, array) in shorter.into_all() {
            let is_kept = matches!(group, Group::Kept | Group::Stored);
            if group.of_particles().is_some() || is_kept {
                let columns = array.count() / before;
                let numbers = self.card.read(&array).map_err(failure)?;
                // Rows behind the particles keep their initial values.
                let mut longer = match self.columns.array(group).filter(|longer| longer.count() == columns * stride) {
                    Some(longer) => self.card.read(longer).map_err(failure)?,
                    None => vec![0.0; columns * stride],
                };
                copy_rows(&numbers, before, &mut longer, stride, own);
                self.columns.insert(group, self.card.numbers(&longer).map_err(failure)?);
            } else if group.outlasts_columns() {
                self.columns.insert(group, array);
            }
        }
        self.plan = self.plan_of(self.references())?;
        Ok(())
    }
}

/// The sets of positions in which neighbours are searched.
fn sets(
    model: &Model,
    present: impl FnOnce() -> Result<Vec<Vector<f64>>, RunFailure>,
    reference: impl FnOnce() -> Result<Vec<Vector<f64>>, RunFailure>,
) -> Result<Vec<Vec<Vector<f64>>>, RunFailure> {
    Ok(match (model.is_total_lagrangian(), model.ghost_lifetime()) {
        (false, _) => vec![present()?],
        (true, GhostLifetime::OneReference) => vec![reference()?],
        (true, _) => vec![present()?, reference()?],
    })
}

/// Chooses ghosts at the start, when nothing is on the GPU yet.
pub(super) fn choose_at_start(domain: &mut Domain, model: &Model, p: &Particles, edge: f64) -> Result<(), RunFailure> {
    let places = || Ok(p.position.clone());
    let nobody = vec![Vec::new(); domain.ranks.size()];
    domain.choose(&cells(model, edge), &sets(model, places, places)?, &nobody)
}

/// Cells as wide as the distance of neighbours, and the margin if ghosts are used until particles have moved.
fn cells(model: &Model, edge: f64) -> Cells {
    let margin = if model.ghosts_expire() { MARGIN } else { 0.0 };
    let axes = match model.dimensions {
        Dimensions::One => 1,
        Dimensions::PlaneStrain => 2,
        Dimensions::Three => 3,
    };
    Cells::new((1.0 + margin) * edge, axes, model.periodic)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_copied_to_columns_of_another_length() {
        let shorter = [1.0, 2.0, 0.0, 3.0, 4.0, 0.0];
        let mut longer = [9.0; 8];
        copy_rows(&shorter, 3, &mut longer, 4, 2);
        assert_eq!(longer, [1.0, 2.0, 9.0, 9.0, 3.0, 4.0, 9.0, 9.0]);
    }
}
