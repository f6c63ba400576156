//! Conduction in the total Lagrangian form: sums over the initial neighbours at the initial positions. The formulas are
//! in [`sphorge_physics::conduction`].

use super::conduction::{Replacements, Shares};
use super::conduction_table::ConductionTable;
use super::ghosts::WithGhosts;
use crate::neighbors::{BLOCK, NeighborList};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::conduction::{Inflow, Surroundings, add_temperature_gradient, added_flow, best_flow};
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::{Tensor, Vector, tensor::dot};

/// The data of particles and ghosts that the sum of the flow reads, in the initial configuration.
#[derive(Clone, Copy)]
pub(super) struct ReferencePoints<'a> {
    position: WithGhosts<'a, Vector<f64>>,
    volume: WithGhosts<'a, f64>,
    smoothing_length: WithGhosts<'a, f64>,
    temperature: WithGhosts<'a, f64>,
    body: WithGhosts<'a, u32>,
    shares: Shares<'a>,
    /// `q b` of every particle, W/m²: the contribution of the deformation.
    flow: WithGhosts<'a, Vector<f64>>,
    deformation: &'a [Tensor<f64>],
}

impl<'a> ReferencePoints<'a> {
    pub(super) fn new(p: &'a Particles, ghosts: &'a Particles, shares: Shares<'a>) -> Self {
        Self {
            shares,
            position: WithGhosts::new(&p.reference_position, &ghosts.reference_position),
            volume: WithGhosts::new(&p.reference_volume, &ghosts.reference_volume),
            smoothing_length: WithGhosts::new(&p.smoothing_length, &ghosts.smoothing_length),
            temperature: WithGhosts::new(&p.temperature, &ghosts.temperature),
            body: WithGhosts::new(&p.body, &ghosts.body),
            flow: WithGhosts::new(&p.heat_flow, &ghosts.heat_flow),
            deformation: &p.deformation,
        }
    }

    /// The initial neighbours of a particle, and of each the distance `X_ij`, m, its square, m², and the smoothing length of the pair, m.
    fn pairs<'r>(&'r self, i: usize, row: &'r [u32]) -> impl Iterator<Item = (usize, Vector<f64>, f64, f64)> {
        let (x_i, h_i) = (self.position.at(i), self.smoothing_length.at(i));
        row.iter().map(move |&j| {
            let x_j = self.position.at(j as usize);
            let x = [0, 1, 2].map(|k| x_i[k] - x_j[k]);
            (j as usize, x, dot(x, x), pair_smoothing_length(h_i, self.smoothing_length.at(j as usize)))
        })
    }
}

impl ConductionTable {
    /// Temperature gradient, K/m, before the correction.
    fn temperature_gradient(&self, i: usize, row: &[u32], points: &ReferencePoints<'_>) -> Vector<f64> {
        let ReferencePoints { volume, temperature, shares, .. } = points;
        let mut gradient = [0.0; 3];
        for (j, x, r2, h) in points.pairs(i, row) {
            let slope = shares.of_pair(i, j) * self.kernel.slope(self.dimension, r2.sqrt(), h);
            let difference = temperature.at(j) - temperature.at(i);
            add_temperature_gradient(&mut gradient, volume.at(j), slope, difference, x);
        }
        gradient
    }

    /// Adds the initial neighbours of a particle to what it sees of its surroundings.
    pub(super) fn see_reference(
        &self,
        surroundings: &mut Surroundings<f64>,
        i: usize,
        row: &[u32],
        points: &ReferencePoints<'_>,
    ) {
        for (j, x, r2, h) in points.pairs(i, row) {
            self.see(surroundings, (points.body.at(i), points.body.at(j)), points.volume.at(j), (r2, h), x);
        }
    }

    /// Adds the heat flow to a particle from its initial neighbours, given what replaces missing pairs.
    pub(super) fn add_reference(
        &self,
        sum: &mut Inflow<f64>,
        i: usize,
        row: &[u32],
        points: &ReferencePoints<'_>,
        replacements: Replacements<'_>,
    ) {
        let ReferencePoints { volume, temperature, body, flow, shares, .. } = points;
        let better = best_flow(&points.deformation[i]);
        let flow_i = flow.at(i);
        for (j, x, r2, h) in points.pairs(i, row) {
            let (share, flow_j) = (shares.of_pair(i, j), flow.at(j));
            let flow = [0, 1, 2].map(|k| share * (flow_i[k] + flow_j[k]));
            let volumes = (volume.at(i), volume.at(j));
            let difference = temperature.at(j) - temperature.at(i);
            let conducts = (share, replacements.of_pair(i, j, x, r2));
            let pair = self.pair((body.at(i), body.at(j)), volumes, (r2, h), difference, conducts);
            sum.add_reference(&pair, x, flow, better, self.dimension);
        }
    }
}

/// `q b` of every particle at its temperature.
pub(super) fn sum_reference_flow(
    table: &ConductionTable,
    list: &NeighborList,
    points: &ReferencePoints<'_>,
    p: &Particles,
    flow: &mut [Vector<f64>],
) {
    flow.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, flow)| {
        let gradient = table.temperature_gradient(i, list.row(i), points);
        let conductivity = table.conductivity[p.body[i] as usize];
        *flow = added_flow(conductivity, gradient, &p.deformation[i], &p.correction[i], table.dimension);
    });
}
