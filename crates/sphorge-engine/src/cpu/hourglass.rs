//! Hourglass control of the total Lagrangian form: gathers the neighbours and adds up their springs, in the same loop as the stresses where nothing else
//! acts along pairs. The formulas are in [`sphorge_physics::hourglass`] and [`sphorge_physics::pair`].

use super::CpuEngine;
use super::forces::{gather_corrected, splat_corrected};
use super::inner::Rows;
use super::kinematics::{PairConstants, own_scale, scale_with};
use super::records::kinematic::{self, H, V, WEIGHT, X};
use super::records::{Records, hourglass as entry};
use super::sweeps::dispatch_dimension;
use crate::RunFailure;
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run, splat_record};
use crate::model::{Formulation, Material, Model};
use crate::neighbors::{BLOCK, Block};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::hourglass::{Counted, Misfit, Spring, SpringSums};
use sphorge_physics::pair::{EnergySplit, ForceSums, PairForm, corrected_stress_vector, momentum_factor};
use sphorge_physics::{Dimension, Tensor, Vector, tensor};

/// Sums of one particle over its springs, still without the factor `V_i / m_i`, and of its stresses in the same loop.
#[derive(Clone, Copy)]
struct RowSums<T> {
    springs: SpringSums<T>,
    stresses: ForceSums<T>,
}

impl<T: PairScalar> RowSums<T> {
    fn zero() -> Self {
        Self { springs: SpringSums::zero(), stresses: ForceSums::zero() }
    }
}

/// The sums of a block of particles; with `STRESS` also those of the stresses.
struct HourglassJob<'a, T, const D: usize, const STRESS: bool> {
    records: &'a Records<T>,
    first: usize,
    block: &'a Block,
    constants: &'a PairConstants<T>,
    split: EnergySplit,
    sums: &'a mut [RowSums<T>; BLOCK],
}

impl<T: PairScalar, const D: usize, const STRESS: bool> Job<T> for HourglassJob<'_, T, D, STRESS> {
    #[inline(always)]
    fn run<L: Lanes<Element = T>>(self) {
        let mut springs = [Springs::zero(); BATCH];
        for k in 0..self.block.len() {
            self.sums[k] = hourglass_row::<L, D, STRESS>(&self, k, &mut springs);
        }
    }
}

/// SIMD vectors of a row that are processed together.
const BATCH: usize = 8;

/// A SIMD vector of springs, between the passes over a row.
#[derive(Clone, Copy)]
struct Springs<L> {
    /// `v_i - v_j`, m/s.
    v: Vector<L>,
    misfit: Misfit<L>,
    push: Vector<L>,
    /// Smoothing length of the neighbour, m, and its volume.
    h: L,
    volume: L,
}

impl<L: Lanes> Springs<L> {
    #[inline(always)]
    fn zero() -> Self {
        let o = L::zero();
        Self { v: [o; 3], misfit: Misfit::zero(), push: [o; 3], h: o, volume: o }
    }
}

/// Displacement gradient of a record.
#[inline(always)]
fn displacement_gradient<L: Lanes>(record: &[L; entry::LEN]) -> Tensor<L> {
    let mut h = [[L::zero(); 3]; 3];
    for a in 0..3 {
        for b in 0..3 {
            h[a][b] = record[entry::H + 3 * a + b];
        }
    }
    h
}

/// `u_i - u_j` along an axis, m. Neighbours have moved by nearly the same, so that the difference of the numbers is
/// exact or nearly so, and that of the rests is as small as what is left.
#[inline(always)]
pub(super) fn relative_displacement<L: Lanes>(own: &[L; entry::LEN], other: &[L; entry::LEN], axis: usize) -> L {
    let difference = |first: usize| own[first + axis] - other[first + axis];
    difference(entry::U) + difference(entry::U_REST)
}

