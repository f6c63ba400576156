//! Particles of a table that are so close, or so unlike in mass, that a slip is more likely than an intention.

use sphorge_engine::Particles;
use sphorge_engine::model::{Dimensions, Model, Solid};

/// Share of a spacing below which two particles of a table are told as one.
const CLOSEST: f64 = 1e-3;
/// How many times the mass of another a particle of a body has without a word.
const HEAVIEST: f64 = 1e3;
/// Cells along a spacing: few enough that each has a particle or none.
const CELLS: f64 = 4.0;

/// One sentence for each body of a table that has particles too close to each other, or much heavier than others.
pub(crate) fn notes(model: &Model, particles: &Particles) -> Vec<String> {
    let mut notes = Vec::new();
    for (index, body) in model.bodies.iter().enumerate() {
        if !matches!(body.shape.solid, Solid::Cloud { .. }) {
            continue;
        }
        let own: Vec<usize> = (0..particles.body.len()).filter(|&i| particles.body[i] as usize == index).collect();
        let positions: Vec<[f64; 3]> = own.iter().map(|&i| particles.position[i]).collect();
        if let Some((a, distance)) = closest(&positions, body.spacing, CLOSEST * body.spacing) {
            let [x, y, z] = positions[a].map(|c| format!("{:.4}", c * 1e3));
            notes.push(format!(
                "body `{}`: two particles are {:.1e} m apart at ({x}, {y}, {z}) mm, {:.0e} of the spacing: remove one of them",
                body.name,
                distance,
                distance / body.spacing
            ));
        }
        let masses = || own.iter().map(|&i| particles.mass[i]);
        let (least, most) = masses().fold((f64::INFINITY, 0.0f64), |(least, most), m| (least.min(m), most.max(m)));
        if most > HEAVIEST * least {
            let unit = match model.dimensions {
                Dimensions::One => "kg/m^2",
                Dimensions::PlaneStrain => "kg/m",
                Dimensions::Three => "kg",
            };
            notes.push(format!(
                "body `{}`: its particles have masses from {least:.3e} to {most:.3e} {unit}; heavy particles among light ones pass through them: check \
                 the column of masses",
                body.name
            ));
        }
    }
    notes
}

/// The closest two of some points that are nearer than `limit`: the first of them and their distance. `limit` is less than a cell.
fn closest(points: &[[f64; 3]], spacing: f64, limit: f64) -> Option<(usize, f64)> {
    let edge = spacing / CELLS;
    let cell = |x: [f64; 3]| x.map(|c| (c / edge).floor() as i64);
    let mut sorted: Vec<([i64; 3], usize)> = points.iter().enumerate().map(|(i, x)| (cell(*x), i)).collect();
    sorted.sort_unstable();
    let mut found: Option<(usize, f64)> = None;
    for &(own, i) in &sorted {
        let x = points[i];
        // Cells that a point within the limit may be in: mostly its own alone.
        let (low, high) = (cell(x.map(|c| c - limit)), cell(x.map(|c| c + limit)));
        for cx in low[0]..=high[0] {
            for cy in low[1]..=high[1] {
                for cz in low[2]..=high[2] {
                    let there = [cx, cy, cz];
                    // Each pair once.
                    if there < own {
                        continue;
                    }
                    let from = sorted.partition_point(|(cell, _)| *cell < there);
                    for &(_, j) in sorted[from..].iter().take_while(|(cell, _)| *cell == there) {
                        let d: f64 = (0..3).map(|k| (x[k] - points[j][k]).powi(2)).sum::<f64>().sqrt();
                        if j != i && d < limit && found.is_none_or(|(_, least)| d < least) {
                            found = Some((i.min(j), d));
                        }
                    }
                }
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closest_two_are_found_across_cells_and_within() {
        let lattice = (0..1000).map(|k| [(k % 10) as f64, (k / 10 % 10) as f64, (k / 100) as f64]);
        let mut points: Vec<[f64; 3]> = lattice.collect();
        assert_eq!(closest(&points, 1.0, 1e-3), None);
        // On both sides of a face of a cell, and in one.
        for (x, d) in [(2.0, 1e-9), (2.125, 1e-9), (-0.25, 1e-9), (3.0, 9e-4)] {
            points.truncate(1000);
            points.extend([[x - 0.5 * d, 0.5, 0.5], [x + 0.5 * d, 0.5, 0.5]]);
            let (first, distance) = closest(&points, 1.0, 1e-3).unwrap();
            assert_eq!(first, 1000);
            assert!((distance - d).abs() < 1e-3 * d, "{distance}");
        }
        points.truncate(1000);
        points.extend([[0.5; 3], [0.5, 0.5, 0.502]]);
        assert_eq!(closest(&points, 1.0, 1e-3), None);
    }
}
