//! Bodies in one place.
//!
//! Two bodies overlap if a particle of one is inside the shape of the other, or if two particles are too near. Bodies that touch
//! leave half a spacing of each between their outermost particles; half of that distance is the limit, which allows for edges
//! that are no multiple of the spacing.

use super::FillError;
use crate::model::{LatticePlacement, Model, Solid};
use std::collections::HashMap;

/// The limit over the distance of touching bodies, less rounding.
const LIMIT: f64 = 0.5 * (1.0 - 1e-6);

/// Axis-aligned bounds: lower and upper corner.
type Bounds = ([f64; 3], [f64; 3]);

/// Points sorted into cells of one edge length.
struct Cells<'a> {
    points: &'a [[f64; 3]],
    edge: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl<'a> Cells<'a> {
    fn new(points: &'a [[f64; 3]], edge: f64) -> Self {
        let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        for (i, point) in points.iter().enumerate() {
            cells.entry(Self::cell(*point, edge)).or_default().push(i as u32);
        }
        Self { points, edge, cells }
    }

    fn cell(point: [f64; 3], edge: f64) -> [i64; 3] {
        point.map(|c| (c / edge).floor() as i64)
    }

    /// Distance from `point` to the nearest of our points, if nearer than one edge.
    fn nearest(&self, point: [f64; 3]) -> Option<f64> {
        let home = Self::cell(point, self.edge);
        let mut least = self.edge * self.edge;
        let mut found = false;
        for step in 0..27 {
            // Cells far out saturate; they may wrap, distances decide.
            let offset = [step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1];
            let cell: [i64; 3] = std::array::from_fn(|k| home[k].wrapping_add(offset[k]));
            for &i in self.cells.get(&cell).into_iter().flatten() {
                let other = self.points[i as usize];
                let squared: f64 = (0..3).map(|k| (point[k] - other[k]).powi(2)).sum();
                if squared < least {
                    least = squared;
                    found = true;
                }
            }
        }
        found.then(|| least.sqrt())
    }
}

fn bounds(points: &[[f64; 3]]) -> Bounds {
    points.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), p| {
        (std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k])))
    })
}

fn within(point: &[f64; 3], (low, high): &Bounds, margin: f64) -> bool {
    (0..3).all(|k| point[k] >= low[k] - margin && point[k] <= high[k] + margin)
}

/// Whether boxes come within a margin of each other.
fn meet(a: &Bounds, b: &Bounds, margin: f64) -> bool {
    (0..3).all(|k| a.0[k] <= b.1[k] + margin && b.0[k] <= a.1[k] + margin)
}

/// Particles in a cell of one spacing from which on a file is refused: those of a third of the spacing. Neighbour lists grow with the square.
const MOST_IN_A_CELL: [usize; 3] = [3, 9, 27];

/// Particles of files that are crowded, the most crowded place of each body.
pub(super) fn check_crowds(positions: &[[f64; 3]], starts: &[usize], model: &Model, errors: &mut Vec<FillError>) {
    let most = MOST_IN_A_CELL[model.dimensions.count() - 1];
    for (body, setup) in model.bodies.iter().enumerate() {
        if !matches!(setup.shape.solid, Solid::Cloud { .. }) {
            continue;
        }
        let points = &positions[starts[body]..starts[body + 1]];
        let cells = Cells::new(points, setup.spacing);
        let crowd = cells.cells.values().filter(|cell| cell.len() > most).max_by_key(|cell| (cell.len(), cell[0]));
        if let Some(cell) = crowd {
            let (position, count) = (points[cell[0] as usize], cell.len());
            errors.push(FillError::Crowded { body, position, count, spacing: setup.spacing });
        }
    }
}

/// Largest share of a spacing that a coordinate may be rounded by.
const ROUNDING: f64 = 1e-6;

