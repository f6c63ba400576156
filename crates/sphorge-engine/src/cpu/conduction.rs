//! Heat conduction: the flow between particles and through boundaries, and its effect on energy and temperature.
//!
//! Forward Euler with the temperatures of the start of the step, in double precision. In a run with mechanics the flow
//! is not summed in every step ([`HeatClock`]); until the next sum the last flow continues. Each sum is antisymmetric,
//! so heat is conserved either way.

use super::CpuEngine;
use super::conduction_table::ConductionTable;
use super::domain::Share;
use super::ghosts::{Ghosts, WithGhosts};
use super::reference_conduction::{ReferencePoints, sum_reference_flow};
use crate::geometry::HeatFaces;
use crate::halo::{self, Exchanged, ExchangedSets, GhostColumn};
use crate::lanes::PairScalar;
use crate::model::{HeatBoundaryKind, Material, Model, TemperatureSource};
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, persist_column};
use crate::{HeatClock, HeatLedger, RunFailure};
use rayon::prelude::*;
use smallvec::smallvec;
use sphorge_physics::conduction::{
    Inflow, Surroundings, cell_size, conducting_share, face_area, outline_area, replaced, touch, turned, turned_back,
};
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::time_step::conduction_limit;
use sphorge_physics::{Dimension, SymmetricTensor, Vector, tensor::dot};

/// Heat flow.
#[derive(Clone, Debug)]
pub(super) struct HeatFlow {
    table: ConductionTable,
    faces: HeatFaces,
    /// Power of each boundary by block, W, and its heat in a step by block, J.
    partial: Vec<f64>,
    /// Heat exchanged in a step by block, J.
    moved: Vec<f64>,
    /// Largest stable step over the margin by block, s.
    limits: Vec<f64>,
    /// When it is summed again, with the smallest limit of all blocks of all ranks.
    clock: HeatClock,
    /// Power of each boundary at the last evaluation, W.
    power: Vec<f64>,
    /// Heat of each boundary so far, J.
    supplied: Vec<f64>,
    /// Heat exchanged so far, J.
    exchanged: f64,
    surfaces: bool,
    /// Whether the flow is summed again in this step.
    due: bool,
    /// The other body whose face each particle touches, which is that of the nearest particle: its index plus one, zero
    /// for none.
    touched: Vec<u32>,
    /// The same of the ghosts of the neighbour list, and of those of the contact.
    touched_near: Vec<u32>,
    touched_far: Vec<u32>,
    /// Share with which each particle conducts, if some material breaks, and those of the ghosts.
    shares: Vec<f64>,
    shares_near: Vec<f64>,
    shares_far: Vec<f64>,
    /// What replaces missing pairs of each particle in the configuration of the sums, and of the ghosts of the neighbour list.
    replacements: Vec<SymmetricTensor<f64>>,
    replacements_near: Vec<SymmetricTensor<f64>>,
    /// The same in the current configuration, where other bodies are, and of the ghosts of the contact.
    replacements_now: Vec<SymmetricTensor<f64>>,
    replacements_far: Vec<SymmetricTensor<f64>>,
    /// Whether these and the bodies touched are those of the particles where they are: without mechanics from the first sum after a search on.
    surroundings_known: bool,
}

/// What replaces missing pairs of particles and ghosts.
#[derive(Clone, Copy)]
pub(super) struct Replacements<'a>(WithGhosts<'a, SymmetricTensor<f64>>);

impl Replacements<'_> {
    /// How many times as much as by itself a pair conducts at the distance `x` (m, its square `r2`).
    #[inline(always)]
    pub(super) fn of_pair(&self, i: usize, j: usize, x: Vector<f64>, r2: f64) -> f64 {
        replaced(self.0.at(i), self.0.at(j), x, r2)
    }
}

/// Shares with which particles and ghosts conduct; nothing where no material breaks.
#[derive(Clone, Copy)]
pub(super) struct Shares<'a>(Option<WithGhosts<'a, f64>>);

