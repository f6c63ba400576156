//! Contact between bodies by overlap, and of a body with itself where surface particles meet that were not neighbours. In
//! the total Lagrangian form contact acts at the faces of particles. Contact at facets: [`super::facets`].

use super::facets;
use super::grid::Grid;
use super::images::Image;
use super::neighbors::{Pair, apart, at_start, different, over_cells};
use super::reference::{Deformations, References, Separated};
use super::section::{Crossing, Through};
use crate::engine::columns::{
    Binder, Compensated, CompensatedVector, Group, Member, NOTHING, Read, ReadColumns, ReadRecords, ReadShared,
    Recording, Records, ValuedMember, VectorColumns, WriteColumns, added, groups, recording,
};
use crate::record::{Index, Indices, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_engine::particles::HistoryVariables;
use sphorge_engine::{ContactLaws, FacetLaws};
use sphorge_physics::contact::{
    ContactForce, ContactKernel, ContactLaw, ContactPair, ContactStiffness, Overlap, contact_force, stopping,
};
use sphorge_physics::surface::{FaceShift, different_sides, sides_of_a_sheet, surface_normal};
use sphorge_physics::tensor::dot;
use sphorge_physics::{Elementary, Numbers, Real, Vector};

/// Calls a function for every body with its index.
pub(super) fn each_body(bodies: usize, act: impl Fn(Index)) {
    Recorded::iterate([Recorded::zero()], |[body]| {
        act(Index::floor(body));
        let next = body + Recorded::one();
        ([next], Recorded::of(bodies as f64) - next)
    });
}

/// The laws of all pairs of bodies, if there is a contact.
pub(in crate::engine) fn laws(model: &Model) -> Option<Vec<f32>> {
    let strength = model.contact.strength()?;
    let (laws, count) = (ContactLaws::new(model, strength), model.bodies.len());
    let at_facets = model.has_facets().then(|| FacetLaws::new(model, strength));
    let numbers = |a: usize, b: usize| {
        if let Some(at_facets) = &at_facets {
            return facets::law_numbers(at_facets, (a, b), laws.friction_share(a, b));
        }
        let ContactLaw { inverse_sums, modulus, damping, friction } = *laws.law(a, b);
        [inverse_sums.0, inverse_sums.1, modulus, damping, friction, laws.friction_share(a, b)]
    };
    let pairs = (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
    model.has_contact().then(|| pairs.flat_map(|(a, b)| numbers(a, b)).map(|number| number as f32).collect())
}

/// Contact positions of particles near faces.
pub(in crate::engine) fn contact_positions(references: References, count: usize) -> Result<Recording, KernelFault> {
    recording("stand", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (place, outward, standing) =
            (groups::Place::read(bind).position, groups::Outward::read(bind), groups::Standing::write(bind));
        let (deformation, gradient) =
            (Deformations::of(bind, references), groups::Gradient::read(bind).velocity_gradient);
        let (f, zero) = (deformation.since_reference(i), Recorded::zero());
        let (normal, arm) = (outward.normal.get(i), outward.arm.get(i));
        let near = || {
            let face = FaceShift::of(&deformation.whole(i), arm);
            let ([x, y, z], [u, v, w]) = (face.shift(), face.rate(&gradient.get(i)));
            [x, y, z, u, v, w]
        };
        let face = Recorded::if_lt(zero, dot(arm, arm), near, || [zero; 6]);
        for a in 0..3 {
            let z = added(place.axis(a).get(i), face[a]);
            standing.position.axis(a).set(i, z);
        }
        standing.velocity.set(i, [face[3], face[4], face[5]]);
        let normal = Recorded::if_lt(zero, dot(normal, normal), || surface_normal(&f, normal), || [zero; 3]);
        standing.normal.set(i, normal);
    })
}

/// Data that determine contact pairs.
#[derive(Clone, Copy)]
struct Bodies {
    /// Contact positions.
    place: CompensatedVector<Read>,
    constants: groups::Constants<Read>,
    body: Indices,
    laws: groups::ContactLaws<Records>,
    count: u32,
    surfaces: Option<Surfaces>,
    itself: Option<SelfContact>,
}

/// Surfaces of the total Lagrangian form.
#[derive(Clone, Copy)]
struct Surfaces {
    at: groups::Standing<Read>,
    reference: groups::Reference<Read>,
    outward: groups::Outward<Read>,
}

/// The contact of a body with itself.
#[derive(Clone, Copy)]
pub(super) struct SelfContact {
    surfaces: Surfaces,
    constants: groups::Constants<Read>,
    apart: Option<Separated>,
}

impl SelfContact {
    /// Nothing without self-contact.
    pub(super) fn of(
        bind: &mut Binder<'_>,
        model: &Model,
        references: References,
        constants: groups::Constants<Read>,
    ) -> Option<Self> {
        let of = |bind: &mut Binder<'_>| Self {
            surfaces: Surfaces::of(bind),
            constants,
            apart: Separated::of(bind, model, references),
        };
        model.has_self_contact().then(|| of(bind))
    }

    /// One if particles of one body are in contact, or may be so soon, according to `sides` of their unit normals; else
    /// zero.
    pub(super) fn press<const D: usize>(
        self,
        model: &Model,
        i: Index,
        pair: &Pair,
        j: Index,
        sides: impl Fn(Vector<Recorded>, Vector<Recorded>) -> Recorded,
    ) -> Recorded {
        let press = || self.surfaces.press::<D>(model, i, pair, j, self.constants, sides);
        // A body that has separated is renewed often, and meets itself in the sums.
        let Some(apart) = self.apart else { return press() };
        Recorded::if_lt(apart.has_separated(i), Recorded::of(0.5), press, Recorded::zero)
    }
}

