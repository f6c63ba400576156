//! The two pair loops over all blocks: packing their input, choosing the compiled variant, storing their sums.

use super::CpuEngine;
use super::forces::{ForceJob, ForceSum, ForceTerms};
use super::inner::Rows;
use super::kinematics::PairConstants;
use super::kinematics::{GradientJob, GradientSum};
use super::numerical_work::NumericalWork;
use super::records::{Records, kinematic};
use super::search::Lists;
use super::stored::{StoredBlock, StoredPairs};
use crate::lanes::{Instructions, PairScalar, run};
use crate::neighbors::{BLOCK, Block, NeighborList};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::viscosity::ViscosityParameters;
use sphorge_physics::{Dimension, Vector, pair};

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

pub(super) use dispatch_dimension;

/// The sums of the first pair loop, block by block, over the records. The compiled variant is chosen once per block:
/// loops over blocks are compiled only once.
pub(super) struct GradientSweep<'a, T> {
    records: &'a [[T; kinematic::LEN]],
    list: &'a NeighborList,
    stored: Option<&'a StoredPairs<T>>,
    constants: &'a PairConstants<T>,
    instructions: Instructions,
    dimension: Dimension,
}

impl<'a, T: PairScalar> GradientSweep<'a, T> {
    pub(super) fn new(
        records: &'a Records<T>,
        lists: &'a Lists<T>,
        constants: &'a PairConstants<T>,
        instructions: Instructions,
        dimension: Dimension,
    ) -> Self {
        let stored = lists.stored.as_ref();
        Self { records: &records.kinematic, list: &lists.list, stored, constants, instructions, dimension }
    }

    /// Sums of the particles of block `b`; with `moments` also those of the gradient correction.
    pub(super) fn block(&self, b: usize, moments: bool, sums: &mut [GradientSum<T>; BLOCK]) {
        dispatch_dimension!(self.dimension, |D| {
            if moments { self.variant::<D, true>(b, sums) } else { self.variant::<D, false>(b, sums) }
        });
    }

    fn variant<const D: usize, const CORRECTED: bool>(&self, b: usize, sums: &mut [GradientSum<T>; BLOCK]) {
        let job = GradientJob::<T, D, CORRECTED> {
            records: self.records,
            first: b * BLOCK,
            block: &self.list.blocks()[b],
            stored: self.stored.map(|s| s.block(b)),
            constants: self.constants,
            sums,
        };
        run(self.instructions, job);
    }
}

/// The sums of the second pair loop, block by block.
struct ForceSweep<'a, T> {
    records: &'a Records<T>,
    constants: &'a PairConstants<T>,
    instructions: Instructions,
    dimension: Dimension,
    corrected: bool,
    terms: &'a ForceTerms<T>,
}

impl<T: PairScalar> ForceSweep<'_, T> {
    /// Sums of the particles of block `b` over its `rows`. Corrected sums have no variant for the default terms,
    /// because few decks use both.
    fn block(
        &self,
        b: usize,
        rows: &Block,
        stored: Option<&StoredBlock<T>>,
        default_terms: bool,
        sums: &mut [ForceSum<T>; BLOCK],
    ) {
        dispatch_dimension!(self.dimension, |D| match (self.corrected, default_terms) {
            (true, _) => self.variant::<D, true, false>(b, rows, stored, sums),
            (false, true) => self.variant::<D, false, true>(b, rows, stored, sums),
            (false, false) => self.variant::<D, false, false>(b, rows, stored, sums),
        });
    }

    fn variant<const D: usize, const CORRECTED: bool, const DEFAULT: bool>(
        &self,
        b: usize,
        rows: &Block,
        stored: Option<&StoredBlock<T>>,
        sums: &mut [ForceSum<T>; BLOCK],
    ) {
        let job = ForceJob::<T, D, CORRECTED, DEFAULT> {
            records: self.records,
            first: b * BLOCK,
            block: rows,
            stored,
            constants: self.constants,
            terms: self.terms,
            sums,
        };
        run(self.instructions, job);
    }
}

/// Output of the force sum of a block: acceleration, energy rate, XSPH velocity, `mu`, and the powers of the pair
/// viscosity and of the artificial stress, W.
type ForceColumns<'a> =
    (&'a mut [Vector<f64>], &'a mut [f64], &'a mut [Vector<f64>], &'a mut [f64], (&'a mut f64, &'a mut f64));

impl<T: PairScalar> CpuEngine<T> {
    /// Whether sums use corrected gradients.
    pub(super) fn corrected(&self) -> bool {
        self.formulation.is_corrected(&self.model)
    }

    /// Allocates memory for the records of all particles and ghosts.
    pub(super) fn make_records(&mut self) {
        let numerics = &self.model.numerics;
        let extra = numerics.artificial_stress.is_some() || numerics.balsara || numerics.xsph != 0.0;
        let corrected = self.corrected();
        self.records.resize(self.particles.len() + self.ghosts.count(), extra, corrected);
    }

    /// Adds up the pairs of the last velocity gradient.
    pub(super) fn count_pairs(&mut self) {
        self.step.pairs = self.particles.neighbors.iter().map(|&n| u64::from(n)).sum();
    }

