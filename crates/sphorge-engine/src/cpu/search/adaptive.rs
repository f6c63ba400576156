//! Adaptive search: only particles that deform plastically are searched again (Fraser).
//!
//! Fraser's rule looks only at the plastic strain of a step. The guard adds what the rule does not detect;
//! `docs/adaptive-search.md` derives each of its bounds:
//!
//! - elastic strain: a particle whose strain since its last search passes a bound is searched;
//! - contact candidates: particles near another body, near another fragment of their own, or near material that came from far away are
//!   searched every step ([`super::contact_candidates`]);
//! - one-sidedness: rows of neighbours that a searched particle gains or loses are patched, so that both rows of a pair
//!   list it or neither;
//! - old gradients: kernel values are those of the current positions. Without the guard they are those of the last
//!   search.

use super::super::CpuEngine;
use super::{CHUNK, moved_beyond};
use crate::RunFailure;
use crate::engine::SearchReport;
use crate::halo::Images;
use crate::lanes::PairScalar;
use crate::model::{AdaptiveSearch, Search};
use crate::neighbors::{PartialSearch, Reach, mark};
use crate::particles::Particles;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU8, Ordering};

impl<T: PairScalar> CpuEngine<T> {
    pub(super) fn search_adaptively(&mut self, adaptive: AdaptiveSearch) -> Result<SearchReport, RunFailure> {
        if self.lists.stale || self.ghosts_used_up()? {
            return self.search_all();
        }
        self.follow_frame()?;
        if adaptive.guard.is_some() {
            let reach = self.largest_reach();
            let factor = self.model.numerics.kernel.support();
            let (domain, lists) = (self.domain.as_ref(), &mut self.lists);
            let (images, displacement) = (|| Images::new(&self.model), lists.displacement);
            lists.candidates.refresh(images, &self.particles, domain, &lists.list, displacement, reach, factor)?;
        }
        let own = self.mark(adaptive);
        let (marked, count) = match &self.domain {
            None => (own, self.particles.len()),
            Some(domain) => (domain.ranks.gather_one(own)?.into_iter().sum(), domain.count()),
        };
        if adaptive.guard.is_some() && marked as f64 > AdaptiveSearch::ALL_ABOVE * count as f64 {
            return self.search_all();
        }
        self.step.any_adapted = marked > 0;
        if marked == 0 {
            return Ok(SearchReport { searched_fraction: 0.0 });
        }
        let one_sided = adaptive.guard.is_none();
        if self.domain.is_some() {
            self.search_marked_among_ranks(one_sided)?;
        } else {
            self.search_marked(one_sided);
        }
        let super::Lists { list, points, marks, stored, .. } = &mut self.lists;
        if let Some(stored) = stored {
            // Without ghosts the particles are all there is.
            let points = if self.ghosts.count() == 0 { &self.particles.position } else { &*points };
            let first = self.domain.as_ref().map_or(0, |domain| domain.own().start);
            let searched = |i: usize| marks[first + i].load(Ordering::Relaxed) == mark::REBUILD;
            stored.rebuild(list, points, searched);
        }
        // Every particle that can touch another body is a contact candidate and was searched: all pairs of bodies are
        // in the rows.
        self.take_contacts();
        Ok(SearchReport { searched_fraction: marked as f64 / count as f64 })
    }

    /// Rebuilds the rows of the marked particles, and patches others.
    fn search_marked(&mut self, one_sided: bool) {
        let count = self.particles.len();
        if self.ghosts.count() > 0 {
            self.place_points();
        }
        let factor = self.reach_factor();
        let (displacement, range) = (self.lists.displacement, self.lists.smoothing_lengths);
        let super::Lists { list, searcher, points, smoothing_length, marks, to_search, .. } = &mut self.lists;
        let sources = self.ghosts.halo.sources();
        // Without ghosts the particles are all there is.
        let (points, smoothing_length) = if sources.is_empty() {
            (&self.particles.position, &self.particles.smoothing_length)
        } else {
            (&*points, &*smoothing_length)
        };
        marks.truncate(count);
        mark_images(marks, to_search, sources);
        let reach = Reach { smoothing_length, factor, range };
        let partial = PartialSearch { points, sources, rows: 0..count, reach, displacement, marks };
        searcher.rebuild_rows(&partial, self.instructions, list, to_search, one_sided);
    }

