//! Choice of the ghost particles: particles of other ranks that may be near one of the own particles.
//!
//! Each rank sends the others the cells that contain its particles; another rank sends it the particles in these cells
//! and the ones around them.

use sphorge_engine::RunFailure;
use sphorge_engine::ranks::Ranks;
use sphorge_physics::Vector;
use std::collections::{HashMap, HashSet};

/// Cells as wide as the search distance, along the axes over which particles are spread; along periodic axes they
/// repeat.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    edge: [f64; 3],
    origin: [f64; 3],
    periodic: [Option<i64>; 3],
    axes: usize,
}

type Cell = [i64; 3];

impl Cells {
    /// At least `reach` wide, m. `ends` are those of periodic axes, m.
    pub(super) fn new(reach: f64, axes: usize, ends: [Option<(f64, f64)>; 3]) -> Self {
        let mut cells = Self { edge: [reach; 3], origin: [0.0; 3], periodic: [None; 3], axes };
        for (axis, (low, high)) in ends.iter().enumerate().filter_map(|(axis, ends)| Some((axis, (*ends)?))) {
            let count = ((high - low) / reach).floor().max(1.0);
            cells.edge[axis] = (high - low) / count;
            cells.origin[axis] = low;
            cells.periodic[axis] = Some(count as i64);
        }
        cells
    }

    fn of(&self, place: &Vector<f64>) -> Cell {
        let along = |axis: usize| ((place[axis] - self.origin[axis]) / self.edge[axis]).floor() as i64;
        [0, 1, 2].map(|axis| if axis < self.axes { self.wrapped(axis, along(axis)) } else { 0 })
    }

    fn wrapped(&self, axis: usize, along: i64) -> i64 {
        self.periodic[axis].map_or(along, |count| along.rem_euclid(count))
    }

    /// A cell and those around it.
    fn around(&self, cell: Cell) -> impl Iterator<Item = Cell> + '_ {
        let steps = |axis: usize| if axis < self.axes { -1..=1 } else { 0..=0 };
        steps(0)
            .flat_map(move |x| steps(1).flat_map(move |y| steps(2).map(move |z| [x, y, z])))
            .map(move |by| [0, 1, 2].map(|axis| self.wrapped(axis, cell[axis] + by[axis])))
    }
}

/// The own particles that each other rank has to know, ascending, if neighbours of its own particles are searched in
/// each of these sets of positions.
///
/// # Errors
/// A rank is lost.
pub(super) fn read_by_others(
    ranks: &Ranks,
    cells: &Cells,
    sets: &[Vec<Vector<f64>>],
) -> Result<Vec<Vec<u32>>, RunFailure> {
    let mut read_by: Vec<HashSet<u32>> = vec![HashSet::new(); ranks.size()];
    for places in sets {
        let of_own: Vec<Cell> = places.iter().map(|place| cells.of(place)).collect();
        let mut own = of_own.clone();
        own.sort_unstable();
        own.dedup();
        let counts = ranks.gather_one(own.len())?;
        let coordinates: Vec<[u64; 3]> = own.iter().map(|cell| cell.map(|along| along as u64)).collect();
        let all = ranks.gather(&coordinates, &counts)?;
        // The ranks that search in each cell of this rank.
        let mut lookers: HashMap<Cell, Vec<usize>> = own.iter().map(|cell| (*cell, Vec::new())).collect();
        let mut rest = &all[..];
        for (rank, count) in counts.into_iter().enumerate() {
            let (of_rank, behind) = rest.split_at(count);
            rest = behind;
            if rank == ranks.rank() {
                continue;
            }
            for cell in of_rank.iter().map(|cell| cell.map(|along| along as i64)) {
                for near in cells.around(cell) {
                    if let Some(lookers) = lookers.get_mut(&near)
                        && lookers.last() != Some(&rank)
                    {
                        lookers.push(rank);
                    }
                }
            }
        }
        for (i, cell) in of_own.iter().enumerate() {
            for rank in lookers.get(cell).into_iter().flatten() {
                read_by[*rank].insert(i as u32);
            }
        }
    }
    let ascending = |of: HashSet<u32>| {
        let mut of: Vec<u32> = of.into_iter().collect();
        of.sort_unstable();
        of
    };
    Ok(read_by.into_iter().map(ascending).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_cells_of_a_periodic_axis_repeat() {
        // Six cells of 1.05 m from 0.2 m on.
        let cells = Cells::new(1.0, 2, [Some((0.2, 6.5)), None, None]);
        assert_eq!(cells.of(&[0.3, -0.5, 9.0]), [0, -1, 0]);
        assert_eq!((cells.of(&[6.4, 0.5, 0.0]), cells.of(&[6.6, 0.5, 0.0])), ([5, 0, 0], [0, 0, 0]));
        assert_eq!(cells.of(&[0.1, 0.5, 0.0]), [5, 0, 0]);
        let mut around: Vec<_> = cells.around([0, 7, 0]).collect();
        around.sort_unstable();
        let expected = [[0, 6], [0, 7], [0, 8], [1, 6], [1, 7], [1, 8], [5, 6], [5, 7], [5, 8]].map(|[x, y]| [x, y, 0]);
        assert_eq!(around, expected);
    }
}
