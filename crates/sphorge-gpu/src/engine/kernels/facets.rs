//! Contact of bodies of the total Lagrangian form at the facets of the cells of their particles, and of a body with
//! itself, as in the engine for processors.
//!
//! Facets are found on the processor in the initial configuration ([`crate::engine::facets`]). A kernel carries those of
//! a particle and of its neighbours to the present where it needs them: that is short beside the law of a pair. The law
//! is long, so a kernel has its text once, in a loop over facets, neighbours, cells and images.

use super::contact::{LIMIT, MEETING, SelfPairs, each_body, law_number};
use super::grid::Grid;
use super::images::{Image, Planes};
use super::neighbors::{ON_PLANE, over_list, places, strays};
use super::reference::{Deformations, References};
use super::section::{Crossing, Through};
use crate::engine::columns::{Binder, Fields, Group, NOTHING, Reading, Recording, recording};
use crate::engine::step_numbers::{DT, NUMBER};
use crate::record::{Index, Indices, KernelFault, Recorded, Scope};
use sphorge_engine::FacetLaws;
use sphorge_engine::model::Model;
use sphorge_physics::facet::{
    Facet, FacetPairLaw, FacetPress, FacetSlip, FacetStiffness, FrictionShare, Partner, ReferenceFacet, SlipDrive,
    edges_reversed, friction_force, moment_of_torn, press as press_of_pair, slip_after, stress_of_moment,
};
use sphorge_physics::gradient_correction::corrected;
use sphorge_physics::pair::GradientSums;
use sphorge_physics::tensor::{apply, dot, inverse, multiply};
use sphorge_physics::thin::is_thin;
use sphorge_physics::{Elementary, Numbers, Real, SymmetricTensor, Tensor, Vector};

/// Numbers of a facet in [`Group::FacetTable`]: corners, middle, m, normal, curvature, 1/m, depth, m, the face of the cell
/// that it is a part of, how many parts of this face precede it, and one for each of its edges that is free.
pub(in crate::engine) const FACET: usize = 31;
const MIDDLE: usize = 12;
const NORMAL: usize = 15;
const CURVATURE: usize = 18;
const DEPTH: usize = 24;
const FACE: usize = 25;
const PART: usize = 26;
const FREE: usize = 27;

/// Whole numbers of a particle in [`Group::Facets`]: the first of its facets, the one behind its last, and its `id`.
pub(in crate::engine) const FACETS: usize = 3;

/// Numbers of a particle in [`Group::FacetMotion`]: velocity gradient, 1/s, and reach of its facets, m.
pub(in crate::engine) const MOTION: usize = 10;
/// Index of the reach among them.
pub(in crate::engine) const REACH: usize = 9;

/// Faces of a cell.
const FACES: usize = 6;

/// Numbers of a face in [`Group::Slips`]: slip along the first edge of its facet and square to it, m, stiffness, N/m, and
/// power of the friction over it, m²/s; without stiffness the power, W.
const SLIP: usize = 4;
const RUBBED: usize = 3;
/// Numbers of a particle there.
pub(in crate::engine) const SLIPS: usize = SLIP * FACES;

/// Numbers of a face in [`Group::Drives`]: sums over its pairs, stiffness, limit, and rate.
const DRIVE: usize = 5;
/// Numbers of a particle there.
pub(in crate::engine) const DRIVES: usize = DRIVE * FACES;

/// How much farther than the corners of facets owners are looked for: surfaces are curved.
const FARTHER: f64 = 1.1;

/// Indices of the power that the contact takes up and of the energy that it holds among the numbers of
/// [`Group::Meetings`].
const TAKEN_UP: usize = 3;
pub(in crate::engine) const ENERGY: usize = 12;

/// Numbers of the law of two bodies.
pub(super) fn law_numbers(laws: &FacetLaws, (a, b): (usize, usize), friction_share: f64) -> [f64; 6] {
    let FacetPairLaw { stiffness, damping, friction, tangential_stiffness } = *laws.of(a, b);
    [stiffness, damping, friction, tangential_stiffness, 0.0, friction_share]
}

/// Facets of the initial configuration, and who has them.
#[derive(Clone, Copy)]
struct Table {
    numbers: Reading,
    of_particles: Indices,
    stride: Index,
}

