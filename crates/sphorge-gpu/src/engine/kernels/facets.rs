//! Contact of bodies of the total Lagrangian form at the facets of the cells of their particles, and of a body with
//! itself, as in the engine for processors.
//!
//! Facets are found on the processor in the initial configuration ([`crate::engine::facets`]). A kernel carries those of
//! a particle and of its neighbours to the present where it needs them: that is short beside the law of a pair. The law
//! is long, so a kernel has its text once, in a loop over facets, neighbours, cells and images.

use super::contact::{SelfPairs, each_body};
use super::grid::Grid;
use super::images::{Image, Planes};
use super::neighbors::{ON_PLANE, over_list, strays};
use super::reference::{Deformations, References};
use super::section::{Crossing, Through};
use crate::engine::columns::groups::{self, FACES};
use crate::engine::columns::{
    Binder, CompensatedVector, Group, Member, NOTHING, Read, ReadColumns, ReadRecords, ReadShared, Recording, Records,
    ValuedMember, VectorColumns, WriteColumns, recording,
};
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
use sphorge_physics::{Elementary, Numbers, Real, Tensor, Vector};

/// Whole numbers of a particle in [`Group::Facets`]: the first of its facets, the one behind its last, and its `id`.
pub(in crate::engine) const FACETS: usize = 3;

/// How much farther than the corners of facets owners are looked for: surfaces are curved.
const FARTHER: f64 = 1.1;

/// Numbers of the law of two bodies.
pub(super) fn law_numbers(laws: &FacetLaws, (a, b): (usize, usize), friction_share: f64) -> [f64; 6] {
    let FacetPairLaw { stiffness, damping, friction, tangential_stiffness } = *laws.of(a, b);
    [stiffness, damping, friction, tangential_stiffness, 0.0, friction_share]
}

/// Facets of the initial configuration, and who has them.
#[derive(Clone, Copy)]
struct Table {
    columns: groups::FacetTable<Records>,
    of_particles: Indices,
    stride: Index,
}

impl Table {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            columns: groups::FacetTable::records(bind),
            of_particles: bind.indices(Group::Facets),
            stride: bind.stride(),
        }
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

    fn facet(self, facet: Index) -> ReferenceFacet<Recorded> {
        ReferenceFacet {
            corners: self.columns.corners.get(facet),
            middle: self.columns.middle.get(facet),
            normal: self.columns.normal.get(facet),
            curvature: self.columns.curvature.get(facet),
            depth: self.columns.depth.get(facet),
            free: self.columns.free.get(facet),
        }
    }

    fn face(self, facet: Index) -> Index {
        Index::floor(self.columns.face.get(facet))
    }

    /// The first part of the same face.
    fn lead(self, facet: Index) -> Index {
        facet + Index::floor(-self.columns.part.get(facet))
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
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (evaluated, correction) =
            (groups::Evaluated::read(bind).velocity, groups::Correction::read(bind).correction);
        let (gradient, deformation) =
            (groups::Gradient::read(bind).velocity_gradient, Deformations::of(bind, references));
        let (table, motion) = (Table::of(bind), groups::FacetMotion::write(bind));
        let own = evaluated.get(i);
        let zero = [[Recorded::zero(); 3]; 3];
        let sum = over_list::<_, D>(bind, model, i, near, zero, |gradient: [[Recorded; 3]; 3], pair, j| {
            let other = pair.image.vector(evaluated.get(j));
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.volume.high().get(j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { gradient, ..GradientSums::zero() };
            sums.add::<D, false>(&pair.x, &[0, 1, 2].map(|a| other[a] - own[a]), f);
            sums.gradient
        });
        let (correction, f) = (correction.get(i), deformation.since_reference(i));
        // What the sums of thin parts do not see across them is that of the middle of the step.
        let thin = || gradient.get(i);
        let thick = || multiply(&corrected(&sum, &correction), &inverse(&f));
        let l = Recorded::if_lt(Recorded::zero(), is_thin(&correction), thin, thick);
        motion.velocity_gradient.set(i, &l);
        let sizes = deformation.whole(i).map(|row| row.map(Real::abs));
        let farthest =
            bind.scope.fold(table.first(i), table.end(i), Recorded::zero(), |_, farthest: Recorded, facet| {
                table.facet(facet).corners.into_iter().fold(farthest, |farthest, corner| {
                    let arm = apply(&sizes, corner.map(Real::abs));
                    farthest.max(dot(arm, arm))
                })
            });
        motion.reach.set(i, Recorded::of(FARTHER) * farthest.sqrt());
    })
}

