//! Adaptive search: only particles that deform plastically are searched again (Fraser).
//!
//! Fraser's rule looks at the plastic strain of a step alone. The guard adds what the rule cannot see; `docs/adaptive-search.md`
//! derives each of its bounds:
//!
//! - elastic strain: a particle whose strain since its last search passes a bound is searched;
//! - contact candidates: particles near another body, near another fragment of their own, or near material that came from far away are
//!   searched every step ([`super::contact_candidates`]);
//! - one-sidedness: rows of neighbours that a searched particle gains or loses are patched, so that of every pair both rows know
//!   or none;
//! - old gradients: kernel values are those of the positions as they are. Without the guard they are those of the search.

use super::super::CpuEngine;
use super::{CHUNK, moved_beyond};
use crate::RunFailure;
use crate::engine::SearchReport;
use crate::lanes::PairScalar;
use crate::model::{AdaptiveSearch, Search};
use crate::neighbors::{Reach, mark};
use crate::particles::Particles;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU8, Ordering};

/// Ghosts are made for particles this much farther away than the kernel reaches, as a share of the reach.
pub(super) const GHOST_MARGIN: f64 = 0.5;

impl<T: PairScalar> CpuEngine<T> {
    pub(super) fn search_adaptively(&mut self, adaptive: AdaptiveSearch) -> Result<SearchReport, RunFailure> {
        if self.lists.stale || self.ghosts_used_up() {
            return self.search_all();
        }
        self.follow_frame()?;
        if adaptive.guard.is_some() {
            let reach = self.largest_reach();
            let factor = self.model.numerics.kernel.support();
            let lists = &mut self.lists;
            lists.candidates.refresh(&self.particles, &lists.list, lists.displacement, reach, factor);
        }
        let marked = self.mark(adaptive);
        let count = self.particles.len();
        if adaptive.guard.is_some() && marked as f64 > AdaptiveSearch::ALL_ABOVE * count as f64 {
            return self.search_all();
        }
        self.step.any_adapted = marked > 0;
        if marked == 0 {
            return Ok(SearchReport { searched_fraction: 0.0 });
        }
        if self.ghosts.count() > 0 {
            self.place_points();
        }
        let factor = self.reach_factor();
        let one_sided = adaptive.guard.is_none();
        let (displacement, range) = (self.lists.displacement, self.lists.smoothing_lengths);
        let super::Lists { list, searcher, points, smoothing_length, marks, to_search, stored, .. } = &mut self.lists;
        let rows = self.ghosts.halo.sources();
        // Without ghosts the particles are all there is.
        let (points, smoothing_length) = if rows.is_empty() {
            (&self.particles.position, &self.particles.smoothing_length)
        } else {
            (&*points, &*smoothing_length)
        };
        marks.truncate(count);
        for (k, &row) in rows.iter().enumerate() {
            let mark = marks[row as usize].load(Ordering::Relaxed);
            marks.push(AtomicU8::new(mark));
            if mark == mark::REBUILD {
                to_search.push((count + k) as u32);
            }
        }
        let reach = Reach { smoothing_length, factor, range };
        searcher.rebuild_rows(points, rows, &reach, displacement, self.instructions, list, to_search, marks, one_sided);
        if let Some(stored) = stored {
            let searched = |i: usize| marks[i].load(Ordering::Relaxed) == mark::REBUILD;
            stored.rebuild(list, points, searched);
        }
        // Every particle that can touch another body is among contact candidates and was searched: all pairs of bodies are in the rows.
        self.take_contacts();
        Ok(SearchReport { searched_fraction: marked as f64 / count as f64 })
    }

    /// Notes a full search for what is measured from it.
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

    /// Whether sums are taken with the distances of the last search.
    pub(super) fn keeps_distances(&self) -> bool {
        match self.model.search {
            Search::EveryStep | Search::Skin { .. } => false,
            Search::Adaptive(adaptive) => adaptive.guard.is_none(),
            Search::Initial => !self.formulation.is_initial(),
        }
    }

    /// Whether a particle may have come near a symmetry plane or a periodic end without a ghost.
    fn ghosts_used_up(&self) -> bool {
        let allowed = GHOST_MARGIN * self.largest_reach();
        !self.ghosts.halo.is_empty()
            && !self.lists.displacement.is_within(self.lists.displacement_at_search, allowed)
            && moved_beyond(&self.particles.position, &self.particles.searched_at, allowed)
    }

    /// Marks the particles to be searched, returns how many.
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
