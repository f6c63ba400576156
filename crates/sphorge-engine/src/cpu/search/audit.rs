//! Audit of the neighbour lists: a comparison with an exact full search.

use super::super::CpuEngine;
use super::super::common_points::CommonPoints;
use super::super::contact_search::Reaches;
use super::super::domain::Domain;
use super::super::ghosts::{Ghosts, WithGhosts};
use super::super::stored::StoredBlock;
use crate::halo::{FieldSet, Halo, Image, Images};
use crate::lanes::PairScalar;
use crate::neighbors::{BLOCK, Block, DisplacementBound, NeighborList, Reach, Searcher, brute_force_rows};
use crate::particles::Particles;
use crate::{Audit, RunFailure};
use rayon::prelude::*;
use sphorge_physics::audit::{AuditPair, AuditSums};
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::{SymmetricTensor, Vector, tensor::dot};
use std::borrow::Cow;
use std::collections::HashMap;
use std::ops::Range;

/// Up to this many points every pair is tested; beyond, a separate cell search finds the pairs.
const EVERY_PAIR_UP_TO: usize = 2000;

/// Sums and counts of one particle.
#[derive(Clone, Copy, Debug)]
pub struct AuditedRow {
    /// Rate of the density, and acceleration by the stress only.
    pub sums: AuditSums<f64>,
    /// Acceleration by particles, not ghosts, m/s^2.
    pub internal: Vector<f64>,
    /// Pairs within the kernel support, in an exact row.
    pub pairs: u64,
    /// Those that are missing from the list, and those of them with another body.
    pub missed: u64,
    /// See above.
    pub missed_foreign: u64,
    /// Pairs beyond the support, in a row of the list.
    pub stale: u64,
}

impl Default for AuditedRow {
    fn default() -> Self {
        Self { sums: AuditSums::zero(), internal: [0.0; 3], pairs: 0, missed: 0, missed_foreign: 0, stale: 0 }
    }
}

/// Sums over the rows of all particles, each from the list and exact, with their masses (kg).
pub fn audit_of(rows: &[(AuditedRow, AuditedRow)], mass: &[f64]) -> Audit {
    let mut totals = Totals::default();
    totals.add_all(rows, mass);
    totals.audit(counts_of(rows))
}

/// Pairs, missed pairs, missed pairs with another body, and stale pairs.
fn counts_of(rows: &[(AuditedRow, AuditedRow)]) -> [u64; 4] {
    let mut counts = [0u64; 4];
    for (ours, theirs) in rows {
        let own = [theirs.pairs, theirs.missed, theirs.missed_foreign, ours.stale];
        counts.iter_mut().zip(own).for_each(|(count, own)| *count += own);
    }
    counts
}

/// Sums over all particles.
#[derive(Clone, Copy, Default)]
struct Totals {
    divergence_error: f64,
    divergence: f64,
    force_error: f64,
    force: f64,
    scale: f64,
    momentum: Vector<f64>,
}

impl Totals {
    fn add_all(&mut self, rows: &[(AuditedRow, AuditedRow)], mass: &[f64]) {
        rows.iter().zip(mass).for_each(|((ours, theirs), &mass)| self.add(mass, ours, theirs));
    }

    fn add(&mut self, mass: f64, ours: &AuditedRow, theirs: &AuditedRow) {
        self.divergence_error += (ours.sums.divergence - theirs.sums.divergence).powi(2);
        self.divergence += theirs.sums.divergence.powi(2);
        let (own, exact) = (ours.sums.acceleration, theirs.sums.acceleration);
        let difference = [0, 1, 2].map(|a| mass * (own[a] - exact[a]));
        self.force_error += dot(difference, difference);
        self.force += mass * mass * dot(exact, exact);
        self.scale += mass * dot(ours.internal, ours.internal).sqrt();
        for a in 0..3 {
            self.momentum[a] += mass * ours.internal[a];
        }
    }

    fn to_array(self) -> [f64; 8] {
        let [x, y, z] = self.momentum;
        [self.divergence_error, self.divergence, self.force_error, self.force, self.scale, x, y, z]
    }

    fn from_array([divergence_error, divergence, force_error, force, scale, x, y, z]: [f64; 8]) -> Self {
        Self { divergence_error, divergence, force_error, force, scale, momentum: [x, y, z] }
    }

    fn audit(&self, [pairs, missed_pairs, missed_foreign_pairs, stale_pairs]: [u64; 4]) -> Audit {
        let ratio = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        Audit {
            pairs,
            missed_pairs,
            missed_foreign_pairs,
            stale_pairs,
            density_rate_error: ratio(self.divergence_error, self.divergence).sqrt(),
            force_error: ratio(self.force_error, self.force).sqrt(),
            momentum_residual: ratio(dot(self.momentum, self.momentum).sqrt(), self.scale),
        }
    }
}

