//! Which densities divide in the pair sums.
//!
//! Velocity gradient, density rate and momentum are the sums
//!
//! `L_i = g_i sum_j w_j (v_j - v_i) ⊗ grad_i W_ij`,  `drho_i/dt = -rho_i tr L_i`,
//! `dv_i/dt = f_i sum_j w'_j (a_i sigma_i + a_j sigma_j) . grad_i W_ij`,
//!
//! with weights `w`, `w'` and scales `a` that each particle has for itself, so that a pair costs no division, and factors `g`, `f`
//! of the whole sum.
//!
//! They are *adjoint* if the power of the momentum sum is that of the stress for whatever stress and velocity,
//! `sum_i m_i v_i . dv_i/dt = - sum_i (m_i/rho_i) sigma_i : L_i`: only then is the work done by pair forces the integral of
//! `sigma : D`, and an energy account can close. Linear momentum is conserved by all three forms.
//!
//! | form | `w_j` | `g_i` | `w'_j` | `f_i` | `a` | adjoint |
//! |---|---|---|---|---|---|---|
//! | volume-weighted | `m_j/rho_j` | 1 | `m_j/rho_j` | `1/rho_i` | 1 | yes |
//! | density-weighted | `m_j` | `1/rho_i` | `m_j` | 1 | `1/rho^2` | yes |
//! | mixed | `m_j/rho_j` | 1 | `m_j` | 1 | `1/rho^2` | no |
//!
//! The first stands in Fraser Eq 4 and 6, the second in Monaghan 1992, the third in Patiño et al. Eq 8, 9 and 22. Patiño et
//! al. Eq 8 prints `v_j - v_i` in the density rate: it is `v_i - v_j`.
//!
//! [`GradientSums`] and [`ForceSums`] add up the pairs. Engines gather what a pair needs, add it, and multiply by the factor of the
//! sum.

mod force_sums;
mod gradient_sums;

pub use force_sums::{
    EnergySplit, ForceSums, PairForce, closing_power, corrected_stress_vector, share_of_power, stress_vector,
};
pub use gradient_sums::GradientSums;

use crate::Real;

/// Which densities divide in the pair sums.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PairForm {
    /// Gradient by volume, force `(sigma_i + sigma_j)/(rho_i rho_j)`; adjoint, and right across jumps of density.
    #[default]
    VolumeWeighted,
    /// Gradient by the particle's own density, force `sigma_i/rho_i^2 + sigma_j/rho_j^2`; adjoint.
    DensityWeighted,
    /// Gradient of the first with the force of the second, as Patiño et al. print; not adjoint.
    Mixed,
}

/// `w_j`, m^d or kg: the weight of a neighbour of that mass (kg) and density (kg/m^3) in the velocity gradient.
#[inline(always)]
pub fn gradient_weight<T: Real>(form: PairForm, mass: T, density: T) -> T {
    match form {
        PairForm::VolumeWeighted | PairForm::Mixed => mass / density,
        PairForm::DensityWeighted => mass,
    }
}

/// `g_i`: the factor of the whole sum of the velocity gradient of a particle of that density (kg/m^3), 1 or m^3/kg.
#[inline(always)]
pub fn gradient_factor<T: Real>(form: PairForm, density: T) -> T {
    match form {
        PairForm::VolumeWeighted | PairForm::Mixed => T::one(),
        PairForm::DensityWeighted => T::one() / density,
    }
}

/// `a`: what a particle's stress is multiplied by, once per particle, before the momentum sum, 1 or m^6/kg^2.
#[inline(always)]
pub fn stress_scale<T: Real>(form: PairForm, density: T) -> T {
    match form {
        PairForm::VolumeWeighted => T::one(),
        PairForm::DensityWeighted | PairForm::Mixed => T::one() / (density * density),
    }
}

/// `w'_j`, m^d or kg: the weight of a neighbour of that mass (kg) and density (kg/m^3) in the momentum sum.
#[inline(always)]
pub fn momentum_weight<T: Real>(form: PairForm, mass: T, density: T) -> T {
    match form {
        PairForm::VolumeWeighted => mass / density,
        PairForm::DensityWeighted | PairForm::Mixed => mass,
    }
}

/// `f_i`: the factor of the whole momentum sum of a particle, 1 or m^3/kg. `1/rho_i` is taken as the particle's own `weight` over its
/// mass: with the weight as its neighbours see it, rounded or corrected, forces are opposite to the last digit.
#[inline(always)]
pub fn momentum_factor<T: Real>(form: PairForm, mass: T, weight: T) -> T {
    match form {
        PairForm::VolumeWeighted => weight / mass,
        PairForm::DensityWeighted | PairForm::Mixed => T::one(),
    }
}

