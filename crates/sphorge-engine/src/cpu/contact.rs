//! Contact between bodies: two passes over the pairs of particles of different bodies, and of different sides of one body.
//!
//! The pairs are few, lie along surfaces and are summed in double precision. Each particle sums its own row in the
//! order of the list. The law is antisymmetric to the bit, so linear momentum is conserved to rounding. The energy
//! stored by the elastic force is an entry of the energy balance. The heat of damping is shared equally by the two
//! particles, the heat of friction according to their effusivities.

use super::CpuEngine;
use super::contact_search::ContactSearch;
use super::domain::{Domain, Share};
use super::faces::WholeDeformation;
use super::facets::{CellSlips, FacetContacts, FacetPoints, face_stress as stress_of_faces};
use super::ghosts::{Ghosts, WithGhosts};
use super::self_contact::Surfaces;
use super::shared_edges::{CellEdges, Neighbors, Pulls, PullsOfBlock, store_pulls};
use crate::halo::{Halo, Image};
use crate::lanes::PairScalar;
use crate::model::Model;
use crate::neighbors::{BLOCK, ForeignBlock, ForeignList, NeighborList};
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, persist_each};
use crate::{ContactLaws, ContactLedger, RunFailure};
use rayon::prelude::*;
use sphorge_physics::contact::{ContactPair, ContactStiffness, Overlap, contact_force, share_of_released, stopping};
use sphorge_physics::facet::OnSides;
use sphorge_physics::surface::FaceShift;
use sphorge_physics::{Tensor, Vector, tensor::dot};

/// Contact of all bodies with each other.
pub(super) struct BodyContacts {
    pub(super) foreign: ForeignList,
    /// A separate search, if the neighbour list is not that of the current positions.
    pub(super) search: Option<ContactSearch>,
    /// Where bodies meet at the facets of their particles.
    pub(super) facets: Option<FacetContacts>,
    table: ContactLaws,
    /// Sums of each block.
    partial: Vec<BlockSums>,
    /// Largest stable step over the margin, by block, s.
    limits: Vec<f64>,
    /// Sums at the last evaluation, by pair of bodies.
    now: Vec<PairSums>,
    /// Works so far, by pair of bodies, J.
    works: Vec<Works>,
    /// Forces and heat of particles that have neighbours in contact, block by block.
    pushes: Vec<Vec<(usize, Push)>>,
    /// Forces on the edges of these, block by block.
    pulls: Vec<PullsOfBlock>,
    /// Which bodies that met others at facets have come apart in this step.
    released: Vec<bool>,
}

/// Sums over the pairs of two bodies, the first with the lower index.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PairSums {
    /// Force on the first, N.
    pub(super) force: Vector<f64>,
    /// Powers, W: what pairs of facets take up, with friction and damping, and of what meets by overlap as much as friction and damping.
    pub(super) stored: f64,
    /// What pairs that meet by overlap store.
    overlapped: f64,
    pub(super) friction: f64,
    pub(super) damped: f64,
    /// What facets hold, J.
    pub(super) energy: f64,
}

impl PairSums {
    fn add(&mut self, part: &Self) {
        self.stored += part.stored;
        self.overlapped += part.overlapped;
        self.friction += part.friction;
        self.damped += part.damped;
        self.energy += part.energy;
        for k in 0..3 {
            self.force[k] += part.force[k];
        }
    }

    fn to_array(self) -> [f64; 8] {
        let [x, y, z] = self.force;
        [x, y, z, self.stored, self.overlapped, self.friction, self.damped, self.energy]
    }

    fn from_array([x, y, z, stored, overlapped, friction, damped, energy]: [f64; 8]) -> Self {
        Self { force: [x, y, z], stored, overlapped, friction, damped, energy }
    }
}

/// Sums of a block over the pairs of bodies that meet in it, by their index: few of the many pairs of many bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockSums(Vec<(usize, PairSums)>);