    /// Resets the quantities that are measured from the last full search.
    pub(super) fn note_search(&mut self) {
        if self.keeps_distances() {
            let lists = &mut self.lists;
            lists.stored.get_or_insert_default().rebuild(&lists.list, &lists.points, |_| true);
        }
        if matches!(self.model.search, Search::Adaptive(_)) {
            self.lists.displacement_at_search = self.lists.displacement;
            let p = &mut self.particles;
            p.searched_at.copy_from_slice(&p.position);
            p.strain_since_search.fill(0.0);
            p.plastic_since_search.fill(0.0);
        }
    }

    /// Whether sums use the distances of the last search.
    pub(super) fn keeps_distances(&self) -> bool {
        match self.model.search {
            Search::EveryStep | Search::Skin { .. } => false,
            Search::Adaptive(adaptive) => adaptive.guard.is_none(),
            Search::Initial => !self.formulation.is_initial(),
        }
    }

    /// Whether a particle may have come near a symmetry plane or a periodic end without a ghost.
    fn ghosts_used_up(&self) -> Result<bool, RunFailure> {
        let allowed = AdaptiveSearch::IMAGE_MARGIN * self.largest_reach();
        if !self.ghosts.halo.has_images()
            || self.lists.displacement.is_within(self.lists.displacement_at_search, allowed)
        {
            return Ok(false);
        }
        let moved = moved_beyond(&self.particles.position, &self.particles.searched_at, allowed);
        self.domain.as_ref().map_or(Ok(moved), |domain| domain.any(moved))
    }

    /// Marks the particles of this rank to be searched; returns how many.
    fn mark(&mut self, adaptive: AdaptiveSearch) -> usize {
        let count = self.particles.len();
        let super::Lists { marks, to_search, candidates, .. } = &mut self.lists;
        marks.resize_with(count.max(marks.len()), AtomicU8::default);
        let step = self.step.count as u32;
        let Particles {
            plastic_strain_increment,
            adapted,
            last_searched,
            strain_since_search,
            plastic_since_search,
            ..
        } = &mut self.particles;
        let (plastic_strain_increment, candidates) = (&*plastic_strain_increment, &*candidates);
        let columns = (
            marks[..count].par_chunks_mut(CHUNK),
            adapted.par_chunks_mut(CHUNK),
            last_searched.par_chunks_mut(CHUNK),
            strain_since_search.par_chunks_mut(CHUNK),
            plastic_since_search.par_chunks_mut(CHUNK),
        );
        columns.into_par_iter().enumerate().for_each(|(c, (marks, adapted, last, strain, plastic))| {
            for k in 0..marks.len() {
                let i = c * CHUNK + k;
                let flow = if adaptive.accumulate { plastic[k] } else { plastic_strain_increment[i] };
                let search = flow > adaptive.plastic_strain_threshold
                    || adaptive.guard.is_some_and(|bound| strain[k] > bound || candidates.is_candidate(i));
                *marks[k].get_mut() = if search { mark::REBUILD } else { mark::KEEP };
                adapted[k] = u32::from(search);
                if search {
                    (last[k], strain[k], plastic[k]) = (step, 0.0, 0.0);
                }
            }
        });
        to_search.clear();
        let marked = |i: &u32| *marks[*i as usize].get_mut() == mark::REBUILD;
        to_search.extend((0..count as u32).filter(marked));
        to_search.len()
    }
}

/// Marks images like their sources, and adds them to the searched points; `marks` are those of all particles.
pub(super) fn mark_images(marks: &mut Vec<AtomicU8>, to_search: &mut Vec<u32>, sources: &[u32]) {
    for &source in sources {
        let mark = marks[source as usize].load(Ordering::Relaxed);
        if mark == mark::REBUILD {
            to_search.push(marks.len() as u32);
        }
        marks.push(AtomicU8::new(mark));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_of_what_is_searched_are_searched_too() {
        let mut marks: Vec<AtomicU8> = [mark::REBUILD, mark::KEEP].map(AtomicU8::new).into();
        let mut to_search = vec![0];
        // Points 2 to 4.
        mark_images(&mut marks, &mut to_search, &[1, 0, 0]);
        assert_eq!(to_search, [0, 3, 4]);
        let marks: Vec<u8> = marks.into_iter().map(AtomicU8::into_inner).collect();
        assert_eq!(marks, [mark::REBUILD, mark::KEEP, mark::KEEP, mark::REBUILD, mark::REBUILD]);
    }
}
