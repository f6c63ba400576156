//! Forces of the total Lagrangian form: the sum of the stress in the reference configuration, and the hourglass
//! springs.

use super::neighbors::{Pair, over_list};
use super::reference::less_identity;
use super::section::{Crossing, Through};
use crate::engine::columns::{Handles, ReadColumns, Recording, WriteColumns, groups, recording};
use crate::record::{Double, Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::hourglass::{Counted, Misfit, Spring, SpringSums};
use sphorge_physics::pair::{ForceSums, PairForce, corrected_stress_vector, momentum_factor};
use sphorge_physics::tensor::{dot, multiply, plus};
use sphorge_physics::total_lagrangian::force_tensor;
use sphorge_physics::viscosity::{ShockSums, closing_rate, shock_push};
use sphorge_physics::{Real, Tensor, Vector};

/// Data of a neighbour that forces read: the tensor whose sum is the force, and its spring.
pub(in crate::engine) fn pull_back(
    model: &Model,
    (hourglass, counted): (f64, Counted),
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("pull_back", count, |bind, i| {
        let (packed, deformation) = (groups::Packed::write(bind), groups::Deformation::read(bind).deformation);
        let correction = groups::Correction::read(bind).correction;
        let pulled_back = groups::PulledBack::at(packed.source(), 0);
        let f = deformation.high().get(i);
        let face_stress = match model.walls.is_empty() && !model.has_contact() {
            true => [[Recorded::zero(); 3]; 3],
            false => groups::FaceStress::read(bind).stress.get(i),
        };
        let springs = (hourglass != 0.0).then(|| groups::Springs::read(bind));
        let more = springs.map_or(face_stress, |of| plus(&face_stress, Recorded::one(), &of.moment.get(i)));
        let more = match model.formulation.is_quadratic_at_faces() {
            true => plus(&more, Recorded::one(), &groups::FaceShare::read(bind).stress.get(i)),
            false => more,
        };
        let tensor = force_tensor(packed.stress.get(i), &f, &more, &correction.get(i));
        pulled_back.tensor.set(i, &tensor);
        if model.numerics.viscosity_of_shocks > 0.0 {
            pulled_back.impedance.set(i, groups::Stretch::read(bind).impedance.get(i));
        }
        if let Some(springs) = springs {
            let (plastic, constants) = (groups::Plastic::read(bind), groups::Constants::read(bind));
            let (yield_stress, plastic_strain) = (plastic.yield_stress.get(i), plastic.strain.high().get(i));
            let (strength, young) = (Recorded::of(hourglass), constants.young_modulus.get(i));
            let stretch = springs.least_stretch.get(i);
            let spring = Spring::new(counted, strength, young, yield_stress, plastic_strain, stretch);
            pulled_back.stiffness.set(i, spring.at(springs.misfit.get(i)));
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
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (evaluated, packed) = (groups::Evaluated::read(bind).velocity, groups::PulledBack::read(bind));
        let (own, tensor) = (evaluated.get(i), packed.tensor.get(i));
        let zero = Recorded::zero();
        let add = |state: [Recorded; 4], pair: &Pair, j: Index| {
            let other = pair.image.vector(evaluated.get(j));
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let force = PairForce {
                x: pair.x,
                v: [0, 1, 2].map(|a| own[a] - other[a]),
                own_stress: corrected_stress_vector::<_, D>(&tensor, &pair.x),
                other_stress: corrected_stress_vector::<_, D>(&pair.image.tensor(&packed.tensor.get(j)), &pair.x),
                artificial_stress: [zero; 3],
                pi: zero,
                weighted_f: pair.scale.weighted(near.0.volume.high().get(j)).f(kernel.dw_over_q_by(q, inverse_q)),
                closing_power: zero,
            };
            let acceleration = [state[0], state[1], state[2]];
            let mut sums = ForceSums { acceleration, stress_power: state[3], ..ForceSums::zero() };
            sums.add::<D>(numerics.energy_split, &force);
            [sums.acceleration[0], sums.acceleration[1], sums.acceleration[2], sums.energy_rate()]
        };
        let factor = momentum_factor(numerics.pair_form, near.1.mass.get(i), near.0.volume.high().get(i));
        if let Some(through) = through {
            let place = groups::Place::read(bind).position;
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = over_list::<_, D>(bind, model, i, near, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                crossing.add(sum, &pair.image, j, || add([zero; 4], pair, j), |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.mass.get(i)), false);
            return;
        }
        let sums = over_list::<_, D>(bind, model, i, near, [zero; 4], add);
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, sums[a] * factor);
        }
        let rate = sums[3] * factor;
        let rate = match model.formulation.is_quadratic_at_faces() {
            true => rate + groups::FaceShare::read(bind).power.get(i),
            false => rate,
        };
        energy.rate.set(i, rate);
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
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (place, evaluated) = (groups::Place::read(bind).position, groups::Evaluated::read(bind).velocity);
        let (packed, deformation) = (groups::PulledBack::read(bind), groups::Deformation::read(bind).deformation);
        // Displacement and its low part: differences of places would be rounded to single precision of the distance.
        // So would the difference of the numbers where a body has gone far: its low part is kept, too.
        let displacement = |k: Index| {
            let (now, then) = (place.get(k), near.0.position.get(k));
            let u = [0, 1, 2].map(|a| Double::new(now[a]) - Double::new(then[a]));
            [u.map(|u| u.high), u.map(|u| u.low)]
        };
        let excess = model.formulation.is_quadratic_at_faces().then(|| groups::FaceExcess::read(bind).excess.high());
        // Springs see the motion that the sums do not.
        let gradient = |k: Index| {
            let gradient = less_identity(deformation, k);
            excess.map_or(gradient, |excess| plus(&gradient, Recorded::one(), &excess.get(k)))
        };
        let (u_i, v_i): (_, Vector<Recorded>) = (displacement(i), evaluated.get(i));
        let (h_i, stiffness) = (gradient(i), packed.stiffness.get(i));
        let zero = Recorded::zero();
        let kernel = numerics.kernel;
        let add = |state: [Recorded; SPRING_SUMS], pair: &Pair, j: Index| {
            let image = &pair.image;
            let u_j = displacement(j).map(|part| image.vector(part));
            let u = [0, 1, 2].map(|a| (u_i[0][a] - u_j[0][a]) + (u_i[1][a] - u_j[1][a]));
            let v_j = image.vector(evaluated.get(j));
            let v = [0, 1, 2].map(|a| v_i[a] - v_j[a]);
            let misfit = Misfit::of::<D>(&pair.x, &u, &h_i, &image.tensor(&gradient(j)));
            let (q, inverse_q) = pair.scale.reduced_distance(misfit.initial2);
            let weight = -pair.scale.weighted(near.0.volume.high().get(j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = unpacked(&state);
            sums.add::<D>(&misfit, &misfit.push::<D>(stiffness, packed.stiffness.get(j)), &v, weight);
            let mut state = [zero; SPRING_SUMS];
            state[..3].copy_from_slice(&sums.acceleration);
            (state[3], state[4]) = (sums.closing, sums.misfit2);
            state[5..].copy_from_slice(sums.moment.as_flattened());
            state
        };
        let factor = momentum_factor(numerics.pair_form, near.1.mass.get(i), near.0.volume.high().get(i));
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = over_list::<_, D>(bind, model, i, near, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                let of = || add([zero; SPRING_SUMS], pair, j);
                crossing.add(sum, &pair.image, j, of, |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.mass.get(i)), true);
            return;
        }
        let state = over_list::<_, D>(bind, model, i, near, [zero; SPRING_SUMS], add);
        let sums = unpacked(&state);
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        let (springs, gradient) = (groups::Springs::write(bind), groups::Gradient::read(bind).velocity_gradient);
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, rates.acceleration.axis(a).get(i) + sums.acceleration[a] * factor);
        }
        let power = sums.energy_rate(stiffness) * factor;
        energy.rate.set(i, energy.rate.get(i) + power);
        // The stress of the moment has worked in the sum of the stress.
        let rate = multiply(&gradient.get(i), &deformation.high().get(i));
        let earlier = springs.moment.get(i);
        let turned = rate.as_flattened().iter().zip(earlier.as_flattened()).fold(zero, |sum, (f, m)| sum + *f * *m);
        energy.hourglass_rate.set(i, power + turned * factor);
        springs.misfit.set(i, sums.misfit2 * Recorded::of(1.0 / D as f64));
        let half = stiffness * Recorded::of(0.5);
        springs.moment.set(i, &sums.moment.map(|row| row.map(|m| half * m)));
    })
}

