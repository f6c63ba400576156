//! Cubic B-spline.

use super::KernelShape;
use crate::{Dimension, Real};
use core::f64::consts::PI;

/// Cubic B-spline, the kernel of both papers: `w = 2/3 - q^2 + q^3/2` for `q < 1`, `(2 - q)^3 / 6` for `1 <= q < 2`.
///
/// Patiño et al. Eq 4, Fraser Eq 7; Monaghan & Lattanzio 1985. Normalisation 1, 15/(7 pi), 3/(2 pi).
#[derive(Clone, Copy, Debug)]
pub struct CubicSpline;

impl KernelShape for CubicSpline {
    const KEY: &'static str = "cubic-spline";
    const NAME: &'static str = "cubic B-spline";
    const REFERENCE: &'static str = "Monaghan & Lattanzio, Astronomy and Astrophysics 149 (1985) 135";
    const SUPPORT: f64 = 2.0;

    fn normalisation(dimension: Dimension) -> f64 {
        match dimension {
            Dimension::One => 1.0,
            Dimension::Two => 15.0 / (7.0 * PI),
            Dimension::Three => 3.0 / (2.0 * PI),
        }
    }

    // Both pieces at once: `[(2-q)+^3 - 4 (1-q)+^3] / 6`.
    #[inline(always)]
    fn w<T: Real>(q: T) -> T {
        let a = (T::of(2.0) - q).max(T::zero());
        let b = (T::one() - q).max(T::zero());
        T::of(1.0 / 6.0) * (a * a * a) - T::of(2.0 / 3.0) * (b * b * b)
    }

    #[inline(always)]
    fn dw_over_q<T: Real>(q: T) -> T {
        Self::dw_over_q_by(q, T::one() / q.max(T::one()))
    }

    #[inline(always)]
    fn dw_over_q_by<T: Real>(q: T, inverse_q: T) -> T {
        let a = (T::of(2.0) - q).max(T::zero());
        let inner = T::of(1.5).mul_add(q, T::of(-2.0));
        let outer = T::of(-0.5) * a * a * inverse_q;
        T::select_lt(q, T::one(), inner, outer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_values() {
        // q = 0.5: 2/3 - 0.25 + 0.0625; slope -2 + 0.75. q = 1.5: 0.125/6; slope -0.125/1.5.
        assert!((CubicSpline::w(0.5f64) - 0.479_166_666_666_667).abs() < 1e-14);
        assert!((CubicSpline::dw_over_q(0.5f64) + 1.25).abs() < 1e-14);
        assert!((CubicSpline::w(1.5f64) - 0.020_833_333_333_333).abs() < 1e-14);
        assert!((CubicSpline::dw_over_q(1.5f64) + 0.083_333_333_333_333).abs() < 1e-14);
    }
}
