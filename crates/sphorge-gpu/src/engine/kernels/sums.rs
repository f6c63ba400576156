//! Sums over particles, in pairs of numbers and in an order that depends on nothing but the particles.
//!
//! Particles are summed in chunks by their number, and of a chunk those of one body and motion by themselves: a segment ([`crate::engine::segments`]). Each
//! segment has a few threads, its lanes, which take its particles in turn; then a thread of each sum adds what the lanes have found, in order. The sums of the
//! segments are read back.

use crate::engine::columns::{Binder, Compensated, Group, Number, Reading, Recording, Writing, recording};
use crate::record::{Double, Index, Indices, KernelFault, Recorded, Scope};
use sphorge_physics::{Elementary, Numbers, Real};

/// Particles that one lane takes of a chunk.
const EACH: usize = 16;

/// Fewest and most particles of a chunk, powers of two.
const FEWEST: usize = 32;
const MOST: usize = 1024;

/// So many chunks at least where there are particles enough: among as many processes they can be shared in whole chunks.
const CHUNKS: usize = 64;

/// Particles of a chunk, a power of two, of so many particles in all. Where they are shared out, it is in whole chunks.
pub(in crate::engine) fn chunk_of(total: usize) -> usize {
    let least = (total / CHUNKS).max(1);
    (1 << least.ilog2()).clamp(FEWEST, MOST)
}

/// What particles are summed in: the segments of a process, of chunks of so many particles.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Partition {
    pub(in crate::engine) segments: usize,
    pub(in crate::engine) chunk: usize,
}

impl Partition {
    /// Threads of a segment in the first pass, a power of two.
    pub(in crate::engine) fn lanes(self) -> usize {
        self.chunk / EACH
    }
}

/// Most sums that are taken at once beside those of the ledger.
pub(in crate::engine) const MOST_SUMS: usize = 4;

/// A thread of the first pass.
#[derive(Clone, Copy)]
pub(super) struct Lane {
    partition: Partition,
    thread: Index,
    segments: Indices,
    of_particles: Indices,
    segment: Index,
}

impl Lane {
    pub(super) fn of(bind: &mut Binder<'_>, partition: Partition, thread: Index) -> Self {
        let (segments, of_particles) = (bind.indices(Group::Segments), bind.indices(Group::SegmentOf));
        let lane = thread.and(Index::of(partition.lanes() as u32 - 1));
        // The number of a multiple of the lanes is exact far beyond that of a thread.
        let first = thread + Index::floor(-lane.number());
        let segment = Index::floor(first.number() * Recorded::of(1.0 / partition.lanes() as f64));
        Self { partition, thread, segments, of_particles, segment }
    }

    /// The body of the particles.
    pub(super) fn body(self) -> Index {
        self.segments.at(Index::of(2) * self.segment + Index::of(1))
    }

    /// Takes a state through the particles of the lane.
    pub(super) fn fold<S: Numbers<Recorded>>(self, scope: &mut Scope, start: S, add: impl FnOnce(S, Index) -> S) -> S {
        let Partition { chunk, .. } = self.partition;
        let lanes = self.partition.lanes() as u32;
        let lane = self.thread.and(Index::of(lanes - 1));
        let first = self.segments.at(Index::of(2) * self.segment) * Index::of(chunk as u32) + lane;
        let own = self.segment.number();
        scope.fold(Index::of(0), Index::of(EACH as u32), start, |_, state, k| {
            // Threads side by side read numbers side by side.
            let i = first + k * Index::of(lanes);
            let strange = (self.of_particles.at(i).number() - own).abs();
            Recorded::if_lt(strange, Recorded::of(0.5), || add(state, i), || state)
        })
    }

    /// Stores the pair of numbers that the lane has for a sum.
    pub(super) fn set(self, sums: Writing, sum: Index, value: Double) {
        let threads = self.partition.segments * self.partition.lanes();
        let at = sum * Index::of(2 * threads as u32) + Index::of(2) * self.thread;
        sums.set_at(at, value.high);
        sums.set_at(at + Index::of(1), value.low);
    }

    /// Sums terms of the particles, `sums` of the `N`, as the sums from `first` on.
    pub(super) fn sum<const N: usize>(
        self,
        bind: &mut Binder<'_>,
        (first, sums): (usize, usize),
        terms: impl FnOnce(Index) -> [Double; N],
    ) {
        let all = self.fold(bind.scope, [Double::zero(); N], |all, i| {
            let terms = terms(i);
            core::array::from_fn(|k| if k < sums { all[k] + terms[k] } else { all[k] })
        });
        let to = bind.write(Group::LaneSums);
        for (k, sum) in all.into_iter().take(sums).enumerate() {
            self.set(to, Index::of((first + k) as u32), sum);
        }
    }

    /// Stores what the lane has found.
    pub(super) fn set_all(self, bind: &mut Binder<'_>, found: &[Double]) {
        let to = bind.write(Group::LaneSums);
        for (k, number) in found.iter().enumerate() {
            self.set(to, Index::of(k as u32), *number);
        }
    }
}

/// A number with its low part among the numbers a sum is given.
pub(super) fn given(numbers: Reading, at: Index) -> Double {
    Double::new([numbers.get_at(at), numbers.get_at(at + Index::of(1))])
}

/// A column, with the rest of it where there is one.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Term {
    pub(in crate::engine) column: usize,
    pub(in crate::engine) rest: Option<usize>,
}

