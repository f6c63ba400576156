//! Search for contact if the neighbour list is that of the initial configuration.
//!
//! The search is repeated when two particles may have approached each other by its skin. Its images in symmetry planes
//! are those of the current positions, not those of the neighbour list. All ranks search the same points, those of all
//! of them, each for the rows of its own particles.

use super::CpuEngine;
use super::common_points::CommonPoints;
use super::domain::Share;
use super::faces::WholeDeformation;
use super::facets::FacetContacts;
use super::facing::Facing;
use super::ghosts::{Ghosts, WithGhosts};
use super::search::closed_in_beyond;
use super::self_contact::Surfaces;
use crate::RunFailure;
use crate::halo::{FieldSet, Halo, Image, Images};
use crate::lanes::{Instructions, PairScalar};
use crate::model::Model;
use crate::neighbors::{BLOCK, DisplacementBound, ForeignList, NeighborList, Reach, Searcher};
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, persist_pieces_or_none, require};
use rayon::prelude::*;
use sphorge_physics::{Tensor, Vector, tensor::dot};
use std::ops::Range;

/// Skin of the search, in reaches of the contact.
const SKIN: f64 = 0.2;

/// How much farther than its facets a particle is searched around, in spacings.
const MARGIN: f64 = 0.25;

/// Current surroundings of the particles.
pub(super) struct ContactSearch {
    pub(super) ghosts: Ghosts,
    /// The points of all ranks; on a single rank these are its particles and ghosts.
    common: CommonPoints,
    /// Reach of the contact in smoothing lengths.
    support: f64,
    /// Smoothing length of the contact by body, m.
    smoothing_length_of: Vec<f64>,
    /// Spacing by body, m.
    spacing_of: Vec<f64>,
    has_self_contact: bool,
    conducts: bool,
    /// Whether particles meet within their kernels: all where there are no facets, with facets those of bodies that have come apart and those that
    /// heat crosses between.
    by_kernels: bool,
    /// Particles and ghosts that are searched: all if there are several bodies, otherwise those on the surface. Ghosts
    /// are numbered after the particles. With ranks these are the members on all of them; members that this rank does
    /// not read have no index.
    members: Vec<u32>,
    /// Their positions, m, and smoothing lengths, m, and all their pairs.
    points: Vec<Vector<f64>>,
    smoothing_length: Vec<f64>,
    list: NeighborList,
    searcher: Searcher,
    /// Number of members at the last search.
    searched: usize,
    /// Positions of the particles at the last search, m, and their shifts to the contact positions, if there are any.
    searched_at: Vec<Vector<f64>>,
    shifts: Vec<Vector<f64>>,
    /// Distances of their farthest corners of facets at the last search, m, where bodies meet at facets.
    reaches: Vec<f64>,
    /// Value of the displacement bound at the last search.
    displacement: DisplacementBound,
    is_made: bool,
}

impl ContactSearch {
    /// Nothing is searched yet.
    pub(super) fn new(model: &Model, halo: Box<dyn Halo>, smoothing_length_of: Vec<f64>) -> Self {
        Self {
            ghosts: Ghosts::new(halo),
            common: CommonPoints::new(Images::new(model)),
            support: model.numerics.kernel.support(),
            smoothing_length_of,
            spacing_of: model.bodies.iter().map(|body| body.spacing).collect(),
            has_self_contact: model.has_self_contact(),
            conducts: model.thermal.conduction,
            by_kernels: model.thermal.conduction || !model.has_facets(),
            members: Vec::new(),
            points: Vec::new(),
            smoothing_length: Vec::new(),
            list: NeighborList::default(),
            searcher: Searcher::default(),
            searched: 0,
            searched_at: Vec::new(),
            shifts: Vec::new(),
            reaches: Vec::new(),
            displacement: DisplacementBound::default(),
            is_made: false,
        }
    }

