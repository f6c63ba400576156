//! Contact of bodies of the total Lagrangian form at the facets of their particles: where the facets are, and what the
//! pairs of them do ([`sphorge_physics::facet`]).
//!
//! Facets are found in the initial configuration ([`crate::geometry::ReferenceFacets`]) and follow with the whole
//! deformation since the start. Pairs of particles whose facets may meet are found by the contact search; each
//! particle sums over its own row, and the pair is evaluated in the same order from both sides, so that forces are
//! opposite to the bit.

use super::CpuEngine;
use super::contact::{BlockSums, Push};
use super::evaluated::ReferenceWeights;
use super::faces::WholeDeformation;
use super::facet_bounds::{About, Arms};
use super::facet_source::{Source, mirrored};
use super::ghosts::{Ghosts, WithGhosts};
use super::shared_edges::{BesidePoints, CellEdges, shifts_of};
use crate::ContactLaws;
use crate::facet_laws::FacetLaws;
use crate::geometry::ReferenceFacets;
use crate::lanes::PairScalar;
use crate::model::Model;
use crate::neighbors::{BLOCK, ForeignList};
use crate::particles::Particles;
use rayon::prelude::*;
use smallvec::SmallVec;
use sphorge_physics::contact::ContactStrength;
use sphorge_physics::facet::{
    EdgeForces, Facet, FacetPairLaw, FacetPress, FacetSlip, FacetStiffness, FrictionShare, OnSides, Partner, SlipDrive,
    friction_force, moment_of_edge, moment_of_torn, press, slip_after, stress_of_moment,
};
use sphorge_physics::tensor::{apply, dot, plus};
use sphorge_physics::{Dimension, SymmetricTensor, Tensor, Vector};

pub(super) use sphorge_physics::facet::{MARGIN, MOBILITY};

/// What may press in the rows of a block, by the numbers of the own facet and the other; and what does.
#[derive(Default)]
struct Candidates {
    pairs: Vec<(u32, u32)>,
    /// Each pair once: in the row of the first of both, or of the particle of this rank if the other is a ghost.
    pressing: Vec<Found>,
}

/// What was found out about a pair.
struct Found {
    /// The facets by the points they belong to: that of the row, and the other.
    own: u32,
    other: u32,
    press: FacetPress<f64>,
}

/// The facets of the particles and ghosts that may meet.
pub(super) struct FacetContacts {
    dimension: Dimension,
    pub(super) reference: ReferenceFacets,
    /// How far their corners are from the owner along each axis.
    arms: Arms,
    pub(super) beside: BesidePoints,
    pub(super) weights: ReferenceWeights,
    pub(super) laws: FacetLaws,
    sources: Vec<Source>,
    /// Of each particle and ghost the first of its facets among those that may meet.
    first: Vec<u32>,
    now: Vec<Facet<f64>>,
    /// Where it is about.
    about: Vec<About>,
    /// Stretch along its normal.
    stretch: Vec<f64>,
    /// Pairs of facets that may press, of every row of a block.
    candidates: Vec<Candidates>,
    /// Of each particle where these begin and end in its block, and of those that were found to press.
    found_of: Vec<[u32; 4]>,
    /// The first part of the face of the cell that a facet is a part of: the slip is that of the face.
    lead: Vec<u32>,
    /// Slips of particles that have pairs, block by block.
    pub(super) slips: Vec<Vec<(usize, CellSlips)>>,
    /// Which bodies have come apart: they have no cells any more.
    apart: Vec<bool>,
}

