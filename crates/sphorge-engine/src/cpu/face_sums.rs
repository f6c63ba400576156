//! Gradients that are exact for quadratic fields at faces: what is taken from the sums of particles at faces, and the transpose of it, which
//! is added to their stresses. The formulas are in [`sphorge_physics::face_gradient`].
//!
//! Few particles are at a face, so that the pair sums stay as they are and this is a second, sparse pass. Its terms are found once for a
//! reference configuration, in the order of the rows of the list; images are entries of the particles they are images of. On ranks, faces
//! read the sums of particles of other ranks, and particles the stresses of faces of other ranks, which are sent where they are read.

mod found;

pub use found::{FaceConfiguration, FaceNeighbor, face_terms};

use super::sweeps::dispatch_dimension;
use crate::halo::{self, Exchanged, GhostColumn, Halo, Remote};
use crate::lanes::{Instructions, Job, Lanes, run};
use crate::model::Model;
use crate::neighbors::BLOCK;
use rayon::prelude::*;
use smallvec::smallvec;
use sphorge_physics::face_gradient::{ThirdOrder, add_difference, along, excess, power as power_of, spread};
use sphorge_physics::tensor::plus;
use sphorge_physics::{Dimension, Tensor, Vector};

/// Particles or faces that one thread takes at least.
const AT_ONCE: usize = 64;

/// A term of a sum: a neighbour at a face, or of one.
#[derive(Clone, Copy, Debug)]
pub struct FaceTerm {
    /// Index of the particle, or of the face.
    pub other: u32,
    /// Axes along which it is an image of that.
    pub mirrored: [bool; 3],
    /// `q_ij`, 1/m; of the transpose `V_j/V_i q_ji`.
    pub q: Vector<f64>,
}

impl FaceTerm {
    /// A tensor of the particle as that of the image.
    #[inline(always)]
    fn seen(&self, tensor: &Tensor<f64>) -> Tensor<f64> {
        let mut seen = *tensor;
        if self.mirrored != [false; 3] {
            for a in 0..3 {
                for b in 0..3 {
                    if self.mirrored[a] != self.mirrored[b] {
                        seen[a][b] = -seen[a][b];
                    }
                }
            }
        }
        seen
    }
}

/// The terms of the particles at faces and of those near them.
#[derive(Debug, Default)]
pub struct FaceTerms {
    /// Particles at faces, ascending; on ranks behind them faces of other ranks, numbered after the particles.
    pub faces: Vec<u32>,
    /// `K_i` of each, m.
    pub contraction: Vec<ThirdOrder>,
    /// `sum_j q_ij` of those of this process, 1/m.
    pub whole: Vec<Vector<f64>>,
    /// First term of each of these, and the number of all.
    pub starts: Vec<u32>,
    /// Their neighbours.
    pub terms: Vec<FaceTerm>,
    /// Particles of this process at faces and neighbours of faces, ascending.
    pub near: Vec<u32>,
    /// First term of each, and the number of all.
    pub near_starts: Vec<u32>,
    /// The faces they are neighbours of.
    pub near_terms: Vec<FaceTerm>,
    /// Index among the faces of those that are at one.
    pub face_of_near: Vec<Option<u32>>,
}

impl FaceTerms {
    fn of_face(&self, face: usize) -> &[FaceTerm] {
        &self.terms[self.starts[face] as usize..self.starts[face + 1] as usize]
    }

    fn of_near(&self, n: usize) -> &[FaceTerm] {
        &self.near_terms[self.near_starts[n] as usize..self.near_starts[n + 1] as usize]
    }

    fn bytes(&self) -> usize {
        size_of::<FaceTerm>() * (self.terms.capacity() + self.near_terms.capacity())
            + size_of::<ThirdOrder>() * self.contraction.capacity()
            + size_of::<Vector<f64>>() * self.whole.capacity()
    }
}

/// What is read of other ranks.
struct Others {
    neighbors: Remote,
    faces: Remote,
}

/// Fills the tensors of other ranks' particles, which stand behind those of `count` particles here. The engine reports the loss of a rank.
fn receive(from: &Remote, tensors: &mut [Tensor<f64>], count: usize) {
    let (own, ghosts) = tensors.split_at_mut(count);
    halo::fill(smallvec![Exchanged { halo: from, columns: smallvec![GhostColumn::Tensor(own, ghosts)] }]);
}

/// The sums of the particles at faces and of those near them.
#[derive(Default)]
pub(super) struct FaceSums {
    /// Whether they belong to the present reference configuration.
    is_known: bool,
    /// Particles of this process.
    count: usize,
    /// Particles of other ranks whose sums faces here read, and faces of other ranks whose stresses particles here read.
    others: Option<Others>,
    of: FaceTerms,
    /// Whether blocks have particles at faces, and near them.
    has_faces: Vec<bool>,
    is_near: Vec<bool>,
    /// `G_i` of particles in blocks that are near, and of those of other ranks, 1/s.
    linear: Vec<Tensor<f64>>,
    /// Those at the velocities at which forces are evaluated, of particles that meet something; which these are.
    evaluated: Vec<Tensor<f64>>,
    is_wanted: Vec<bool>,
    wanted: Vec<u32>,
    /// `E_i` of each face of this process, 1/s.
    excess: Vec<Tensor<f64>>,
    /// `R_i` of each face, Pa m.
    spread: Vec<ThirdOrder>,
    /// Stresses that work on the sums, of all particles; of faces of other ranks those that work on exact gradients, Pa.
    stresses: Vec<Tensor<f64>>,
    /// What is added to the stress of particles near faces, Pa, and what they have of the power of others, W/kg.
    shared: Vec<(Tensor<f64>, f64)>,
}

