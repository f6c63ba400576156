//! Density re-initialisation by first-order moving least squares (Dilts 1999), within each body.

use super::CpuEngine;
use crate::lanes::PairScalar;
use crate::model::Integrator;
use crate::neighbors::BLOCK;
use rayon::prelude::*;
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::moving_least_squares::Moments;
use sphorge_physics::{Vector, stress, tensor::dot};

impl<T: PairScalar> CpuEngine<T> {
    /// Replaces the density just reached by its moving-least-squares estimate, every so many steps. A particle whose
    /// moment matrix is singular (too few neighbours, or all on a line) keeps its density.
    pub(super) fn restore_density(&mut self) {
        let due =
            self.model.numerics.mls_interval.is_some_and(|n| self.step.dt > 0.0 && self.step.count.is_multiple_of(n));
        if !due {
            return;
        }
        let dimension = super::dimension(&self.model);
        let kernel = self.model.numerics.kernel;
        let particles = &self.particles;
        let count = particles.len();
        let ghosts = &self.halo.ghosts;
        // Where a neighbour is, and which particle holds its mass and density.
        let place = |j: usize| match j.checked_sub(count) {
            None => (particles.position[j], j),
            Some(g) => {
                let source = ghosts[g].source as usize;
                (ghosts[g].position(&particles.position[source]), source)
            }
        };
        let mut restored = std::mem::take(&mut self.work.restored_density);
        restored.resize(count, 0.0);
        restored.par_chunks_mut(BLOCK).enumerate().for_each(|(b, restored)| {
            for (k, rho) in restored.iter_mut().enumerate() {
                let i = b * BLOCK + k;
                // Visits the particle itself and its neighbours of the same body: source, x_ij, W_ij.
                let visit = |each: &mut dyn FnMut(usize, Vector<f64>, f64)| {
                    let h_i = particles.smoothing_length[i];
                    each(i, [0.0; 3], kernel.value(dimension, 0.0, h_i));
                    for &j in self.list().row(i) {
                        let (x_j, source) = place(j as usize);
                        if particles.body[source] == particles.body[i] {
                            let x = [0, 1, 2].map(|a| particles.position[i][a] - x_j[a]);
                            let h = pair_smoothing_length(h_i, particles.smoothing_length[source]);
                            each(source, x, kernel.value(dimension, dot(x, x).sqrt(), h));
                        }
                    }
                };
                let mut moments = Moments::default();
                visit(&mut |j, x, w| moments.add(x, particles.mass[j] / particles.density[j] * w));
                let mut density = particles.density[i];
                if let Some(beta) = moments.solve(particles.smoothing_length[i], dimension) {
                    let mut sum = 0.0;
                    visit(&mut |j, x, w| sum += particles.mass[j] * beta.factor(x) * w);
                    if sum > 0.0 {
                        density = sum;
                    }
                }
                *rho = density;
            }
        });

        let half = 0.5 * self.step.dt;
        for (i, &rho) in restored.iter().enumerate() {
            let old = self.particles.density[i];
            // Pressure changes without work: the volume change it would have taken is an entry of the ledger.
            self.step.mls_energy += self.particles.mass[i] * self.particles.pressure[i] * (rho - old) / (rho * old);
            self.particles.density[i] = rho;
            if self.model.numerics.integrator == Integrator::PredictorCorrector {
                // The corrector starts from the beginning of the step.
                self.base.density[i] = stress::density_after(rho, &self.particles.velocity_gradient[i], -half);
            }
        }
        self.work.restored_density = restored;
    }
}
