//! A partial search among the particles of all ranks.
//!
//! Rows that are rebuilt or patched contain indices in the common order during the search, as on one process; the other
//! rows keep the indices of this rank. If a row contains a point that is not a ghost yet, the ghosts are chosen again,
//! and all rows are renumbered.

use super::super::CpuEngine;
use super::adaptive::mark_images;
use crate::RunFailure;
use crate::halo::FieldSet;
use crate::lanes::PairScalar;
use crate::neighbors::{BLOCK, NeighborList, PartialSearch, Reach, mark};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU8, Ordering};

impl<T: PairScalar> CpuEngine<T> {
    /// Rebuilds the rows of the particles that any rank has marked, and patches others. Marks are then those of the
    /// particles of all ranks.
    pub(super) fn search_marked_among_ranks(&mut self, one_sided: bool) -> Result<(), RunFailure> {
        let factor = self.reach_factor();
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let points = domain.gather_points(&self.particles)?;
        let own = domain.own();
        let (displacement, range) = (self.lists.displacement, self.lists.smoothing_lengths);
        let super::Lists { list, searcher, marks, to_search, stored, .. } = &mut self.lists;
        to_search.iter_mut().for_each(|i| *i += own.start as u32);
        *to_search = domain.ranks.gather_all(to_search)?;
        marks.clear();
        marks.resize_with(domain.count(), || AtomicU8::new(mark::KEEP));
        for &i in &*to_search {
            *marks[i as usize].get_mut() = mark::REBUILD;
        }
        mark_images(marks, to_search, domain.image_sources());

        let marks = &*marks;
        let has = |i: usize, wanted: u8| marks[i].load(Ordering::Relaxed) == wanted;
        renumber(list, own.clone(), |i| has(i, mark::REBUILD), |j| domain.point(j));
        let reach = Reach { smoothing_length: domain.smoothing_lengths(), factor, range };
        let sources = domain.image_sources();
        let partial = PartialSearch { points: &points, sources, rows: own.clone(), reach, displacement, marks };
        searcher.rebuild_marked(&partial, self.instructions, list, to_search, one_sided);
        if !one_sided {
            // Rows of other ranks are patched by these.
            let is_others = |place: &usize| !own.contains(place) && has(*place, mark::PATCH);
            let places: Vec<u32> = (0..domain.count()).filter(is_others).map(|place| place as u32).collect();
            for place in domain.ranks.gather_all(&places)? {
                marks[place as usize].store(mark::PATCH, Ordering::Relaxed);
            }
            renumber(list, own.clone(), |i| has(i, mark::PATCH), |j| domain.point(j));
            searcher.patch_marked(&partial, self.instructions, list);
        }

        let is_made = |i: usize| !has(i, mark::KEEP);
        let names_new = (0..own.len())
            .into_par_iter()
            .any(|k| is_made(own.start + k) && list.row(k).iter().any(|&j| !domain.is_here(j)));
        let are_new = domain.any(names_new)?;
        if are_new {
            renumber(list, own, |i| !is_made(i), |j| domain.point(j));
            self.ghosts.halo = Box::new(domain.adopt(list)?);
        } else {
            renumber(list, own, is_made, |j| domain.number(j));
        }
        if stored.is_some() {
            self.place_points();
        } else if are_new {
            self.ghosts.exchange(&[FieldSet::Search], &self.particles);
        }
        Ok(())
    }
}

/// Renumbers the neighbours in some rows, which are those of particles given by their index in the common order.
fn renumber(
    list: &mut NeighborList,
    own: Range<usize>,
    is_wanted: impl Fn(usize) -> bool + Sync,
    number: impl Fn(u32) -> u32 + Sync,
) {
    list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
        for k in (0..block.len()).filter(|k| is_wanted(own.start + b * BLOCK + k)) {
            block.row_entries_mut(k).iter_mut().for_each(|j| *j = number(*j));
        }
    });
}