/// What the contact reads of particles and ghosts.
#[derive(Clone, Copy)]
pub(super) struct FacetPoints<'a> {
    id: WithGhosts<'a, u32>,
    body: WithGhosts<'a, u32>,
    /// Of bodies that break and meet themselves.
    integrity: Option<WithGhosts<'a, f64>>,
    velocity: WithGhosts<'a, Vector<f64>>,
    gradient: WithGhosts<'a, Tensor<f64>>,
    /// Of the edges of the low and of the high sides of cells.
    pub(super) shifts: [WithGhosts<'a, Tensor<f64>>; 2],
    slip: [WithGhosts<'a, Tensor<f64>>; 2],
    rubbed: [WithGhosts<'a, Vector<f64>>; 2],
}

impl<'a> FacetPoints<'a> {
    pub(super) fn new(own: &'a Particles, ghosts: &'a Particles) -> Self {
        Self {
            id: WithGhosts::new(&own.id, &ghosts.id),
            body: WithGhosts::new(&own.body, &ghosts.body),
            integrity: (!own.facet_integrity.is_empty())
                .then(|| WithGhosts::new(&own.facet_integrity, &ghosts.facet_integrity)),
            velocity: WithGhosts::new(&own.evaluated_velocity, &ghosts.evaluated_velocity),
            gradient: WithGhosts::new(&own.evaluated_gradient, &ghosts.evaluated_gradient),
            shifts: [
                WithGhosts::new(&own.shifts_of_low_edges, &ghosts.shifts_of_low_edges),
                WithGhosts::new(&own.shifts_of_high_edges, &ghosts.shifts_of_high_edges),
            ],
            slip: [
                WithGhosts::new(&own.slip_of_low_faces, &ghosts.slip_of_low_faces),
                WithGhosts::new(&own.slip_of_high_faces, &ghosts.slip_of_high_faces),
            ],
            rubbed: [
                WithGhosts::new(&own.rubbed_at_low_faces, &ghosts.rubbed_at_low_faces),
                WithGhosts::new(&own.rubbed_at_high_faces, &ghosts.rubbed_at_high_faces),
            ],
        }
    }
}

impl FacetPoints<'_> {
    /// Whether no facet of a particle holds a tangential spring or has let one go.
    fn has_no_springs(&self, i: usize) -> bool {
        (0..2).all(|high| self.slip[high].at(i) == [[0.0; 3]; 3] && self.rubbed[high].at(i) == [0.0; 3])
    }

    /// Whether a body meets itself at the facets of these two particles: neither is severed. A severed particle is loose and may be anywhere,
    /// within its own body too; facets that it carried there would be met from behind, at any depth at once.
    fn are_whole(&self, i: usize, j: usize) -> bool {
        self.integrity.is_none_or(|integrity| integrity.at(i) > 0.0 && integrity.at(j) > 0.0)
    }
}

/// Slip of the six faces of a cell, and the power of their friction over their stiffness, m²/s; of a face that has let
/// go, without stiffness, the power itself, W.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellSlips {
    pub(super) slip: [Tensor<f64>; 2],
    pub(super) rubbed: [Vector<f64>; 2],
}

/// A facet seen from the pair it is in.
#[derive(Clone, Copy)]
struct Side<'a> {
    index: usize,
    point: usize,
    facet: &'a Facet<f64>,
}

/// A pair that presses, from the side of the row.
struct Met<'a> {
    own: Side<'a>,
    other: Side<'a>,
    press: &'a FacetPress<f64>,
    /// Whether the own facet is the first of the pair.
    is_first: bool,
    law: &'a FacetPairLaw<f64>,
    bodies: (usize, usize),
    /// Velocity of the first at the centre of pressure relative to the second, m/s.
    velocity: Vector<f64>,
}

/// What the pairs of a facet with a body do to the edges of the facet, which is linear in it.
struct OnEdges {
    facet: usize,
    bodies: (usize, usize),
    forces: EdgeForces<f64>,
}

impl OnEdges {
    /// Adds a pair to that of the last one, if it is of the same facet and body: pairs of a facet come one after the other.
    fn add(all: &mut SmallVec<[Self; 6]>, met: &Met<'_>) {
        let forces = if met.is_first { met.press.edges_a } else { met.press.edges_b };
        let (facet, bodies) = (met.own.index, met.bodies);
        match all.last_mut().filter(|last| (last.facet, last.bodies) == (facet, bodies)) {
            Some(last) => last.forces.add(&forces),
            None => all.push(Self { facet, bodies, forces }),
        }
    }
}

impl FacetContacts {
    pub(super) fn new(model: &Model, strength: ContactStrength) -> Self {
        let reference = ReferenceFacets::new(model);
        Self {
            dimension: model.dimensions.into(),
            arms: Arms::new(&reference),
            reference,
            beside: BesidePoints::default(),
            weights: ReferenceWeights::default(),
            laws: FacetLaws::new(model, strength),
            sources: Vec::new(),
            first: Vec::new(),
            now: Vec::new(),
            about: Vec::new(),
            stretch: Vec::new(),
            candidates: Vec::new(),
            found_of: Vec::new(),
            lead: Vec::new(),
            slips: Vec::new(),
            apart: vec![false; model.bodies.len()],
        }
    }