/// Row `k` of a block, in two short passes, so that the processor works on many pairs at a time.
#[inline(always)]
fn hourglass_row<L: Lanes, const D: usize, const STRESS: bool>(
    job: &HourglassJob<'_, L::Element, D, STRESS>,
    k: usize,
    springs: &mut [Springs<L>; BATCH],
) -> RowSums<L::Element> {
    let (own, records) = (job.first + k, job.records);
    let initial_i: [L; kinematic::LEN] = splat_record(&records.kinematic[own]);
    let record_i: [L; entry::LEN] = splat_record(&records.hourglass[own]);
    let (gradient_i, stiffness_i) = (displacement_gradient(&record_i), record_i[entry::STIFFNESS]);
    let stress_i = if STRESS { splat_corrected(&records.corrected[own]) } else { [[L::zero(); 3]; 3] };
    let scale_i = own_scale::<L, D>(job.constants, records.kinematic[own][H]);
    let unit = L::splat(job.constants.unit);
    let kernel = job.constants.kernel;
    let (mut sums, mut stresses) = (SpringSums::<L>::zero(), ForceSums::<L>::zero());
    for indices in job.block.padded_row(k, L::WIDTH).chunks(BATCH * L::WIDTH) {
        let vectors = indices.chunks_exact(L::WIDTH);
        for (pair, indices) in springs.iter_mut().zip(vectors.clone()) {
            let initial_j = L::gather(&records.kinematic, indices);
            let record_j = L::gather(&records.hourglass, indices);
            let (mut initial, mut u) = ([L::zero(); 3], [L::zero(); 3]);
            for a in 0..D {
                initial[a] = L::difference(initial_i[X + a], initial_j[X + a], unit);
                u[a] = relative_displacement(&record_i, &record_j, a);
                pair.v[a] = initial_i[V + a] - initial_j[V + a];
            }
            pair.misfit = Misfit::of::<D>(&initial, &u, &gradient_i, &displacement_gradient(&record_j));
            pair.push = pair.misfit.push::<D>(stiffness_i, record_j[entry::STIFFNESS]);
            (pair.h, pair.volume) = (initial_j[H], initial_j[WEIGHT]);
        }
        for (pair, indices) in springs.iter().zip(vectors) {
            let scale = scale_with::<L, D>(scale_i, job.constants, pair.h);
            let (q, inverse_q) = scale.reduced_distance(pair.misfit.initial2);
            let weighted_f = scale.weighted(pair.volume).f(kernel.dw_over_q_by(q, inverse_q));
            sums.add::<D>(&pair.misfit, &pair.push, &pair.v, -weighted_f);
            if STRESS {
                let x = &pair.misfit.initial;
                let own_stress = corrected_stress_vector::<L, D>(&stress_i, x);
                let other_stress = corrected_stress_vector::<L, D>(&gather_corrected(&records.corrected, indices), x);
                stresses.add_stress::<D>(job.split, (&own_stress, &other_stress), &pair.v, weighted_f);
            }
        }
    }
    let ([ax, ay, az], [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]) = (sums.acceleration, sums.moment);
    let mut row = RowSums::zero();
    let [ax, ay, az, closing, misfit2, xx, xy, xz, yx, yy, yz, zx, zy, zz] =
        L::sums([ax, ay, az, sums.closing, sums.misfit2, xx, xy, xz, yx, yy, yz, zx, zy, zz]);
    row.springs =
        SpringSums { acceleration: [ax, ay, az], closing, misfit2, moment: [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] };
    if STRESS {
        let [x, y, z] = stresses.acceleration;
        let [x, y, z, stress_power] = L::sums([x, y, z, stresses.stress_power]);
        row.stresses = ForceSums { acceleration: [x, y, z], stress_power, ..ForceSums::zero() };
    }
    row
}

/// The sums of a block of particles over rows of it.
struct SpringSweep<'a, T> {
    records: &'a Records<T>,
    constants: &'a PairConstants<T>,
    instructions: Instructions,
    dimension: Dimension,
    split: EnergySplit,
}

impl<'a, T: PairScalar> SpringSweep<'a, T> {
    fn new(
        records: &'a Records<T>,
        constants: &'a PairConstants<T>,
        instructions: Instructions,
        model: &Model,
    ) -> Self {
        let dimension = super::dimension(model);
        Self { records, constants, instructions, dimension, split: model.numerics.energy_split }
    }

    fn block<const STRESS: bool>(&self, b: usize, block: &Block, sums: &mut [RowSums<T>; BLOCK]) {
        let (records, first, constants, split) = (self.records, b * BLOCK, self.constants, self.split);
        dispatch_dimension!(self.dimension, |D| {
            run(self.instructions, HourglassJob::<T, D, STRESS> { records, first, block, constants, split, sums });
        });
    }
}