impl FaceSums {
    /// Nothing where a model has gradients that are exact for linear fields only.
    pub(super) fn of(model: &Model) -> Option<Self> {
        model.formulation.is_quadratic_at_faces().then(Self::default)
    }

    /// Whether the terms are those of the present reference configuration.
    pub(super) fn is_known(&self) -> bool {
        self.is_known
    }

    /// Makes the terms be found again.
    pub(super) fn forget(&mut self) {
        self.is_known = false;
    }

    /// Whether block `b` has particles at faces, whose deformation waits for their neighbours.
    pub(super) fn waits(&self, b: usize) -> bool {
        self.has_faces[b]
    }

    /// Whether the sums `G_i` of a block are needed and whether it [waits](Self::waits), and where they are put, block by block.
    pub(super) fn linear_chunks(&mut self) -> impl IndexedParallelIterator<Item = (&bool, &bool, &mut [Tensor<f64>])> {
        (&self.is_near, &self.has_faces, self.linear.par_chunks_mut(BLOCK)).into_par_iter()
    }

    /// The rates of the deformation of a block: its `G_i`, and for those at faces `F_i` and in `taken` what has been taken from it.
    pub(super) fn rates(&self, b: usize, rates: &mut [Tensor<f64>; BLOCK], taken: &mut [Tensor<f64>; BLOCK]) {
        let first = b * BLOCK;
        let end = (first + BLOCK).min(self.count);
        rates[..end - first].copy_from_slice(&self.linear[first..end]);
        *taken = [[[0.0; 3]; 3]; BLOCK];
        let faces = &self.of.faces;
        let from = faces.partition_point(|&i| (i as usize) < first);
        for (face, &i) in faces.iter().enumerate().skip(from).take_while(|(_, i)| (**i as usize) < end) {
            let k = i as usize - first;
            taken[k] = self.excess[face];
            rates[k] = plus(&rates[k], -1.0, &taken[k]);
        }
    }

    /// Finds the sums at the velocities at which forces are evaluated, `linear`, of these particles and of what those of them at faces take
    /// from their own.
    pub(super) fn evaluate(
        &mut self,
        particles: impl Iterator<Item = usize>,
        linear: impl Fn(usize) -> Tensor<f64> + Sync,
    ) {
        let Self { count, others, of, is_wanted, wanted, evaluated, .. } = self;
        let mut want = |i: usize| {
            if !std::mem::replace(&mut is_wanted[i], true) {
                wanted.push(i as u32);
            }
        };
        for i in particles {
            want(i);
            if let Ok(face) = of.faces.binary_search(&(i as u32)) {
                of.of_face(face).iter().for_each(|term| want(term.other as usize));
            }
        }
        // Which faces of other ranks meet something is not known here.
        others.iter().flat_map(|others| others.neighbors.read()).for_each(|i| want(i as usize));
        let is_wanted = &*is_wanted;
        evaluated[..*count].par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, rate)| {
            if is_wanted[i] {
                *rate = linear(i);
            }
        });
        if let Some(others) = others {
            receive(&others.neighbors, evaluated, *count);
        }
        for i in self.wanted.drain(..) {
            self.is_wanted[i as usize] = false;
        }
    }

    /// The rate of the deformation of a particle of the last [evaluation](Self::evaluate), 1/s.
    pub(super) fn evaluated_rate(&self, i: usize, dimension: Dimension) -> Tensor<f64> {
        let own = &self.evaluated[i];
        let Ok(face) = self.of.faces.binary_search(&(i as u32)) else { return *own };
        dispatch_dimension!(dimension, |D| {
            let mut sum = [[[0.0; 3]; 3]; 3];
            for term in self.of.of_face(face) {
                add_difference::<f64, D>(&mut sum, own, &term.seen(&self.evaluated[term.other as usize]), &term.q);
            }
            plus(own, -1.0, &excess::<f64, D>(&self.of.contraction[face], &sum))
        })
    }

    /// Finds what is to be taken from the sums of the faces.
    pub(super) fn find_excess(&mut self, instructions: Instructions, dimension: Dimension) {
        let Self { count, others, of, linear, excess, .. } = self;
        if let Some(others) = others {
            receive(&others.neighbors, linear, *count);
        }
        excess.par_chunks_mut(AT_ONCE).enumerate().for_each(|(chunk, excess)| {
            let first = chunk * AT_ONCE;
            dispatch_dimension!(dimension, |D| run(instructions, ExcessJob::<D> { first, of, linear, excess }));
        });
    }

    /// Finds the stresses that work on the sums of all particles, from those that work on exact gradients, `stress`, Pa; and the energy that
    /// each particle has of the stresses of others. `density` is that of the reference configuration, kg/m^3.
    pub(super) fn transpose(
        &mut self,
        stress: impl Fn(usize) -> Tensor<f64> + Sync,
        (instructions, dimension): (Instructions, Dimension),
        density: impl Fn(usize) -> f64 + Sync,
    ) {
        let found = self.stresses[..self.count].par_iter_mut().with_min_len(BLOCK).enumerate();
        found.for_each(|(i, found)| *found = stress(i));
        if let Some(others) = &self.others {
            receive(&others.faces, &mut self.stresses, self.count);
        }
        let Self { of, spread, stresses, .. } = self;
        spread.par_chunks_mut(AT_ONCE).enumerate().for_each(|(chunk, spread)| {
            let first = chunk * AT_ONCE;
            dispatch_dimension!(dimension, |D| run(instructions, SpreadJob::<D> { first, of, stresses, spread }));
        });
        let mut shared = std::mem::take(&mut self.shared);
        let of = &*self;
        shared.par_chunks_mut(AT_ONCE).enumerate().for_each(|(chunk, shared)| {
            let first = chunk * AT_ONCE;
            dispatch_dimension!(dimension, |D| run(instructions, ShareJob::<D> { first, of, shared }));
            for (n, (_, power)) in shared.iter_mut().enumerate() {
                *power /= density(of.of.near[first + n] as usize);
            }
        });
        for (&i, (more, _)) in self.of.near.iter().zip(&shared) {
            let own = &mut self.stresses[i as usize];
            *own = plus(own, 1.0, more);
        }
        self.shared = shared;
    }

    /// The stresses that work on the sums `G_i`, Pa.
    pub(super) fn stresses(&self) -> &[Tensor<f64>] {
        &self.stresses
    }

    /// Adds the energy that particles have of the stresses of others.
    pub(super) fn share_power(&self, energy_rate: &mut [f64]) {
        for (&i, (_, power)) in self.of.near.iter().zip(&self.shared) {
            energy_rate[i as usize] += power;
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.of.bytes()
            + size_of::<ThirdOrder>() * self.spread.capacity()
            + size_of::<Tensor<f64>>()
                * (self.linear.capacity()
                    + self.evaluated.capacity()
                    + self.excess.capacity()
                    + self.stresses.capacity()
                    + self.shared.capacity())
            + self.others.as_ref().map_or(0, |others| others.neighbors.bytes() + others.faces.bytes())
    }
}

