//! Pairs of facets that press: particles near each other, their facets, and what is known of a pair.

use super::contact::SelfPairs;
use super::facets::{Table, carried};
use super::grid::Grid;
use super::images::{Image, Planes};
use super::neighbors::{ON_PLANE, strays};
use super::reference::{Deformations, References};
use super::shared_edges::shifts;
use crate::engine::columns::{
    Binder, CompensatedVector, Group, Read, ReadColumns, ReadRecords, Records, VectorColumns, groups,
};
use crate::record::{Index, Indices, Recorded, Scope};
use sphorge_engine::FacetLaws;
use sphorge_engine::model::Model;
use sphorge_physics::facet::{Facet, FacetPairLaw, FacetPress, Partner, press as press_of_pair};
use sphorge_physics::tensor::{apply, dot};
use sphorge_physics::{Elementary, Numbers, Real, Vector};

/// What the pairs of facets of a particle are made of.
#[derive(Clone, Copy)]
pub(super) struct Points {
    pub(super) table: Table,
    pub(super) place: CompensatedVector<Read>,
    pub(super) deformation: Deformations,
    pub(super) motion: groups::FacetMotion<Read>,
    pub(super) edges: groups::SharedEdges<Read>,
    pub(super) evaluated: VectorColumns<Read>,
    pub(super) body: Indices,
    pub(super) laws: groups::FacetLaws<Records>,
    pub(super) bodies: u32,
    /// Whether the law of some pair does.
    pub(super) some_give_way: bool,
    pub(super) itself: Option<SelfPairs>,
}

/// A neighbour whose facets may meet those of a particle.
pub(super) struct Near<'a> {
    pub(super) image: &'a Image,
    /// From it to the particle, m.
    pub(super) x: Vector<Recorded>,
    pub(super) j: Index,
}

/// A pair that presses, from the side of the particle.
pub(super) struct Met<'a> {
    pub(super) image: &'a Image,
    pub(super) j: Index,
    /// Places of both facets in the table.
    pub(super) facets: [Index; 2],
    pub(super) own: Facet<Recorded>,
    /// Stretch of the own facet along its normal.
    pub(super) stretch: Recorded,
    /// One if the own facet is the first of the pair, else minus one.
    pub(super) sign: Recorded,
    pub(super) press: FacetPress<Recorded>,
    pub(super) law: FacetPairLaw<Recorded>,
    /// Share of the heat of friction that the particle receives.
    pub(super) friction_share: Recorded,
    /// Velocity of the own side at the centre of pressure relative to the other, m/s.
    pub(super) velocity: Vector<Recorded>,
}

impl Met<'_> {
    /// Of two numbers that belong to the facets of the pair that of the own one.
    pub(super) fn own(&self, of_first: Recorded, of_second: Recorded) -> Recorded {
        chosen(self.sign, of_first, of_second)
    }
}

/// The first if the sign is positive, else the second.
fn chosen(sign: Recorded, first: Recorded, second: Recorded) -> Recorded {
    Recorded::select_lt(Recorded::zero(), sign, first, second)
}

fn chosen_facet(sign: Recorded, first: &Facet<Recorded>, mut second: Facet<Recorded>) -> Facet<Recorded> {
    let (mut numbers, mut first) = (Vec::new(), *first);
    first.each(&mut |number| numbers.push(*number));
    let mut numbers = numbers.into_iter();
    second.each(&mut |number| {
        if let Some(first) = numbers.next() {
            *number = chosen(sign, first, *number);
        }
    });
    second
}

impl Points {
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Self {
        Self {
            table: Table::of(bind),
            place: groups::Place::read(bind).position,
            deformation: Deformations::of(bind, references),
            motion: groups::FacetMotion::read(bind),
            edges: groups::SharedEdges::read(bind),
            evaluated: groups::Evaluated::read(bind).velocity,
            body: bind.indices(Group::Body),
            laws: groups::FacetLaws::records(bind),
            bodies: model.bodies.len() as u32,
            some_give_way: model.contact.strength().is_some_and(|of| FacetLaws::new(model, of).some_give_way()),
            itself: SelfPairs::of(bind, model, references),
        }
    }

