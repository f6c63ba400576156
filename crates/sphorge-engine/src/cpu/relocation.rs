//! Particles that change their index in the common order, and some of them their rank: one message with all columns of
//! those that go to another rank.

use crate::RunFailure;
use crate::particles::{ColumnVisitor, Particles};
use crate::persist::Fixed;
use crate::ranks::{Ranks, unreadable};

/// New positions of particles in the common order.
pub(super) struct Relocation {
    ranks: Ranks,
    /// Particles that go to each rank, in their new order.
    leaving: Vec<Vec<u32>>,
    /// For every new index of this rank, the source of its particle.
    from: Vec<u32>,
}

impl Relocation {
    /// Index `k` of the common order receives the particle at `order[k]`. The first particles of each rank are at the
    /// first of `places` before, at the second afterwards, followed by the number of particles.
    pub(super) fn new(ranks: Ranks, (former, starts): (&[usize], &[usize]), order: &[u32]) -> Self {
        let (rank, size) = (ranks.rank(), ranks.size());
        let own = former[rank]..former[rank + 1];
        let owner = |place: u32| former.partition_point(|&start| start <= place as usize) as u32 - 1;
        let is_own = |place: &&u32| own.contains(&(**place as usize));
        let leaving = (0..size)
            .map(|r| {
                order[starts[r]..starts[r + 1]].iter().filter(is_own).map(|place| place - own.start as u32).collect()
            })
            .collect();
        let from = order[starts[rank]..starts[rank + 1]].iter().map(|&place| owner(place)).collect();
        Self { ranks, leaving, from }
    }

    /// Moves every column, in one message to each rank.
    ///
    /// Only particles that go to another rank are copied. The largest memory at once is that of the columns before or
    /// afterwards, whichever is more, plus the incoming messages and one column.
    ///
    /// # Errors
    /// A rank is lost, and with it some particles.
    pub(super) fn apply(&self, particles: &mut Particles) -> Result<(), RunFailure> {
        let width = particles.width();
        let mut leaving = Leaving::new(self, width);
        particles.visit(&mut leaving);
        let from = self.ranks.exchange(leaving.to, &self.lengths(width))?;
        let mut coming = Coming::new(self, leaving.is_used, from);
        particles.visit(&mut coming);
        coming.is_readable.then_some(()).ok_or_else(unreadable)
    }

    /// Bytes that arrive from each rank, given the number for each particle.
    fn lengths(&self, width: usize) -> Vec<usize> {
        let mut lengths = vec![0; self.ranks.size()];
        for &rank in self.from.iter().filter(|rank| **rank as usize != self.ranks.rank()) {
            lengths[rank as usize] += width;
        }
        lengths
    }
}

/// Removes the particles that go to other ranks from each column and sorts the others into their new order.
struct Leaving<'a> {
    relocation: &'a Relocation,
    /// To each rank, column by column.
    to: Vec<Vec<u8>>,
    /// Which columns have values: the same ones on all ranks.
    is_used: Vec<bool>,
}

impl<'a> Leaving<'a> {
    fn new(relocation: &'a Relocation, width: usize) -> Self {
        let rank = relocation.ranks.rank();
        let room = |(r, places): (usize, &Vec<u32>)| if r == rank { 0 } else { width * places.len() };
        // Allocated at once, because growing would hold the message twice.
        let to = relocation.leaving.iter().enumerate().map(|place| Vec::with_capacity(room(place))).collect();
        Self { relocation, to, is_used: Vec::new() }
    }
}

impl ColumnVisitor for Leaving<'_> {
    fn visit<V: Fixed + Copy>(&mut self, column: &mut Vec<V>) {
        self.is_used.push(!column.is_empty());
        if column.is_empty() {
            return;
        }
        let Relocation { ranks, leaving, .. } = self.relocation;
        for (_, (message, places)) in self.to.iter_mut().zip(leaving).enumerate().filter(|(r, _)| *r != ranks.rank()) {
            places.iter().for_each(|&i| column[i as usize].write(message));
        }
        *column = leaving[ranks.rank()].iter().map(|&i| column[i as usize]).collect();
    }
}

/// Inserts the particles that have arrived between those that stay.
struct Coming<'a> {
    relocation: &'a Relocation,
    is_used: std::vec::IntoIter<bool>,
    from: Vec<Vec<u8>>,
    /// Bytes of each that were taken.
    taken: Vec<usize>,
    is_readable: bool,
}

impl<'a> Coming<'a> {
    fn new(relocation: &'a Relocation, is_used: Vec<bool>, from: Vec<Vec<u8>>) -> Self {
        let taken = vec![0; from.len()];
        Self { relocation, is_used: is_used.into_iter(), from, taken, is_readable: true }
    }

    /// The next value from a rank.
    fn next<V: Fixed>(&mut self, rank: usize) -> Option<V> {
        let start = self.taken[rank];
        self.taken[rank] += V::SIZE;
        V::read(self.from[rank].get(start..self.taken[rank])?)
    }
}