impl Table {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self { numbers: bind.read(Group::FacetTable), of_particles: bind.indices(Group::Facets), stride: bind.stride() }
    }

    fn first(self, i: Index) -> Index {
        self.of_particles.at(i)
    }

    fn end(self, i: Index) -> Index {
        self.of_particles.at(self.stride + i)
    }

    /// The number of a particle that no other has, in two parts that single precision represents exactly.
    fn id(self, i: Index) -> [Recorded; 2] {
        const LOW: u32 = (1 << 16) - 1;
        let id = self.of_particles.at(Index::of(2) * self.stride + i);
        [id.and(Index::of(!LOW)).number(), id.and(Index::of(LOW)).number()]
    }

    fn number(self, facet: Index, field: usize) -> Recorded {
        self.numbers.get_at(facet * Index::of(FACET as u32) + Index::of(field as u32))
    }

    fn vector(self, facet: Index, field: usize) -> Vector<Recorded> {
        [0, 1, 2].map(|a| self.number(facet, field + a))
    }

    fn facet(self, facet: Index) -> ReferenceFacet<Recorded> {
        ReferenceFacet {
            corners: [0, 1, 2, 3].map(|corner| self.vector(facet, 3 * corner)),
            middle: self.vector(facet, MIDDLE),
            normal: self.vector(facet, NORMAL),
            curvature: SymmetricTensor::from_array([0, 1, 2, 3, 4, 5].map(|k| self.number(facet, CURVATURE + k))),
            depth: self.number(facet, DEPTH),
            free: [0, 1, 2, 3].map(|edge| self.number(facet, FREE + edge)),
        }
    }

    fn face(self, facet: Index) -> Index {
        Index::floor(self.number(facet, FACE))
    }

    /// The first part of the same face.
    fn lead(self, facet: Index) -> Index {
        facet + Index::floor(-self.number(facet, PART))
    }
}

/// A facet where it is, about its owner, and the stretch along its normal.
fn carried(table: Table, facet: Index, f: &Tensor<Recorded>, image: Option<&Image>) -> (Facet<Recorded>, Recorded) {
    let reference = table.facet(facet);
    let (now, stretch) = Facet::now([Recorded::zero(); 3], f, &reference).held(reference.depth);
    (image.map_or(now, |image| mirrored(&now, image)), stretch)
}

/// Whether corners of an image follow each other the other way round: `-1` if so, else one.
fn handedness(image: &Image) -> Recorded {
    let [x, y, z] = image.vector([Recorded::one(); 3]);
    x * y * z
}

fn mirrored(facet: &Facet<Recorded>, image: &Image) -> Facet<Recorded> {
    let hand = handedness(image);
    let [a, b, c, d] = facet.corners.map(|corner| image.vector(corner));
    let choose = |reversed: Vector<Recorded>, same: Vector<Recorded>| {
        [0, 1, 2].map(|k| Recorded::select_lt(hand, Recorded::zero(), reversed[k], same[k]))
    };
    Facet {
        corners: [choose(b, a), choose(a, b), choose(d, c), choose(c, d)],
        middle: image.vector(facet.middle),
        normal: image.vector(facet.normal),
        curvature: image.symmetric(facet.curvature),
        free: {
            let reversed = edges_reversed(facet.free);
            [0, 1, 2, 3].map(|k| Recorded::select_lt(hand, Recorded::zero(), reversed[k], facet.free[k]))
        },
        ..*facet
    }
}

