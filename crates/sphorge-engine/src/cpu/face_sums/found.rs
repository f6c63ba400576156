//! The terms of faces, found in the reference configuration.

use super::{AT_ONCE, FaceSums, FaceTerm, FaceTerms, Others};
use crate::RunFailure;
use crate::cpu::CpuEngine;
use crate::cpu::domain::Domain;
use crate::cpu::ghosts::{Ghosts, WithGhosts};
use crate::halo::{self, Exchanged, GhostColumn, Images, Remote};
use crate::lanes::PairScalar;
use crate::neighbors::BLOCK;
use rayon::prelude::*;
use smallvec::smallvec;
use sphorge_physics::face_gradient::{
    FitNeighbor, ThirdOrder, contraction, fit, is_at_face, second_moment, weight_in_fit,
};
use sphorge_physics::kernel::{Kernel, pair_smoothing_length};
use sphorge_physics::tensor::{apply, dot, identity};
use sphorge_physics::{Dimension, Tensor, Vector};

/// Faces, the ghosts that they read, and on ranks how these are exchanged.
type FoundFaces = (Vec<Face>, Vec<u32>, Option<Remote>);
/// A list for each rank.
type OfRanks<T> = Vec<Vec<T>>;

/// What the terms of faces are made of: the reference configuration.
pub struct FaceConfiguration<'a, Row> {
    /// Positions of particles, m.
    pub position: &'a [Vector<f64>],
    /// Their smoothing lengths, m.
    pub smoothing_length: &'a [f64],
    /// Their volumes, m^d.
    pub volume: &'a [f64],
    /// Their gradient corrections.
    pub correction: &'a [Tensor<f64>],
    /// Their bodies.
    pub body: &'a [u32],
    /// By body, whether it has come apart: it then has no faces.
    pub has_come_apart: &'a [bool],
    /// The kernel of the sums.
    pub kernel: Kernel,
    /// Its dimension.
    pub dimension: Dimension,
    /// The neighbours of a particle, as an iterator over [`FaceNeighbor`].
    pub row: Row,
}

/// A neighbour of a particle, or an image of one.
#[derive(Clone, Copy, Debug)]
pub struct FaceNeighbor {
    /// Itself, or what it is an image of: a particle, or a ghost numbered after them.
    pub source: usize,
    /// Axes along which it is an image.
    pub mirrored: [bool; 3],
    /// m.
    pub position: Vector<f64>,
    /// m.
    pub smoothing_length: f64,
    /// m^d.
    pub volume: f64,
}

/// A neighbour in the reference configuration.
struct Neighbor {
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
#[repr(u32)]
enum Kind {
    /// Its sum is not exact for linear fields.
    Inexact,
    Inside,
    AtFace,
}

/// Largest deviation of the sum for a linear field.
const INEXACT: f64 = 1e-3;

/// What belongs to a face before all are put together.
struct Face {
    particle: u32,
    contraction: ThirdOrder,
    terms: Vec<FaceTerm>,
}

/// A term of a face as it is sent to the rank of its neighbour: the common points of both, the axes of the image as bits, and `V_i/V_j q_ij`.
type SentTerm = ((u32, u32), (u32, Vector<f64>));

/// The ranks that share the particles: this one's part, and its ghosts.
type OnRanks<'a> = (&'a Domain, &'a Ghosts);

/// The terms of all faces of a process that has all particles.
pub fn face_terms<I: Iterator<Item = FaceNeighbor>>(
    of: &FaceConfiguration<'_, impl Fn(usize) -> I + Sync>,
) -> FaceTerms {
    // Only other ranks can be lost.
    of.find(None).map(|sums| sums.of).unwrap_or_default()
}

impl<I: Iterator<Item = FaceNeighbor>, Row: Fn(usize) -> I + Sync> FaceConfiguration<'_, Row> {
    fn neighbors(&self, i: usize) -> impl Iterator<Item = Neighbor> {
        let Self { kernel, dimension, .. } = *self;
        let (own, h_i, correction) = (self.position[i], self.smoothing_length[i], self.correction[i]);
        (self.row)(i).filter_map(move |FaceNeighbor { source, mirrored, position, smoothing_length, volume }| {
            let x = [0, 1, 2].map(|a| position[a] - own[a]);
            let (r, h) = (dot(x, x).sqrt(), pair_smoothing_length(h_i, smoothing_length));
            let along = volume * kernel.slope(dimension, r, h);
            let slope = apply(&correction, x.map(|x| along * x));
            (r > 0.0 && r < kernel.support() * h).then_some(Neighbor { source, mirrored, x, slope, q: r / h })
        })
    }