    /// Whether some body has come apart.
    pub(super) fn has_rubble(&self) -> bool {
        self.apart.contains(&true)
    }

    /// Whether one of two bodies has come apart, so that they do not meet at facets.
    pub(super) fn are_apart(&self, a: u32, b: u32) -> bool {
        self.apart[a as usize] || self.apart[b as usize]
    }

    /// A bound of the distance of the corners of the facets of a particle, m, the same for all its images; zero
    /// without any, and in a body that has come apart: it meets the others by its kernels, and its deformation has no bound.
    pub(super) fn reach(&self, id: u32, f: &Tensor<f64>, has_come_apart: bool) -> f64 {
        if has_come_apart {
            return 0.0;
        }
        let sizes = f.map(|row| row.map(f64::abs));
        let squared = self.arms.of(id).iter().map(|corner| {
            let arm = apply(&sizes, *corner);
            dot(arm, arm)
        });
        squared.fold(0.0, f64::max).sqrt()
    }

    /// Takes over the pairs that were just found.
    pub(super) fn adopt(
        &mut self,
        foreign: &ForeignList,
        particles: &Particles,
        ghosts: &Ghosts,
        has_come_apart: &[bool],
    ) {
        self.apart.copy_from_slice(has_come_apart);
        self.weights.forget();
        let count = particles.len();
        let images = ghosts.halo.images();
        let others = ghosts.count() - images.len();
        let sign = |point: usize| match point.checked_sub(count + others) {
            Some(image) => images[image].sign(),
            None => [1.0; 3],
        };
        let id = WithGhosts::new(&particles.id, &ghosts.columns.id);
        self.first.clear();
        self.first.resize(count + ghosts.count() + 1, 0);
        for (own, row) in foreign.blocks().iter().flat_map(|block| block.rows()) {
            self.first[own] = 1;
            row.iter().for_each(|&j| self.first[j as usize] = 1);
        }
        if self.laws.has_friction {
            self.slips.resize_with(foreign.blocks().len(), Vec::new);
            for (slips, block) in self.slips.iter_mut().zip(foreign.blocks()) {
                slips.clear();
                slips.reserve(block.rows().count());
            }
        }
        self.sources.clear();
        for point in 0..count + ghosts.count() {
            let is_used = self.first[point] == 1;
            self.first[point] = self.sources.len() as u32;
            if is_used {
                let source = |place: usize| Source { point: point as u32, place: place as u32, sign: sign(point) };
                self.sources.extend(self.reference.range(id.at(point)).map(source));
            }
        }
        if let Some(last) = self.first.last_mut() {
            *last = self.sources.len() as u32;
        }
        self.lead.clear();
        for index in 0..self.sources.len() {
            let (point, face) = (self.sources[index].point, self.sources[index].face(&self.reference));
            let before = index.checked_sub(1).map(|k| (self.sources[k].point, self.sources[k].face(&self.reference)));
            let lead = if before == Some((point, face)) { self.lead[index - 1] } else { index as u32 };
            self.lead.push(lead);
        }
        let none = Facet {
            owner: [0.0; 3],
            corners: [[0.0; 3]; 4],
            middle: [0.0; 3],
            normal: [0.0; 3],
            curvature: SymmetricTensor::zero(),
            depth: 0.0,
            area: 0.0,
            free: [0.0; 4],
            shift: [0.0; 3],
            shear: [[0.0; 3]; 3],
            misfit: 0.0,
            rest_depth: 0.0,
        };
        self.now.clear();
        self.now.resize(self.sources.len(), none);
        self.about.clear();
        self.about.resize(self.sources.len(), About::default());
        self.candidates.resize_with(foreign.blocks().len(), Candidates::default);
        self.found_of.clear();
        self.found_of.resize(count, [0; 4]);
        self.stretch.clear();
        self.stretch.resize(self.sources.len(), 1.0);
    }

