//! Gradients that are exact for quadratic fields at faces: what is taken from the sums of particles at faces, and the transpose of it, which
//! is added to their stresses. The formulas are in [`sphorge_physics::face_gradient`].
//!
//! Few particles are at a face, so that the pair sums stay as they are and this is a second, sparse pass. Its terms are found once for a
//! reference configuration, in the order of the rows of the list; images are entries of the particles they are images of.

use super::CpuEngine;
use super::sweeps::dispatch_dimension;
use crate::halo::Image;
use crate::lanes::{Instructions, Job, Lanes, PairScalar, run};
use crate::model::Model;
use crate::neighbors::{BLOCK, NeighborList};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::face_gradient::{
    FitNeighbor, ThirdOrder, add_difference, along, contraction, excess, fit, is_at_face, second_moment, spread,
    weight_in_fit,
};
use sphorge_physics::kernel::{Kernel, pair_smoothing_length};
use sphorge_physics::tensor::{apply, dot, identity, plus};
use sphorge_physics::{Dimension, Tensor, Vector};

/// Particles or faces that one thread takes at least.
const AT_ONCE: usize = 64;

/// A term of a sum: a neighbour at a face, or of one.
#[derive(Clone, Copy)]
struct Term {
    /// Index of the particle, or of the face.
    other: u32,
    /// Axes along which it is an image of that.
    mirrored: [bool; 3],
    /// `q_ij`, 1/m; of the transpose `V_j/V_i q_ji`.
    q: Vector<f64>,
}

impl Term {
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

/// Terms of the particles at faces and of those near them.
#[derive(Default)]
pub(super) struct FaceSums {
    /// Whether they belong to the present reference configuration.
    is_known: bool,
    /// Particles at faces, ascending.
    faces: Vec<u32>,
    /// `K_i` of each, m.
    contraction: Vec<ThirdOrder>,
    /// `sum_j q_ij` of each, 1/m.
    whole: Vec<Vector<f64>>,
    /// First term of each, and the number of all.
    starts: Vec<u32>,
    terms: Vec<Term>,
    /// Particles at faces and their neighbours, ascending; terms of each, of the faces they are neighbours of.
    near: Vec<u32>,
    near_starts: Vec<u32>,
    near_terms: Vec<Term>,
    /// Index among the faces of those that are at one.
    face_of_near: Vec<Option<u32>>,
    /// Whether blocks have particles at faces, and near them.
    has_faces: Vec<bool>,
    is_near: Vec<bool>,
    /// `G_i` of particles in blocks that are near, 1/s.
    linear: Vec<Tensor<f64>>,
    /// Those at the velocities at which forces are evaluated, of particles that meet something; which these are.
    evaluated: Vec<Tensor<f64>>,
    is_wanted: Vec<bool>,
    wanted: Vec<u32>,
    /// `E_i` of each face, 1/s.
    excess: Vec<Tensor<f64>>,
    /// `R_i` of each face, Pa m.
    spread: Vec<ThirdOrder>,
    /// Stresses that work on the sums, of all particles, Pa.
    stresses: Vec<Tensor<f64>>,
    /// What is added to the stress of particles near faces, Pa, and what they have of the power of others, W/kg.
    shared: Vec<(Tensor<f64>, f64)>,
}

impl FaceSums {
    /// Nothing where a model has gradients that are exact for linear fields only.
    pub(super) fn of(model: &Model) -> Option<Self> {
        model.formulation.is_quadratic_at_faces().then(Self::default)
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
        let end = (first + BLOCK).min(self.linear.len());
        rates[..end - first].copy_from_slice(&self.linear[first..end]);
        *taken = [[[0.0; 3]; 3]; BLOCK];
        let from = self.faces.partition_point(|&i| (i as usize) < first);
        for (face, &i) in self.faces.iter().enumerate().skip(from).take_while(|(_, i)| (**i as usize) < end) {
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
        let Self { faces, starts, terms, is_wanted, wanted, evaluated, .. } = self;
        let mut want = |i: usize| {
            if !std::mem::replace(&mut is_wanted[i], true) {
                wanted.push(i as u32);
            }
        };
        for i in particles {
            want(i);
            if let Ok(face) = faces.binary_search(&(i as u32)) {
                terms[starts[face] as usize..starts[face + 1] as usize]
                    .iter()
                    .for_each(|term| want(term.other as usize));
            }
        }
        let is_wanted = &*is_wanted;
        evaluated.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, rate)| {
            if is_wanted[i] {
                *rate = linear(i);
            }
        });
        for i in self.wanted.drain(..) {
            self.is_wanted[i as usize] = false;
        }
    }

