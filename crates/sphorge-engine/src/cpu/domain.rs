//! The part of the particles of a run on several ranks that this rank has.
//!
//! Particles have one common order, that of the cells, independent of the ranks. Each rank has a contiguous range of
//! whole blocks of this order. Rows of the lists are searched among the positions of all particles and are the same as
//! on one rank, so each particle sums the same numbers in the same order. Sums over blocks are taken in the common
//! order of the blocks. Results therefore do not depend on the number of ranks, to the bit.

use super::common_points::CommonPoints;
use super::relocation::Relocation;
use super::smoothing::least_searched;
use super::{CpuEngine, balance};
use crate::engine::{Engine, Part, TimeStepLimit};
use crate::halo::{Images, Remote};
use crate::lanes::PairScalar;
use crate::model::{Model, Precision};
use crate::neighbors::{BLOCK, DisplacementBound, NeighborList, Reach, range_of};
use crate::particles::{Column, Particles};
use crate::persist::{Archive, ArchiveError, Fixed};
use crate::ranks::{Communicator, Ranks};
use crate::reduction::{FieldSource, Reduction};
use crate::{LimitReason, RunFailure};
use sphorge_physics::Vector;
use std::ops::Deref;
use std::sync::Arc;

/// Distribution of the particles.
#[derive(Clone, Debug)]
pub(super) struct Share {
    pub(super) ranks: Ranks,
    /// Indices in the common order of the first particle of each rank, and the number of particles.
    pub(super) starts: Vec<usize>,
}

/// The share of this rank, and the points it searches.
pub(super) struct Domain {
    pub(super) share: Share,
    points: CommonPoints,
    /// Smoothing lengths of all points, m, if searches of some particles have set them.
    smoothing_length: Vec<f64>,
    /// Load imbalance: the largest work of a rank over the mean of all, in counted pairs of the last step.
    pub(super) imbalance: f64,
    /// Share of the rows of all ranks that read no ghost and are summed before the ghosts have arrived.
    pub(super) inner_share: f64,
}

impl Domain {
    fn new(share: Share, model: &Model) -> Self {
        let points = CommonPoints::new(Images::new(model));
        Self { share, points, smoothing_length: Vec::new(), imbalance: 1.0, inner_share: 0.0 }
    }

    /// Adds up the pairs of all ranks, and sets the load imbalance and the share of inner rows.
    pub(super) fn sum_pairs(&mut self, own: u64, inner_rows: usize) -> Result<u64, RunFailure> {
        let (pairs, rows): (Vec<u64>, Vec<usize>) = self.ranks.gather_one((own, inner_rows))?.into_iter().unzip();
        self.inner_share = rows.iter().sum::<usize>() as f64 / self.count() as f64;
        let work = |(pairs, count): (&u64, usize)| pairs + balance::OF_A_PARTICLE * count as u64;
        let works: Vec<u64> = pairs.iter().zip(self.counts()).map(work).collect();
        self.imbalance = balance::imbalance(&works);
        Ok(pairs.into_iter().sum())
    }

    /// Saves or loads the images of the particles of all ranks.
    pub(super) fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.points.persist(name, archive)
    }

    pub(super) fn bytes(&self) -> usize {
        self.points.bytes() + 8 * self.smoothing_length.capacity()
    }

    /// Positions, m, of the particles of all ranks and their images; sets [`Self::smoothing_lengths`].
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn gather_points(&mut self, particles: &Particles) -> Result<Vec<Vector<f64>>, RunFailure> {
        let mut points = self.gather(&particles.position)?;
        self.points.extend(&mut points, |image, x| image.position(&x));
        if self.smoothing_length.len() != points.len() {
            self.smoothing_length = self.gather(&particles.smoothing_length)?;
            self.points.extend(&mut self.smoothing_length, |_, h| h);
        }
        Ok(points)
    }

    /// Smoothing lengths of these points, m, where they are constant.
    pub(super) fn smoothing_lengths(&self) -> &[f64] {
        &self.smoothing_length
    }

    /// Makes the next search of some particles request them: particles have changed, or their order has.
    pub(super) fn forget_smoothing_lengths(&mut self) {
        self.smoothing_length.clear();
    }

    /// Creates ghosts for the points in the rows, which are indices in the common order, and renumbers them to indices
    /// on this rank.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn adopt(&mut self, list: &mut NeighborList) -> Result<Remote, RunFailure> {
        let named = list.blocks().iter().flat_map(|block| block.entries()).copied();
        let halo = self.points.adopt(&self.share, named)?;
        for block in list.blocks_mut() {
            block.entries_mut().iter_mut().for_each(|j| *j = self.points.number(*j));
        }
        Ok(halo)
    }

    /// The points that are searched.
    pub(super) fn points(&self) -> &CommonPoints {
        &self.points
    }

    /// The common point of a particle or ghost of this rank, by its index.
    pub(super) fn point(&self, number: u32) -> u32 {
        self.points.point(self.own(), number)
    }

    /// Index on this rank of a point that is one of its particles or ghosts.
    pub(super) fn number(&self, point: u32) -> u32 {
        self.points.number(point)
    }

    /// Whether a point is a particle or a ghost of this rank.
    pub(super) fn is_here(&self, point: u32) -> bool {
        self.points.is_here(point)
    }

    /// Points that are searched: particles of all ranks and their images.
    pub(super) fn searched(&self) -> usize {
        self.count() + self.points.images()
    }

    /// The particles that the images are of, by their index in the common order.
    pub(super) fn image_sources(&self) -> &[u32] {
        self.points.sources()
    }
}

