//! Cell search: a full search, or one that rebuilds the rows of some particles.

use super::candidates::Candidates;
use super::cell_points::CellPoints;
use super::rows::{PatchJob, RowsJob};
use super::{BLOCK, Block, DisplacementBound, Frame, NeighborList, Reach, mark};
use crate::lanes::{Instructions, PairScalar, run};
use crate::persist::{Archive, ArchiveError, Persist};
use rayon::prelude::*;
use sphorge_physics::Vector;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The searcher: a cell grid and the points in its order, kept between searches.
#[derive(Debug, Default)]
pub(crate) struct Searcher {
    points: CellPoints,
    /// One for each thread.
    scratch: Vec<Mutex<Scratch>>,
}

/// Working memory of a thread.
#[derive(Debug, Default)]
struct Scratch {
    /// A block being rebuilt.
    spare: Block,
    /// A row being made.
    row: Block,
    candidates: Candidates,
}

/// Input of a partial search.
pub(crate) struct PartialSearch<'a> {
    /// Particles, followed by ghosts.
    pub(crate) points: &'a [Vector<f64>],
    /// Sources of the ghosts. A ghost is rebuilt if its source is.
    pub(crate) sources: &'a [u32],
    /// Particles whose rows are in the list: contiguous whole blocks.
    pub(crate) rows: std::ops::Range<usize>,
    pub(crate) reach: Reach<'a>,
    /// Upper bound of the displacements of the points.
    pub(crate) displacement: DisplacementBound,
    /// Of each point: [`mark::REBUILD`] for those whose rows are rebuilt, [`mark::KEEP`] for the others; rows to be patched get [`mark::PATCH`].
    pub(crate) marks: &'a [AtomicU8],
}

impl PartialSearch<'_> {
    fn count(&self) -> usize {
        self.points.len() - self.sources.len()
    }

    /// Whether the rows of all particles are in the list.
    fn is_whole(&self) -> bool {
        self.rows.len() == self.count()
    }

    /// The particle of a point, or the source of an image.
    fn source(&self, j: u32) -> usize {
        let ghost = (j as usize).checked_sub(self.count());
        ghost.map_or(j as usize, |ghost| self.sources[ghost] as usize)
    }

    fn mark_of(&self, i: usize) -> u8 {
        self.marks[i].load(Ordering::Relaxed)
    }

    /// Particles of a block of the list that have a mark.
    fn rows_of_block(&self, b: usize, mark: u8) -> impl Iterator<Item = usize> {
        let first = self.rows.start + b * BLOCK;
        (first..(first + BLOCK).min(self.rows.end)).filter(move |&i| self.mark_of(i) == mark)
    }
}

impl Searcher {
    /// Fills `list` with the neighbours of the first `count` of `points`. Rows are in the order of the cells, which
    /// depends only on positions, never on threads. `displacement` bounds how far the points have moved.
    pub(crate) fn search(
        &mut self,
        points: &[Vector<f64>],
        count: usize,
        reach: &Reach<'_>,
        displacement: DisplacementBound,
        instructions: Instructions,
        list: &mut NeighborList,
    ) {
        self.search_rows(points, 0..count, reach, displacement, instructions, list);
    }

