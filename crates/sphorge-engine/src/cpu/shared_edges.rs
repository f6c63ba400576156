//! Edges that facets of neighbouring cells share ([`sphorge_physics::facet`], `edges`): where they are, and the forces on the neighbours that they follow.

use super::CpuEngine;
use super::faces::WholeDeformation;
use super::facets::{FacetContacts, FacetPoints};
use super::ghosts::{Ghosts, WithGhosts};
use crate::geometry::{Beside, ReferenceFacets};
use crate::lanes::PairScalar;
use crate::neighbors::{BLOCK, NeighborList};
use crate::particles::Particles;
use rayon::prelude::*;
use smallvec::SmallVec;
use sphorge_physics::facet::{OnSides, SharedEdge, half_of_misfit};
use sphorge_physics::tensor::{dot, multiply};
use sphorge_physics::{Tensor, Vector};
use std::borrow::Cow;

/// Distance over that of the farthest of them beyond which none is.
const FARTHEST: f64 = 1.0 + 2.0 * Beside::THERE;

/// An edge that the facets of a cell share with those of the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellEdge {
    /// Side of the cell, `2 axis + side`.
    pub(super) side: usize,
    /// To the next particle at the start, m.
    pub(super) way: Vector<f64>,
    pub(super) edge: SharedEdge<f64>,
    /// Rate of its shift, m/s.
    pub(super) rate: Vector<f64>,
}

/// Those of a cell.
pub(super) type CellEdges = SmallVec<[CellEdge; 6]>;

/// A point beside the cell of a particle: a particle or a ghost.
#[derive(Clone, Copy, Debug)]
struct Next {
    point: u32,
    /// Side of the cell.
    side: u8,
}

/// What is beside the cells of the particles, in the order of their rows. It stays as long as the list of neighbours does.
#[derive(Clone, Debug, Default)]
pub(super) struct BesidePoints {
    /// Of each particle where its own begin.
    starts: Vec<u32>,
    found: Vec<Next>,
    /// Number of particles and state of the list for which they were found.
    of: Option<(usize, u64)>,
}

impl BesidePoints {
    /// Finds them again if the list has changed.
    pub(super) fn refresh(
        &mut self,
        reference: &ReferenceFacets,
        p: &Particles,
        ghosts: &Particles,
        list: &NeighborList,
    ) {
        if !self.is_of(p, list) {
            *self = Self::find(reference, p, ghosts, list);
        }
    }

    fn is_of(&self, particles: &Particles, list: &NeighborList) -> bool {
        self.of == Some((particles.len(), list.changes()))
    }

    fn find(reference: &ReferenceFacets, particles: &Particles, ghosts: &Particles, list: &NeighborList) -> Self {
        let initial = WithGhosts::new(&particles.reference_position, &ghosts.reference_position);
        let beside = |i: usize| -> SmallVec<[Next; 6]> {
            let mut found = SmallVec::new();
            let Some(beside) = reference.beside(particles.id[i]) else { return found };
            let from = initial.at(i);
            let farthest = (0..6).filter_map(|side| beside.way(side)).map(|way| dot(way, way)).fold(0.0, f64::max);
            for &point in list.row(i) {
                let there = initial.at(point as usize);
                let to: Vector<f64> = std::array::from_fn(|k| there[k] - from[k]);
                // Most of a row is farther.
                if dot(to, to) > FARTHEST * FARTHEST * farthest {
                    continue;
                }
                for side in 0..6 {
                    let Some(way) = beside.way(side) else { continue };
                    let apart: Vector<f64> = std::array::from_fn(|k| to[k] - way[k]);
                    if dot(apart, apart) < (Beside::THERE * Beside::THERE) * dot(way, way) {
                        found.push(Next { point, side: side as u8 });
                    }
                }
            }
            found
        };
        let rows: Vec<SmallVec<[Next; 6]>> =
            (0..particles.len()).into_par_iter().with_min_len(BLOCK).map(beside).collect();
        let mut starts = Vec::with_capacity(rows.len() + 1);
        starts.push(0);
        starts.extend(rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        }));
        let found: Vec<Next> = rows.into_iter().flatten().collect();
        Self { starts, found, of: Some((particles.len(), list.changes())) }
    }

    fn of_particle(&self, i: usize) -> &[Next] {
        &self.found[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<u32>() * self.starts.capacity() + size_of::<Next>() * self.found.capacity()
    }
}

