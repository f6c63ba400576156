//! The neighbour list: one flat, dense layout for every strategy.
//!
//! Particles are grouped in blocks, whose rows are stored contiguously. Different threads build blocks without atomics
//! and process them as units of work. Every row is padded to a whole number of SIMD vectors with the particle's own
//! index: a pair of a particle with itself has zero distance and zero velocity difference, so every antisymmetric or
//! difference sum ignores it and loops need no masks.

use crate::persist::{Archive, ArchiveError, persist_pieces_or_none, require};
use rayon::prelude::*;

/// Rows in a block.
pub const BLOCK: usize = 128;

/// Rows are padded to a multiple of this length, the widest SIMD vector in use.
pub const PAD: usize = 16;

/// Neighbours of every particle.
#[derive(Clone, Debug, Default)]
pub struct NeighborList {
    blocks: Vec<Block>,
    /// How often blocks were borrowed for changes.
    changes: u64,
}

/// Rows of up to [`BLOCK`] consecutive particles.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Start of each row in `indices`, one more entry than rows.
    starts: Vec<u32>,
    /// True lengths, without padding.
    lengths: Vec<u32>,
    /// Contiguous rows; only the first `used` entries are valid, the rest is capacity.
    indices: Vec<u32>,
    used: usize,
}

impl NeighborList {
    /// Sets the number of particles; rows are empty until filled.
    pub fn resize(&mut self, particles: usize) {
        self.blocks.resize_with(particles.div_ceil(BLOCK), Block::default);
        self.changes += 1;
    }

    /// Rows of `particles` particles, each from what `row` adds to the empty list that it is given, on all threads.
    pub fn fill(&mut self, particles: usize, row: impl Fn(usize, &mut Vec<u32>) + Sync) {
        self.resize(particles);
        self.blocks_mut().par_iter_mut().enumerate().for_each_init(Vec::new, |neighbors, (b, block)| {
            block.clear();
            for i in b * BLOCK..particles.min((b + 1) * BLOCK) {
                neighbors.clear();
                row(i, neighbors);
                block.push_all(neighbors);
                block.end_row(i as u32);
            }
        });
    }

    /// The blocks, particle `i` in block `i / BLOCK`.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// The blocks, to be filled.
    pub fn blocks_mut(&mut self) -> &mut [Block] {
        self.changes += 1;
        &mut self.blocks
    }

    /// A number that changes whenever the list may have changed.
    pub(crate) fn changes(&self) -> u64 {
        self.changes
    }

    /// Neighbours of particle `i`, without padding.
    pub fn row(&self, i: usize) -> &[u32] {
        self.blocks[i / BLOCK].row(i % BLOCK)
    }

    /// Ordered pairs in the list.
    pub fn pairs(&self) -> u64 {
        self.blocks.iter().flat_map(|b| &b.lengths).map(|&n| u64::from(n)).sum()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let of = |b: &Block| 4 * (b.starts.capacity() + b.lengths.capacity() + b.indices.capacity());
        self.blocks.iter().map(of).sum()
    }
}