    /// Whether two particles may be within the reach of the contact without being among the pairs.
    fn is_due(
        &self,
        particles: &Particles,
        facets: Option<&FacetContacts>,
        share: Option<&Share>,
        displacement: DisplacementBound,
        has_come_apart: &[bool],
    ) -> Result<bool, RunFailure> {
        if !self.is_made {
            return Ok(true);
        }
        let smallest = |of_bodies: &[f64]| of_bodies.iter().copied().fold(f64::INFINITY, f64::min);
        // The change of the shifts uses up a part of the skin of a particle; the skin of a pair is the mean of both.
        // Particles are in the state of the last evaluation.
        let over_all = |change: f64| share.map_or(Ok(change), |share| share.largest(change));
        let mut half = f64::INFINITY;
        if let Some(facets) = facets {
            let growth = over_all(self.largest_growth(particles, facets, has_come_apart))?;
            half = MARGIN * smallest(&self.spacing_of) - growth;
        }
        if self.by_kernels {
            let change = over_all(self.largest_change_of_shift(particles))?;
            half = half.min((0.5 * SKIN * self.support - change) * smallest(&self.smoothing_length_of));
        }
        if half <= 0.0 {
            return Ok(true);
        }
        if displacement.is_within(self.displacement, half) {
            return Ok(false);
        }
        let has_images = self.ghosts.halo.has_images();
        closed_in_beyond(&particles.position, &self.searched_at, 2.0 * half, has_images, share)
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

    /// Largest growth of the reach of a particle's facets since the last search, m.
    fn largest_growth(&self, particles: &Particles, facets: &FacetContacts, has_come_apart: &[bool]) -> f64 {
        let whole = whole_deformation(particles);
        let growth = |(i, then): (usize, &f64)| {
            let is_apart = has_come_apart[particles.body[i] as usize];
            if *then > 0.0 { facets.reach(particles.id[i], &whole.at(i), is_apart) - then } else { 0.0 }
        };
        self.reaches.par_iter().with_min_len(BLOCK).enumerate().map(growth).reduce(|| 0.0, f64::max)
    }

    /// Makes the next search due, after particles have been exchanged.
    pub(super) fn forget(&mut self) {
        self.is_made = false;
        self.searcher.forget();
    }

    /// Finds the pairs of different bodies, and the pairs of surface particles of one body that are not neighbours in
    /// its reference configuration, within the reach of the contact and its skin. A body that `has_come_apart` is
    /// renewed often, and meets itself in its own sums.
    fn search(
        &mut self,
        particles: &Particles,
        share: Option<&Share>,
        displacement: DisplacementBound,
        instructions: Instructions,
        has_come_apart: &[bool],
        facets: Option<&FacetContacts>,
        foreign: &mut ForeignList,
    ) -> Result<(), RunFailure> {
        self.by_kernels |= has_come_apart.contains(&true);
        let factor = self.factor();
        let largest = |of_bodies: &[f64]| of_bodies.iter().copied().fold(0.0, f64::max);
        // The contact positions of stretched material are farther out than the particles.
        let over_all = |longest: f64| share.map_or(Ok(longest), |share| share.largest(longest));
        let mut ghost_reach: f64 = 0.0;
        if let Some(facets) = facets {
            let whole = whole_deformation(particles);
            let all = (0..particles.len()).into_par_iter().with_min_len(BLOCK);
            let is_apart = |i: usize| has_come_apart[particles.body[i] as usize];
            all.map(|i| facets.reach(particles.id[i], &whole.at(i), is_apart(i))).collect_into_vec(&mut self.reaches);
            let farthest = over_all(self.reaches.iter().copied().fold(0.0, f64::max))?;
            ghost_reach = 2.0 * (farthest + MARGIN * largest(&self.spacing_of));
        }
        if self.by_kernels {
            let farthest = over_all(largest_length(&particles.contact_shift))?;
            ghost_reach = ghost_reach.max(factor * largest(&self.smoothing_length_of) + farthest);
        }
        let rows = match share {
            None => self.place(particles, facets, ghost_reach, has_come_apart),
            Some(share) => self.place_among_ranks(particles, facets, share, ghost_reach)?,
        };
        let reach = Reach::new(&self.smoothing_length, factor);
        self.searcher.search_rows(&self.points, rows.clone(), &reach, displacement, instructions, &mut self.list);
        let mut owners = self.members[rows].to_vec();
        if let Some(share) = share {
            owners.iter_mut().for_each(|place| *place -= share.own().start as u32);
            self.adopt_found(particles, share)?;
        }
        let ghosts = &self.ghosts.columns;
        let body = WithGhosts::new(&particles.body, &ghosts.body);
        let surfaces = Surfaces::new(&particles.reference_normal, &particles.deformation, ghosts);
        let reference = WithGhosts::new(&particles.reference_position, &ghosts.reference_position);
        let facing = facets
            .filter(|_| self.has_self_contact && !self.by_kernels)
            .map(|of| Facing::new(of, particles, &self.ghosts));
        foreign.gather(&self.list, &owners, &self.members, particles.len(), |i, j| {
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
                && match &facing {
                    Some(facing) => facing.may_meet(i, j),
                    None => facets.is_some() || surfaces.may_press(i, j, apart, self.spacing_of[of]),
                }
        });
        if let Some(share) = share {
            self.keep_met(particles, share, foreign)?;
        }
        self.searched = self.points.len();
        self.searched_at.clone_from(&particles.position);
        self.shifts.clone_from(&particles.contact_shift);
        self.displacement = displacement;
        self.is_made = true;
        Ok(())
    }

    /// Sets the contact positions of the members, including ghosts of all particles within `reach` (m) of where they
    /// are needed. Returns those whose rows are searched.
    fn place(
        &mut self,
        particles: &Particles,
        facets: Option<&FacetContacts>,
        reach: f64,
        has_come_apart: &[bool],
    ) -> Range<usize> {
        if self.ghosts.halo.rebuild(&particles.position, reach) {
            self.searcher.forget();
        }
        // Faces are as they were at the last evaluation.
        self.exchange_all(particles);
        let own = self.find_members(particles, facets);
        let (members, ghosts) = (std::mem::take(&mut self.members), std::mem::take(&mut self.ghosts.columns));
        let (position, body) =
            (WithGhosts::new(&particles.position, &ghosts.position), WithGhosts::new(&particles.body, &ghosts.body));
        let shift = WithGhosts::new(&particles.contact_shift, &ghosts.contact_shift);
        let reach = Reaches::new(facets, particles, &ghosts, has_come_apart);
        self.place_members(&members, |i| (position.at(i), shift.at(i), body.at(i), reach.of(i)));
        (self.members, self.ghosts.columns) = (members, ghosts);
        0..own
    }

    /// The same among the particles of all ranks.
    fn place_among_ranks(
        &mut self,
        particles: &Particles,
        facets: Option<&FacetContacts>,
        share: &Share,
        reach: f64,
    ) -> Result<Range<usize>, RunFailure> {
        let is_one_body = self.smoothing_length_of.len() == 1;
        let reach_of = |i: usize| match facets {
            Some(_) if self.reaches[i] > 0.0 || self.by_kernels => self.reaches[i],
            None if !is_one_body || particles.reference_normal[i] != [0.0; 3] => 0.0,
            _ => UNSEARCHED,
        };
        let own: Vec<Point> = (0..particles.len())
            .map(|i| ((particles.position[i], particles.contact_shift[i]), (particles.body[i], reach_of(i))))
            .collect();
        let mut all = share.gather(&own)?;
        let positions: Vec<Vector<f64>> = all.iter().map(|point| point.0.0).collect();
        if self.common.reflect(&positions, reach) {
            self.searcher.forget();
        }
        self.common.extend(&mut all, |image: &Image, ((x, shift), of)| ((image.position(&x), image.vector(shift)), of));
        let members: Vec<u32> = (0..all.len() as u32).filter(|&i| all[i as usize].1.1 != UNSEARCHED).collect();
        self.place_members(&members, |i| {
            let ((x, shift), (body, reach)) = all[i];
            (x, shift, body, facets.map(|_| reach))
        });
        let before = |place: usize| members.partition_point(|&member| (member as usize) < place);
        let rows = before(share.own().start)..before(share.own().end);
        self.members = members;
        Ok(rows)
    }

    /// Sets the contact positions of members; `of` returns position (m), shift (m), body and the reach of facets (m), if
    /// bodies meet there.
    fn place_members(&mut self, members: &[u32], of: impl Fn(usize) -> (Vector<f64>, Vector<f64>, u32, Option<f64>)) {
        self.points.clear();
        self.smoothing_length.clear();
        for &i in members {
            let (x, shift, body, reach) = of(i as usize);
            let shift = if self.by_kernels { shift } else { [0.0; 3] };
            self.points.push([0, 1, 2].map(|a| x[a] + shift[a]));
            // Heat is exchanged between positions, which are nearer to each other than the contact positions; facets are seen from there, too.
            let shifted = dot(shift, shift).sqrt();
            let beyond = if self.conducts { 2.0 / self.support * shifted } else { 0.0 };
            let of_kernel = self.smoothing_length_of[body as usize] + beyond;
            // The reach of a pair is the mean of these times the factor.
            let of_facets =
                |reach: f64| 2.0 * (reach + shifted + MARGIN * self.spacing_of[body as usize]) / self.factor();
            self.smoothing_length.push(match reach {
                None => of_kernel,
                Some(reach) if self.by_kernels => of_facets(reach).max(of_kernel),
                Some(reach) => of_facets(reach),
            });
        }
    }

    /// Creates ghosts for the neighbours found on other ranks, and numbers the members by them.
    fn adopt_found(&mut self, particles: &Particles, share: &Share) -> Result<(), RunFailure> {
        let found = self.list.blocks().iter().flat_map(|block| (0..block.len()).flat_map(|k| block.row(k)));
        let halo = self.common.adopt(share, found.map(|&k| self.members[k as usize]))?;
        self.ghosts.halo = Box::new(halo);
        self.members.iter_mut().for_each(|member| *member = self.common.number(*member));
        self.exchange_all(particles);
        Ok(())
    }

    /// Keeps only the ghosts that are in contact, a small part of those found.
    fn keep_met(&mut self, particles: &Particles, share: &Share, foreign: &mut ForeignList) -> Result<(), RunFailure> {
        let own = share.own();
        foreign.renumber(|j| self.common.point(own.clone(), j));
        let halo = self.common.adopt(share, foreign.indices())?;
        self.ghosts.halo = Box::new(halo);
        foreign.renumber(|point| self.common.number(point));
        self.exchange_all(particles);
        Ok(())
    }

    /// Updates the data of ghosts that a search reads.
    fn exchange_all(&mut self, particles: &Particles) {
        self.ghosts.exchange(&[FieldSet::Search, FieldSet::Contact], particles);
    }

    /// Distance within which two particles with smoothing lengths of one are found.
    fn factor(&self) -> f64 {
        self.support * (1.0 + SKIN)
    }

    /// Finds the members that are searched; returns how many of them are particles.
    fn find_members(&mut self, particles: &Particles, facets: Option<&FacetContacts>) -> usize {
        let id = WithGhosts::new(&particles.id, &self.ghosts.columns.id);
        let normal = WithGhosts::new(&particles.reference_normal, &self.ghosts.columns.reference_normal);
        let is_one_body = self.smoothing_length_of.len() == 1;
        let by_kernels = self.by_kernels;
        let is_member = |i: &u32| match facets {
            Some(facets) => by_kernels || !facets.reference.of(id.at(*i as usize)).is_empty(),
            None => !is_one_body || normal.at(*i as usize) != [0.0; 3],
        };
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
            + self.common.bytes()
            + 36 * self.points.capacity()
            + 24 * (self.searched_at.capacity() + self.shifts.capacity())
            + 8 * self.reaches.capacity()
    }
}

/// A particle as ranks exchange it: position and shift, m; body, and the reach of its facets, m, or [`UNSEARCHED`].
type Point = ((Vector<f64>, Vector<f64>), (u32, f64));

/// In place of a reach, for a particle that is not searched.
const UNSEARCHED: f64 = -1.0;

/// Deformation of particles since the start.
fn whole_deformation(particles: &Particles) -> WholeDeformation<'_> {
    WholeDeformation { since: &particles.deformation, earlier: &particles.earlier_deformation }
}