    /// The rate of the deformation of a particle of the last [evaluation](Self::evaluate), 1/s.
    pub(super) fn evaluated_rate(&self, i: usize, dimension: Dimension) -> Tensor<f64> {
        let own = &self.evaluated[i];
        let Ok(face) = self.faces.binary_search(&(i as u32)) else { return *own };
        dispatch_dimension!(dimension, |D| {
            let mut sum = [[[0.0; 3]; 3]; 3];
            for term in &self.terms[self.starts[face] as usize..self.starts[face + 1] as usize] {
                add_difference::<D>(&mut sum, own, &term.seen(&self.evaluated[term.other as usize]), &term.q);
            }
            plus(own, -1.0, &excess::<D>(&self.contraction[face], &sum))
        })
    }

    /// Finds what is to be taken from the sums of the faces.
    pub(super) fn find_excess(&mut self, instructions: Instructions, dimension: Dimension) {
        let Self { contraction, starts, terms, linear, excess, faces, .. } = self;
        excess.par_chunks_mut(AT_ONCE).enumerate().for_each(|(chunk, excess)| {
            let first = chunk * AT_ONCE;
            dispatch_dimension!(dimension, |D| run(
                instructions,
                ExcessJob::<D> { first, contraction, starts, terms, linear, faces, excess }
            ));
        });
    }

    /// Finds the stresses that work on the sums of all particles, from those that work on exact gradients, `stress`, Pa; and the energy that
    /// each particle has of the stresses of others. `density` is that of the reference configuration, kg/m^3.
    pub(super) fn transpose(
        &mut self,
        count: usize,
        stress: impl Fn(usize) -> Tensor<f64> + Sync,
        (instructions, dimension): (Instructions, Dimension),
        density: impl Fn(usize) -> f64 + Sync,
    ) {
        self.stresses.resize(count, [[0.0; 3]; 3]);
        let found = self.stresses.par_iter_mut().with_min_len(BLOCK).enumerate();
        found.for_each(|(i, found)| *found = stress(i));
        let Self { faces, contraction, spread, stresses, .. } = self;
        spread.par_chunks_mut(AT_ONCE).enumerate().for_each(|(chunk, spread)| {
            let first = chunk * AT_ONCE;
            dispatch_dimension!(dimension, |D| run(
                instructions,
                SpreadJob::<D> { first, faces, contraction, stresses, spread }
            ));
        });
        let mut shared = std::mem::take(&mut self.shared);
        let of = &*self;
        shared.par_chunks_mut(AT_ONCE).enumerate().for_each(|(chunk, shared)| {
            let first = chunk * AT_ONCE;
            dispatch_dimension!(dimension, |D| run(instructions, ShareJob::<D> { first, of, shared }));
            for (n, (_, power)) in shared.iter_mut().enumerate() {
                *power /= density(of.near[first + n] as usize);
            }
        });
        for (&i, (more, _)) in self.near.iter().zip(&shared) {
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
        for (&i, (_, power)) in self.near.iter().zip(&self.shared) {
            energy_rate[i as usize] += power;
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Term>() * (self.terms.capacity() + self.near_terms.capacity())
            + size_of::<ThirdOrder>() * (self.contraction.capacity() + self.spread.capacity())
            + size_of::<Tensor<f64>>()
                * (self.linear.capacity()
                    + self.evaluated.capacity()
                    + self.excess.capacity()
                    + self.stresses.capacity()
                    + self.shared.capacity())
            + size_of::<Vector<f64>>() * self.whole.capacity()
    }
}

struct ExcessJob<'a, const D: usize> {
    first: usize,
    faces: &'a [u32],
    contraction: &'a [ThirdOrder],
    starts: &'a [u32],
    terms: &'a [Term],
    linear: &'a [Tensor<f64>],
    excess: &'a mut [Tensor<f64>],
}

impl<const D: usize> Job<f64> for ExcessJob<'_, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        for (n, result) in self.excess.iter_mut().enumerate() {
            let face = self.first + n;
            let own = &self.linear[self.faces[face] as usize];
            let mut sum = [[[0.0; 3]; 3]; 3];
            for term in &self.terms[self.starts[face] as usize..self.starts[face + 1] as usize] {
                let other = term.seen(&self.linear[term.other as usize]);
                add_difference::<D>(&mut sum, own, &other, &term.q);
            }
            *result = excess::<D>(&self.contraction[face], &sum);
        }
    }
}

