//! The two pair sweeps over all blocks: packing what they read, choosing the compiled variant, storing what they sum.

use super::forces::{ForceJob, ForceSum, ForceTerms};
use super::kinematics::{GradientJob, GradientSum};
use super::records::kinematic;
use super::{CpuEngine, Work};
use crate::lanes::{PairScalar, run};
use crate::model::{GradientCorrection, Integrator};
use crate::neighbors::{BLOCK, NeighborList};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::viscosity::ViscosityParameters;
use sphorge_physics::{Dimension, Tensor, Vector, gradient_correction, pair, stress, tensor};

/// Runs an expression with the dimension `D` and the choice `CORRECTED` as compile-time constants.
macro_rules! dispatch_sweep {
    ($dimension:expr, $corrected:expr, |$d:ident, $c:ident| $body:expr) => {
        match ($dimension, $corrected) {
            (Dimension::One, false) => {
                const $d: usize = 1;
                const $c: bool = false;
                $body
            }
            (Dimension::Two, false) => {
                const $d: usize = 2;
                const $c: bool = false;
                $body
            }
            (Dimension::Three, false) => {
                const $d: usize = 3;
                const $c: bool = false;
                $body
            }
            (Dimension::One, true) => {
                const $d: usize = 1;
                const $c: bool = true;
                $body
            }
            (Dimension::Two, true) => {
                const $d: usize = 2;
                const $c: bool = true;
                $body
            }
            (Dimension::Three, true) => {
                const $d: usize = 3;
                const $c: bool = true;
                $body
            }
        }
    };
}

/// Runs an expression with the dimension `D` as a compile-time constant.
macro_rules! dispatch_dimension {
    ($dimension:expr, |$d:ident| $body:expr) => {
        match $dimension {
            Dimension::One => {
                const $d: usize = 1;
                $body
            }
            Dimension::Two => {
                const $d: usize = 2;
                $body
            }
            Dimension::Three => {
                const $d: usize = 3;
                $body
            }
        }
    };
}

pub(super) use {dispatch_dimension, dispatch_sweep};

impl<T: PairScalar> CpuEngine<T> {
    pub(super) fn corrected(&self) -> bool {
        self.model.numerics.gradient_correction != GradientCorrection::None || self.reference.is_some()
    }

    /// Writes velocity, smoothing length, the position a time `back` (s) ago and the weight expected a time `ahead` (s) of the
    /// present density, of every particle and ghost, into its kinematic record.
    fn pack_kinematics(&mut self, back: f64, ahead: f64) {
        let numerics = &self.model.numerics;
        let extra = numerics.artificial_stress.is_some() || numerics.balsara;
        let count = self.particles.len();
        self.records.resize(count + self.halo.ghosts.len(), extra, self.corrected());

        let form = numerics.pair_form;
        let frame = self.records.frame;
        let Particles { position, velocity, velocity_gradient, mass, density, smoothing_length, .. } = &self.particles;
        let Work { xsph, motion, .. } = &self.work;
        let motions = &self.motions;
        let place = |i: usize| match back {
            0.0 => position[i],
            _ => earlier(position[i], velocity[i], xsph[i], motions.of(motion[i]), back),
        };
        self.records.kinematic[..count].par_chunks_mut(BLOCK).enumerate().for_each(|(b, records)| {
            for (k, record) in records.iter_mut().enumerate() {
                let i = b * BLOCK + k;
                let x = frame.encode::<T>(&place(i));
                for a in 0..3 {
                    record[kinematic::X + a] = x[a];
                    record[kinematic::V + a] = T::of(velocity[i][a]);
                }
                let density = stress::predicted_density(density[i], &velocity_gradient[i], ahead);
                record[kinematic::WEIGHT] = T::of(pair::gradient_weight(form, mass[i], density));
                record[kinematic::H] = T::of(smoothing_length[i]);
            }
        });
        self.halo.exchange_kinematics(count, place, &mut self.records);
    }