/// `E_i` of faces.
struct ExcessJob<'a, const D: usize> {
    first: usize,
    of: &'a FaceTerms,
    linear: &'a [Tensor<f64>],
    excess: &'a mut [Tensor<f64>],
}

impl<const D: usize> Job<f64> for ExcessJob<'_, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        for (n, result) in self.excess.iter_mut().enumerate() {
            let face = self.first + n;
            let own = &self.linear[self.of.faces[face] as usize];
            let mut sum = [[[0.0; 3]; 3]; 3];
            for term in self.of.of_face(face) {
                let other = term.seen(&self.linear[term.other as usize]);
                add_difference::<f64, D>(&mut sum, own, &other, &term.q);
            }
            *result = excess::<f64, D>(&self.of.contraction[face], &sum);
        }
    }
}

/// `R_i` of faces.
struct SpreadJob<'a, const D: usize> {
    first: usize,
    of: &'a FaceTerms,
    stresses: &'a [Tensor<f64>],
    spread: &'a mut [ThirdOrder],
}

impl<const D: usize> Job<f64> for SpreadJob<'_, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        for (n, result) in self.spread.iter_mut().enumerate() {
            let face = self.first + n;
            *result = spread::<f64, D>(&self.stresses[self.of.faces[face] as usize], &self.of.contraction[face]);
        }
    }
}

/// What is added to the stresses of particles near faces, and the power that they have of others, W/m^3.
struct ShareJob<'a, const D: usize> {
    first: usize,
    of: &'a FaceSums,
    shared: &'a mut [(Tensor<f64>, f64)],
}

impl<const D: usize> Job<f64> for ShareJob<'_, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        let FaceSums { of, spread, stresses, linear, excess, .. } = self.of;
        for (n, shared) in self.shared.iter_mut().enumerate() {
            let n = self.first + n;
            let i = of.near[n] as usize;
            let (mut more, mut power) = ([[0.0; 3]; 3], 0.0);
            if let Some(face) = of.face_of_near[n] {
                let face = face as usize;
                more = along::<f64, D>(&spread[face], &of.whole[face]);
                power -= power_of::<f64, D>(&stresses[i], &excess[face]);
            }
            for term in of.of_near(n) {
                let stress = term.seen(&along::<f64, D>(&spread[term.other as usize], &term.q));
                for a in 0..D {
                    for b in 0..D {
                        more[a][b] -= stress[a][b];
                    }
                }
            }
            power -= power_of::<f64, D>(&more, &linear[i]);
            *shared = (more, power);
        }
    }
}
