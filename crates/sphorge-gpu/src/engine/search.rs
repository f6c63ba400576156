//! Decides when stored lists are searched again.

use super::columns::{Group, Layout, groups};
use super::kernels::audit;
use super::kernels::images::Planes;
use super::kernels::reduce::{self, Together};
use super::kernels::verlet::{HIGH, LONGEST, LONGEST_ROW, LOW, MARKED_ROWS, THINNEST_SKIN, WAYS};
use super::read_back::read;
use super::stages::Stage;
use super::{GpuEngine, failure};
use rayon::prelude::*;
use sphorge_engine::model::{AdaptiveSearch, Search};
use sphorge_engine::neighbors::NeighborList;
use sphorge_engine::persist::{Archive, ArchiveError, Persist};
use sphorge_engine::{Audit, ContactCandidates, RunFailure, SearchReport, SearchedMaterial, audit_of};
use sphorge_physics::Vector;

/// Capacity beyond the longest list so far, as a share of it.
pub(super) const SPARE: f64 = 0.25;

/// Reduction of the numbers of [`Group::Ways`].
pub(super) const DISPLACEMENT_REDUCTION: [Together; WAYS] = {
    let mut together = [Together::Largest; WAYS];
    together[LOW] = Together::Least;
    together[LOW + 1] = Together::Least;
    together[LOW + 2] = Together::Least;
    together[MARKED_ROWS] = Together::Sum;
    together[THINNEST_SKIN] = Together::Least;
    together
};

/// State of stored lists.
#[derive(Debug, Default)]
pub(super) struct VerletLists {
    /// Capacity in neighbours.
    pub(super) capacity: u32,
    /// Whether they have been searched.
    pub(super) is_made: bool,
    /// Number of the step of the last full search.
    pub(super) last_searched: u32,
    /// Whether contact candidates have been determined.
    has_candidates: bool,
    /// Whether lists are those of former reference configurations.
    pub(super) had_other_references: bool,
}

/// Displacements of all particles since the last full search.
pub(super) struct Displacements {
    /// Square of the largest, m².
    pub(super) longest: f64,
    /// Square of the diagonal of their bounding box, m².
    pub(super) diagonal: f64,
    /// The thinnest skin left by the growth of smoothing lengths, in supports, m.
    skin: f64,
}

impl GpuEngine {
    /// Makes the lists valid for the updated positions.
    pub(super) fn refresh_lists(&mut self) -> Result<SearchReport, RunFailure> {
        self.launch(Stage::Follow)?;
        let due = match self.model.search {
            Search::Skin { fraction } => !self.lists.is_made || self.moved_beyond_skin(fraction)?,
            Search::Adaptive(rule) if self.lists.is_made => return self.search_adaptively(rule),
            Search::EveryStep => true,
            Search::Adaptive(_) | Search::Initial => !self.lists.is_made,
        };
        if due {
            self.search_all()?;
        } else if !self.model.contact_pairs().is_empty() {
            // The contact uses the cells.
            self.launch(Stage::Sorting)?;
        }
        Ok(SearchReport { searched_fraction: f64::from(u8::from(due)) })
    }

    /// Whether two particles may have approached each other by more than the skin. Bounds are twice the largest
    /// displacement since the search, and the largest difference of displacements; images in symmetry planes have other
    /// displacements than their particles.
    fn moved_beyond_skin(&self, fraction: f64) -> Result<bool, RunFailure> {
        let smallest = self.model.bodies.iter().map(|body| body.smoothing_length).fold(f64::INFINITY, f64::min);
        let displacements = self.displacements(Stage::Displacements)?;
        let skin = if self.model.smoothing_follows_density() { displacements.skin } else { fraction * smallest };
        let skin = skin.max(0.0) * self.model.numerics.kernel.support();
        Ok(skin == 0.0
            || displacements.longest > 0.25 * skin * skin
                && (self.model.has_images() || displacements.diagonal > skin * skin))
    }