/// `R_i` of faces.
struct SpreadJob<'a, const D: usize> {
    first: usize,
    faces: &'a [u32],
    contraction: &'a [ThirdOrder],
    stresses: &'a [Tensor<f64>],
    spread: &'a mut [ThirdOrder],
}

impl<const D: usize> Job<f64> for SpreadJob<'_, D> {
    #[inline(always)]
    fn run<L: Lanes<Element = f64>>(self) {
        for (n, result) in self.spread.iter_mut().enumerate() {
            let face = self.first + n;
            *result = spread::<D>(&self.stresses[self.faces[face] as usize], &self.contraction[face]);
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
        let FaceSums { near, near_starts, near_terms, face_of_near, whole, spread, stresses, linear, excess, .. } =
            self.of;
        for (n, shared) in self.shared.iter_mut().enumerate() {
            let n = self.first + n;
            let i = near[n] as usize;
            let (mut more, mut power) = ([[0.0; 3]; 3], 0.0);
            if let Some(face) = face_of_near[n] {
                let face = face as usize;
                more = along::<D>(&spread[face], &whole[face]);
                power -= work::<D>(&stresses[i], &excess[face]);
            }
            for term in &near_terms[near_starts[n] as usize..near_starts[n + 1] as usize] {
                let stress = term.seen(&along::<D>(&spread[term.other as usize], &term.q));
                for a in 0..D {
                    for b in 0..D {
                        more[a][b] -= stress[a][b];
                    }
                }
            }
            power -= work::<D>(&more, &linear[i]);
            *shared = (more, power);
        }
    }
}

/// `a : b`.
#[inline(always)]
fn work<const D: usize>(a: &Tensor<f64>, b: &Tensor<f64>) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        for l in 0..D {
            sum += a[k][l] * b[k][l];
        }
    }
    sum
}

/// What the terms of faces are made of: the reference configuration of one process.
struct Configuration<'a> {
    particles: &'a Particles,
    list: &'a NeighborList,
    images: &'a [Image],
    has_come_apart: &'a [bool],
    kernel: Kernel,
    dimension: Dimension,
}

/// A neighbour in the reference configuration.
struct Neighbor {
    /// Itself, or the particle that it is an image of, and the axes along which it is one.
    source: usize,
    mirrored: [bool; 3],
    /// `X_j - X_i`, m.
    x: Vector<f64>,
    /// `V_j B_i grad_0 W_ij`, 1/m.
    slope: Vector<f64>,
    /// Distance over the smoothing length of the pair.
    q: f64,
}

/// What a particle is for the gradients of its neighbours.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Its sum is not exact for linear fields.
    Inexact,
    Inside,
    AtFace,
}

