//! Correction that makes kernel gradients exact for linear fields (Randles & Libersky 1996; Bonet & Lok 1999).
//!
//! With `M_i = sum_j V_j (x_j - x_i) ⊗ grad_i W_ij`, `B_i = M_i^-1`, the gradient `L_i B_i` of
//! `L_i = sum_j V_j (v_j - v_i) ⊗ grad_i W_ij` is exact where `v` is linear in space. `M` and `B` are symmetric as long as
//! `grad W` lies along the line of the pair. The adjoint force is `m_j (sigma_i B_i + sigma_j B_j) grad_i W_ij / (rho_i rho_j)`.

use crate::tensor::{determinant, identity, inverse, multiply, transpose};
use crate::{Dimension, Elementary, Real, Tensor};

/// Largest component of a correction, usually. A particle in the corner of a block, an eighth of a neighbourhood, needs about 16.
pub const LARGEST_COMPONENT: f64 = 30.0;

/// `B = M^-1`, with a unit on the axes not computed in. The unit tensor, that is no correction, where `M` is singular, inside
/// out or so ill-conditioned that a component of `B` exceeds `largest`.
pub fn gradient_correction<T: Elementary>(moment: &Tensor<T>, dimension: Dimension, largest: T) -> Tensor<T> {
    correction_or(moment, dimension, largest, identity)
}

/// The same with something else in place of the unit tensor.
pub(crate) fn correction_or<T: Elementary>(
    moment: &Tensor<T>,
    dimension: Dimension,
    largest: T,
    otherwise: impl Fn() -> Tensor<T>,
) -> Tensor<T> {
    let count = dimension.count();
    let mut m = identity();
    for a in 0..count {
        for b in 0..count {
            m[a][b] = moment[a][b];
        }
    }
    let invert = || {
        let inverse = inverse(&m);
        let mut bounded = T::one();
        for a in 0..3 {
            for b in 0..3 {
                // Asked this way, a component that is not a number fails.
                bounded = T::select_lt(inverse[a][b].abs(), largest, bounded, T::zero());
            }
        }
        T::if_lt(T::zero(), bounded, || inverse, &otherwise)
    };
    T::if_lt(T::zero(), determinant(&m), invert, &otherwise)
}

/// `L B^T`: the corrected gradient of a plain one.
#[inline(always)]
pub fn corrected<T: Real>(gradient: &Tensor<T>, correction: &Tensor<T>) -> Tensor<T> {
    multiply(gradient, &transpose(correction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::zero;
    use crate::test_cloud::{Cloud, DIMENSIONS};

    #[test]
    fn corrected_gradient_of_a_linear_field_is_exact() {
        let a = [[120.0, -30.0, 55.0], [61.0, -80.0, 10.0], [-90.0, 33.0, 24.0]];
        for dimension in DIMENSIONS {
            let cloud = Cloud::block(dimension);
            for i in 0..cloud.count() {
                let (mut moment, mut gradient) = (zero::<f64>(), zero::<f64>());
                for j in (0..cloud.count()).filter(|&j| j != i) {
                    let (x_ij, g) = (cloud.x_ij(i, j), cloud.grad_w(i, j));
                    for p in 0..3 {
                        let v_ij = a[p][0] * x_ij[0] + a[p][1] * x_ij[1] + a[p][2] * x_ij[2];
                        for q in 0..3 {
                            moment[p][q] -= cloud.volume[j] * x_ij[p] * g[q];
                            gradient[p][q] -= cloud.volume[j] * v_ij * g[q];
                        }
                    }
                }
                let corrected = corrected(&gradient, &gradient_correction(&moment, dimension, LARGEST_COMPONENT));
                for p in 0..3 {
                    for q in 0..dimension.count() {
                        assert!((corrected[p][q] - a[p][q]).abs() < 1e-10 * 120.0, "{dimension:?} {i}");
                    }
                }
            }
        }
    }

    #[test]
    fn unusable_moments_are_not_inverted() {
        let unit = identity::<f64>();
        let flat = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
        let nearly_flat = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.01]];
        let inside_out = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let broken = [[f64::NAN; 3]; 3];
        for moment in [zero(), flat, nearly_flat, inside_out, broken] {
            assert_eq!(gradient_correction(&moment, Dimension::Three, LARGEST_COMPONENT), unit);
        }
        // Axes not computed in do not count.
        assert_eq!(
            gradient_correction(&[[0.5, 0.0, 0.0], [0.0; 3], [0.0; 3]], Dimension::One, LARGEST_COMPONENT)[0][0],
            2.0
        );
        assert_eq!(gradient_correction(&flat, Dimension::Two, LARGEST_COMPONENT), unit);
        let half = [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(gradient_correction(&half, Dimension::Three, 1.9), unit);
        assert_eq!(gradient_correction(&half, Dimension::Three, 2.1)[0][0], 2.0);
    }
}