    /// Searches the particles that flow; with the guard also those that strain and contact candidates.
    fn search_adaptively(&mut self, rule: AdaptiveSearch) -> Result<SearchReport, RunFailure> {
        if self.must_wrap()? {
            self.search_all()?;
            return Ok(SearchReport { searched_fraction: 1.0 });
        }
        if rule.guard.is_some() {
            self.refresh_candidates()?;
        }
        self.launch(Stage::Mark)?;
        let marked = self.sum_in_order(self.of_rows()?(MARKED_ROWS))?;
        let share = marked / self.total_count() as f64;
        if rule.guard.is_some() && share > AdaptiveSearch::ALL_ABOVE {
            self.search_all()?;
            return Ok(SearchReport { searched_fraction: 1.0 });
        }
        if marked > 0.0 || !self.model.contact_pairs().is_empty() {
            self.launch(Stage::Sorting)?;
        }
        if marked > 0.0 {
            self.launch(Stage::SearchMarked)?;
            if self.longest_row()? > f64::from(self.lists.capacity) {
                // Neighbours beyond the capacity are lost.
                self.search_all()?;
                return Ok(SearchReport { searched_fraction: 1.0 });
            }
        }
        Ok(SearchReport { searched_fraction: share })
    }

    /// Whether particles are to be wrapped to the other end of a periodic cell. All are wrapped together, when the CPU
    /// engine would create its images again.
    fn must_wrap(&self) -> Result<bool, RunFailure> {
        let is_closed = self.stages.is_empty(Stage::DisplacementsSinceSearch);
        Ok(!is_closed
            && self.displacements(Stage::DisplacementsSinceSearch)?.longest.sqrt()
                > AdaptiveSearch::IMAGE_MARGIN * self.reach())
    }

    /// How far kernels reach at the start, m.
    fn reach(&self) -> f64 {
        let largest = self.model.bodies.iter().map(|body| body.smoothing_length).fold(0.0, f64::max);
        self.model.numerics.kernel.support() * largest
    }

    /// Determines contact candidates, as the CPU engine does and on the processor, when particles have moved so far
    /// that this is necessary: a few times during the perforation of a plate.
    fn refresh_candidates(&mut self) -> Result<(), RunFailure> {
        let reach = self.reach();
        if self.lists.has_candidates
            && self.displacements(Stage::Displacements)?.longest <= ContactCandidates::lasts(reach).powi(2)
        {
            return Ok(());
        }
        let place = read(&self.card, &self.columns, Group::Place)?;
        let places = |numbers: &[f32]| {
            let at = |column: usize, i: usize| f64::from(numbers[column * self.stride + i]);
            let position = |a: usize, i: usize| {
                let [high, low] = groups::Place::layout().position.axis(a).columns();
                at(high, i) + at(low, i)
            };
            let own = (0..self.initial.len()).into_par_iter().with_min_len(1 << 10);
            self.of_all_ranks(&own.map(|i| [0, 1, 2].map(|a| position(a, i))).collect::<Vec<Vector<f64>>>())
        };
        let material = SearchedMaterial {
            position: &places(&place)?,
            origin: &self.of_all_ranks(&self.initial.position)?,
            searched_at: &places(&read(&self.card, &self.columns, Group::SearchedAt)?)?,
            body: &self.of_all_ranks(&self.initial.body)?,
            smoothing_length: &self.of_all_ranks(&self.initial.smoothing_length)?,
        };
        let mut candidates = ContactCandidates::default();
        candidates.find(&self.model, &material, &self.lists_of_all()?, reach)?;
        let flag = |i: usize| if candidates.is_candidate(i) { 1.0 } else { 0.0 };
        let mut flags: Vec<f32> = self.own_places().map(flag).collect();
        flags.resize(self.stride, 0.0);
        for (group, numbers) in [(Group::Candidates, &flags), (Group::FoundAt, &place)] {
            let array = self.columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
            self.card.write(array, numbers);
        }
        self.lists.has_candidates = true;
        Ok(())
    }

