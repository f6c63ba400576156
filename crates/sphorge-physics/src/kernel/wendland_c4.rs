//! Wendland C4.

use super::KernelShape;
use crate::{Dimension, Real};
use core::f64::consts::PI;

/// Wendland's four times differentiable kernel: `w = (1 - q/2)^6 (1 + 3 q + 35/12 q^2)` for `q < 2`.
///
/// Wendland 1995; Dehnen & Aly 2012, Table 1. Normalisation 9/(4 pi) and 495/(256 pi) in two and three dimensions. In one
/// dimension the same polynomial is used (it stays positive definite there) with its own normalisation 27/32.
#[derive(Clone, Copy, Debug)]
pub struct WendlandC4;

impl KernelShape for WendlandC4 {
    const KEY: &'static str = "wendland-c4";
    const NAME: &'static str = "Wendland C4";
    const REFERENCE: &'static str = "Wendland, Advances in Computational Mathematics 4 (1995) 389; \
                                     Dehnen & Aly, Monthly Notices of the RAS 425 (2012) 1068";
    const SUPPORT: f64 = 2.0;

    fn normalisation(dimension: Dimension) -> f64 {
        match dimension {
            Dimension::One => 27.0 / 32.0,
            Dimension::Two => 9.0 / (4.0 * PI),
            Dimension::Three => 495.0 / (256.0 * PI),
        }
    }

    #[inline(always)]
    fn w<T: Real>(q: T) -> T {
        let a = T::of(-0.5).mul_add(q, T::one()).max(T::zero());
        let a2 = a * a;
        let polynomial = T::of(35.0 / 12.0).mul_add(q, T::of(3.0)).mul_add(q, T::one());
        a2 * a2 * a2 * polynomial
    }

    #[inline(always)]
    fn dw_over_q<T: Real>(q: T) -> T {
        let a = T::of(-0.5).mul_add(q, T::one()).max(T::zero());
        let a2 = a * a;
        T::of(-14.0 / 3.0) * (a2 * a2 * a) * T::of(2.5).mul_add(q, T::one())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_hand() {
        // q = 1: (1/2)^6 (83/12) and -(14/3) 3.5 / 32; q = 0.4: 0.8^6 (1 + 1.2 + 7/15) and -(14/3) 2 0.8^5.
        assert!((WendlandC4::w(1.0f64) - 83.0 / 768.0).abs() < 1e-15);
        assert!((WendlandC4::dw_over_q(1.0f64) + 49.0 / 96.0).abs() < 1e-15);
        assert!((WendlandC4::w(0.4f64) - 0.262_144 * 2.666_666_666_666_667).abs() < 1e-14);
        assert!((WendlandC4::dw_over_q(0.4f64) + 3.058_346_666_666_667).abs() < 1e-14);
    }
}