/// Adds the viscosity of shocks along pairs to acceleration and energy rate, or to the force through a section.
pub(in crate::engine) fn shocks<const D: usize>(
    model: &Model,
    through: Option<Through<'_>>,
    count: usize,
) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    recording(&Through::name(through, "shocks"), count, |bind, i| {
        let near = (groups::Reference::read(bind), groups::Constants::read(bind));
        let (place, evaluated) = (groups::Place::read(bind).position, groups::Evaluated::read(bind).velocity);
        let packed = groups::PulledBack::read(bind);
        // As of the springs.
        let displacement = |k: Index| {
            let (now, then) = (place.get(k), near.0.position.get(k));
            let u = [0, 1, 2].map(|a| Double::new(now[a]) - Double::new(then[a]));
            [u.map(|u| u.high), u.map(|u| u.low)]
        };
        let (u_i, v_i): (_, Vector<Recorded>) = (displacement(i), evaluated.get(i));
        let own = packed.impedance.get(i);
        let (zero, kernel) = (Recorded::zero(), numerics.kernel);
        let strength = Recorded::of(numerics.viscosity_of_shocks);
        let add = |state: [Recorded; 4], pair: &Pair, j: Index| {
            let u_j = displacement(j).map(|part| pair.image.vector(part));
            let x = [0, 1, 2].map(|a| pair.x[a] + ((u_i[0][a] - u_j[0][a]) + (u_i[1][a] - u_j[1][a])));
            let v_j = pair.image.vector(evaluated.get(j));
            let (mut v_dot_x, mut x2) = (zero, zero);
            for a in 0..D {
                v_dot_x += (v_i[a] - v_j[a]) * x[a];
                x2 += x[a] * x[a];
            }
            let (q, inverse_q) = pair.scale.reduced_distance(dot(pair.x, pair.x));
            let weight = -pair.scale.weighted(near.0.volume.high().get(j)).f(kernel.dw_over_q_by(q, inverse_q));
            let closing = closing_rate(v_dot_x, x2, pair.scale.h);
            let push = shock_push(strength, own, packed.impedance.get(j), pair.scale.h, closing);
            let mut sums = ShockSums { acceleration: [state[0], state[1], state[2]], power: state[3] };
            sums.add::<D>(&x, v_dot_x, push, weight);
            [sums.acceleration[0], sums.acceleration[1], sums.acceleration[2], sums.power]
        };
        let factor = momentum_factor(numerics.pair_form, near.1.mass.get(i), near.0.volume.high().get(i));
        if let Some(through) = through {
            let crossing = Crossing::of(bind, model, through, i, place);
            let sum = over_list::<_, D>(bind, model, i, near, [zero; 3], |sum: Vector<Recorded>, pair, j| {
                crossing.add(sum, &pair.image, j, || add([zero; 4], pair, j), |sums| [sums[0], sums[1], sums[2]])
            });
            crossing.set(sum.map(|of| of * factor * near.1.mass.get(i)), true);
            return;
        }
        let sums = over_list::<_, D>(bind, model, i, near, [zero; 4], add);
        let (rates, energy) = (groups::Rates::write(bind), groups::Energy::write(bind));
        for a in 0..3 {
            rates.acceleration.axis(a).set(i, rates.acceleration.axis(a).get(i) + sums[a] * factor);
        }
        let power = sums[3] * factor;
        energy.rate.set(i, energy.rate.get(i) + power);
        energy.viscous_rate.set(i, power);
    })
}