impl Block {
    /// Removes all rows, keeps the memory.
    pub fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.lengths.clear();
        self.used = 0;
    }

    /// Capacity for at least `count` more entries of the row being written.
    #[inline(always)]
    pub(crate) fn room(&mut self, count: usize) -> &mut [u32] {
        let needed = self.used + count;
        if self.indices.len() < needed {
            // Exactly as much: doubling would leave half of the largest array of a run empty.
            self.indices.reserve_exact(needed - self.indices.len());
            self.indices.resize(needed, 0);
        }
        &mut self.indices[self.used..]
    }

    /// Counts the next `count` entries as written.
    #[inline(always)]
    pub(crate) fn advance(&mut self, count: usize) {
        self.used += count;
    }

    /// Adds one neighbour to the row being written.
    #[inline(always)]
    pub fn push(&mut self, j: u32) {
        self.room(1)[0] = j;
        self.used += 1;
    }

    /// Adds several neighbours to the row being written.
    fn push_all(&mut self, neighbors: &[u32]) {
        self.room(neighbors.len())[..neighbors.len()].copy_from_slice(neighbors);
        self.used += neighbors.len();
    }

    /// Ends the row of particle `own` and pads it.
    pub fn end_row(&mut self, own: u32) {
        let start = *self.starts.last().unwrap_or(&0) as usize;
        let length = self.used - start;
        self.lengths.push(length as u32);
        // A whole SIMD vector at once: entries behind the padding are capacity.
        self.room(PAD)[..PAD].fill(own);
        self.used = start + length.next_multiple_of(PAD);
        self.starts.push(self.used as u32);
    }

    /// Adds row `k` of another block as it is.
    pub fn copy_row(&mut self, other: &Block, k: usize) {
        let row = &other.indices[other.starts[k] as usize..other.starts[k + 1] as usize];
        self.room(row.len())[..row.len()].copy_from_slice(row);
        self.used += row.len();
        self.lengths.push(other.lengths[k]);
        self.starts.push(self.used as u32);
    }

    /// Where the padded row `k` starts among all padded entries of the block.
    #[inline(always)]
    pub fn start(&self, k: usize) -> usize {
        self.starts[k] as usize
    }

    /// Entries of all rows, padding included.
    pub fn padded_len(&self) -> usize {
        self.used
    }

    /// Replaces row `k` of particle `own`: in place if it fits, else by way of a `spare` block.
    pub(crate) fn set_row(&mut self, k: usize, own: u32, row: &[u32], spare: &mut Self) {
        if self.row(k) == row {
            return;
        }
        let place = self.starts[k] as usize..self.starts[k + 1] as usize;
        if row.len() <= place.len() {
            let place = &mut self.indices[place];
            place[..row.len()].copy_from_slice(row);
            place[row.len()..].fill(own);
            self.lengths[k] = row.len() as u32;
            return;
        }
        spare.clear();
        for other in 0..self.len() {
            if other == k {
                row.iter().for_each(|&j| spare.push(j));
                spare.end_row(own);
            } else {
                spare.copy_row(self, other);
            }
        }
        std::mem::swap(self, spare);
    }

    /// Entries of all rows, padding included.
    pub(crate) fn entries(&self) -> &[u32] {
        &self.indices[..self.used]
    }

    /// The same, to be renumbered.
    pub(crate) fn entries_mut(&mut self) -> &mut [u32] {
        &mut self.indices[..self.used]
    }

    /// The row of particle `k` with its padding, to be renumbered.
    pub(crate) fn row_entries_mut(&mut self, k: usize) -> &mut [u32] {
        &mut self.indices[self.starts[k] as usize..self.starts[k + 1] as usize]
    }

    /// Rows written.
    pub fn len(&self) -> usize {
        self.lengths.len()
    }

    /// No rows.
    pub fn is_empty(&self) -> bool {
        self.lengths.is_empty()
    }

    /// Row `k` without padding.
    #[inline(always)]
    pub fn row(&self, k: usize) -> &[u32] {
        let start = self.starts[k] as usize;
        &self.indices[start..start + self.lengths[k] as usize]
    }

    /// Row `k` padded to a multiple of `width`, which must divide [`PAD`].
    #[inline(always)]
    pub fn padded_row(&self, k: usize, width: usize) -> &[u32] {
        let start = self.starts[k] as usize;
        &self.indices[start..start + (self.lengths[k] as usize).next_multiple_of(width)]
    }

    /// Keeps the neighbours in row `k` of particle `own` that `keep` allows, in their order, and pads the row again.
    pub(crate) fn retain_in_row(&mut self, k: usize, own: u32, mut keep: impl FnMut(u32) -> bool) {
        let row = &mut self.indices[self.starts[k] as usize..self.starts[k + 1] as usize];
        let mut kept = 0;
        for at in 0..self.lengths[k] as usize {
            let j = row[at];
            if keep(j) {
                row[kept] = j;
                kept += 1;
            }
        }
        row[kept..].fill(own);
        self.lengths[k] = kept as u32;
    }

    /// Sorts every row. Rows come out in the order of the cells, which moves with the grid.
    pub fn sort_rows(&mut self) {
        for k in 0..self.lengths.len() {
            let start = self.starts[k] as usize;
            self.indices[start..start + self.lengths[k] as usize].sort_unstable();
        }
    }
}

