//! Forces of the total Lagrangian form: the sum of the stress in the reference configuration, and the hourglass
//! springs.

use super::neighbors::{Pair, over_list, places};
use super::reference::less_identity;
use super::section::{Crossing, Through};
use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::record::{Double, Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::hourglass::{Misfit, Spring, SpringSums};
use sphorge_physics::pair::{ForceSums, PairForce, corrected_stress_vector, momentum_factor};
use sphorge_physics::tensor::{multiply, plus};
use sphorge_physics::total_lagrangian::force_tensor;
use sphorge_physics::{Real, Tensor, Vector};

/// Data of a neighbour that forces read: the tensor whose sum is the force, and its spring.
pub(in crate::engine) fn pull_back(model: &Model, hourglass: f64, count: usize) -> Result<Recording, KernelFault> {
    recording("pull_back", count, |bind, i| {
        let (packed, deformation) = (bind.write(Group::Packed), bind.read(Group::Deformation));
        let correction = bind.read(Group::Correction);
        let f = deformation.tensor(0, i);
        let face_stress = match model.walls.is_empty() && !model.has_contact() {
            true => [[Recorded::zero(); 3]; 3],
            false => bind.read(Group::FaceStress).tensor(0, i),
        };
        let springs = (hourglass != 0.0).then(|| bind.read(Group::Springs));
        let more = springs.map_or(face_stress, |of| plus(&face_stress, Recorded::one(), &of.tensor(2, i)));
        let tensor = force_tensor(packed.symmetric(0, i), &f, &more, &correction.tensor(0, i));
        packed.set_all(0, i, tensor.as_flattened());
        if let Some(springs) = springs {
            let (plastic, constants) = (bind.read(Group::Plastic), bind.read(Group::Constants));
            let (yield_stress, plastic_strain) = (plastic.get(3, i), plastic.get(0, i));
            let (strength, stretch) = (Recorded::of(hourglass), springs.get(0, i));
            let spring = Spring::new(strength, constants.get(5, i), yield_stress, plastic_strain, stretch);
            packed.set(9, i, spring.at(springs.get(1, i)));
        }
    })
}

/// Acceleration and energy rate of the stress.
///
/// If a section is given, only the force of the pairs that cross it.
pub(in crate::engine) fn forces<const D: usize>(
    model: &Model,
    through: Option<Through<'_>>,
    count: usize,
) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    let kernel = numerics.kernel;
    recording(&Through::name(through, "reference_forces"), count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (evaluated, packed) = (bind.read(Group::Evaluated), bind.read(Group::Packed));
        let (own, tensor) = (evaluated.vector(0, i), packed.tensor(0, i));
        let zero = Recorded::zero();
        let add = |state: [Recorded; 4], pair: &Pair, j: Index| {
            let other = pair.image.vector(evaluated.vector(0, j));
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let force = PairForce {
                x: pair.x,
                v: [0, 1, 2].map(|a| own[a] - other[a]),
                own_stress: corrected_stress_vector::<_, D>(&tensor, &pair.x),
                other_stress: corrected_stress_vector::<_, D>(&pair.image.tensor(&packed.tensor(0, j)), &pair.x),
                artificial_stress: [zero; 3],
                pi: zero,
                weighted_f: pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q)),
                closing_power: zero,
            };
            let acceleration = [state[0], state[1], state[2]];
            let mut sums = ForceSums { acceleration, stress_power: state[3], ..ForceSums::zero() };
            sums.add::<D>(numerics.energy_split, &force);
            [sums.acceleration[0], sums.acceleration[1], sums.acceleration[2], sums.energy_rate()]
        };
        let factor = momentum_factor(numerics.pair_form, near.1.get(0, i), near.0.get(6, i));
        if let Some(through) = through {
            let place = bind.read(Group::Place);
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = over_list::<_, D>(bind, model, i, near, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                crossing.add(sum, &pair.image, j, || add([zero; 4], pair, j), |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.get(0, i)), false);
            return;
        }
        let sums = over_list::<_, D>(bind, model, i, near, [zero; 4], add);
        let (rates, energy) = (bind.write(Group::Rates), bind.write(Group::Energy));
        for a in 0..3 {
            rates.set(a, i, sums[a] * factor);
        }
        energy.set(2, i, sums[3] * factor);
    })
}

