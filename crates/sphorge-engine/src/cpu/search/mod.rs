//! The search strategies: when neighbour lists are rebuilt, and for which particles.

mod adaptive;
mod audit;
mod contact_candidates;
mod partial_on_ranks;
mod saved;
mod surroundings;

use super::CpuEngine;
use super::domain::Share;
use super::ghosts::{Ghosts, WithGhosts};
use super::smoothing::least_searched;
use super::stored::StoredPairs;
use crate::RunFailure;
use crate::engine::SearchReport;
use crate::halo::FieldSet;
use crate::lanes::PairScalar;
use crate::model::{AdaptiveSearch, Model, Search};
use crate::neighbors::{BLOCK, DisplacementBound, Frame, NeighborList, Reach, Searcher, bounds};
use crate::particles::{Particles, Permutation};
pub use audit::{AuditedRow, audit_of};
pub use contact_candidates::{ContactCandidates, SearchedMaterial};
use rayon::prelude::*;
use sphorge_physics::Vector;
use std::sync::atomic::AtomicU8;

/// Particles per work unit of a thread if there is little work per particle.
const CHUNK: usize = 4096;

/// Neighbour lists and the data of the search.
#[derive(Default)]
pub(super) struct Lists<T> {
    pub(super) list: NeighborList,
    /// Distances of the last search, if the strategy stores them.
    pub(super) stored: Option<StoredPairs<T>>,
    pub(super) permutation: Permutation,
    /// Number of full searches since particles were sorted.
    pub(super) searches: u64,
    /// Whether the list is not that of these particles.
    pub(super) stale: bool,
    pub(super) searcher: Searcher,
    /// Positions of particles and ghosts at the last search, m.
    pub(super) points: Vec<Vector<f64>>,
    /// Smoothing lengths of particles and ghosts at the last search, not below those of the contact between bodies, m.
    pub(super) smoothing_length: Vec<f64>,
    /// Smallest smoothing length of a particle, and largest one used in the search, m.
    pub(super) smoothing_lengths: (f64, f64),
    pub(super) displacement: DisplacementBound,
    /// Its values at the last full search, and when the frame was made.
    displacement_at_search: DisplacementBound,
    /// Range of the smoothing lengths at the last full search, m.
    smoothing_lengths_at_search: (f64, f64),
    displacement_at_frame: DisplacementBound,
    /// Marks of the rows for a partial search; ghosts have those of their sources.
    marks: Vec<AtomicU8>,
    /// Points of a partial search.
    to_search: Vec<u32>,
    candidates: ContactCandidates,
}

impl<T: Default> Lists<T> {
    /// Lists to be built for particles of these smallest and largest smoothing lengths, m.
    pub(super) fn new(smoothing_lengths: (f64, f64)) -> Self {
        Self { stale: true, smoothing_lengths, ..Self::default() }
    }
}

impl<T> Lists<T> {
    /// Edge of the cells that particles are put in order by, m.
    fn edge_of_cells(&self, model: &Model) -> f64 {
        model.numerics.kernel.support() * self.smoothing_lengths.1
    }

    /// Puts particles into the order of cells, tile by tile; lists of them are not valid any more.
    pub(super) fn sort(&mut self, model: &Model, particles: &mut Particles) {
        let edge = self.edge_of_cells(model);
        self.permutation.set(self.searcher.tiled_order(&particles.position, edge));
        particles.reorder(&self.permutation);
    }