impl Configuration<'_> {
    fn neighbors(&self, i: usize) -> impl Iterator<Item = Neighbor> {
        let Self { particles: p, list, images, kernel, dimension, .. } = *self;
        let count = p.len();
        list.row(i).iter().filter_map(move |&j| {
            let (source, mirrored, place) = match (j as usize).checked_sub(count) {
                None => (j as usize, [false; 3], p.reference_position[j as usize]),
                Some(ghost) => {
                    let image = &images[ghost];
                    let source = image.source as usize;
                    (source, image.sign().map(|sign| sign < 0.0), image.position(&p.reference_position[source]))
                }
            };
            let x = [0, 1, 2].map(|a| place[a] - p.reference_position[i][a]);
            let (r, h) = (dot(x, x).sqrt(), pair_smoothing_length(p.smoothing_length[i], p.smoothing_length[source]));
            let along = p.reference_volume[source] * kernel.slope(dimension, r, h);
            let slope = apply(&p.correction[i], x.map(|x| along * x));
            (r > 0.0 && r < kernel.support() * h).then_some(Neighbor { source, mirrored, x, slope, q: r / h })
        })
    }

    fn moment(&self, i: usize) -> ThirdOrder {
        second_moment(self.neighbors(i).map(|neighbor| (neighbor.x, neighbor.slope)))
    }

    fn kind(&self, i: usize) -> Kind {
        let p = self.particles;
        let mut first = [[0.0; 3]; 3];
        for Neighbor { x, slope, .. } in self.neighbors(i) {
            for a in 0..3 {
                for b in 0..3 {
                    first[a][b] += x[a] * slope[b];
                }
            }
        }
        let (one, d) = (identity::<f64>(), self.dimension.count());
        let is_exact = (0..d).all(|a| (0..d).all(|b| (first[a][b] - one[a][b]).abs() < INEXACT));
        match is_exact {
            false => Kind::Inexact,
            true if self.has_come_apart[p.body[i] as usize] => Kind::Inside,
            true if is_at_face(&self.moment(i), p.smoothing_length[i]) => Kind::AtFace,
            true => Kind::Inside,
        }
    }
}

/// Largest deviation of the sum for a linear field.
const INEXACT: f64 = 1e-3;

