//! Conduction in the total Lagrangian form: sums over the initial neighbours at the initial positions `X`.
//!
//! Per initial volume heat flows with `k J C^-1 grad_0 T`, `C = F^T F`, and `rho_0 c dT/dt` is the divergence of that. The part of
//! undeformed material, `k grad_0 T`, is the sum of Cleary & Monaghan (1999); the rest, `q = k (J C^-1 - I) grad_0 T`, goes by the two
//! sums of the form itself,
//!
//! `grad_0 T_i = sum_j V_j (T_j - T_i) B_i grad_0 W_ij`,  `Q_i = sum_j V_i V_j (q_i B_i + q_j B_j) . grad_0 W_ij`,
//!
//! which are adjoint and antisymmetric: heat is conserved. The gradient sees less of a temperature than pairs do, so that even where
//! `q` flows upwards, which is never more than `k grad_0 T`, heat does not on the whole.

use super::CpuEngine;
use super::conduction::{Inflow, Table};
use super::contact::Places;
use super::total_lagrangian::Reference;
use crate::lanes::PairScalar;
use crate::neighbors::BLOCK;
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::{Tensor, Vector, conduction::pair_conductivity, tensor, tensor::dot};

/// `J C^-1`: how much better than at rest heat flows, by direction of the initial configuration.
fn stretched(f: &Tensor<f64>) -> Tensor<f64> {
    let inverse = tensor::inverse(f);
    let j = tensor::determinant(f);
    tensor::multiply(&inverse, &tensor::transpose(&inverse)).map(|row| row.map(|c| j * c))
}

/// Largest sum of magnitudes in a row: no eigenvalue is larger.
fn bound(a: &Tensor<f64>) -> f64 {
    a.iter().map(|row| row.iter().map(|c| c.abs()).sum()).fold(0.0, f64::max)
}

fn apply(a: &Tensor<f64>, v: Vector<f64>) -> Vector<f64> {
    a.map(|row| dot(row, v))
}

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
            let h = 0.5 * (p.smoothing_length[i] + p.smoothing_length[source]);
            let weight = reference.volume[source] * self.slope(dot(x, x), h);
            let difference = p.temperature[source] - p.temperature[i];
            for k in 0..3 {
                gradient[k] -= weight * difference * x[k];
            }
        }
        gradient
    }

    /// Adds what flows to a particle from its initial neighbours.
    pub(super) fn add_reference(&self, sum: &mut Inflow, i: usize, row: &[u32], state: ReferenceState<'_>) {
        let (p, reference) = (state.particles, state.reference);
        let body = p.body[i] as usize;
        let volume = reference.volume[i];
        let better = bound(&stretched(&reference.deformation[i])).max(1.0);
        for &j in row {
            let (source, position, sign) = state.places.of(j);
            let x = [0, 1, 2].map(|k| reference.position[i][k] - position[k]);
            let h = 0.5 * (p.smoothing_length[i] + p.smoothing_length[source]);
            let (r2, other) = (dot(x, x), reference.volume[source]);
            let slope = self.slope(r2, h);
            let flow = [0, 1, 2].map(|k| state.flow[i][k] + sign[k] * state.flow[source][k]);
            let b = p.body[source] as usize;
            let correction = 0.5 * (self.correction[body] + self.correction[b]);
            let conductivity = pair_conductivity(self.conductivity[body], self.conductivity[b]);
            let conductance = (volume * other) * conductivity * (correction * slope);
            sum.power +=
                conductance * (p.temperature[source] - p.temperature[i]) - volume * other * slope * dot(flow, x);
            sum.conductance += better * conductance;
            sum.filled += correction * other * slope * r2 / self.dimension.count() as f64;
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
            let gradient = apply(&correction[i], table.temperature_gradient(i, list.row(i), state));
            let k = table.conductivity[p.body[i] as usize];
            let along = apply(&stretched(&reference.deformation[i]), gradient);
            let q = [0, 1, 2].map(|c| k * (along[c] - gradient[c]));
            *flow = apply(&tensor::transpose(&correction[i]), q);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_flows_better_along_what_is_pressed() {
        // A cube of side 1 pressed to half its height and spread to 1.5 x 1.2: through the height the area is 1.8 times as large and
        // the way half as long, 3.6; along x the area is 0.6, the way 1.5, 0.4; along y 0.75/1.2 = 0.625.
        let f = [[1.5, 0.0, 0.0], [0.0, 1.2, 0.0], [0.0, 0.0, 0.5]];
        let a = stretched(&f);
        for (k, expected) in [0.4, 0.625, 3.6].into_iter().enumerate() {
            assert!((a[k][k] - expected).abs() < 1e-12, "{a:?}");
        }
        // A rotation changes nothing.
        let turned = tensor::multiply(&[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], &f);
        let b = stretched(&turned);
        assert!((0..9).all(|c| (a[c / 3][c % 3] - b[c / 3][c % 3]).abs() < 1e-12), "{b:?}");
        assert!((bound(&a) - 3.6).abs() < 1e-12);
    }
}