impl BlockSums {
    pub(super) fn of(&mut self, place: usize) -> &mut PairSums {
        let known = self.0.iter().position(|sum| sum.0 == place);
        let at = known.unwrap_or_else(|| {
            self.0.push((place, PairSums::default()));
            self.0.len() - 1
        });
        &mut self.0[at].1
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Works {
    stored: f64,
    overlapped: f64,
    friction: f64,
    damped: f64,
    /// What facets held at the start, J.
    initial: f64,
}

/// Differences of the contact positions from the positions, and their rates.
#[derive(Clone, Copy)]
struct Shifts<'a> {
    shift: WithGhosts<'a, Vector<f64>>,
    rate: WithGhosts<'a, Vector<f64>>,
}

/// Positions of particles and ghosts in the contact.
#[derive(Clone, Copy)]
struct Places<'a> {
    position: WithGhosts<'a, Vector<f64>>,
    velocity: WithGhosts<'a, Vector<f64>>,
    /// Shifts to positions that are half a spacing behind the faces, and their rates, in the total Lagrangian form.
    shift: Option<Shifts<'a>>,
}

impl<'a> Places<'a> {
    /// At the positions of particles and ghosts.
    fn new(own: &'a Particles, ghosts: &'a Particles) -> Self {
        Self::at((&own.position, &ghosts.position), own, ghosts)
    }

    /// Of particles at the first of these positions, m, and ghosts at the second.
    fn at(position: (&'a [Vector<f64>], &'a [Vector<f64>]), own: &'a Particles, ghosts: &'a Particles) -> Self {
        let shift = || Shifts {
            shift: WithGhosts::new(&own.contact_shift, &ghosts.contact_shift),
            rate: WithGhosts::new(&own.contact_shift_rate, &ghosts.contact_shift_rate),
        };
        Self {
            position: WithGhosts::new(position.0, position.1),
            velocity: WithGhosts::new(&own.evaluated_velocity, &ghosts.evaluated_velocity),
            shift: (!own.contact_shift.is_empty()).then(shift),
        }
    }

    /// From the contact position of `j` to that of `i`, m.
    fn apart(&self, i: usize, j: usize) -> Vector<f64> {
        let x = difference(self.position.at(i), self.position.at(j));
        self.shift.map_or(x, |by| plus(x, difference(by.shift.at(i), by.shift.at(j))))
    }

    /// Velocity of the contact position of `i` relative to that of `j`, m/s.
    fn relative_velocity(&self, i: usize, j: usize) -> Vector<f64> {
        let v = difference(self.velocity.at(i), self.velocity.at(j));
        self.shift.map_or(v, |by| plus(v, difference(by.rate.at(i), by.rate.at(j))))
    }
}

/// What overlaps follow from.
#[derive(Clone, Copy)]
struct Seen<'a> {
    places: Places<'a>,
    mass: WithGhosts<'a, f64>,
    body: WithGhosts<'a, u32>,
    surfaces: Surfaces<'a>,
}

impl<'a> Seen<'a> {
    fn new(places: Places<'a>, own: &'a Particles, ghosts: &'a Particles) -> Self {
        Self {
            places,
            mass: WithGhosts::new(&own.mass, &ghosts.mass),
            body: WithGhosts::new(&own.body, &ghosts.body),
            surfaces: Surfaces::new(&own.reference_normal, &own.deformation, ghosts),
        }
    }
}

/// The data of particles and ghosts that the contact reads.
#[derive(Clone, Copy)]
struct Points<'a> {
    seen: Seen<'a>,
    overlap: WithGhosts<'a, f64>,
    direction: WithGhosts<'a, Vector<f64>>,
    weight: WithGhosts<'a, f64>,
}

impl<'a> Points<'a> {
    fn new(places: Places<'a>, own: &'a Particles, ghosts: &'a Particles) -> Self {
        Self {
            seen: Seen::new(places, own, ghosts),
            overlap: WithGhosts::new(&own.contact_overlap, &ghosts.contact_overlap),
            direction: WithGhosts::new(&own.contact_direction, &ghosts.contact_direction),
            weight: WithGhosts::new(&own.contact_weight, &ghosts.contact_weight),
        }
    }

    /// Overlap of a particle or ghost with other bodies.
    fn overlap_of(&self, j: usize) -> Overlap<f64> {
        Overlap { overlap: self.overlap.at(j), away: self.direction.at(j), weight: self.weight.at(j) }
    }
}