impl<'a> Shares<'a> {
    fn new(own: &'a [f64], ghosts: &'a [f64]) -> Self {
        Self((!own.is_empty()).then(|| WithGhosts::new(own, ghosts)))
    }

    /// Of a pair: the smaller one.
    #[inline(always)]
    pub(super) fn of_pair(&self, i: usize, j: usize) -> f64 {
        self.0.map_or(1.0, |shares| shares.at(i).min(shares.at(j)))
    }
}

impl HeatFlow {
    /// `None` without heat conduction.
    pub(super) fn new(model: &Model, particles: usize) -> Option<Self> {
        let (blocks, boundaries) = (particles.div_ceil(BLOCK), model.thermal.boundaries.len());
        let on_surface = |kind| !matches!(kind, HeatBoundaryKind::HeldTemperature(_));
        model.thermal.conduction.then(|| Self {
            table: ConductionTable::new(model),
            faces: HeatFaces::new(model),
            // At least one column, so that every block has a chunk.
            partial: vec![0.0; blocks * boundaries.max(1)],
            moved: vec![0.0; blocks],
            limits: vec![f64::INFINITY; blocks],
            clock: HeatClock::default(),
            power: vec![0.0; boundaries],
            supplied: vec![0.0; boundaries],
            exchanged: 0.0,
            surfaces: model.thermal.boundaries.iter().any(|b| on_surface(b.kind)),
            due: false,
            touched: vec![0; if model.bodies.len() > 1 { particles } else { 0 }],
            touched_near: Vec::new(),
            touched_far: Vec::new(),
            shares: vec![1.0; if model.materials.iter().any(Material::breaks) { particles } else { 0 }],
            shares_near: Vec::new(),
            shares_far: Vec::new(),
            replacements: vec![SymmetricTensor::zero(); particles],
            replacements_near: Vec::new(),
            replacements_now: Vec::new(),
            replacements_far: Vec::new(),
            surroundings_known: false,
        })
    }

    /// Largest stable step over the margin at the last evaluation, s.
    pub(super) fn limit(&self) -> f64 {
        self.clock.limit
    }

    /// Allocates memory for other particles, before a step has summed anything.
    pub(super) fn resize(&mut self, particles: usize) {
        let blocks = particles.div_ceil(BLOCK);
        self.partial.resize(blocks * self.power.len().max(1), 0.0);
        self.moved.resize(blocks, 0.0);
        self.limits.resize(blocks, f64::INFINITY);
        self.replacements.resize(particles, SymmetricTensor::zero());
        self.surroundings_known = false;
        if !self.touched.is_empty() {
            self.touched.resize(particles, 0);
        }
        if !self.shares.is_empty() {
            self.shares.resize(particles, 1.0);
        }
    }

    /// After a search particles may be elsewhere in the columns, and pairs others.
    pub(super) fn forget_surroundings(&mut self) {
        self.surroundings_known = false;
    }

    /// Whether the flow is summed again in this step.
    pub(super) fn is_due(&self) -> bool {
        self.due
    }

    /// Heat balance.
    pub(super) fn ledger(&self) -> HeatLedger {
        HeatLedger { supplied: self.supplied.clone(), exchanged: self.exchanged }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let touched = self.touched.capacity() + self.touched_near.capacity() + self.touched_far.capacity();
        let shares = self.shares.capacity() + self.shares_near.capacity() + self.shares_far.capacity();
        let columns = 8 * (shares + self.partial.capacity() + self.moved.capacity() + self.limits.capacity());
        let of_particles = self.replacements.capacity() + self.replacements_now.capacity();
        let of_ghosts = self.replacements_near.capacity() + self.replacements_far.capacity();
        let replacements = size_of::<SymmetricTensor<f64>>() * (of_particles + of_ghosts);
        columns + self.faces.bytes() + 4 * touched + replacements
    }

