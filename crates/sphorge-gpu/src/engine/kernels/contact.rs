//! The contact of a body with itself: particles of its surface that were no neighbours meet where their faces are.

use super::grid::Grid;
use super::neighbors::{Pair, apart, over_cells, places};
use crate::engine::columns::{Binder, Fields, Group, Reading, Recording, added, recording};
use crate::engine::step_numbers::DT;
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{BodyContact, Model};
use sphorge_physics::conduction::friction_share;
use sphorge_physics::contact::{
    ContactBody, ContactKernel, ContactLaw, ContactPair, ContactStiffness, Overlap, contact_force, stopping,
};
use sphorge_physics::surface::{FaceShift, different_sides, sides_of_a_sheet, surface_normal};
use sphorge_physics::{Elementary, Numbers, Real, Vector};

/// Place of the limit among the numbers of [`Group::Contact`].
pub(in crate::engine) const LIMIT: usize = 5;

/// Places of the works there, each before its rest, and of their powers.
pub(in crate::engine) const WORKS: [(usize, usize); 3] = [(6, 12), (8, 13), (10, 14)];

/// Constants of the one body there is.
struct Meeting {
    law: ContactLaw<f64>,
    /// Reach of the contact, m, spacing, m, smoothing length, m.
    reach: f64,
    spacing: f64,
    h: f64,
    /// `1/rho` at rest, m³/kg.
    specific_volume: f64,
    friction_share: f64,
}

impl Meeting {
    fn of(model: &Model) -> Option<Self> {
        let (BodyContact::Penalty(strength), Some(body)) = (model.contact, model.bodies.first()) else { return None };
        let (kernel, material) = (model.numerics.kernel, &model.materials[body.material]);
        let speed = material.equation_of_state.reference_sound_speed();
        let own = ContactBody {
            spacing: body.spacing,
            smoothing_length: body.smoothing_length,
            density: material.density,
            bulk_modulus: material.density * speed * speed,
        };
        Some(Self {
            law: ContactLaw::with_itself(kernel, model.dimensions.into(), &own, strength),
            reach: kernel.support() * body.smoothing_length,
            spacing: body.spacing,
            h: body.smoothing_length,
            specific_volume: 1.0 / material.density,
            friction_share: friction_share(material.effusivity(), material.effusivity()),
        })
    }
}

/// Where particles of the surface stand for the contact.
pub(in crate::engine) fn stand(count: usize) -> Result<Recording, KernelFault> {
    recording("stand", count, |bind, thread| {
        let i = bind.indices(Group::Surface).at(thread);
        let (place, outward, standing) =
            (bind.read(Group::Place), bind.read(Group::Outward), bind.write(Group::Standing));
        let (deformation, gradient) = (bind.read(Group::Deformation), bind.read(Group::Gradient));
        let f = deformation.tensor(0, i);
        let face = FaceShift::of(&f, outward.vector(3, i));
        for (a, shift) in face.shift().into_iter().enumerate() {
            let z = added(place.double(a, 3 + a, i), shift);
            standing.set(a, i, z[0]);
            standing.set(3 + a, i, z[1]);
        }
        standing.set_all(6, i, &face.rate(&gradient.tensor(0, i)));
        standing.set_all(9, i, &surface_normal(&f, outward.vector(0, i)));
    })
}

/// What tells who meets.
#[derive(Clone, Copy)]
struct Surfaces {
    standing: Reading,
    reference: Reading,
    outward: Reading,
    constants: Reading,
}

impl Surfaces {
    fn of(bind: &mut Binder<'_>) -> Self {
        Self {
            standing: bind.read(Group::Standing),
            reference: bind.read(Group::Reference),
            outward: bind.read(Group::Outward),
            constants: bind.read(Group::Constants),
        }
    }

    /// Takes a state through every particle that presses particle `i`: of another side of the surface, not its neighbour in the reference
    /// configuration, nor behind it as the other side of a sheet is.
    fn over_pressing<S: Numbers<Recorded>, const D: usize>(
        self,
        bind: &mut Binder<'_>,
        model: &Model,
        (grid, meeting): (&Grid, &Meeting),
        i: Index,
        start: S,
        add: impl Fn(S, &Pair, Index) -> S,
    ) -> S {
        let x_i = places(self.reference, i);
        let (then_i, now_i) = (self.outward.vector(0, i), self.standing.vector(9, i));
        over_cells::<_, D>(bind, model, grid, i, (self.standing, self.constants), start, |state, pair, j| {
            let (zero, image) = (Recorded::zero(), &pair.image);
            let x = apart::<D>(image, &x_i, &places(self.reference, j));
            let mut r2 = zero;
            for c in &x[..D] {
                r2 = c.mul_add(*c, r2);
            }
            let then_j = image.vector(self.outward.vector(0, j));
            let sheet = sides_of_a_sheet(x, then_i, then_j, Recorded::of(meeting.spacing));
            let sides = different_sides(now_i, image.vector(self.standing.vector(9, j)));
            let presses = Recorded::select_lt(sheet, Recorded::of(0.5), sides, zero);
            let presses = Recorded::select_lt(r2, Recorded::of(meeting.reach * meeting.reach), zero, presses);
            Recorded::if_lt(zero, presses, || add(state, pair, j), || state)
        })
    }

    fn volume(self, meeting: &Meeting, i: Index) -> Recorded {
        self.constants.get(0, i) * Recorded::of(meeting.specific_volume)
    }
}

