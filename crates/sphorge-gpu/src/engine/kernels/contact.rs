//! Contact between bodies by overlap, and of a body with itself where surface particles meet that were not neighbours. In
//! the total Lagrangian form contact acts at the faces of particles. Contact at facets: [`super::facets`].

use super::facets;
use super::grid::Grid;
use super::images::Image;
use super::neighbors::{Pair, apart, at_start, different, over_cells, places};
use super::reference::{Apart, Deformations, References};
use super::section::{Crossing, Through};
use crate::engine::columns::{Binder, Fields, Group, NOTHING, Reading, Recording, added, recording};
use crate::engine::step_numbers::DT;
use crate::record::{Index, Indices, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_engine::{ContactLaws, FacetLaws};
use sphorge_physics::contact::{
    ContactKernel, ContactLaw, ContactPair, ContactStiffness, Overlap, contact_force, stopping,
};
use sphorge_physics::surface::{FaceShift, different_sides, sides_of_a_sheet, surface_normal};
use sphorge_physics::tensor::dot;
use sphorge_physics::{Elementary, Numbers, Real, Vector};

/// Index of the limit among the numbers of [`Group::Contact`].
pub(in crate::engine) const LIMIT: usize = 5;

/// Columns of [`Group::Meetings`] for each body; indices of the works among them, each before its rest, and of their
/// powers.
pub(in crate::engine) const MEETING: usize = 13;
pub(in crate::engine) const WORKS: [(usize, usize); 3] = [(6, 3), (8, 4), (10, 5)];

/// Numbers of the law of two bodies, the last of them the share of the heat of friction that the first receives.
const LAW: usize = 6;

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

/// A number of the law of a pair of bodies.
pub(super) fn law_number(laws: Reading, pair: Index, k: usize) -> Recorded {
    laws.get(0, pair * Index::of(LAW as u32) + Index::of(k as u32))
}

/// Contact positions of particles near faces.
pub(in crate::engine) fn stand(references: References, count: usize) -> Result<Recording, KernelFault> {
    recording("stand", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (place, outward, standing) =
            (bind.read(Group::Place), bind.read(Group::Outward), bind.write(Group::Standing));
        let (deformation, gradient) = (Deformations::of(bind, references), bind.read(Group::Gradient));
        let (f, zero) = (deformation.since_reference(i), Recorded::zero());
        let (normal, arm) = (outward.vector(0, i), outward.vector(3, i));
        let near = || {
            let face = FaceShift::of(&deformation.whole(i), arm);
            let ([x, y, z], [u, v, w]) = (face.shift(), face.rate(&gradient.tensor(0, i)));
            [x, y, z, u, v, w]
        };
        let face = Recorded::if_lt(zero, dot(arm, arm), near, || [zero; 6]);
        for a in 0..3 {
            let z = added(place.double(a, 3 + a, i), face[a]);
            standing.set(a, i, z[0]);
            standing.set(3 + a, i, z[1]);
        }
        standing.set_all(6, i, &face[3..]);
        let normal = Recorded::if_lt(zero, dot(normal, normal), || surface_normal(&f, normal), || [zero; 3]);
        standing.set_all(9, i, &normal);
    })
}

/// Data that determine contact pairs.
#[derive(Clone, Copy)]
struct Bodies {
    /// Contact positions.
    place: Reading,
    constants: Reading,
    body: Indices,
    laws: Reading,
    count: u32,
    surfaces: Option<Surfaces>,
    itself: Option<SelfContact>,
}

/// Surfaces of the total Lagrangian form.
#[derive(Clone, Copy)]
struct Surfaces {
    standing: Reading,
    reference: Reading,
    outward: Reading,
}

/// The contact of a body with itself.
#[derive(Clone, Copy)]
pub(super) struct SelfContact {
    surfaces: Surfaces,
    constants: Reading,
    apart: Option<Apart>,
}

