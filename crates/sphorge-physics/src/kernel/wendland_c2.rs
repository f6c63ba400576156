//! Wendland C2.

use super::KernelShape;
use crate::{Dimension, Real};
use core::f64::consts::PI;

/// Wendland's twice differentiable kernel: `w = (1 - q/2)^4 (1 + 2 q)` for `q < 2`.
///
/// Wendland 1995; Dehnen & Aly 2012, Table 1. Normalisation 7/(4 pi) and 21/(16 pi) in two and three dimensions. In one
/// dimension the same polynomial is used (it stays positive definite there) with its own normalisation 3/4, not the
/// one-dimensional member of the family `(1 - q/2)^3 (1 + 3 q/2)`.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC2;

impl KernelShape for WendlandC2 {
    const KEY: &'static str = "wendland-c2";
    const NAME: &'static str = "Wendland C2";
    const REFERENCE: &'static str = "Wendland, Advances in Computational Mathematics 4 (1995) 389; \
                                     Dehnen & Aly, Monthly Notices of the RAS 425 (2012) 1068";
    const SUPPORT: f64 = 2.0;

    fn normalisation(dimension: Dimension) -> f64 {
        match dimension {
            Dimension::One => 0.75,
            Dimension::Two => 7.0 / (4.0 * PI),
            Dimension::Three => 21.0 / (16.0 * PI),
        }
    }

    #[inline(always)]
    fn w<T: Real>(q: T) -> T {
        let a = T::of(-0.5).mul_add(q, T::one()).max(T::zero());
        let a2 = a * a;
        a2 * a2 * T::of(2.0).mul_add(q, T::one())
    }

    #[inline(always)]
    fn dw_over_q<T: Real>(q: T) -> T {
        let a = T::of(-0.5).mul_add(q, T::one()).max(T::zero());
        T::of(-5.0) * (a * a * a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_hand() {
        // q = 1: (1/2)^4 3 and -5/8; q = 0.4: 0.8^4 1.8 and -5 0.8^3.
        assert!((WendlandC2::w(1.0f64) - 0.1875).abs() < 1e-15);
        assert!((WendlandC2::dw_over_q(1.0f64) + 0.625).abs() < 1e-15);
        assert!((WendlandC2::w(0.4f64) - 0.73728).abs() < 1e-14);
        assert!((WendlandC2::dw_over_q(0.4f64) + 2.56).abs() < 1e-14);
    }
}
