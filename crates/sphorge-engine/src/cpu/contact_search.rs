//! Search for contact where the neighbour list is that of the initial configuration: who is beside whom now.
//!
//! The search is repeated when two particles may have closed in by the skin it was made with. Its images in symmetry planes are those
//! of the present positions, not those the neighbour list has.

use super::CpuEngine;
use super::ghosts::{Ghosts, WithGhosts};
use super::search::{differ_beyond, moved_beyond};
use crate::halo::{FieldSet, Halo};
use crate::lanes::{Instructions, PairScalar};
use crate::neighbors::{DisplacementBound, ForeignList, NeighborList, Reach, Searcher};
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, require};
use sphorge_physics::Vector;

/// Skin of the search, in reaches of the contact.
const SKIN: f64 = 0.2;

/// Present surroundings of the particles.
pub(super) struct ContactSearch {
    pub(super) ghosts: Ghosts,
    /// Reach of the contact in smoothing lengths.
    support: f64,
    /// Smoothing length of the contact by body, m.
    smoothing_length_of: Vec<f64>,
    /// All pairs of the last search; those of different bodies are taken out of it.
    list: NeighborList,
    searcher: Searcher,
    /// Positions (m) and smoothing lengths (m) of particles and ghosts at the last search.
    points: Vec<Vector<f64>>,
    smoothing_length: Vec<f64>,
    /// Reading of the displacement bound at the last search.
    displacement: DisplacementBound,
    is_made: bool,
}

impl ContactSearch {
    /// Nothing is searched yet.
    pub(super) fn new(halo: Box<dyn Halo>, support: f64, smoothing_length_of: Vec<f64>) -> Self {
        Self {
            ghosts: Ghosts::new(halo),
            support,
            smoothing_length_of,
            list: NeighborList::default(),
            searcher: Searcher::default(),
            points: Vec::new(),
            smoothing_length: Vec::new(),
            displacement: DisplacementBound::default(),
            is_made: false,
        }
    }

    /// Whether two particles may be nearer each other than the contact reaches and not be among the pairs.
    fn is_due(&self, particles: &Particles, displacement: DisplacementBound) -> bool {
        let smallest = self.smoothing_length_of.iter().copied().fold(f64::INFINITY, f64::min);
        let half = 0.5 * SKIN * self.support * smallest;
        let then = || &self.points[..particles.len()];
        // Images in symmetry planes are displaced otherwise than their sources.
        let differ = || !self.ghosts.halo.is_empty() || differ_beyond(&particles.position, then(), 2.0 * half);
        !self.is_made
            || (!displacement.is_within(self.displacement, half)
                && moved_beyond(&particles.position, then(), half)
                && differ())
    }

    /// Finds the pairs of different bodies within the reach of the contact and its skin.
    fn search(
        &mut self,
        particles: &Particles,
        displacement: DisplacementBound,
        instructions: Instructions,
        foreign: &mut ForeignList,
    ) {
        let factor = self.support * (1.0 + SKIN);
        let largest = self.smoothing_length_of.iter().copied().fold(0.0, f64::max);
        if self.ghosts.halo.rebuild(&particles.position, factor * largest) {
            self.searcher.forget();
        }
        self.ghosts.exchange(FieldSet::Search, particles);
        let ghosts = &self.ghosts.columns;
        let ghost_count = self.ghosts.count();
        self.points.clear();
        self.points.extend_from_slice(&particles.position);
        self.points.extend_from_slice(&ghosts.position[..ghost_count]);
        let body = WithGhosts::new(&particles.body, &ghosts.body);
        self.smoothing_length.clear();
        let all = 0..self.points.len();
        self.smoothing_length.extend(all.map(|j| self.smoothing_length_of[body.at(j) as usize]));
        let reach = Reach::new(&self.smoothing_length, factor);
        self.searcher.search(&self.points, particles.len(), &reach, displacement, instructions, &mut self.list);
        foreign.take_from(&mut self.list, |j| body.at(j as usize));
        self.displacement = displacement;
        self.is_made = true;
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.ghosts.halo.bytes()
            + self.ghosts.columns.bytes()
            + self.list.bytes()
            + self.searcher.bytes()
            + 32 * self.points.capacity()
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the pairs in contact among the present positions, where the neighbour list does not hold them and they may have changed.
    pub(super) fn search_contacts(&mut self) {
        let displacement = self.lists.displacement;
        let Some(contacts) = &mut self.contacts else { return };
        let Some(search) = contacts.search.as_mut().filter(|s| s.is_due(&self.particles, displacement)) else { return };
        search.search(&self.particles, displacement, self.instructions, &mut contacts.foreign);
        // Those that lose their neighbours in other bodies overlap no more.
        let p = &mut self.particles;
        p.contact_overlap.fill(0.0);
        p.contact_direction.fill([0.0; 3]);
        p.contact_weight.fill(0.0);
    }

    /// Brings the columns of the images the contact reads to those of the particles.
    pub(super) fn exchange_contact_ghosts(&mut self, fields: FieldSet) {
        if let Some(search) = self.contacts.as_mut().and_then(|contacts| contacts.search.as_mut()) {
            search.ghosts.exchange(fields, &self.particles);
        }
    }
}

impl Persist for ContactSearch {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        self.ghosts.halo.persist(&of("halo"), archive)?;
        self.searcher.persist(&of("searcher"), archive)?;
        self.points.persist(&of("points"), archive)?;
        self.displacement.persist(&of("displacement"), archive)?;
        self.is_made.persist(&of("is_made"), archive)
    }
}

impl ContactSearch {
    /// Refuses what was loaded and does not fit the particles, and brings the columns of the images up to date.
    pub(super) fn complete(&mut self, particles: &Particles, name: &str) -> Result<(), ArchiveError> {
        let rows = self.ghosts.halo.rows();
        require(rows.iter().all(|&row| (row as usize) < particles.len()), &format!("{name}.halo"))?;
        let all = particles.len() + rows.len();
        let fits = !self.is_made || self.points.len() == all && self.searcher.fits(all);
        require(fits, &format!("{name}.points"))?;
        // They take what does not change between searches with each search, and the next one may be far.
        self.ghosts.exchange(FieldSet::Search, particles);
        Ok(())
    }
}
