//! Cells are drawn no longer than what is beside them lets them be.
//!
//! The deformation gradient of a particle that was torn off its neighbours, or whose neighbours have lost their integrity, is that of a motion with nothing in
//! between: metal is not as long as it says.

use super::{Deformation, JoinedCells, NONE, length, minus};
use rayon::prelude::*;

/// A cell that nobody is beside any more is drawn by its deformation gradient up to this stretch.
const ALONE: f64 = 2.0;
/// Between particles a cell is no longer than so many distances to the farther of those across two faces on opposite sides. The gradient is a mean over
/// more than these.
const BESIDE: f64 = 1.5;
/// They count as far as they are no farther from where the gradient puts them than this share of the way there.
const THERE: f64 = 1.0;
/// Ways to the sides of a cell that are as near to a plane as this have no inverse.
const FLAT: f64 = 1e-6;

impl JoinedCells {
    /// The deformation of cells that are at places, m, as they are drawn.
    pub(super) fn supported(&self, now: &[[f64; 3]], deformation: &Deformation) -> Deformation {
        let mut drawn = deformation.clone();
        let (cells, _) = drawn.gradient.as_chunks_mut::<9>();
        cells.par_iter_mut().enumerate().for_each(|(cell, f)| {
            // A bound on any stretch.
            let is_short = f.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() <= ALONE * ALONE;
            if !is_short && let Some(shorter) = self.shorter(cell, now, deformation) {
                *f = std::array::from_fn(|k| shorter[k / 3][k % 3] as f32);
            }
        });
        drawn
    }

    /// The deformation gradient of a cell that is shorter along its own axes; none where it is not too long.
    fn shorter(&self, cell: usize, now: &[[f64; 3]], deformation: &Deformation) -> Option<[[f64; 3]; 3]> {
        let f = deformation.of(cell as u32);
        let ways = self.ways(cell);
        let shares: [f64; 3] = std::array::from_fn(|axis| {
            let way = times(&f, ways[axis]);
            let long = length(way);
            let sides = [(way.map(|x| -x), self.across[cell][2 * axis]), (way, self.across[cell][2 * axis + 1])];
            // Where nobody was at the start nobody is missed.
            if sides.iter().all(|(_, other)| *other == NONE) {
                return 1.0;
            }
            let there = sides.iter().filter(|(_, other)| *other != NONE && !deformation.is_severed(*other));
            let apart = there.map(|(way, other)| {
                let to = minus(now[*other as usize], now[cell]);
                if length(minus(to, *way)) <= THERE * long { length(to) } else { 0.0 }
            });
            let most = (ALONE * length(ways[axis])).max(BESIDE * apart.fold(0.0, f64::max));
            if long > most { most / long } else { 1.0 }
        });
        if shares == [1.0; 3] {
            return None;
        }
        // In the axes of the cell each column is shorter by its share: the gradient times ways, shares, and the inverse of the ways.
        let normals: [[f64; 3]; 3] = std::array::from_fn(|k| cross(ways[(k + 1) % 3], ways[(k + 2) % 3]));
        let volume = dot(ways[0], normals[0]);
        if volume.abs() <= FLAT * ways.map(length).iter().product::<f64>() {
            let least = shares.into_iter().fold(1.0, f64::min);
            return Some(f.map(|row| row.map(|x| least * x)));
        }
        let columns = [0, 1, 2].map(|k| times(&f, ways[k].map(|x| shares[k] * x / volume)));
        let entry = |a: usize, b: usize| (0..3).map(|k| columns[k][a] * normals[k][b]).sum();
        Some(std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b))))
    }

    /// From side to side of a cell at the start along its own axes, m; a unit along one that the problem lacks.
    fn ways(&self, cell: usize) -> [[f64; 3]; 3] {
        let mut ways = [[0.0; 3]; 3];
        for corner in 0..self.corners {
            let members = self.members(self.of[self.corners * cell + corner] as usize);
            let own = members.iter().find(|own| own.cell as usize == cell && usize::from(own.corner) == corner);
            let Some(own) = own else { continue };
            for (axis, way) in ways.iter_mut().enumerate() {
                let side = if corner >> axis & 1 == 1 { 2.0 } else { -2.0 } / self.corners as f64;
                (0..3).for_each(|a| way[a] += side * f64::from(own.arm[a]));
            }
        }
        if self.corners == 4 {
            ways[2] = [0.0, 0.0, 1.0];
        }
        ways
    }
}

fn times(f: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    f.map(|row| dot(row, v))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}