/// What belongs to a face before all are put together.
struct Face {
    particle: u32,
    contraction: ThirdOrder,
    terms: Vec<Term>,
}

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the terms of the faces of the present reference configuration.
    pub(super) fn know_faces(&mut self) {
        let Some(mut sums) = self.face_sums.take_if(|sums| !sums.is_known) else { return };
        let count = self.particles.len();
        let of = Configuration {
            particles: &self.particles,
            list: &self.lists.list,
            images: self.ghosts.halo.images(),
            has_come_apart: &self.has_come_apart,
            kernel: self.model.numerics.kernel,
            dimension: super::dimension(&self.model),
        };
        let kinds: Vec<Kind> = (0..count).into_par_iter().with_min_len(AT_ONCE).map(|i| of.kind(i)).collect();
        let mut is_near = vec![false; count];
        let at_faces: Vec<u32> = (0..count as u32).filter(|&i| kinds[i as usize] == Kind::AtFace).collect();
        for &i in &at_faces {
            is_near[i as usize] = true;
            of.neighbors(i as usize).for_each(|neighbor| is_near[neighbor.source] = true);
        }
        let near: Vec<u32> = (0..count as u32).filter(|&i| is_near[i as usize]).collect();
        let mut place = vec![u32::MAX; count];
        near.iter().enumerate().for_each(|(n, &i)| place[i as usize] = n as u32);
        let moments: Vec<ThirdOrder> = near.par_iter().with_min_len(AT_ONCE).map(|&i| of.moment(i as usize)).collect();
        let faces: Vec<Face> = at_faces
            .par_iter()
            .with_min_len(AT_ONCE)
            .filter_map(|&i| of.face(i, &kinds, |j| &moments[place[j] as usize]))
            .collect();

        sums.starts = vec![0];
        (sums.faces, sums.contraction, sums.whole, sums.terms) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        sums.face_of_near = vec![None; near.len()];
        for Face { particle, contraction, terms } in faces {
            sums.face_of_near[place[particle as usize] as usize] = Some(sums.faces.len() as u32);
            sums.faces.push(particle);
            sums.contraction.push(contraction);
            let add = |sum: Vector<f64>, term: &Term| [0, 1, 2].map(|a| sum[a] + term.q[a]);
            sums.whole.push(terms.iter().fold([0.0; 3], add));
            sums.terms.extend(terms);
            sums.starts.push(sums.terms.len() as u32);
        }
        let volume = &self.particles.reference_volume;
        let mut near_terms: Vec<Vec<Term>> = vec![Vec::new(); near.len()];
        for (face, &i) in sums.faces.iter().enumerate() {
            for term in &sums.terms[sums.starts[face] as usize..sums.starts[face + 1] as usize] {
                let j = term.other as usize;
                let q = term.q.map(|q| volume[i as usize] / volume[j] * q);
                near_terms[place[j] as usize].push(Term { other: face as u32, q, ..*term });
            }
        }
        sums.near_starts = vec![0];
        sums.near_terms.clear();
        for terms in near_terms {
            sums.near_terms.extend(terms);
            sums.near_starts.push(sums.near_terms.len() as u32);
        }
        let blocks = count.div_ceil(BLOCK);
        (sums.has_faces, sums.is_near) = (vec![false; blocks], vec![false; blocks]);
        sums.faces.iter().for_each(|&i| sums.has_faces[i as usize / BLOCK] = true);
        near.iter().for_each(|&i| sums.is_near[i as usize / BLOCK] = true);
        sums.linear = vec![[[0.0; 3]; 3]; count];
        sums.evaluated = vec![[[0.0; 3]; 3]; count];
        sums.is_wanted = vec![false; count];
        sums.excess = vec![[[0.0; 3]; 3]; sums.faces.len()];
        sums.spread = vec![[[[0.0; 3]; 3]; 3]; sums.faces.len()];
        sums.shared = vec![([[0.0; 3]; 3], 0.0); near.len()];
        sums.near = near;
        sums.is_known = true;
        self.face_sums = Some(sums);
    }
}

impl Configuration<'_> {
    /// What is taken from the sum of a particle at a face, if its neighbours tell it.
    fn face<'a>(&self, i: u32, kinds: &[Kind], moment: impl Fn(usize) -> &'a ThirdOrder) -> Option<Face> {
        let support = self.kernel.support();
        let told = |neighbor: &Neighbor| kinds[neighbor.source] != Kind::Inexact;
        let neighbors: Vec<Neighbor> = self.neighbors(i as usize).filter(told).collect();
        let weighted: Vec<(Vector<f64>, f64)> =
            neighbors.iter().map(|neighbor| (neighbor.x, weight_in_fit(neighbor.q, support))).collect();
        let fitted = fit(&weighted, self.dimension)?;
        // Images have the moments of their mirrored particles.
        let mirrored = |neighbor: &Neighbor| {
            let mut moment = *moment(neighbor.source);
            for a in 0..3 {
                for b in 0..3 {
                    for c in 0..3 {
                        if neighbor.mirrored[a] ^ neighbor.mirrored[b] ^ neighbor.mirrored[c] {
                            moment[a][b][c] = -moment[a][b][c];
                        }
                    }
                }
            }
            moment
        };
        let moments: Vec<ThirdOrder> = neighbors.iter().map(mirrored).collect();
        let contributions = neighbors.iter().zip(&fitted).zip(&moments);
        let contributions = contributions.map(|((neighbor, q), moment)| FitNeighbor { x: neighbor.x, q: *q, moment });
        let contraction = contraction(moment(i as usize), contributions, self.dimension);
        let terms = neighbors.iter().zip(&fitted).map(|(neighbor, q)| Term {
            other: neighbor.source as u32,
            mirrored: neighbor.mirrored,
            q: *q,
        });
        Some(Face { particle: i, contraction, terms: terms.collect() })
    }
}