    /// Fills `list` with the neighbours of some of `points`, contiguous whole blocks, as [`Self::search`] finds them.
    pub(crate) fn search_rows(
        &mut self,
        points: &[Vector<f64>],
        wanted: std::ops::Range<usize>,
        reach: &Reach<'_>,
        displacement: DisplacementBound,
        instructions: Instructions,
        list: &mut NeighborList,
    ) {
        self.prepare_scratch();
        self.points.prepare(points, reach, displacement);
        self.points.encode_all(points, reach);
        list.resize(wanted.len());
        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            block.clear();
            let first = wanted.start + b * BLOCK;
            let rows = first..(first + BLOCK).min(wanted.end);
            let candidates = &mut this.scratch().candidates;
            candidates.clear();
            run(instructions, RowsJob { points: &this.points, rows, candidates, block });
        });
    }

    /// Rebuilds the rows of the points `rebuilt`. If a row gains or loses a neighbour, the row of that neighbour is
    /// patched, so that a symmetric list stays symmetric: a pair is in both rows or in neither. With `one_sided`
    /// nothing is patched.
    pub(crate) fn rebuild_rows(
        &mut self,
        partial: &PartialSearch<'_>,
        instructions: Instructions,
        list: &mut NeighborList,
        rebuilt: &[u32],
        one_sided: bool,
    ) {
        self.rebuild_marked(partial, instructions, list, rebuilt, one_sided);
        if !one_sided {
            self.patch_marked(partial, instructions, list);
        }
    }

    /// The first half of [`Self::rebuild_rows`]: rows are rebuilt, and unless it is `one_sided` those to be patched are
    /// marked, whether they are in the list or not.
    pub(crate) fn rebuild_marked(
        &mut self,
        partial: &PartialSearch<'_>,
        instructions: Instructions,
        list: &mut NeighborList,
        rebuilt: &[u32],
        one_sided: bool,
    ) {
        let &PartialSearch { points, ref reach, displacement, .. } = partial;
        self.prepare_scratch();
        self.points.prepare(points, reach, displacement);
        self.points.note_rebuilt(rebuilt, |i| partial.is_whole() || partial.rows.contains(&(i as usize)));
        self.points.encode_wanted(points, reach);
        let patch = |j: u32| {
            let row = partial.source(j);
            if partial.mark_of(row) == mark::KEEP {
                // Every thread writes the same value.
                partial.marks[row].store(mark::PATCH, Ordering::Relaxed);
            }
        };
        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            let mut to_rebuild = partial.rows_of_block(b, mark::REBUILD).peekable();
            if to_rebuild.peek().is_none() {
                return;
            }
            let Scratch { spare, row, candidates } = &mut *this.scratch();
            candidates.clear();
            for i in to_rebuild {
                row.clear();
                run(instructions, RowsJob { points: &this.points, rows: i..i + 1, candidates, block: row });
                if !one_sided {
                    differences(block.row(i % BLOCK), row.row(0), patch);
                }
                block.set_row(i % BLOCK, i as u32, row.row(0), spare);
            }
        });
    }

    /// The second half: patches the marked rows.
    pub(crate) fn patch_marked(
        &mut self,
        partial: &PartialSearch<'_>,
        instructions: Instructions,
        list: &mut NeighborList,
    ) {
        // A former neighbour may be anywhere.
        let want = |i| if partial.is_whole() { self.points.want_cell_of(i) } else { self.points.want_around(i) };
        (0..list.blocks().len()).into_par_iter().for_each(|b| partial.rows_of_block(b, mark::PATCH).for_each(want));
        self.points.encode_wanted(partial.points, &partial.reach);
        let this = &*self;
        list.blocks_mut().par_iter_mut().enumerate().for_each(|(b, block)| {
            let mut to_patch = partial.rows_of_block(b, mark::PATCH).peekable();
            if to_patch.peek().is_none() {
                return;
            }
            let Scratch { spare, row, candidates } = &mut *this.scratch();
            candidates.clear();
            for i in to_patch {
                row.clear();
                for &j in block.row(i % BLOCK).iter().filter(|&&j| partial.mark_of(j as usize) != mark::REBUILD) {
                    row.push(j);
                }
                run(instructions, PatchJob { points: &this.points, row: i, candidates, block: row });
                block.set_row(i % BLOCK, i as u32, row.row(0), spare);
            }
        });
    }

    /// Indices of the points in the order of tiles of cells of a search with the given reach, m, along a Hilbert curve: points of one cell are served one
    /// after the other, and any piece of the order, such as a rank has, is compact.
    pub(crate) fn tiled_order(&mut self, points: &[Vector<f64>], reach: f64) -> &[u32] {
        self.points.tiled_order(points, reach)
    }

    /// Makes the next search sort points into cells again: they have been put elsewhere, or into another order.
    pub(crate) fn forget(&mut self) {
        self.points.forget();
    }

    /// The frame in which coordinates of the points are encoded for pair sums; it holds them until they have moved through
    /// the reach.
    pub(crate) fn frame<T: PairScalar>(&self) -> Frame {
        self.points.frame::<T>()
    }

    /// Whether the loaded data are those of `count` points, or of none if they are to be sorted again.
    pub(crate) fn fits(&self, count: usize) -> bool {
        self.points.fits(count)
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let of = |s: &Mutex<Scratch>| s.lock().map_or(0, |scratch| scratch.candidates.bytes());
        self.points.bytes() + self.scratch.iter().map(of).sum::<usize>()
    }

    /// The working memory of the calling thread.
    fn scratch(&self) -> MutexGuard<'_, Scratch> {
        // Only a panic in a row poisons the lock; all of it is cleared before use.
        self.scratch[rayon::current_thread_index().unwrap_or(0)].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One working memory per thread, each as large as the largest, because the next cell of any thread may be the
    /// densest.
    fn prepare_scratch(&mut self) {
        self.scratch.resize_with(rayon::current_num_threads(), Mutex::default);
        let room = |s: &mut Mutex<Scratch>| s.get_mut().unwrap_or_else(PoisonError::into_inner).candidates.room();
        let most = self.scratch.iter_mut().map(room).max().unwrap_or(0);
        for scratch in &mut self.scratch {
            scratch.get_mut().unwrap_or_else(PoisonError::into_inner).candidates.make_room(most);
        }
    }
}

/// Visits the entries that are in only one of two rows without repetitions.
fn differences(old: &[u32], new: &[u32], mut visit: impl FnMut(u32)) {
    // Rows are in the order of the cells and mostly do not change.
    let same = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let (old, new) = (&old[same..], &new[same..]);
    let same = old.iter().rev().zip(new.iter().rev()).take_while(|(a, b)| a == b).count();
    let (old, new) = (&old[..old.len() - same], &new[..new.len() - same]);
    old.iter().filter(|j| !new.contains(j)).for_each(|&j| visit(j));
    new.iter().filter(|j| !old.contains(j)).for_each(|&j| visit(j));
}

impl Persist for Searcher {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        self.points.persist(name, archive)
    }
}

#[cfg(test)]
mod tests;
