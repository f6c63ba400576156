//! Cell grid: particles sorted by cell, and within a cell by index.
//!
//! Cells repeat along each axis after a power of two, so that no bounding box is needed: particles a period away are
//! near in the table, but too far away in space to count.

use crate::engine::columns::{Binder, Group, ReadColumns, ReadShared, Recording, groups, recording};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_physics::{Real, Vector};

/// Cells per thread in the sums, and chunks per thread.
pub(in crate::engine) const CHUNK: usize = 64;

/// Layout of the cells.
#[derive(Clone, Debug)]
pub(in crate::engine) struct Grid {
    /// Corner of cell zero, m.
    pub(in crate::engine) origin: Vector<f64>,
    /// Search distance in smoothing lengths.
    pub(in crate::engine) reach: f64,
    /// Edge of a cell, m: slightly more than the search distance.
    pub(in crate::engine) edge: f64,
    /// Number of cells along each axis until they repeat, powers of two.
    pub(in crate::engine) counts: [u32; 3],
}

impl Grid {
    pub(in crate::engine) fn cells(&self) -> usize {
        self.counts.iter().map(|n| *n as usize).product()
    }

    pub(in crate::engine) fn chunks(&self) -> usize {
        self.cells().div_ceil(CHUNK)
    }

    /// Numbers of chunks, chunks of chunks, and so on to one.
    fn levels(&self) -> Vec<usize> {
        let mut levels = vec![self.chunks()];
        while let Some(count) = levels.last().copied().filter(|count| *count > 1) {
            levels.push(count.div_ceil(CHUNK));
        }
        levels
    }

    /// Index of the sums of each level; the starts follow them.
    fn places(&self) -> Vec<[u32; 2]> {
        let mut place = 0;
        // Whole chunks, whose remaining entries are zero.
        let mut next = |count: &usize| {
            let padded = count.div_ceil(CHUNK) * CHUNK;
            let places = [place, place + padded].map(|place| place as u32);
            place += 2 * padded;
            places
        };
        self.levels().iter().map(&mut next).collect()
    }

    /// Numbers of [`Group::ChunkStarts`].
    pub(in crate::engine) fn sums(&self) -> usize {
        self.levels().iter().map(|count| 2 * count.div_ceil(CHUNK) * CHUNK).sum()
    }

    /// Offsets of the cells around one, and of itself, three numbers each; negative ones count down from `2^32`.
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

    /// The cell along each axis that contains a position, before it repeats.
    pub(in crate::engine) fn steps(&self, place: &impl Fn(usize) -> Recorded) -> [Index; 3] {
        [0, 1, 2].map(|axis| {
            if self.counts[axis] == 1 {
                return Index::of(0);
            }
            let inverse = Recorded::of(1.0 / self.edge);
            Index::floor((place(axis) - Recorded::of(self.origin[axis])) * inverse)
        })
    }

    /// The index of the cell at this offset along each axis.
    pub(in crate::engine) fn cell(&self, steps: [Index; 3]) -> Index {
        let [x, y, z] = [0, 1, 2].map(|axis| steps[axis].and(Index::of(self.counts[axis] - 1)));
        (z * Index::of(self.counts[1]) + y) * Index::of(self.counts[0]) + x
    }
}

/// The particles that are sorted into the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum Sorted {
    /// All particles, at their positions.
    Particles,
    /// The same in the reference configuration.
    Reference,
    /// Those of the surface, at their contact positions.
    Surface,
    /// Those with facets.
    WithFacets,
}

/// Number of threads of a kernel of the sorting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::engine) enum SortingThreads {
    Of(usize),
    /// One per particle to sort.
    OfSorted,
}

impl Sorted {
    /// Name of a kernel.
    fn name(self, of: &str) -> String {
        match self {
            Self::Particles => of.to_owned(),
            Self::Reference => format!("{of}_of_reference"),
            Self::Surface => format!("{of}_of_surface"),
            Self::WithFacets => format!("{of}_with_facets"),
        }
    }

    /// The particle of a thread, and its cell.
    fn cell(self, bind: &mut Binder<'_>, grid: &Grid, thread: Index) -> (Index, Index) {
        let (i, place) = match self {
            Self::Particles => (thread, groups::Place::read(bind).position),
            Self::Reference => (thread, groups::Reference::read(bind).position),
            Self::Surface => (bind.indices(Group::Surface).at(thread), groups::Standing::read(bind).position),
            Self::WithFacets => (bind.indices(Group::Surface).at(thread), groups::Place::read(bind).position),
        };
        (i, grid.cell(grid.steps(&|axis| place.high().axis(axis).get(i))))
    }
}