/// What the pairs of facets of a particle are made of.
#[derive(Clone, Copy)]
struct Points {
    table: Table,
    place: CompensatedVector<Read>,
    deformation: Deformations,
    motion: groups::FacetMotion<Read>,
    evaluated: VectorColumns<Read>,
    body: Indices,
    laws: groups::FacetLaws<Records>,
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
            place: groups::Place::read(bind).position,
            deformation: Deformations::of(bind, references),
            motion: groups::FacetMotion::read(bind),
            evaluated: groups::Evaluated::read(bind).velocity,
            body: bind.indices(Group::Body),
            laws: groups::FacetLaws::records(bind),
            bodies: model.bodies.len() as u32,
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
        let (f_i, v_i, l_i) = (self.deformation.whole(i), self.evaluated.get(i), self.motion.velocity_gradient.get(i));
        let ([high_i, low_i], first_i) = (table.id(i), table.first(i));
        let (zero, one) = (Recorded::zero(), Recorded::one());
        // Facets of one particle have it in common.
        let _ = inverse(&f_i);
        let reach_i = self.motion.reach.get(i);
        let reach = |j: Index| reach_i + self.motion.reach.get(j);
        self.over_near::<S, D>(bind, model, grid, i, reach, start, |scope, state, near| {
            let Near { image, x, j } = *near;
            let has_images = Planes::of(model).images().count() > 1;
            let f_j = self.deformation.whole(j);
            let _ = inverse(&f_j);
            let (v_j, l_j) = (image.vector(self.evaluated.get(j)), image.tensor(&self.motion.velocity_gradient.get(j)));
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
            sum + Recorded::select_lt(table.columns.part.get(facet), Recorded::of(0.5), of_face, zero)
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
    slips: groups::Slips<Read>,
}

impl Springs {
    /// The spring of a face, and what it rubs.
    fn of_face(self, i: Index, face: Index) -> (FacetSlip<Recorded>, Recorded) {
        let of_face = self.slips.of_value(face);
        let slip = FacetSlip { slip: of_face.slip.get(i), stiffness: of_face.stiffness.get(i) };
        (slip, of_face.rubbed.get(i))
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
        let (slips, drives) = (groups::Slips::write(bind), groups::Drives::write(bind));
        let dt = groups::Step::shared(bind).dt.value();
        let table = points.table;
        let (zero, half) = (Recorded::zero(), Recorded::of(0.5));
        for face in 0..FACES {
            drives.of(face).parts.set(i, [zero; 5]);
        }
        points.each::<_, D>(bind, model, grid, i, NOTHING, |nothing, met| {
            let drives = drives.of_value(table.face(met.facets[0]));
            let mut drive = SlipDrive::none();
            drive.add(&FrictionShare::of(&met.press, &met.law, met.velocity, false));
            let mut field = 0;
            drive.each(&mut |part| {
                drives.parts.number(field).add(i, *part);
                field += 1;
            });
            nothing
        });
        let f = points.deformation.whole(i);
        bind.scope.fold(table.first(i), table.end(i), NOTHING, |_, nothing, facet| {
            let update = || {
                let face = table.face(facet);
                let (slips, drives) = (slips.of_value(face), drives.of_value(face));
                let before = FacetSlip { slip: slips.slip.get(i), stiffness: slips.stiffness.get(i) };
                let mut drive = SlipDrive::none();
                let mut field = 0;
                drive.each(&mut |part| {
                    *part = drives.parts.number(field).get(i);
                    field += 1;
                });
                let (after, heat) = slip_after(&before, &carried(table, facet, &f, None).0, &drive, dt);
                let power = Recorded::if_lt(zero, dt, || heat / dt, || zero);
                let rubbed = Recorded::if_lt(zero, after.stiffness, || power / after.stiffness, || power);
                slips.slip.set(i, after.slip);
                slips.stiffness.set(i, after.stiffness);
                slips.rubbed.set(i, rubbed);
                NOTHING
            };
            Recorded::if_lt(table.columns.part.get(facet), half, update, || nothing)
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
        let springs = model.contact.has_friction().then(|| Springs { slips: groups::Slips::read(bind) });
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
            let place = groups::Place::read(bind).position;
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = points.each::<_, D>(bind, model, grid, i, [zero; 3], |sum: Vector<Recorded>, met| {
                let force = || pushed(met).0.force.map(|c| met.sign * c);
                crossing.add(sum, met.image, met.j, force, |force| *force)
            });
            crossing.set(sum, true);
            return;
        }
        let step = groups::Step::shared(bind);
        let (constants, reference) = (groups::Constants::read(bind), groups::Reference::read(bind));
        let (meetings, contact) = (groups::Meetings::write(bind), groups::Contact::write(bind));
        let (external, face_stress) = (groups::External::write(bind), groups::FaceStress::write(bind).stress);
        let mass = constants.mass.get(i);
        let (v, l) = (points.evaluated.get(i), points.motion.velocity_gradient.get(i));
        each_body(model.bodies.len(), |body| {
            let meeting = meetings.of_value(body);
            meeting.force.set(i, [zero; 3]);
            meeting.powers.set(i, [zero; 3]);
            meeting.energy.set(i, zero);
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
            let meeting = meetings.of_value(points.body.at(met.j));
            let powers = [-(power + friction + damped), friction, damped];
            meeting.force.add(i, force);
            meeting.powers.add(i, powers);
            meeting.energy.add(i, half * met.press.energy + held);
            state
        });
        let [x, y, z, mut heat, mut friction] = all.sums;
        if let Some(springs) = springs {
            let released = points.released(bind, springs, i);
            heat += released;
            friction += released;
            let book = || {
                let [stored, friction, _] = {
                    let meeting = meetings.of_value(points.nearest::<D>(bind, model, grid, i));
                    [0, 1, 2].map(|k| meeting.powers.number(k))
                };
                stored.add(i, -released);
                friction.add(i, released);
                NOTHING
            };
            Recorded::if_lt(zero, released.abs(), book, || NOTHING);
        }
        for k in 0..3 {
            heat += dot(all.moment[k], l[k]);
        }
        external.friction_heat.set(i, external.friction_heat.get(i) + friction / mass);
        let f = points.deformation.since_reference(i);
        for (k, moment) in stress_of_moment(&all.moment, &f).into_iter().flatten().enumerate() {
            let component = face_stress.component(k);
            component.set(i, component.get(i) - moment / reference.volume.high().get(i));
        }
        let limit = all.stiffness.limit();
        contact.force.set(i, [x, y, z]);
        contact.heat.set(i, heat);
        contact.approach.set(i, zero);
        contact.limit.set(i, limit);
        // Bodies may start pressed: what they hold then has not been taken up.
        let begin = || {
            each_body(model.bodies.len(), |body| {
                let meeting = meetings.of_value(body);
                meeting.works.number(0).high().set(i, meeting.energy.get(i));
            });
            NOTHING
        };
        Recorded::if_lt(step.number.value(), half, begin, || NOTHING);
    })
}
