//! Neighbours in contact, mostly in other bodies. They are removed from the neighbour list if bodies have a penalty
//! contact.

use super::{BLOCK, Block, NeighborList};
use crate::persist::{Archive, ArchiveError, persist_pieces, persist_pieces_or_none, require};
use rayon::prelude::*;

/// Rows of the few particles that have neighbours in contact, by block as in [`NeighborList`].
#[derive(Clone, Debug, Default)]
pub(crate) struct ForeignList {
    blocks: Vec<ForeignBlock>,
}

/// Rows of the particles of one block.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForeignBlock {
    /// Particles that have a row, ascending.
    owners: Vec<u32>,
    /// End of each row in `indices`.
    ends: Vec<u32>,
    indices: Vec<u32>,
}

impl ForeignList {
    /// Moves the pairs that are in contact out of a list that was just rebuilt; the order of the rows does not change.
    pub(crate) fn take_from(&mut self, list: &mut NeighborList, is_in_contact: impl Fn(usize, usize) -> bool + Sync) {
        self.blocks.resize_with(list.blocks().len(), ForeignBlock::default);
        (list.blocks_mut().par_iter_mut(), self.blocks.par_iter_mut()).into_par_iter().enumerate().for_each(
            |(b, (block, foreign))| {
                foreign.clear();
                for k in 0..block.len() {
                    foreign.take_row((b * BLOCK + k) as u32, k, block, &is_in_contact);
                }
            },
        );
    }

    /// Takes the pairs that are in contact from a list of some points: `owners` has the particle (of `count`) of each
    /// of its rows, in ascending order, `members` the particle or ghost of each of its points.
    pub(crate) fn gather(
        &mut self,
        list: &NeighborList,
        owners: &[u32],
        members: &[u32],
        count: usize,
        is_in_contact: impl Fn(usize, usize) -> bool + Sync,
    ) {
        self.blocks.resize_with(count.div_ceil(BLOCK), ForeignBlock::default);
        let row_of = |i: usize| owners.partition_point(|&owner| (owner as usize) < i);
        self.blocks.par_iter_mut().enumerate().for_each(|(b, foreign)| {
            foreign.clear();
            for row in row_of(b * BLOCK)..row_of((b + 1) * BLOCK) {
                let own = owners[row];
                let neighbours = list.row(row).iter().map(|&k| members[k as usize]);
                foreign.indices.extend(neighbours.filter(|&j| is_in_contact(own as usize, j as usize)));
                foreign.end_row(own);
            }
        });
    }

    /// Neighbours in contact, row by row.
    pub(crate) fn indices(&self) -> impl Iterator<Item = u32> {
        self.blocks.iter().flat_map(|block| &block.indices).copied()
    }

    /// Renumbers the neighbours.
    pub(crate) fn renumber(&mut self, number: impl Fn(u32) -> u32) {
        self.blocks.iter_mut().flat_map(|block| &mut block.indices).for_each(|j| *j = number(*j));
    }

    /// No pairs at all.
    pub(crate) fn is_empty(&self) -> bool {
        self.blocks.iter().all(|block| block.owners.is_empty())
    }

    /// The blocks, particle `i` in block `i / BLOCK`.
    pub(crate) fn blocks(&self) -> &[ForeignBlock] {
        &self.blocks
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let of = |b: &ForeignBlock| 4 * (b.owners.capacity() + b.ends.capacity() + b.indices.capacity());
        self.blocks.iter().map(of).sum()
    }
}

impl ForeignBlock {
    fn take_row(&mut self, own: u32, k: usize, block: &mut Block, is_in_contact: &impl Fn(usize, usize) -> bool) {
        let indices = &mut self.indices;
        block.retain_in_row(k, own, |j| {
            let is_in_contact = is_in_contact(own as usize, j as usize);
            if is_in_contact {
                indices.push(j);
            }
            !is_in_contact
        });
        self.end_row(own);
    }

    fn clear(&mut self) {
        self.owners.clear();
        self.ends.clear();
        self.indices.clear();
    }

    /// Makes the entries added since the last row that of a particle, if there are any.
    fn end_row(&mut self, own: u32) {
        if self.indices.len() as u32 > self.ends.last().copied().unwrap_or(0) {
            self.owners.push(own);
            self.ends.push(self.indices.len() as u32);
        }
    }

    /// Particles that have neighbours in contact, with these neighbours.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        let row =
            |((&own, start), &end): ((&u32, u32), &u32)| (own as usize, &self.indices[start as usize..end as usize]);
        self.owners.iter().zip(starts).zip(&self.ends).map(row)
    }
}

