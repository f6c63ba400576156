//! Cells: particles sorted by the cell they are in, in the order of their numbers within it.
//!
//! Cells repeat along each axis after a power of two, so that there is no bounding box to find: what lies a period away is near in the
//! table, and too far in space to count.

use crate::engine::columns::{Binder, Fields, Group, Recording, recording};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_physics::{Real, Vector};

/// Cells that one thread adds up.
pub(in crate::engine) const CHUNK: usize = 256;

/// How cells lie.
#[derive(Clone, Debug)]
pub(in crate::engine) struct Grid {
    /// Corner of cell zero, m.
    pub(in crate::engine) origin: Vector<f64>,
    /// How far particles are searched, in smoothing lengths.
    pub(in crate::engine) reach: f64,
    /// Edge of a cell, m: as far as particles are searched, and a little more.
    pub(in crate::engine) edge: f64,
    /// Cells along each axis until they repeat, powers of two.
    pub(in crate::engine) counts: [u32; 3],
}

impl Grid {
    pub(in crate::engine) fn cells(&self) -> usize {
        self.counts.iter().map(|n| *n as usize).product()
    }

    pub(in crate::engine) fn chunks(&self) -> usize {
        self.cells().div_ceil(CHUNK)
    }

    /// Steps to the cells around one, and to itself, three numbers each; negative ones count from `2^32` down.
    pub(in crate::engine) fn around(&self) -> Vec<u32> {
        let steps = |axis: usize| if self.counts[axis] == 1 { vec![0] } else { vec![u32::MAX, 0, 1] };
        let mut around = Vec::new();
        for z in steps(2) {
            for y in steps(1) {
                for x in steps(0) {
                    around.extend([x, y, z]);
                }
            }
        }
        around
    }

    /// The cell along each axis that a place is in, before it repeats.
    pub(in crate::engine) fn steps(&self, place: &impl Fn(usize) -> Recorded) -> [Index; 3] {
        [0, 1, 2].map(|axis| {
            if self.counts[axis] == 1 {
                return Index::of(0);
            }
            let inverse = Recorded::of(1.0 / self.edge);
            Index::floor((place(axis) - Recorded::of(self.origin[axis])) * inverse)
        })
    }

    /// The number of the cell so many steps along each axis.
    pub(in crate::engine) fn cell(&self, steps: [Index; 3]) -> Index {
        let [x, y, z] = [0, 1, 2].map(|axis| steps[axis].and(Index::of(self.counts[axis] - 1)));
        (z * Index::of(self.counts[1]) + y) * Index::of(self.counts[0]) + x
    }
}

/// Who is sorted into the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Sorted {
    /// All particles, where they are.
    Particles,
    /// Those of the surface, where they stand for the contact.
    Surface,
}

/// How many threads a kernel of the sorting has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum SortingThreads {
    Of(usize),
    /// As many as there are particles to sort.
    OfSorted,
}

impl Sorted {
    /// Name of a kernel.
    fn name(self, of: &str) -> String {
        match self {
            Self::Particles => of.to_owned(),
            Self::Surface => format!("{of}_of_surface"),
        }
    }

    /// The particle of a thread, and its cell.
    fn cell(self, bind: &mut Binder<'_>, grid: &Grid, thread: Index) -> (Index, Index) {
        let (i, place) = match self {
            Self::Particles => (thread, bind.read(Group::Place)),
            Self::Surface => (bind.indices(Group::Surface).at(thread), bind.read(Group::Standing)),
        };
        (i, grid.cell(grid.steps(&|axis| place.get(axis, i))))
    }
}

/// The kernels, in their order, of columns of a length.
pub(in crate::engine) fn sorting(
    grid: &Grid,
    count: usize,
    of: Sorted,
) -> Result<Vec<(Recording, SortingThreads)>, KernelFault> {
    let cells = grid.cells();
    let clear = recording(&of.name("clear_cells"), count, |bind, cell| {
        let counts = bind.index_output(Group::CellCounts);
        counts.set(cell, Index::of(0));
    })?;
    let counting = recording(&of.name("count_in_cells"), count, |bind, thread| {
        let (i, cell) = of.cell(bind, grid, thread);
        let (counts, slots) = (bind.counters(Group::CellCounts), bind.index_output(Group::Slots));
        slots.set(i, counts.count(cell));
    })?;
    let last = |chunk: Index| (chunk * Index::of(CHUNK as u32), CHUNK as u32);
    // The table of cells is as long as whole chunks, so that no chunk ends early.
    let chunk_sums = recording(&of.name("add_up_chunks"), count, |bind, chunk| {
        let (counts, sums) = (bind.indices(Group::CellCounts), bind.write(Group::ChunkStarts));
        let (first, length) = last(chunk);
        let sum = bind
            .scope
            .fold(first, first + Index::of(length), Recorded::zero(), |_, sum, cell| sum + counts.at(cell).number());
        sums.set(0, chunk, sum);
    })?;
    let chunk_starts = recording(&of.name("start_chunks"), count, |bind, one| {
        let sums = bind.write(Group::ChunkStarts);
        let end = one + Index::of(grid.chunks() as u32);
        let total = bind.scope.fold(one, end, Recorded::zero(), |_, start, chunk| {
            let sum = sums.get(0, chunk);
            sums.set(0, chunk, start);
            start + sum
        });
        sums.set(0, end, total);
    })?;
    let starts = recording(&of.name("start_cells"), count, |bind, chunk| {
        let (counts, sums) = (bind.indices(Group::CellCounts), bind.read(Group::ChunkStarts));
        let starts = bind.index_output(Group::CellStarts);
        let (first, length) = last(chunk);
        let end = first + Index::of(length);
        let total = bind.scope.fold(first, end, sums.get(0, chunk), |_, start, cell| {
            starts.set(cell, Index::floor(start));
            start + counts.at(cell).number()
        });
        // The next chunk says the same.
        starts.set(end, Index::floor(total));
    })?;
    let scatter = recording(&of.name("scatter"), count, |bind, thread| {
        let (i, cell) = of.cell(bind, grid, thread);
        let (starts, slots) = (bind.indices(Group::CellStarts), bind.indices(Group::Slots));
        let unsorted = bind.index_output(Group::Unsorted);
        unsorted.set(starts.at(cell) + slots.at(i), i);
    })?;
    let rank = recording(&of.name("rank"), count, |bind, thread| {
        let (i, cell) = of.cell(bind, grid, thread);
        let starts = bind.indices(Group::CellStarts);
        let (unsorted, sorted) = (bind.indices(Group::Unsorted), bind.index_output(Group::Sorted));
        let (first, end) = (starts.at(cell), starts.at(cell + Index::of(1)));
        let before = bind.scope.fold(first, end, Recorded::zero(), |_, before, k| {
            let (other, own) = (unsorted.at(k).number(), i.number());
            before + Recorded::select_lt(other, own, Recorded::one(), Recorded::zero())
        });
        sorted.set(first + Index::floor(before), i);
    })?;
    let chunks = grid.chunks();
    let padded = chunks * CHUNK;
    debug_assert!(padded >= cells);
    let (of, sorted) = (SortingThreads::Of, SortingThreads::OfSorted);
    Ok(vec![
        (clear, of(padded)),
        (counting, sorted),
        (chunk_sums, of(chunks)),
        (chunk_starts, of(1)),
        (starts, of(chunks)),
        (scatter, sorted),
        (rank, sorted),
    ])
}