/// Pairs of particles of one body that meet at their facets.
#[derive(Clone, Copy)]
pub(super) struct SelfPairs {
    reference: groups::Reference<Read>,
    constants: groups::Constants<Read>,
    apart: Option<Separated>,
    /// Integrity, if some material loses it.
    integrity: Option<Compensated<Read>>,
}

impl SelfPairs {
    /// Nothing without self-contact.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Option<Self> {
        let of = |bind: &mut Binder<'_>| Self {
            reference: groups::Reference::read(bind),
            constants: groups::Constants::read(bind),
            apart: Separated::of(bind, model, references),
            integrity: HistoryVariables::of(model).integrity().map(|place| groups::History::read(bind).of(place).value),
        };
        model.has_self_contact().then(|| of(bind))
    }

    /// One if particles of a body may meet: they were not neighbours, and the body has not separate; else zero.
    pub(super) fn meet<const D: usize>(self, model: &Model, i: Index, image: &Image, j: Index) -> Recorded {
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let x = apart::<D>(image, &self.reference.position.get(i), &self.reference.position.get(j));
        let reach = Recorded::of(model.numerics.kernel.support()) * at_start(self.constants)(i);
        let meet = Recorded::select_lt(dot(x, x), reach * reach, zero, one);
        // What is severed may be anywhere, within its own body too.
        let meet = self.integrity.map_or(meet, |integrity| {
            Recorded::select_lt(zero, integrity.high().get(i).min(integrity.high().get(j)), meet, zero)
        });
        // A body that has separated is renewed often, and meets itself in the sums.
        self.apart.map_or(meet, |apart| Recorded::select_lt(apart.has_separated(i), Recorded::of(0.5), meet, zero))
    }
}

impl Bodies {
    fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Self {
        let surfaces = model.has_faces().then(|| Surfaces::of(bind));
        let constants = groups::Constants::read(bind);
        Self {
            place: surfaces.map_or_else(|| groups::Place::read(bind).position, |of| of.at.position),
            surfaces,
            constants,
            body: bind.indices(Group::Body),
            laws: groups::ContactLaws::records(bind),
            count: model.bodies.len() as u32,
            itself: SelfContact::of(bind, model, references, constants),
        }
    }

