//! Which densities divide in the pair sums.
//!
//! Velocity gradient, density rate and momentum are the sums
//!
//! `L_i = sum_j g_ij (v_j - v_i) ⊗ grad_i W_ij`,  `drho_i/dt = -rho_i tr L_i`,
//! `dv_i/dt = sum_j f_ij (a_i sigma_i + a_j sigma_j) . grad_i W_ij`.
//!
//! They are *adjoint* if the power of the momentum sum is that of the stress for whatever stress and velocity,
//! `sum_i m_i v_i . dv_i/dt = - sum_i (m_i/rho_i) sigma_i : L_i`: only then is the work done by pair forces the integral of
//! `sigma : D`, and an energy account can close. Linear momentum is conserved by all three forms.
//!
//! | form | `g_ij` | `f_ij` | `a` | adjoint |
//! |---|---|---|---|---|
//! | volume-weighted | `m_j/rho_j` | `m_j/(rho_i rho_j)` | 1 | yes |
//! | density-weighted | `m_j/rho_i` | `m_j` | `1/rho^2` | yes |
//! | mixed | `m_j/rho_j` | `m_j` | `1/rho^2` | no |
//!
//! The first stands in Fraser Eq 4 and 6, the second in Monaghan 1992, the third in Patiño et al. Eq 8, 9 and 22. Patiño et
//! al. Eq 8 prints `v_j - v_i` in the density rate: it is `v_i - v_j`.
//!
//! Energy: each particle gets its own stress work, `de_i/dt = (1/m_i) (m_i/rho_i) sigma_i : L_i` with an adjoint form, and
//! half of what artificial viscosity and artificial stress take from the pair. Patiño et al. Eq 10 is the other split, half of
//! the whole pair power to each; as printed, with a symmetrised product, it is twice too large.

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

impl PairForm {
    /// Every form.
    pub const ALL: &'static [Self] = &[Self::VolumeWeighted, Self::DensityWeighted, Self::Mixed];

    /// Name in a deck.
    pub const fn key(self) -> &'static str {
        match self {
            Self::VolumeWeighted => "volume-weighted",
            Self::DensityWeighted => "density-weighted",
            Self::Mixed => "mixed",
        }
    }

    /// The form of that name in a deck.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|form| form.key() == key)
    }

    /// Whether the work of the pair forces is the integral of `sigma : D`.
    pub const fn is_adjoint(self) -> bool {
        !matches!(self, Self::Mixed)
    }
}

/// `g_ij`, m^d: the weight of `(v_j - v_i) ⊗ grad_i W_ij` in the velocity gradient.
#[inline(always)]
pub fn gradient_weight<T: Real>(form: PairForm, m_j: T, rho_i: T, rho_j: T) -> T {
    match form {
        PairForm::VolumeWeighted | PairForm::Mixed => m_j / rho_j,
        PairForm::DensityWeighted => m_j / rho_i,
    }
}

/// `a`: what a particle's stress is multiplied by, once per particle, before the momentum sum.
#[inline(always)]
pub fn stress_scale<T: Real>(form: PairForm, rho: T) -> T {
    match form {
        PairForm::VolumeWeighted => T::one(),
        PairForm::DensityWeighted | PairForm::Mixed => T::one() / (rho * rho),
    }
}

/// `f_ij`: the weight of the sum of the two scaled stresses in the momentum sum.
#[inline(always)]
pub fn momentum_weight<T: Real>(form: PairForm, m_j: T, rho_i: T, rho_j: T) -> T {
    match form {
        PairForm::VolumeWeighted => m_j / (rho_i * rho_j),
        PairForm::DensityWeighted | PairForm::Mixed => m_j,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::{dot, zero};
    use crate::test_cloud::{Cloud, DIMENSIONS, Noise};
    use crate::{SymmetricTensor, Tensor, Vector};

    /// Power of the pair forces and of the stress, and the sum of forces, of a cloud with noise for all its fields.
    fn sums(form: PairForm, cloud: &Cloud) -> (f64, f64, Vector<f64>) {
        let n = cloud.count();
        let mut noise = Noise::new(11);
        let rho: Vec<f64> = (0..n).map(|_| 5.0 + 3.0 * noise.next()).collect();
        let mass: Vec<f64> = (0..n).map(|i| cloud.volume[i] * rho[i]).collect();
        let v: Vec<Vector<f64>> = (0..n).map(|_| core::array::from_fn(|_| noise.next())).collect();
        let sigma: Vec<SymmetricTensor<f64>> =
            (0..n).map(|_| SymmetricTensor::from_array(core::array::from_fn(|_| noise.next()))).collect();
        let (mut force_power, mut stress_power, mut total) = (0.0, 0.0, [0.0; 3]);
        for i in 0..n {
            let mut l: Tensor<f64> = zero();
            let mut acceleration = [0.0; 3];
            for j in (0..n).filter(|&j| j != i) {
                let grad_w = cloud.grad_w(i, j);
                let g = gradient_weight(form, mass[j], rho[i], rho[j]);
                let f = momentum_weight(form, mass[j], rho[i], rho[j]);
                let stress = sigma[i] * stress_scale(form, rho[i]) + sigma[j] * stress_scale(form, rho[j]);
                let traction = stress.dot(grad_w);
                for a in 0..3 {
                    acceleration[a] += f * traction[a];
                    for b in 0..3 {
                        l[a][b] += g * (v[j][a] - v[i][a]) * grad_w[b];
                    }
                }
            }
            force_power += mass[i] * dot(v[i], acceleration);
            stress_power += mass[i] / rho[i] * sigma[i].double_dot(SymmetricTensor::symmetric_part(&l));
            for a in 0..3 {
                total[a] += mass[i] * acceleration[a];
            }
        }
        (force_power, stress_power, total)
    }

    #[test]
    fn adjoint_forms_do_exactly_the_work_of_the_stress() {
        for dimension in DIMENSIONS {
            let cloud = Cloud::few(dimension);
            for &form in PairForm::ALL {
                let (force, stress, _) = sums(form, &cloud);
                let gap = (force + stress).abs() / stress.abs();
                if form.is_adjoint() {
                    assert!(gap < 1e-13, "{form:?} {dimension:?}: {gap}");
                } else {
                    assert!(gap > 1e-2, "{form:?} {dimension:?}: {gap}");
                }
            }
        }
    }

    #[test]
    fn linear_momentum_is_conserved_by_every_form() {
        for dimension in DIMENSIONS {
            for &form in PairForm::ALL {
                let (_, stress, total) = sums(form, &Cloud::few(dimension));
                assert!(dot(total, total).sqrt() < 1e-14 * (1.0 + stress.abs()), "{form:?} {dimension:?}: {total:?}");
            }
        }
    }

    #[test]
    fn weights_by_hand() {
        use PairForm::{DensityWeighted, Mixed, VolumeWeighted};
        let weights = |form| {
            (gradient_weight(form, 6.0, 2.0, 4.0), momentum_weight(form, 6.0, 2.0, 4.0), stress_scale(form, 2.0f64))
        };
        assert_eq!(weights(VolumeWeighted), (1.5, 0.75, 1.0));
        assert_eq!(weights(DensityWeighted), (3.0, 6.0, 0.25));
        assert_eq!(weights(Mixed), (1.5, 6.0, 0.25));
        for &form in PairForm::ALL {
            assert_eq!(PairForm::from_key(form.key()), Some(form));
        }
    }
}