    /// The lists of the particles of all ranks, without images.
    fn lists_of_all(&self) -> Result<NeighborList, RunFailure> {
        let mut list = NeighborList::default();
        let without_images = |entries: &mut dyn Iterator<Item = u32>, row: &mut Vec<u32>| {
            let neighbors = entries.map(Planes::split).filter(|(_, image)| *image == 0);
            row.extend(neighbors.map(|(j, _)| j as u32));
        };
        if self.domain.is_none() {
            let (kept, rows) =
                (read(&self.card, &self.columns, Group::Kept)?, read(&self.card, &self.columns, Group::Rows)?);
            let (stride, lengths) = (self.stride, &rows[groups::Rows::layout().length.column() * self.stride..]);
            list.fill(self.initial.len(), |i, row| {
                let mut entries = (0..lengths[i] as usize).map(|k| kept[k * stride + i].to_bits());
                without_images(&mut entries, row);
            });
            return Ok(list);
        }
        let own = self.list_entries()?;
        let lengths = self.of_all_ranks(&own.iter().map(Vec::len).collect::<Vec<usize>>())?;
        let entries = self.joined_of_ranks(&own.concat())?;
        let mut starts = vec![0];
        starts.extend(lengths.iter().scan(0, |end, length| {
            *end += length;
            Some(*end)
        }));
        list.fill(lengths.len(), |i, row| {
            without_images(&mut entries[starts[i]..starts[i + 1]].iter().copied(), row);
        });
        Ok(list)
    }

    /// The longest list of all ranks.
    fn longest_row(&self) -> Result<f64, RunFailure> {
        let [longest] = self.largest_of_ranks([self.of_rows()?(LONGEST_ROW).fold(0.0, f64::max)])?;
        Ok(longest)
    }

    fn displacements(&self, since: Stage) -> Result<Displacements, RunFailure> {
        self.launch(since)?;
        self.displacements_of_all()
    }

    /// Results of the displacement kernels, over the particles of all ranks.
    pub(super) fn displacements_of_all(&self) -> Result<Displacements, RunFailure> {
        let numbers = self.of_rows()?;
        let largest = |k: usize| numbers(k).fold(f64::NEG_INFINITY, f64::max);
        let least = |k: usize| numbers(k).fold(f64::INFINITY, f64::min);
        let of_rank = [LONGEST, HIGH, HIGH + 1, HIGH + 2].map(largest);
        let [longest, high @ ..] = self.largest_of_ranks(of_rank)?;
        let [low @ .., skin] = self.largest_of_ranks([LOW, LOW + 1, LOW + 2, THINNEST_SKIN].map(|k| -least(k)))?;
        Ok(Displacements { longest, diagonal: (0..3).map(|a| (high[a] + low[a]).powi(2)).sum(), skin: -skin })
    }

    /// The numbers of the remaining rows, by index.
    fn of_rows(&self) -> Result<impl Fn(usize) -> Box<dyn Iterator<Item = f64>>, RunFailure> {
        let numbers = read(&self.card, &self.columns, reduce::left(Group::Ways, reduce::rows(self.stride)))?;
        let rows = numbers.len() / WAYS;
        Ok(move |k: usize| {
            let of = numbers[k * rows..(k + 1) * rows].to_vec();
            Box::new(of.into_iter().map(f64::from)) as Box<dyn Iterator<Item = f64>>
        })
    }

    /// Searches the neighbours of all particles, with more memory if there is too little.
    fn search_all(&mut self) -> Result<(), RunFailure> {
        self.launch(Stage::Wrap)?;
        self.find_all()
    }

    /// The same with particles that are already wrapped along periodic axes.
    fn find_all(&mut self) -> Result<(), RunFailure> {
        self.choose_ghosts_of_search()?;
        self.launch(Stage::Sorting)?;
        self.launch(Stage::Search)?;
        let longest = self.longest_row()?;
        if longest > f64::from(self.lists.capacity) {
            self.allocate_lists(((1.0 + SPARE) * longest) as u32 + 1)?;
            self.set_step()?;
            self.launch(Stage::Search)?;
        }
        self.lists.is_made = true;
        self.lists.last_searched = self.steps;
        Ok(())
    }

