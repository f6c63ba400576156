//! Distances stored at the last search, the "stored kernel values" of the paper. A kernel value is a function of the
//! distance, so storing one is storing the other, with three numbers per pair.

use crate::lanes::{Lanes, PairScalar};
use crate::neighbors::{BLOCK, Block, NeighborList, PAD};
use crate::persist::{Archive, ArchiveError, Persist, persist_pieces_or_none, require};
use rayon::prelude::*;
use sphorge_physics::Vector;

/// Distances `x_i - x_j` of all listed pairs as they were when the row of `i` was searched.
#[derive(Clone, Debug, Default)]
pub(crate) struct StoredPairs<T> {
    blocks: Vec<StoredBlock<T>>,
}

/// Distances of the rows of a block, components separate in groups of [`PAD`] pairs, m.
#[derive(Clone, Debug, Default)]
pub(crate) struct StoredBlock<T> {
    starts: Vec<u32>,
    x: Vec<T>,
}

impl<T: PairScalar> StoredPairs<T> {
    /// Updates the distances of the rows that `searched` returns true for; the others keep theirs.
    pub(crate) fn rebuild(
        &mut self,
        list: &NeighborList,
        points: &[Vector<f64>],
        searched: impl Fn(usize) -> bool + Sync,
    ) {
        self.blocks.resize_with(list.blocks().len(), || StoredBlock { starts: Vec::new(), x: Vec::new() });
        self.blocks.par_iter_mut().zip(list.blocks()).enumerate().for_each(|(b, (stored, block))| {
            let first = b * BLOCK;
            if (0..block.len()).any(|k| searched(first + k)) {
                stored.rebuild(block, first, points, &searched);
            }
        });
    }

    /// Distances of a block.
    pub(crate) fn block(&self, b: usize) -> &StoredBlock<T> {
        &self.blocks[b]
    }
}

impl<T> StoredPairs<T> {
    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.blocks.iter().map(|b| 4 * b.starts.capacity() + size_of::<T>() * b.x.capacity()).sum()
    }
}

impl<T: PairScalar> StoredBlock<T> {
    fn rebuild(&mut self, block: &Block, first: usize, points: &[Vector<f64>], searched: &impl Fn(usize) -> bool) {
        let mut x = vec![T::zero(); 3 * block.padded_len()];
        for k in 0..block.len() {
            let i = first + k;
            let start = 3 * block.start(k);
            if searched(i) {
                for (n, &j) in block.row(k).iter().enumerate() {
                    for a in 0..3 {
                        let d = points[i][a] - points[j as usize][a];
                        x[start + n / PAD * 3 * PAD + a * PAD + n % PAD] = T::of(d);
                    }
                }
            } else {
                let length = 3 * (block.start(k + 1) - block.start(k));
                let old = 3 * self.starts[k] as usize;
                x[start..start + length].copy_from_slice(&self.x[old..old + length]);
            }
        }
        self.x = x;
        self.starts.clear();
        self.starts.extend((0..=block.len()).map(|k| block.start(k) as u32));
    }

    /// Distances of some of the pairs, those at `entries` of this block, which are the contiguous rows of `part`.
    pub(super) fn part(&self, part: &Block, entries: &[usize]) -> Self {
        let mut x = vec![T::zero(); 3 * part.padded_len()];
        let mut entries = entries.iter();
        for k in 0..part.len() {
            for (n, &entry) in (part.start(k)..).zip(entries.by_ref().take(part.row(k).len())) {
                for a in 0..3 {
                    let place = |at: usize| at / PAD * 3 * PAD + a * PAD + at % PAD;
                    x[place(n)] = self.x[place(entry)];
                }
            }
        }
        Self { starts: (0..=part.len()).map(|k| part.start(k) as u32).collect(), x }
    }

    /// Component `a` of the SIMD vector that starts at the padded entry `at` of the block.
    #[inline(always)]
    pub(crate) fn vector<L: Lanes<Element = T>>(&self, at: usize, a: usize) -> L {
        L::load(&self.x[at / PAD * 3 * PAD + a * PAD + at % PAD..])
    }

    /// The distance of the pair at entry `at` of the block, m.
    pub(crate) fn distance(&self, at: usize) -> Vector<f64> {
        [0, 1, 2].map(|a| self.x[at / PAD * 3 * PAD + a * PAD + at % PAD].to_f64())
    }
}

impl<T: PairScalar> StoredPairs<T> {
    /// Saves or loads the distances of the pairs of a list, if they are stored.
    ///
    /// # Errors
    /// See [`ArchiveError`].
    pub(super) fn persist(
        kept: &mut Option<Self>,
        list: &NeighborList,
        name: &str,
        archive: &mut dyn Archive,
    ) -> Result<(), ArchiveError> {
        let mut is_there = kept.is_some();
        is_there.persist(&format!("{name}.is_there"), archive)?;
        if !is_there {
            *kept = None;
            return Ok(());
        }
        let name = format!("{name}.distances");
        let blocks = &mut kept.get_or_insert_default().blocks;
        // Single precision widens to double and back without a change.
        let saved = blocks.iter().flat_map(|block| &block.x).filter(|_| archive.is_saving());
        let mut distances: Vec<f64> = saved.map(|x| x.to_f64()).collect();
        let all: usize = list.blocks().iter().map(|block| 3 * block.padded_len()).sum();
        persist_pieces_or_none(&mut distances, all, &name, archive)?;
        require(distances.len() == all, &name)?;
        if archive.is_saving() {
            return Ok(());
        }
        let mut rest = &distances[..];
        blocks.clear();
        for block in list.blocks() {
            let (own, behind) = rest.split_at(3 * block.padded_len());
            let x = own.iter().copied().map(T::of).collect();
            blocks.push(StoredBlock { starts: (0..=block.len()).map(|k| block.start(k) as u32).collect(), x });
            rest = behind;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_not_searched_keep_their_distances() {
        let mut list = NeighborList::default();
        list.resize(2);
        let block = &mut list.blocks_mut()[0];
        block.clear();
        block.push(1);
        block.end_row(0);
        block.push(0);
        block.end_row(1);
        let mut stored = StoredPairs::<f32>::default();
        stored.rebuild(&list, &[[0.0; 3], [1.0, 2.0, 3.0]], |_| true);
        // Row 1 grows and row 0 moves on in memory when only row 1 is searched.
        stored.rebuild(&list, &[[0.5, 0.0, 0.0], [1.0, 2.0, 4.0]], |i| i == 1);
        let block = stored.block(0);
        assert_eq!(block.distance(0), [-1.0, -2.0, -3.0]);
        assert_eq!(block.distance(list.blocks()[0].start(1)), [0.5, 2.0, 4.0]);
        assert_eq!(block.vector::<f32>(list.blocks()[0].start(1), 2), 4.0);
        // Padding is at no distance.
        assert_eq!(block.distance(1), [0.0; 3]);
    }
}