/// Velocity gradients of particles with facets at the velocities at which forces are evaluated, so that the forces work
/// as in the sums; and how far their facets reach.
pub(in crate::engine) fn follow<const D: usize>(
    model: &Model,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    let kernel = model.numerics.kernel;
    recording("follow_facets", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (evaluated, correction) = (bind.read(Group::Evaluated), bind.read(Group::Correction));
        let (gradient, deformation) = (bind.read(Group::Gradient), Deformations::of(bind, references));
        let (table, motion) = (Table::of(bind), bind.write(Group::FacetMotion));
        let own = evaluated.vector(0, i);
        let zero = [[Recorded::zero(); 3]; 3];
        let sum = over_list::<_, D>(bind, model, i, near, zero, |gradient: [[Recorded; 3]; 3], pair, j| {
            let other = pair.image.vector(evaluated.vector(0, j));
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { gradient, ..GradientSums::zero() };
            sums.add::<D, false>(&pair.x, &[0, 1, 2].map(|a| other[a] - own[a]), f);
            sums.gradient
        });
        let (correction, f) = (correction.tensor(0, i), deformation.since_reference(i));
        // What the sums of thin parts do not see across them is that of the middle of the step.
        let thin = || gradient.tensor(0, i);
        let thick = || multiply(&corrected(&sum, &correction), &inverse(&f));
        let l = Recorded::if_lt(Recorded::zero(), is_thin(&correction), thin, thick);
        motion.set_all(0, i, l.as_flattened());
        let sizes = deformation.whole(i).map(|row| row.map(Real::abs));
        let farthest =
            bind.scope.fold(table.first(i), table.end(i), Recorded::zero(), |_, farthest: Recorded, facet| {
                table.facet(facet).corners.into_iter().fold(farthest, |farthest, corner| {
                    let arm = apply(&sizes, corner.map(Real::abs));
                    farthest.max(dot(arm, arm))
                })
            });
        motion.set(REACH, i, Recorded::of(FARTHER) * farthest.sqrt());
    })
}

/// What the pairs of facets of a particle are made of.
#[derive(Clone, Copy)]
struct Points {
    table: Table,
    place: Reading,
    deformation: Deformations,
    motion: Reading,
    evaluated: Reading,
    body: Indices,
    laws: Reading,
    bodies: u32,
    itself: Option<SelfPairs>,
}

/// A neighbour whose facets may meet those of a particle.
struct Near<'a> {
    image: &'a Image,
    /// From it to the particle, m.
    x: Vector<Recorded>,
    j: Index,
}

/// A pair that presses, from the side of the particle.
struct Met<'a> {
    image: &'a Image,
    j: Index,
    /// Places of both facets in the table.
    facets: [Index; 2],
    own: Facet<Recorded>,
    /// Stretch of the own facet along its normal.
    stretch: Recorded,
    /// One if the own facet is the first of the pair, else minus one.
    sign: Recorded,
    press: FacetPress<Recorded>,
    law: FacetPairLaw<Recorded>,
    /// Share of the heat of friction that the particle receives.
    friction_share: Recorded,
    /// Velocity of the own side at the centre of pressure relative to the other, m/s.
    velocity: Vector<Recorded>,
}