/// What cells share edges with.
pub(super) struct Neighbors<'a> {
    reference: &'a ReferenceFacets,
    particles: &'a Particles,
    beside: Cow<'a, BesidePoints>,
    position: WithGhosts<'a, Vector<f64>>,
    velocity: WithGhosts<'a, Vector<f64>>,
}

impl<'a> Neighbors<'a> {
    pub(super) fn new(
        facets: &'a FacetContacts,
        particles: &'a Particles,
        ghosts: &'a Particles,
        list: &NeighborList,
    ) -> Self {
        let reference = &facets.reference;
        // A section may be asked for before a step has been taken from a state that was loaded.
        let beside = match facets.beside.is_of(particles, list) {
            true => Cow::Borrowed(&facets.beside),
            false => Cow::Owned(BesidePoints::find(reference, particles, ghosts, list)),
        };
        Self {
            reference,
            particles,
            beside,
            position: WithGhosts::new(&particles.position, &ghosts.position),
            velocity: WithGhosts::new(&particles.evaluated_velocity, &ghosts.evaluated_velocity),
        }
    }

    fn beside(&self, i: usize) -> Option<&'a Beside> {
        self.reference.beside(self.particles.id[i])
    }

    /// Sides of the cell of a particle with the points beside them: particles or ghosts.
    fn each(&self, i: usize, mut visit: impl FnMut(usize, Vector<f64>, usize)) {
        let next = self.beside.of_particle(i);
        let Some(beside) = (!next.is_empty()).then(|| self.beside(i)).flatten() else { return };
        for Next { point, side } in next {
            let side = usize::from(*side);
            if let Some(way) = beside.way(side) {
                visit(side, way, *point as usize);
            }
        }
    }

    fn apart(of: &WithGhosts<'_, Vector<f64>>, i: usize, j: usize) -> Vector<f64> {
        let (own, other) = (of.at(i), of.at(j));
        std::array::from_fn(|k| other[k] - own[k])
    }

    /// Shifts of the edges of a cell with this deformation gradient, m.
    fn shifts(&self, i: usize, f: &Tensor<f64>) -> OnSides<f64> {
        let mut shifts = OnSides::zero();
        self.each(i, |side, way, j| {
            *shifts.on_mut(side) = SharedEdge::of(Self::apart(&self.position, i, j), f, way).shift();
        });
        shifts
    }

    /// Edges of a cell with this deformation gradient and velocity gradient (1/s).
    pub(super) fn edges(&self, i: usize, f: &Tensor<f64>, l: &Tensor<f64>) -> CellEdges {
        let (mut edges, turned) = (CellEdges::new(), multiply(l, f));
        self.each(i, |side, way, j| {
            let edge = SharedEdge::of(Self::apart(&self.position, i, j), f, way);
            let rate = edge.tangent(half_of_misfit(Self::apart(&self.velocity, i, j), &turned, way));
            edges.push(CellEdge { side, way, edge, rate });
        });
        edges
    }
}

/// Forces on the distances of the edges of the cells of a block, N.
pub(super) type PullsOfBlock = Vec<(usize, OnSides<f64>)>;

/// Copies the forces of all blocks to the particles, where ghosts get them from.
pub(super) fn store_pulls(reference: &ReferenceFacets, pulls: &[PullsOfBlock], particles: &mut Particles) {
    let Particles { pulls_of_low_edges: low, pulls_of_high_edges: high, id, .. } = particles;
    // Those of others are zero from the start on.
    for (i, _) in id.iter().enumerate().filter(|(_, id)| reference.beside(**id).is_some()) {
        (low[i], high[i]) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    }
    for (i, pulls) in pulls.iter().flatten() {
        (low[*i], high[*i]) = (pulls.low, pulls.high);
    }
}

/// The same of particles and ghosts.
pub(super) struct Pulls<'a> {
    neighbors: Neighbors<'a>,
    low: WithGhosts<'a, Tensor<f64>>,
    high: WithGhosts<'a, Tensor<f64>>,
    ghosts: &'a Ghosts,
}