impl ForeignList {
    /// The first block that is not as [`Self::take_from`] leaves it for `rows` particles among `points`; for loaded
    /// lists.
    pub(crate) fn first_unfit(&self, rows: usize, points: usize) -> Option<usize> {
        let blocks = rows.div_ceil(BLOCK);
        let fits =
            |b: usize| self.blocks.get(b).is_some_and(|block| block.fits(b * BLOCK..rows.min((b + 1) * BLOCK), points));
        (0..blocks.max(self.blocks.len())).find(|&b| b >= blocks || !fits(b))
    }
}

impl ForeignBlock {
    fn fits(&self, own: std::ops::Range<usize>, points: usize) -> bool {
        self.owners.len() == self.ends.len()
            && self.owners.iter().all(|&i| own.contains(&(i as usize)))
            && self.owners.is_sorted()
            && self.ends.is_sorted()
            && self.ends.last().copied().unwrap_or(0) as usize == self.indices.len()
            && self.indices.iter().all(|&j| (j as usize) < points)
    }
}

impl ForeignList {
    /// Saves or loads the rows of `count` particles: the number of neighbours in contact of each, and these, renumbered
    /// by `number` for saving. Loaded rows keep the saved indices.
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
        let mut lengths = vec![0u32; count];
        for (own, row) in self.blocks.iter().flat_map(ForeignBlock::rows) {
            lengths[own] = row.len() as u32;
        }
        persist_pieces(&mut lengths, &format!("{name}.lengths"), archive)?;
        // Rows that were loaded before and not completed have other indices.
        let mut indices: Vec<u32> = if archive.is_saving() { self.indices().map(number).collect() } else { Vec::new() };
        let all: usize = lengths.iter().map(|&length| length as usize).sum();
        let indices_name = format!("{name}.indices");
        persist_pieces_or_none(&mut indices, all, &indices_name, archive)?;
        require(indices.len() == all, &indices_name)?;
        if archive.is_saving() {
            return Ok(());
        }
        self.blocks.resize_with(count.div_ceil(BLOCK), ForeignBlock::default);
        let mut rest = &indices[..];
        for (b, (block, lengths)) in self.blocks.iter_mut().zip(lengths.chunks(BLOCK)).enumerate() {
            block.clear();
            for (k, &length) in lengths.iter().enumerate() {
                let (row, behind) = rest.split_at(length as usize);
                block.indices.extend_from_slice(row);
                block.end_row((b * BLOCK + k) as u32);
                rest = behind;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_in_other_bodies_move_to_rows_of_their_own() {
        let mut list = NeighborList::default();
        list.resize(4);
        let block = &mut list.blocks_mut()[0];
        block.clear();
        for (own, row) in [vec![3, 1, 2], vec![0, 2], vec![1, 0], vec![0]].into_iter().enumerate() {
            row.iter().for_each(|&j| block.push(j));
            block.end_row(own as u32);
        }
        // Bodies 0, 0, 0, 1.
        let mut foreign = ForeignList::default();
        foreign.take_from(&mut list, |i, j| i / 3 != j / 3);
        assert_eq!(list.row(0), [1, 2]);
        assert_eq!(list.blocks()[0].padded_row(0, 4), [1, 2, 0, 0]);
        assert_eq!(list.row(1), [0, 2]);
        assert!(list.row(3).is_empty());
        let rows: Vec<_> = foreign.blocks()[0].rows().map(|(own, row)| (own, row.to_vec())).collect();
        assert_eq!(rows, [(0, vec![3]), (3, vec![0])]);
        // A list of particles 1 and 3 and a ghost, 4, that are 0, 1 and 2 there; pairs with particle 1 do not count.
        let mut some = NeighborList::default();
        some.resize(2);
        let block = &mut some.blocks_mut()[0];
        block.clear();
        for (own, row) in [vec![1, 2], vec![2, 0]].into_iter().enumerate() {
            row.iter().for_each(|&j| block.push(j));
            block.end_row(own as u32);
        }
        foreign.gather(&some, &[1, 3], &[1, 3, 4], 4, |_, j| j != 1);
        let rows: Vec<_> = foreign.blocks()[0].rows().map(|(own, row)| (own, row.to_vec())).collect();
        assert_eq!(rows, [(1, vec![3, 4]), (3, vec![4])]);
        // A second search starts from nothing.
        foreign.take_from(&mut list, |_, _| false);
        assert_eq!(foreign.blocks()[0].rows().count(), 0);
    }
}