impl Met<'_> {
    /// Of two numbers that belong to the facets of the pair that of the own one.
    fn own(&self, of_first: Recorded, of_second: Recorded) -> Recorded {
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
    fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Self {
        Self {
            table: Table::of(bind),
            place: bind.read(Group::Place),
            deformation: Deformations::of(bind, references),
            motion: bind.read(Group::FacetMotion),
            evaluated: bind.read(Group::Evaluated),
            body: bind.indices(Group::Body),
            laws: bind.read(Group::ContactLaws),
            bodies: model.bodies.len() as u32,
            itself: SelfPairs::of(bind, model, references),
        }
    }

    /// The law of two particles, and the share of the heat of friction that the first receives.
    fn law(self, i: Index, j: Index) -> (FacetPairLaw<Recorded>, Recorded) {
        let pair = self.body.at(i) * Index::of(self.bodies) + self.body.at(j);
        let number = |k: usize| law_number(self.laws, pair, k);
        let law = FacetPairLaw {
            stiffness: number(0),
            damping: number(1),
            friction: number(2),
            tangential_stiffness: number(3),
        };
        (law, number(5))
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
        let own = places(self.place, i);
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
                        let other = places(self.place, j);
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

    /// Folds a state over every pair of the particle's facets with others that presses.
    fn each<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        grid: &Grid,
        i: Index,
        start: S,
        visit: impl FnOnce(S, &Met<'_>) -> S,
    ) -> S {
        let table = self.table;
        let (f_i, v_i, l_i) = (self.deformation.whole(i), self.evaluated.vector(0, i), self.motion.tensor(0, i));
        let ([high_i, low_i], first_i) = (table.id(i), table.first(i));
        let (zero, one) = (Recorded::zero(), Recorded::one());
        // Facets of one particle have it in common.
        let _ = inverse(&f_i);
        let reach_i = self.motion.get(REACH, i);
        let reach = |j: Index| reach_i + self.motion.get(REACH, j);
        self.over_near::<S, D>(bind, model, grid, i, reach, start, |scope, state, near| {
            let Near { image, x, j } = *near;
            let has_images = Planes::of(model).images().count() > 1;
            let f_j = self.deformation.whole(j);
            let _ = inverse(&f_j);
            let (v_j, l_j) = (image.vector(self.evaluated.vector(0, j)), image.tensor(&self.motion.tensor(0, j)));
            let (law, friction_share) = self.law(i, j);
            // The same order from both sides.
            let [high_j, low_j] = table.id(j);
            let below = |a: Recorded, b: Recorded, otherwise: Recorded| {
                let not_above = Recorded::select_lt(b, a, -one, otherwise);
                Recorded::select_lt(a, b, one, not_above)
            };
            let first_j = table.first(j);
            scope.fold(first_i, table.end(i), state, |scope, state, facet_i| {
                let (own, stretch) = carried(table, facet_i, &f_i, None);
                scope.fold(first_j, table.end(j), state, |_, state, facet_j| {
                    let (other, _) = carried(table, facet_j, &f_j, has_images.then_some(image));
                    let other = Facet { owner: x.map(|c| -c), ..other };
                    let (part_i, part_j) = (facet_i.number() - first_i.number(), facet_j.number() - first_j.number());
                    let by_part = Recorded::select_lt(part_j, part_i, -one, one);
                    let sign = below(high_i, high_j, below(low_i, low_j, by_part));
                    let a = chosen_facet(sign, &own, other);
                    let b = chosen_facet(sign, &other, own);
                    let press = press_of_pair(&a, &b, Partner::Facet, &law).within(model.dimensions.into());
                    let visit = || {
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
                })
            })
        })
    }
}

impl Points {
    /// Power of the springs of a particle's facets that have lost their last partner, W: what they held is its heat.
    fn released(self, bind: &mut Binder<'_>, springs: Springs, i: Index) -> Recorded {
        let (table, zero) = (self.table, Recorded::zero());
        bind.scope.fold(table.first(i), table.end(i), zero, |_, sum: Recorded, facet| {
            let (slip, power) = springs.of_face(i, table.face(facet));
            let of_face = Recorded::select_lt(zero, slip.stiffness, zero, power);
            sum + Recorded::select_lt(table.number(facet, PART), Recorded::of(0.5), of_face, zero)
        })
    }

    /// The body of the nearest particle that a particle may have had contact with, its own if there is none: nothing says
    /// any more whom a facet that is free has let go.
    fn nearest<const D: usize>(self, bind: &mut Binder<'_>, model: &Model, grid: &Grid, i: Index) -> Index {
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

/// Tangential springs of facets.
#[derive(Clone, Copy)]
struct Springs {
    slips: Reading,
}

impl Springs {
    /// The spring of a face, and what it rubs.
    fn of_face(self, i: Index, face: Index) -> (FacetSlip<Recorded>, Recorded) {
        let number = |field: usize| self.slips.get_in_group((face, SLIP), field, i);
        (FacetSlip { slip: [number(0), number(1)], stiffness: number(2) }, number(RUBBED))
    }

    /// The slip of the face of a facet in space, m.
    fn vector(
        self,
        points: Points,
        (slip, i): (&FacetSlip<Recorded>, Index),
        facet: Index,
        image: Option<&Image>,
    ) -> Vector<Recorded> {
        let f = points.deformation.whole(i);
        let lead = carried(points.table, points.table.lead(facet), &f, None).0;
        let vector = slip.vector(&lead);
        image.map_or(vector, |image| image.vector(vector))
    }
}

/// First pass, with friction: slips of the facets of a particle after the step.
pub(in crate::engine) fn slip<const D: usize>(
    model: &Model,
    grid: &Grid,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("slip_facets", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let points = Points::of(bind, model, references);
        let (slips, drives) = (bind.write(Group::Slips), bind.write(Group::Drives));
        let dt = bind.read(Group::Step).get(0, Index::of(DT));
        let table = points.table;
        let (zero, half) = (Recorded::zero(), Recorded::of(0.5));
        for field in 0..DRIVES {
            drives.set(field, i, zero);
        }
        points.each::<_, D>(bind, model, grid, i, NOTHING, |nothing, met| {
            let face = (table.face(met.facets[0]), DRIVE);
            let mut drive = SlipDrive::none();
            drive.add(&FrictionShare::of(&met.press, &met.law, met.velocity, false));
            let mut field = 0;
            drive.each(&mut |part| {
                drives.add_in_group(face, field, i, *part);
                field += 1;
            });
            nothing
        });
        let f = points.deformation.whole(i);
        bind.scope.fold(table.first(i), table.end(i), NOTHING, |_, nothing, facet| {
            let update = || {
                let face = table.face(facet);
                let at = |field: usize| slips.get_in_group((face, SLIP), field, i);
                let before = FacetSlip { slip: [at(0), at(1)], stiffness: at(2) };
                let mut drive = SlipDrive::none();
                let mut field = 0;
                drive.each(&mut |part| {
                    *part = drives.get_in_group((face, DRIVE), field, i);
                    field += 1;
                });
                let (after, heat) = slip_after(&before, &carried(table, facet, &f, None).0, &drive, dt);
                let power = Recorded::if_lt(zero, dt, || heat / dt, || zero);
                let rubbed = Recorded::if_lt(zero, after.stiffness, || power / after.stiffness, || power);
                for (field, number) in [after.slip[0], after.slip[1], after.stiffness, rubbed].into_iter().enumerate() {
                    slips.set_in_group((face, SLIP), field, i, number);
                }
                NOTHING
            };
            Recorded::if_lt(table.number(facet, PART), half, update, || nothing)
        });
    })
}

/// Sums of a particle over its pairs.
#[derive(Clone, Copy)]
struct Pressed {
    /// Force, N, heat of the particle, W, and friction's part.
    sums: [Recorded; 5],
    /// Moment of the forces, N m.
    moment: Tensor<Recorded>,
    stiffness: FacetStiffness<Recorded>,
}

impl Numbers<Recorded> for Pressed {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.sums.each(visit);
        self.moment.each(visit);
        self.stiffness.each(visit);
    }
}

/// Second pass: forces, with the stress of their moments, and their heat.
///
/// If a section is given, the forces of the pairs that cross it are added to the force through it instead.
pub(in crate::engine) fn press<const D: usize>(
    model: &Model,
    grid: &Grid,
    through: Option<Through<'_>>,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording(&Through::name(through, "press_facets"), count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let points = Points::of(bind, model, references);
        let springs = model.contact.has_friction().then(|| Springs { slips: bind.read(Group::Slips) });
        let (zero, half) = (Recorded::zero(), Recorded::of(0.5));
        let has_images = Planes::of(model).images().count() > 1;
        // The pair with the forces of damping and friction; the heat of damping, the work of friction, W, what the own
        // spring holds of it, J.
        let pushed = |met: &Met<'_>| {
            let mut press = met.press;
            let (mut at_centre, damped) = press.damping(&met.law, met.velocity.map(|c| met.sign * c));
            let (mut rubbed, mut held) = (zero, zero);
            if let Some(springs) = springs {
                let [facet_i, facet_j] = met.facets;
                let (own, own_rubbed) = springs.of_face(i, points.table.face(facet_i));
                let (other, other_rubbed) = springs.of_face(met.j, points.table.face(facet_j));
                let own_vector = springs.vector(points, (&own, i), facet_i, None);
                let image = has_images.then_some(met.image);
                let other_vector = springs.vector(points, (&other, met.j), facet_j, image);
                let signed = |v: Vector<Recorded>| v.map(|c| met.sign * c);
                let pull = friction_force(&press, &met.law, signed(own_vector), signed(other_vector), false);
                at_centre = [0, 1, 2].map(|k| at_centre[k] + pull[k]);
                let share = FrictionShare::of(&press, &met.law, met.velocity, false).stiffness;
                rubbed = share * (own_rubbed + other_rubbed);
                // Of what the own spring holds, the part of this pair.
                held = Recorded::if_lt(zero, share, || share / own.stiffness * own.energy(), || zero);
            }
            press.add_at_centre(at_centre);
            (press, damped, rubbed, held)
        };
        if let Some(through) = through {
            let place = bind.read(Group::Place);
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = points.each::<_, D>(bind, model, grid, i, [zero; 3], |sum: Vector<Recorded>, met| {
                let force = || pushed(met).0.force.map(|c| met.sign * c);
                crossing.add(sum, met.image, met.j, force, |force| *force)
            });
            crossing.set(sum, true);
            return;
        }
        let step = bind.read(Group::Step);
        let (constants, reference) = (bind.read(Group::Constants), bind.read(Group::Reference));
        let (meetings, contact) = (bind.write(Group::Meetings), bind.write(Group::Contact));
        let (external, face_stress) = (bind.write(Group::External), bind.write(Group::FaceStress));
        let mass = constants.get(0, i);
        let (v, l) = (points.evaluated.vector(0, i), points.motion.tensor(0, i));
        each_body(model.bodies.len(), |body| {
            for field in (0..TAKEN_UP + 3).chain([ENERGY]) {
                meetings.set_in_group((body, MEETING), field, i, zero);
            }
        });
        let start = Pressed { sums: [zero; 5], moment: [[zero; 3]; 3], stiffness: FacetStiffness::none() };
        let all = points.each::<_, D>(bind, model, grid, i, start, |mut state: Pressed, met| {
            let torn = || moment_of_torn(&met.own, met.stretch, met.press.force.map(|c| met.sign * c));
            let torn = Recorded::if_lt(Recorded::one(), met.stretch, torn, || [[zero; 3]; 3]);
            let (press, damped, rubbed, held) = pushed(met);
            let force = press.force.map(|c| met.sign * c);
            let mut power = dot(force, v);
            for k in 0..3 {
                state.sums[k] += force[k];
                for c in 0..3 {
                    let moment = met.own(press.moment_a[k][c], press.moment_b[k][c]) + torn[k][c];
                    state.moment[k][c] += moment;
                    power = moment.mul_add(l[k][c], power);
                }
            }
            let friction = met.friction_share * rubbed;
            // The other half comes from the row of the other particle.
            let damped = half * damped;
            state.sums[3] += damped + friction;
            state.sums[4] += friction;
            state.stiffness.add(&met.press, &met.law, mass);
            let body = (points.body.at(met.j), MEETING);
            let booked = [force[0], force[1], force[2], -(power + friction + damped), friction, damped];
            for (field, part) in booked.into_iter().enumerate() {
                meetings.add_in_group(body, field, i, part);
            }
            meetings.add_in_group(body, ENERGY, i, half * met.press.energy + held);
            state
        });
        let [x, y, z, mut heat, mut friction] = all.sums;
        if let Some(springs) = springs {
            let released = points.released(bind, springs, i);
            heat += released;
            friction += released;
            let book = || {
                let body = (points.nearest::<D>(bind, model, grid, i), MEETING);
                meetings.add_in_group(body, TAKEN_UP, i, -released);
                meetings.add_in_group(body, TAKEN_UP + 1, i, released);
                NOTHING
            };
            Recorded::if_lt(zero, released.abs(), book, || NOTHING);
        }
        for k in 0..3 {
            heat += dot(all.moment[k], l[k]);
        }
        external.set(4, i, external.get(4, i) + friction / mass);
        let f = points.deformation.since_reference(i);
        for (k, moment) in stress_of_moment(&all.moment, &f).into_iter().flatten().enumerate() {
            face_stress.set(k, i, face_stress.get(k, i) - moment / reference.get(6, i));
        }
        contact.set_all(0, i, &[x, y, z, heat, zero, all.stiffness.limit()]);
        debug_assert_eq!(LIMIT, 5);
        // Bodies may start pressed: what they hold then has not been taken up.
        let begin = || {
            each_body(model.bodies.len(), |body| {
                let held = meetings.get_in_group((body, MEETING), ENERGY, i);
                meetings.set_in_group((body, MEETING), super::contact::WORKS[0].0, i, held);
            });
            NOTHING
        };
        Recorded::if_lt(step.get(0, Index::of(NUMBER)), half, begin, || NOTHING);
    })
}
