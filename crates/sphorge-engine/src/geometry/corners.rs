//! The corners of the cells of particles in the initial configuration.

use super::fill::pattern;
use crate::model::Model;
use sphorge_physics::Vector;

/// Corners of the cells of all particles that fill the bodies of a model, by the number of the particle: m, from the particle. Bit `k` of a
/// corner's number is its side along axis `k` of the cell.
pub fn cell_corners(model: &Model) -> Vec<[Vector<f64>; 8]> {
    let mut all = Vec::new();
    for body in &model.bodies {
        pattern(model, body).for_each_cell(&body.shape, |site, _, cell| all.push(cell.corners(site, model.dimensions)));
    }
    all
}