    fn moment(&self, i: usize) -> ThirdOrder {
        second_moment(self.neighbors(i).map(|neighbor| (neighbor.x, neighbor.slope)))
    }

    fn kind(&self, i: usize) -> Kind {
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
            true if self.has_come_apart[self.body[i] as usize] => Kind::Inside,
            true if is_at_face(&self.moment(i), self.smoothing_length[i]) => Kind::AtFace,
            true => Kind::Inside,
        }
    }

    /// The kinds of all particles, and on ranks of ghosts, as numbers.
    fn kinds(&self, on_ranks: Option<OnRanks<'_>>) -> Vec<u32> {
        let count = self.position.len();
        let mut kinds: Vec<u32> =
            (0..count).into_par_iter().with_min_len(AT_ONCE).map(|i| self.kind(i) as u32).collect();
        if let Some((_, ghosts)) = on_ranks {
            let halo = ghosts.halo.as_ref();
            kinds.resize(count + halo.count(), Kind::Inexact as u32);
            let (own, of_ghosts) = kinds.split_at_mut(count);
            halo::fill(smallvec![Exchanged { halo, columns: smallvec![GhostColumn::Integer(own, of_ghosts)] }]);
        }
        kinds
    }

    /// What is taken from the sum of a particle at a face, if its neighbours tell it.
    fn face<'a>(&self, i: u32, kinds: &[u32], moment: impl Fn(usize) -> &'a ThirdOrder) -> Option<Face> {
        let support = self.kernel.support();
        let told = |neighbor: &Neighbor| kinds[neighbor.source] != Kind::Inexact as u32;
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
        let terms = neighbors.iter().zip(&fitted).map(|(neighbor, q)| FaceTerm {
            other: neighbor.source as u32,
            mirrored: neighbor.mirrored,
            q: *q,
        });
        Some(Face { particle: i, contraction, terms: terms.collect() })
    }

    /// The faces, and on ranks the particles of others that they read, which are the ghosts in `read`.
    fn faces(&self, on_ranks: Option<OnRanks<'_>>) -> Result<FoundFaces, RunFailure> {
        let count = self.position.len();
        let kinds = self.kinds(on_ranks);
        let mut is_read = vec![false; kinds.len()];
        let at_faces: Vec<u32> = (0..count as u32).filter(|&i| kinds[i as usize] == Kind::AtFace as u32).collect();
        for &i in &at_faces {
            is_read[i as usize] = true;
            self.neighbors(i as usize).for_each(|neighbor| is_read[neighbor.source] = true);
        }
        let read: Vec<u32> = (count..kinds.len()).filter(|&j| is_read[j]).map(|j| j as u32).collect();
        let of_points = |domain: &Domain| {
            let points = read.iter().map(|&j| domain.point(j)).collect();
            remote(domain).with(points, Vec::new())
        };
        let others = on_ranks.map(|(domain, _)| of_points(domain)).transpose()?;
        others.iter().flat_map(Remote::read).for_each(|i| is_read[i as usize] = true);
        let own: Vec<u32> = (0..count as u32).filter(|&i| is_read[i as usize]).collect();
        let mut place = vec![u32::MAX; kinds.len()];
        own.iter().chain(&read).enumerate().for_each(|(n, &i)| place[i as usize] = n as u32);
        let mut moments: Vec<ThirdOrder> =
            own.par_iter().with_min_len(AT_ONCE).map(|&i| self.moment(i as usize)).collect();
        if let Some(others) = &others {
            let of_others = others.values(|i| moments[place[i as usize] as usize])?;
            moments.extend(of_others);
        }
        let faces = at_faces.par_iter().with_min_len(AT_ONCE);
        let faces = faces.filter_map(|&i| self.face(i, &kinds, |j| &moments[place[j] as usize])).collect();
        Ok((faces, read, others))
    }

    /// All terms.
    fn find(&self, on_ranks: Option<OnRanks<'_>>) -> Result<FaceSums, RunFailure> {
        let (count, domain) = (self.position.len(), on_ranks.map(|(domain, _)| domain));
        let (mut faces, read, neighbors) = self.faces(on_ranks)?;
        let come = on_ranks.map(|(domain, ghosts)| -> Result<_, RunFailure> {
            let (faces, terms) = self.sent(&faces, domain, &ghosts.columns.reference_volume);
            Ok((domain.ranks.exchange_values(&faces)?, domain.ranks.exchange_values(&terms)?))
        });
        let (come_faces, come_terms) = come.transpose()?.unwrap_or_default();
        // Ghosts that are read are numbered without the others.
        let ghosts = on_ranks.map_or(0, |(_, ghosts)| ghosts.count());
        let mut number: Vec<u32> = (0..(count + ghosts) as u32).collect();
        read.iter().enumerate().for_each(|(k, &j)| number[j as usize] = (count + k) as u32);
        for term in faces.iter_mut().flat_map(|face| &mut face.terms) {
            term.other = number[term.other as usize];
        }

        let mut of = FaceTerms { starts: vec![0], near_starts: vec![0], ..FaceTerms::default() };
        for Face { particle, contraction, terms } in faces {
            of.faces.push(particle);
            of.contraction.push(contraction);
            let add = |sum: Vector<f64>, term: &FaceTerm| [0, 1, 2].map(|a| sum[a] + term.q[a]);
            of.whole.push(terms.iter().fold([0.0; 3], add));
            of.terms.extend(terms);
            of.starts.push(of.terms.len() as u32);
        }
        let own_faces = of.faces.len();
        let points: Vec<u32> = come_faces.iter().flatten().map(|(point, _)| *point).collect();
        of.faces.extend((0..points.len()).map(|k| (count + k) as u32));
        of.contraction.extend(come_faces.iter().flatten().map(|(_, contraction)| contraction));

        // In the order of all faces.
        let mut pairs: Vec<(u32, FaceTerm)> = Vec::new();
        let add_own = |pairs: &mut Vec<(u32, FaceTerm)>| {
            for (face, &i) in of.faces[..own_faces].iter().enumerate() {
                for term in of.of_face(face).iter().filter(|term| (term.other as usize) < count) {
                    let q = term.q.map(|q| self.volume[i as usize] / self.volume[term.other as usize] * q);
                    pairs.push((term.other, FaceTerm { other: face as u32, q, ..*term }));
                }
            }
        };
        match domain {
            None => add_own(&mut pairs),
            Some(domain) => {
                for (rank, terms) in come_terms.iter().enumerate() {
                    if rank == domain.ranks.rank() {
                        add_own(&mut pairs);
                    }
                    for &((face, other), (axes, q)) in terms {
                        let face = own_faces + points.partition_point(|&point| point < face);
                        let mirrored = [0, 1, 2].map(|a| axes >> a & 1 == 1);
                        let term = FaceTerm { other: face as u32, mirrored, q };
                        pairs.push((other - domain.own().start as u32, term));
                    }
                }
            }
        }
        of.keep_near(pairs, own_faces);

        let mut sums = FaceSums { count, of, is_known: true, ..FaceSums::default() };
        let of = &sums.of;
        let blocks = count.div_ceil(BLOCK);
        (sums.has_faces, sums.is_near) = (vec![false; blocks], vec![false; blocks]);
        of.faces[..own_faces].iter().for_each(|&i| sums.has_faces[i as usize / BLOCK] = true);
        of.near.iter().for_each(|&i| sums.is_near[i as usize / BLOCK] = true);
        sums.linear = vec![[[0.0; 3]; 3]; count + read.len()];
        sums.evaluated = vec![[[0.0; 3]; 3]; count + read.len()];
        sums.is_wanted = vec![false; count + read.len()];
        sums.excess = vec![[[0.0; 3]; 3]; own_faces];
        sums.spread = vec![[[[0.0; 3]; 3]; 3]; of.faces.len()];
        sums.stresses = vec![[[0.0; 3]; 3]; count + points.len()];
        sums.shared = vec![([[0.0; 3]; 3], 0.0); of.near.len()];
        if let (Some(domain), Some(neighbors)) = (domain, neighbors) {
            sums.others = Some(Others { neighbors, faces: remote(domain).with(points, Vec::new())? });
        }
        Ok(sums)
    }

    /// What other ranks need of faces here: those that have their particles for neighbours, by their common points, and these terms. The volumes
    /// (m^d) are those of ghosts.
    fn sent(
        &self,
        faces: &[Face],
        domain: &Domain,
        volumes: &[f64],
    ) -> (OfRanks<(u32, ThirdOrder)>, OfRanks<SentTerm>) {
        let (size, count) = (domain.ranks.size(), self.position.len());
        let mut sent_faces: Vec<Vec<(u32, ThirdOrder)>> = vec![Vec::new(); size];
        let mut sent_terms: Vec<Vec<SentTerm>> = vec![Vec::new(); size];
        for Face { particle, contraction, terms } in faces {
            let point = domain.point(*particle);
            for (ghost, term) in terms.iter().filter_map(|term| Some(((term.other as usize).checked_sub(count)?, term)))
            {
                let other = domain.point(term.other);
                let rank = domain.starts.partition_point(|&start| start <= other as usize) - 1;
                if sent_faces[rank].last().is_none_or(|(last, _)| *last != point) {
                    sent_faces[rank].push((point, *contraction));
                }
                let axes = (0..3).filter(|&a| term.mirrored[a]).map(|a| 1 << a).sum();
                let share = self.volume[*particle as usize] / volumes[ghost];
                sent_terms[rank].push(((point, other), (axes, term.q.map(|q| share * q))));
            }
        }
        (sent_faces, sent_terms)
    }
}

