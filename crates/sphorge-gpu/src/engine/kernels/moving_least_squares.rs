//! Density restoration by moving least squares.

use super::neighbors::{different, over_present_neighbors};
use crate::engine::columns::{Group, ReadColumns, ReadShared, Recording, WriteColumns, groups, recording};
use crate::record::{Index, KernelFault, Recorded};
use sphorge_engine::model::{Integrator, Model};
use sphorge_physics::kernel::PairScale;
use sphorge_physics::moving_least_squares::{Coefficients, Moments};
use sphorge_physics::stress::density_after;
use sphorge_physics::{Elementary, Real, SymmetricTensor, Vector};

/// The moments of a neighbourhood as a state.
fn state(moments: &Moments<Recorded>) -> [Recorded; 10] {
    let Moments { zeroth, first: [x, y, z], second } = *moments;
    let [xx, yy, zz, xy, yz, xz] = second.to_array();
    [zeroth, x, y, z, xx, yy, zz, xy, yz, xz]
}

fn moments([zeroth, x, y, z, xx, yy, zz, xy, yz, xz]: [Recorded; 10]) -> Moments<Recorded> {
    Moments { zeroth, first: [x, y, z], second: SymmetricTensor::from_array([xx, yy, zz, xy, yz, xz]) }
}

/// The density of every particle from its neighbours of the same body; its own density if they do not span the space.
pub(in crate::engine) fn estimate<const D: usize>(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    let (kernel, dimension) = (model.numerics.kernel, model.dimensions.into());
    recording("estimate_density", count, |bind, i| {
        let near = (groups::Place::read(bind).position, groups::Constants::read(bind));
        let (density, restored) = (groups::Density::read(bind).density, groups::Restored::write(bind).density);
        let bodies = (model.bodies.len() > 1).then(|| bind.indices(Group::Body));
        let (zero, half) = (Recorded::zero(), Recorded::of(0.5));
        // The particle itself is in its own body.
        let other = |j: Index| bodies.map_or(zero, |of| different(of, i, j));
        let value = |scale: PairScale<Recorded>, r2: Recorded| scale.value(kernel.w(scale.reduced_distance(r2).0));
        let volume = |j: Index| near.1.mass.get(j) / density.high().get(j);
        let sigma = Recorded::of(kernel.normalisation(dimension));
        let (h, origin): (_, Vector<Recorded>) = (near.1.smoothing_length.get(i), [zero; 3]);
        let itself = value(PairScale::new::<D>(sigma, h), zero);
        let mut start = Moments::default();
        start.add(origin, volume(i) * itself);
        let all =
            over_present_neighbors::<_, D>(bind, model, i, near, state(&start), |sums: [Recorded; 10], pair, j| {
                let add = || {
                    let mut sums = moments(sums);
                    sums.add(pair.x, volume(j) * value(pair.scale, pair.r2));
                    state(&sums)
                };
                Recorded::if_lt(other(j), half, add, || sums)
            });
        let [constant, x, y, z, is_one] = moments(all).coefficients(h, dimension);
        let beta = Coefficients { constant, linear: [x, y, z] };
        let start = near.1.mass.get(i) * beta.factor(origin) * itself;
        let sum = over_present_neighbors::<_, D>(bind, model, i, near, start, |sum: Recorded, pair, j| {
            let mass = near.1.mass.get(j);
            let add = || sum + mass * beta.factor(pair.x) * value(pair.scale, pair.r2);
            Recorded::if_lt(other(j), half, add, || sum)
        });
        let own = density.high().get(i);
        let estimate = Recorded::select_lt(zero, sum, sum, own);
        restored.set(i, Recorded::select_lt(half, is_one, estimate, own));
    })
}

/// Applies the densities.
pub(in crate::engine) fn restore(model: &Model, count: usize) -> Result<Recording, KernelFault> {
    recording("restore_density", count, |bind, i| {
        let (density, restored) = (groups::Density::write(bind).density, groups::Restored::read(bind).density);
        let (pressure, constants) = (groups::Pressure::read(bind), groups::Constants::read(bind));
        let accounts = groups::Accounts::write(bind);
        let (old, rho) = (density.get(i), restored.get(i));
        let gained = (rho - old[0]) - old[1];
        // The work that the corresponding volume change would do.
        let energy = constants.mass.get(i) * pressure.pressure.get(i) * gained / (rho * old[0]);
        accounts.moving_least_squares.add(i, energy);
        density.set(i, [rho, Recorded::zero()]);
        if model.numerics.integrator == Integrator::PredictorCorrector {
            // The corrector starts from the beginning of the step.
            let (gradient, step) = (groups::Gradient::read(bind).velocity_gradient, groups::Step::shared(bind));
            let before = density_after(rho, &gradient.get(i), -step.half.value());
            groups::BaseDensity::write(bind).density.set(i, [before, Recorded::zero()]);
        }
    })
}