    /// Velocity gradient and density. With leapfrog the gradient is taken with the positions of mid-step, where its
    /// velocities are: the step is then the same forwards and backwards in time, and what stress gains in it is the work of
    /// the forces before and after it, to second order.
    pub(super) fn sum_gradients(&mut self) {
        if self.reference.is_some() {
            return self.sum_reference_gradients();
        }
        let half = 0.5 * self.step.dt;
        // The predictor has its positions at mid-step already.
        let leapfrog = self.model.numerics.integrator == Integrator::Leapfrog;
        self.pack_kinematics(if leapfrog { half } else { 0.0 }, half);
        let model = &*self.model;
        let dimension = super::dimension(model);
        dispatch_sweep!(dimension, self.corrected(), |D, CORRECTED| {
            let records = &self.records.kinematic;
            let constants = &self.constants;
            let form = model.numerics.pair_form;
            let dt = self.step.dt_to_evaluation(model.numerics.integrator);
            let Particles { velocity_gradient, neighbors, density, .. } = &mut self.particles;
            let (list, instructions) = (&self.lists.list, self.instructions);
            let stored = self.lists.stored.as_ref();
            let sum_block = |sums: &mut [GradientSum<T>; BLOCK], b: usize| {
                let block = &list.blocks()[b];
                let job = GradientJob::<T, D, CORRECTED> {
                    records,
                    first: b * BLOCK,
                    block,
                    stored: stored.map(|s| s.block(b)),
                    constants,
                    sums,
                };
                run(instructions, job);
            };
            let room = || [GradientSum::zero(); BLOCK];
            let finish =
                |sum: &GradientSum<T>, rho: &mut f64, last: &Tensor<f64>, correction: Option<&mut Tensor<f64>>| {
                    let scale = pair::gradient_factor(form, stress::predicted_density(*rho, last, half));
                    let mut l = sum.gradient.map(|row| row.map(|v| v.to_f64() * scale));
                    if let Some(b_i) = correction {
                        let moment = sum.moment.map(|row| row.map(|v| v.to_f64() * scale));
                        *b_i = gradient_correction::gradient_correction(&moment, dimension);
                        l = tensor::multiply(&l, &tensor::transpose(b_i));
                    }
                    *rho = stress::density_after(*rho, &l, dt);
                    l
                };
            let columns = (
                velocity_gradient.par_chunks_mut(BLOCK),
                neighbors.par_chunks_mut(BLOCK),
                density.par_chunks_mut(BLOCK),
            );
            if CORRECTED {
                (columns.0, columns.1, columns.2, self.work.correction.par_chunks_mut(BLOCK))
                    .into_par_iter()
                    .enumerate()
                    .for_each_init(room, |sums, (b, (l, n, rho, correction))| {
                        sum_block(sums, b);
                        for k in 0..l.len() {
                            l[k] = finish(&sums[k], &mut rho[k], &l[k], Some(&mut correction[k]));
                            n[k] = sums[k].inside;
                        }
                    });
            } else {
                columns.into_par_iter().enumerate().for_each_init(room, |sums, (b, (l, n, rho))| {
                    sum_block(sums, b);
                    for k in 0..l.len() {
                        l[k] = finish(&sums[k], &mut rho[k], &l[k], None);
                        n[k] = sums[k].inside;
                    }
                });
            }
        });
        self.step.pairs = self.particles.neighbors.iter().map(|&n| u64::from(n)).sum();
    }

    /// Gradient correction at the positions and densities forces are evaluated with, where those are not the ones of the
    /// velocity gradient. Torques cancel only if force and correction see the same.
    pub(super) fn correct_forces(&mut self) {
        let moved = self.model.numerics.integrator == Integrator::Leapfrog && self.step.dt > 0.0;
        if !(self.corrected() && moved) || self.reference.is_some() {
            return;
        }
        self.pack_kinematics(0.0, 0.0);
        let model = &*self.model;
        let dimension = super::dimension(model);
        let form = model.numerics.pair_form;
        dispatch_sweep!(dimension, true, |D, CORRECTED| {
            let (records, constants) = (&self.records.kinematic, &self.constants);
            let (list, instructions) = (&self.lists.list, self.instructions);
            let stored = self.lists.stored.as_ref();
            let density = &self.particles.density;
            self.work.correction.par_chunks_mut(BLOCK).enumerate().for_each(|(b, correction)| {
                let mut sums = [GradientSum::zero(); BLOCK];
                let job = GradientJob::<T, D, CORRECTED> {
                    records,
                    first: b * BLOCK,
                    block: &list.blocks()[b],
                    stored: stored.map(|s| s.block(b)),
                    constants,
                    sums: &mut sums,
                };
                run(instructions, job);
                for (k, b_i) in correction.iter_mut().enumerate() {
                    let scale = pair::gradient_factor(form, density[b * BLOCK + k]);
                    let moment = sums[k].moment.map(|row| row.map(|v| v.to_f64() * scale));
                    *b_i = gradient_correction::gradient_correction(&moment, dimension);
                }
            });
        });
    }