/// What the springs of a model have in common.
#[derive(Clone, Copy)]
pub(super) struct SpringLaw {
    strength: f64,
    counted: Counted,
}

impl SpringLaw {
    /// Nothing where there are no springs.
    pub(super) fn of(model: &Model) -> Option<Self> {
        match model.formulation {
            Formulation::TotalLagrangian { hourglass, faces, .. } if hourglass != 0.0 => {
                Some(Self { strength: hourglass, counted: faces.counted() })
            }
            _ => None,
        }
    }

    /// Springs of a particle of this flow stress (Pa) and plastic strain, with the least principal stretch at which it
    /// has yielded.
    pub(super) fn spring(self, of: &Material, yield_stress: f64, plastic_strain: f64, stretch: f64) -> Spring<f64> {
        Spring::new(self.counted, self.strength, of.young_modulus(), yield_stress, plastic_strain, stretch)
    }

    /// Springs of particle `i`.
    fn of_particle(self, materials: &[Material], p: &Particles, i: usize) -> Spring<f64> {
        let material = &materials[p.material[i] as usize];
        self.spring(material, p.yield_stress[i], p.plastic_strain[i], p.yielded_stretch[i])
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Whether there are hourglass springs.
    pub(super) fn has_springs(&self) -> bool {
        SpringLaw::of(&self.model).is_some()
    }

    /// Whether their loop sums stresses as well: where no other terms act along pairs, at volumes of the reference configuration.
    pub(super) fn sums_stress_with_springs(&self) -> bool {
        self.has_springs()
            && self.records.extra.is_empty()
            && self.lists.stored.is_none()
            && self.model.numerics.pair_form == PairForm::VolumeWeighted
    }

    /// Adds the forces of the springs of some pairs of block `b`, as last evaluated, N.
    pub(super) fn add_hourglass_forces(&self, b: usize, rows: &Block, forces: &mut [Vector<f64>]) {
        if self.records.hourglass.is_empty() {
            return;
        }
        let mut sums = [RowSums::zero(); BLOCK];
        SpringSweep::new(&self.records, &self.constants, self.instructions, &self.model)
            .block::<false>(b, rows, &mut sums);
        for (k, force) in forces.iter_mut().enumerate() {
            let springs = &sums[k].springs;
            for a in 0..3 {
                force[a] += self.particles.reference_volume[b * BLOCK + k] * springs.acceleration[a].to_f64();
            }
        }
    }

    /// Adds the hourglass forces to acceleration and energy rate, or gives them together with those of the stresses.
    ///
    /// In single precision the deformation gradient drifts from the fit to the neighbours, by some 1e-8, and springs
    /// would turn the body. The moment that they have then is therefore given to the stress of the next force sum. It is
    /// zero but for rounding, and varies so slowly that one step makes no difference.
    pub(super) fn resist_hourglass(&mut self, rows: Rows) {
        if SpringLaw::of(&self.model).is_none() {
            return;
        }
        self.pack_displacements(rows);
        let with_stress = self.sums_stress_with_springs();
        let inner = &self.inner;
        let list = &self.lists.list;
        let sweep = SpringSweep::new(&self.records, &self.constants, self.instructions, &self.model);
        let Records { kinematic, hourglass: records, .. } = &self.records;
        let per_dimension = 1.0 / sweep.dimension.count() as f64;
        let Particles {
            acceleration,
            energy_rate,
            spring_misfit,
            spring_moment,
            mass,
            reference_volume,
            velocity_gradient,
            deformation,
            ..
        } = &mut self.particles;
        let (velocity_gradient, deformation) = (&*velocity_gradient, &*deformation);
        let (mass, volume, work) = (&*mass, &*reference_volume, &mut self.numerical_work.hourglass);
        (
            acceleration.par_chunks_mut(BLOCK),
            energy_rate.par_chunks_mut(BLOCK),
            spring_misfit.par_chunks_mut(BLOCK),
            spring_moment.par_chunks_mut(BLOCK),
            work.power.par_iter_mut(),
        )
            .into_par_iter()
            .enumerate()
            .filter(|(b, _)| inner.is_summed_in(*b, rows))
            .for_each(|(b, (acceleration, energy_rate, misfit, moment, power))| {
                let mut sums = [RowSums::zero(); BLOCK];
                if with_stress {
                    sweep.block::<true>(b, &list.blocks()[b], &mut sums);
                    for k in 0..acceleration.len() {
                        let i = b * BLOCK + k;
                        let stresses = &sums[k].stresses;
                        let outer = momentum_factor(PairForm::VolumeWeighted, mass[i], kinematic[i][WEIGHT].to_f64());
                        acceleration[k] = stresses.acceleration.map(|a| a.to_f64() * outer);
                        energy_rate[k] = stresses.stress_power.to_f64() * outer;
                    }
                } else {
                    sweep.block::<false>(b, &list.blocks()[b], &mut sums);
                }
                *power = 0.0;
                for k in 0..acceleration.len() {
                    let i = b * BLOCK + k;
                    let (factor, sums) = (volume[i] / mass[i], &sums[k].springs);
                    for a in 0..3 {
                        acceleration[k][a] += factor * sums.acceleration[a].to_f64();
                    }
                    let own_power = sums.energy_rate(records[i][entry::STIFFNESS]).to_f64();
                    energy_rate[k] += factor * own_power;
                    // The stress of the moment has worked in the momentum sum.
                    let rate = tensor::multiply(&velocity_gradient[i], &deformation[i]);
                    let turned = rate.as_flattened().iter().zip(moment[k].as_flattened()).map(|(f, m)| f * m);
                    *power += volume[i] * (own_power + turned.sum::<f64>());
                    misfit[k] = per_dimension * sums.misfit2.to_f64();
                    let half = 0.5 * records[i][entry::STIFFNESS].to_f64();
                    moment[k] = sums.moment.map(|row| row.map(|m| half * m.to_f64()));
                }
            });
    }

    /// The stiffness of hourglass springs, which softens with the strain and with the misfit of the last force sum. Others
    /// read it with the stress, so it must not change while rows are summed.
    pub(super) fn soften_springs(&mut self) {
        let Some(law) = SpringLaw::of(&self.model) else { return };
        let mut stiffness = std::mem::take(&mut self.particles.spring_stiffness);
        let (p, materials) = (&self.particles, &*self.model.materials);
        let update = |(i, stiffness): (usize, &mut f64)| {
            *stiffness = law.of_particle(materials, p, i).at(p.spring_misfit[i]);
        };
        stiffness.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(update);
        self.particles.spring_stiffness = stiffness;
    }

    /// Energy that the hourglass springs of all particles hold, J, at the misfit of the last force sum.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn energy_of_springs(&self) -> Result<f64, RunFailure> {
        let Some(law) = SpringLaw::of(&self.model) else { return Ok(0.0) };
        let (p, dimension, materials) = (&self.particles, super::dimension(&self.model), &*self.model.materials);
        let mut held = [0.0];
        let add = |held: &mut [f64]| {
            for (i, misfit) in p.spring_misfit.iter().enumerate() {
                held[0] += p.reference_volume[i] * law.of_particle(materials, p, i).energy(*misfit, dimension);
            }
        };
        match &self.domain {
            None => add(&mut held),
            Some(domain) => domain.ranks.sum_in_turn(&mut held, add)?,
        }
        Ok(held[0])
    }

    /// Writes the data of particles and ghosts that the sum reads: velocities at which forces are evaluated,
    /// displacements and their gradients, springs; for particles with the first rows, for ghosts when they have arrived.
    pub(super) fn pack_displacements(&mut self, rows: Rows) {
        if !(rows.is_first() || rows.is_last()) {
            return;
        }
        let count = self.particles.len();
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
                    let displacement = p.position[i][a] - p.reference_position[i][a];
                    [spring_record[entry::U + a], spring_record[entry::U_REST + a]] = T::of_displacement(displacement);
                }
                for c in 0..9 {
                    let (a, b) = (c / 3, c % 3);
                    let identity = if a == b { 1.0 } else { 0.0 };
                    let gradient = p.deformation[i][a][b] - identity;
                    // Springs see the motion that the sums do not.
                    let gradient = p.face_excess.get(i).map_or(gradient, |excess| gradient + excess[a][b]);
                    spring_record[entry::H + c] = T::of_displacement_gradient(gradient);
                }
                spring_record[entry::STIFFNESS] = T::of(p.spring_stiffness[i]);
            });
        }
    }
}