fn difference(a: Vector<f64>, b: Vector<f64>) -> Vector<f64> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn plus(a: Vector<f64>, b: Vector<f64>) -> Vector<f64> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Heat that each particle of a body receives of the energy `held` (J) by its contact with itself, J/kg: in proportion
/// to how far it is `pressed`, evenly if none is any more. `sum` is the mass-weighted sum of a number over the body.
///
/// # Errors
/// Those of `sum`.
pub fn heat_of_released<'a>(
    held: f64,
    pressed: &'a dyn Fn(usize) -> f64,
    sum: impl Fn(&dyn Fn(usize) -> f64) -> Result<f64, RunFailure>,
) -> Result<impl Fn(usize) -> f64 + 'a, RunFailure> {
    let of_pressed = sum(pressed)?;
    let is_pressed = of_pressed > 0.0;
    let all = if is_pressed { of_pressed } else { sum(&|_| 1.0)? };
    Ok(move |i| held * if is_pressed { pressed(i) } else { 1.0 } / all)
}

impl BodyContacts {
    /// `None` if bodies interact through the kernel sum, or if there is no contact. With a halo, pairs are searched
    /// separately from the neighbour list.
    pub(super) fn new(model: &Model, particles: usize, halo: Option<Box<dyn Halo>>) -> Option<Self> {
        let (strength, by_overlap) = (model.contact.strength()?, model.contact.overlap_strength()?);
        let pairs = model.contact_pairs().len();
        if pairs == 0 {
            return None;
        }
        let table = ContactLaws::new(model, by_overlap);
        let facets = model.has_facets().then(|| FacetContacts::new(model, strength));
        Some(Self {
            facets,
            foreign: ForeignList::default(),
            search: halo.map(|halo| ContactSearch::new(model, halo, table.smoothing_length.clone())),
            table,
            partial: vec![BlockSums::default(); particles.div_ceil(BLOCK)],
            limits: vec![f64::INFINITY; particles.div_ceil(BLOCK)],
            now: vec![PairSums::default(); pairs],
            works: vec![Works::default(); pairs],
            pushes: vec![Vec::new(); particles.div_ceil(BLOCK)],
            pulls: vec![Vec::new(); particles.div_ceil(BLOCK)],
            released: vec![false; model.bodies.len()],
        })
    }

    /// Allocates memory for other particles, before a step has summed anything.
    pub(super) fn resize(&mut self, particles: usize) {
        let blocks = particles.div_ceil(BLOCK);
        self.partial.resize(blocks, BlockSums::default());
        self.limits.resize(blocks, f64::INFINITY);
        self.pushes.resize(blocks, Vec::new());
        self.pulls.resize(blocks, Vec::new());
    }

    /// Images that pairs refer to, if they are not those of the list.
    pub(super) fn images(&self, domain: Option<&Domain>) -> Option<&[Image]> {
        self.search.as_ref().map(|search| search.images(domain.map(|domain| &domain.share)))
    }

    /// The points, of all ranks if there are several, that are in contact with particle `i` of this rank.
    pub(super) fn met_by<'a>(&'a self, i: usize, domain: Option<&'a Domain>) -> impl Iterator<Item = u32> + 'a {
        let of_all = move |j: u32| match (domain, &self.search) {
            (None, _) => j,
            (Some(domain), None) => domain.point(j),
            (Some(domain), Some(search)) => search.point(domain, j),
        };
        let rows = self.foreign.blocks()[i / BLOCK].rows();
        rows.filter(move |(own, _)| *own == i).flat_map(|(_, row)| row.iter()).map(move |&j| of_all(j))
    }

    /// Removes the pairs of different bodies from a list that was just rebuilt.
    pub(super) fn take_pairs(&mut self, list: &mut NeighborList, body: WithGhosts<'_, u32>) {
        self.foreign.take_from(list, |i, j| body.at(i) != body.at(j));
    }

    /// Adds the powers of the last evaluation over a time `dt`, s.
    pub(super) fn book(&mut self, dt: f64) {
        for (works, now) in self.works.iter_mut().zip(&self.now) {
            works.stored += dt * now.stored;
            works.overlapped += dt * now.overlapped;
            works.friction += dt * now.friction;
            works.damped += dt * now.damped;
        }
    }