/// The points of all ranks by their index in the common order, followed by images, and the columns of those that are in
/// rows. Images are those of the lists, with their indices, followed by those that are near now.
struct Sight<'a> {
    points: &'a [Vector<f64>],
    reach: Reach<'a>,
    /// Particles of all ranks.
    count: usize,
    /// Index of the first particle of this rank.
    first: usize,
    ghosts: &'a Particles,
    /// Which ghosts these are, if there are other ranks.
    common: Option<&'a CommonPoints>,
    /// The points of the images of the contact, if it has its own images; none for those that are far away now.
    of_contact: Option<Vec<Option<u32>>>,
    /// How far facets are from their particles.
    reaches: Reaches<'a>,
}

impl Sight<'_> {
    /// Whether a particle and a ghost of different bodies that are this far apart, m, meet if they are on a list: at facets only
    /// where these are near enough to touch; what has come apart has none.
    fn can_meet(&self, i: usize, j: usize, apart: f64) -> bool {
        if self.reaches.is_apart(i) || self.reaches.is_apart(j) {
            return true;
        }
        let of_both = self.reaches.of(i).zip(self.reaches.of(j));
        of_both.is_none_or(|(own, other)| own > 0.0 && other > 0.0 && apart < own + other)
    }

    /// Index of a point in columns of particles and ghosts.
    fn number(&self, point: u32) -> usize {
        self.common.map_or(point, |common| common.number(point)) as usize
    }

    /// The point that has this index in the contact.
    fn met(&self, number: u32) -> Option<u32> {
        let image = (number as usize).checked_sub(self.count);
        match (&self.of_contact, image) {
            (Some(of_contact), Some(image)) => of_contact[image],
            _ => Some(number),
        }
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Compares the lists, at the current positions, with an exact search: pairs within the kernel support that are
    /// missing, pairs beyond it, and the effect of both on density rate and force.
    ///
    /// # Errors
    /// A rank is lost.
    pub(in super::super) fn audit_lists(&mut self) -> Result<Audit, RunFailure> {
        let (mut points, mut smoothing_length) = match &self.domain {
            None => (self.particles.position.clone(), self.particles.smoothing_length.clone()),
            Some(domain) => {
                (domain.gather(&self.particles.position)?, domain.gather(&self.particles.smoothing_length)?)
            }
        };
        let count = points.len();
        let mut common = self.points_of_now(&points, &smoothing_length);
        common.extend(&mut points, |image, x| image.position(&x));
        common.extend(&mut smoothing_length, |_, h| h);
        let own = self.domain.as_ref().map_or(0..self.particles.len(), |domain| domain.own());
        let exact = self.exact_rows(&points, own.clone(), &smoothing_length);
        let ours = |i: usize| -> Cow<'_, [u32]> {
            let row = self.lists.list.row(i);
            let of_all = |domain: &Domain| row.iter().map(|&j| domain.point(j)).collect();
            self.domain.as_ref().map_or(Cow::Borrowed(row), |domain| Cow::Owned(of_all(domain)))
        };
        let halo: Box<dyn Halo> = match &self.domain {
            None => Box::new(common.all_images().clone()),
            Some(domain) => {
                let named = exact.blocks().iter().flat_map(Block::entries).copied();
                Box::new(common.adopt(domain, named.chain((0..own.len()).flat_map(|i| ours(i).into_owned())))?)
            }
        };
        let mut ghosts = Ghosts::new(halo);
        ghosts.exchange(&[FieldSet::Search, FieldSet::Audit, FieldSet::Contact], &self.particles);
        self.domain.as_ref().map_or(Ok(()), |domain| domain.ranks.check_lost())?;
        let sight = Sight {
            points: &points,
            reach: Reach::new(&smoothing_length, self.model.numerics.kernel.support()),
            count,
            first: own.start,
            ghosts: &ghosts.columns,
            common: self.domain.as_ref().map(|_| &common),
            of_contact: self.images_of_contact(&common, count),
            reaches: Reaches::new(
                self.contacts.as_ref().and_then(|contacts| contacts.facets.as_ref()),
                &self.particles,
                &ghosts.columns,
                &self.has_come_apart,
            ),
        };
        let rows: Vec<(AuditedRow, AuditedRow)> = (0..own.len())
            .into_par_iter()
            .map(|i| {
                let (ours, theirs) = (ours(i), exact.row(i));
                (self.audit_row(i, &sight, &ours, true, theirs), self.audit_row(i, &sight, theirs, false, &ours))
            })
            .collect();
        self.sum_audit(&rows)
    }

    /// The points in the lists, with the same indices, and all images that are near at these positions (m) of the
    /// particles of all ranks. Images of the lists may be those of an earlier configuration.
    fn points_of_now(&self, positions: &[Vector<f64>], smoothing_length: &[f64]) -> CommonPoints {
        let reach = self.model.numerics.kernel.support() * smoothing_length.iter().copied().fold(0.0, f64::max);
        match &self.domain {
            None => CommonPoints::new(Images::new(&self.model).with(self.ghosts.halo.images())),
            Some(domain) => domain.points().clone(),
        }
        .supplemented(positions, reach)
    }

    /// For each image of the contact, if it has its own, the corresponding one of these points, which are `count`
    /// particles and their images.
    fn images_of_contact(&self, common: &CommonPoints, count: usize) -> Option<Vec<Option<u32>>> {
        let images = self.contacts.as_ref()?.images(self.domain.as_ref())?;
        let all = common.all_images().images().iter();
        let points: HashMap<_, u32> = all.map(Image::identity).zip(count as u32..).collect();
        Some(images.iter().map(|image| points.get(&image.identity()).copied()).collect())
    }

    /// Rows of some of the points, with all their neighbours.
    fn exact_rows(&self, points: &[Vector<f64>], rows: Range<usize>, smoothing_length: &[f64]) -> NeighborList {
        let reach = Reach::new(smoothing_length, self.model.numerics.kernel.support());
        if points.len() <= EVERY_PAIR_UP_TO {
            return brute_force_rows(points, rows, &reach);
        }
        let mut exact = NeighborList::default();
        // Slightly more than the support: the distance decides later.
        let reach = Reach { factor: reach.factor * (1.0 + 1e-5), ..reach };
        let nowhere = DisplacementBound::default();
        Searcher::default().search_rows(points, rows, &reach, nowhere, self.instructions, &mut exact);
        exact
    }

    /// The result of all ranks from the rows of their particles.
    fn sum_audit(&self, rows: &[(AuditedRow, AuditedRow)]) -> Result<Audit, RunFailure> {
        let mass = &self.particles.mass;
        let Some(domain) = &self.domain else { return Ok(audit_of(rows, mass)) };
        let mut totals = [Totals::default().to_array()];
        domain.ranks.sum_in_turn(&mut totals, |totals: &mut [[f64; 8]]| {
            let mut of_all = Totals::from_array(totals[0]);
            of_all.add_all(rows, mass);
            totals[0] = of_all.to_array();
        })?;
        let of_ranks = domain.ranks.gather_one(counts_of(rows))?;
        let counts = [0, 1, 2, 3].map(|k| of_ranks.iter().map(|counts| counts[k]).sum());
        Ok(Totals::from_array(totals[0]).audit(counts))
    }

    /// Sums of particle `i` of this rank over a row of points; pairs that are not `known` are missed. With `kept`,
    /// distances are those of the last search if the strategy stores them.
    fn audit_row(&self, i: usize, sight: &Sight<'_>, row: &[u32], kept: bool, known: &[u32]) -> AuditedRow {
        let (particles, points, reach) = (&self.particles, sight.points, &sight.reach);
        let lists = &self.lists;
        let kernel = self.model.numerics.kernel;
        let dimension = super::super::dimension(&self.model);
        let (b, k) = (i / BLOCK, i % BLOCK);
        let stored: Option<&StoredBlock<T>> = lists.stored.as_ref().filter(|_| kept).map(|s| s.block(b));
        let ghosts = sight.ghosts;
        let (deviators, pressures) = (
            WithGhosts::new(&particles.deviator, &ghosts.deviator),
            WithGhosts::new(&particles.pressure, &ghosts.pressure),
        );
        let masses = WithGhosts::new(&particles.mass, &ghosts.mass);
        let densities = WithGhosts::new(&particles.density, &ghosts.density);
        let velocities = WithGhosts::new(&particles.velocity, &ghosts.velocity);
        let bodies = WithGhosts::new(&particles.body, &ghosts.body);
        let stress = |j: usize| deviators.at(j) - SymmetricTensor::isotropic(pressures.at(j));
        let mut audited = AuditedRow::default();
        let place = sight.first + i;
        for (n, &point) in row.iter().enumerate() {
            let other = point as usize;
            let now = [0, 1, 2].map(|a| points[place][a] - points[other][a]);
            let h = pair_smoothing_length(reach.smoothing_length[place], reach.smoothing_length[other]);
            let apart = dot(now, now).sqrt();
            let inside = apart < kernel.support() * h;
            audited.stale += u64::from(kept && !inside);
            let j = sight.number(point);
            if !kept {
                if !inside {
                    continue;
                }
                audited.pairs += 1;
                let in_contact = || {
                    let mut met = self.contacts.iter().flat_map(|c| c.met_by(i, self.domain.as_ref()));
                    met.any(|j| sight.met(j) == Some(point))
                };
                let is_foreign = bodies.at(i) != bodies.at(j);
                let can_meet = || !is_foreign || sight.can_meet(i, j, apart);
                if !known.contains(&point) && !in_contact() && can_meet() {
                    audited.missed += 1;
                    audited.missed_foreign += u64::from(is_foreign);
                }
            }
            let x = stored.map_or(now, |s| s.distance(lists.list.blocks()[b].start(k) + n));
            let f = -kernel.slope(dimension, dot(x, x).sqrt(), h);
            let volume = masses.at(j) / densities.at(j);
            let (v_i, v_j) = (velocities.at(i), velocities.at(j));
            let pair = AuditPair {
                x,
                v: [0, 1, 2].map(|a| v_j[a] - v_i[a]),
                f,
                volume,
                density: particles.density[i],
                stress: stress(i) + stress(j),
            };
            let acceleration = audited.sums.add(&pair);
            if other < sight.count {
                (0..3).for_each(|a| audited.internal[a] += acceleration[a]);
            }
        }
        audited
    }
}