impl NeighborList {
    /// The first block that is not as a search of `rows` particles, starting with index `first`, among `points` leaves
    /// it; for loaded lists.
    pub(crate) fn first_unfit(&self, first: usize, rows: usize, points: usize) -> Option<usize> {
        let blocks = rows.div_ceil(BLOCK);
        let fits = |b: usize| {
            self.blocks.get(b).is_some_and(|block| block.fits(first + b * BLOCK, BLOCK.min(rows - b * BLOCK), points))
        };
        (0..blocks.max(self.blocks.len())).find(|&b| b >= blocks || !fits(b))
    }
}

impl Block {
    /// Whether it is one of `rows` particles from `first` on, among `points`.
    fn fits(&self, first: usize, rows: usize, points: usize) -> bool {
        let (starts, indices) = (&self.starts, &self.indices);
        // Sums subtract padding as pairs of the particle with itself, which are always within reach.
        let is_padded = |k: usize| {
            let padding = (starts[k] + self.lengths[k]) as usize..starts[k + 1] as usize;
            indices[padding].iter().all(|&j| j as usize == first + k)
        };
        let room = |k: usize| starts[k + 1].checked_sub(starts[k]).filter(|room| (*room as usize).is_multiple_of(PAD));
        self.lengths.len() == rows
            && starts.len() == rows + 1
            && starts[0] == 0
            && (0..rows).all(|k| room(k).is_some_and(|room| self.lengths[k] <= room))
            && starts[rows] as usize == self.used
            && self.used <= indices.len()
            && indices[..self.used].iter().all(|&j| (j as usize) < points)
            && (0..rows).all(is_padded)
    }
}