impl SelfContact {
    /// Nothing without self-contact.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, references: References, constants: Reading) -> Option<Self> {
        let of = |bind: &mut Binder<'_>| Self {
            surfaces: Surfaces::of(bind),
            constants,
            apart: Apart::of(bind, model, references),
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
        // A body that has come apart is renewed often, and meets itself in the sums.
        let Some(apart) = self.apart else { return press() };
        Recorded::if_lt(apart.has_come_apart(i), Recorded::of(0.5), press, Recorded::zero)
    }
}

/// Pairs of particles of one body that meet at their facets.
#[derive(Clone, Copy)]
pub(super) struct SelfPairs {
    reference: Reading,
    constants: Reading,
    apart: Option<Apart>,
}

impl SelfPairs {
    /// Nothing without self-contact.
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Option<Self> {
        let of = |bind: &mut Binder<'_>| Self {
            reference: bind.read(Group::Reference),
            constants: bind.read(Group::Constants),
            apart: Apart::of(bind, model, references),
        };
        model.has_self_contact().then(|| of(bind))
    }

    /// One if particles of a body may meet: they were not neighbours, and the body has not come apart; else zero.
    pub(super) fn meet<const D: usize>(self, model: &Model, i: Index, image: &Image, j: Index) -> Recorded {
        let (zero, one) = (Recorded::zero(), Recorded::one());
        let x = apart::<D>(image, &places(self.reference, i), &places(self.reference, j));
        let reach = Recorded::of(model.numerics.kernel.support()) * at_start(self.constants)(i);
        let meet = Recorded::select_lt(dot(x, x), reach * reach, zero, one);
        // A body that has come apart is renewed often, and meets itself in the sums.
        self.apart.map_or(meet, |apart| Recorded::select_lt(apart.has_come_apart(i), Recorded::of(0.5), meet, zero))
    }
}

impl Bodies {
    fn of(bind: &mut Binder<'_>, model: &Model, references: References) -> Self {
        let surfaces = model.has_faces().then(|| Surfaces::of(bind));
        let constants = bind.read(Group::Constants);
        Self {
            place: surfaces.map_or_else(|| bind.read(Group::Place), |of| of.standing),
            surfaces,
            constants,
            body: bind.indices(Group::Body),
            laws: bind.read(Group::ContactLaws),
            count: model.bodies.len() as u32,
            itself: SelfContact::of(bind, model, references, constants),
        }
    }

    /// Folds a state over every particle that may be in contact with particle `i`: of another body, or on another side
    /// of the surface of the same body, not its neighbour in the reference configuration, and not behind it as the
    /// other side of a sheet.
    fn over_pressing<S: Numbers<Recorded>, const D: usize>(
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

    fn volume(self, i: Index) -> Recorded {
        self.constants.get(6, i)
    }

    /// The law of two particles, and the share of the heat of friction that the first receives.
    fn law(self, i: Index, j: Index) -> (ContactLaw<Recorded>, Recorded) {
        let pair = self.body.at(i) * Index::of(self.count) + self.body.at(j);
        let number = |k: usize| law_number(self.laws, pair, k);
        let inverse_sums = (number(0), number(1));
        (ContactLaw { inverse_sums, modulus: number(2), damping: number(3), friction: number(4) }, number(5))
    }
}

impl Surfaces {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            standing: bind.read(Group::Standing),
            reference: bind.read(Group::Reference),
            outward: bind.read(Group::Outward),
        }
    }

    fn press<const D: usize>(
        self,
        model: &Model,
        i: Index,
        pair: &Pair,
        j: Index,
        constants: Reading,
        sides: impl Fn(Vector<Recorded>, Vector<Recorded>) -> Recorded,
    ) -> Recorded {
        let (zero, image) = (Recorded::zero(), &pair.image);
        let (then_i, now_i) = (self.outward.vector(0, i), self.standing.vector(9, i));
        let x = apart::<D>(image, &places(self.reference, i), &places(self.reference, j));
        let mut r2 = zero;
        for c in &x[..D] {
            r2 = c.mul_add(*c, r2);
        }
        let then_j = image.vector(self.outward.vector(0, j));
        let sheet = sides_of_a_sheet(x, then_i, then_j, constants.get(3, i));
        let sides = sides(now_i, image.vector(self.standing.vector(9, j)));
        let presses = Recorded::select_lt(sheet, Recorded::of(0.5), sides, zero);
        let reach = Recorded::of(model.numerics.kernel.support()) * constants.get(1, i);
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
        let overlaps = bind.write(Group::Overlap);
        let volume = bodies.volume(i);
        let first = Overlap::before_the_first();
        let start = [first.overlap, first.away[0], first.away[1], first.away[2], first.weight];
        let sum = bodies.over_pressing::<_, D>(bind, model, grid, i, start, |state: [Recorded; 5], pair, j| {
            let [overlap, x, y, z, weight] = state;
            let mut sum = Overlap { overlap, away: [x, y, z], weight };
            sum.add(&bodies.law(i, j).0, &kernel_of(model, pair), pair.x, volume, bodies.volume(j));
            [sum.overlap, sum.away[0], sum.away[1], sum.away[2], sum.weight]
        });
        overlaps.set_all(0, i, &sum);
    })
}