/// The kernels, in their order, for columns of a length, which may have ghosts behind the particles.
pub(in crate::engine) fn sorting(
    grid: &Grid,
    count: usize,
    of: Sorted,
    has_ghosts: bool,
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
    let chunk_of = |chunk: Index| (chunk * Index::of(CHUNK as u32), CHUNK as u32);
    let (levels, places) = (grid.levels(), grid.places());
    // The table of cells is as long as whole chunks, so that no chunk ends early.
    let chunk_sums = recording(&of.name("add_up_chunks"), count, |bind, chunk| {
        let (counts, sums) = (bind.indices(Group::CellCounts), bind.write(Group::ChunkStarts));
        let (first, length) = chunk_of(chunk);
        let sum = bind
            .scope
            .fold(first, first + Index::of(length), Recorded::zero(), |_, sum, cell| sum + counts.at(cell).number());
        sums.set_at(Index::of(places[0][0]) + chunk, sum);
    })?;
    let mut adding_up = vec![(chunk_sums, levels[0])];
    for level in 1..levels.len() {
        let name = format!("{}_{level}", of.name("add_up_chunks"));
        let kernel = recording(&name, count, |bind, chunk| {
            let sums = bind.write(Group::ChunkStarts);
            let (first, length) = chunk_of(chunk);
            let first = Index::of(places[level - 1][0]) + first;
            let sum =
                bind.scope.fold(first, first + Index::of(length), Recorded::zero(), |_, sum, at| sum + sums.get_at(at));
            sums.set_at(Index::of(places[level][0]) + chunk, sum);
        })?;
        adding_up.push((kernel, levels[level]));
    }
    // The single chunk of the last level starts at zero, the permanent value of its entry.
    for level in (1..levels.len()).rev() {
        let name = format!("{}_{level}", of.name("start_chunks"));
        let kernel = recording(&name, count, |bind, chunk| {
            let sums = bind.write(Group::ChunkStarts);
            let (first, length) = chunk_of(chunk);
            let [own, starts] = places[level - 1].map(Index::of);
            let start = sums.get_at(Index::of(places[level][1]) + chunk);
            bind.scope.fold(first, first + Index::of(length), start, |_, start, below| {
                sums.set_at(starts + below, start);
                start + sums.get_at(own + below)
            });
        })?;
        adding_up.push((kernel, levels[level]));
    }
    let starts = recording(&of.name("start_cells"), count, |bind, chunk| {
        let (counts, sums) = (bind.indices(Group::CellCounts), bind.read(Group::ChunkStarts));
        let starts = bind.index_output(Group::CellStarts);
        let (first, length) = chunk_of(chunk);
        let end = first + Index::of(length);
        let start = sums.get_at(Index::of(places[0][1]) + chunk);
        let total = bind.scope.fold(first, end, start, |_, start, cell| {
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
        // Ghosts that precede the own particles in the common order have the last indices.
        let ghosts_before = has_ghosts.then(|| groups::Step::shared(bind).ghosts_before.value());
        let place = |i: Index| {
            let number = i.number();
            ghosts_before
                .map_or(number, |first| Recorded::select_lt(number, first, number, number - Recorded::of(count as f64)))
        };
        let own = place(i);
        let before = bind.scope.fold(first, end, Recorded::zero(), |_, before, k| {
            before + Recorded::select_lt(place(unsorted.at(k)), own, Recorded::one(), Recorded::zero())
        });
        sorted.set(first + Index::floor(before), i);
    })?;
    let padded = grid.chunks() * CHUNK;
    debug_assert!(padded >= cells);
    let (of, sorted) = (SortingThreads::Of, SortingThreads::OfSorted);
    let adding_up = adding_up.into_iter().map(|(kernel, chunks)| (kernel, of(chunks)));
    let before = [(clear, of(padded)), (counting, sorted)];
    let after = [(starts, of(levels[0])), (scatter, sorted), (rank, sorted)];
    Ok(before.into_iter().chain(adding_up).chain(after).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::Evaluation;
    use std::collections::HashMap;

    #[test]
    fn particles_are_sorted_with_several_levels_of_chunks() {
        let count = 700;
        let grid = Grid { origin: [0.0; 3], reach: 1.0, edge: 1.0, counts: [32; 3] };
        assert_eq!(grid.levels(), [512, 8, 1]);
        let place = |axis: usize, i: usize| ((i * [37, 59, 83][axis]) % 320) as f32 / 10.0 + 0.01;
        let cell = |i: usize| (0..3).rev().fold(0, |cell, axis| 32 * cell + place(axis, i) as usize);
        let mut columns: HashMap<String, Vec<f32>> = HashMap::new();
        columns.insert("Place".into(), (0..3).flat_map(|axis| (0..count).map(move |i| place(axis, i))).collect());
        let lengths = [("CellCounts", 32_768), ("CellStarts", 32_769), ("ChunkStarts", grid.sums())];
        for (group, length) in lengths.into_iter().chain([("Slots", count), ("Unsorted", count), ("Sorted", count)]) {
            columns.insert(group.to_owned(), vec![0.0; length]);
        }
        // Twice, to show that results of the first time do not interfere.
        for _ in 0..2 {
            for (recording, threads) in sorting(&grid, count, Sorted::Particles, false).unwrap() {
                let names: Vec<_> = recording.groups.iter().map(|group| format!("{group:?}")).collect();
                let mut buffers: Vec<_> = names.iter().map(|name| columns[name].clone()).collect();
                let threads = match threads {
                    SortingThreads::Of(threads) => threads,
                    SortingThreads::OfSorted => count,
                };
                Evaluation::default().run(&recording.kernel, &mut buffers, threads as u32);
                columns.extend(names.into_iter().zip(buffers));
            }
            let whole = |group: &str| columns[group].iter().map(|bits| bits.to_bits() as usize).collect::<Vec<_>>();
            let mut expected: Vec<_> = (0..count).collect();
            expected.sort_by_key(|i| (cell(*i), *i));
            assert_eq!(whole("Sorted"), expected);
            let before = |of: usize| (0..count).filter(|i| cell(*i) < of).count();
            let starts = whole("CellStarts");
            for of in (0..32_769).step_by(511).chain([32_768]) {
                assert_eq!(starts[of], before(of), "cell {of}");
            }
        }
    }
}