    /// Searches again at the positions of the last search, with the smoothing lengths of that time.
    pub(super) fn search_again(&mut self) -> Result<(), RunFailure> {
        let column = |group: Group| read(&self.card, &self.columns, group);
        let now = column(Group::Place)?;
        let lengths = self.model.smoothing_follows_density().then(|| column(Group::Constants)).transpose()?;
        let (then, stride) = (column(Group::SearchedAt)?, self.stride);
        let (place, searched) = then.split_at(groups::SearchedAt::layout().smoothing_length.column() * stride);
        self.overwrite(Group::Place, place)?;
        if let Some(mut lengths) = lengths.clone() {
            let first = groups::Constants::layout().smoothing_length.column() * stride;
            lengths[first..first + stride].copy_from_slice(searched);
            self.overwrite(Group::Constants, &lengths)?;
        }
        let last_searched = self.lists.last_searched;
        self.find_all()?;
        self.lists.last_searched = last_searched;
        // Columns may have become longer, for more ghosts.
        self.overwrite(Group::Place, &self.as_long_as_columns(now, stride))?;
        let lengths = lengths.map(|lengths| self.as_long_as_columns(lengths, stride));
        lengths.map_or(Ok(()), |lengths| self.overwrite(Group::Constants, &lengths))
    }

    /// Replaces the numbers of a group.
    fn overwrite(&self, group: Group, numbers: &[f32]) -> Result<(), RunFailure> {
        let array = self.columns.array(group).ok_or_else(|| failure(format!("no column {group:?}")))?;
        self.card.write(array, numbers);
        self.wrote(group);
        Ok(())
    }

    /// Audits the lists at the current positions, if an audit is due.
    pub(super) fn audit_lists(&self) -> Result<Option<Audit>, RunFailure> {
        let due = |n: u64| self.dt > 0.0 && !self.is_idle() && u64::from(self.steps).is_multiple_of(n);
        if !self.model.audit.is_some_and(due) {
            return Ok(None);
        }
        self.launch(Stage::Audit)?;
        let audited = self.group(Group::Audit)?;
        let numbers = |i: usize| core::array::from_fn(|field| audited.at(field, i));
        let own: Vec<[f64; audit::AUDIT]> = (0..self.initial.len()).map(numbers).collect();
        let all = self.of_all_ranks(&own)?;
        let rows: Vec<_> = all.iter().map(|of| audit::rows(|field| of[field])).collect();
        Ok(Some(audit_of(&rows, &self.of_all_ranks(&self.initial.mass)?)))
    }

    /// Allocates lists with this capacity for each particle; their contents are lost.
    fn allocate_lists(&mut self, capacity: u32) -> Result<(), RunFailure> {
        let kept = self.card.zeros(capacity as usize * self.stride).map_err(failure)?;
        self.columns.insert(Group::Kept, kept);
        if self.model.keeps_distances() {
            let stored = self.card.zeros(3 * capacity as usize * self.stride).map_err(failure)?;
            self.columns.insert(Group::Stored, stored);
        }
        self.lists.capacity = capacity;
        self.rebind()
    }

    /// Saves or loads the state of stored lists, and allocates memory for the lists that are to be loaded.
    pub(super) fn persist_lists(&mut self, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let mut capacity = self.lists.capacity;
        if self.saves_lists() {
            capacity.persist("kept.room", archive)?;
        }
        self.lists.is_made.persist("kept.is_made", archive)?;
        self.lists.has_candidates.persist("kept.has_candidates", archive)?;
        self.lists.last_searched.persist("kept.last_searched", archive)?;
        if capacity != self.lists.capacity {
            self.allocate_lists(capacity).map_err(|fault| ArchiveError::Unsupported(fault.to_string()))?;
        }
        Ok(())
    }
}
