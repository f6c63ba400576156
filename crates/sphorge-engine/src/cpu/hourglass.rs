//! Hourglass control of the total Lagrangian form: gathers the neighbours and adds up their springs. The formulas are
//! in [`sphorge_physics::hourglass`].

use super::CpuEngine;
use super::inner::Rows;
use super::kinematics::{PairConstants, own_scale, scale_with};
use super::records::kinematic::{self, H, V, WEIGHT, X};
use super::records::{Records, hourglass as entry};
use super::sweeps::dispatch_dimension;
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run, splat_record};
use crate::model::{Formulation, Material};
use crate::neighbors::{BLOCK, Block};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::hourglass::{Misfit, Spring, SpringSums};
use sphorge_physics::{Dimension, Tensor, Vector};

struct HourglassJob<'a, T, const D: usize> {
    kinematic: &'a [[T; kinematic::LEN]],
    records: &'a [[T; entry::LEN]],
    first: usize,
    block: &'a Block,
    constants: &'a PairConstants<T>,
    sums: &'a mut [SpringSums<T>; BLOCK],
}

impl<T: PairScalar, const D: usize> Job<T> for HourglassJob<'_, T, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let mut springs = [Springs::zero(); BATCH];
        for k in 0..self.block.len() {
            self.sums[k] = hourglass_row::<L, D>(&self, k, &mut springs);
        }
    }
}

/// SIMD vectors of a row that are processed together.
const BATCH: usize = 8;

/// A SIMD vector of springs, between the passes over a row.
#[derive(Clone, Copy)]
struct Springs<L> {
    /// `x_i - x_j`, m.
    x: Vector<L>,
    misfit: Misfit<L>,
    /// Smoothing length of the neighbour, m, and its volume.
    h: L,
    volume: L,
    /// Of the neighbour.
    spring: Spring<L>,
}

impl<L: Lanes> Springs<L> {
    #[inline(always)]
    fn zero() -> Self {
        let o = L::zero();
        Self {
            x: [o; 3],
            misfit: Misfit { initial2: o, r2: o, error: o, v_dot_x: o },
            h: o,
            volume: o,
            spring: Spring { stiffness: o, bound: o },
        }
    }
}

/// Deformation gradient of a record.
#[inline(always)]
fn deformation<L: Lanes>(record: &[L; entry::LEN]) -> Tensor<L> {
    let mut f = [[L::zero(); 3]; 3];
    for a in 0..3 {
        for b in 0..3 {
            f[a][b] = record[entry::F + 3 * a + b];
        }
    }
    f
}

/// Springs of a record.
#[inline(always)]
fn spring<L: Lanes>(record: &[L; entry::LEN]) -> Spring<L> {
    Spring { stiffness: record[entry::STIFFNESS], bound: record[entry::BOUND] }
}

/// Row `k` of a block, in two short passes, so that the processor works on many pairs at a time.
#[inline(always)]
fn hourglass_row<L: Lanes, const D: usize>(
    job: &HourglassJob<'_, L::Element, D>,
    k: usize,
    springs: &mut [Springs<L>; BATCH],
) -> SpringSums<L::Element> {
    let own = job.first + k;
    let initial_i: [L; kinematic::LEN] = splat_record(&job.kinematic[own]);
    let record_i: [L; entry::LEN] = splat_record(&job.records[own]);
    let (deformation_i, spring_i) = (deformation(&record_i), spring(&record_i));
    let scale_i = own_scale::<L, D>(job.constants, job.kinematic[own][H]);
    let unit = L::splat(job.constants.unit);
    let kernel = job.constants.kernel;
    let mut sums = SpringSums::<L>::zero();
    for indices in job.block.padded_row(k, L::WIDTH).chunks(BATCH * L::WIDTH) {
        for (pair, indices) in springs.iter_mut().zip(indices.chunks_exact(L::WIDTH)) {
            let initial_j = L::gather(job.kinematic, indices);
            let record_j = L::gather(job.records, indices);
            let (mut initial, mut v) = ([L::zero(); 3], [L::zero(); 3]);
            for a in 0..D {
                initial[a] = L::difference(initial_i[X + a], initial_j[X + a], unit);
                pair.x[a] = L::difference(record_i[entry::X + a], record_j[entry::X + a], unit);
                v[a] = initial_i[V + a] - initial_j[V + a];
            }
            pair.misfit = Misfit::of::<D>(&initial, &pair.x, &v, &deformation_i, &deformation(&record_j));
            (pair.h, pair.volume) = (initial_j[H], initial_j[WEIGHT]);
            pair.spring = spring(&record_j);
        }
        for pair in &springs[..indices.len() / L::WIDTH] {
            let scale = scale_with::<L, D>(scale_i, job.constants, pair.h);
            let (q, _) = scale.reduced_distance(pair.misfit.initial2);
            let strength = pair.misfit.strength(spring_i.between(pair.spring), scale, kernel.w(q), pair.volume);
            sums.add::<D>(&pair.x, pair.misfit.v_dot_x, strength);
        }
    }
    let mut sum = SpringSums { energy_rate: sums.energy_rate.sum(), ..SpringSums::zero() };
    for a in 0..D {
        sum.acceleration[a] = sums.acceleration[a].sum();
    }
    sum
}

