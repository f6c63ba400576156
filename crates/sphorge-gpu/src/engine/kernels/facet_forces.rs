//! Forces of the contact at facets, and the slips of its friction.

use super::contact::each_body;
use super::facet_pairs::{Met, Points};
use super::facets::Table;
use super::grid::Grid;
use super::images::{Image, Planes};
use super::reference::References;
use super::section::{Crossing, Through};
use super::shared_edges::shifts;
use crate::engine::columns::groups::{self, FACES};
use crate::engine::columns::{
    Binder, Group, Member, NOTHING, Read, ReadColumns, ReadShared, Recording, Shared, TensorColumns, ValuedMember,
    Write, WriteColumns, recording,
};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::facet::{
    EdgeForces, FacetPress, FacetSlip, FacetStiffness, FrictionShare, SlipDrive, friction_force, moment_of_torn,
    slip_after, stress_of_moment,
};
use sphorge_physics::tensor::{dot, plus};
use sphorge_physics::{Elementary, Numbers, Real, Tensor, Vector};

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
        let lead = points.carried(i, points.table.lead(facet), None).0;
        let vector = slip.vector(&lead);
        image.map_or(vector, |image| image.vector(vector))
    }

    /// Power of the springs of a particle's facets that have lost their last partner, W: what they held is its heat.
    fn released(self, bind: &mut Binder<'_>, table: Table, i: Index) -> Recorded {
        let zero = Recorded::zero();
        bind.scope.fold(table.first(i), table.end(i), zero, |_, sum: Recorded, facet| {
            let (slip, power) = self.of_face(i, table.face(facet));
            let of_face = Recorded::select_lt(zero, slip.stiffness, zero, power);
            sum + Recorded::select_lt(table.columns.part.get(facet), Recorded::of(0.5), of_face, zero)
        })
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
        let drive = |nothing: [Recorded; 0], met: &Met<'_>| {
            let drives = drives.of_value(table.face(met.facets[0]));
            let mut drive = SlipDrive::none();
            drive.add(&FrictionShare::of(&met.press, &met.law, met.velocity, false));
            let mut field = 0;
            drive.each(&mut |part| {
                drives.parts.number(field).add(i, *part);
                field += 1;
            });
            nothing
        };
        points.each::<_, D>(bind, model, grid, i, NOTHING, drive, |nothing, _, _| nothing);
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
                let (after, heat) = slip_after(&before, &points.carried(i, facet, None).0, &drive, dt);
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
struct ContactSums {
    /// Force, N, heat of the particle, W, and friction's part.
    sums: [Recorded; 5],
    /// Moment of the forces, N m.
    moment: Tensor<Recorded>,
    stiffness: FacetStiffness<Recorded>,
    /// What the pairs of one of its facets with one particle do to its edges.
    edges: EdgeForces<Recorded>,
}

impl ContactSums {
    fn none() -> Self {
        let zero = Recorded::zero();
        let moment = [[zero; 3]; 3];
        Self { sums: [zero; 5], moment, stiffness: FacetStiffness::none(), edges: EdgeForces::none() }
    }
}

impl Numbers<Recorded> for ContactSums {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.sums.each(visit);
        self.moment.each(visit);
        self.stiffness.each(visit);
        self.edges.each(visit);
    }
}

/// A pair with its forces of damping and friction.
struct PairForces {
    press: FacetPress<Recorded>,
    /// Heat of damping and work of friction, W.
    damped: Recorded,
    rubbed: Recorded,
    /// What the own spring holds of the pair, J.
    held: Recorded,
}

/// What the forces of a particle are made of.
struct FacetForces<'a> {
    model: &'a Model,
    points: Points,
    springs: Option<Springs>,
    has_images: bool,
    i: Index,
    zero: Recorded,
    half: Recorded,
}

/// Where they are stored.
struct Stored {
    step: groups::Step<Shared>,
    constants: groups::Constants<Read>,
    reference: groups::Reference<Read>,
    meetings: groups::Meetings<Write>,
    contact: groups::Contact<Write>,
    external: groups::External<Write>,
    face_stress: TensorColumns<Write>,
}