    /// Acceleration by pair forces, energy rate, XSPH velocity.
    pub(super) fn sum_forces(&mut self) {
        let model = &*self.model;
        let numerics = &model.numerics;
        let dimension = super::dimension(model);
        let pair_form = numerics.pair_form;
        let bulk_viscosity = self.reference.is_some();
        let terms = ForceTerms {
            // The total Lagrangian form has its viscosity in the stress.
            viscosity: match self.reference {
                None => {
                    ViscosityParameters { alpha: T::of(numerics.viscosity_alpha), beta: T::of(numerics.viscosity_beta) }
                }
                Some(_) => ViscosityParameters { alpha: T::zero(), beta: T::zero() },
            },
            artificial_stress: numerics.artificial_stress.map(|a| (T::of(self.inverse_w_spacing()), a.exponent)),
            balsara: numerics.balsara,
            xsph: numerics.xsph != 0.0,
            pair_form,
            energy_split: numerics.energy_split,
        };
        let usual = terms.usual(numerics.kernel);
        dispatch_sweep!(dimension, self.corrected(), |D, CORRECTED| {
            let records = &self.records;
            let (lists, constants, strength) = (&self.lists, &self.constants, numerics.xsph);
            let instructions = self.instructions;
            let Work { xsph, mu, .. } = &mut self.work;
            let Particles { acceleration, energy_rate, mass, .. } = &mut self.particles;
            let mass = &*mass;
            let room = || [ForceSum::zero(); BLOCK];
            (
                acceleration.par_chunks_mut(BLOCK),
                energy_rate.par_chunks_mut(BLOCK),
                xsph.par_chunks_mut(BLOCK),
                mu.par_chunks_mut(BLOCK),
            )
                .into_par_iter()
                .enumerate()
                .for_each_init(room, |sums, (b, (a, e, x, mu))| {
                    let first = b * BLOCK;
                    let block = &lists.list.blocks()[b];
                    let stored = lists.stored.as_ref().map(|s| s.block(b));
                    let terms = &terms;
                    if usual {
                        let sums = &mut *sums;
                        let job =
                            ForceJob::<T, D, CORRECTED, true> { records, first, block, stored, constants, terms, sums };
                        run(instructions, job);
                    } else {
                        let sums = &mut *sums;
                        let job = ForceJob::<T, D, CORRECTED, false> {
                            records,
                            first,
                            block,
                            stored,
                            constants,
                            terms,
                            sums,
                        };
                        run(instructions, job);
                    }
                    for (k, sum) in sums.iter().enumerate().take(a.len()) {
                        let i = b * BLOCK + k;
                        let weight = records.force[i][super::records::force::WEIGHT].to_f64();
                        let outer = pair::momentum_factor(pair_form, mass[i], weight);
                        a[k] = sum.acceleration.map(|v| v.to_f64() * outer);
                        e[k] = sum.energy_rate.to_f64() * outer;
                        x[k] = sum.xsph.map(|v| v.to_f64() * strength);
                        if !bulk_viscosity {
                            mu[k] = sum.mu.to_f64();
                        }
                    }
                });
        });
    }

    /// `1 / w(spacing/h)` of the artificial stress: shapes, not kernels, so that bodies of other spacings have the same ratio.
    fn inverse_w_spacing(&self) -> f64 {
        // Spacing over smoothing length is the same in every body: that of the first.
        let ratio = self.model.bodies.first().map_or(1.0, |b| b.spacing / b.smoothing_length);
        1.0 / self.model.numerics.kernel.w(ratio)
    }

    /// The neighbour list, for stages of their own file.
    pub(super) fn list(&self) -> &NeighborList {
        &self.lists.list
    }
}

/// Where a particle that drifts with its velocity and XSPH correction was a time `back` (s) ago.
#[inline(always)]
fn earlier(x: Vector<f64>, v: Vector<f64>, xsph: Vector<f64>, prescribed: [Option<f64>; 3], back: f64) -> Vector<f64> {
    // A prescribed axis has no XSPH; its velocity is the one it drifted with.
    [0, 1, 2].map(|a| x[a] - back * if prescribed[a].is_some() { v[a] } else { v[a] + xsph[a] })
}
