//! Work balance between ranks: shares with different numbers of particles and equal work.
//!
//! Work is counted, not timed, so that a run has the same shares whenever it is repeated. The work of a particle is the
//! number of its pairs plus a constant for everything else that a step does with it. Shares are whole blocks. They are
//! chosen at the start from the pairs that a search finds, and again at each sorting if the load imbalance has grown.

use super::CpuEngine;
use super::domain::Share;
use super::numerical_work::NumericalWork;
use crate::RunFailure;
use crate::lanes::{Instructions, PairScalar};
use crate::model::Model;
use crate::neighbors::{BLOCK, DisplacementBound, NeighborList, Reach, Searcher, range_of};
use crate::particles::Particles;
use crate::ranks::Ranks;
use crate::report::WallLedger;
use sphorge_physics::Vector;

/// Work of a particle apart from its pairs, in pairs. Stress and integration of `copper-bar` at 0.635 mm take 0.76 s on
/// one thread, sums over 33 pairs of each of its particles 0.85 s.
pub(super) const OF_A_PARTICLE: u64 = 30;

/// Load imbalance above which shares are chosen again: the largest work of a rank over the mean of all.
const BOUND: f64 = 1.1;

/// Work of each block, given the number of pairs of each particle.
fn works(pairs: &[u32]) -> Vec<u64> {
    let of_block = |pairs: &[u32]| pairs.iter().map(|&n| u64::from(n) + OF_A_PARTICLE).sum();
    pairs.chunks(BLOCK).map(of_block).collect()
}

/// First blocks of the shares of each rank, and the number of blocks, so that the work is as equal as whole blocks
/// allow. Each rank has at least one block.
fn shares(works: &[u64], size: usize) -> Vec<usize> {
    let blocks = works.len();
    let mut before = vec![0u64];
    before.extend(works.iter().scan(0, |sum, work| {
        *sum += work;
        Some(*sum)
    }));
    let all = before[blocks];
    let mut starts = vec![0];
    for rank in 1..size {
        // In whole numbers: `all rank / size`.
        let wanted = (u128::from(all) * rank as u128 / size as u128) as u64;
        let after = before.partition_point(|&sum| sum < wanted).min(blocks);
        let nearer = if after > 0 && wanted - before[after - 1] < before[after] - wanted { after - 1 } else { after };
        starts.push(nearer.clamp(starts[rank - 1] + 1, blocks - (size - rank)));
    }
    starts.push(blocks);
    starts
}

/// Indices of the first particles of each rank, and the number of particles, from those of blocks.
fn places(blocks: &[usize], count: usize) -> Vec<usize> {
    blocks.iter().map(|block| (block * BLOCK).min(count)).collect()
}

/// The largest work over the mean.
pub(super) fn imbalance(works: &[u64]) -> f64 {
    let (most, all) = (works.iter().max().copied().unwrap_or(0), works.iter().sum::<u64>());
    if all == 0 { 1.0 } else { most as f64 * works.len() as f64 / all as f64 }
}

/// Work of each rank, given the indices of their first particles.
fn of_ranks(works: &[u64], starts: &[usize]) -> Vec<u64> {
    starts.windows(2).map(|ends| works[ends[0] / BLOCK..ends[1].div_ceil(BLOCK)].iter().sum()).collect()
}

/// The share of each rank at the start. All ranks have all particles then; their pairs are searched.
///
/// # Errors
/// A rank is lost, or there are fewer blocks than ranks.
pub(super) fn share_at_start(ranks: Ranks, model: &Model, particles: &Particles) -> Result<Share, RunFailure> {
    let (size, count) = (ranks.size(), particles.len());
    let blocks = count.div_ceil(BLOCK);
    if blocks < size {
        return Err(RunFailure::of_engine(format!(
            "{count} particles are too few for {size} ranks: each needs a block of {BLOCK}; use `--ranks {}`",
            blocks.max(1)
        )));
    }
    let even: Vec<usize> = (0..=size).map(|rank| rank * blocks / size).collect();
    let share = Share { ranks, starts: places(&even, count) };
    if size == 1 {
        return Ok(share);
    }
    let (mut searcher, mut list) = (Searcher::default(), NeighborList::default());
    let factor = model.numerics.kernel.support();
    let range = range_of(&particles.smoothing_length);
    let order = searcher.tiled_order(&particles.position, factor * range.1).to_vec();
    let points: Vec<Vector<f64>> = order.iter().map(|&i| particles.position[i as usize]).collect();
    let smoothing_length: Vec<f64> = order.iter().map(|&i| particles.smoothing_length[i as usize]).collect();
    let reach = Reach { smoothing_length: &smoothing_length, factor, range };
    let nowhere = DisplacementBound::default();
    searcher.search_rows(&points, share.own(), &reach, nowhere, Instructions::best(), &mut list);
    let pairs: Vec<u32> = (0..share.own().len()).map(|i| list.row(i).len() as u32).collect();
    let works = works(&share.gather(&pairs)?);
    Ok(Share { starts: places(&shares(&works, size), count), ..share })
}