    /// Folds a state over every particle that may be in contact with particle `i`: of another body, or on another side
    /// of the surface of the same body, not its neighbour in the reference configuration, and not behind it as the
    /// other side of a sheet.
    fn over_contacts<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        grid: &Grid,
        i: Index,
        start: S,
        add: impl Fn(S, &Pair, Index) -> S,
    ) -> S {
        over_cells::<_, D>(bind, model, grid, i, (self.place, at_start(self.constants)), start, |state, pair, j| {
            let (zero, one) = (Recorded::zero(), Recorded::one());
            let of_itself = || self.itself.map_or(zero, |of| of.press::<D>(model, i, pair, j, different_sides));
            let presses = match self.count {
                1 => of_itself(),
                _ => Recorded::if_lt(different(self.body, i, j), Recorded::of(0.5), of_itself, || one),
            };
            Recorded::if_lt(zero, presses, || add(state, pair, j), || state)
        })
    }

    /// Velocity of a face relative to its particle, m/s.
    fn rate(self, of: Index) -> Option<Vector<Recorded>> {
        self.surfaces.map(|surfaces| surfaces.at.velocity.get(of))
    }

    fn volume(self, i: Index) -> Recorded {
        self.constants.volume_at_rest.get(i)
    }

    /// The law of two particles, and the share of the heat of friction that the first receives.
    fn law(self, i: Index, j: Index) -> (ContactLaw<Recorded>, Recorded) {
        let pair = self.body.at(i) * Index::of(self.count) + self.body.at(j);
        let laws = self.laws;
        let [first, second] = laws.inverse_sums.get(pair);
        let (modulus, damping, friction) = (laws.modulus.get(pair), laws.damping.get(pair), laws.friction.get(pair));
        let law = ContactLaw { inverse_sums: (first, second), modulus, damping, friction };
        (law, laws.friction_share.get(pair))
    }
}

impl Surfaces {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            at: groups::Standing::read(bind),
            reference: groups::Reference::read(bind),
            outward: groups::Outward::read(bind),
        }
    }

    fn press<const D: usize>(
        self,
        model: &Model,
        i: Index,
        pair: &Pair,
        j: Index,
        constants: groups::Constants<Read>,
        sides: impl Fn(Vector<Recorded>, Vector<Recorded>) -> Recorded,
    ) -> Recorded {
        let (zero, image) = (Recorded::zero(), &pair.image);
        let (then_i, now_i) = (self.outward.normal.get(i), self.at.normal.get(i));
        let x = apart::<D>(image, &self.reference.position.get(i), &self.reference.position.get(j));
        let mut r2 = zero;
        for c in &x[..D] {
            r2 = c.mul_add(*c, r2);
        }
        let then_j = image.vector(self.outward.normal.get(j));
        let sheet = sides_of_a_sheet(x, then_i, then_j, constants.spacing.get(i));
        let sides = sides(now_i, image.vector(self.at.normal.get(j)));
        let presses = Recorded::select_lt(sheet, Recorded::of(0.5), sides, zero);
        let reach = Recorded::of(model.numerics.kernel.support()) * constants.smoothing_length.get(i);
        let presses = Recorded::select_lt(r2, reach * reach, zero, presses);
        // Inside there is no normal.
        let exposed = dot(then_i, then_i).min(dot(then_j, then_j));
        Recorded::select_lt(zero, exposed, presses, zero)
    }
}

fn kernel_of(model: &Model, pair: &Pair) -> ContactKernel<Recorded> {
    ContactKernel::new(model.numerics.kernel, model.dimensions.into(), pair.r2.sqrt(), pair.scale.h)
}

/// First pass: the overlap of every particle that may be in contact.
pub(in crate::engine) fn overlap<const D: usize>(
    model: &Model,
    grid: &Grid,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("overlap", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let bodies = Bodies::of(bind, model, references);
        let overlaps = groups::Overlap::write(bind);
        let volume = bodies.volume(i);
        let first = Overlap::before_the_first();
        let start = [first.overlap, first.away[0], first.away[1], first.away[2], first.weight];
        let sum = bodies.over_contacts::<_, D>(bind, model, grid, i, start, |state: [Recorded; 5], pair, j| {
            let [overlap, x, y, z, weight] = state;
            let mut sum = Overlap { overlap, away: [x, y, z], weight };
            sum.add(&bodies.law(i, j).0, &kernel_of(model, pair), pair.x, volume, bodies.volume(j));
            [sum.overlap, sum.away[0], sum.away[1], sum.away[2], sum.weight]
        });
        let [overlap, x, y, z, weight] = sum;
        overlaps.overlap.set(i, overlap);
        overlaps.away.set(i, [x, y, z]);
        overlaps.weight.set(i, weight);
    })
}