impl<'a> Pulls<'a> {
    pub(super) fn new(
        facets: &'a FacetContacts,
        particles: &'a Particles,
        ghosts: &'a Ghosts,
        list: &NeighborList,
    ) -> Self {
        let columns = &ghosts.columns;
        Self {
            neighbors: Neighbors::new(facets, particles, columns, list),
            low: WithGhosts::new(&particles.pulls_of_low_edges, &columns.pulls_of_low_edges),
            high: WithGhosts::new(&particles.pulls_of_high_edges, &columns.pulls_of_high_edges),
            ghosts,
        }
    }

    /// Of a side of a point, particle or ghost.
    fn at(&self, point: usize, side: usize) -> Vector<f64> {
        let (axis, of) = (side / 2, if side.is_multiple_of(2) { &self.low } else { &self.high });
        // Ghosts got them mirrored like tensors in space, whose rows would be mirrored, too.
        let images = self.ghosts.halo.images();
        let first = self.neighbors.particles.len() + self.ghosts.count() - images.len();
        let sign = point.checked_sub(first).map_or(1.0, |image| images[image].sign()[axis]);
        of.at(point)[axis].map(|c| sign * c)
    }

    /// Calls `visit` with every point beside a particle and its force on the particle, N.
    pub(super) fn each(&self, i: usize, mut visit: impl FnMut(usize, Vector<f64>)) {
        let Some(beside) = self.neighbors.beside(i) else { return };
        self.neighbors.each(i, |side, _, j| {
            let (own, other) = (self.at(i, side), self.at(j, usize::from(beside.facing[side])));
            visit(j, std::array::from_fn(|k| 0.5 * (other[k] - own[k])));
        });
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Moves the edges of facets to the middle between the cells that share them.
    pub(super) fn shift_edges(&mut self) {
        let Some(facets) = self.contacts.as_mut().and_then(|contacts| contacts.facets.as_mut()) else { return };
        facets.beside.refresh(&facets.reference, &self.particles, &self.ghosts.columns, &self.lists.list);
        let (facets, p) = (&*facets, &mut self.particles);
        let (mut low, mut high) =
            (std::mem::take(&mut p.shifts_of_low_edges), std::mem::take(&mut p.shifts_of_high_edges));
        let p = &self.particles;
        let neighbors = Neighbors::new(facets, p, &self.ghosts.columns, &self.lists.list);
        let whole = WholeDeformation { since: &p.deformation, earlier: &p.earlier_deformation };
        let all = (&mut low, &mut high).into_par_iter().with_min_len(BLOCK).enumerate();
        all.for_each(|(i, (low, high))| {
            // Those of others are zero from the start on.
            if neighbors.beside(i).is_some() {
                let shifts = neighbors.shifts(i, &whole.at(i));
                (*low, *high) = (shifts.low, shifts.high);
            }
        });
        (self.particles.shifts_of_low_edges, self.particles.shifts_of_high_edges) = (low, high);
    }

    /// Adds the forces of the edges on the cells that they follow to those of the pair sum.
    pub(super) fn add_pulls(&mut self) {
        let mut acceleration = std::mem::take(&mut self.particles.acceleration);
        let (p, ghosts, list) = (&self.particles, &self.ghosts, &self.lists.list);
        if let Some(pulls) = self.contacts.as_ref().and_then(|contacts| contacts.pulls(p, ghosts, list)) {
            acceleration.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, acceleration)| {
                pulls.each(i, |_, force| (0..3).for_each(|k| acceleration[k] += force[k] / p.mass[i]));
            });
        }
        self.particles.acceleration = acceleration;
    }
}

/// Of a point with these rows, in space where it is: those of an image with these signs were mirrored like tensors.
pub(super) fn shifts_of(points: &FacetPoints<'_>, point: usize, sign: Vector<f64>) -> OnSides<f64> {
    let turned = |of: Tensor<f64>| -> Tensor<f64> { std::array::from_fn(|axis| of[axis].map(|c| sign[axis] * c)) };
    OnSides { low: turned(points.shifts[0].at(point)), high: turned(points.shifts[1].at(point)) }
}