/// A pressure over density squared (Pa m^6/kg^2), such as `Pi_ij`, in the unit the scaled stresses of the form have: Pa for stresses
/// that are not scaled.
#[inline(always)]
pub fn scaled_pressure<T: Real>(form: PairForm, pi: T, rho_i: T, rho_j: T) -> T {
    match form {
        PairForm::VolumeWeighted => pi * rho_i * rho_j,
        PairForm::DensityWeighted | PairForm::Mixed => pi,
    }
}

/// The mean of the values of the two particles of a pair.
#[inline(always)]
pub fn mean<T: Real>(a: T, b: T) -> T {
    (a + b) * T::of(0.5)
}

/// The inverse of the mean density of a pair, m^3/kg.
#[inline(always)]
pub fn inverse_density_mean<T: Real>(rho_i: T, rho_j: T) -> T {
    T::of(2.0) / (rho_i + rho_j)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{Kernel, PairScale};
    use crate::tensor::dot;
    use crate::test_cloud::{Cloud, DIMENSIONS, FORMS, Noise};
    use crate::{Dimension, SymmetricTensor, Vector};

    /// Sums over a cloud with noise for all its fields.
    struct Totals {
        /// Power of the pair forces, W.
        force_power: f64,
        /// Power of the stress, `sum (m/rho) sigma : L`, W.
        stress_power: f64,
        /// Rate of the internal energy, W.
        energy_rate: f64,
        /// Sum of all forces, N.
        force: Vector<f64>,
    }

    fn totals(form: PairForm, split: EnergySplit, artificial: f64, cloud: &Cloud) -> Totals {
        match cloud.dimension {
            Dimension::One => totals_in::<1>(form, split, artificial, cloud),
            Dimension::Two => totals_in::<2>(form, split, artificial, cloud),
            Dimension::Three => totals_in::<3>(form, split, artificial, cloud),
        }
    }

    /// As a sweep adds them up; `artificial` is the size of artificial stress and viscosity.
    fn totals_in<const D: usize>(form: PairForm, split: EnergySplit, artificial: f64, cloud: &Cloud) -> Totals {
        let n = cloud.count();
        let mut noise = Noise::new(11);
        let rho: Vec<f64> = (0..n).map(|_| 5.0 + 3.0 * noise.next()).collect();
        let mass: Vec<f64> = (0..n).map(|i| cloud.volume[i] * rho[i]).collect();
        let v: Vec<Vector<f64>> =
            (0..n).map(|_| core::array::from_fn(|a| if a < D { noise.next() } else { 0.0 })).collect();
        let sigma: Vec<SymmetricTensor<f64>> =
            (0..n).map(|_| SymmetricTensor::from_array(core::array::from_fn(|_| noise.next()))).collect();
        let scaled: Vec<_> = (0..n).map(|i| sigma[i] * stress_scale(form, rho[i])).collect();
        let weight: Vec<_> = (0..n).map(|i| momentum_weight(form, mass[i], rho[i])).collect();
        let kernel = Kernel::CubicSpline;
        let scale = PairScale::new::<D>(kernel.normalisation(cloud.dimension), cloud.h);
        let mut totals = Totals { force_power: 0.0, stress_power: 0.0, energy_rate: 0.0, force: [0.0; 3] };
        for i in 0..n {
            let (mut gradients, mut forces) = (GradientSums::zero(), ForceSums::zero());
            for j in (0..n).filter(|&j| j != i) {
                let x = cloud.x_ij(i, j);
                let (q, inverse_q) = scale.reduced_distance(dot(x, x));
                let dw_over_q = kernel.dw_over_q_by(q, inverse_q);
                let v_ij: Vector<f64> = core::array::from_fn(|a| v[i][a] - v[j][a]);
                let f = scale.weighted(gradient_weight(form, mass[j], rho[j])).f(dw_over_q);
                gradients.add::<D, false>(&x, &v_ij.map(|c| -c), f);
                let r = (sigma[i] + sigma[j]) * artificial;
                let weighted_f = scale.weighted(weight[j]).f(dw_over_q);
                let pair = PairForce {
                    x,
                    v: v_ij,
                    own_stress: stress_vector::<_, D>(&scaled[i], &x),
                    other_stress: stress_vector::<_, D>(&scaled[j], &x),
                    artificial_stress: stress_vector::<_, D>(&r, &x),
                    pi: scaled_pressure(form, 0.3 * artificial, rho[i], rho[j]),
                    weighted_f,
                    closing_power: closing_power(dot(v_ij, x), weighted_f),
                };
                forces.add::<D>(split, &pair);
            }
            let l = gradients.gradient.map(|row| row.map(|c| c * gradient_factor(form, rho[i])));
            let m = mass[i] * momentum_factor(form, mass[i], weight[i]);
            totals.force_power += m * dot(v[i], forces.acceleration);
            totals.stress_power += mass[i] / rho[i] * sigma[i].double_dot(SymmetricTensor::symmetric_part(&l));
            totals.energy_rate += m * forces.energy_rate();
            for a in 0..3 {
                totals.force[a] += m * forces.acceleration[a];
            }
        }
        totals
    }

    const SPLITS: [EnergySplit; 2] = [EnergySplit::OwnStress, EnergySplit::Symmetric];

    #[test]
    fn adjoint_forms_do_exactly_the_work_of_the_stress() {
        for dimension in DIMENSIONS {
            let cloud = Cloud::few(dimension);
            for form in FORMS {
                let sums = totals(form, EnergySplit::OwnStress, 0.0, &cloud);
                let gap = (sums.force_power + sums.stress_power).abs() / sums.stress_power.abs();
                match form {
                    PairForm::VolumeWeighted | PairForm::DensityWeighted => {
                        assert!(gap < 1e-12, "{form:?} {dimension:?}: {gap}");
                    }
                    PairForm::Mixed => assert!(gap > 1e-2, "{form:?} {dimension:?}: {gap}"),
                }
            }
        }
    }

    #[test]
    fn energy_gains_what_forces_do_whatever_the_form_and_the_split() {
        for dimension in DIMENSIONS {
            let cloud = Cloud::few(dimension);
            for (form, split) in FORMS.into_iter().flat_map(|form| SPLITS.map(|split| (form, split))) {
                for artificial in [0.0, 2.0] {
                    let sums = totals(form, split, artificial, &cloud);
                    let gap = (sums.force_power + sums.energy_rate).abs() / sums.energy_rate.abs();
                    assert!(gap < 1e-12, "{form:?} {split:?} {dimension:?}: {gap}");
                }
            }
        }
    }

    #[test]
    fn linear_momentum_is_conserved_by_every_form() {
        for dimension in DIMENSIONS {
            for form in FORMS {
                let sums = totals(form, EnergySplit::OwnStress, 2.0, &Cloud::few(dimension));
                let size = 1.0 + sums.stress_power.abs();
                assert!(dot(sums.force, sums.force).sqrt() < 1e-13 * size, "{form:?} {dimension:?}: {:?}", sums.force);
            }
        }
    }

    #[test]
    fn weights_by_hand() {
        use PairForm::{DensityWeighted, Mixed, VolumeWeighted};
        let gradient = |form, rho| (gradient_weight(form, 6.0, rho), gradient_factor(form, rho));
        let momentum = |form, rho| {
            let weight = momentum_weight(form, 6.0, rho);
            (weight, momentum_factor(form, 6.0, weight), stress_scale::<f64>(form, rho))
        };
        assert_eq!((gradient(VolumeWeighted, 4.0), gradient(VolumeWeighted, 2.0)), ((1.5, 1.0), (3.0, 1.0)));
        assert_eq!((gradient(Mixed, 4.0), gradient(Mixed, 2.0)), ((1.5, 1.0), (3.0, 1.0)));
        assert_eq!((gradient(DensityWeighted, 4.0), gradient(DensityWeighted, 2.0)), ((6.0, 0.25), (6.0, 0.5)));
        assert_eq!(momentum(VolumeWeighted, 4.0), (1.5, 0.25, 1.0));
        assert_eq!(momentum(VolumeWeighted, 2.0), (3.0, 0.5, 1.0));
        for form in [DensityWeighted, Mixed] {
            assert_eq!((momentum(form, 4.0), momentum(form, 2.0)), ((6.0, 1.0, 0.0625), (6.0, 1.0, 0.25)));
            assert_eq!(scaled_pressure(form, 3.0, 2.0, 4.0), 3.0);
        }
        assert_eq!(scaled_pressure(VolumeWeighted, 3.0, 2.0, 4.0), 24.0);
        assert_eq!((mean(2.0, 5.0), inverse_density_mean(2.0, 6.0)), (3.5, 0.25));
    }
}