    /// Sets the smallest limit and adds up the power of each boundary, over all ranks if there are several.
    fn close(&mut self, share: Option<&Share>) -> Result<(), RunFailure> {
        let least = self.limits.iter().copied().fold(f64::INFINITY, f64::min);
        self.clock.limit = share.map_or(Ok(least), |share| share.range((least, 0.0)).map(|range| range.0))?;
        self.power.fill(0.0);
        add_by_boundary(&self.partial, &mut self.power, share)
    }
}

/// Sets the temperature of held particles: part of the initial state.
pub(super) fn hold(model: &Model, particles: &mut Particles) {
    for i in 0..particles.len() {
        for boundary in &model.thermal.boundaries {
            if let HeatBoundaryKind::HeldTemperature(held) = boundary.kind
                && boundary.claims(particles.body[i], particles.regions[i])
            {
                let cp = model.materials[particles.material[i] as usize].specific_heat;
                particles.energy[i] += cp * (held - particles.temperature[i]);
                particles.temperature[i] = held;
            }
        }
    }
}

/// Adds the contributions of all blocks, in their order, boundary by boundary.
fn add_by_boundary(partial: &[f64], totals: &mut [f64], share: Option<&Share>) -> Result<(), RunFailure> {
    if totals.is_empty() {
        return Ok(());
    }
    let all = share.map(|share| share.gather_blocks(partial, totals.len())).transpose()?;
    for block in all.as_deref().unwrap_or(partial).chunks(totals.len()) {
        for (total, part) in totals.iter_mut().zip(block) {
            *total += part;
        }
    }
    Ok(())
}

/// The values of a column for ghosts.
fn touched_of<'a>(ghosts: &'a Ghosts, touched: &'a [u32], of_ghosts: &'a mut Vec<u32>) -> Exchanged<'a> {
    of_ghosts.resize(ghosts.count(), 0);
    Exchanged { halo: ghosts.halo.as_ref(), columns: smallvec![GhostColumn::Integer(touched, of_ghosts)] }
}

fn shares_of<'a>(ghosts: &'a Ghosts, shares: &'a [f64], of_ghosts: &'a mut Vec<f64>) -> Exchanged<'a> {
    of_ghosts.resize(ghosts.count(), 1.0);
    Exchanged { halo: ghosts.halo.as_ref(), columns: smallvec![GhostColumn::Scalar(shares, of_ghosts)] }
}

fn replacements_of<'a>(
    ghosts: &'a Ghosts,
    replacements: &'a [SymmetricTensor<f64>],
    of_ghosts: &'a mut Vec<SymmetricTensor<f64>>,
) -> Exchanged<'a> {
    of_ghosts.resize(ghosts.count(), SymmetricTensor::zero());
    Exchanged { halo: ghosts.halo.as_ref(), columns: smallvec![GhostColumn::Symmetric(replacements, of_ghosts)] }
}

/// The data of particles and ghosts that the sum of the flow reads.
#[derive(Clone, Copy)]
struct HeatPoints<'a> {
    position: WithGhosts<'a, Vector<f64>>,
    smoothing_length: WithGhosts<'a, f64>,
    temperature: WithGhosts<'a, f64>,
    body: WithGhosts<'a, u32>,
    mass: WithGhosts<'a, f64>,
    density: WithGhosts<'a, f64>,
    touched: WithGhosts<'a, u32>,
    shares: Shares<'a>,
}

impl<'a> HeatPoints<'a> {
    fn new(p: &'a Particles, ghosts: &'a Ghosts, touched: WithGhosts<'a, u32>, shares: Shares<'a>) -> Self {
        let ghosts = &ghosts.columns;
        Self {
            touched,
            shares,
            position: WithGhosts::new(&p.position, &ghosts.position),
            smoothing_length: WithGhosts::new(&p.smoothing_length, &ghosts.smoothing_length),
            temperature: WithGhosts::new(&p.temperature, &ghosts.temperature),
            body: WithGhosts::new(&p.body, &ghosts.body),
            mass: WithGhosts::new(&p.mass, &ghosts.mass),
            density: WithGhosts::new(&p.density, &ghosts.density),
        }
    }

