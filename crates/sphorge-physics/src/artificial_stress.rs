//! Artificial stress against the tensile instability.
//!
//! Particles in tension clump in pairs. Gray, Monaghan & Swift 2001 add to
//! the pair stress a repulsion `R_ij f^n`, `f = W(r_ij)/W(spacing)` (Fraser Eq 15-17), with `R_ij = R_i/rho_i^2 +
//! R_j/rho_j^2` and, in the principal frame of `sigma_i`, `R_i = -eps sigma_i` for each positive principal stress, rotated
//! back. Fraser Eq 18 leaves out the density and the principal frame. `eps = 0.3`; `n = 4` in Gray, 6 in Fraser.
//!
//! Bodies may differ in their smoothing length over spacing. Each particle's tensor is over the `W(spacing)^n` of its own body, so
//! `W(r_ij)^n` is all a pair adds.

use crate::pair::stress_vector;
use crate::tensile_part::tensile_part;
use crate::{Dimension, Real, SymmetricTensor, Vector};

/// `eps/w(spacing/h)^n`, the coefficient of particles whose neighbours at one spacing have the shape `w` of the kernel.
#[inline(always)]
pub fn coefficient<T: Real>(epsilon: T, w_spacing: T, exponent: u32) -> T {
    epsilon / w_spacing.powu(exponent)
}

/// `R_i/w(spacing/h)^n` in Pa, before division by the square of the density, with the [`coefficient`] of the particle; never tensile.
///
/// Only directions the case computes in take part: in plane strain the in-plane principal frame, so `R_zz = 0`; in one
/// dimension `xx` alone.
#[inline(always)]
pub fn artificial_stress<T: Real>(
    sigma: SymmetricTensor<T>,
    coefficient: T,
    dimension: Dimension,
) -> SymmetricTensor<T> {
    tensile_part(sigma, dimension) * -coefficient
}

/// `w(r_ij/h)^n`: how strongly a pair feels the artificial stresses of its particles.
#[inline(always)]
pub fn pair_factor<T: Real>(w_ij: T, exponent: u32) -> T {
    w_ij.powu(exponent)
}

/// `R_ij f^n . x_ij` along the `D` axes computed in, with `R_ij` the sum of both particles' tensors, which are scaled as their
/// stresses are, and the [`pair_factor`].
#[inline(always)]
pub fn pair_vector<T: Real, const D: usize>(
    r_i: SymmetricTensor<T>,
    r_j: SymmetricTensor<T>,
    factor: T,
    x_ij: &Vector<T>,
) -> Vector<T> {
    let mut vector = stress_vector::<T, D>(&(r_i + r_j), x_ij);
    for a in 0..D {
        vector[a] = vector[a] * factor;
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(a: SymmetricTensor<f64>, b: SymmetricTensor<f64>, tolerance: f64) {
        for (x, y) in a.to_array().iter().zip(b.to_array()) {
            assert!((x - y).abs() <= tolerance, "{a:?} {b:?}");
        }
    }

    #[test]
    fn turned_uniaxial_tension_by_hand() {
        // 100 MPa along (0.6, 0.8, 0), eps 0.3: R = -30 MPa n n^T, components 0.36, 0.64, 0.48.
        let sigma = SymmetricTensor { xx: 36.0e6, yy: 64.0e6, xy: 48.0e6, ..SymmetricTensor::zero() };
        let want = SymmetricTensor { xx: -10.8e6, yy: -19.2e6, xy: -14.4e6, ..SymmetricTensor::zero() };
        assert_near(artificial_stress(sigma, 0.3, Dimension::Two), want, 1e-6);
        assert_near(artificial_stress(sigma, 0.3, Dimension::Three), want, 1e-6);
        // 50 MPa along (2, -1, 2)/3, eps 0.2: -10 MPa/9 times 4, 1, 4, -2, -2, 4.
        let along = |s: f64| SymmetricTensor { xx: 4.0, yy: 1.0, zz: 4.0, xy: -2.0, yz: -2.0, xz: 4.0 } * (s / 9.0);
        assert_near(artificial_stress(along(50.0e6), 0.2, Dimension::Three), along(-10.0e6), 1e-6);
    }

    #[test]
    fn tension_in_one_direction_and_compression_in_the_other() {
        // Pure shear 80 MPa in the plane: +80 along (1, 1)/sqrt(2) gives -12 MPa in each component with eps 0.3.
        let sigma = SymmetricTensor { xy: 80.0e6, ..SymmetricTensor::zero() };
        let want = SymmetricTensor { xx: -12.0e6, yy: -12.0e6, xy: -12.0e6, ..SymmetricTensor::zero() };
        assert_near(artificial_stress(sigma, 0.3, Dimension::Two), want, 1e-6);
    }

    #[test]
    fn compression_has_none_and_axes_not_computed_in_take_no_part() {
        let compressed = SymmetricTensor { xx: -3.0, yy: -2.0, zz: -4.0, xy: 1.0, yz: -0.5, xz: 0.4 };
        for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
            assert_eq!(artificial_stress(compressed, 0.3, dimension), SymmetricTensor::zero());
        }
        let out_of_plane = SymmetricTensor::diagonal(-1.0, -1.0, 5.0);
        assert_eq!(artificial_stress(out_of_plane, 0.3, Dimension::Two), SymmetricTensor::zero());
        assert_eq!(artificial_stress(out_of_plane, 0.3, Dimension::Three), SymmetricTensor::diagonal(0.0, 0.0, -1.5));
        // Compression along x alone: two tensile directions leave the determinant negative.
        let two = artificial_stress(SymmetricTensor::diagonal(-1.0, 2.0, 4.0), 0.5, Dimension::Three);
        assert_near(two, SymmetricTensor::diagonal(0.0, -1.0, -2.0), 1e-15);
        let in_plane = artificial_stress(SymmetricTensor::diagonal(-1.0, 2.0, 4.0), 0.5, Dimension::Two);
        assert_eq!(in_plane, SymmetricTensor::diagonal(0.0, -1.0, 0.0));
        let lateral = SymmetricTensor { xx: 2.0, yy: 7.0, xy: 1.0, ..SymmetricTensor::zero() };
        assert_eq!(artificial_stress(lateral, 0.5, Dimension::One), SymmetricTensor::diagonal(-1.0, 0.0, 0.0));
    }

    #[test]
    fn pair_factor_by_hand() {
        // 0.3 (3/2)^4; 0.2 (0.5/0.25)^3.
        assert_eq!(pair_factor(3.0f64, 4) * coefficient(0.3, 2.0, 4), 0.3 * 5.0625);
        assert_eq!(pair_factor(0.5f64, 3) * coefficient(0.2, 0.25, 3), 1.6);
        assert_eq!(pair_factor(0.0f64, 6), 0.0);
        // (2 + 4, -1 + 3) . (5, -2) = 26 with the shear 2, times 0.5; yy -3: 10 + 6 = 16.
        let (r_i, r_j) = (
            SymmetricTensor { xy: -1.0, ..SymmetricTensor::diagonal(2.0, -3.0, 9.0) },
            SymmetricTensor { xx: 4.0, xy: 3.0, ..SymmetricTensor::zero() },
        );
        assert_eq!(pair_vector::<f64, 2>(r_i, r_j, 0.5, &[5.0, -2.0, 7.0]), [13.0, 8.0, 0.0]);
        assert_eq!(pair_vector::<f64, 1>(r_i, r_j, 2.0, &[5.0, -2.0, 7.0]), [60.0, 0.0, 0.0]);
    }
}
