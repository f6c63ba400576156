//! What the lists miss: a comparison with an exact full search.

use super::super::CpuEngine;
use super::super::ghosts::WithGhosts;
use super::super::stored::StoredBlock;
use super::place;
use crate::Audit;
use crate::lanes::PairScalar;
use crate::neighbors::{BLOCK, DisplacementBound, NeighborList, Reach, Searcher, brute_force};
use rayon::prelude::*;
use sphorge_physics::kernel::pair_smoothing_length;
use sphorge_physics::{SymmetricTensor, Vector, tensor::dot};

/// Up to this many points every pair is tested; beyond, a cell search of its own finds the pairs.
const EVERY_PAIR_UP_TO: usize = 2000;

/// Sums of one particle in double precision: rate of `ln rho` and acceleration by stress alone.
#[derive(Clone, Copy, Default)]
struct Sums {
    divergence: f64,
    acceleration: Vector<f64>,
    /// Acceleration by particles, not ghosts.
    internal: Vector<f64>,
    pairs: u64,
    missed: u64,
    missed_foreign: u64,
    stale: u64,
}

impl<T: PairScalar> CpuEngine<T> {
    /// Compares the lists, at the positions as they are, with an exact search: pairs within the kernel support that are
    /// missing, pairs beyond it, and what both do to density rate and force.
    pub(in super::super) fn audit_lists(&mut self) -> Audit {
        // Those of the lists may be older.
        let (mut points, mut smoothing_length) = (Vec::new(), Vec::new());
        place(&self.particles, &self.ghosts, false, &mut points, &mut smoothing_length);
        let count = self.particles.len();
        let factor = self.model.numerics.kernel.support();
        let lists = &self.lists;
        let reach = Reach::new(&smoothing_length, factor);
        let exact = if points.len() <= EVERY_PAIR_UP_TO {
            brute_force(&points, count, &reach)
        } else {
            let mut exact = NeighborList::default();
            // A hair more than the support: the distance decides below.
            let reach = Reach { factor: factor * (1.0 + 1e-5), ..reach };
            Searcher::default().search(
                &points,
                count,
                &reach,
                DisplacementBound::default(),
                self.instructions,
                &mut exact,
            );
            exact
        };
        let (ours, theirs): (Vec<Sums>, Vec<Sums>) = (0..count)
            .into_par_iter()
            .map(|i| {
                let ours = self.audit_row(i, &reach, &points, &lists.list, true, &exact);
                (ours, self.audit_row(i, &reach, &points, &exact, false, &lists.list))
            })
            .unzip();

        let mass = &self.particles.mass;
        let mut audit = Audit::default();
        let [mut divergence_error, mut divergence, mut force_error, mut force, mut scale] = [0.0; 5];
        let mut momentum = [0.0; 3];
        for (i, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            audit.pairs += theirs.pairs;
            audit.missed_pairs += theirs.missed;
            audit.missed_foreign_pairs += theirs.missed_foreign;
            audit.stale_pairs += ours.stale;
            divergence_error += (ours.divergence - theirs.divergence).powi(2);
            divergence += theirs.divergence.powi(2);
            let difference = [0, 1, 2].map(|a| mass[i] * (ours.acceleration[a] - theirs.acceleration[a]));
            force_error += dot(difference, difference);
            force += mass[i] * mass[i] * dot(theirs.acceleration, theirs.acceleration);
            scale += mass[i] * dot(ours.internal, ours.internal).sqrt();
            for a in 0..3 {
                momentum[a] += mass[i] * ours.internal[a];
            }
        }
        let ratio = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        audit.density_rate_error = ratio(divergence_error, divergence).sqrt();
        audit.force_error = ratio(force_error, force).sqrt();
        audit.momentum_residual = ratio(dot(momentum, momentum).sqrt(), scale);
        audit
    }

    /// Sums of particle `i` of the given points over its row in `list`; pairs that `other` lacks are missed there. With `kept`, distances are those
    /// of the last search where the strategy keeps them.
    fn audit_row(
        &self,
        i: usize,
        reach: &Reach<'_>,
        points: &[Vector<f64>],
        list: &NeighborList,
        kept: bool,
        other: &NeighborList,
    ) -> Sums {
        let particles = &self.particles;
        let count = particles.len();
        let lists = &self.lists;
        let kernel = self.model.numerics.kernel;
        let dimension = super::super::dimension(&self.model);
        let (b, k) = (i / BLOCK, i % BLOCK);
        let stored: Option<&StoredBlock<T>> = lists.stored.as_ref().filter(|_| kept).map(|s| s.block(b));
        let ghosts = &self.ghosts.columns;
        let (deviators, pressures) = (
            WithGhosts::new(&particles.deviator, &ghosts.deviator),
            WithGhosts::new(&particles.pressure, &ghosts.pressure),
        );
        let masses = WithGhosts::new(&particles.mass, &ghosts.mass);
        let densities = WithGhosts::new(&particles.density, &ghosts.density);
        let velocities = WithGhosts::new(&particles.velocity, &ghosts.velocity);
        let bodies = WithGhosts::new(&particles.body, &ghosts.body);
        let stress = |j: usize| deviators.at(j) - SymmetricTensor::isotropic(pressures.at(j));
        let mut sums = Sums::default();
        let row_start = list.blocks()[b].start(k);
        let known = other.row(i);
        for (n, &j) in list.row(i).iter().enumerate() {
            let j = j as usize;
            let now = [0, 1, 2].map(|a| points[i][a] - points[j][a]);
            let h = pair_smoothing_length(reach.smoothing_length[i], reach.smoothing_length[j]);
            let inside = dot(now, now).sqrt() < kernel.support() * h;
            sums.stale += u64::from(kept && !inside);
            if !kept {
                if !inside {
                    continue;
                }
                sums.pairs += 1;
                let in_contact = || self.contacts.as_ref().is_some_and(|c| c.has_pair(i, j as u32));
                if !known.contains(&(j as u32)) && !in_contact() {
                    sums.missed += 1;
                    sums.missed_foreign += u64::from(bodies.at(i) != bodies.at(j));
                }
            }
            let x = stored.map_or(now, |s| s.distance(row_start + n));
            let f = -kernel.slope(dimension, dot(x, x).sqrt(), h);
            let volume = masses.at(j) / densities.at(j);
            let (v_i, v_j) = (velocities.at(i), velocities.at(j));
            let v: Vector<f64> = [0, 1, 2].map(|a| v_j[a] - v_i[a]);
            sums.divergence += volume * f * dot(v, x);
            let traction = (stress(i) + stress(j)).dot(x);
            for a in 0..3 {
                let acceleration = volume / particles.density[i] * f * traction[a];
                sums.acceleration[a] += acceleration;
                if j < count {
                    sums.internal[a] += acceleration;
                }
            }
        }
        sums
    }
}