impl Deref for Domain {
    type Target = Share;
    fn deref(&self) -> &Share {
        &self.share
    }
}

impl Share {
    /// Indices of this rank's particles in the common order.
    pub(super) fn own(&self) -> std::ops::Range<usize> {
        let rank = self.ranks.rank();
        self.starts[rank]..self.starts[rank + 1]
    }

    /// Particles of all ranks.
    pub(super) fn count(&self) -> usize {
        self.starts[self.ranks.size()]
    }

    fn counts(&self) -> Vec<usize> {
        self.starts.windows(2).map(|ends| ends[1] - ends[0]).collect()
    }

    /// A column of the particles of all ranks, in the common order.
    pub(super) fn gather<V: Fixed + Copy>(&self, own: &[V]) -> Result<Vec<V>, RunFailure> {
        self.ranks.gather(own, &self.counts())
    }

    /// `width` values of each block of all ranks, in the common order.
    pub(super) fn gather_blocks<V: Fixed + Copy>(&self, own: &[V], width: usize) -> Result<Vec<V>, RunFailure> {
        let counts: Vec<usize> = self.counts().iter().map(|count| width * count.div_ceil(BLOCK)).collect();
        self.ranks.gather(own, &counts)
    }

    /// Whether a condition holds on any rank.
    pub(super) fn any(&self, own: bool) -> Result<bool, RunFailure> {
        Ok(self.ranks.gather_one(own)?.contains(&true))
    }

    /// The minimum of the first and the maximum of the second of two numbers over all ranks.
    pub(super) fn range(&self, own: (f64, f64)) -> Result<(f64, f64), RunFailure> {
        Ok(self.ranks.gather_one(own)?.into_iter().fold(own, |a, b| (a.0.min(b.0), a.1.max(b.1))))
    }

    /// The maximum of a number over all ranks.
    pub(super) fn largest(&self, own: f64) -> Result<f64, RunFailure> {
        Ok(self.ranks.gather_one(own)?.into_iter().fold(own, f64::max))
    }