    /// The law of two particles, and the share of the heat of friction that the first receives.
    fn law(self, i: Index, j: Index) -> (FacetPairLaw<Recorded>, Recorded) {
        let pair = self.body.at(i) * Index::of(self.bodies) + self.body.at(j);
        let law = FacetPairLaw {
            stiffness: self.laws.stiffness.get(pair),
            damping: self.laws.damping.get(pair),
            friction: self.laws.friction.get(pair),
            tangential_stiffness: self.laws.tangential_stiffness.get(pair),
            gives_way: if self.some_give_way { self.laws.gives_way.get(pair) } else { Recorded::zero() },
            // Single precision has it by itself.
            coincidence: Recorded::zero(),
        };
        (law, self.laws.friction_share.get(pair))
    }

    /// Folds a state over every particle that has a contact with a particle and is not farther than `reach` (m) returns,
    /// by its index, images among them.
    fn over_near<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        grid: &Grid,
        i: Index,
        reach: impl FnOnce(Index) -> Recorded,
        start: S,
        add: impl FnOnce(&mut Scope, S, &Near<'_>) -> S,
    ) -> S {
        let (starts, sorted, around) =
            (bind.indices(Group::CellStarts), bind.indices(Group::Sorted), bind.indices(Group::Around));
        let planes = Planes::of(model);
        let own = self.place.get(i);
        let cells = Index::of((grid.around().len() / 3) as u32);
        let near = Recorded::of(strays(model) * grid.edge);
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let codes: Vec<u32> = planes.images().map(|(bits, _)| bits).collect();
        let images = Index::of(codes.len() as u32);
        bind.scope.fold(Index::of(0), images, start, |scope, state: S, number| {
            let number = number.number();
            let mut code = zero;
            for (k, bits) in codes.iter().enumerate().skip(1) {
                code = Recorded::select_lt(Recorded::of(k as f64 - 0.5), number, Recorded::of(f64::from(*bits)), code);
            }
            let image = planes.coded(code);
            // A particle next to the image of the particle has an image next to the particle itself.
            let steps = grid.steps(&|axis| image.back(axis, own[axis][0]));
            let mut farthest = -Recorded::largest();
            for axis in 0..D {
                farthest = farthest.max(image.distance(axis, own[axis]));
            }
            let among = |scope: &mut Scope, state: S| {
                scope.fold(Index::of(0), cells, state, |scope, state, k| {
                    let there = k * Index::of(3);
                    let cell = grid.cell([0, 1, 2].map(|axis| steps[axis] + around.at(there + Index::of(axis as u32))));
                    scope.fold(starts.at(cell), starts.at(cell + Index::of(1)), state, |scope, state, at| {
                        let j = sorted.at(at);
                        let other = self.place.get(j);
                        let x = [0, 1, 2].map(|a| if a < D { image.apart(a, own[a], other[a]) } else { zero });
                        let reach = reach(j);
                        let mut meets = Recorded::select_lt(dot(x, x), reach * reach, one, zero);
                        for axis in 0..D {
                            // On a plane it has no image, and the neighbour sums over the particle only if it is as near.
                            let distance = image.distance(axis, other[axis]);
                            let is_off = Recorded::select_lt(Recorded::of(ON_PLANE) * reach, distance, meets, zero);
                            let is_near = Recorded::select_lt(distance, near, is_off, zero);
                            meets = image.if_mirrored(axis, is_near, meets);
                        }
                        let other_body = (self.body.at(j).number() - self.body.at(i).number()).abs();
                        let of_itself = self.itself.map_or(zero, |of| of.meet::<D>(model, i, &image, j));
                        meets = meets * Recorded::select_lt(other_body, Recorded::of(0.5), of_itself, one);
                        let near = Near { image: &image, x, j };
                        Recorded::if_lt(zero, meets, || add(scope, state, &near), || state)
                    })
                })
            };
            if codes.len() == 1 {
                return among(scope, state);
            }
            Recorded::if_lt(farthest, near, || among(scope, state), || state)
        })
    }