    /// Moves the facets to where they are now.
    pub(super) fn follow(&mut self, own: &Particles, ghosts: &Particles) {
        let position = WithGhosts::new(&own.position, &ghosts.position);
        let since = WithGhosts::new(&own.deformation, &ghosts.deformation);
        let earlier = WithGhosts::new(&own.earlier_deformation, &ghosts.earlier_deformation);
        let is_renewed = !own.earlier_deformation.is_empty();
        let points = FacetPoints::new(own, ghosts);
        let reference = &self.reference;
        let facets = (&mut self.now, &mut self.about, &mut self.stretch, &self.sources).into_par_iter();
        facets.with_min_len(64).for_each(|(now, about, stretch, source)| {
            let point = source.point as usize;
            let f = since.at(point);
            let f = if is_renewed { WholeDeformation::product(&f, &earlier.at(point)) } else { f };
            let facet = source.facet(reference).facet;
            let facet = if source.sign == [1.0; 3] { facet } else { mirrored(&facet, source) };
            let shifts = shifts_of(&points, point, source.sign);
            let shifted = Facet::now(position.at(point), &f, &facet).shifted(&facet, &f, &shifts);
            (*now, *stretch) = shifted.held(facet.depth);
            *about = About::new(now);
        });
    }

    /// Finds what presses.
    pub(super) fn find(&mut self, foreign: &ForeignList, points: &FacetPoints<'_>) {
        let (mut all, mut found_of) = (std::mem::take(&mut self.candidates), std::mem::take(&mut self.found_of));
        let count = found_of.len();
        let blocks = (all.par_iter_mut(), found_of.par_chunks_mut(BLOCK)).into_par_iter().zip(foreign.blocks());
        blocks.for_each(|((Candidates { pairs, pressing }, found_of), block)| {
            pairs.clear();
            pressing.clear();
            found_of.fill([0; 4]);
            for (i, row) in block.rows() {
                let from = [pairs.len() as u32, pressing.len() as u32];
                for own in self.facets_of(i) {
                    let meets = |j: usize| {
                        let (own, other) = (points.body.at(i), points.body.at(j));
                        !self.are_apart(own, other) && (own != other || points.are_whole(i, j))
                    };
                    for &j in row.iter().filter(|&&j| meets(j as usize)) {
                        for other in self.facets_of(j as usize) {
                            if !self.about[own].may_press(&self.about[other]) {
                                continue;
                            }
                            pairs.push((own as u32, other as u32));
                            let (own, other) = (self.side(own), self.side(other));
                            let is_first = self.is_first(own, other, points);
                            if !is_first && other.point < count {
                                continue;
                            }
                            let (a, b) = if is_first { (own, other) } else { (other, own) };
                            let law = self.law(own, other, points);
                            let press = press(a.facet, b.facet, Partner::Facet, law).within(self.dimension);
                            if press.energy > 0.0 {
                                pressing.push(Found { own: own.index as u32, other: other.index as u32, press });
                            }
                        }
                    }
                }
                found_of[i % BLOCK] = [from[0], pairs.len() as u32, from[1], pressing.len() as u32];
            }
        });
        (self.candidates, self.found_of) = (all, found_of);
    }

    /// What was found of a pair in the row of a particle.
    fn found(&self, i: usize, own: usize, other: usize) -> Option<&FacetPress<f64>> {
        let [.., from, to] = self.found_of[i];
        let pressing = &self.candidates[i / BLOCK].pressing[from as usize..to as usize];
        let found = pressing.iter().find(|found| (found.own as usize, found.other as usize) == (own, other));
        found.map(|found| &found.press)
    }

    /// Whether the first of two facets is the first of the pair: the same from both sides.
    fn is_first(&self, own: Side<'_>, other: Side<'_>, points: &FacetPoints<'_>) -> bool {
        let number = |side: Side<'_>| (points.id.at(side.point), self.sources[side.index].place);
        number(own) <= number(other)
    }

    fn law(&self, own: Side<'_>, other: Side<'_>, points: &FacetPoints<'_>) -> &FacetPairLaw<f64> {
        self.laws.of(points.body.at(own.point) as usize, points.body.at(other.point) as usize)
    }

    fn facets_of(&self, point: usize) -> std::ops::Range<usize> {
        self.first[point] as usize..self.first[point + 1] as usize
    }

