//! Conduction in the total Lagrangian form: sums over the initial neighbours at the initial positions, whose formulas are those of
//! [`sphorge_physics::conduction`].

use super::CpuEngine;
use super::conduction::Table;
use super::contact::Places;
use super::total_lagrangian::Reference;
use crate::lanes::PairScalar;
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::conduction::{Inflow, add_temperature_gradient, added_flow, best_flow};
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::{Vector, tensor::dot};

/// What a flow is summed from.
#[derive(Clone, Copy)]
pub(super) struct ReferenceState<'a> {
    pub(super) places: Places<'a>,
    pub(super) particles: &'a Particles,
    pub(super) reference: &'a Reference,
    /// `q B` of every particle, W/m²: what deformation adds.
    pub(super) flow: &'a [Vector<f64>],
}

impl Table {
    /// Gradient of the temperature, K/m, still to be corrected.
    fn temperature_gradient(&self, i: usize, row: &[u32], state: ReferenceState<'_>) -> Vector<f64> {
        let (p, reference) = (state.particles, state.reference);
        let mut gradient = [0.0; 3];
        for &j in row {
            let (source, position, _) = state.places.of(j);
            let x = [0, 1, 2].map(|k| reference.position[i][k] - position[k]);
            let h = pair_smoothing_length(p.smoothing_length[i], p.smoothing_length[source]);
            let slope = self.kernel.slope(self.dimension, dot(x, x).sqrt(), h);
            let difference = p.temperature[source] - p.temperature[i];
            add_temperature_gradient(&mut gradient, reference.volume[source], slope, difference, x);
        }
        gradient
    }

    /// Adds what flows to a particle from its initial neighbours.
    pub(super) fn add_reference(&self, sum: &mut Inflow<f64>, i: usize, row: &[u32], state: ReferenceState<'_>) {
        let (p, reference) = (state.particles, state.reference);
        let better = best_flow(&reference.deformation[i]);
        for &j in row {
            let (source, position, sign) = state.places.of(j);
            let x = [0, 1, 2].map(|k| reference.position[i][k] - position[k]);
            let h = pair_smoothing_length(p.smoothing_length[i], p.smoothing_length[source]);
            let flow = [0, 1, 2].map(|k| state.flow[i][k] + sign[k] * state.flow[source][k]);
            let volumes = (reference.volume[i], reference.volume[source]);
            let difference = p.temperature[source] - p.temperature[i];
            let pair = self.pair((p.body[i], p.body[source]), volumes, dot(x, x), h, difference);
            sum.add_reference(&pair, x, flow, better, self.dimension);
        }
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// `q B` of every particle at its temperature; nothing without a reference configuration.
    pub(super) fn sum_reference_flow(&self, table: &Table, flow: &mut Vec<Vector<f64>>) {
        let Some(reference) = &self.reference else { return };
        let p = &self.particles;
        let places = Places { position: &reference.position, velocity: &p.velocity, ghosts: &self.halo.ghosts };
        flow.resize(p.len(), [0.0; 3]);
        let (list, correction) = (&self.lists.list, &self.work.correction);
        let state = ReferenceState { places, particles: p, reference, flow: &[] };
        flow.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, flow)| {
            let gradient = table.temperature_gradient(i, list.row(i), state);
            let conductivity = table.conductivity[p.body[i] as usize];
            *flow = added_flow(conductivity, gradient, &reference.deformation[i], &correction[i]);
        });
    }
}