    pub(super) fn bytes(&self) -> usize {
        self.list.bytes()
            + self.searcher.bytes()
            + self.permutation.bytes()
            + self.stored.as_ref().map_or(0, StoredPairs::bytes)
            + 24 * self.points.capacity()
            + 8 * self.smoothing_length.capacity()
            + self.marks.capacity()
            + 4 * self.to_search.capacity()
            + self.candidates.bytes()
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Makes the lists valid for the updated positions, according to the strategy.
    pub(super) fn refresh_lists(&mut self) -> Result<SearchReport, RunFailure> {
        let stale = self.lists.stale;
        if !(stale || self.model.thermal.mechanics) {
            return Ok(self.keep_lists());
        }
        if let Some(heat) = &mut self.heat {
            heat.forget_surroundings();
        }
        match self.model.search {
            Search::EveryStep => self.search_all(),
            Search::Skin { fraction } => {
                if stale || self.moved_beyond_skin(fraction)? {
                    self.search_all()
                } else {
                    self.follow_frame()?;
                    Ok(self.keep_lists())
                }
            }
            Search::Adaptive(adaptive) => self.search_adaptively(adaptive),
            Search::Initial => {
                let report = if stale || self.renew_references()? {
                    let report = self.search_all()?;
                    self.find_surfaces();
                    report
                } else {
                    self.follow_frame()?;
                    self.keep_lists()
                };
                self.search_contacts()?;
                Ok(report)
            }
        }
    }

    /// Kernel support with the skin of the strategy, in smoothing lengths.
    fn reach_factor(&self) -> f64 {
        let skin = match self.model.search {
            Search::Skin { fraction } => fraction,
            Search::EveryStep | Search::Adaptive(_) | Search::Initial => 0.0,
        };
        self.model.numerics.kernel.support() * (1.0 + skin)
    }

    /// Largest distance of a pair in the list, m.
    fn largest_reach(&self) -> f64 {
        self.reach_factor() * self.largest_smoothing_length()
    }

    pub(super) fn largest_smoothing_length(&self) -> f64 {
        self.lists.smoothing_lengths.1
    }

    /// Whether two particles may have approached each other by more than the skin. Bounds are twice the largest
    /// displacement since the search, and the largest difference of displacements, which is small for a body in flight.
    fn moved_beyond_skin(&self, fraction: f64) -> Result<bool, RunFailure> {
        let smallest = self.lists.smoothing_lengths.0;
        let skin = self.skin_left(fraction * smallest, fraction)?;
        let skin = skin * self.model.numerics.kernel.support();
        let (now, then) = (&self.particles.position, &self.lists.points);
        if skin <= 0.0 {
            return Ok(true);
        }
        if self.lists.displacement.is_within(self.lists.displacement_at_search, 0.5 * skin) {
            return Ok(false);
        }
        closed_in_beyond(now, then, skin, self.ghosts.halo.has_images(), self.domain.as_deref())
    }

    fn keep_lists(&mut self) -> SearchReport {
        if self.step.any_adapted {
            self.particles.adapted.fill(0);
            self.step.any_adapted = false;
        }
        SearchReport { searched_fraction: 0.0 }
    }

    fn search_all(&mut self) -> Result<SearchReport, RunFailure> {
        let reach_factor = self.reach_factor();
        let ghost_reach = self.largest_reach() * self.ghost_reach_factor();
        let Particles { position, initial_position, .. } = &mut self.particles;
        let wrapped = self.ghosts.halo.wrap(position, initial_position);
        let wraps = self.model.periodic.iter().any(Option::is_some);
        if self.domain.as_ref().filter(|_| wraps).map_or(Ok(wrapped), |domain| domain.any(wrapped))? {
            self.lists.searcher.forget();
            self.lists.candidates.forget();
        }
        if self.ghosts.halo.rebuild(searched_positions(&self.particles, self.formulation.is_initial()), ghost_reach) {
            self.lists.searcher.forget();
        }
        self.search_among_ranks(reach_factor, ghost_reach)?;
        self.place_points();
        let count = self.particles.len();
        let Lists { list, searcher, points, smoothing_length, smoothing_lengths, displacement, .. } = &mut self.lists;
        if self.domain.is_none() {
            let reach = Reach { smoothing_length, factor: reach_factor, range: *smoothing_lengths };
            searcher.search(points, count, &reach, *displacement, self.instructions, list);
        }
        let frame = searcher.frame::<T>();
        self.keep_own_bodies();
        self.set_frame(frame);
        self.take_contacts();
        self.lists.displacement_at_search = self.lists.displacement;
        self.lists.smoothing_lengths_at_search = self.lists.smoothing_lengths;
        self.lists.searches += 1;
        self.lists.stale = false;
        self.particles.adapted.fill(1);
        self.particles.last_searched.fill(self.step.count as u32);
        self.step.any_adapted = true;
        self.note_search();
        Ok(SearchReport { searched_fraction: 1.0 })
    }

    /// Removes other bodies from the rows if their material does not contribute to the deformation of this one.
    fn keep_own_bodies(&mut self) {
        if self.formulation.sees_other_bodies() {
            return;
        }
        let body = WithGhosts::new(&self.particles.body, &self.ghosts.columns.body);
        for (b, block) in self.lists.list.blocks_mut().iter_mut().enumerate() {
            for k in 0..block.len() {
                let own = b * BLOCK + k;
                block.retain_in_row(k, own as u32, |j| body.at(own) == body.at(j as usize));
            }
        }
    }

    /// Moves pairs of different bodies to the contact between them, if the deck has one.
    fn take_contacts(&mut self) {
        if !self.take_foreign_pairs() {
            return;
        }
        // Particles that lose their neighbours in other bodies no longer overlap.
        let p = &mut self.particles;
        p.contact_overlap.fill(0.0);
        p.contact_direction.fill([0.0; 3]);
        p.contact_weight.fill(0.0);
    }

    /// The same for the pairs only; returns whether there is such a contact.
    fn take_foreign_pairs(&mut self) -> bool {
        let of_list = self.contacts.as_mut().filter(|contacts| contacts.search.is_none());
        let Some(contacts) = of_list else { return false };
        let body = WithGhosts::new(&self.particles.body, &self.ghosts.columns.body);
        contacts.take_pairs(&mut self.lists.list, body);
        true
    }

    /// How far beyond the reach of the kernel ghosts are created, so that they can be used until particles have moved. A
    /// renewed reference configuration is that of before the drift that has just brought particles into a periodic cell.
    fn ghost_reach_factor(&self) -> f64 {
        let is_renewed = self.has_come_apart.contains(&true) && self.model.periodic.iter().any(Option::is_some);
        match self.model.search {
            Search::Adaptive(_) => 1.0 + AdaptiveSearch::IMAGE_MARGIN,
            Search::Initial if is_renewed => 2.0,
            Search::EveryStep | Search::Skin { .. } | Search::Initial => 1.0,
        }
    }

    /// Positions of particles and ghosts and their smoothing lengths in the search, for the searcher.
    fn place_points(&mut self) {
        self.ghosts.exchange(&[FieldSet::Search], &self.particles);
        let Lists { points, smoothing_length, .. } = &mut self.lists;
        place(&self.particles, &self.ghosts, self.formulation.is_initial(), points, smoothing_length);
        if let Some(least) = least_searched(&self.model, self.contacts.as_ref()) {
            let body = WithGhosts::new(&self.particles.body, &self.ghosts.columns.body);
            let raise = |(i, h): (usize, &mut f64)| *h = h.max(least[body.at(i) as usize]);
            smoothing_length.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(raise);
        }
    }

    /// The frame of the records around the current positions; lists may outlive it. A reference configuration stays in
    /// that of its search.
    fn follow_frame(&mut self) -> Result<(), RunFailure> {
        if self.formulation.is_initial()
            || self.lists.displacement.is_within(self.lists.displacement_at_frame, self.largest_reach())
        {
            return Ok(());
        }
        self.frame_all()
    }

    /// Creates a frame around the current positions.
    fn frame_all(&mut self) -> Result<(), RunFailure> {
        let (mut low, mut high) = bounds(&self.particles.position);
        if let Some(domain) = &self.domain {
            (low, high) = domain.bounds(low, high)?;
        }
        // Ghosts are at most as far outside as the reach for which they were created; all may move by a reach.
        self.set_frame(Frame::around::<T>(low, high, 4.0 * self.largest_reach() + self.ghosts.halo.longest_shift()));
        Ok(())
    }

    fn set_frame(&mut self, frame: Frame) {
        self.records.frame = frame;
        self.lists.displacement_at_frame = self.lists.displacement;
        self.constants.unit = T::of(frame.unit);
    }

    /// Sorting makes a full search due, which some strategies must not have.
    pub(super) fn may_sort(&self) -> bool {
        match self.model.search {
            Search::EveryStep | Search::Skin { .. } => true,
            Search::Adaptive(adaptive) => adaptive.guard.is_some(),
            Search::Initial => false,
        }
    }

    /// Sorts the particles into the order of cells, tile by tile, so that neighbours in space are neighbours in memory.
    pub(super) fn sort_particles(&mut self) -> Result<(), RunFailure> {
        if self.domain.is_some() {
            self.sort_among_ranks(self.lists.edge_of_cells(&self.model))?;
        } else {
            self.lists.sort(&self.model, &mut self.particles);
        }
        self.lists.stale = true;
        // It refers to particles by their index.
        self.lists.candidates.forget();
        Ok(())
    }
}

/// Positions at which neighbours are searched, m, of particles or ghosts: on request those of the reference
/// configuration.
pub(super) fn searched_positions(particles: &Particles, is_reference: bool) -> &[Vector<f64>] {
    if is_reference { &particles.reference_position } else { &particles.position }
}

/// [`searched_positions`] and smoothing lengths (m) of particles and ghosts.
fn place(
    particles: &Particles,
    ghosts: &Ghosts,
    is_reference: bool,
    points: &mut Vec<Vector<f64>>,
    smoothing_length: &mut Vec<f64>,
) {
    let (count, ghost_count) = (particles.len(), ghosts.count());
    let own = searched_positions(particles, is_reference);
    let ghost = searched_positions(&ghosts.columns, is_reference);
    points.resize(count + ghost_count, [0.0; 3]);
    smoothing_length.resize(count + ghost_count, 0.0);
    let copy_points = || copy(own, points);
    let copy_lengths = || copy(&particles.smoothing_length, smoothing_length);
    rayon::join(copy_points, copy_lengths);
    points[count..].copy_from_slice(&ghost[..ghost_count]);
    smoothing_length[count..].copy_from_slice(&ghosts.columns.smoothing_length[..ghost_count]);
}

/// Copies a column to the front of another, on all threads.
fn copy<V: Copy + Send + Sync>(from: &[V], to: &mut [V]) {
    to.par_chunks_mut(CHUNK).zip(from.par_chunks(CHUNK)).for_each(|(to, from)| to[..from.len()].copy_from_slice(from));
}

/// Whether any of `now` has moved by more than `allowed` (m) from its position `then`.
pub(super) fn moved_beyond(now: &[Vector<f64>], then: &[Vector<f64>], allowed: f64) -> bool {
    now.par_chunks(CHUNK).zip(then.par_chunks(CHUNK)).any(|(now, then)| {
        now.iter().zip(then).any(|(now, then)| {
            let d = [now[0] - then[0], now[1] - then[1], now[2] - then[2]];
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > allowed * allowed
        })
    })
}

/// Whether two particles, of all ranks, or particles and images may have approached each other by more than `skin` (m)
/// since they were at `then`. Bounds are twice the largest displacement, and the largest difference of displacements.
pub(super) fn closed_in_beyond(
    now: &[Vector<f64>],
    then: &[Vector<f64>],
    skin: f64,
    has_images: bool,
    share: Option<&Share>,
) -> Result<bool, RunFailure> {
    let moved = || moved_beyond(now, then, 0.5 * skin);
    let Some(share) = share else {
        // Images in symmetry planes have other displacements than their sources.
        return Ok(moved() && (has_images || differ_beyond(now, then, skin)));
    };
    let (low, high) = displacement_box(now, then);
    let (low, high) = share.bounds(low, high)?;
    Ok(share.any(moved())? && (has_images || diagonal_beyond(low, high, skin)))
}

/// Whether the displacements of any two from `then` to `now` may differ by more than `allowed`, m: the diagonal of
/// their bounding box does.
fn differ_beyond(now: &[Vector<f64>], then: &[Vector<f64>], allowed: f64) -> bool {
    let (low, high) = displacement_box(now, then);
    diagonal_beyond(low, high, allowed)
}

/// Whether the diagonal of a box is longer than `allowed`, m.
fn diagonal_beyond(low: Vector<f64>, high: Vector<f64>, allowed: f64) -> bool {
    (0..3).map(|a| (high[a] - low[a]).powi(2)).sum::<f64>() > allowed * allowed
}

/// The bounding box of all displacements from `then` to `now`, m.
fn displacement_box(now: &[Vector<f64>], then: &[Vector<f64>]) -> (Vector<f64>, Vector<f64>) {
    let nothing = || ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let of_chunk = |(now, then): (&[Vector<f64>], &[Vector<f64>])| {
        let (mut low, mut high) = nothing();
        for (now, then) in now.iter().zip(then) {
            for a in 0..3 {
                let way = now[a] - then[a];
                (low[a], high[a]) = (low[a].min(way), high[a].max(way));
            }
        }
        (low, high)
    };
    let join = |a: (Vector<f64>, Vector<f64>), b: (Vector<f64>, Vector<f64>)| {
        ([0, 1, 2].map(|k| a.0[k].min(b.0[k])), [0, 1, 2].map(|k| a.1[k].max(b.1[k])))
    };
    now.par_chunks(CHUNK).zip(then.par_chunks(CHUNK)).map(of_chunk).reduce(nothing, join)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_is_as_long_as_its_three_axes_say() {
        let then = vec![[1.0, 2.0, 3.0]; 3];
        for way in [[2.0, 3.0, 6.0], [-6.0, 2.0, -3.0], [3.0, -6.0, 2.0]] {
            let mut now = then.clone();
            now[1] = [0, 1, 2].map(|a| then[1][a] + way[a]);
            assert!(moved_beyond(&now, &then, 7.0 - 1e-9) && !moved_beyond(&now, &then, 7.0 + 1e-9), "{way:?}");
            assert!(differ_beyond(&now, &then, 7.0 - 1e-9) && !differ_beyond(&now, &then, 7.0 + 1e-9), "{way:?}");
        }
    }

    #[test]
    fn ways_differ_by_what_is_left_without_the_motion_all_share() {
        let then: Vec<Vector<f64>> = (0..10_000).map(|i| [f64::from(i), 2.0, 3.0]).collect();
        let mut now: Vec<Vector<f64>> = then.iter().map(|x| [x[0] + 100.0, x[1] - 7.0, x[2]]).collect();
        assert!(moved_beyond(&now, &then, 100.0) && !differ_beyond(&now, &then, 1e-9));
        now[9_000][0] += 3.0;
        now[20][1] -= 4.0;
        assert!(!differ_beyond(&now, &then, 5.0 + 1e-9) && differ_beyond(&now, &then, 5.0 - 1e-9));
    }
}