/// The sums of a block of particles over rows of it.
struct SpringSweep<'a, T> {
    records: &'a Records<T>,
    constants: &'a PairConstants<T>,
    instructions: Instructions,
    dimension: Dimension,
}

impl<T: PairScalar> SpringSweep<'_, T> {
    fn block(&self, b: usize, block: &Block, sums: &mut [SpringSums<T>; BLOCK]) {
        let Records { kinematic, hourglass: records, .. } = self.records;
        let (first, constants) = (b * BLOCK, self.constants);
        dispatch_dimension!(self.dimension, |D| {
            run(self.instructions, HourglassJob::<T, D> { kinematic, records, first, block, constants, sums });
        });
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Adds the forces of the springs of some pairs of block `b`, as last evaluated, N.
    pub(super) fn add_hourglass_forces(&self, b: usize, rows: &Block, forces: &mut [Vector<f64>]) {
        if self.records.hourglass.is_empty() {
            return;
        }
        let springs = SpringSweep {
            records: &self.records,
            constants: &self.constants,
            instructions: self.instructions,
            dimension: super::dimension(&self.model),
        };
        let mut sums = [SpringSums::zero(); BLOCK];
        springs.block(b, rows, &mut sums);
        for (k, force) in forces.iter_mut().enumerate() {
            for a in 0..3 {
                force[a] += self.particles.reference_volume[b * BLOCK + k] * sums[k].acceleration[a].to_f64();
            }
        }
    }

    /// Adds the hourglass forces to acceleration and energy rate.
    pub(super) fn resist_hourglass(&mut self, rows: Rows) {
        let Formulation::TotalLagrangian { hourglass: strength, .. } = self.model.formulation else { return };
        if strength == 0.0 {
            return;
        }
        self.pack_hourglass(strength, rows);
        let inner = &self.inner;
        let list = &self.lists.list;
        let springs = SpringSweep {
            records: &self.records,
            constants: &self.constants,
            instructions: self.instructions,
            dimension: super::dimension(&self.model),
        };
        let Particles { acceleration, energy_rate, mass, reference_volume, .. } = &mut self.particles;
        let (mass, volume, work) = (&*mass, &*reference_volume, &mut self.numerical_work.hourglass);
        (acceleration.par_chunks_mut(BLOCK), energy_rate.par_chunks_mut(BLOCK), work.power.par_iter_mut())
            .into_par_iter()
            .enumerate()
            .filter(|(b, _)| inner.is_summed_in(*b, rows))
            .for_each(|(b, (acceleration, energy_rate, power))| {
                let mut sums = [SpringSums::zero(); BLOCK];
                springs.block(b, &list.blocks()[b], &mut sums);
                *power = 0.0;
                for k in 0..acceleration.len() {
                    let i = b * BLOCK + k;
                    let factor = volume[i] / mass[i];
                    for a in 0..3 {
                        acceleration[k][a] += factor * sums[k].acceleration[a].to_f64();
                    }
                    energy_rate[k] += factor * sums[k].energy_rate.to_f64();
                    *power += volume[i] * sums[k].energy_rate.to_f64();
                }
            });
    }

    /// Writes the data of particles and ghosts that the sum reads: velocities at which forces are evaluated, current
    /// positions, deformation gradients, springs; for particles with the first rows, for ghosts when they have arrived.
    fn pack_hourglass(&mut self, strength: f64, rows: Rows) {
        if !(rows.is_first() || rows.is_last()) {
            return;
        }
        let young: Vec<f64> = self.model.materials.iter().map(Material::young_modulus).collect();
        let count = self.particles.len();
        let frame = self.records.frame;
        let Records { kinematic, hourglass, .. } = &mut self.records;
        hourglass.resize(kinematic.len(), [T::zero(); entry::LEN]);
        let (own, ghost) = kinematic.split_at_mut(count);
        let (own_springs, ghost_springs) = hourglass.split_at_mut(count);
        let parts = [
            (rows.is_first(), (&self.particles, own, own_springs)),
            (rows.is_last(), (&self.ghosts.columns, ghost, ghost_springs)),
        ];
        for (p, kinematic, springs) in parts.into_iter().filter(|(is_now, _)| *is_now).map(|(_, part)| part) {
            kinematic.par_iter_mut().zip(springs).enumerate().for_each(|(i, (record, spring_record))| {
                for a in 0..3 {
                    record[V + a] = T::of_velocity(p.evaluated_velocity[i][a]);
                }
                let young = young[p.material[i] as usize];
                let spring =
                    Spring::new(strength, young, p.yield_stress[i], p.plastic_strain[i], p.smallest_stretch[i]);
                spring_record[..3].copy_from_slice(&frame.encode::<T>(&p.position[i]));
                for c in 0..9 {
                    spring_record[entry::F + c] = T::of(p.deformation[i][c / 3][c % 3]);
                }
                spring_record[entry::STIFFNESS] = T::of(spring.stiffness);
                spring_record[entry::BOUND] = T::of(spring.bound);
            });
        }
    }
}