    /// Converts the energy held by the contact of a body with itself to heat of the particles it presses. From now on
    /// its surfaces meet in the sums of the body.
    ///
    /// It keeps what it overlaps others by, as its cells may be pressed flat or lie beside theirs, and what its contact with them holds becomes heat, too: an
    /// overlap of that much would drive them apart with far more than facets held.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn release(
        &mut self,
        body: usize,
        particles: &mut Particles,
        share: Option<&Share>,
    ) -> Result<(), RunFailure> {
        let Some(works) = self.works.get_mut(self.table.place(body, body)) else {
            return Ok(());
        };
        let mut held = match self.facets {
            // What facets hold is the sum of the last evaluation.
            Some(_) => self.now[self.table.place(body, body)].energy,
            None => std::mem::take(&mut works.overlapped),
        };
        works.damped += held;
        if self.facets.is_some() {
            held += self.let_go(body);
        }
        let Particles { energy, mass, body: bodies, contact_overlap, reference_normal, .. } = particles;
        let is_met = |i: usize| {
            let rows = self.foreign.blocks().get(i / BLOCK).into_iter().flat_map(|block| block.rows());
            rows.map(|(own, _)| own).any(|own| own == i)
        };
        let has_facets = self.facets.is_some();
        let pressed = |i: usize| match (has_facets, reference_normal[i] == [0.0; 3]) {
            (true, _) => f64::from(u8::from(is_met(i))),
            (false, true) => 0.0,
            (false, false) => share_of_released(contact_overlap[i]),
        };
        let sum = |part: &dyn Fn(usize) -> f64| -> Result<f64, RunFailure> {
            let of = |i: usize| if bodies[i] as usize == body { mass[i] * part(i) } else { 0.0 };
            let add = |sums: &mut [f64]| (0..mass.len()).for_each(|i| sums[0] += of(i));
            let mut sums = [0.0];
            match share {
                Some(share) => share.ranks.sum_in_turn(&mut sums, add)?,
                None => add(&mut sums),
            }
            Ok(sums[0])
        };
        let heat = heat_of_released(held, &pressed, sum)?;
        for i in (0..energy.len()).filter(|&i| bodies[i] as usize == body) {
            energy[i] += heat(i);
        }
        Ok(())
    }

    /// From now on a body that has come apart meets the others by what it overlaps them more than now; returns what their facets held, J.
    fn let_go(&mut self, body: usize) -> f64 {
        self.released[body] = true;
        let others = (0..self.table.smoothing_length.len()).filter(|other| *other != body);
        let places: Vec<usize> = others.map(|other| self.table.place(body, other)).collect();
        places.into_iter().fold(0.0, |all, place| {
            let held = std::mem::take(&mut self.now[place].energy);
            self.works[place].damped += held;
            all + held
        })
    }

    /// Forces on the edges that facets share, where bodies meet at facets.
    pub(super) fn pulls<'a>(
        &'a self,
        particles: &'a Particles,
        ghosts: &'a Ghosts,
        list: &NeighborList,
    ) -> Option<Pulls<'a>> {
        self.facets.as_ref().map(|facets| Pulls::new(facets, particles, ghosts, list))
    }

    /// Smoothing lengths of particles in the contact, by body, m.
    pub(super) fn smoothing_lengths(&self) -> &[f64] {
        &self.table.smoothing_length
    }

    /// Particles' neighbours in other bodies.
    pub(super) fn foreign(&self) -> &ForeignList {
        &self.foreign
    }

    /// Force on particle `i` by a particle or ghost `j` of another body, N, where particles and ghosts are at `places`, m.
    pub(super) fn force_of_pair(
        &self,
        i: usize,
        j: u32,
        places: (&[Vector<f64>], &[Vector<f64>]),
        own: &Particles,
        ghosts: &Particles,
        dt: f64,
    ) -> Vector<f64> {
        if let Some(facets) = &self.facets {
            let body = WithGhosts::new(&own.body, &ghosts.body);
            if !facets.are_apart(body.at(i), body.at(j as usize)) {
                return facets.force(i, j, own, ghosts, &self.table);
            }
        }
        let points = Points::new(Places::at(places, own, ghosts), own, ghosts);
        self.table.row(i, &[j], &points, None, dt, &mut BlockSums::default()).force
    }

    /// Largest stable step over the margin, s.
    pub(super) fn limit(&self) -> f64 {
        self.limits.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Energy and forces of every pair of bodies.
    pub(super) fn ledger(&self) -> Vec<ContactLedger> {
        let has_facets = self.facets.is_some();
        let of = |(now, works): (&PairSums, &Works)| {
            let taken_up = works.stored - works.friction - works.damped;
            let (stored_energy, integration_energy) = match has_facets {
                true => (now.energy + works.overlapped, taken_up - (now.energy - works.initial)),
                false => (works.overlapped, 0.0),
            };
            ContactLedger {
                force: now.force.map(|f| 0.0 - f),
                stored_energy,
                friction_work: works.friction,
                damping_work: works.damped,
                integration_energy,
            }
        };
        self.now.iter().zip(&self.works).map(of).collect()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let search = self.search.as_ref().map_or(0, ContactSearch::bytes);
        let pushes: usize = self.pushes.iter().map(Vec::capacity).sum();
        let sums: usize = self.partial.iter().map(|block| block.0.capacity()).sum();
        search
            + self.facets.as_ref().map_or(0, FacetContacts::bytes)
            + self.foreign.bytes()
            + pushes * size_of::<(usize, Push)>()
            + self.pulls.iter().map(Vec::capacity).sum::<usize>() * size_of::<(usize, OnSides<f64>)>()
            + sums * size_of::<(usize, PairSums)>()
            + self.partial.capacity() * size_of::<BlockSums>()
    }

    /// Completes a loaded state once all ranks have loaded theirs: creates the ghosts that are in contact and updates
    /// them.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn complete(
        &mut self,
        particles: &Particles,
        share: Option<&Share>,
        has_come_apart: &[bool],
    ) -> Result<(), RunFailure> {
        let Some(search) = &mut self.search else { return Ok(()) };
        search.complete(particles, share, &mut self.foreign)?;
        if let Some(facets) = &mut self.facets {
            facets.adopt(&self.foreign, particles, &search.ghosts, has_come_apart);
        }
        Ok(())
    }

    /// The ghosts in its pairs, if they are not those of the neighbour list.
    pub(super) fn ghosts<'a>(&'a self, of_list: &'a Ghosts) -> &'a Ghosts {
        self.search.as_ref().map_or(of_list, |search| &search.ghosts)
    }

    /// The same to be filled, if there are any.
    pub(super) fn ghosts_of_search(&mut self) -> Option<&mut Ghosts> {
        self.search.as_mut().map(|search| &mut search.ghosts)
    }

    /// Adds up the blocks in their order, over all ranks if there are several.
    fn close(&mut self, share: Option<&Share>) -> Result<(), RunFailure> {
        self.now.fill(PairSums::default());
        let own = self.partial.iter().flat_map(|block| &block.0);
        match share {
            None => own.for_each(|(place, part)| self.now[*place].add(part)),
            Some(share) => {
                let own: Vec<(usize, [f64; 8])> = own.map(|(place, part)| (*place, part.to_array())).collect();
                for (place, part) in share.ranks.gather_all(&own)? {
                    self.now[place].add(&PairSums::from_array(part));
                }
            }
        }
        Ok(())
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// First pass: the overlap of every particle that has neighbours in other bodies.
    pub(super) fn overlap_bodies(&mut self) {
        if self.contacts.as_ref().is_some_and(|contacts| contacts.facets.is_some()) {
            self.slip_facets();
        }
        let Some(contacts) = &self.contacts else { return };
        let table = &contacts.table;
        let facets = contacts.facets.as_ref();
        if facets.is_some_and(|facets| !facets.has_rubble()) {
            return;
        }
        let mut overlaps = std::mem::take(&mut self.particles.contact_overlap);
        let mut directions = std::mem::take(&mut self.particles.contact_direction);
        let mut weights = std::mem::take(&mut self.particles.contact_weight);
        let mut kept = std::mem::take(&mut self.particles.kept_overlap);
        let p = &self.particles;
        let ghosts = &contacts.ghosts(&self.ghosts).columns;
        let seen = Seen::new(Places::new(p, ghosts), p, ghosts);
        (
            contacts.foreign.blocks().par_iter(),
            overlaps.par_chunks_mut(BLOCK),
            directions.par_chunks_mut(BLOCK),
            weights.par_chunks_mut(BLOCK),
        )
            .into_par_iter()
            .for_each(|(block, overlaps, directions, weights)| {
                for (i, row) in block.rows() {
                    let sum = table.overlap(i, row, &seen, |a, b| by_overlap(facets, a, b));
                    let k = i % BLOCK;
                    (overlaps[k], directions[k], weights[k]) = (sum.overlap, sum.away, sum.weight);
                }
            });
        if !kept.is_empty() && facets.is_some() {
            // Pairs that met by overlap before this step push on as they did.
            let has_come_apart = &self.has_come_apart;
            let was_apart = |body: usize| has_come_apart[body] && !contacts.released[body];
            let met_before = |a: usize, b: usize| was_apart(a) || was_apart(b);
            let some_released = contacts.released.contains(&true);
            for (i, row) in contacts.foreign.blocks().iter().flat_map(|block| block.rows()) {
                let whole = overlaps[i];
                if some_released {
                    let pushes = (table.overlap(i, row, &seen, met_before).overlap - kept[i]).max(0.0);
                    kept[i] = kept[i].max(whole - pushes);
                }
                kept[i] = kept[i].min(whole.max(0.0));
                overlaps[i] = whole - kept[i];
            }
        }
        let p = &mut self.particles;
        (p.contact_overlap, p.contact_direction, p.contact_weight) = (overlaps, directions, weights);
        p.kept_overlap = kept;
        if let Some(contacts) = &mut self.contacts {
            contacts.released.fill(false);
        }
    }

    /// First pass of facets: where they are, and their slips.
    fn slip_facets(&mut self) {
        let Some(contacts) = &mut self.contacts else { return };
        let BodyContacts { foreign, search, facets, .. } = contacts;
        let Some(facets) = facets else { return };
        let ghosts = search.as_ref().map_or(&self.ghosts.columns, |search| &search.ghosts.columns);
        facets.follow(&self.particles, ghosts);
        let points = FacetPoints::new(&self.particles, ghosts);
        facets.find(foreign, &points);
        if !facets.laws.has_friction {
            return;
        }
        let dt = self.step.dt;
        let mut slips = std::mem::take(&mut facets.slips);
        slips.par_iter_mut().zip(foreign.blocks()).for_each(|(slips, block)| {
            slips.clear();
            slips.extend(block.rows().map(|(i, _)| (i, facets.slips(i, &points, dt))));
        });
        let p = &mut self.particles;
        for &(i, CellSlips { slip, rubbed }) in slips.iter().flatten() {
            [p.slip_of_low_faces[i], p.slip_of_high_faces[i]] = slip;
            [p.rubbed_at_low_faces[i], p.rubbed_at_high_faces[i]] = rubbed;
        }
        facets.slips = slips;
    }

    /// Second pass: computes the forces between bodies and their heat. A force on a face has a moment about the
    /// particle, which enters as a stress of it, so that the work is done at the face.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn push_bodies(&mut self) -> Result<(), RunFailure> {
        let Some(contacts) = &mut self.contacts else { return Ok(()) };
        let BodyContacts { foreign, search, facets, table, partial, limits, pushes, pulls, .. } = contacts;
        let ghosts = search.as_ref().map_or(&self.ghosts.columns, |search| &search.ghosts.columns);
        let mut friction_heat = std::mem::take(&mut self.particles.friction_heat);
        let mut face_stress = std::mem::take(&mut self.particles.face_stress);
        let p = &self.particles;
        let points = Points::new(Places::new(p, ghosts), p, ghosts);
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        let (table, dt) = (&*table, self.step.dt);
        let at_facets = facets.as_ref().map(|facets| {
            let neighbors = Neighbors::new(facets, p, &self.ghosts.columns, &self.lists.list);
            (facets, FacetPoints::new(p, ghosts), neighbors)
        });
        let update = |block: &ForeignBlock,
                      (sums, limit): (&mut BlockSums, &mut f64),
                      (pushes, of_edges, friction_heat): (&mut Vec<(usize, Push)>, &mut PullsOfBlock, &mut [f64]),
                      face_stress: &mut [Tensor<f64>]| {
            sums.0.clear();
            *limit = f64::INFINITY;
            pushes.clear();
            of_edges.clear();
            for (i, row) in block.rows() {
                let mut add_stress = |stress: Tensor<f64>| {
                    if let Some(own) = face_stress.get_mut(i % BLOCK) {
                        for (own, row) in own.iter_mut().zip(stress) {
                            (0..3).for_each(|a| own[a] += row[a]);
                        }
                    }
                };
                if let Some((facets, points, neighbors)) = &at_facets {
                    // Most of those that are near others press none.
                    if facets.is_alone(i, points) && !facets.has_rubble() {
                        continue;
                    }
                    let f = whole.at(i);
                    let presses = facets.may_press(i);
                    let edges =
                        if presses { neighbors.edges(i, &f, &p.evaluated_gradient[i]) } else { CellEdges::new() };
                    let own = (p.mass[i], &f, &edges);
                    let (push, moment, pulls) = facets.push(i, (row, None), points, own, table, sums);
                    if presses {
                        of_edges.push((i, pulls));
                    }
                    friction_heat[i % BLOCK] += push.friction / p.mass[i];
                    *limit = limit.min(push.limit);
                    add_stress(stress_of_faces(&moment, &p.deformation[i], p.reference_volume[i]));
                    pushes.push((i, push));
                    if !facets.has_rubble() {
                        continue;
                    }
                }
                let mut push = table.row(i, row, &points, at_facets.as_ref().map(|(facets, ..)| *facets), dt, sums);
                friction_heat[i % BLOCK] += push.friction / p.mass[i];
                *limit = limit.min(push.limit);
                let face = || FaceShift::new(&whole.at(i), p.face_arm[i]);
                if let Some(face) = points.seen.places.shift.and_then(|_| face()) {
                    push.heat += dot(push.force, p.contact_shift_rate[i]);
                    let moment = face.stress(&p.deformation[i], push.force);
                    add_stress(moment.map(|row| row.map(|c| c / p.reference_volume[i])));
                }
                pushes.push((i, push));
            }
        };
        let sums = partial.par_iter_mut().zip(limits);
        let pushes = (pushes.par_iter_mut(), pulls.par_iter_mut(), friction_heat.par_chunks_mut(BLOCK)).into_par_iter();
        let chunks = (foreign.blocks().par_iter(), sums, pushes);
        if face_stress.is_empty() {
            chunks.into_par_iter().for_each(|(block, sums, pushes)| update(block, sums, pushes, &mut []));
        } else {
            let (block, sums, pushes) = chunks;
            (block, sums, pushes, face_stress.par_chunks_mut(BLOCK))
                .into_par_iter()
                .for_each(|(block, sums, pushes, stress)| update(block, sums, pushes, stress));
        }
        contacts.close(self.domain.as_deref())?;
        if self.step.count == 0 {
            contacts.works.iter_mut().zip(&contacts.now).for_each(|(works, now)| works.initial = now.energy);
        }
        (self.particles.friction_heat, self.particles.face_stress) = (friction_heat, face_stress);
        if let Some(facets) = &contacts.facets {
            store_pulls(&facets.reference, &contacts.pulls, &mut self.particles);
        }
        Ok(())
    }

    /// Adds the forces between bodies, and their heat, to those of the pair sum.
    pub(super) fn add_body_contact(&mut self) {
        let Some(contacts) = &self.contacts else { return };
        let Particles { acceleration, energy_rate, mu, mass, .. } = &mut self.particles;
        for &(i, push) in contacts.pushes.iter().flatten() {
            for axis in 0..3 {
                acceleration[i][axis] += push.force[axis] / mass[i];
            }
            energy_rate[i] += push.heat / mass[i];
            mu[i] = mu[i].max(push.approach);
        }
    }
}