/// Sums of a particle over its contact pairs.
#[derive(Clone, Copy)]
struct ContactSums {
    /// Force, N, heat of the particle, W, and friction's part, speed of approach, m/s.
    sums: [Recorded; 6],
    stiffness: ContactStiffness<Recorded>,
}

impl Numbers<Recorded> for ContactSums {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.sums.each(visit);
        self.stiffness.each(visit);
    }
}

fn overlap_of(overlaps: groups::Overlap<Read>, i: Index) -> Overlap<Recorded> {
    Overlap { overlap: overlaps.overlap.get(i), away: overlaps.away.get(i), weight: overlaps.weight.get(i) }
}

/// What the forces of a particle are made of.
struct ContactPairs {
    bodies: Bodies,
    overlaps: groups::Overlap<Read>,
    evaluated: VectorColumns<Read>,
    i: Index,
    dt: Recorded,
    half: Recorded,
    zero: Recorded,
    mass: Recorded,
    volume: Recorded,
    own: Overlap<Recorded>,
    velocity: Vector<Recorded>,
    /// Velocity of the face relative to the particle, m/s.
    rate: Option<Vector<Recorded>>,
}

/// The force of a contact pair, and what it follows from.
struct PairForce {
    force: ContactForce<Recorded>,
    friction_share: Recorded,
    law: ContactLaw<Recorded>,
    kernel: ContactKernel<Recorded>,
    overlaps: (Recorded, Recorded),
    other_volume: Recorded,
}

impl ContactPairs {
    fn of(bind: &mut Binder<'_>, bodies: Bodies, i: Index) -> Self {
        let (overlaps, evaluated, step) =
            (groups::Overlap::read(bind), groups::Evaluated::read(bind).velocity, groups::Step::shared(bind));
        let (dt, half, zero) = (step.dt.value(), Recorded::of(0.5), Recorded::zero());
        let (mass, volume) = (bodies.constants.mass.get(i), bodies.volume(i));
        let own = overlap_of(overlaps, i);
        let (velocity, rate) = (evaluated.get(i), bodies.rate(i));
        Self { bodies, overlaps, evaluated, i, dt, half, zero, mass, volume, own, velocity, rate }
    }

    fn push(&self, model: &Model, pair: &Pair, j: Index) -> PairForce {
        let (bodies, own, image) = (self.bodies, &self.own, &pair.image);
        let other_velocity = image.vector(self.evaluated.get(j));
        let mut v = [0, 1, 2].map(|a| self.velocity[a] - other_velocity[a]);
        if let Some((rate, other_rate)) = self.rate.zip(bodies.rate(j)) {
            let other_rate = image.vector(other_rate);
            v = [0, 1, 2].map(|a| v[a] + (rate[a] - other_rate[a]));
        }
        let mut other = overlap_of(self.overlaps, j);
        other.away = image.vector(other.away);
        let (law, friction_share) = bodies.law(self.i, j);
        let (kernel, other_volume) = (kernel_of(model, pair), bodies.volume(j));
        let weight = kernel.weight(self.volume, other_volume);
        let overlaps = (own.overlap, other.overlap);
        let other_mass = bodies.constants.mass.get(j);
        let pair = ContactPair {
            x: pair.x,
            v,
            weight,
            overlaps,
            direction: [0, 1, 2].map(|a| own.away[a] - other.away[a]),
            stopping: stopping(self.mass, other_mass, weight, (own.weight, other.weight), self.dt),
        };
        PairForce { force: contact_force(&law, &pair), friction_share, law, kernel, overlaps, other_volume }
    }
}