impl From<Number<()>> for Term {
    fn from(of: Number<()>) -> Self {
        Self { column: of.column(), rest: None }
    }
}

impl From<Compensated<()>> for Term {
    fn from(of: Compensated<()>) -> Self {
        let [column, rest] = of.columns();
        Self { column, rest: Some(rest) }
    }
}

/// Sums of one kernel: as many as its threads have registers for.
const TOGETHER: usize = 12;

/// The kernels that sum columns of a group, as the sums from `first` on.
pub(in crate::engine) fn of_columns(
    group: Group,
    terms: &[Term],
    (partition, first): (Partition, usize),
    count: usize,
) -> Result<Vec<Recording>, KernelFault> {
    let of_batch = |(number, batch): (usize, &[Term])| {
        // Names are letters, digits and underscores.
        let name = format!("sum_{group:?}_{number}").to_lowercase().replace('(', "_").replace(')', "");
        recording(&name, count, |bind, thread| {
            let (lane, columns) = (Lane::of(bind, partition, thread), bind.read(group));
            let term = |term: &Term, i: Index| {
                let rest = term.rest.map_or_else(Recorded::zero, |rest| columns.get(rest, i));
                Double::new([columns.get(term.column, i), rest])
            };
            lane.sum::<TOGETHER>(bind, (first + TOGETHER * number, batch.len()), |i| {
                core::array::from_fn(|k| batch.get(k).map_or_else(Double::zero, |of| term(of, i)))
            });
        })
    };
    terms.chunks(TOGETHER).enumerate().map(of_batch).collect()
}

/// Adds what lanes have found, one thread for each sum of each segment.
pub(in crate::engine) fn of_lanes(lanes: usize, count: usize) -> Result<Recording, KernelFault> {
    recording("sum_lanes", count, |bind, sum| {
        let (from, to) = (bind.read(Group::LaneSums), bind.write(Group::Sums));
        let first = sum * Index::of(2 * lanes as u32);
        let all = bind.scope.fold(Index::of(0), Index::of(lanes as u32), Double::zero(), |_, all, lane| {
            all + given(from, first + Index::of(2) * lane)
        });
        let at = Index::of(2) * sum;
        to.set_at(at, all.high);
        to.set_at(at + Index::of(1), all.low);
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::{Evaluation, whole};

    /// Particles of three segments in two chunks of 32, of which the first has those of two kinds.
    const SEGMENTS: [u32; 6] = [0, 0, 0, 1, 1, 0];
    const COUNT: usize = 50;
    const STRIDE: usize = 64;

    fn segment_of(i: usize) -> u32 {
        match i {
            0..32 if i.is_multiple_of(3) => 0,
            0..32 => 1,
            32..COUNT => 2,
            _ => 3,
        }
    }

    /// Two columns, each with its low part: numbers of all sizes, whose sums need both.
    fn number(column: usize, i: usize) -> [f32; 2] {
        let number = (i as f64 - 17.3) * 10f64.powi((i % 7) as i32) + 1.0 / (column + i + 1) as f64;
        [number as f32, (number - f64::from(number as f32)) as f32]
    }

    #[test]
    fn sums_of_segments_are_separate_and_have_fourteen_digits() {
        let partition = Partition { segments: 3, chunk: chunk_of(COUNT) };
        assert_eq!((partition.chunk, partition.lanes()), (32, 2));
        let terms = [Term { column: 0, rest: Some(1) }, Term { column: 2, rest: Some(3) }];
        let kernels = of_columns(Group::Accounts, &terms, (partition, 1), STRIDE).unwrap();
        let columns: Vec<f32> = (0..4)
            .flat_map(|k| (0..STRIDE).map(move |i| if i < COUNT { number(k / 2, i)[k % 2] } else { f32::NAN }))
            .collect();
        let of_particles: Vec<u32> = (0..STRIDE).map(segment_of).collect();
        let mut buffers = [
            whole(&SEGMENTS),
            whole(&of_particles),
            columns,
            vec![0.0; 2 * 3 * partition.lanes() * partition.segments],
        ];
        Evaluation::default().run(&kernels[0].kernel, &mut buffers, (partition.segments * partition.lanes()) as u32);
        let mut sums = [buffers[3].clone(), vec![0.0; 2 * 3 * partition.segments]];
        let kernel = of_lanes(partition.lanes(), STRIDE).unwrap().kernel;
        Evaluation::default().run(&kernel, &mut sums, 3 * partition.segments as u32);
        for segment in 0..3 {
            let found = |sum: usize| -> f64 {
                let at = 2 * (sum * partition.segments + segment);
                f64::from(sums[1][at]) + f64::from(sums[1][at + 1])
            };
            // The first sum is of others.
            assert_eq!(found(0), 0.0);
            for column in 0..2 {
                let of = || (0..COUNT).filter(|i| segment_of(*i) == segment as u32);
                let value = |i: usize| number(column, i).map(f64::from).iter().sum::<f64>();
                let (expected, size) = (of().map(value).sum::<f64>(), of().map(|i| value(i).abs()).sum::<f64>());
                let off = (found(1 + column) - expected).abs();
                assert!(off < 1e-14 * size, "{segment}, {column}: {expected}, {off:e} off");
            }
        }
    }

    #[test]
    fn chunk_length_depends_on_the_number_of_particles() {
        let lengths = [1, 32, 570, 4096, 65_535, 65_536, 16_000_000].map(chunk_of);
        assert_eq!(lengths, [32, 32, 32, 64, 512, 1024, 1024]);
    }
}