/// Reaches of the facets of particles and ghosts, if bodies meet there.
pub(super) struct Reaches<'a> {
    facets: Option<&'a FacetContacts>,
    has_come_apart: &'a [bool],
    id: WithGhosts<'a, u32>,
    body: WithGhosts<'a, u32>,
    since: WithGhosts<'a, Tensor<f64>>,
    earlier: Option<WithGhosts<'a, Tensor<f64>>>,
}

impl<'a> Reaches<'a> {
    pub(super) fn new(
        facets: Option<&'a FacetContacts>,
        own: &'a Particles,
        ghosts: &'a Particles,
        has_come_apart: &'a [bool],
    ) -> Self {
        let earlier = || WithGhosts::new(&own.earlier_deformation, &ghosts.earlier_deformation);
        Self {
            facets,
            has_come_apart,
            id: WithGhosts::new(&own.id, &ghosts.id),
            body: WithGhosts::new(&own.body, &ghosts.body),
            since: WithGhosts::new(&own.deformation, &ghosts.deformation),
            earlier: (!own.earlier_deformation.is_empty()).then(earlier),
        }
    }

    /// Whether a particle or ghost is of a body that has come apart.
    pub(super) fn is_apart(&self, i: usize) -> bool {
        self.has_come_apart[self.body.at(i) as usize]
    }

