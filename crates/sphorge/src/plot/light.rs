//! Light on the surface of a cloud of particles.
//!
//! A particle at a surface has its neighbours on one side; away from their mean is the normal. It is lit from the upper
//! left, so that a round bar appears round and a top face differs from a side.

use super::mark::Mark;
use rayon::prelude::*;
use sphorge_engine::neighbors::CellGrid;

/// Direction to the light: right, up, towards the eye; of length one.
pub(crate) const LIGHT: [f64; 3] = [-0.36, 0.56, 0.746];
/// Radius of the neighbourhood the normal is taken from, in spacings.
const REACH: f64 = 1.8;
/// Share of the light a surface turned away loses.
pub(crate) const DARKEST: f64 = 0.28;

/// Sets how each mark is lit.
pub(super) fn light(marks: &mut [Mark]) {
    let spacing = marks.iter().map(|mark| mark.spacing).fold(0.0, f64::max);
    if !(spacing > 0.0 && spacing.is_finite()) {
        return;
    }
    let points: Vec<[f64; 3]> = marks.iter().map(|mark| [mark.right, mark.up, mark.towards]).collect();
    let mut grid = CellGrid::default();
    grid.sort(&points, REACH * spacing);
    marks.par_iter_mut().zip(&points).for_each(|(mark, point)| mark.light = brightness(&grid, &points, point, spacing));
}

fn brightness(grid: &CellGrid, points: &[[f64; 3]], point: &[f64; 3], spacing: f64) -> f64 {
    let mut away = [0.0; 3];
    let mut reach = 0.0;
    for (first, last) in grid.runs_around(point) {
        for &j in &grid.order()[first..last] {
            let d: [f64; 3] = std::array::from_fn(|k| point[k] - points[j as usize][k]);
            let distance = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            if distance < REACH * spacing {
                (0..3).for_each(|k| away[k] += d[k]);
                reach += distance;
            }
        }
    }
    let length = away.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length <= 1e-9 * spacing {
        return 1.0;
    }
    let towards_light = (0..3).map(|k| away[k] * LIGHT[k]).sum::<f64>() / length;
    // Inside, the normal is noise: it counts as far as the neighbours lean to one side.
    let surface = (3.0 * length / reach).min(1.0);
    // What faces the eye keeps its colour, so that a flat cut reads like the bar.
    1.0 - surface * DARKEST * (1.0 - (towards_light / LIGHT[2]).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_turned_to_the_light_are_brighter_and_the_inside_is_neutral() {
        let mut marks = Vec::new();
        for i in 0..343 {
            let at = |k: usize| (k % 7) as f64;
            let (right, up, towards) = (at(i), at(i / 7), at(i / 49));
            marks.push(Mark { right, up, towards, spacing: 1.0, value: 0.0, light: 0.0, body: 0, cell: None });
        }
        light(&mut marks);
        let at = |right: usize, up: usize, towards: usize| marks[right + 7 * up + 49 * towards].light;
        let (inside, front, top, right) = (at(3, 3, 3), at(3, 3, 6), at(3, 6, 3), at(6, 3, 3));
        assert!(
            inside == 1.0 && (front - 1.0).abs() < 1e-9 && front > top && top > right,
            "{inside} {front} {top} {right}"
        );
    }
}
