//! Velocity gradients of what may meet at facets, at the velocities at which forces are evaluated.

use super::CpuEngine;
use super::contact::BodyContacts;
use super::ghosts::WithGhosts;
use crate::lanes::PairScalar;
use crate::neighbors::{BLOCK, ForeignList, NeighborList};
use rayon::prelude::*;
use sphorge_physics::gradient_correction::corrected;
use sphorge_physics::kernel::{Kernel, pair_smoothing_length};
use sphorge_physics::tensor::{dot, inverse, multiply};
use sphorge_physics::thin::is_thin;
use sphorge_physics::{Dimension, Tensor, Vector};

/// A neighbour in the reference configuration.
#[derive(Clone, Copy, Debug)]
struct Weighted {
    /// Its volume times the slope of the kernel, negative.
    weight: f64,
    /// From there to the particle, m.
    way: Vector<f64>,
}

/// Weights of the rows of all particles that may meet others: they stay as long as the lists do.
#[derive(Clone, Debug, Default)]
pub(super) struct ReferenceWeights {
    /// Block by block, row after row.
    blocks: Vec<Vec<Weighted>>,
    /// Of each particle where its own begin in its block; [`NONE`] without.
    starts: Vec<u32>,
    /// State of the list for which they were found; none if pairs were found since.
    of: Option<u64>,
}

/// A particle without stored weights.
const NONE: u32 = u32::MAX;

impl ReferenceWeights {
    /// Other particles may meet now.
    pub(super) fn forget(&mut self) {
        self.of = None;
    }

    fn refresh(&mut self, sum: &ReferenceSum<'_>, foreign: &ForeignList, count: usize, list: &NeighborList) {
        if self.of == Some(list.changes()) {
            return;
        }
        self.of = Some(list.changes());
        self.starts.clear();
        self.starts.resize(count, NONE);
        self.blocks.resize_with(foreign.blocks().len(), Vec::new);
        let blocks = (self.blocks.par_iter_mut(), self.starts.par_chunks_mut(BLOCK)).into_par_iter();
        blocks.zip(foreign.blocks()).for_each(|((weights, starts), block)| {
            weights.clear();
            for (i, _) in block.rows() {
                starts[i % BLOCK] = weights.len() as u32;
                weights.extend(list.row(i).iter().map(|&j| sum.weighted(i, j as usize)));
            }
        });
    }

    /// Those of a particle with so many neighbours.
    fn of_particle(&self, i: usize, neighbors: usize) -> Option<&[Weighted]> {
        let start = self.starts.get(i).copied().filter(|start| *start != NONE)? as usize;
        Some(&self.blocks[i / BLOCK][start..start + neighbors])
    }

    pub(super) fn bytes(&self) -> usize {
        self.blocks.iter().map(Vec::capacity).sum::<usize>() * size_of::<Weighted>()
            + self.starts.capacity() * size_of::<u32>()
    }
}

/// Sums over the neighbours in the reference configuration.
#[derive(Clone, Copy)]
struct ReferenceSum<'a> {
    kernel: Kernel,
    dimension: Dimension,
    position: WithGhosts<'a, Vector<f64>>,
    volume: WithGhosts<'a, f64>,
    smoothing_length: WithGhosts<'a, f64>,
    velocity: WithGhosts<'a, Vector<f64>>,
}