    /// Of a particle or ghost, m.
    pub(super) fn of(&self, i: usize) -> Option<f64> {
        // Without facets there may be no deformation to ask for.
        let facets = self.facets?;
        let f = self.since.at(i);
        let f = self.earlier.map_or(f, |earlier| WholeDeformation::product(&f, &earlier.at(i)));
        Some(facets.reach(self.id.at(i), &f, self.is_apart(i)))
    }
}

/// Length of the longest vector.
fn largest_length(vectors: &[Vector<f64>]) -> f64 {
    vectors.par_iter().with_min_len(BLOCK).map(|v| dot(*v, *v)).reduce(|| 0.0, f64::max).sqrt()
}

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the pairs in contact at the current positions, if the neighbour list does not contain them and they may
    /// have changed.
    pub(super) fn search_contacts(&mut self) -> Result<(), RunFailure> {
        let (displacement, share) = (self.lists.displacement, self.domain.as_deref());
        let Some(contacts) = &mut self.contacts else { return Ok(()) };
        let Some(search) = &mut contacts.search else { return Ok(()) };
        let (apart, facets) = (&self.has_come_apart, contacts.facets.as_ref());
        if !search.is_due(&self.particles, facets, share, displacement, apart)? {
            return Ok(());
        }
        let foreign = &mut contacts.foreign;
        search.search(&self.particles, share, displacement, self.instructions, apart, facets, foreign)?;
        if let Some(facets) = &mut contacts.facets {
            facets.adopt(foreign, &self.particles, &search.ghosts, apart);
        }
        // Particles that lose their neighbours in other bodies no longer overlap.
        let p = &mut self.particles;
        p.contact_overlap.fill(0.0);
        p.contact_direction.fill([0.0; 3]);
        p.contact_weight.fill(0.0);
        Ok(())
    }
}

