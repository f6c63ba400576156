//! Search for contact where the neighbour list is that of the initial configuration: who is beside whom now.
//!
//! The search is repeated when two particles may have closed in by the skin it was made with. Its images in symmetry planes are those
//! of the present positions, not those the neighbour list has.

use super::CpuEngine;
use super::ghosts::{Ghosts, WithGhosts};
use super::search::{differ_beyond, moved_beyond};
use super::self_contact::Surfaces;
use crate::halo::{FieldSet, Halo};
use crate::lanes::{Instructions, PairScalar};
use crate::model::Model;
use crate::neighbors::{BLOCK, DisplacementBound, ForeignList, NeighborList, Reach, Searcher};
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, require};
use rayon::prelude::*;
use sphorge_physics::{Vector, tensor::dot};

/// Skin of the search, in reaches of the contact.
const SKIN: f64 = 0.2;

/// Present surroundings of the particles.
pub(super) struct ContactSearch {
    pub(super) ghosts: Ghosts,
    /// Reach of the contact in smoothing lengths.
    support: f64,
    /// Smoothing length of the contact by body, m.
    smoothing_length_of: Vec<f64>,
    /// Spacing by body, m.
    spacing_of: Vec<f64>,
    has_self_contact: bool,
    conducts: bool,
    /// Particles and ghosts that are searched: all of several bodies, the surface of one. Ghosts have the numbers after the particles'.
    members: Vec<u32>,
    /// Their positions, m, and smoothing lengths, m, and all their pairs.
    points: Vec<Vector<f64>>,
    smoothing_length: Vec<f64>,
    list: NeighborList,
    searcher: Searcher,
    /// Positions of the particles at the last search, m, and their shifts to where they stood for the contact, where they have such.
    searched_at: Vec<Vector<f64>>,
    shifts: Vec<Vector<f64>>,
    /// Reading of the displacement bound at the last search.
    displacement: DisplacementBound,
    is_made: bool,
}

impl ContactSearch {
    /// Nothing is searched yet.
    pub(super) fn new(model: &Model, halo: Box<dyn Halo>, smoothing_length_of: Vec<f64>) -> Self {
        Self {
            ghosts: Ghosts::new(halo),
            support: model.numerics.kernel.support(),
            smoothing_length_of,
            spacing_of: model.bodies.iter().map(|body| body.spacing).collect(),
            has_self_contact: model.has_self_contact(),
            conducts: model.thermal.conduction,
            members: Vec::new(),
            points: Vec::new(),
            smoothing_length: Vec::new(),
            list: NeighborList::default(),
            searcher: Searcher::default(),
            searched_at: Vec::new(),
            shifts: Vec::new(),
            displacement: DisplacementBound::default(),
            is_made: false,
        }
    }

    /// Whether two particles may be nearer each other than the contact reaches and not be among the pairs.
    fn is_due(&self, particles: &Particles, displacement: DisplacementBound) -> bool {
        let smallest = self.smoothing_length_of.iter().copied().fold(f64::INFINITY, f64::min);
        // What the shifts have changed is spent, of the skin that a particle has: that of a pair is the mean of both. Particles are as they were
        // at the last evaluation.
        let half = smallest * (0.5 * SKIN * self.support - self.largest_change_of_shift(particles));
        // Images in symmetry planes are displaced otherwise than their sources.
        let differ =
            || !self.ghosts.halo.is_empty() || differ_beyond(&particles.position, &self.searched_at, 2.0 * half);
        !self.is_made
            || half <= 0.0
            || (!displacement.is_within(self.displacement, half)
                && moved_beyond(&particles.position, &self.searched_at, half)
                && differ())
    }

    /// Largest change of a shift since the last search, in smoothing lengths of the body.
    fn largest_change_of_shift(&self, particles: &Particles) -> f64 {
        let columns = (&particles.contact_shift, &self.shifts, &particles.body).into_par_iter().with_min_len(BLOCK);
        let squared = |(now, then, &body): (&Vector<f64>, &Vector<f64>, &u32)| {
            let way: f64 = (0..3).map(|k| (now[k] - then[k]).powi(2)).sum();
            way / self.smoothing_length_of[body as usize].powi(2)
        };
        columns.map(squared).reduce(|| 0.0, f64::max).sqrt()
    }

    /// Makes the next search due, of other particles.
    pub(super) fn forget(&mut self) {
        self.is_made = false;
        self.searcher.forget();
    }