    /// The nearest particle of another body among neighbours whose faces touch that of particle `i`: its distance squared, m², and its body.
    fn nearest_touching(&self, i: usize, row: &[u32], dimension: Dimension) -> Option<(f64, u32)> {
        let (x_i, cell) = (self.position.at(i), |j: usize| cell_size(dimension, self.mass.at(j) / self.density.at(j)));
        let touching = |&j: &u32| {
            let (j, x) = (j as usize, self.position.at(j as usize));
            let d = [0, 1, 2].map(|a| x_i[a] - x[a]);
            let is_other = self.body.at(j) != self.body.at(i);
            (is_other && touch(dot(d, d), cell(i), cell(j))).then(|| (dot(d, d), self.body.at(j)))
        };
        row.iter().filter_map(touching).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Whether heat flows between two particles: they are of one body, or of two whose faces touch at one of them.
    fn are_joined(&self, i: usize, j: usize) -> bool {
        let (a, b) = (self.body.at(i), self.body.at(j));
        a == b || self.touched.at(i) == b + 1 || self.touched.at(j) == a + 1
    }

    /// The neighbours in a row with which a particle exchanges heat, and of each the distance `x_ij`, m, its square, m², and the smoothing length of the
    /// pair, m.
    fn joined<'r>(
        &'r self,
        i: usize,
        row: impl IntoIterator<Item = &'r u32>,
    ) -> impl Iterator<Item = (usize, Vector<f64>, f64, f64)> {
        let (x_i, h_i) = (self.position.at(i), self.smoothing_length.at(i));
        row.into_iter().map(|&j| j as usize).filter(move |&j| self.are_joined(i, j)).map(move |j| {
            let x_j = self.position.at(j);
            let x = [0, 1, 2].map(|k| x_i[k] - x_j[k]);
            (j, x, dot(x, x), pair_smoothing_length(h_i, self.smoothing_length.at(j)))
        })
    }

    /// Current volume, m^d.
    fn volume(&self, i: usize) -> f64 {
        self.mass.at(i) / self.density.at(i)
    }
}