impl ContactSearch {
    /// Saves or loads the data of the `count` particles of this rank. The images of all particles are saved; which of
    /// them are ghosts of a rank follows from the pairs.
    pub(super) fn persist(
        &mut self,
        count: usize,
        share: Option<&Share>,
        name: &str,
        archive: &mut dyn Archive,
    ) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        match share {
            None => self.ghosts.halo.persist(&of("halo"), archive)?,
            Some(_) => self.common.persist(&of("halo"), archive)?,
        }
        self.searcher.persist(&of("searcher"), archive)?;
        self.searched.persist(&of("searched"), archive)?;
        persist_pieces_or_none(&mut self.searched_at, count, &of("searched_at"), archive)?;
        persist_pieces_or_none(&mut self.shifts, count, &of("shifts"), archive)?;
        persist_pieces_or_none(&mut self.reaches, count, &of("reaches"), archive)?;
        self.displacement.persist(&of("displacement"), archive)?;
        self.by_kernels.persist(&of("by_kernels"), archive)?;
        self.is_made.persist(&of("is_made"), archive)?;
        if archive.is_saving() {
            return Ok(());
        }
        let all = share.map_or(count, |share| share.count());
        let (images, sources) = match share {
            None => (self.ghosts.count(), self.ghosts.halo.sources()),
            Some(_) => (self.common.images(), self.common.sources()),
        };
        require(sources.iter().all(|&source| (source as usize) < all), &of("halo"))?;
        let fits = self.searched_at.len() == count && self.shifts.len() == count;
        require(!self.is_made || fits, &of("searched_at"))?;
        // Those on surfaces alone may be searched: none, or as many as there were.
        let are_searched = self.searched <= all + images && self.searcher.fits(self.searched);
        require(!self.is_made || are_searched, &of("searcher.sorted_at"))
    }

    /// Points that pairs may refer to, by their indices among those of all ranks.
    pub(super) fn points(&self, count: usize, share: Option<&Share>) -> usize {
        share.map_or_else(|| count + self.ghosts.count(), |share| share.count() + self.common.images())
    }

    /// The images among the points that pairs may refer to.
    pub(super) fn images(&self, share: Option<&Share>) -> &[Image] {
        share.map_or_else(|| self.ghosts.halo.images(), |_| self.common.all_images().images())
    }

    /// The index among the points of all ranks of a point of this one.
    pub(super) fn point(&self, share: &Share, number: u32) -> u32 {
        self.common.point(share.own(), number)
    }

    /// Completes a loaded state once all ranks have loaded theirs.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn complete(
        &mut self,
        particles: &Particles,
        share: Option<&Share>,
        foreign: &mut ForeignList,
    ) -> Result<(), RunFailure> {
        if let Some(share) = share {
            let halo = self.common.adopt(share, foreign.indices())?;
            self.ghosts.halo = Box::new(halo);
            foreign.renumber(|point| self.common.number(point));
        }
        // They receive data that do not change between searches only at searches, and the next one may be far away.
        self.ghosts.exchange(&[FieldSet::Search], particles);
        Ok(())
    }
}
