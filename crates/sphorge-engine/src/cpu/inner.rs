//! Inner rows, which read no ghost: whole blocks of them are summed while messages are in flight.

use crate::neighbors::{Block, NeighborList};
use rayon::prelude::*;

/// Which rows a stage processes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rows {
    /// All of them.
    All,
    /// A part of the inner rows, before the ghosts have arrived.
    Inner(usize),
    /// The others.
    Rest,
}

impl Rows {
    /// Whether it is the first of a stage.
    pub(super) fn is_first(self) -> bool {
        matches!(self, Self::All | Self::Inner(0))
    }

    /// Whether it is the last one, after the ghosts have arrived.
    pub(super) fn is_last(self) -> bool {
        matches!(self, Self::All | Self::Rest)
    }
}

/// Largest number of parts; between them messages make progress.
const MOST_PARTS: usize = 4;
/// Smallest number of blocks per thread in a part, so that threads finish together.
const BLOCKS_OF_THREAD: usize = 4;

/// The blocks of a list whose rows contain only particles of this rank.
#[derive(Debug, Default)]
pub(super) struct InnerBlocks {
    /// Part of each block; none if it reads a ghost.
    part: Vec<Option<usize>>,
    parts: usize,
    /// Rows of all of them.
    rows: usize,
    /// Number of particles and state of the list for which this was determined.
    of: Option<(usize, u64)>,
}

impl InnerBlocks {
    /// Determines them again if the list has changed.
    pub(super) fn refresh(&mut self, list: &NeighborList, particles: usize) {
        let now = Some((particles, list.changes()));
        if self.of == now {
            return;
        }
        self.of = now;
        let is_inner = |block: &Block| block.entries().iter().all(|&j| (j as usize) < particles).then_some(0);
        self.part.clear();
        self.part.par_extend(list.blocks().par_iter().map(is_inner));
        let count = self.part.iter().flatten().count();
        let at_once = BLOCKS_OF_THREAD * rayon::current_num_threads();
        self.parts = if count == 0 { 0 } else { (count / at_once).clamp(1, MOST_PARTS) };
        for (k, part) in self.part.iter_mut().flatten().enumerate() {
            *part = k * self.parts / count;
        }
        let inner = list.blocks().iter().zip(&self.part).filter(|(_, part)| part.is_some());
        self.rows = inner.map(|(block, _)| block.len()).sum();
    }

    /// Number of parts.
    pub(super) fn parts(&self) -> usize {
        self.parts
    }

    /// Number of rows in them.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Whether those of block `b` are among `rows`.
    pub(super) fn is_summed_in(&self, b: usize, rows: Rows) -> bool {
        match rows {
            Rows::All => true,
            Rows::Inner(part) => self.part[b] == Some(part),
            Rows::Rest => self.part[b].is_none(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Option<usize>>() * self.part.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbors::BLOCK;

    /// A list of two blocks whose particle `i` has one neighbour, `of(i)`.
    fn list(of: impl Fn(usize) -> u32) -> NeighborList {
        let mut list = NeighborList::default();
        list.resize(BLOCK + 2);
        for (b, block) in list.blocks_mut().iter_mut().enumerate() {
            block.clear();
            for i in b * BLOCK..(BLOCK + 2).min((b + 1) * BLOCK) {
                block.push(of(i));
                block.end_row(i as u32);
            }
        }
        list
    }

    #[test]
    fn blocks_that_name_a_ghost_wait_for_it() {
        let particles = BLOCK + 2;
        let mut inner = InnerBlocks::default();
        let mut names_ghost = list(|i| if i == BLOCK + 1 { particles as u32 } else { 0 });
        inner.refresh(&names_ghost, particles);
        let turns = |inner: &InnerBlocks, rows| [0, 1].map(|b| inner.is_summed_in(b, rows));
        assert_eq!(turns(&inner, Rows::Inner(0)), [true, false]);
        assert_eq!(turns(&inner, Rows::Rest), [false, true]);
        assert_eq!(turns(&inner, Rows::All), [true, true]);
        assert_eq!((inner.parts(), inner.rows()), (1, BLOCK));
        // The same list changed, and one of more particles.
        names_ghost.blocks_mut()[1].row_entries_mut(1)[0] = 5;
        inner.refresh(&names_ghost, particles);
        assert_eq!(turns(&inner, Rows::Inner(0)), [true, true]);
        inner.refresh(&names_ghost, 5);
        assert_eq!(turns(&inner, Rows::Inner(0)), [false, false]);
        assert_eq!(inner.parts(), 0);
    }

    #[test]
    fn parts_share_the_inner_blocks() {
        let blocks = 4 * BLOCKS_OF_THREAD * rayon::current_num_threads() + 2;
        let mut list = NeighborList::default();
        list.resize(blocks * BLOCK);
        list.blocks_mut().iter_mut().for_each(Block::clear);
        let mut inner = InnerBlocks::default();
        inner.refresh(&list, blocks * BLOCK);
        assert_eq!(inner.parts(), MOST_PARTS);
        let turns =
            |b: usize| (0..MOST_PARTS).filter(|&part| inner.is_summed_in(b, Rows::Inner(part))).collect::<Vec<_>>();
        let parts: Vec<usize> = (0..blocks).map(|b| turns(b)[0]).collect();
        assert!((0..blocks).all(|b| turns(b).len() == 1) && parts.is_sorted(), "{parts:?}");
        assert_eq!((parts[0], parts[blocks - 1]), (0, MOST_PARTS - 1));
    }
}
