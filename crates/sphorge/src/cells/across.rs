//! Which particle is across each face of a cell at the start.

use super::{NONE, corners_of_face, length, minus};
use rayon::prelude::*;
use sphorge_engine::neighbors::CellGrid;

/// How far a neighbour may be from where the shape of a cell puts it, in distances from there: rings of cells are not in rows.
const OFF: f64 = 0.6;

/// How far somebody behind a face is from its middle at most: in the same distances, and in distances from there to its corners, which are longer where few
/// wedges meet at an axis.
const BEHIND: f64 = 0.9;
const BESIDE: f64 = 1.25;

/// The particles of the same body across the faces of the cells, of which there may be none.
pub(super) fn across(
    start: &[[f64; 3]],
    corners: &[[[f64; 3]; 8]],
    bodies: &[f32],
    dimensions: usize,
) -> Vec<[u32; 6]> {
    let ways: Vec<[[f64; 3]; 6]> = corners.par_iter().map(|corners| ways(corners, dimensions)).collect();
    let reaches: Vec<[f64; 6]> =
        corners.par_iter().zip(&ways).map(|(corners, ways)| reaches(corners, ways, dimensions)).collect();
    let longest = ways.as_flattened().iter().map(|way| length(*way)).fold(0.0, f64::max);
    if longest <= 0.0 {
        return vec![[NONE; 6]; start.len()];
    }
    // Nobody farther away is across or behind a face.
    let farthest =
        ((1.0 + OFF) * longest).max(0.5 * longest + reaches.as_flattened().iter().copied().fold(0.0, f64::max));
    let mut grid = CellGrid::default();
    grid.sort(start, farthest);
    let of = |i: usize| -> [u32; 6] {
        let mut best = ways[i].map(|way| (OFF * length(way), NONE));
        // Where rings of few cells meet there may be nobody there, but somebody behind the face all the same.
        let mut behind = reaches[i].map(|reach| (reach, NONE));
        for (first, last) in grid.runs_around(&start[i]) {
            for &j in &grid.order()[first..last] {
                if j as usize == i || bodies[j as usize] != bodies[i] {
                    continue;
                }
                let to = minus(start[j as usize], start[i]);
                if length(to) > farthest {
                    continue;
                }
                for (way, (best, behind)) in ways[i].iter().zip(best.iter_mut().zip(&mut behind)) {
                    let off = length(minus(to, *way));
                    if off < best.0 {
                        *best = (off, j);
                    }
                    let off = length(minus(to, way.map(|x| 0.5 * x)));
                    let along: f64 = (0..3).map(|k| to[k] * way[k]).sum();
                    if off < behind.0 && along > 0.5 * length(*way).powi(2) {
                        *behind = (off, j);
                    }
                }
            }
        }
        std::array::from_fn(|face| if best[face].1 == NONE { behind[face].1 } else { best[face].1 })
    };
    (0..start.len()).into_par_iter().map(of).collect()
}

/// How far from the middle of each face somebody behind it may be.
fn reaches(corners: &[[f64; 3]; 8], ways: &[[f64; 3]; 6], dimensions: usize) -> [f64; 6] {
    std::array::from_fn(|face| {
        if face / 2 >= dimensions {
            return 0.0;
        }
        let middle = ways[face].map(|x| 0.5 * x);
        let side =
            corners_of_face(face, 1 << dimensions).map(|k| length(minus(corners[k], middle))).fold(0.0, f64::max);
        (BEHIND * length(ways[face])).max(BESIDE * side)
    })
}

/// From a particle to those across the faces of its cell, if they have the same shape: twice the way to the middle of each face.
fn ways(corners: &[[f64; 3]; 8], dimensions: usize) -> [[f64; 3]; 6] {
    std::array::from_fn(|face| {
        // Across an axis that is not there nobody is.
        if face / 2 >= dimensions {
            return [0.0; 3];
        }
        let each = 1 << dimensions;
        let count = corners_of_face(face, each).count() as f64;
        std::array::from_fn(|a| corners_of_face(face, each).map(|k| 2.0 * corners[k][a]).sum::<f64>() / count)
    })
}
