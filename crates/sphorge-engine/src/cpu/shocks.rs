//! Viscosity of shocks along the pairs of the total Lagrangian form: gathers the neighbours of particles at a shock and adds up what pushes them. The formulas are
//! in [`sphorge_physics::viscosity`].

use super::CpuEngine;
use super::hourglass::relative_displacement;
use super::inner::Rows;
use super::kinematics::{PairConstants, own_scale, scale_with};
use super::records::kinematic::{self, H, V, WEIGHT, X};
use super::records::{Records, force, hourglass as entry};
use super::sweeps::dispatch_dimension;
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run, splat_record};
use crate::neighbors::{BLOCK, Block};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::tensor::dot;
use sphorge_physics::viscosity::{ShockSums, closing_rate, shock_push};
use sphorge_physics::{Dimension, Real, Vector};

struct ShockJob<'a, T, const D: usize> {
    records: &'a Records<T>,
    first: usize,
    block: &'a Block,
    constants: &'a PairConstants<T>,
    strength: T,
    sums: &'a mut [ShockSums<T>; BLOCK],
}

impl<T: PairScalar, const D: usize> Job<T> for ShockJob<'_, T, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        for k in 0..self.block.len() {
            self.sums[k] = shock_row::<L, D>(&self, k);
        }
    }
}

/// `chi c rho_0` of a particle, Pa s/m.
#[inline(always)]
fn impedance<T: PairScalar>(records: &Records<T>, i: usize) -> T {
    records.force[i][force::C]
}

/// Row `k` of a block.
#[inline(always)]
fn shock_row<L: Lanes, const D: usize>(job: &ShockJob<'_, L::Element, D>, k: usize) -> ShockSums<L::Element> {
    let (own, records) = (job.first + k, job.records);
    let nothing = <L::Element as Real>::zero();
    let is_at_shock = |i: usize| impedance(records, i) > nothing;
    if !is_at_shock(own) && !job.block.row(k).iter().any(|&j| is_at_shock(j as usize)) {
        return ShockSums::zero();
    }
    let initial_i: [L; kinematic::LEN] = splat_record(&records.kinematic[own]);
    let record_i: [L; entry::LEN] = splat_record(&records.hourglass[own]);
    let own_impedance = L::splat(impedance(records, own));
    let scale_i = own_scale::<L, D>(job.constants, records.kinematic[own][H]);
    let (unit, strength) = (L::splat(job.constants.unit), L::splat(job.strength));
    let kernel = job.constants.kernel;
    let mut sums = ShockSums::<L>::zero();
    for indices in job.block.padded_row(k, L::WIDTH).chunks_exact(L::WIDTH) {
        let initial_j = L::gather(&records.kinematic, indices);
        let record_j: [L; entry::LEN] = L::gather(&records.hourglass, indices);
        let [other_impedance]: [L; 1] = L::gather_part(&records.force, indices, force::C);
        let (mut x, mut v) = ([L::zero(); 3], [L::zero(); 3]);
        let (mut x2, mut initial2) = (L::zero(), L::zero());
        for a in 0..D {
            let initial = L::difference(initial_i[X + a], initial_j[X + a], unit);
            x[a] = initial + relative_displacement(&record_i, &record_j, a);
            v[a] = initial_i[V + a] - initial_j[V + a];
            x2 = x[a].mul_add(x[a], x2);
            initial2 = initial.mul_add(initial, initial2);
        }
        let v_dot_x = dot(v, x);
        let scale = scale_with::<L, D>(scale_i, job.constants, initial_j[H]);
        let (q, inverse_q) = scale.reduced_distance(initial2);
        let weight = -scale.weighted(initial_j[WEIGHT]).f(kernel.dw_over_q_by(q, inverse_q));
        let closing = closing_rate(v_dot_x, x2, scale.h);
        let push = shock_push(strength, own_impedance, other_impedance, scale.h, closing);
        sums.add::<D>(&x, v_dot_x, push, weight);
    }
    let mut sum = ShockSums { power: sums.power.sum(), ..ShockSums::zero() };
    for a in 0..D {
        sum.acceleration[a] = sums.acceleration[a].sum();
    }
    sum
}

