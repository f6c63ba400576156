//! The part of the lists in a saved state.
//!
//! Rows of a full search are not saved: the same search of the points, with the same cells, builds them again on any
//! number of ranks. Rows of an adaptive search, and stored distances, are saved.

use super::super::CpuEngine;
use super::super::stored::StoredPairs;
use super::{Lists, Reach};
use crate::RunFailure;
use crate::halo::{self, Exchanged, FieldSet, GhostColumn};
use crate::lanes::PairScalar;
use crate::model::Search;
use crate::neighbors::{are_places, is_place};
use crate::persist::{Archive, ArchiveError, Persist, persist_pieces_or_none, require};
use smallvec::smallvec;

impl<T: PairScalar> CpuEngine<T> {
    /// Whether rows are those of the last full search.
    fn is_searched_whole(&self) -> bool {
        !self.keeps_distances() && !matches!(self.model.search, Search::Adaptive(_))
    }

    /// Saves or loads the lists; [`Self::complete_state`] completes a loaded state.
    pub(in crate::cpu) fn persist_lists(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        let (count, is_searched_whole) = (self.particles.len(), self.is_searched_whole());
        let Lists { list, stored, searcher, points, smoothing_length, candidates, .. } = &mut self.lists;
        let domain = self.domain.as_ref();
        if is_searched_whole {
            // Those of ghosts follow.
            points.truncate(count);
            smoothing_length.truncate(count);
            persist_pieces_or_none(points, count, &of("points"), archive)?;
            persist_pieces_or_none(smoothing_length, count, &of("smoothing_length"), archive)?;
        } else {
            let number = |j| domain.map_or(j, |domain| domain.point(j));
            list.persist(count, number, &of("list"), archive)?;
            StoredPairs::persist(stored, list, &of("stored"), archive)?;
            candidates.persist(count, &of("candidates"), archive)?;
        }
        searcher.persist(&of("searcher"), archive)?;
        let lists = &mut self.lists;
        lists.searches.persist(&of("searches"), archive)?;
        lists.stale.persist(&of("stale"), archive)?;
        lists.smoothing_lengths.persist(&of("smoothing_lengths"), archive)?;
        lists.smoothing_lengths_at_search.persist(&of("smoothing_lengths_at_search"), archive)?;
        lists.displacement.persist(&of("displacement"), archive)?;
        lists.displacement_at_search.persist(&of("displacement_at_search"), archive)?;
        lists.displacement_at_frame.persist(&of("displacement_at_frame"), archive)?;
        if archive.is_saving() {
            // Skins are measured from these positions, whether they are saved or not.
            self.place_ghost_points();
            return Ok(());
        }
        self.check_lists(name)
    }

    /// Refuses loaded lists that do not fit the particles and ghosts.
    fn check_lists(&self, name: &str) -> Result<(), ArchiveError> {
        let Lists { list, stored, searcher, points, smoothing_length, candidates, stale, .. } = &self.lists;
        let count = self.particles.len();
        let in_place = |part: &str, unfit: Option<usize>| match unfit {
            Some(block) => require(false, &format!("{name}.{part}.{block}")),
            None => Ok(()),
        };
        require(candidates.fits(count), &format!("{name}.candidates.is_candidate"))?;
        let kept = stored.is_some() == self.keeps_distances() || *stale && stored.is_none();
        require(kept, &format!("{name}.stored.is_there"))?;
        if *stale {
            // Searched before they are read.
            return Ok(());
        }
        let all = self.domain.as_ref().map_or_else(|| count + self.ghosts.count(), |domain| domain.searched());
        require(searcher.fits(all), &format!("{name}.searcher.sorted_at"))?;
        if let Some(contacts) = &self.contacts
            && let Some(search) = &contacts.search
        {
            let named = search.points(count, self.domain.as_deref());
            in_place("foreign", contacts.foreign().first_unfit(count, named))?;
        }
        if self.is_searched_whole() {
            let is_length = |&h: &f64| h > 0.0 && is_place(h);
            require(are_places(points), &format!("{name}.points"))?;
            require(smoothing_length.iter().all(is_length), &format!("{name}.smoothing_length"))?;
            let (smallest, largest) = self.lists.smoothing_lengths_at_search;
            let fits = smallest > 0.0 && is_place(largest) && smallest <= largest;
            require(fits, &format!("{name}.smoothing_lengths_at_search"))?;
            require(points.len() == count, &format!("{name}.points"))?;
            require(smoothing_length.len() == count, &format!("{name}.smoothing_length"))
        } else {
            let first = self.domain.as_ref().map_or(0, |domain| domain.own().start);
            in_place("list", list.first_unfit(first, count, all))
        }
    }

    /// Completes a loaded state once all ranks have loaded theirs.
    ///
    /// # Errors
    /// A rank is lost.
    pub(in crate::cpu) fn complete_state(&mut self) -> Result<(), RunFailure> {
        if let Some(contacts) = &mut self.contacts {
            contacts.complete(&self.particles, self.domain.as_deref(), &self.has_come_apart)?;
        }
        let is_again = self.is_searched_whole() && !self.lists.stale;
        if is_again && let Some(domain) = &self.domain {
            let points = domain.gather(&self.lists.points)?;
            let smoothing_length = domain.gather(&self.lists.smoothing_length)?;
            let reach = (self.reach_factor(), self.lists.smoothing_lengths_at_search);
            self.search_common((points, smoothing_length), reach, self.lists.displacement_at_search)?;
        }
        if !self.is_searched_whole()
            && !self.lists.stale
            && let Some(domain) = &mut self.domain
        {
            self.ghosts.halo = Box::new(domain.adopt(&mut self.lists.list)?);
            domain.forget_smoothing_lengths();
        }
        // Ghosts receive data that do not change between searches only at searches, and the next one may be far away.
        self.ghosts.exchange(&[FieldSet::Search], &self.particles);
        if is_again {
            self.place_ghost_points();
            let (count, factor) = (self.particles.len(), self.reach_factor());
            if self.domain.is_none() {
                let (range, displacement) = (self.lists.smoothing_lengths_at_search, self.lists.displacement_at_search);
                let Lists { list, searcher, points, smoothing_length, .. } = &mut self.lists;
                let reach = Reach { smoothing_length, factor, range };
                searcher.search(points, count, &reach, displacement, self.instructions, list);
            }
            self.keep_own_bodies();
        }
        if !self.lists.stale {
            self.take_foreign_pairs();
        }
        self.domain.as_ref().map_or(Ok(()), |domain| domain.ranks.check_lost())
    }

    /// Appends the positions and smoothing lengths that ghosts had at the last full search to those of the particles.
    fn place_ghost_points(&mut self) {
        let Lists { points, smoothing_length, .. } = &self.lists;
        let (count, ghosts) = (points.len(), self.ghosts.count());
        if count < self.particles.len() || !self.is_searched_whole() || ghosts == 0 {
            return;
        }
        let (mut places, mut lengths) = (vec![[0.0; 3]; ghosts], vec![0.0; ghosts]);
        let columns =
            smallvec![GhostColumn::Point(points, &mut places), GhostColumn::Scalar(smoothing_length, &mut lengths)];
        halo::fill(smallvec![Exchanged { halo: self.ghosts.halo.as_ref(), columns }]);
        self.lists.points.extend(places);
        self.lists.smoothing_length.extend(lengths);
    }
}