/// Ghosts of this rank that are none of its lists.
fn remote(domain: &Domain) -> Remote {
    Remote::new(domain.ranks.clone(), domain.starts.clone(), Images::default())
}

impl FaceTerms {
    /// Sets the terms of particles near faces from pairs of such a particle and a term; the first faces are those of this process.
    fn keep_near(&mut self, mut pairs: Vec<(u32, FaceTerm)>, own_faces: usize) {
        // Stable: terms of a particle stay in their order.
        pairs.sort_by_key(|(near, _)| *near);
        self.near = pairs.iter().map(|(near, _)| *near).chain(self.faces[..own_faces].iter().copied()).collect();
        self.near.sort_unstable();
        self.near.dedup();
        self.face_of_near =
            self.near.iter().map(|i| self.faces[..own_faces].binary_search(i).ok().map(|face| face as u32)).collect();
        self.near_starts.extend(self.near.iter().map(|i| pairs.partition_point(|(near, _)| near <= i) as u32));
        self.near_terms = pairs.into_iter().map(|(_, term)| term).collect();
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Finds the terms of the faces of the present reference configuration.
    pub(in crate::cpu) fn know_faces(&mut self) {
        let Some(sums) = &mut self.face_sums else { return };
        if sums.is_known {
            return;
        }
        let (p, list, columns) = (&self.particles, &self.lists.list, &self.ghosts.columns);
        let halo = self.ghosts.halo.as_ref();
        let (sources, images) = (halo.sources(), halo.images());
        let (count, not_images) = (p.len(), sources.len() - images.len());
        let position = WithGhosts::new(&p.reference_position, &columns.reference_position);
        let volume = WithGhosts::new(&p.reference_volume, &columns.reference_volume);
        let smoothing_length = WithGhosts::new(&p.smoothing_length, &columns.smoothing_length);
        let neighbor = |&j: &u32| {
            let j = j as usize;
            let (source, mirrored) = match j.checked_sub(count) {
                None => (j, [false; 3]),
                Some(ghost) => {
                    let image = ghost.checked_sub(not_images).map(|image| images[image].sign().map(|sign| sign < 0.0));
                    (sources[ghost] as usize, image.unwrap_or_default())
                }
            };
            FaceNeighbor {
                source,
                mirrored,
                position: position.at(j),
                smoothing_length: smoothing_length.at(j),
                volume: volume.at(j),
            }
        };
        let of = FaceConfiguration {
            position: &p.reference_position,
            smoothing_length: &p.smoothing_length,
            volume: &p.reference_volume,
            correction: &p.correction,
            body: &p.body,
            has_come_apart: &self.has_come_apart,
            kernel: self.model.numerics.kernel,
            dimension: crate::cpu::dimension(&self.model),
            row: |i| list.row(i).iter().map(neighbor),
        };
        *sums = match of.find(self.domain.as_ref().map(|domain| (domain, &self.ghosts))) {
            Ok(found) => found,
            // The engine reports it when it has exchanged the next fields.
            Err(failure) => {
                self.domain.iter().for_each(|domain| domain.ranks.note_loss(failure.clone()));
                FaceSums::of_no_faces(self.particles.len())
            }
        };
    }
}

impl FaceSums {
    /// No particle is at a face.
    fn of_no_faces(count: usize) -> Self {
        let blocks = count.div_ceil(BLOCK);
        Self {
            count,
            of: FaceTerms { starts: vec![0], near_starts: vec![0], ..FaceTerms::default() },
            has_faces: vec![false; blocks],
            is_near: vec![false; blocks],
            linear: vec![[[0.0; 3]; 3]; count],
            evaluated: vec![[[0.0; 3]; 3]; count],
            is_wanted: vec![false; count],
            stresses: vec![[[0.0; 3]; 3]; count],
            ..Self::default()
        }
    }
}