impl NeighborList {
    /// Saves or loads the rows of `count` particles, or none at all: the capacity of each row, its length, and all
    /// entries including padding, renumbered by `number` for saving. Loaded rows keep the saved indices.
    ///
    /// # Errors
    /// See [`ArchiveError`].
    pub(crate) fn persist(
        &mut self,
        count: usize,
        number: impl Fn(u32) -> u32,
        name: &str,
        archive: &mut dyn Archive,
    ) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        let blocks = &self.blocks;
        let mut rooms: Vec<u32> = blocks.iter().flat_map(|b| b.starts.windows(2).map(|row| row[1] - row[0])).collect();
        let mut lengths: Vec<u32> = blocks.iter().flat_map(|b| &b.lengths).copied().collect();
        // Rows that were loaded before and not completed have other indices.
        let entries = blocks.iter().flat_map(Block::entries).filter(|_| archive.is_saving());
        let mut indices: Vec<u32> = entries.map(|&j| number(j)).collect();
        persist_pieces_or_none(&mut rooms, count, &of("rooms"), archive)?;
        persist_pieces_or_none(&mut lengths, rooms.len(), &of("lengths"), archive)?;
        require(lengths.len() == rooms.len(), &of("lengths"))?;
        let all: usize = rooms.iter().map(|&room| room as usize).sum();
        persist_pieces_or_none(&mut indices, all, &of("indices"), archive)?;
        require(indices.len() == all, &of("indices"))?;
        // Starts of rows are counted in 32 bits.
        let block_rooms = || rooms.chunks(BLOCK).map(|rooms| rooms.iter().map(|&room| u64::from(room)).sum::<u64>());
        require(block_rooms().all(|room| room <= u64::from(u32::MAX)), &of("rooms"))?;
        if archive.is_saving() {
            return Ok(());
        }
        self.resize(rooms.len());
        let mut rest = &indices[..];
        for ((block, rooms), lengths) in self.blocks.iter_mut().zip(rooms.chunks(BLOCK)).zip(lengths.chunks(BLOCK)) {
            block.clear();
            for room in rooms {
                block.starts.push(block.starts[block.lengths.len()] + room);
                block.lengths.push(0);
            }
            block.lengths.copy_from_slice(lengths);
            block.used = block.starts[rooms.len()] as usize;
            let (own, behind) = rest.split_at(block.used);
            block.indices.clear();
            block.indices.extend_from_slice(own);
            rest = behind;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_filled_together_are_those_filled_one_by_one() {
        // More than one block, rows of every length around that of a SIMD vector, none among them.
        let row = |i: usize| (0..(7 * i % 40) as u32).map(|k| k + i as u32).collect::<Vec<u32>>();
        let count = 2 * BLOCK + 3;
        let (mut filled, mut pushed) = (NeighborList::default(), NeighborList::default());
        filled.fill(count, |i, neighbors| neighbors.extend(row(i)));
        pushed.resize(count);
        for (b, block) in pushed.blocks_mut().iter_mut().enumerate() {
            block.clear();
            for i in b * BLOCK..count.min((b + 1) * BLOCK) {
                row(i).into_iter().for_each(|j| block.push(j));
                block.end_row(i as u32);
            }
        }
        assert_eq!(filled.pairs(), pushed.pairs());
        for i in 0..count {
            assert_eq!(filled.row(i), pushed.row(i), "{i}");
            let padded = |list: &NeighborList| list.blocks()[i / BLOCK].padded_row(i % BLOCK, PAD).to_vec();
            assert_eq!(padded(&filled), padded(&pushed), "{i}");
        }
    }

    #[test]
    fn a_row_is_replaced_in_its_place_or_the_block_is_rebuilt() {
        let mut block = Block::default();
        block.clear();
        for (own, row) in [vec![1, 2], vec![0, 2], vec![0]].into_iter().enumerate() {
            row.iter().for_each(|&j| block.push(j));
            block.end_row(own as u32);
        }
        let rows = |block: &Block| [0, 1, 2].map(|k| block.row(k).to_vec());
        let mut spare = Block::default();
        block.set_row(1, 1, &[7], &mut spare);
        assert_eq!(rows(&block), [vec![1, 2], vec![7], vec![0]]);
        assert_eq!(block.padded_row(1, 4), [7, 1, 1, 1]);
        assert_eq!(block.padded_len(), 3 * PAD);
        let long: Vec<u32> = (10..10 + PAD as u32 + 1).collect();
        block.set_row(1, 1, &long, &mut spare);
        assert_eq!(rows(&block), [vec![1, 2], long, vec![0]]);
        assert_eq!((block.padded_row(1, PAD).len(), block.padded_row(1, PAD)[PAD + 1]), (2 * PAD, 1));
        assert_eq!(block.padded_row(2, 4), [0, 2, 2, 2]);
        // A long row that became short keeps its place; what comes behind stays where it is.
        block.set_row(1, 1, &[], &mut spare);
        assert_eq!((block.row(1).len(), block.start(2), block.row(2)), (0, 3 * PAD, &[0][..]));
    }

    #[test]
    fn rows_are_padded_with_the_particle_itself() {
        let mut list = NeighborList::default();
        list.resize(2);
        let block = &mut list.blocks_mut()[0];
        block.clear();
        block.push(1);
        block.end_row(0);
        block.end_row(1);
        assert_eq!(list.row(0), [1]);
        assert_eq!(list.blocks()[0].padded_row(0, 8), [1, 0, 0, 0, 0, 0, 0, 0]);
        assert!(list.row(1).is_empty());
        assert_eq!(list.pairs(), 1);
    }
}
