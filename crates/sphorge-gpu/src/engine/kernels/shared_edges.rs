//! Edges that facets of neighbouring cells share, as in the engine for processors: where they are, and the forces on the neighbours that they follow.

use super::facets::Table;
use super::neighbors::{Pair, over_list};
use super::reference::{Deformations, References};
use super::section::{Crossing, Through};
use crate::engine::columns::groups::{self, FACES};
use crate::engine::columns::{
    Binder, CompensatedVector, Group, Member, NOTHING, Read, ReadColumns, Recording, ValuedMember, WriteColumns,
    recording,
};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::geometry;
use sphorge_engine::model::Model;
use sphorge_physics::facet::{OnSides, SharedEdge, half_of_misfit, moment_of_edge, stress_of_moment};
use sphorge_physics::tensor::{dot, multiply, plus};
use sphorge_physics::{Elementary, Numbers, Real, Tensor, Vector};

/// A cell that is beside that of a particle.
struct Beside<'a> {
    side: usize,
    /// To its particle at the start, m.
    way: Vector<Recorded>,
    pair: &'a Pair,
    j: Index,
}

/// What the edges of a particle follow from.
#[derive(Clone, Copy)]
struct Cells {
    table: Table,
    place: CompensatedVector<Read>,
    near: (groups::Reference<Read>, groups::Constants<Read>),
}

impl Cells {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            table: Table::of(bind),
            place: groups::Place::read(bind).position,
            near: (groups::Reference::read(bind), groups::Constants::read(bind)),
        }
    }

    /// Folds a state over the cells beside that of a particle.
    fn over<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        i: Index,
        start: S,
        mut add: impl FnMut(S, &Beside<'_>) -> S,
    ) -> S {
        let row = self.table.beside(i);
        let ways = self.table.ways;
        over_list::<_, D>(bind, model, i, self.near, start, |mut state: S, pair, j| {
            for side in 0..2 * D {
                let way = ways.ways.vector(side).get(row);
                let off = [0, 1, 2].map(|a| pair.x[a] + way[a]);
                let within = Recorded::of(geometry::Beside::THERE * geometry::Beside::THERE) * dot(way, way);
                let beside = Beside { side, way, pair, j };
                state = Recorded::if_lt(dot(off, off), within, || add(state, &beside), || state);
            }
            state
        })
    }

    /// From a particle to the next one, m.
    fn to<const D: usize>(self, i: Index, beside: &Beside<'_>) -> Vector<Recorded> {
        let (own, other) = (self.place.get(i), self.place.get(beside.j));
        [0, 1, 2].map(|a| if a < D { -beside.pair.image.apart(a, own[a], other[a]) } else { Recorded::zero() })
    }
}

/// Moves the edges of a particle with facets to the middle between the cells that share them.
pub(in crate::engine) fn shift<const D: usize>(
    model: &Model,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("shift_edges", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (cells, deformation) = (Cells::of(bind), Deformations::of(bind, references));
        let (evaluated, motion) = (groups::Evaluated::read(bind).velocity, groups::FacetMotion::read(bind));
        let edges = groups::SharedEdges::write(bind);
        let f = deformation.whole(i);
        let turned = multiply(&motion.velocity_gradient.get(i), &f);
        let own = evaluated.get(i);
        for side in 0..FACES {
            edges.of(side).shift.set(i, [Recorded::zero(); 3]);
            edges.of(side).rate.set(i, [Recorded::zero(); 3]);
        }
        cells.over::<_, D>(bind, model, i, NOTHING, |nothing, beside| {
            let edge = SharedEdge::of(cells.to::<D>(i, beside), &f, beside.way);
            let other = beside.pair.image.vector(evaluated.get(beside.j));
            let apart = [0, 1, 2].map(|a| other[a] - own[a]);
            let edges = edges.of(beside.side);
            edges.shift.set(i, edge.shift());
            edges.rate.set(i, edge.tangent(half_of_misfit(apart, &turned, beside.way)));
            nothing
        });
    })
}

/// Shifts of the edges of a particle, m.
pub(super) fn shifts(edges: groups::SharedEdges<Read>, i: Index) -> OnSides<Recorded> {
    let mut shifts = OnSides::zero();
    (0..FACES).for_each(|side| *shifts.on_mut(side) = edges.of(side).shift.get(i));
    shifts
}

/// Turns the forces on the shifts of the edges of a particle into those on their distances, and adds their moment.
pub(in crate::engine) fn pull<const D: usize>(
    model: &Model,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("pull_edges", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (cells, deformation) = (Cells::of(bind), Deformations::of(bind, references));
        let motion = groups::FacetMotion::read(bind);
        let (pulls, contact) = (groups::EdgePulls::write(bind), groups::Contact::write(bind));
        let face_stress = groups::FaceStress::write(bind).stress;
        let f = deformation.whole(i);
        let none: Tensor<Recorded> = [[Recorded::zero(); 3]; 3];
        let moment = cells.over::<_, D>(bind, model, i, none, |moment, beside| {
            let pull = pulls.of(beside.side).pull;
            let force = SharedEdge::of(cells.to::<D>(i, beside), &f, beside.way).tangent(pull.get(i));
            pull.set(i, force);
            plus(&moment, Recorded::one(), &moment_of_edge(force, &f, beside.way))
        });
        let l = motion.velocity_gradient.get(i);
        let heat = (0..3).fold(contact.heat.get(i), |heat, k| heat + dot(moment[k], l[k]));
        contact.heat.set(i, heat);
        let volume = cells.near.0.volume.high().get(i);
        let stress = stress_of_moment(&moment, &deformation.since_reference(i));
        for (k, stress) in stress.into_iter().flatten().enumerate() {
            let component = face_stress.component(k);
            component.set(i, component.get(i) - stress / volume);
        }
    })
}

/// Adds the forces of the edges on the cells that they follow to those of the contact of a particle with facets.
///
/// If a section is given, those across it are added to the force through it instead.
pub(in crate::engine) fn share<const D: usize>(
    model: &Model,
    through: Option<Through<'_>>,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording(&Through::name(through, "share_pulls"), count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (cells, pulls) = (Cells::of(bind), groups::EdgePulls::read(bind));
        let row = cells.table.beside(i);
        let force = |beside: &Beside<'_>| -> Vector<Recorded> {
            let facing = Index::floor(cells.table.ways.facing.number(beside.side).get(row));
            let own = pulls.of(beside.side).pull.get(i);
            let other = beside.pair.image.vector(pulls.of_value(facing).pull.get(beside.j));
            [0, 1, 2].map(|a| Recorded::of(0.5) * (other[a] - own[a]))
        };
        let none = [Recorded::zero(); 3];
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, cells.place);
            let sum = cells.over::<_, D>(bind, model, i, none, |sum, beside| {
                crossing.add(sum, &beside.pair.image, beside.j, || force(beside), |force| *force)
            });
            crossing.set(sum, true);
            return;
        }
        let contact = groups::Contact::write(bind);
        let sum: Vector<Recorded> = cells.over::<_, D>(bind, model, i, none, |sum, beside| {
            let force = force(beside);
            [0, 1, 2].map(|a| sum[a] + force[a])
        });
        contact.force.add(i, sum);
    })
}
