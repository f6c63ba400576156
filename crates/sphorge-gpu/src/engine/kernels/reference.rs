//! The reference configuration of the total Lagrangian form: its lists, made once, and what deforms it.

use super::grid::Grid;
use super::images::Planes;
use super::neighbors::{over_list, over_own_body};
use crate::engine::columns::{Fields, Group, Recording, recording};
use crate::engine::step_numbers::DT;
use crate::record::{Double, Index, KernelFault, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;
use sphorge_physics::gradient_correction::{LARGEST_COMPONENT, corrected, gradient_correction};
use sphorge_physics::pair::GradientSums;
use sphorge_physics::total_lagrangian::{density, smallest_stretch, stretched, velocity_gradient};
use sphorge_physics::viscosity::bulk_mu;

/// Number of the neighbours of every particle.
pub(in crate::engine) fn count<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("count_neighbors", count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let weight = bind.write(Group::Weight);
        let zero = Recorded::zero();
        let sum = over_own_body::<_, D>(bind, model, grid, i, near, zero, |sum: Recorded, _, _| sum + Recorded::one());
        weight.set(1, i, sum);
    })
}

/// The list of every particle, from its place on.
pub(in crate::engine) fn list<const D: usize>(
    model: &Model,
    grid: &Grid,
    count: usize,
) -> Result<Recording, KernelFault> {
    recording("list_neighbors", count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (starts, list) = (bind.indices(Group::ListStarts), bind.index_output(Group::List));
        let first = starts.at(i);
        over_own_body::<_, D>(bind, model, grid, i, near, Recorded::zero(), |before: Recorded, pair, j| {
            list.set(first + Index::floor(before), Planes::entry_of(pair.bits, j));
            before + Recorded::one()
        });
    })
}

/// The gradient correction of every particle.
pub(in crate::engine) fn correct<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let kernel = model.numerics.kernel;
    recording("correct_reference", count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let correction = bind.write(Group::Correction);
        let zero = [[Recorded::zero(); 3]; 3];
        let moment = over_list::<_, D>(bind, model, i, near, zero, |moment: [[Recorded; 3]; 3], pair, j| {
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { moment, ..GradientSums::zero() };
            sums.add::<D, true>(&pair.x, &[Recorded::zero(); 3], f);
            sums.moment
        });
        let b = gradient_correction(&moment, model.dimensions.into(), Recorded::of(LARGEST_COMPONENT));
        correction.set_all(0, i, b.as_flattened());
    })
}

/// Deformation gradient, velocity gradient and density.
pub(in crate::engine) fn deform<const D: usize>(
    model: &Model,
    renewal: Option<f64>,
    count: usize,
) -> Result<Recording, KernelFault> {
    let kernel = model.numerics.kernel;
    recording("deform", count, |bind, i| {
        let near = (bind.read(Group::Reference), bind.read(Group::Constants));
        let (velocity, correction) = (bind.read(Group::Velocity), bind.read(Group::Correction));
        let (gradient, of_density) = (bind.write(Group::Gradient), bind.write(Group::Density));
        let (deformation, stretch) = (bind.write(Group::Deformation), bind.write(Group::Stretch));
        let (rates, step) = (bind.write(Group::Rates), bind.read(Group::Step));
        let own = velocity.vector(0, i);
        let zero = [[Recorded::zero(); 3]; 3];
        let sum = over_list::<_, D>(bind, model, i, near, zero, |gradient: [[Recorded; 3]; 3], pair, j| {
            let other = pair.image.vector(velocity.vector(0, j));
            let (q, inverse_q) = pair.scale.reduced_distance(pair.r2);
            let f = pair.scale.weighted(near.0.get(6, j)).f(kernel.dw_over_q_by(q, inverse_q));
            let mut sums = GradientSums { gradient, ..GradientSums::zero() };
            sums.add::<D, false>(&pair.x, &[0, 1, 2].map(|a| other[a] - own[a]), f);
            sums.gradient
        });
        let dt = step.get(0, Index::of(DT));
        let rate = corrected(&sum, &correction.tensor(0, i));
        let l = velocity_gradient(&deformation.tensor(0, i), &rate, dt);
        for (k, rate) in rate.into_iter().flatten().enumerate() {
            deformation.add(k, 9 + k, i, dt * rate);
        }
        let f = deformation.tensor(0, i);
        let smallest = smallest_stretch(&f);
        gradient.set_all(0, i, l.as_flattened());
        let double = |a: usize, b: usize| Double::new(deformation.double(3 * a + b, 9 + 3 * a + b, i));
        let whole = [0, 1, 2].map(|a| [0, 1, 2].map(|b| double(a, b)));
        let rho = density(Double::from(near.1.get(0, i)), Double::new(near.0.double(6, 7, i)), &whole);
        of_density.set_all(0, i, &[rho.high, rho.low]);
        stretch.set(0, i, smallest);
        stretch.set(2, i, renewal.map_or_else(Recorded::zero, |bound| stretched(&f, Recorded::of(bound))));
        rates.set(6, i, bulk_mu(&l, near.1.get(1, i) * smallest));
    })
}