/// The sums of a block of particles over rows of it.
struct ShockSweep<'a, T> {
    records: &'a Records<T>,
    constants: &'a PairConstants<T>,
    instructions: Instructions,
    dimension: Dimension,
    strength: f64,
}

impl<T: PairScalar> ShockSweep<'_, T> {
    fn block(&self, b: usize, block: &Block, sums: &mut [ShockSums<T>; BLOCK]) {
        let (records, first, constants) = (self.records, b * BLOCK, self.constants);
        let strength = T::of(self.strength);
        dispatch_dimension!(self.dimension, |D| {
            run(self.instructions, ShockJob::<T, D> { records, first, block, constants, strength, sums });
        });
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// The sums, if there is viscosity of shocks.
    fn shock_sweep(&self) -> Option<ShockSweep<'_, T>> {
        Some(ShockSweep {
            strength: self.formulation.viscosity_of_shocks(&self.model)?,
            records: &self.records,
            constants: &self.constants,
            instructions: self.instructions,
            dimension: super::dimension(&self.model),
        })
    }

    /// Adds the forces by the viscosity of shocks of some pairs of block `b`, as last evaluated, N.
    pub(super) fn add_shock_forces(&self, b: usize, rows: &Block, forces: &mut [Vector<f64>]) {
        let Some(shocks) = self.shock_sweep() else { return };
        let mut sums = [ShockSums::zero(); BLOCK];
        shocks.block(b, rows, &mut sums);
        for (k, force) in forces.iter_mut().enumerate() {
            for a in 0..3 {
                force[a] += self.particles.reference_volume[b * BLOCK + k] * sums[k].acceleration[a].to_f64();
            }
        }
    }

    /// Adds the viscosity of shocks along pairs to acceleration and energy rate.
    pub(super) fn resist_shocks(&mut self, rows: Rows) {
        if self.formulation.viscosity_of_shocks(&self.model).is_none() {
            return;
        }
        if !self.has_springs() {
            self.pack_displacements(rows);
        }
        // Taken out while particles are written to; nothing of it changes.
        let mut work = std::mem::take(&mut self.numerical_work.viscous.power);
        let Particles { acceleration, energy_rate, .. } = &mut self.particles;
        let mut rates = (std::mem::take(acceleration), std::mem::take(energy_rate));
        // Most steps have no shock.
        let is_at_shock = self.records.force.par_iter().with_min_len(BLOCK).any(|record| record[force::C] > T::zero());
        let shocks = self.shock_sweep().filter(|_| is_at_shock);
        let (p, inner, list) = (&self.particles, &self.inner, &self.lists.list);
        (rates.0.par_chunks_mut(BLOCK), rates.1.par_chunks_mut(BLOCK), work.par_iter_mut())
            .into_par_iter()
            .enumerate()
            .filter(|(b, _)| inner.is_summed_in(*b, rows))
            .for_each(|(b, (acceleration, energy_rate, power))| {
                *power = 0.0;
                let Some(shocks) = &shocks else { return };
                let mut sums = [ShockSums::zero(); BLOCK];
                shocks.block(b, &list.blocks()[b], &mut sums);
                for k in 0..acceleration.len() {
                    let (mass, volume) = (p.mass[b * BLOCK + k], p.reference_volume[b * BLOCK + k]);
                    for a in 0..3 {
                        acceleration[k][a] += volume / mass * sums[k].acceleration[a].to_f64();
                    }
                    let heat = volume * sums[k].power.to_f64();
                    energy_rate[k] += heat / mass;
                    *power += heat;
                }
            });
        self.numerical_work.viscous.power = work;
        (self.particles.acceleration, self.particles.energy_rate) = rates;
    }
}