/// Bodies whose coordinates are too large for double precision.
pub(super) fn check_distances(positions: &[[f64; 3]], starts: &[usize], model: &Model, errors: &mut Vec<FillError>) {
    for (body, setup) in model.bodies.iter().enumerate() {
        let farthest = ROUNDING / f64::EPSILON * setup.spacing;
        let points = &positions[starts[body]..starts[body + 1]];
        if let Some(&position) = points.iter().find(|x| x.iter().any(|c| c.abs() > farthest)) {
            errors.push(FillError::Far { body, position, spacing: setup.spacing });
        }
    }
}

/// Overlaps that are told: of many bodies in one place every pair would be one.
const TOLD: usize = 20;

/// Bodies that overlap, each pair once; `starts[b]..starts[b + 1]` are the particles of body `b`.
pub(super) fn check_bodies(positions: &[[f64; 3]], starts: &[usize], model: &Model, errors: &mut Vec<FillError>) {
    let of = |body: usize| &positions[starts[body]..starts[body + 1]];
    let boxes: Vec<Bounds> = (0..model.bodies.len()).map(|body| bounds(of(body))).collect();
    let mut told = 0;
    for second in 1..model.bodies.len() {
        for first in 0..second {
            let touching = 0.5 * (model.bodies[first].spacing + model.bodies[second].spacing);
            if told == TOLD || !meet(&boxes[first], &boxes[second], touching) {
                continue;
            }
            let limit = LIMIT * touching;
            let near = |body: usize, other: usize| -> Vec<[f64; 3]> {
                of(body).iter().filter(|p| within(p, &boxes[other], touching)).copied().collect()
            };
            let (ours, theirs) = (near(first, second), near(second, first));
            if ours.is_empty() || theirs.is_empty() {
                continue;
            }
            let cells = Cells::new(&theirs, limit);
            let mut hits: Vec<[f64; 3]> = Vec::new();
            hits.extend(ours.iter().filter(|p| cells.nearest(**p).is_some() || is_inside(**p, first, second, model)));
            hits.extend(theirs.iter().filter(|p| is_inside(**p, second, first, model)));
            if let Some(&position) = hits.first() {
                errors.push(FillError::Overlap { first, second, position, count: hits.len() });
                told += 1;
            }
        }
    }
}

/// Whether a particle of a body is inside the shape of another one.
fn is_inside(point: [f64; 3], body: usize, other: usize, model: &Model) -> bool {
    // Particles at cell centres stay inside their own shape; those on faces lie on it, a quarter of a spacing off where
    // the edge was rounded.
    let share = match model.bodies[body].lattice.placement {
        LatticePlacement::CellCentres => 1e-6,
        LatticePlacement::OnFaces => 0.25 + 1e-6,
    };
    model.bodies[other].shape.contains(point, model.dimensions, -share * model.bodies[body].spacing)
}

/// Particles at one end of a periodic cell that meet those at the other end.
pub(super) fn check_periodic(positions: &[[f64; 3]], bodies: &[u32], model: &Model, errors: &mut Vec<FillError>) {
    let spacing = |i: usize| model.bodies[bodies[i] as usize].spacing;
    let coarsest = model.bodies.iter().map(|b| b.spacing).fold(0.0, f64::max);
    let limit = LIMIT * coarsest;
    for (axis, cell) in model.periodic.iter().enumerate() {
        let Some((low, high)) = *cell else { continue };
        // Bodies that reach out of the cell overlap their images, of course.
        if errors.iter().any(|e| matches!(e, FillError::OutsideCell { axis: a, .. } if *a == axis)) {
            continue;
        }
        let lower: Vec<[f64; 3]> = positions.iter().filter(|p| p[axis] < low + limit).copied().collect();
        let cells = Cells::new(&lower, limit);
        let upper = (0..positions.len()).filter(|&i| positions[i][axis] > high - limit);
        let nearest = upper
            .filter_map(|i| {
                let mut image = positions[i];
                image[axis] -= high - low;
                cells.nearest(image).filter(|&d| d < LIMIT * spacing(i))
            })
            .min_by(f64::total_cmp);
        if let Some(distance) = nearest {
            errors.push(FillError::PeriodicOverlap { axis, distance });
        }
    }
}