/// Sums of a particle over its contact pairs.
#[derive(Clone, Copy)]
struct Pressed {
    /// Force, N, heat of the particle, W, and friction's part, speed of approach, m/s.
    sums: [Recorded; 6],
    stiffness: ContactStiffness<Recorded>,
}

impl Numbers<Recorded> for Pressed {
    fn each(&mut self, visit: &mut dyn FnMut(&mut Recorded)) {
        self.sums.each(visit);
        self.stiffness.each(visit);
    }
}

fn overlap_of(overlaps: Reading, i: Index) -> Overlap<Recorded> {
    Overlap { overlap: overlaps.get(0, i), away: overlaps.vector(1, i), weight: overlaps.get(4, i) }
}

/// Second pass: forces and their heat. A force on a face has a moment about the particle, which enters as a stress of
/// it, so that the work is done at the face.
///
/// If a section is given, the forces of the pairs that cross it are added to the force through it instead.
pub(in crate::engine) fn press<const D: usize>(
    model: &Model,
    grid: &Grid,
    through: Option<Through<'_>>,
    references: References,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording(&Through::name(through, "press"), count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let bodies = Bodies::of(bind, model, references);
        let (overlaps, evaluated, step) =
            (bind.read(Group::Overlap), bind.read(Group::Evaluated), bind.read(Group::Step));
        let (dt, half, zero) = (step.get(0, Index::of(DT)), Recorded::of(0.5), Recorded::zero());
        let (mass, volume) = (bodies.constants.get(0, i), bodies.volume(i));
        let own = overlap_of(overlaps, i);
        // Velocity of the face relative to the particle.
        let rate = |of: Index| bodies.surfaces.map(|surfaces| surfaces.standing.vector(6, of));
        let (v_i, rate_i) = (evaluated.vector(0, i), rate(i));
        // The force of a contact pair, and the part due to its law.
        let push = |pair: &Pair, j: Index| {
            let image = &pair.image;
            let v_j = image.vector(evaluated.vector(0, j));
            let mut v = [0, 1, 2].map(|a| v_i[a] - v_j[a]);
            if let Some((rate_i, rate_j)) = rate_i.zip(rate(j)) {
                let rate_j = image.vector(rate_j);
                v = [0, 1, 2].map(|a| v[a] + (rate_i[a] - rate_j[a]));
            }
            let mut other = overlap_of(overlaps, j);
            other.away = image.vector(other.away);
            let (law, friction_share) = bodies.law(i, j);
            let (kernel, other_volume) = (kernel_of(model, pair), bodies.volume(j));
            let weight = kernel.weight(volume, other_volume);
            let overlaps = (own.overlap, other.overlap);
            let other_mass = bodies.constants.get(0, j);
            let force = contact_force(
                &law,
                &ContactPair {
                    x: pair.x,
                    v,
                    weight,
                    overlaps,
                    direction: [0, 1, 2].map(|a| own.away[a] - other.away[a]),
                    stopping: stopping(mass, other_mass, weight, (own.weight, other.weight), dt),
                },
            );
            (force, friction_share, law, kernel, overlaps, other_volume)
        };
        if let Some(through) = through {
            let place = bodies.surfaces.map_or(bodies.place, |_| bind.read(Group::Place));
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum =
                bodies.over_pressing::<_, D>(bind, model, grid, i, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                    crossing.add(sum, &pair.image, j, || push(pair, j).0.force, |force| *force)
                });
            crossing.set(sum, true);
            return;
        }
        let meetings = bind.write(Group::Meetings);
        each_body(model.bodies.len(), |body| {
            (0..WORKS[0].0).for_each(|field| meetings.set_in_group((body, MEETING), field, i, zero));
        });
        let start = Pressed { sums: [zero; 6], stiffness: ContactStiffness::none() };
        let all = bodies.over_pressing::<_, D>(bind, model, grid, i, start, |mut state: Pressed, pair, j| {
            let (force, friction_share, law, kernel, overlaps, other_volume) = push(pair, j);
            let (heat, friction) = force.own_heat(friction_share);
            let sums = &mut state.sums;
            for (sum, part) in sums[..5].iter_mut().zip(force.force.into_iter().chain([heat, friction])) {
                *sum += part;
            }
            sums[5] = sums[5].max(force.approach);
            // The other half comes from the row of the other particle.
            let halves = [force.stored, force.rubbed, force.damped].map(|power| half * power);
            let body = (bodies.body.at(j), MEETING);
            let book = || {
                for (field, part) in force.force.into_iter().chain(halves).enumerate() {
                    meetings.add_in_group(body, field, i, part);
                }
                NOTHING
            };
            Recorded::if_lt(zero, dot(force.force, force.force), book, || NOTHING);
            state.stiffness.add(&law, &kernel, overlaps, volume, other_volume);
            state
        });
        let [x, y, z, heat, friction, approach] = all.sums;
        let force: Vector<Recorded> = [x, y, z];
        let (contact, external) = (bind.write(Group::Contact), bind.write(Group::External));
        external.set(4, i, external.get(4, i) + friction / mass);
        let mut along = zero;
        if let Some((surfaces, rate)) = bodies.surfaces.zip(rate_i) {
            let (face_stress, deformation) = (bind.write(Group::FaceStress), Deformations::of(bind, references));
            let arm = surfaces.outward.vector(3, i);
            let f = deformation.since_reference(i);
            let moment = || FaceShift::of(&deformation.whole(i), arm).stress(&f, force);
            let moment = Recorded::if_lt(zero, dot(arm, arm), moment, || [[zero; 3]; 3]);
            for (k, moment) in moment.into_iter().flatten().enumerate() {
                face_stress.set(k, i, face_stress.get(k, i) + moment / surfaces.reference.get(6, i));
            }
            along = dot(force, rate);
        }
        let limit = all.stiffness.limit(&own, volume, mass);
        contact.set_all(0, i, &[x, y, z, heat + along, approach, limit]);
    })
}

/// Adds the contact to acceleration and energy rate.
pub(in crate::engine) fn add(count: usize) -> Result<Recording, KernelFault> {
    recording("add_contact", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (contact, constants) = (bind.read(Group::Contact), bind.read(Group::Constants));
        let (rates, energy) = (bind.write(Group::Rates), bind.write(Group::Energy));
        let mass = constants.get(0, i);
        for a in 0..3 {
            rates.set(a, i, rates.get(a, i) + contact.get(a, i) / mass);
        }
        energy.set(2, i, energy.get(2, i) + contact.get(3, i) / mass);
        rates.set(6, i, rates.get(6, i).max(contact.get(4, i)));
    })
}