/// Whether particles of two bodies meet by overlap: all where there are no facets, else those of bodies that have come apart.
fn by_overlap(facets: Option<&FacetContacts>, a: usize, b: usize) -> bool {
    facets.is_none_or(|facets| facets.are_apart(a as u32, b as u32))
}

/// Sums of one particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Push {
    pub(super) force: Vector<f64>,
    /// Power that becomes heat of the particle in all its pairs, W, including the difference in power due to the stress
    /// of its face.
    pub(super) heat: f64,
    /// Friction's part of it, W.
    pub(super) friction: f64,
    approach: f64,
    pub(super) limit: f64,
}

impl ContactLaws {
    /// What a particle overlaps its neighbours in bodies by that meet its own.
    #[inline]
    fn overlap(&self, i: usize, row: &[u32], seen: &Seen<'_>, meet: impl Fn(usize, usize) -> bool) -> Overlap<f64> {
        let a = seen.body.at(i) as usize;
        let volume = seen.mass.at(i) * self.specific_volume[a];
        let mut sum = Overlap::before_the_first();
        for &j in row {
            let j = j as usize;
            let b = seen.body.at(j) as usize;
            if !meet(a, b) || a == b && !seen.surfaces.press(i, j) {
                continue;
            }
            let x = seen.places.apart(i, j);
            let kernel = self.kernel(a, b, dot(x, x).sqrt());
            sum.add(self.law(a, b), &kernel, x, volume, seen.mass.at(j) * self.specific_volume[b]);
        }
        sum
    }