    fn side(&self, index: usize) -> Side<'_> {
        Side { index, point: self.sources[index].point as usize, facet: &self.now[index] }
    }

    /// Whether a particle has nothing to do with others: it presses none, and its springs have let go.
    pub(super) fn is_alone(&self, i: usize, points: &FacetPoints<'_>) -> bool {
        !self.may_press(i) && (!self.laws.has_friction || points.has_no_springs(i))
    }

    /// Whether some pair of the particle's facets may press.
    pub(super) fn may_press(&self, i: usize) -> bool {
        let [from, to, ..] = self.found_of[i];
        from < to
    }

    /// Calls `visit` with every pair of the particle's facets that presses, if asked for only those with one point.
    fn each<'a>(&'a self, i: usize, only: Option<u32>, points: &FacetPoints<'_>, mut visit: impl FnMut(Met<'a>)) {
        let count = self.found_of.len();
        let [from, to, ..] = self.found_of[i];
        for &(own, other) in &self.candidates[i / BLOCK].pairs[from as usize..to as usize] {
            let (own, other) = (self.side(own as usize), self.side(other as usize));
            if only.is_some_and(|only| only as usize != other.point) {
                continue;
            }
            let is_first = self.is_first(own, other, points);
            let found = match is_first || other.point >= count {
                true => self.found(i, own.index, other.index),
                false => self.found(other.point, other.index, own.index),
            };
            let Some(press) = found else { continue };
            let motion = |side: Side<'_>| (points.velocity.at(side.point), points.gradient.at(side.point));
            let (a, b) = if is_first { (own, other) } else { (other, own) };
            let ((v_a, l_a), (v_b, l_b)) = (motion(a), motion(b));
            let velocity = press.velocity(v_a, &l_a, v_b, &l_b);
            let bodies = (points.body.at(own.point) as usize, points.body.at(other.point) as usize);
            visit(Met { own, other, press, is_first, law: self.law(own, other, points), bodies, velocity });
        }
    }

    /// Slip of a facet in space, and what it rubs.
    fn slip_of(&self, side: Side<'_>, points: &FacetPoints<'_>) -> (FacetSlip<f64>, f64) {
        let source = &self.sources[side.index];
        let (sign, (axis, high)) = (source.sign, source.face(&self.reference));
        let slip = points.slip[high].at(side.point)[axis];
        let rubbed = points.rubbed[high].at(side.point)[axis];
        // Ghosts got them mirrored like tensors and vectors in space, which they are not.
        let turn = |k: usize| sign[axis] * sign[k];
        let mut slip = FacetSlip { slip: [turn(0) * slip[0], turn(1) * slip[1]], stiffness: turn(2) * slip[2] };
        if source.is_reversed() {
            // The first edge of a mirrored facet goes the other way.
            slip.slip[0] = -slip.slip[0];
        }
        (slip, sign[axis] * rubbed)
    }

    /// First pass, with friction: slips of the particle's facets after a step `dt`, s.
    pub(super) fn slips(&self, i: usize, points: &FacetPoints<'_>, dt: f64) -> CellSlips {
        if !self.may_press(i) && points.has_no_springs(i) {
            return CellSlips { slip: [[[0.0; 3]; 3]; 2], rubbed: [[0.0; 3]; 2] };
        }
        let mut drives = [SlipDrive::none(); 6];
        self.each(i, None, points, |met| {
            let share = FrictionShare::of(met.press, met.law, met.velocity, false);
            let share = if met.is_first { share } else { share.turned() };
            let (axis, high) = self.sources[met.own.index].face(&self.reference);
            drives[2 * axis + high].add(&share);
        });
        let mut slips = CellSlips { slip: [[[0.0; 3]; 3]; 2], rubbed: [[0.0; 3]; 2] };
        for index in self.facets_of(i).filter(|&index| self.lead[index] as usize == index) {
            let side = self.side(index);
            let (before, _) = self.slip_of(side, points);
            let (axis, high) = self.sources[index].face(&self.reference);
            let (after, heat) = slip_after(&before, side.facet, &drives[2 * axis + high], dt);
            slips.slip[high][axis] = [after.slip[0], after.slip[1], after.stiffness];
            slips.rubbed[high][axis] = match after.stiffness > 0.0 {
                _ if dt == 0.0 => 0.0,
                true => heat / (dt * after.stiffness),
                false => heat / dt,
            };
        }
        slips
    }

    /// Second pass: what the pairs of a particle do to it, if asked for only those with one point of its row, with the moment of their forces about it, N m.
    pub(super) fn push(
        &self,
        i: usize,
        (row, only): (&[u32], Option<u32>),
        points: &FacetPoints<'_>,
        own: (f64, &Tensor<f64>, &CellEdges),
        table: &ContactLaws,
        sums: &mut BlockSums,
    ) -> (Push, Tensor<f64>, OnSides<f64>) {
        let (mass, f, edges) = own;
        let mut shifts = OnSides::zero();
        edges.iter().for_each(|edge| *shifts.on_mut(edge.side) = edge.edge.shift());
        let mut push = Push::default();
        let mut on_edges: SmallVec<[OnEdges; 6]> = SmallVec::new();
        let mut moment = [[0.0; 3]; 3];
        let mut stiffness = FacetStiffness::none();
        let (v, l) = (points.velocity.at(i), points.gradient.at(i));
        self.each(i, only, points, |met| {
            let mut press = *met.press;
            let sign = if met.is_first { 1.0 } else { -1.0 };
            let stretch = self.stretch[met.own.index];
            if stretch > 1.0 {
                let force = press.force.map(|c| sign * c);
                let torn = moment_of_torn(met.own.facet, stretch, force);
                for k in 0..3 {
                    for c in 0..3 {
                        moment[k][c] += torn[k][c];
                        sums.of(table.place(met.bodies.0, met.bodies.1)).stored -= torn[k][c] * l[k][c];
                    }
                }
            }
            let (force, damped) = press.damping(met.law, met.velocity);
            let mut pull = [0.0; 3];
            let (mut rubbed, mut held) = (0.0, 0.0);
            if self.laws.has_friction {
                let (own, other) = (self.slip_of(met.own, points), self.slip_of(met.other, points));
                let (a, b) = if met.is_first { (met.own, met.other) } else { (met.other, met.own) };
                let (of_a, of_b) = if met.is_first { (own, other) } else { (other, own) };
                let vector =
                    |side: Side<'_>, slip: &FacetSlip<f64>| slip.vector(&self.now[self.lead[side.index] as usize]);
                pull = friction_force(&press, met.law, vector(a, &of_a.0), vector(b, &of_b.0), false);
                let share = FrictionShare::of(&press, met.law, met.velocity, false).stiffness;
                rubbed = share * (own.1 + other.1);
                // Of what the own spring holds, the part of this pair.
                held = if share > 0.0 { share / own.0.stiffness * own.0.energy() } else { 0.0 };
            }
            let at_centre: Vector<f64> = std::array::from_fn(|k| force[k] + pull[k]);
            press.add_at_centre(at_centre);
            let of_own = if met.is_first { &press.moment_a } else { &press.moment_b };
            let mut power = 0.0;
            let (a, b) = met.bodies;
            let sum = sums.of(table.place(a, b));
            for k in 0..3 {
                let force = sign * press.force[k];
                push.force[k] += force;
                power += force * v[k];
                if a < b {
                    sum.force[k] += force;
                }
                for c in 0..3 {
                    moment[k][c] += of_own[k][c];
                    power += of_own[k][c] * l[k][c];
                }
            }
            OnEdges::add(&mut on_edges, &met);
            let friction = table.friction_share(a, b) * rubbed;
            push.heat += 0.5 * damped + friction;
            push.friction += friction;
            // The other half comes from the row of the other particle.
            sum.energy += 0.5 * press.energy + held;
            sum.stored -= power;
            sum.friction += friction;
            sum.damped += 0.5 * damped;
            stiffness.add(met.press, met.law, mass);
        });
        let released = self.released(i, points);
        if released != 0.0 {
            push.heat += released;
            push.friction += released;
            if let Some(other) = self.nearest(i, row) {
                sums.of(table.place(points.body.at(i) as usize, points.body.at(other) as usize)).friction += released;
            }
        }
        let mut pulls = OnSides::zero();
        for OnEdges { facet, bodies: (a, b), forces } in on_edges {
            let reference = &self.sources[facet].facet(&self.reference).facet;
            let cell = forces.on_cell(&self.now[facet], reference, f, &shifts);
            let mut power: f64 = (0..3).map(|k| dot(cell.moment[k], l[k])).sum();
            for edge in edges {
                let (of_side, all) = (cell.sides.on(edge.side), pulls.on_mut(edge.side));
                power += dot(*of_side, edge.rate);
                (0..3).for_each(|k| all[k] += of_side[k]);
            }
            moment = plus(&moment, 1.0, &cell.moment);
            stiffness.add_edges(&cell, mass);
            sums.of(table.place(a, b)).stored -= power;
        }
        for edge in edges {
            let pull = pulls.on_mut(edge.side);
            *pull = edge.edge.tangent(*pull);
            moment = plus(&moment, 1.0, &moment_of_edge(*pull, f, edge.way));
        }
        for k in 0..3 {
            push.heat += dot(moment[k], l[k]);
        }
        push.limit = stiffness.limit();
        (push, moment, pulls)
    }

    /// Power of the springs of a particle's facets that have lost their last partner, W: what they held is its heat.
    fn released(&self, i: usize, points: &FacetPoints<'_>) -> f64 {
        if !self.laws.has_friction || points.has_no_springs(i) {
            return 0.0;
        }
        let leads = self.facets_of(i).filter(|&index| self.lead[index] as usize == index);
        let springs = leads.map(|index| self.slip_of(self.side(index), points));
        springs.filter(|(slip, _)| slip.stiffness == 0.0).map(|(_, power)| power).sum()
    }

    /// The nearest of the row that has facets: nothing says any more whom a facet that is free has let go.
    fn nearest(&self, i: usize, row: &[u32]) -> Option<usize> {
        let place = |point: usize| self.facets_of(point).next().map(|index| self.now[index].owner);
        let from = place(i)?;
        let squared = |x: Vector<f64>| (0..3).map(|k| (x[k] - from[k]).powi(2)).sum::<f64>();
        let near = row.iter().filter_map(|&j| Some((squared(place(j as usize)?), j as usize)));
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, j)| j)
    }

    /// Force of a particle or ghost `j` on a particle, N.
    pub(super) fn force(
        &self,
        i: usize,
        j: u32,
        own: &Particles,
        ghosts: &Particles,
        table: &ContactLaws,
    ) -> Vector<f64> {
        let points = FacetPoints::new(own, ghosts);
        let own = (own.mass[i], &own.deformation[i], &CellEdges::new());
        self.push(i, (&[j], Some(j)), &points, own, table, &mut BlockSums::default()).0.force
    }

    pub(super) fn bytes(&self) -> usize {
        self.reference.bytes()
            + self.arms.bytes()
            + self.beside.bytes()
            + self.weights.bytes()
            + 4 * (self.first.capacity() + self.lead.capacity())
            + self.sources.capacity() * size_of::<Source>()
            + self.now.capacity() * size_of::<Facet<f64>>()
            + self.about.capacity() * size_of::<About>()
            + self
                .candidates
                .iter()
                .map(|of| 8 * of.pairs.capacity() + size_of::<Found>() * of.pressing.capacity())
                .sum::<usize>()
            + size_of::<[u32; 4]>() * self.found_of.capacity()
            + self.slips.iter().map(Vec::capacity).sum::<usize>() * size_of::<(usize, CellSlips)>()
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// What is severed takes no part in the contact of its body with itself, from the step after that in which it was.
    pub(super) fn take_out_severed(&mut self) {
        let Particles { facet_integrity, history, .. } = &mut self.particles;
        let history = &*history;
        let all = facet_integrity.par_iter_mut().with_min_len(BLOCK).enumerate();
        all.for_each(|(i, integrity)| *integrity = history.integrity_of(i));
    }
}

/// First Piola-Kirchhoff stress, Pa, whose sum leaves a particle without the work of a moment (N m) of forces on its facets.
pub(super) fn face_stress(moment: &Tensor<f64>, f: &Tensor<f64>, volume: f64) -> Tensor<f64> {
    stress_of_moment(moment, f).map(|row| row.map(|c| -c / volume))
}