    /// Folds a state over every pair of the particle's facets with others that presses. `after` is given the state when a facet has met all facets of a particle,
    /// with the places of both.
    pub(super) fn each<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        grid: &Grid,
        i: Index,
        start: S,
        visit: impl FnOnce(S, &Met<'_>) -> S,
        after: impl FnOnce(S, Index, Index) -> S,
    ) -> S {
        let table = self.table;
        let ([high_i, low_i], first_i) = (table.id(i), table.first(i));
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let reach_i = self.motion.reach.get(i);
        let reach = |j: Index| reach_i + self.motion.reach.get(j);
        let has_images = Planes::of(model).images().count() > 1;
        self.over_near::<S, D>(bind, model, grid, i, reach, start, |scope, state, near| {
            let Near { image, x, j } = *near;
            let (law, friction_share) = self.law(i, j);
            let [high_j, low_j] = table.id(j);
            // The same order from both sides.
            let below = |a: Recorded, b: Recorded, otherwise: Recorded| {
                let not_above = Recorded::select_lt(b, a, -one, otherwise);
                Recorded::select_lt(a, b, one, not_above)
            };
            let first_j = table.first(j);
            scope.fold(first_i, table.end(i), state, |scope, state, facet_i| {
                // What pairs have in common is read for each of them: registers are full of what their law needs.
                let state = scope.fold(first_j, table.end(j), state, |_, state, facet_j| {
                    let (own, stretch) = self.carried(i, facet_i, None);
                    let (other, _) = self.carried(j, facet_j, has_images.then_some(image));
                    let other = Facet { owner: x.map(|c| -c), ..other };
                    let (part_i, part_j) = (facet_i.number() - first_i.number(), facet_j.number() - first_j.number());
                    let by_part = Recorded::select_lt(part_j, part_i, -one, one);
                    let sign = below(high_i, high_j, below(low_i, low_j, by_part));
                    let a = chosen_facet(sign, &own, other);
                    let b = chosen_facet(sign, &other, own);
                    let press = press_of_pair(&a, &b, Partner::Facet, &law).within(model.dimensions.into());
                    let visit = || {
                        let (v_i, l_i) = (self.evaluated.get(i), self.motion.velocity_gradient.get(i));
                        let (v_j, l_j) =
                            (image.vector(self.evaluated.get(j)), image.tensor(&self.motion.velocity_gradient.get(j)));
                        let to_centre = |first: Vector<Recorded>, second: Vector<Recorded>| {
                            [0, 1, 2].map(|k| chosen(sign, first[k], second[k]))
                        };
                        let turn_i = apply(&l_i, to_centre(press.centre_a, press.centre_b));
                        let turn_j = apply(&l_j, to_centre(press.centre_b, press.centre_a));
                        let velocity = [0, 1, 2].map(|k| (v_i[k] + turn_i[k]) - (v_j[k] + turn_j[k]));
                        let facets = [facet_i, facet_j];
                        visit(
                            state,
                            &Met { image, j, facets, own, stretch, sign, press, law, friction_share, velocity },
                        )
                    };
                    Recorded::if_lt(zero, press.energy, visit, || state)
                });
                after(state, facet_i, j)
            })
        })
    }

    /// A facet of a particle where it is, and the stretch along its normal.
    pub(super) fn carried(self, i: Index, facet: Index, image: Option<&Image>) -> (Facet<Recorded>, Recorded) {
        carried(self.table, facet, (&self.deformation.whole(i), &shifts(self.edges, i)), image)
    }

    /// The body of the nearest particle that a particle may have had contact with, its own if there is none: nothing says
    /// any more whom a facet that is free has let go.
    pub(super) fn nearest<const D: usize>(self, bind: &mut Binder<'_>, model: &Model, grid: &Grid, i: Index) -> Index {
        let start = [Recorded::largest(), self.body.at(i).number()];
        let reach = |_: Index| Recorded::of(2.0 * grid.edge);
        let [_, body] = self.over_near::<_, D>(bind, model, grid, i, reach, start, |_, [least, body], near| {
            let squared = dot(near.x, near.x);
            let number = self.body.at(near.j).number();
            [least.min(squared), Recorded::select_lt(squared, least, number, body)]
        });
        Index::floor(body)
    }
}