/// Second pass: forces and their heat. A force on a face has a moment about the particle, which enters as a stress of
/// it, so that the work is done at the face.
///
/// If a section is given, the forces of the pairs that cross it are added to the force through it instead.
pub(in crate::engine) fn forces<const D: usize>(
    model: &Model,
    grid: &Grid,
    through: Option<Through<'_>>,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording(&Through::name(through, "press"), count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let bodies = Bodies::of(bind, model, references);
        let pairs = ContactPairs::of(bind, bodies, i);
        let ContactPairs { half, zero, mass, volume, own, rate: rate_i, .. } = pairs;
        if let Some(through) = through {
            let place = bodies.surfaces.map_or(bodies.place, |_| groups::Place::read(bind).position);
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum =
                bodies.over_contacts::<_, D>(bind, model, grid, i, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                    crossing.add(sum, &pair.image, j, || pairs.push(model, pair, j).force.force, |force| *force)
                });
            crossing.set(sum, true);
            return;
        }
        let meetings = groups::Meetings::write(bind);
        each_body(model.bodies.len(), |body| {
            let meeting = meetings.of_value(body);
            meeting.force.set(i, [zero; 3]);
            meeting.powers.set(i, [zero; 3]);
        });
        let start = ContactSums { sums: [zero; 6], stiffness: ContactStiffness::none() };
        let all = bodies.over_contacts::<_, D>(bind, model, grid, i, start, |mut state: ContactSums, pair, j| {
            let PairForce { force, friction_share, law, kernel, overlaps, other_volume } = pairs.push(model, pair, j);
            let (heat, friction) = force.own_heat(friction_share);
            let sums = &mut state.sums;
            for (sum, part) in sums[..5].iter_mut().zip(force.force.into_iter().chain([heat, friction])) {
                *sum += part;
            }
            sums[5] = sums[5].max(force.approach);
            // The other half comes from the row of the other particle.
            let halves = [force.stored, force.rubbed, force.damped].map(|power| half * power);
            let meeting = meetings.of_value(bodies.body.at(j));
            let book = || {
                meeting.force.add(i, force.force);
                meeting.powers.add(i, halves);
                NOTHING
            };
            Recorded::if_lt(zero, dot(force.force, force.force), book, || NOTHING);
            state.stiffness.add(&law, &kernel, overlaps, volume, other_volume);
            state
        });
        let [x, y, z, heat, friction, approach] = all.sums;
        let force: Vector<Recorded> = [x, y, z];
        let (contact, external) = (groups::Contact::write(bind), groups::External::write(bind));
        external.friction_heat.set(i, external.friction_heat.get(i) + friction / mass);
        let mut along = zero;
        if let Some((surfaces, rate)) = bodies.surfaces.zip(rate_i) {
            let (face_stress, deformation) =
                (groups::FaceStress::write(bind).stress, Deformations::of(bind, references));
            let arm = surfaces.outward.arm.get(i);
            let f = deformation.since_reference(i);
            let moment = || FaceShift::of(&deformation.whole(i), arm).stress(&f, force);
            let moment = Recorded::if_lt(zero, dot(arm, arm), moment, || [[zero; 3]; 3]);
            for (k, moment) in moment.into_iter().flatten().enumerate() {
                let component = face_stress.component(k);
                component.set(i, component.get(i) + moment / surfaces.reference.volume.high().get(i));
            }
            along = dot(force, rate);
        }
        let limit = all.stiffness.limit(&own, volume, mass);
        let heat = heat + along;
        contact.force.set(i, force);
        contact.heat.set(i, heat);
        contact.approach.set(i, approach);
        contact.limit.set(i, limit);
    })
}

/// Adds the contact to acceleration and energy rate.
pub(in crate::engine) fn add(count: usize) -> Result<Recording, KernelFault> {
    recording("add_contact", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (contact, constants) = (groups::Contact::read(bind), groups::Constants::read(bind));
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        let mass = constants.mass.get(i);
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, rates.acceleration.axis(a).get(i) + contact.force.axis(a).get(i) / mass);
        }
        energy.rate.set(i, energy.rate.get(i) + contact.heat.get(i) / mass);
        rates.largest_mu.set(i, rates.largest_mu.get(i).max(contact.approach.get(i)));
    })
}
