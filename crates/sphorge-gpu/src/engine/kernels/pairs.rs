//! The pair sums: every particle goes through the cells around its own.

use super::grid::Grid;
use crate::engine::columns::{Binder, Fields, Group, Reading, Recording, recording};
use crate::engine::step_numbers::HALF;
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::kernel::{PairScale, pair_smoothing_length};
use sphorge_physics::pair::{
    ForceSums, GradientSums, PairForce, PairForm, gradient_factor, gradient_weight, inverse_density_mean, mean,
    momentum_factor, momentum_weight, scaled_pressure, stress_vector,
};
use sphorge_physics::stress::{density_after, predicted_density};
use sphorge_physics::viscosity::{ViscosityParameters, switched, viscosity_mu, viscous_pressure};
use sphorge_physics::xsph::{add_xsph, xsph_weight};
use sphorge_physics::{Dimension, Elementary, Numbers, Real, Vector, artificial_stress};

/// The weight of every particle in the gradient sum, of the density half a step ahead.
pub(in crate::engine) fn weigh(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let form = model.numerics.pair_form;
    recording("weigh", count, |bind, i| {
        let (density, gradient, constants) =
            (bind.read(Group::Density), bind.read(Group::Gradient), bind.read(Group::Constants));
        let (weight, step) = (bind.write(Group::Weight), bind.read(Group::Step));
        let half = step.get(0, Index::of(HALF));
        let ahead = predicted_density(density.get(0, i), &gradient.tensor(0, i), half);
        weight.set(0, i, gradient_weight(form, constants.get(0, i), ahead));
        weight.set(2, i, gradient_factor(form, ahead));
    })
}

/// Where pairs are, and how far their kernel reaches.
struct Pair {
    /// `x_i - x_j`, m.
    x: Vector<Recorded>,
    r2: Recorded,
    scale: PairScale<Recorded>,
}

/// Takes a state through every neighbour within the kernel support, the particle itself left out.
fn over_neighbors<S: Numbers<Recorded>, const D: usize>(
    bind: &mut Binder<'_>,
    model: &Model,
    grid: &Grid,
    i: Index,
    (place, constants): (Reading, Reading),
    start: S,
    add: impl FnOnce(S, &Pair, Index) -> S,
) -> S {
    let (starts, sorted, around) =
        (bind.indices(Group::CellStarts), bind.indices(Group::Sorted), bind.indices(Group::Around));
    let kernel = model.numerics.kernel;
    let sigma = Recorded::of(kernel.normalisation(model.dimensions.into()));
    let own = [0, 1, 2].map(|a| place.double(a, 3 + a, i));
    let h = constants.get(1, i);
    let steps = grid.steps(&|axis| own[axis][0]);
    let cells = Index::of((grid.around().len() / 3) as u32);
    bind.scope.fold(Index::of(0), cells, start, |scope, state, k| {
        let there = k * Index::of(3);
        let cell = grid.cell([0, 1, 2].map(|axis| steps[axis] + around.at(there + Index::of(axis as u32))));
        scope.fold(starts.at(cell), starts.at(cell + Index::of(1)), state, |_, state, place_of| {
            let j = sorted.at(place_of);
            let x = [0, 1, 2].map(|a| {
                if a >= D {
                    return Recorded::zero();
                }
                let other = place.double(a, 3 + a, j);
                (own[a][0] - other[0]) + (own[a][1] - other[1])
            });
            let mut r2 = Recorded::zero();
            for c in &x[..D] {
                r2 = c.mul_add(*c, r2);
            }
            let scale = PairScale::new::<D>(sigma, pair_smoothing_length(h, constants.get(1, j)));
            let reach = Recorded::of(kernel.support()) * scale.h;
            let pair = Pair { x, r2, scale };
            // The particle itself is as if out of reach.
            let itself = (j.number() - i.number()).abs();
            let apart = Recorded::select_lt(itself, Recorded::of(0.5), reach * reach, r2);
            Recorded::if_lt(apart, reach * reach, || add(state, &pair, j), || state)
        })
    })
}

