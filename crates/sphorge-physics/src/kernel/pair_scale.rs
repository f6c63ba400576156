//! The kernel of a pair: from the distance to `q`, and from the shape to the value and the gradient.

use crate::{Dimension, Elementary, Real};

/// Shortest distance a pair is taken to have, squared, in `h^2`: `1/r` is finite where particles coincide.
const SHORTEST: f64 = 1e-12;

/// Smoothing length of a pair, m, its inverse, and the factor of the kernel gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairScale<T> {
    /// `h`, m.
    pub h: T,
    /// `1/h`, 1/m.
    pub inverse_h: T,
    /// `sigma_d / h^(d+2)`, m^-(d+2), times the weight of the neighbour where it was given one.
    pub gradient: T,
}

/// Smoothing length of a pair, m: the mean of both.
#[inline(always)]
pub fn pair_smoothing_length<T: Real>(h_i: T, h_j: T) -> T {
    (h_i + h_j) * T::of(0.5)
}

/// Smoothing length (m) of material that was at rest with another: `h_0 (rho_0/rho)^(1/d)`, so that a particle keeps its neighbours, within a
/// `factor` of it.
#[inline(always)]
pub fn following_smoothing_length<T: Elementary>(
    dimension: Dimension,
    at_rest: T,
    density_at_rest: T,
    density: T,
    factor: f64,
) -> T {
    let ratio = (density_at_rest / density).powf(T::of(1.0 / dimension.count() as f64));
    at_rest * ratio.max(T::of(1.0 / factor)).min(T::of(factor))
}

impl<T: Real> PairScale<T> {
    /// Of a smoothing length (m) in `D` dimensions; `sigma` is the normalisation of the kernel.
    #[inline(always)]
    pub fn new<const D: usize>(sigma: T, h: T) -> Self {
        let inverse_h = T::one() / h;
        Self { h, inverse_h, gradient: sigma * inverse_h.powu(D as u32 + 2) }
    }

    /// `q = r/h` and its inverse, both finite at `r = 0`; `r2 = r^2`, m^2.
    #[inline(always)]
    pub fn reduced_distance(self, r2: T) -> (T, T) {
        let inverse_r = r2.max(self.h * self.h * T::of(SHORTEST)).inverse_sqrt();
        (r2 * inverse_r * self.inverse_h, inverse_r * self.h)
    }

    /// The same for a neighbour of that weight: value and gradient come multiplied by it.
    #[inline(always)]
    pub fn weighted(self, weight: T) -> Self {
        Self { gradient: self.gradient * weight, ..self }
    }

    /// `F` of `grad_i W_ij = F x_ij`, m^-(d+2), from `(1/q) dw/dq`; never positive.
    #[inline(always)]
    pub fn f(self, dw_over_q: T) -> T {
        dw_over_q * self.gradient
    }

    /// `W_ij`, m^-d, from `w(q)`.
    #[inline(always)]
    pub fn value(self, w: T) -> T {
        w * (self.h * self.h) * self.gradient
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smoothing_length_follows_the_density_by_hand() {
        // An eighth of the density: twice as long in space, 8^(1/2) times in a plane, bounded by 2.
        let of = |dimension, density| following_smoothing_length(dimension, 3.0, 8000.0, density, 2.0f64);
        assert_eq!((of(Dimension::Three, 1000.0), of(Dimension::Two, 1000.0)), (6.0, 6.0));
        assert!((of(Dimension::Two, 10_000.0) - 3.0 * 0.8f64.sqrt()).abs() < 1e-15);
        assert_eq!(of(Dimension::One, 32_000.0), 1.5);
    }

    #[test]
    fn scale_value_and_gradient_by_hand() {
        // h = 2, d = 3: 3/32; W = 0.5 3/8, F = -0.5 3/32.
        let scale = PairScale::new::<3>(3.0f64, 2.0);
        assert_eq!(scale, PairScale { h: 2.0, inverse_h: 0.5, gradient: 3.0 / 32.0 });
        assert_eq!((scale.value(0.5), scale.f(-0.5)), (0.1875, -0.046875));
        // h = 0.5, d = 1, weight 0.25: 4 8 = 32, 8 of it; W = 2 0.25 8.
        let scale = PairScale::new::<1>(4.0f64, pair_smoothing_length(0.75, 0.25)).weighted(0.25);
        assert_eq!((scale.gradient, scale.value(2.0), scale.f(-1.0)), (8.0, 4.0, -8.0));
    }

    #[test]
    fn reduced_distance_by_hand_and_finite_where_particles_coincide() {
        let scale = PairScale::new::<2>(1.0f64, 2.0);
        let (q, inverse_q) = scale.reduced_distance(9.0);
        assert!((q - 1.5).abs() < 1e-15 && (inverse_q - 2.0 / 3.0).abs() < 1e-15);
        assert_eq!(scale.reduced_distance(0.0), (0.0, 1e6));
        let (q, _) = PairScale::new::<2>(1.0f64, 2e-6).reduced_distance(9e-12);
        assert!((q - 1.5).abs() < 1e-15);
    }
}