    /// Finds the pairs of different bodies, and those of surfaces of one body that are no neighbours in its reference configuration, within
    /// the reach of the contact and its skin. What `has_come_apart` is renewed often, and meets itself in the sums.
    fn search(
        &mut self,
        particles: &Particles,
        displacement: DisplacementBound,
        instructions: Instructions,
        has_come_apart: &[bool],
        foreign: &mut ForeignList,
    ) {
        let factor = self.support * (1.0 + SKIN);
        let largest = self.smoothing_length_of.iter().copied().fold(0.0, f64::max);
        // Particles of stretched material stand farther out than they are.
        let farthest = largest_length(&particles.contact_shift);
        if self.ghosts.halo.rebuild(&particles.position, factor * largest + farthest) {
            self.searcher.forget();
        }
        self.ghosts.exchange(FieldSet::Search, particles);
        // Faces are as they were at the last evaluation.
        self.ghosts.exchange(FieldSet::Contact, particles);
        let own = self.find_members(particles);
        let ghosts = &self.ghosts.columns;
        let (position, body) =
            (WithGhosts::new(&particles.position, &ghosts.position), WithGhosts::new(&particles.body, &ghosts.body));
        self.points.clear();
        let shift = WithGhosts::new(&particles.contact_shift, &ghosts.contact_shift);
        self.points.extend(self.members.iter().map(|&i| {
            let (x, s) = (position.at(i as usize), shift.at(i as usize));
            [0, 1, 2].map(|a| x[a] + s[a])
        }));
        self.smoothing_length.clear();
        // Heat crosses faces between positions, which are nearer each other than the places they stand at.
        let beyond =
            |i: usize| if self.conducts { 2.0 / self.support * dot(shift.at(i), shift.at(i)).sqrt() } else { 0.0 };
        self.smoothing_length.extend(self.members.iter().map(|&i| {
            let i = i as usize;
            self.smoothing_length_of[body.at(i) as usize] + beyond(i)
        }));
        let reach = Reach::new(&self.smoothing_length, factor);
        self.searcher.search(&self.points, own, &reach, displacement, instructions, &mut self.list);
        let surfaces = Surfaces::new(&particles.reference_normal, &particles.deformation, ghosts);
        let reference = WithGhosts::new(&particles.reference_position, &ghosts.reference_position);
        foreign.gather(&self.list, &self.members, particles.len(), |i, j| {
            let of = body.at(i) as usize;
            if of != body.at(j) as usize {
                return true;
            }
            if !self.has_self_contact || has_come_apart[of] {
                return false;
            }
            let (x, other) = (reference.at(i), reference.at(j));
            let apart: Vector<f64> = [0, 1, 2].map(|a| x[a] - other[a]);
            dot(apart, apart) >= (self.support * self.smoothing_length_of[of]).powi(2)
                && surfaces.may_press(i, j, apart, self.spacing_of[of])
        });
        self.searched_at.clone_from(&particles.position);
        self.shifts.clone_from(&particles.contact_shift);
        self.displacement = displacement;
        self.is_made = true;
    }

    /// Finds who is searched; how many of them are particles.
    fn find_members(&mut self, particles: &Particles) -> usize {
        let normal = WithGhosts::new(&particles.reference_normal, &self.ghosts.columns.reference_normal);
        let is_one_body = self.smoothing_length_of.len() == 1;
        let is_member = |i: &u32| !is_one_body || normal.at(*i as usize) != [0.0; 3];
        let (count, all) = (particles.len() as u32, (particles.len() + self.ghosts.count()) as u32);
        self.members.clear();
        self.members.extend((0..count).filter(is_member));
        let own = self.members.len();
        self.members.extend((count..all).filter(is_member));
        own
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.ghosts.halo.bytes()
            + self.ghosts.columns.bytes()
            + self.list.bytes()
            + self.searcher.bytes()
            + 36 * self.points.capacity()
            + 24 * (self.searched_at.capacity() + self.shifts.capacity())
    }
}

/// Length of the longest vector.
fn largest_length(vectors: &[Vector<f64>]) -> f64 {
    vectors.par_iter().with_min_len(BLOCK).map(|v| dot(*v, *v)).reduce(|| 0.0, f64::max).sqrt()
}

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the pairs in contact among the present positions, where the neighbour list does not hold them and they may have changed.
    pub(super) fn search_contacts(&mut self) {
        let displacement = self.lists.displacement;
        let Some(contacts) = &mut self.contacts else { return };
        let Some(search) = contacts.search.as_mut().filter(|s| s.is_due(&self.particles, displacement)) else { return };
        search.search(&self.particles, displacement, self.instructions, &self.has_come_apart, &mut contacts.foreign);
        // Those that lose their neighbours in other bodies overlap no more.
        let p = &mut self.particles;
        p.contact_overlap.fill(0.0);
        p.contact_direction.fill([0.0; 3]);
        p.contact_weight.fill(0.0);
    }

    /// Brings what the contact reads of ghosts, be they its own or those of the neighbour list, to that of the particles.
    pub(super) fn exchange_contact(&mut self, fields: FieldSet) {
        match &self.contacts {
            None => {}
            Some(contacts) if contacts.search.is_some() => self.exchange_contact_ghosts(fields),
            Some(_) => self.ghosts.exchange(fields, &self.particles),
        }
    }

    /// Brings the columns of the images the contact reads to those of the particles.
    pub(super) fn exchange_contact_ghosts(&mut self, fields: FieldSet) {
        let Some(contacts) = self.contacts.as_mut().filter(|contacts| !contacts.foreign.is_empty()) else { return };
        if let Some(search) = &mut contacts.search {
            search.ghosts.exchange(fields, &self.particles);
        }
    }
}

impl Persist for ContactSearch {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        self.ghosts.halo.persist(&of("halo"), archive)?;
        self.searcher.persist(&of("searcher"), archive)?;
        self.searched_at.persist(&of("searched_at"), archive)?;
        self.shifts.persist(&of("shifts"), archive)?;
        self.displacement.persist(&of("displacement"), archive)?;
        self.is_made.persist(&of("is_made"), archive)
    }
}

impl ContactSearch {
    /// Refuses what was loaded and does not fit the particles, and brings the columns of the images up to date.
    pub(super) fn complete(&mut self, particles: &Particles, name: &str) -> Result<(), ArchiveError> {
        let rows = self.ghosts.halo.rows();
        require(rows.iter().all(|&row| (row as usize) < particles.len()), &format!("{name}.halo"))?;
        // They take what does not change between searches with each search, and the next one may be far.
        self.ghosts.exchange(FieldSet::Search, particles);
        self.find_members(particles);
        let fits = self.searched_at.len() == particles.len()
            && self.shifts.len() == particles.contact_shift.len()
            && self.searcher.fits(self.members.len());
        require(!self.is_made || fits, &format!("{name}.searched_at"))
    }
}