    /// The bounding box of those of all ranks.
    pub(super) fn bounds(&self, low: Vector<f64>, high: Vector<f64>) -> Result<(Vector<f64>, Vector<f64>), RunFailure> {
        let wider = |a: (Vector<f64>, Vector<f64>), b: (Vector<f64>, Vector<f64>)| {
            ([0, 1, 2].map(|k| a.0[k].min(b.0[k])), [0, 1, 2].map(|k| a.1[k].max(b.1[k])))
        };
        Ok(self.ranks.gather_one((low, high))?.into_iter().fold((low, high), wider))
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Sorts the particles of all ranks into their common order, that of the cells tile by tile. Each rank receives the
    /// particles of its blocks with all their columns, and other blocks if the load imbalance has grown.
    pub(super) fn sort_among_ranks(&mut self, cell: f64) -> Result<(), RunFailure> {
        let Some(share) = self.domain.as_ref().map(|domain| domain.share.clone()) else { return Ok(()) };
        let positions = share.gather(&self.particles.position)?;
        let order = self.lists.searcher.tiled_order(&positions, cell).to_vec();
        let pairs = share.gather(&self.particles.neighbors)?;
        // Before the first step no pairs are counted, and the shares are those of the start.
        let are_counted = pairs.iter().any(|&pairs| pairs > 0);
        let pairs: Vec<u32> = order.iter().map(|&place| pairs[place as usize]).collect();
        let starts = if are_counted { share.rebalanced(&pairs) } else { None };
        let Some(starts) = starts else { return self.relocate(&share, &share.starts, &order) };
        let taken = self.take_block_sums(&share)?;
        self.relocate(&share, &starts, &order)?;
        let share = Share { starts, ..share };
        self.keep_block_sums(&share, taken);
        self.domain.iter_mut().for_each(|domain| domain.share = share.clone());
        Ok(())
    }

    fn relocate(&mut self, share: &Share, starts: &[usize], order: &[u32]) -> Result<(), RunFailure> {
        Relocation::new(share.ranks.clone(), (&share.starts, starts), order).apply(&mut self.particles)
    }

    /// Searches the neighbours of this rank's particles among those of all ranks and images of these, which are created
    /// up to `ghost_reach` (m). The neighbours found become the ghosts of this rank.
    pub(super) fn search_among_ranks(&mut self, factor: f64, ghost_reach: f64) -> Result<(), RunFailure> {
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let searched = super::search::searched_positions(&self.particles, self.formulation.is_initial());
        let points = domain.gather(searched)?;
        let mut own_lengths = self.particles.smoothing_length.clone();
        if let Some(least) = least_searched(&self.model, self.contacts.as_ref()) {
            let raise = |(h, body): (&mut f64, &u32)| *h = h.max(least[*body as usize]);
            own_lengths.iter_mut().zip(&self.particles.body).for_each(raise);
        }
        let smoothing_length = domain.gather(&own_lengths)?;
        if domain.points.reflect(&points, ghost_reach) {
            self.lists.searcher.forget();
        }
        let (range, displacement) = (self.lists.smoothing_lengths, self.lists.displacement);
        self.search_common((points, smoothing_length), (factor, range), displacement)
    }

    /// Builds the rows of this rank and its ghosts from the positions (m) and smoothing lengths (m) of the particles of
    /// all ranks; `reach` is that of a kernel in smoothing lengths, with the range of these.
    pub(super) fn search_common(
        &mut self,
        (mut points, mut smoothing_length): (Vec<Vector<f64>>, Vec<f64>),
        (factor, range): (f64, (f64, f64)),
        displacement: DisplacementBound,
    ) -> Result<(), RunFailure> {
        let Some(domain) = &mut self.domain else { return Ok(()) };
        let lists = &mut self.lists;
        domain.points.extend(&mut points, |image, x| image.position(&x));
        domain.points.extend(&mut smoothing_length, |_, h| h);
        let reach = Reach { smoothing_length: &smoothing_length, factor, range };
        lists.searcher.search_rows(&points, domain.own(), &reach, displacement, self.instructions, &mut lists.list);
        self.ghosts.halo = Box::new(domain.adopt(&mut lists.list)?);
        domain.forget_smoothing_lengths();
        Ok(())
    }

    /// The limit of all ranks from the limits of each.
    pub(super) fn agree_on_limit(&self, own: TimeStepLimit) -> Result<TimeStepLimit, RunFailure> {
        let Some(domain) = &self.domain else { return Ok(own) };
        let limits = domain.ranks.gather_one((own.dt, own.reason))?.into_iter();
        // Of equal limits, that of the first rule, as on one rank.
        let smaller = |a: (f64, LimitReason), b: (f64, LimitReason)| {
            if b.0 < a.0 || b.0 == a.0 && (b.1 as u8) < a.1 as u8 { b } else { a }
        };
        let (dt, reason) = limits.fold((own.dt, own.reason), smaller);
        Ok(TimeStepLimit { dt, reason })
    }
}

impl<T: PairScalar> Part for CpuEngine<T> {
    fn collect(&self, field: &str) -> Result<Column<'static>, RunFailure> {
        let column = self.field(field)?;
        let Some(domain) = &self.domain else { return Ok(column.into_owned()) };
        domain.ranks.collect(column, &domain.counts())
    }

    fn section_force(&self, section: usize) -> Result<Vec<f64>, RunFailure> {
        let section = self.model.sections.get(section);
        section.map_or(Ok(Vec::new()), |section| self.reduce(&Reduction::SectionForce(section)))
    }

    fn complete(&mut self) -> Result<(), RunFailure> {
        self.complete_state()
    }

    fn total(&self) -> usize {
        self.domain.as_ref().map_or(self.particles.len(), |domain| domain.count())
    }

    fn own(&self) -> &dyn FieldSource {
        &self.particles
    }
}

/// Starts this rank's part of a run on the CPU.
pub(super) fn start_part(
    model: Arc<Model>,
    particles: Particles,
    communicator: Arc<dyn Communicator>,
) -> Result<Box<dyn Part>, RunFailure> {
    let share = balance::share_at_start(Ranks::new(communicator), &model, &particles)?;
    let domain = Domain::new(share, &model);
    Ok(match model.numerics.precision {
        Precision::Mixed => Box::new(part::<f32>(model, particles, domain)?),
        Precision::Double => Box::new(part::<f64>(model, particles, domain)?),
    })
}

fn part<T: PairScalar>(
    model: Arc<Model>,
    mut particles: Particles,
    domain: Domain,
) -> Result<CpuEngine<T>, RunFailure> {
    let smoothing_lengths = range_of(&particles.smoothing_length);
    particles.keep(domain.own());
    let halo = Box::new(Remote::new(domain.ranks.clone(), domain.starts.clone(), Images::new(&model)));
    CpuEngine::new(model, particles, halo, Some(domain), smoothing_lengths)
}