impl ColumnVisitor for Coming<'_> {
    fn visit<V: Fixed + Copy>(&mut self, column: &mut Vec<V>) {
        // All particles may have left a column that is used.
        if self.is_used.next() != Some(true) {
            return;
        }
        let Relocation { ranks, from, .. } = self.relocation;
        let mut stayed = std::mem::take(column).into_iter();
        column.reserve_exact(from.len());
        for &rank in from {
            let value = if rank as usize == ranks.rank() { stayed.next() } else { self.next(rank as usize) };
            match value {
                Some(value) => column.push(value),
                None => self.is_readable = false,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Owner;
    use crate::ranks::{Communicator, Messages};
    use sphorge_physics::history::HistoryVariable;
    use sphorge_physics::parameter::Bound;
    use std::sync::Arc;

    static DAMAGE: HistoryVariable =
        HistoryVariable { name: "damage", unit: "", initial: 0.0, bound: Bound::Any, meaning: "for a test" };

    /// One of three ranks whose messages the test carries.
    #[derive(Debug)]
    struct OfThree(usize);

    impl Communicator for OfThree {
        fn rank(&self) -> usize {
            self.0
        }
        fn size(&self) -> usize {
            3
        }
        fn begin(&self, _: Vec<Vec<u8>>, _: &[usize]) -> Result<Box<dyn Messages>, String> {
            Err("nobody is there".to_owned())
        }
    }

    /// Places at which the particles of three ranks begin, before and afterwards.
    const FORMER: [usize; 4] = [0, 4, 7, 10];
    const STARTS: [usize; 4] = [0, 3, 8, 10];
    /// The first rank keeps one particle, the second two, the third none.
    const ORDER: [u32; 10] = [9, 2, 4, 0, 6, 5, 7, 8, 3, 1];

    fn relocations() -> [Relocation; 3] {
        [0, 1, 2].map(|rank| Relocation::new(Ranks::new(Arc::new(OfThree(rank))), (&FORMER, &STARTS), &ORDER))
    }

    /// Particles at these places of the common order, with columns of unlike widths and one that is not used.
    fn particles(places: impl Iterator<Item = u32> + Clone) -> Particles {
        let mut particles = Particles::new(places.clone().count());
        particles.allocate(Owner::AdaptiveSearch);
        particles.id = places.clone().collect();
        particles.position = places.clone().map(|k| [f64::from(k), 0.5, -f64::from(k)]).collect();
        particles.searched_at = places.clone().map(|k| [0.0, f64::from(k).sqrt(), 0.1]).collect();
        particles.history.add(&DAMAGE, &places.map(|k| 0.1 * f64::from(k)).collect::<Vec<_>>());
        particles
    }

    #[test]
    fn particles_take_all_their_columns_to_their_new_places_in_one_message() {
        let relocations = relocations();
        let mut parts: Vec<Particles> =
            FORMER.windows(2).map(|ends| particles(ends[0] as u32..ends[1] as u32)).collect();
        let width = parts[0].width();
        let packed: Vec<Leaving<'_>> = relocations
            .iter()
            .zip(&mut parts)
            .map(|(relocation, part)| {
                let mut leaving = Leaving::new(relocation, width);
                part.visit(&mut leaving);
                leaving
            })
            .collect();
        for (rank, (relocation, part)) in relocations.iter().zip(&mut parts).enumerate() {
            let from: Vec<Vec<u8>> = packed.iter().map(|leaving| leaving.to[rank].clone()).collect();
            assert_eq!(from.iter().map(Vec::len).collect::<Vec<_>>(), relocation.lengths(width));
            let mut coming = Coming::new(relocation, packed[rank].is_used.clone(), from);
            part.visit(&mut coming);
            assert!(coming.is_readable);
            let expected = particles(ORDER[STARTS[rank]..STARTS[rank + 1]].iter().copied());
            assert_eq!(format!("{part:?}"), format!("{expected:?}"));
        }
    }

    #[test]
    fn what_stays_is_held_once() {
        let relocation = &relocations()[1];
        let mut part = particles(4..7);
        let width = part.width();
        let mut leaving = Leaving::new(relocation, width);
        part.visit(&mut leaving);
        // One of three goes; no room is left over in what is sent and in what is kept.
        let sent: usize = leaving.to.iter().map(Vec::capacity).sum();
        assert_eq!((sent, part.bytes()), (width, 2 * width));
        let from = relocation.lengths(width).into_iter().map(|length| vec![0; length]).collect();
        part.visit(&mut Coming::new(relocation, leaving.is_used, from));
        assert_eq!(part.bytes(), 5 * width);
    }

    #[test]
    fn a_message_that_is_too_short_is_told() {
        let relocation = &relocations()[1];
        let mut part = particles(4..7);
        let mut leaving = Leaving::new(relocation, part.width());
        part.visit(&mut leaving);
        let mut coming = Coming::new(relocation, leaving.is_used, vec![Vec::new(); 3]);
        part.visit(&mut coming);
        assert!(!coming.is_readable);
    }
}