/// Sums of the springs of a particle: force, how fast they close, misfit and moment.
const SPRING_SUMS: usize = 14;

fn unpacked(state: &[Recorded; SPRING_SUMS]) -> SpringSums<Recorded> {
    let row = |a: usize| [state[5 + 3 * a], state[6 + 3 * a], state[7 + 3 * a]];
    let moment: Tensor<Recorded> = [row(0), row(1), row(2)];
    let acceleration = [state[0], state[1], state[2]];
    SpringSums { acceleration, closing: state[3], misfit2: state[4], moment }
}

/// Adds the springs to acceleration and energy rate, or to the force through a section.
pub(in crate::engine) fn springs<const D: usize>(
    model: &Model,
    through: Option<Through<'_>>,
    count: usize,
) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    recording(&Through::name(through, "springs"), count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (place, evaluated) = (bind.read(Group::Place), bind.read(Group::Evaluated));
        let (packed, deformation) = (bind.read(Group::Packed), bind.read(Group::Deformation));
        // Displacement and its rest: differences of places would be rounded to single precision of the distance.
        // So would the difference of the numbers where a body has gone far: its rest is kept, too.
        let displacement = |k: Index| {
            let (now, then) = (places(place, k), places(near.0, k));
            let u = [0, 1, 2].map(|a| Double::new(now[a]) - Double::new(then[a]));
            [u.map(|u| u.high), u.map(|u| u.low)]
        };
        let (u_i, v_i): (_, Vector<Recorded>) = (displacement(i), evaluated.vector(0, i));
        let (h_i, stiffness) = (less_identity(deformation, i), packed.get(9, i));
        let zero = Recorded::zero();
        let kernel = numerics.kernel;
        let add = |state: [Recorded; SPRING_SUMS], pair: &Pair, j: Index| {
            let image = &pair.image;
            let u_j = displacement(j).map(|part| image.vector(part));
            let u = [0, 1, 2].map(|a| (u_i[0][a] - u_j[0][a]) + (u_i[1][a] - u_j[1][a]));
            let v_j = image.vector(evaluated.vector(0, j));
            let v = [0, 1, 2].map(|a| v_i[a] - v_j[a]);
            let misfit = Misfit::of::<D>(&pair.x, &u, &h_i, &image.tensor(&less_identity(deformation, j)));
            let (q, inverse_q) = pair.scale.reduced_distance(misfit.initial2);
            let weight = -pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = unpacked(&state);
            sums.add::<D>(&misfit, &misfit.push::<D>(stiffness, packed.get(9, j)), &v, weight);
            let mut state = [zero; SPRING_SUMS];
            state[..3].copy_from_slice(&sums.acceleration);
            (state[3], state[4]) = (sums.closing, sums.misfit2);
            state[5..].copy_from_slice(sums.moment.as_flattened());
            state
        };
        let factor = momentum_factor(numerics.pair_form, near.1.get(0, i), near.0.get(6, i));
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = over_list::<_, D>(bind, model, i, near, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                let of = || add([zero; SPRING_SUMS], pair, j);
                crossing.add(sum, &pair.image, j, of, |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.get(0, i)), true);
            return;
        }
        let state = over_list::<_, D>(bind, model, i, near, [zero; SPRING_SUMS], add);
        let sums = unpacked(&state);
        let (rates, energy) = (bind.write(Group::Rates), bind.write(Group::Energy));
        let (springs, gradient) = (bind.write(Group::Springs), bind.read(Group::Gradient));
        for a in 0..3 {
            rates.set(a, i, rates.get(a, i) + sums.acceleration[a] * factor);
        }
        let power = sums.energy_rate(stiffness) * factor;
        energy.set(2, i, energy.get(2, i) + power);
        // The stress of the moment has worked in the sum of the stress.
        let rate = multiply(&gradient.tensor(0, i), &deformation.tensor(0, i));
        let earlier = springs.tensor(2, i);
        let turned = rate.as_flattened().iter().zip(earlier.as_flattened()).fold(zero, |sum, (f, m)| sum + *f * *m);
        energy.set(5, i, power + turned * factor);
        springs.set(1, i, sums.misfit2 * Recorded::of(1.0 / D as f64));
        let half = stiffness * Recorded::of(0.5);
        springs.set_all(2, i, sums.moment.map(|row| row.map(|m| half * m)).as_flattened());
    })
}