    /// By overlap; with `facets` only with what does not meet there.
    fn row(
        &self,
        i: usize,
        row: &[u32],
        points: &Points<'_>,
        facets: Option<&FacetContacts>,
        dt: f64,
        sums: &mut BlockSums,
    ) -> Push {
        let a = points.seen.body.at(i) as usize;
        let mass = points.seen.mass.at(i);
        let volume = mass * self.specific_volume[a];
        let own = points.overlap_of(i);
        let mut push = Push::default();
        let mut stiffness = ContactStiffness::default();
        for &j in row {
            let j = j as usize;
            let b = points.seen.body.at(j) as usize;
            if !by_overlap(facets, a, b) || a == b && !points.seen.surfaces.press(i, j) {
                continue;
            }
            let x = points.seen.places.apart(i, j);
            let law = self.law(a, b);
            let (other, other_mass) = (points.overlap_of(j), points.seen.mass.at(j));
            let kernel = self.kernel(a, b, dot(x, x).sqrt());
            let other_volume = other_mass * self.specific_volume[b];
            let (weight, overlaps) = (kernel.weight(volume, other_volume), (own.overlap, other.overlap));
            let pair = ContactPair {
                x,
                v: points.seen.places.relative_velocity(i, j),
                weight,
                overlaps,
                direction: difference(own.away, other.away),
                stopping: stopping(mass, other_mass, weight, (own.weight, other.weight), dt),
            };
            let force = contact_force(law, &pair);
            push.approach = push.approach.max(force.approach);
            let sum = sums.of(self.place(a, b));
            for k in 0..3 {
                push.force[k] += force.force[k];
                if a < b {
                    sum.force[k] += force.force[k];
                }
            }
            let (heat, friction) = force.own_heat(self.friction_share(a, b));
            push.heat += heat;
            push.friction += friction;
            // The other half comes from the row of the other particle.
            sum.stored += 0.5 * (force.rubbed + force.damped);
            sum.overlapped += 0.5 * force.stored;
            sum.friction += 0.5 * force.rubbed;
            sum.damped += 0.5 * force.damped;
            stiffness.add(law, &kernel, overlaps, volume, other_volume);
        }
        push.limit = stiffness.limit(&own, volume, mass);
        push
    }
}

crate::persist_fields!(PairSums { force, stored, overlapped, friction, damped, energy });
crate::persist_fields!(Works { stored, overlapped, friction, damped, initial });

impl BodyContacts {
    /// Saves or loads the data of the `count` particles of this rank. Pairs follow from the neighbour list, except
    /// those that are searched separately.
    pub(super) fn persist(
        &mut self,
        count: usize,
        share: Option<&Share>,
        name: &str,
        archive: &mut dyn Archive,
    ) -> Result<(), ArchiveError> {
        if let Some(search) = &mut self.search {
            search.persist(count, share, &format!("{name}.search"), archive)?;
            let number = |j: u32| share.map_or(j, |share| search.point(share, j));
            self.foreign.persist(count, number, &format!("{name}.foreign"), archive)?;
        }
        persist_each(&mut self.now, &format!("{name}.now"), archive)?;
        persist_each(&mut self.works, &format!("{name}.works"), archive)
    }
}
