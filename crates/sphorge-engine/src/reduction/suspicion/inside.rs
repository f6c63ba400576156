//! Particles that lie in another body.

use super::CHUNK;
use crate::model::Model;
use crate::neighbors::{CellGrid, bounds};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::Vector;
use sphorge_physics::tensor::{apply, dot, identity, inverse};

/// Stretch beyond which the deformation of a particle is not taken for the shape of its cell.
const LARGEST_STRETCH: f64 = 8.0;
/// Integrity below which a particle belongs to a crack, whose material has no place of its own.
const WHOLE: f64 = 0.5;

/// How deep particles lie in cells of other bodies.
pub(super) struct Inside(Vec<f64>);

impl Inside {
    /// Looks for particles whose centre lies within half a spacing of one of another body, as it was before the deformation of that one: in the ball
    /// that its cell holds, whatever the lattice. At faces that press each other centres are half a cell away from the cells of the other body,
    /// unless the pressure is as large as the modulus: two particles of outermost layers do not count.
    ///
    /// Bodies that have come apart have no cells any more.
    pub(super) fn find(model: &Model, p: &Particles) -> Self {
        let mut inside = Self(vec![0.0; p.len()]);
        if p.deformation.is_empty() || model.bodies.len() < 2 {
            return inside;
        }
        let mut has_cells = vec![true; model.bodies.len()];
        for (&body, earlier) in p.body.iter().zip(&p.earlier_deformation) {
            has_cells[body as usize] &= *earlier == identity();
        }
        let spacing = |i: usize| model.bodies[p.body[i] as usize].spacing;
        // How far the cell of a particle may extend, m.
        let reach_of = |j: usize| {
            let stretch = p.deformation[j].iter().map(|&row| dot(row, row)).sum::<f64>().sqrt();
            let has_cell = has_cells[p.body[j] as usize] && stretch <= LARGEST_STRETCH;
            if has_cell { 0.5 * stretch * spacing(j) } else { 0.0 }
        };
        let is_outermost = |i: usize| p.reference_normal.get(i).is_some_and(|normal| *normal != [0.0; 3]);
        let is_whole = |i: usize| p.history.integrity_of(i) > WHOLE;
        let looked_at = || (0..p.len()).into_par_iter().with_min_len(CHUNK).filter(|&i| is_whole(i));
        let reach = looked_at().map(reach_of).reduce(|| 0.0, f64::max);
        if !(reach > 0.0 && reach.is_finite()) {
            return inside;
        }
        let boxes = Boxes::of(model, p, reach);
        let near: Vec<usize> = looked_at().filter(|&i| boxes.are_several(p, i)).collect();
        let places: Vec<Vector<f64>> = near.iter().map(|&i| p.position[i]).collect();
        let mut grid = CellGrid::default();
        grid.sort(&places, reach);
        let depth = |&i: &usize| {
            let mut deepest = 0.0_f64;
            for (begin, end) in grid.runs_around(&p.position[i]) {
                for j in grid.order()[begin..end].iter().map(|&k| near[k as usize]) {
                    if p.body[j] == p.body[i] || is_outermost(i) && is_outermost(j) {
                        continue;
                    }
                    let away: Vector<f64> = std::array::from_fn(|a| p.position[i][a] - p.position[j][a]);
                    if dot(away, away) >= reach_of(j).powi(2) {
                        continue;
                    }
                    let before = apply(&inverse(&p.deformation[j]), away);
                    deepest = deepest.max(1.0 - 2.0 * dot(before, before).sqrt() / spacing(j));
                }
            }
            deepest
        };
        let depths: Vec<f64> = near.par_iter().with_min_len(256).map(depth).collect();
        near.iter().zip(depths).for_each(|(&i, depth)| inside.0[i] = depth);
        inside
    }

    /// How deep a particle lies: zero outside, one in the centre of a particle of another body.
    pub(super) fn depth(&self, i: usize) -> f64 {
        self.0[i]
    }
}

/// What bodies and the cells at their surfaces extend over, m.
struct Boxes(Vec<(Vector<f64>, Vector<f64>)>);

impl Boxes {
    fn of(model: &Model, p: &Particles, reach: f64) -> Self {
        let mut places = vec![Vec::new(); model.bodies.len()];
        for (&body, x) in p.body.iter().zip(&p.position) {
            places[body as usize].push(*x);
        }
        let wider = |(low, high): (Vector<f64>, Vector<f64>)| (low.map(|x| x - reach), high.map(|x| x + reach));
        Self(places.iter().filter(|places| !places.is_empty()).map(|places| wider(bounds(places))).collect())
    }

    /// Whether a particle lies in the boxes of two bodies, one of which is its own: of the others nobody can lie in anything.
    fn are_several(&self, p: &Particles, i: usize) -> bool {
        let holds = |(low, high): &&(Vector<f64>, Vector<f64>)| {
            (0..3).all(|a| low[a] <= p.position[i][a] && p.position[i][a] <= high[a])
        };
        self.0.iter().filter(holds).nth(1).is_some()
    }
}