impl ReferenceSum<'_> {
    fn weighted(&self, i: usize, j: usize) -> Weighted {
        let (own, other) = (self.position.at(i), self.position.at(j));
        let way: Vector<f64> = std::array::from_fn(|k| own[k] - other[k]);
        let h = pair_smoothing_length(self.smoothing_length.at(i), self.smoothing_length.at(j));
        Weighted { weight: -self.volume.at(j) * self.kernel.slope(self.dimension, dot(way, way).sqrt(), h), way }
    }

    /// `dF/dt` at the velocities at which forces are evaluated, before the correction, 1/s.
    fn rate(&self, i: usize, row: &[u32], weights: Option<&[Weighted]>) -> Tensor<f64> {
        let mut rate = [[0.0; 3]; 3];
        let own = self.velocity.at(i);
        let mut add = |j: u32, Weighted { weight, way }: Weighted| {
            let other = self.velocity.at(j as usize);
            for k in 0..3 {
                for c in 0..3 {
                    rate[k][c] += weight * (other[k] - own[k]) * way[c];
                }
            }
        };
        match weights {
            Some(weights) => row.iter().zip(weights).for_each(|(&j, weighted)| add(j, *weighted)),
            None => row.iter().for_each(|&j| add(j, self.weighted(i, j as usize))),
        }
        rate
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Velocity gradients of what may meet at facets, as their forces work in the sums over particles. That of the deformation belongs to the middle of the step.
    pub(super) fn follow_evaluated(&mut self) {
        let has_facets = self.contacts.as_ref().is_some_and(|contacts| contacts.facets.is_some());
        if !has_facets && self.facets_on_walls.is_none() {
            return;
        }
        let mut gradients = std::mem::take(&mut self.particles.evaluated_gradient);
        let mut face_sums = self.face_sums.take();
        let (p, ghosts, list) = (&self.particles, &self.ghosts.columns, &self.lists.list);
        let sum = ReferenceSum {
            kernel: self.model.numerics.kernel,
            dimension: self.model.dimensions.into(),
            position: WithGhosts::new(&p.reference_position, &ghosts.reference_position),
            volume: WithGhosts::new(&p.reference_volume, &ghosts.reference_volume),
            smoothing_length: WithGhosts::new(&p.smoothing_length, &ghosts.smoothing_length),
            velocity: WithGhosts::new(&p.evaluated_velocity, &ghosts.evaluated_velocity),
        };
        if let Some(BodyContacts { foreign, facets: Some(facets), .. }) = &mut self.contacts {
            facets.weights.refresh(&sum, foreign, p.len(), list);
        }
        let contacts = self.contacts.as_ref().and_then(|contacts| Some((contacts, contacts.facets.as_ref()?)));
        let linear = |i: usize| {
            let row = list.row(i);
            let weights = contacts.and_then(|(_, facets)| facets.weights.of_particle(i, row.len()));
            corrected(&sum.rate(i, row, weights), &p.correction[i])
        };
        let near_wall = |i: usize| {
            self.facets_on_walls.as_ref().is_some_and(|of| of.is_near_any(&self.model, &self.walls.states, p, i))
        };
        if let Some(face_sums) = &mut face_sums {
            let met = contacts.iter().flat_map(|(contacts, _)| contacts.foreign.blocks());
            let met = met.flat_map(|block| block.rows().map(|(i, _)| i));
            face_sums.evaluate(met.chain((0..p.len()).filter(|i| near_wall(*i))), linear);
        }
        let gradient = |i: usize| {
            // What the sums of thin parts do not see across them is that of the middle of the step.
            if is_thin(&p.correction[i]) > 0.0 {
                return p.velocity_gradient[i];
            }
            let rate = match &face_sums {
                None => linear(i),
                Some(face_sums) => face_sums.evaluated_rate(i, super::dimension(&self.model)),
            };
            multiply(&rate, &inverse(&p.deformation[i]))
        };
        if let Some((contacts, _)) = contacts {
            let blocks = gradients.par_chunks_mut(BLOCK).zip(contacts.foreign.blocks());
            blocks.for_each(|(gradients, block)| block.rows().for_each(|(i, _)| gradients[i % BLOCK] = gradient(i)));
        }
        if self.facets_on_walls.is_some() {
            let all = gradients.par_iter_mut().with_min_len(BLOCK).enumerate();
            all.filter(|(i, _)| near_wall(*i)).for_each(|(i, own)| *own = gradient(i));
        }
        self.particles.evaluated_gradient = gradients;
        self.face_sums = face_sums;
    }
}
