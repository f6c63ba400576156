//! Quintic B-spline.

use super::KernelShape;
use crate::{Dimension, Real};
use core::f64::consts::PI;

/// Quintic B-spline: `w = (3 - q)+^5 - 6 (2 - q)+^5 + 15 (1 - q)+^5`, radius `3 h`.
///
/// Morris, Fox & Zhu 1997. Normalisation 1/120, 7/(478 pi), 1/(120 pi).
#[derive(Clone, Copy, Debug)]
pub struct QuinticSpline;

impl KernelShape for QuinticSpline {
    const KEY: &'static str = "quintic-spline";
    const NAME: &'static str = "quintic B-spline";
    const REFERENCE: &'static str = "Morris, Fox & Zhu, Journal of Computational Physics 136 (1997) 214";
    const SUPPORT: f64 = 3.0;

    fn normalisation(dimension: Dimension) -> f64 {
        match dimension {
            Dimension::One => 1.0 / 120.0,
            Dimension::Two => 7.0 / (478.0 * PI),
            Dimension::Three => 1.0 / (120.0 * PI),
        }
    }

    #[inline(always)]
    fn w<T: Real>(q: T) -> T {
        let a = (T::of(3.0) - q).max(T::zero());
        let b = (T::of(2.0) - q).max(T::zero());
        let c = (T::one() - q).max(T::zero());
        let (a2, b2, c2) = (a * a, b * b, c * c);
        a2 * a2 * a - T::of(6.0) * (b2 * b2 * b) + T::of(15.0) * (c2 * c2 * c)
    }

    // Inside `q < 1` the three pieces sum to `66 - 60 q^2 + 30 q^4 - 10 q^5`, whose slope divides by `q` exactly.
    #[inline(always)]
    fn dw_over_q<T: Real>(q: T) -> T {
        Self::dw_over_q_by(q, T::one() / q.max(T::one()))
    }

    #[inline(always)]
    fn dw_over_q_by<T: Real>(q: T, inverse_q: T) -> T {
        let a = (T::of(3.0) - q).max(T::zero());
        let b = (T::of(2.0) - q).max(T::zero());
        let (a2, b2) = (a * a, b * b);
        let inner = T::of(-50.0).mul_add(q, T::of(120.0)).mul_add(q * q, T::of(-120.0));
        let outer = (T::of(30.0) * (b2 * b2) - T::of(5.0) * (a2 * a2)) * inverse_q;
        T::select_lt(q, T::one(), inner, outer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_by_hand() {
        // q = 0: 243 - 192 + 15; q = 1: 32 - 6, slope -5 (16 - 6); q = 2: 1, slope -5/2; q = 0.5: 66 - 15 + 1.875 - 0.3125.
        assert!((QuinticSpline::w(0.0f64) - 66.0).abs() < 1e-12);
        assert!((QuinticSpline::dw_over_q(0.0f64) + 120.0).abs() < 1e-12);
        assert!((QuinticSpline::w(0.5f64) - 52.5625).abs() < 1e-12);
        assert!((QuinticSpline::dw_over_q(0.5f64) + 96.25).abs() < 1e-12);
        assert!((QuinticSpline::w(1.0f64) - 26.0).abs() < 1e-12);
        assert!((QuinticSpline::dw_over_q(1.0f64) + 50.0).abs() < 1e-12);
        assert!((QuinticSpline::w(2.0f64) - 1.0).abs() < 1e-12);
        assert!((QuinticSpline::dw_over_q(2.0f64) + 2.5).abs() < 1e-12);
    }
}