impl Stored {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            step: groups::Step::shared(bind),
            constants: groups::Constants::read(bind),
            reference: groups::Reference::read(bind),
            meetings: groups::Meetings::write(bind),
            contact: groups::Contact::write(bind),
            external: groups::External::write(bind),
            face_stress: groups::FaceStress::write(bind).stress,
        }
    }
}

impl<'a> FacetForces<'a> {
    fn of(bind: &mut Binder<'_>, model: &'a Model, references: References, i: Index) -> Self {
        let points = Points::of(bind, model, references);
        let springs = model.contact.has_friction().then(|| Springs { slips: groups::Slips::read(bind) });
        let (zero, half) = (Recorded::zero(), Recorded::of(0.5));
        let has_images = Planes::of(model).images().count() > 1;
        Self { model, points, springs, has_images, i, zero, half }
    }

    fn pushed(&self, met: &Met<'_>) -> PairForces {
        let (points, i, zero) = (self.points, self.i, self.zero);
        let mut press = met.press;
        let (mut at_centre, damped) = press.damping(&met.law, met.velocity.map(|c| met.sign * c));
        let (mut rubbed, mut held) = (zero, zero);
        if let Some(springs) = self.springs {
            let [facet_i, facet_j] = met.facets;
            let (own, own_rubbed) = springs.of_face(i, points.table.face(facet_i));
            let (other, other_rubbed) = springs.of_face(met.j, points.table.face(facet_j));
            let own_vector = springs.vector(points, (&own, i), facet_i, None);
            let image = self.has_images.then_some(met.image);
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
        PairForces { press, damped, rubbed, held }
    }

    /// Adds a pair to the sums of the particle and to those of the contact with the other body.
    fn add(
        &self,
        mut state: ContactSums,
        met: &Met<'_>,
        (v, l): (Vector<Recorded>, &Tensor<Recorded>),
        (mass, meetings): (Recorded, groups::Meetings<Write>),
    ) -> ContactSums {
        let (i, zero) = (self.i, self.zero);
        let torn = || moment_of_torn(&met.own, met.stretch, met.press.force.map(|c| met.sign * c));
        let torn = Recorded::if_lt(Recorded::one(), met.stretch, torn, || [[zero; 3]; 3]);
        let PairForces { press, damped, rubbed, held } = self.pushed(met);
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
        let (of_first, of_second) = (press.edges_a, press.edges_b);
        state.edges.add(&EdgeForces {
            force: [0, 1, 2].map(|a| met.own(of_first.force[a], of_second.force[a])),
            moment: [0, 1, 2].map(|a| [0, 1, 2].map(|b| met.own(of_first.moment[a][b], of_second.moment[a][b]))),
            by_misfit: met.own(of_first.by_misfit, of_second.by_misfit),
        });
        let friction = met.friction_share * rubbed;
        // The other half comes from the row of the other particle.
        let damped = self.half * damped;
        state.sums[3] += damped + friction;
        state.sums[4] += friction;
        state.stiffness.add(&met.press, &met.law, mass);
        let meeting = meetings.of_value(self.points.body.at(met.j));
        let powers = [-(power + friction + damped), friction, damped];
        meeting.force.add(i, force);
        meeting.powers.add(i, powers);
        meeting.energy.add(i, self.half * met.press.energy + held);
        state
    }

    /// Follows what a facet and those of another particle did to its edges.
    fn follow_edges(
        &self,
        mut state: ContactSums,
        (facet, j): (Index, Index),
        l: &Tensor<Recorded>,
        (mass, meetings, pulls): (Recorded, groups::Meetings<Write>, groups::EdgePulls<Write>),
    ) -> ContactSums {
        let (i, zero) = (self.i, self.zero);
        let edges = std::mem::replace(&mut state.edges, EdgeForces::none());
        let follow = || {
            let mut state = state;
            let (f, now) = (self.points.deformation.whole(i), self.points.carried(i, facet, None).0);
            let cell = edges.on_cell(&now, &self.points.table.facet(facet), &f, &shifts(self.points.edges, i));
            let mut power = (0..3).fold(zero, |power, k| power + dot(cell.moment[k], l[k]));
            for side in 0..FACES {
                pulls.of(side).pull.add(i, *cell.sides.on(side));
                power += dot(*cell.sides.on(side), self.points.edges.of(side).rate.get(i));
            }
            state.moment = plus(&state.moment, Recorded::one(), &cell.moment);
            state.stiffness.add_edges(&cell, mass);
            meetings.of_value(self.points.body.at(j)).powers.number(0).add(i, -power);
            state
        };
        // Without a pair that presses there is nothing.
        Recorded::if_lt(zero, edges.by_misfit, follow, || state)
    }

    /// Power that springs without partners release, W, booked to the nearest body; nothing without friction.
    fn released<const D: usize>(
        &self,
        bind: &mut Binder<'_>,
        grid: &Grid,
        meetings: groups::Meetings<Write>,
    ) -> Option<Recorded> {
        let (points, i) = (self.points, self.i);
        let released = self.springs?.released(bind, points.table, i);
        let book = || {
            let meeting = meetings.of_value(points.nearest::<D>(bind, self.model, grid, i));
            meeting.powers.number(0).add(i, -released);
            meeting.powers.number(1).add(i, released);
            NOTHING
        };
        Recorded::if_lt(self.zero, released.abs(), book, || NOTHING);
        Some(released)
    }
}

/// Second pass: forces, with the stress of their moments, and their heat.
///
/// If a section is given, the forces of the pairs that cross it are added to the force through it instead.
pub(in crate::engine) fn forces<const D: usize>(
    model: &Model,
    grid: &Grid,
    through: Option<Through<'_>>,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording(&Through::name(through, "press_facets"), count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let forces = FacetForces::of(bind, model, references, i);
        let FacetForces { points, zero, half, .. } = forces;
        if let Some(through) = through {
            let place = groups::Place::read(bind).position;
            let crossing = Crossing::of(bind, model, through, i, place);
            let add = |sum: Vector<Recorded>, met: &Met<'_>| {
                let force = || forces.pushed(met).press.force.map(|c| met.sign * c);
                crossing.add(sum, met.image, met.j, force, |force| *force)
            };
            let sum = points.each::<_, D>(bind, model, grid, i, [zero; 3], add, |sum, _, _| sum);
            crossing.set(sum, true);
            return;
        }
        let Stored { step, constants, reference, meetings, contact, external, face_stress } = Stored::of(bind);
        let mass = || constants.mass.get(i);
        let (v, l) = (|| points.evaluated.get(i), || points.motion.velocity_gradient.get(i));
        each_body(model.bodies.len(), |body| {
            let meeting = meetings.of_value(body);
            meeting.force.set(i, [zero; 3]);
            meeting.powers.set(i, [zero; 3]);
            meeting.energy.set(i, zero);
        });
        let pulls = groups::EdgePulls::write(bind);
        for side in 0..FACES {
            pulls.of(side).pull.set(i, [zero; 3]);
        }
        let add = |state: ContactSums, met: &Met<'_>| forces.add(state, met, (v(), &l()), (mass(), meetings));
        let follow = |state, facet, j| forces.follow_edges(state, (facet, j), &l(), (mass(), meetings, pulls));
        let all = points.each::<_, D>(bind, model, grid, i, ContactSums::none(), add, follow);
        let [x, y, z, mut heat, mut friction] = all.sums;
        if let Some(released) = forces.released::<D>(bind, grid, meetings) {
            heat += released;
            friction += released;
        }
        for k in 0..3 {
            heat += dot(all.moment[k], l()[k]);
        }
        external.friction_heat.set(i, external.friction_heat.get(i) + friction / mass());
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