fn kernel_of(model: &Model, meeting: &Meeting, pair: &Pair) -> ContactKernel<Recorded> {
    ContactKernel::new(model.numerics.kernel, model.dimensions.into(), pair.r2.sqrt(), Recorded::of(meeting.h))
}

/// First pass: the overlap of every particle of the surface.
pub(in crate::engine) fn overlap<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("overlap", count, |bind, thread| {
        let Some(meeting) = Meeting::of(model) else { return };
        let i = bind.indices(Group::Surface).at(thread);
        let surfaces = Surfaces::of(bind);
        let overlaps = bind.write(Group::Overlap);
        let law = meeting.law.cast();
        let volume = surfaces.volume(&meeting, i);
        let first = Overlap::before_the_first();
        let start = [first.overlap, first.away[0], first.away[1], first.away[2], first.weight];
        let with = (grid, &meeting);
        let sum = surfaces.over_pressing::<_, D>(bind, model, with, i, start, |state: [Recorded; 5], pair, j| {
            let [overlap, x, y, z, weight] = state;
            let mut sum = Overlap { overlap, away: [x, y, z], weight };
            sum.add(&law, &kernel_of(model, &meeting, pair), pair.x, volume, surfaces.volume(&meeting, j));
            [sum.overlap, sum.away[0], sum.away[1], sum.away[2], sum.weight]
        });
        overlaps.set_all(0, i, &sum);
    })
}

/// Sums of a particle over what presses it.
#[derive(Clone, Copy)]
struct Pressed {
    /// Force, N, heat of the particle, W, and friction's part, speed of approach, m/s, and of the pairs what is stored, rubbed, damped, W.
    sums: [Recorded; 9],
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

/// Second pass: forces and their heat. A force on a face has a moment about the particle, which is a stress of it, so that the face does the work.
pub(in crate::engine) fn press<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("press", count, |bind, thread| {
        let Some(meeting) = Meeting::of(model) else { return };
        let i = bind.indices(Group::Surface).at(thread);
        let surfaces = Surfaces::of(bind);
        let (overlaps, evaluated, step) =
            (bind.read(Group::Overlap), bind.read(Group::Evaluated), bind.read(Group::Step));
        let law = meeting.law.cast();
        let (dt, half, zero) = (step.get(0, Index::of(DT)), Recorded::of(0.5), Recorded::zero());
        let (mass, volume) = (surfaces.constants.get(0, i), surfaces.volume(&meeting, i));
        let own = overlap_of(overlaps, i);
        let standing = surfaces.standing;
        let (v_i, rate_i) = (evaluated.vector(0, i), standing.vector(6, i));
        let start = Pressed { sums: [zero; 9], stiffness: ContactStiffness::none() };
        let with = (grid, &meeting);
        let all = surfaces.over_pressing::<_, D>(bind, model, with, i, start, |mut state: Pressed, pair, j| {
            let image = &pair.image;
            let (v_j, rate_j) = (image.vector(evaluated.vector(0, j)), image.vector(standing.vector(6, j)));
            let mut other = overlap_of(overlaps, j);
            other.away = image.vector(other.away);
            let other_mass = surfaces.constants.get(0, j);
            let kernel = kernel_of(model, &meeting, pair);
            let other_volume = surfaces.volume(&meeting, j);
            let weight = kernel.weight(volume, other_volume);
            let overlaps = (own.overlap, other.overlap);
            let force = contact_force(
                &law,
                &ContactPair {
                    x: pair.x,
                    v: [0, 1, 2].map(|a| (v_i[a] - v_j[a]) + (rate_i[a] - rate_j[a])),
                    weight,
                    overlaps,
                    direction: [0, 1, 2].map(|a| own.away[a] - other.away[a]),
                    stopping: stopping(mass, other_mass, weight, (own.weight, other.weight), dt),
                },
            );
            let (heat, friction) = force.own_heat(Recorded::of(meeting.friction_share));
            let sums = &mut state.sums;
            // The other half comes from the row of the other particle.
            let halves = [force.stored, force.rubbed, force.damped].map(|power| half * power);
            for (sum, part) in sums[..5].iter_mut().zip(force.force.into_iter().chain([heat, friction])) {
                *sum += part;
            }
            sums[5] = sums[5].max(force.approach);
            for (sum, part) in sums[6..].iter_mut().zip(halves) {
                *sum += part;
            }
            state.stiffness.add(&law, &kernel, overlaps, volume, other_volume);
            state
        });
        let [x, y, z, heat, friction, approach, stored, rubbed, damped] = all.sums;
        let force: Vector<Recorded> = [x, y, z];
        let (contact, external, face_stress) =
            (bind.write(Group::Contact), bind.write(Group::External), bind.write(Group::FaceStress));
        let (deformation, reference) = (bind.read(Group::Deformation), surfaces.reference);
        external.set(4, i, external.get(4, i) + friction / mass);
        let f = deformation.tensor(0, i);
        let moment = FaceShift::of(&f, surfaces.outward.vector(3, i)).stress(&f, force);
        for (k, moment) in moment.into_iter().flatten().enumerate() {
            face_stress.set(k, i, face_stress.get(k, i) + moment / reference.get(6, i));
        }
        let mut along = zero;
        for a in 0..3 {
            along += force[a] * rate_i[a];
        }
        let limit = all.stiffness.limit(&own, volume, mass);
        contact.set_all(0, i, &[x, y, z, heat + along, approach, limit]);
        for ((_, power), value) in WORKS.into_iter().zip([stored, rubbed, damped]) {
            contact.set(power, i, value);
        }
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