impl ConductionTable {
    /// Adds neighbours to what a particle sees of its surroundings, in directions as `seen`.
    fn look<'a>(
        &self,
        surroundings: &mut Surroundings<f64>,
        i: usize,
        row: impl IntoIterator<Item = &'a u32>,
        points: &'a HeatPoints<'_>,
        seen: impl Fn(Vector<f64>) -> Vector<f64>,
    ) {
        for (j, x, r2, h) in points.joined(i, row) {
            let bodies = (points.body.at(i), points.body.at(j));
            self.see(surroundings, bodies, points.volume(j), (r2, h), seen(x));
        }
    }

    /// Adds the heat flow to a particle from neighbours.
    fn add<'a>(
        &self,
        sum: &mut Inflow<f64>,
        i: usize,
        row: impl IntoIterator<Item = &'a u32>,
        points: &'a HeatPoints<'_>,
        replacements: Replacements<'_>,
    ) {
        let volume = points.volume(i);
        for (j, x, r2, h) in points.joined(i, row) {
            let volumes = (volume, points.volume(j));
            let difference = points.temperature.at(j) - points.temperature.at(i);
            let bodies = (points.body.at(i), points.body.at(j));
            let conducts = (points.shares.of_pair(i, j), replacements.of_pair(i, j, x, r2));
            sum.add(&self.pair(bodies, volumes, (r2, h), difference, conducts), self.dimension);
        }
    }

    /// Power and conductance of a boundary at a particle on a surface, W and W/K: of its `face` where the boundary names faces, else of its
    /// `outline` as far as it is free (areas at unit density).
    fn through_surface(
        &self,
        kind: HeatBoundaryKind,
        i: usize,
        (face, outline): (Option<f64>, f64),
        sum: &Inflow<f64>,
        p: &Particles,
    ) -> (f64, f64) {
        let body = p.body[i] as usize;
        let volume = p.mass[i] / p.density[i];
        let area = match face {
            Some(face) => face_area(self.dimension, face, p.density[i]),
            None => outline_area(self.dimension, (volume, p.density[i]), sum.filled, self.flat[body], outline),
        };
        let cell = cell_size(self.dimension, volume);
        kind.through_surface(area, p.temperature[i], self.conductivity[body], cell)
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Determines whether the heat flow is due to be summed again, and computes the data of neighbours for it.
    pub(super) fn begin_heat(&mut self) {
        let Some(heat) = &mut self.heat else { return };
        heat.due = heat.clock.is_due(&self.model);
        if heat.due && !heat.shares.is_empty() {
            let (p, HeatFlow { shares, shares_near, shares_far, .. }) = (&self.particles, &mut *heat);
            shares.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, share)| {
                *share = conducting_share(p.pressure[i], p.history.integrity_of(i));
            });
            let touching = self.contacts.as_ref().map_or(&self.ghosts, |c| c.ghosts(&self.ghosts));
            halo::fill(smallvec![
                shares_of(&self.ghosts, shares, shares_near),
                shares_of(touching, shares, shares_far),
            ]);
        }
        if heat.due && self.formulation.is_initial() {
            let mut flow = std::mem::take(&mut self.particles.heat_flow);
            let shares = Shares::new(&heat.shares, &heat.shares_near);
            let points = ReferencePoints::new(&self.particles, &self.ghosts.columns, shares);
            sum_reference_flow(&heat.table, &self.lists.list, &points, &self.particles, &mut flow);
            self.particles.heat_flow = flow;
        }
    }

    /// Sums the heat flow again if it is due.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn sum_heat(&mut self) -> Result<(), RunFailure> {
        let Some(heat) = self.heat.as_mut().filter(|heat| heat.due) else { return Ok(()) };
        heat.clock.start();
        let mut rates = std::mem::take(&mut self.particles.heat_rate);
        let p = &self.particles;
        let (list, foreign) = (&self.lists.list, self.contacts.as_ref().map(|c| c.foreign()));
        let touching = self.contacts.as_ref().map_or(&self.ghosts, |c| c.ghosts(&self.ghosts));
        let HeatFlow {
            table,
            faces,
            partial,
            limits,
            surfaces,
            touched,
            touched_near,
            touched_far,
            shares,
            shares_near,
            shares_far,
            replacements,
            replacements_near,
            replacements_now,
            replacements_far,
            surroundings_known,
            ..
        } = &mut *heat;
        let [near, far] = [shares_near, shares_far].map(|of_ghosts| Shares::new(shares, of_ghosts));
        let reference = self.formulation.is_initial().then(|| ReferencePoints::new(p, &self.ghosts.columns, near));
        if !touched.is_empty() {
            let untouched = WithGhosts::new(&[], &[]);
            let [near, far] = [(&self.ghosts, near), (touching, far)]
                .map(|(ghosts, shares)| HeatPoints::new(p, ghosts, untouched, shares));
            let dimension = table.dimension;
            let unknown = if *surroundings_known { &mut [][..] } else { &mut touched[..] };
            unknown.par_chunks_mut(BLOCK).enumerate().for_each(|(b, touched)| {
                let mut rows = foreign.map(|f| f.blocks()[b].rows().peekable());
                for (k, touched) in touched.iter_mut().enumerate() {
                    let i = b * BLOCK + k;
                    let mut nearest = None;
                    if reference.is_none() {
                        nearest = near.nearest_touching(i, list.row(i), dimension);
                    }
                    if let Some((_, row)) = rows.as_mut().and_then(|rows| rows.next_if(|(own, _)| *own == i)) {
                        nearest = nearest.or(far.nearest_touching(i, row, dimension));
                    }
                    *touched = nearest.map_or(0, |(_, body)| body + 1);
                }
            });
            halo::fill(smallvec![
                touched_of(&self.ghosts, touched, touched_near),
                touched_of(touching, touched, touched_far),
            ]);
        }
        let points = HeatPoints::new(p, &self.ghosts, WithGhosts::new(touched, touched_near), near);
        let contact = touching;
        let touching = HeatPoints::new(p, contact, WithGhosts::new(touched, touched_far), far);
        let unknown = if *surroundings_known { &mut [][..] } else { &mut replacements[..] };
        unknown.par_chunks_mut(BLOCK).enumerate().for_each(|(b, replacements)| {
            let mut rows = foreign.map(|f| f.blocks()[b].rows().peekable());
            for (k, replacement) in replacements.iter_mut().enumerate() {
                let i = b * BLOCK + k;
                let mut surroundings = Surroundings::none();
                match &reference {
                    Some(points) => table.see_reference(&mut surroundings, i, list.row(i), points),
                    None => table.look(&mut surroundings, i, list.row(i), &points, |x| x),
                }
                if let Some((_, row)) = rows.as_mut().and_then(|rows| rows.next_if(|(own, _)| *own == i)) {
                    let other_bodies = row.iter().filter(|&&j| touching.body.at(j as usize) != p.body[i]);
                    let initially = |x| if reference.is_some() { turned_back(x, &p.deformation[i]) } else { x };
                    table.look(&mut surroundings, i, other_bodies, &touching, initially);
                }
                *replacement = surroundings.replacement(table.most_replaced[p.body[i] as usize]);
            }
        });
        *surroundings_known = !self.model.thermal.mechanics;
        let meets_in_turn = reference.is_some() && foreign.is_some();
        if meets_in_turn {
            replacements_now.resize(p.len(), SymmetricTensor::zero());
            let turns = replacements_now.par_iter_mut().zip(&*replacements).zip(&p.deformation);
            turns.with_min_len(BLOCK).for_each(|((now, initial), f)| *now = turned(*initial, f));
        }
        let (now, replacements) = (if meets_in_turn { &**replacements_now } else { &**replacements }, &**replacements);
        let mut exchanged = ExchangedSets::new();
        exchanged.push(replacements_of(&self.ghosts, replacements, replacements_near));
        if foreign.is_some() {
            exchanged.push(replacements_of(contact, now, replacements_far));
        }
        halo::fill(exchanged);
        let of_list = Replacements(WithGhosts::new(replacements, replacements_near));
        let of_contact = Replacements(WithGhosts::new(now, replacements_far));
        let (table, faces, boundaries) = (&*table, &*faces, &self.model.thermal.boundaries);
        let parts = partial.par_chunks_mut(boundaries.len().max(1));
        (rates.par_chunks_mut(BLOCK), limits.par_iter_mut(), parts).into_par_iter().enumerate().for_each(
            |(b, (rate, limit, powers))| {
                *limit = f64::INFINITY;
                powers.fill(0.0);
                let mut rows = foreign.map(|f| f.blocks()[b].rows().peekable());
                for (k, rate) in rate.iter_mut().enumerate() {
                    let i = b * BLOCK + k;
                    let mut sum = Inflow::default();
                    match &reference {
                        Some(points) => table.add_reference(&mut sum, i, list.row(i), points, of_list),
                        None => table.add(&mut sum, i, list.row(i), &points, of_list),
                    }
                    if let Some((_, row)) = rows.as_mut().and_then(|rows| rows.next_if(|(own, _)| *own == i)) {
                        // Surfaces of one body that face each other do not conduct.
                        let other_bodies = row.iter().filter(|&&j| touching.body.at(j as usize) != p.body[i]);
                        table.add(&mut sum, i, other_bodies, &touching, of_contact);
                    }
                    if *surfaces {
                        for (k, (boundary, total)) in boundaries.iter().zip(powers.iter_mut()).enumerate() {
                            if boundary.claims(p.body[i], p.regions[i]) {
                                let face = (faces.at_unit_density(k, p.id[i]), faces.outline(p.id[i]));
                                let (power, conductance) = table.through_surface(boundary.kind, i, face, &sum, p);
                                sum.power += power;
                                sum.conductance += conductance;
                                *total += power;
                            }
                        }
                    }
                    *rate = sum.power / p.mass[i];
                    let capacity = p.mass[i] * table.specific_heat[p.body[i] as usize];
                    *limit = limit.min(conduction_limit(capacity, sum.conductance));
                }
            },
        );
        heat.close(self.domain.as_deref())?;
        self.particles.heat_rate = rates;
        Ok(())
    }

    /// Applies the heat flow of the step to energy, temperature and balance.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn flow_heat(&mut self) -> Result<(), RunFailure> {
        let model = &*self.model;
        let dt = self.step.dt;
        let Some(heat) = &mut self.heat else { return Ok(()) };
        let Particles { energy, temperature, mass, body, regions, heat_rate, .. } = &mut self.particles;
        let (mass, body, regions, rate) = (&*mass, &*body, &*regions, &*heat_rate);
        let HeatFlow { table, partial, moved, power, supplied, exchanged, clock, .. } = heat;
        let boundaries = &model.thermal.boundaries;
        let parts = partial.par_chunks_mut(boundaries.len().max(1));
        (
            energy.par_chunks_mut(BLOCK),
            temperature.par_chunks_mut(BLOCK),
            rate.par_chunks(BLOCK),
            moved.par_iter_mut(),
            parts,
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(b, (e, t, rate, moved, heats))| {
                *moved = 0.0;
                heats.fill(0.0);
                for k in 0..e.len() {
                    let i = b * BLOCK + k;
                    let cp = table.specific_heat[body[i] as usize];
                    let inflow = dt * rate[k];
                    e[k] += inflow;
                    t[k] += inflow / cp;
                    *moved += mass[i] * inflow.abs();
                    for (boundary, total) in boundaries.iter().zip(heats.iter_mut()) {
                        if let HeatBoundaryKind::HeldTemperature(held) = boundary.kind
                            && boundary.claims(body[i], regions[i])
                        {
                            let supply = cp * (held - t[k]);
                            e[k] += supply;
                            t[k] = held;
                            *total += mass[i] * supply;
                        }
                    }
                }
            });
        let share = self.domain.as_deref();
        add_by_boundary(partial, supplied, share)?;
        for (supplied, power) in supplied.iter_mut().zip(power) {
            *supplied += dt * *power;
        }
        let all = share.map(|share| share.gather_blocks(moved, 1)).transpose()?;
        *exchanged += all.as_ref().unwrap_or(moved).iter().sum::<f64>();
        clock.advance(dt);
        Ok(())
    }

    /// Heats particles by friction, unless the temperature follows from the internal energy.
    pub(super) fn warm_by_friction(&mut self) {
        let model = &*self.model;
        if model.numerics.temperature != TemperatureSource::PlasticWork {
            return;
        }
        let dt = self.step.dt;
        let Particles { temperature, material, friction_heat, .. } = &mut self.particles;
        let columns = temperature.par_iter_mut().with_min_len(BLOCK).zip(&*friction_heat).zip(&*material);
        // Springs of facets give some of it back while the pressure on them falls fast.
        columns.filter(|((_, heat), _)| **heat != 0.0).for_each(|((t, heat), material)| {
            *t += dt * heat / model.materials[*material as usize].specific_heat;
        });
    }
}

impl Persist for HeatFlow {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.clock.persist(name, archive)?;
        persist_column(&mut self.power, &format!("{name}.power"), archive)?;
        persist_column(&mut self.supplied, &format!("{name}.supplied"), archive)?;
        self.exchanged.persist(&format!("{name}.exchanged"), archive)
    }
}