    /// Terms of the pair forces besides the stress.
    fn force_terms(&self) -> ForceTerms<T> {
        let numerics = &self.model.numerics;
        let viscosity = self.formulation.pair_viscosity(&self.model);
        ForceTerms {
            viscosity: viscosity.map(|of| ViscosityParameters { alpha: T::of(of.alpha), beta: T::of(of.beta) }),
            artificial_stress: numerics.artificial_stress.map(|a| a.exponent),
            balsara: numerics.balsara,
            xsph: numerics.xsph != 0.0,
            pair_form: numerics.pair_form,
            energy_split: numerics.energy_split,
        }
    }

    /// Forces on the particles of block `b` by some of their pairs, N, in the state of the last force evaluation.
    pub(super) fn forces_of_rows(&self, b: usize, rows: &Block, stored: Option<&StoredBlock<T>>) -> Vec<Vector<f64>> {
        let terms = self.force_terms();
        let sweep = ForceSweep {
            records: &self.records,
            constants: &self.constants,
            instructions: self.instructions,
            dimension: super::dimension(&self.model),
            corrected: self.corrected(),
            terms: &terms,
        };
        let mut sums = [ForceSum::zero(); BLOCK];
        sweep.block(b, rows, stored, terms.are_default(self.model.numerics.kernel), &mut sums);
        let force = |k: usize| {
            let (i, mass) = (b * BLOCK + k, self.particles.mass[b * BLOCK + k]);
            let weight = self.records.force[i][super::records::force::WEIGHT].to_f64();
            let outer = mass * pair::momentum_factor(terms.pair_form, mass, weight);
            sums[k].acceleration.map(|a| outer * a.to_f64())
        };
        (0..rows.len()).map(force).collect()
    }

    /// Acceleration by pair forces, energy rate, XSPH velocity, unless the loop over springs sums them.
    pub(super) fn sum_forces(&mut self, rows: Rows) {
        if self.sums_stress_with_springs() {
            return;
        }
        let numerics = &self.model.numerics;
        let pair_form = numerics.pair_form;
        let viscosity_of_pairs = self.formulation.pair_viscosity(&self.model).is_some();
        let terms = self.force_terms();
        let default_terms = terms.are_default(numerics.kernel);
        let strength = numerics.xsph;
        let (list, stored) = (&self.lists.list, self.lists.stored.as_ref());
        let sweep = ForceSweep {
            records: &self.records,
            constants: &self.constants,
            instructions: self.instructions,
            dimension: super::dimension(&self.model),
            corrected: self.corrected(),
            terms: &terms,
        };
        let Particles { acceleration, energy_rate, mass, xsph, mu, artificial_power, .. } = &mut self.particles;
        let NumericalWork { viscous, artificial_stress, .. } = &mut self.numerical_work;
        let mass = &*mass;
        let inner = &self.inner;
        let room = || [ForceSum::zero(); BLOCK];
        let sum_block = |sums: &mut [ForceSum<T>; BLOCK], b: usize, columns: ForceColumns<'_>, powers: &mut [f64]| {
            let (a, e, x, mu, (viscous, repulsive)) = columns;
            if viscosity_of_pairs {
                *viscous = 0.0;
            }
            *repulsive = 0.0;
            sweep.block(b, &list.blocks()[b], stored.map(|s| s.block(b)), default_terms, sums);
            for (k, sum) in sums.iter().enumerate().take(a.len()) {
                let i = b * BLOCK + k;
                let weight = sweep.records.force[i][super::records::force::WEIGHT].to_f64();
                let outer = pair::momentum_factor(pair_form, mass[i], weight);
                a[k] = sum.acceleration.map(|v| v.to_f64() * outer);
                e[k] = sum.energy_rate.to_f64() * outer;
                x[k] = sum.xsph.map(|v| v.to_f64() * strength);
                if viscosity_of_pairs {
                    mu[k] = sum.mu.to_f64();
                    *viscous += mass[i] * outer * sum.viscous_power.to_f64();
                }
                let artificial_power = sum.artificial_power.to_f64() * outer;
                *repulsive += mass[i] * artificial_power;
                if let Some(power) = powers.get_mut(k) {
                    *power = artificial_power;
                }
            }
        };
        let blocks = (
            acceleration.par_chunks_mut(BLOCK),
            energy_rate.par_chunks_mut(BLOCK),
            xsph.par_chunks_mut(BLOCK),
            mu.par_chunks_mut(BLOCK),
            (viscous.power.par_iter_mut(), artificial_stress.power.par_iter_mut()).into_par_iter(),
        )
            .into_par_iter()
            .enumerate();
        // The column is empty if it is not needed.
        if artificial_power.is_empty() {
            blocks
                .filter(|(b, _)| inner.is_summed_in(*b, rows))
                .for_each_init(room, |sums, (b, columns)| sum_block(sums, b, columns, &mut []));
        } else {
            blocks
                .zip(artificial_power.par_chunks_mut(BLOCK))
                .filter(|((b, _), _)| inner.is_summed_in(*b, rows))
                .for_each_init(room, |sums, ((b, columns), powers)| sum_block(sums, b, columns, powers));
        }
    }
}