impl Share {
    /// New indices of the first particles of each rank, given the number of pairs of each particle in the new common
    /// order. They change only if the load imbalance has grown and whole blocks allow a better one.
    pub(super) fn rebalanced(&self, pairs: &[u32]) -> Option<Vec<usize>> {
        let works = works(pairs);
        let starts = places(&shares(&works, self.ranks.size()), pairs.len());
        let now = imbalance(&of_ranks(&works, &self.starts));
        (now > BOUND && imbalance(&of_ranks(&works, &starts)) < now).then_some(starts)
    }
}

/// Sums that each rank keeps for its blocks, from all ranks, while blocks change their rank.
pub(super) struct BlockSums {
    wall_powers: Vec<WallLedger>,
    columns: Vec<Vec<f64>>,
}

impl<T: PairScalar> CpuEngine<T> {
    /// The sums per block that outlive a step, besides the powers of walls.
    fn block_sums(&mut self) -> [&mut Vec<f64>; 7] {
        let NumericalWork { hourglass, viscous, artificial_stress } = &mut self.numerical_work;
        [
            &mut self.walls.at_faces,
            &mut hourglass.power,
            &mut hourglass.work,
            &mut viscous.power,
            &mut viscous.work,
            &mut artificial_stress.power,
            &mut artificial_stress.work,
        ]
    }

    /// Number of wall powers of a block.
    fn walls_of_a_block(&self) -> usize {
        self.model.walls.len().max(1)
    }

    /// Gathers the sums of the blocks of all ranks before blocks change their rank.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn take_block_sums(&mut self, share: &Share) -> Result<BlockSums, RunFailure> {
        let wall_powers = share.gather_blocks(&self.walls.powers, self.walls_of_a_block())?;
        let columns = self.block_sums().into_iter().map(|column| share.gather_blocks(column, 1));
        Ok(BlockSums { wall_powers, columns: columns.collect::<Result<_, _>>()? })
    }

    /// Keeps those of the blocks that this rank has now, and allocates memory for the sums of a step.
    pub(super) fn keep_block_sums(&mut self, share: &Share, taken: BlockSums) {
        let own = share.own();
        let blocks = own.start / BLOCK..own.end.div_ceil(BLOCK);
        let walls = self.walls_of_a_block();
        self.walls.powers = taken.wall_powers[walls * blocks.start..walls * blocks.end].to_vec();
        for (column, taken) in self.block_sums().into_iter().zip(taken.columns) {
            *column = taken[blocks.clone()].to_vec();
        }
        let count = own.len();
        self.walls.limits.resize(blocks.len(), f64::INFINITY);
        self.external.resize(count);
        if let Some(contacts) = &mut self.contacts {
            contacts.resize(count);
        }
        if let Some(heat) = &mut self.heat {
            heat.resize(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn works_are_shared_as_evenly_as_whole_blocks_allow() {
        // Eight blocks of one, two of four: sixteen for two, three and five ranks.
        let works = [4, 1, 1, 1, 1, 1, 1, 1, 1, 4];
        assert_eq!(shares(&works, 2), [0, 5, 10]);
        assert_eq!(shares(&works, 4), [0, 1, 5, 9, 10]);
        assert_eq!(shares(&works, 10), (0..=10).collect::<Vec<_>>());
        assert_eq!(shares(&works, 1), [0, 10]);
        // The first one has the work of all, and each other one a block.
        assert_eq!(shares(&[1000, 1, 1, 1], 4), [0, 1, 2, 3, 4]);
        assert_eq!(shares(&[1, 1, 1, 1000], 3), [0, 2, 3, 4]);
        assert_eq!(shares(&[0, 0, 0], 2), [0, 1, 3]);
    }

    #[test]
    fn imbalance_is_the_most_over_the_mean() {
        assert_eq!([imbalance(&[3, 1, 2]), imbalance(&[5, 5]), imbalance(&[0, 0])], [1.5, 1.0, 1.0]);
        assert_eq!(of_ranks(&[4, 1, 1, 7], &[0, BLOCK, 3 * BLOCK, 3 * BLOCK + 5]), [4, 2, 7]);
    }

    #[test]
    fn a_particle_costs_its_pairs_and_what_is_done_with_it_alone() {
        let mut pairs = vec![10; BLOCK];
        pairs.extend([1, 0]);
        assert_eq!(works(&pairs), [BLOCK as u64 * (10 + OF_A_PARTICLE), 1 + 2 * OF_A_PARTICLE]);
    }
}
