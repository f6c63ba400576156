//! Density re-initialisation by first-order moving least squares (Dilts 1999), within each body.

use super::CpuEngine;
use super::ghosts::WithGhosts;
use crate::RunFailure;
use crate::lanes::PairScalar;
use crate::model::Integrator;
use crate::neighbors::BLOCK;
use rayon::prelude::*;
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::moving_least_squares::Moments;
use sphorge_physics::{Vector, stress, tensor::dot};

impl<T: PairScalar> CpuEngine<T> {
    /// Whether this step restores the density.
    pub(super) fn restoration_is_due(&self) -> bool {
        let due = |n: u64| self.step.dt > 0.0 && self.step.count.is_multiple_of(n);
        self.model.numerics.mls_interval.is_some_and(due)
    }

    /// Replaces the updated density by its moving-least-squares estimate. A particle whose moment matrix is singular
    /// (too few neighbours, or all on a line) keeps its density.
    pub(super) fn restore_densities(&mut self) -> Result<(), RunFailure> {
        let dimension = super::dimension(&self.model);
        let kernel = self.model.numerics.kernel;
        let particles = &self.particles;
        let ghosts = &self.ghosts.columns;
        let position = WithGhosts::new(&particles.position, &ghosts.position);
        let smoothing_length = WithGhosts::new(&particles.smoothing_length, &ghosts.smoothing_length);
        let mass = WithGhosts::new(&particles.mass, &ghosts.mass);
        let density = WithGhosts::new(&particles.density, &ghosts.density);
        let body = WithGhosts::new(&particles.body, &ghosts.body);
        let mut restored = std::mem::take(&mut self.restored_density);
        restored.resize(particles.len(), 0.0);
        restored.par_chunks_mut(BLOCK).enumerate().for_each(|(b, restored)| {
            for (k, rho) in restored.iter_mut().enumerate() {
                let i = b * BLOCK + k;
                // Visits the particle itself and its neighbours of the same body: number, x_ij, W_ij.
                let visit = |each: &mut dyn FnMut(usize, Vector<f64>, f64)| {
                    let h_i = particles.smoothing_length[i];
                    each(i, [0.0; 3], kernel.value(dimension, 0.0, h_i));
                    for &j in self.lists.list.row(i) {
                        let j = j as usize;
                        if body.at(j) == particles.body[i] {
                            let x_j = position.at(j);
                            let x = [0, 1, 2].map(|a| particles.position[i][a] - x_j[a]);
                            let h = pair_smoothing_length(h_i, smoothing_length.at(j));
                            each(j, x, kernel.value(dimension, dot(x, x).sqrt(), h));
                        }
                    }
                };
                let mut moments = Moments::default();
                visit(&mut |j, x, w| moments.add(x, mass.at(j) / density.at(j) * w));
                let mut estimate = particles.density[i];
                if let Some(beta) = moments.solve(particles.smoothing_length[i], dimension) {
                    let mut sum = 0.0;
                    visit(&mut |j, x, w| sum += mass.at(j) * beta.factor(x) * w);
                    if sum > 0.0 {
                        estimate = sum;
                    }
                }
                *rho = estimate;
            }
        });

        let half = 0.5 * self.step.dt;
        let p = &self.particles;
        let mut energy = [self.step.mls_energy];
        // The pressure changes without work. The work that the corresponding volume change would do is an entry of the
        // energy balance.
        let add = |energy: &mut [f64]| {
            for (i, &rho) in restored.iter().enumerate() {
                let old = p.density[i];
                energy[0] += p.mass[i] * p.pressure[i] * (rho - old) / (rho * old);
            }
        };
        match &self.domain {
            None => add(&mut energy),
            Some(domain) => domain.ranks.sum_in_turn(&mut energy, add)?,
        }
        [self.step.mls_energy] = energy;
        for (i, &rho) in restored.iter().enumerate() {
            self.particles.density[i] = rho;
            if self.model.numerics.integrator == Integrator::PredictorCorrector {
                // The corrector starts from the beginning of the step.
                self.particles.base_density[i] =
                    stress::density_after(rho, &self.particles.velocity_gradient[i], -half);
            }
        }
        self.restored_density = restored;
        Ok(())
    }
}