/// Velocity gradient and density.
pub(in crate::engine) fn gradients<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    let kernel = model.numerics.kernel;
    recording("gradients", count, |bind, i| {
        let near = (bind.read(Group::Place), bind.read(Group::Constants));
        let (velocity, weight) = (bind.read(Group::Velocity), bind.write(Group::Weight));
        let (gradient, density, step) =
            (bind.write(Group::Gradient), bind.write(Group::Density), bind.read(Group::Step));
        let own = velocity.vector(0, i);
        let start = [Recorded::zero(); 10];
        let sums = over_neighbors::<_, D>(bind, model, grid, i, near, start, |mut state: [Recorded; 10], pair, j| {
            let other = velocity.vector(0, j);
            let v = [0, 1, 2].map(|a| other[a] - own[a]);
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(weight.get(0, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums::zero();
            sums.gradient = [0, 1, 2].map(|a| [state[3 * a], state[3 * a + 1], state[3 * a + 2]]);
            sums.add::<D, false>(&pair.x, &v, f);
            state[..9].copy_from_slice(sums.gradient.as_flattened());
            state[9] += Recorded::one();
            state
        });
        let factor = weight.get(2, i);
        let l = [0, 1, 2].map(|a| [0, 1, 2].map(|b| sums[3 * a + b] * factor));
        gradient.set_all(0, i, l.as_flattened());
        weight.set(1, i, sums[9]);
        let half = step.get(0, Index::of(HALF));
        let rho = density.get(0, i);
        density.set(0, i, density_after(rho, &l, half));
        density.set(1, i, Recorded::zero());
    })
}

/// Acceleration, energy rate, XSPH velocity and the largest `|mu|`.
pub(in crate::engine) fn forces<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    let numerics = &model.numerics;
    let (kernel, form) = (numerics.kernel, numerics.pair_form);
    recording("forces", count, |bind, i| {
        let viscosity = ViscosityParameters {
            alpha: Recorded::of(numerics.viscosity_alpha),
            beta: Recorded::of(numerics.viscosity_beta),
        };
        let near = (bind.read(Group::Place), bind.read(Group::Constants));
        let (evaluated, weight, density) =
            (bind.read(Group::Evaluated), bind.read(Group::Weight), bind.read(Group::Density));
        let packed = bind.read(Group::Packed);
        let (rates, energy) = (bind.write(Group::Rates), bind.write(Group::Energy));
        // The volumes of the gradient sum: both sums are adjoint to the last digit.
        let weight_of = |j: Index| match form {
            PairForm::VolumeWeighted => weight.get(0, j),
            PairForm::DensityWeighted | PairForm::Mixed => momentum_weight(form, near.1.get(0, j), density.get(0, j)),
        };
        let (own, rho) = (evaluated.vector(0, i), density.get(0, i));
        let (stress, repulsion) = (packed.symmetric(0, i), packed.symmetric(6, i));
        let (switch, sound_speed) = (packed.get(12, i), packed.get(13, i));
        let start = [Recorded::zero(); 8];
        let sums = over_neighbors::<_, D>(bind, model, grid, i, near, start, |mut state: [Recorded; 8], pair, j| {
            let other = evaluated.vector(0, j);
            let v = [0, 1, 2].map(|a| own[a] - other[a]);
            let mut v_dot_x = Recorded::zero();
            for a in 0..D {
                v_dot_x = v[a].mul_add(pair.x[a], v_dot_x);
            }
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let w_j = weight_of(j);
            let weighted = pair.scale.weighted(w_j);
            let mu = viscosity_mu(v_dot_x, pair.r2, pair.scale.h);
            let rho_j = density.get(0, j);
            let inverse_density = inverse_density_mean(rho, rho_j);
            let pi = viscous_pressure(viscosity, mu, mean(sound_speed, packed.get(13, j)), inverse_density);
            let mut pi = scaled_pressure(form, pi, rho, rho_j);
            if numerics.balsara {
                pi = switched(pi, switch, packed.get(12, j));
            }
            let w = kernel.w(q);
            let mut artificial = [Recorded::zero(); 3];
            if let Some(terms) = numerics.artificial_stress {
                let factor = artificial_stress::pair_factor(w, terms.exponent);
                artificial = artificial_stress::pair_vector::<_, D>(repulsion, packed.symmetric(6, j), factor, &pair.x);
            }
            let force = PairForce {
                x: pair.x,
                v,
                own_stress: stress_vector::<_, D>(&stress, &pair.x),
                other_stress: stress_vector::<_, D>(&packed.symmetric(0, j), &pair.x),
                artificial_stress: artificial,
                pi,
                weighted_f: weighted.f(kernel.dw_over_q_by(q, inverse_q)),
            };
            let mut sums = ForceSums { acceleration: [state[0], state[1], state[2]], energy_rate: state[3] };
            sums.add::<D>(numerics.energy_split, &force);
            state[..3].copy_from_slice(&sums.acceleration);
            state[3] = sums.energy_rate;
            if numerics.xsph != 0.0 {
                let mut smoothing = [state[4], state[5], state[6]];
                let mass_per_weight = near.1.get(0, j) / w_j;
                let weight = xsph_weight(weighted.value(w), mass_per_weight, inverse_density);
                add_xsph::<_, D>(&mut smoothing, &v, weight);
                state[4..7].copy_from_slice(&smoothing);
            }
            state[7] = state[7].max(mu.abs());
            state
        });
        let factor = momentum_factor(form, near.1.get(0, i), weight_of(i));
        for a in 0..3 {
            rates.set(a, i, sums[a] * factor);
            rates.set(3 + a, i, sums[4 + a] * Recorded::of(numerics.xsph));
        }
        rates.set(6, i, sums[7]);
        energy.set(2, i, sums[3] * factor);
    })
}

/// A kernel of the dimension of a model.
pub(in crate::engine) fn of_dimension(model: &Model, grid: &Grid, count: usize) -> Result<[Recording; 2], KernelFault> {
    Ok(match Dimension::from(model.dimensions) {
        Dimension::One => [gradients::<1>(model, grid, count)?, forces::<1>(model, grid, count)?],
        Dimension::Two => [gradients::<2>(model, grid, count)?, forces::<2>(model, grid, count)?],
        Dimension::Three => [gradients::<3>(model, grid, count)?, forces::<3>(model, grid, count)?],
    })
}
