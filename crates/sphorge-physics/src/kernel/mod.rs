//! Smoothing kernels.
//!
//! `W(r, h) = sigma_d / h^d w(q)` with `q = r / h` (Patiño et al. Eq 3), unit `m^-d`, and
//! `grad_i W = sigma_d / h^(d+2) [(1/q) dw/dq] x_ij`, unit `m^-(d+1)`. A shape `w` is written without branches so that it
//! runs on SIMD lanes, and in the form `(1/q) dw/dq`, which is finite where particles coincide.
//!
//! A further kernel is one file and one line of the table at the end of this one.

mod cubic_spline;
mod pair_scale;
mod quintic_spline;
mod wendland_c2;
mod wendland_c4;

pub use cubic_spline::CubicSpline;
pub use pair_scale::{PairScale, following_smoothing_length, pair_smoothing_length};
pub use quintic_spline::QuinticSpline;
pub use wendland_c2::WendlandC2;
pub use wendland_c4::WendlandC4;

use crate::{Dimension, Real};

/// The shape of a smoothing kernel.
pub trait KernelShape: Copy + Send + Sync + 'static {
    /// Name in a deck.
    const KEY: &'static str;
    /// Name in a text.
    const NAME: &'static str;
    /// Where it is published.
    const REFERENCE: &'static str;
    /// Radius beyond which the kernel is zero, in units of `h`.
    const SUPPORT: f64;

    /// `sigma_d`, such that the kernel integrates to one.
    fn normalisation(dimension: Dimension) -> f64;
    /// `w(q)` for `q >= 0`; zero beyond the support.
    fn w<T: Real>(q: T) -> T;
    /// `(1/q) dw/dq` for `q >= 0`, never positive; finite at `q = 0`, zero beyond the support.
    fn dw_over_q<T: Real>(q: T) -> T;
    /// The same where `1/q` is known too: a division less. `inverse_q` may be infinite at `q = 0`.
    #[inline(always)]
    fn dw_over_q_by<T: Real>(q: T, inverse_q: T) -> T {
        let _ = inverse_q;
        Self::dw_over_q(q)
    }
}

macro_rules! kernels {
    ($($(#[$attribute:meta])* $kernel:ident,)*) => {
        /// The kernels a deck can choose.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum Kernel {
            $(
                #[doc = concat!("See [`", stringify!($kernel), "`](struct@", stringify!($kernel), ").")]
                $(#[$attribute])*
                $kernel,
            )*
        }

        impl Kernel {
            /// Every kernel.
            pub const ALL: &'static [Self] = &[$(Self::$kernel,)*];

            /// Name in a deck.
            pub const fn key(self) -> &'static str {
                match self { $(Self::$kernel => <$kernel as KernelShape>::KEY,)* }
            }

            /// Name in a text.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$kernel => <$kernel as KernelShape>::NAME,)* }
            }

            /// Where it is published.
            pub const fn reference(self) -> &'static str {
                match self { $(Self::$kernel => <$kernel as KernelShape>::REFERENCE,)* }
            }

            /// Radius beyond which the kernel is zero, in units of `h`.
            pub const fn support(self) -> f64 {
                match self { $(Self::$kernel => <$kernel as KernelShape>::SUPPORT,)* }
            }

            /// `sigma_d`, such that the kernel integrates to one.
            pub fn normalisation(self, dimension: Dimension) -> f64 {
                match self { $(Self::$kernel => <$kernel as KernelShape>::normalisation(dimension),)* }
            }

            /// `w(q)`; see [`KernelShape::w`].
            #[inline(always)]
            pub fn w<T: Real>(self, q: T) -> T {
                match self { $(Self::$kernel => <$kernel as KernelShape>::w(q),)* }
            }

            /// `(1/q) dw/dq`; see [`KernelShape::dw_over_q`].
            #[inline(always)]
            pub fn dw_over_q<T: Real>(self, q: T) -> T {
                match self { $(Self::$kernel => <$kernel as KernelShape>::dw_over_q(q),)* }
            }

            /// `(1/q) dw/dq`; see [`KernelShape::dw_over_q_by`].
            #[inline(always)]
            pub fn dw_over_q_by<T: Real>(self, q: T, inverse_q: T) -> T {
                match self { $(Self::$kernel => <$kernel as KernelShape>::dw_over_q_by(q, inverse_q),)* }
            }
        }
    };
}

kernels! {
    #[default]
    CubicSpline,
    WendlandC2,
    WendlandC4,
    QuinticSpline,
}

impl Kernel {
    /// `W`, m^-d, at a distance `r` (m) with the smoothing length `h` (m).
    #[inline(always)]
    pub fn value<T: Real>(self, dimension: Dimension, r: T, h: T) -> T {
        T::of(self.normalisation(dimension)) / h.powu(dimension.count() as u32) * self.w(r / h)
    }

    /// `-(1/r) dW/dr`, m^-(d+2), never negative: `grad_i W_ij` is minus this times `x_ij`. Arguments as for [`Self::value`].
    #[inline(always)]
    pub fn slope<T: Real>(self, dimension: Dimension, r: T, h: T) -> T {
        -T::of(self.normalisation(dimension)) * self.dw_over_q(r / h) / h.powu(dimension.count() as u32 + 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    const DIMENSIONS: [Dimension; 3] = [Dimension::One, Dimension::Two, Dimension::Three];

    #[test]
    fn every_kernel_integrates_to_one() {
        for &kernel in Kernel::ALL {
            for dimension in DIMENSIONS {
                // Midpoint rule; the knots of the splines (integers) fall on interval ends.
                let n = 6000;
                let dq = kernel.support() / f64::from(n);
                let mut sum = 0.0;
                for k in 0..n {
                    let q = (f64::from(k) + 0.5) * dq;
                    let shell = match dimension {
                        Dimension::One => 2.0,
                        Dimension::Two => 2.0 * PI * q,
                        Dimension::Three => 4.0 * PI * q * q,
                    };
                    sum += shell * kernel.w(q) * dq;
                }
                let integral = kernel.normalisation(dimension) * sum;
                assert!((integral - 1.0).abs() < 1e-6, "{} {dimension:?}: {integral}", kernel.key());
            }
        }
    }

    #[test]
    fn gradient_is_the_slope_of_the_kernel() {
        for &kernel in Kernel::ALL {
            let mut q = 0.013;
            while q < kernel.support() {
                let step = 1e-5;
                let slope = (kernel.w(q + step) - kernel.w(q - step)) / (2.0 * step);
                let exact = kernel.dw_over_q(q) * q;
                assert!((slope - exact).abs() < 1e-8 * kernel.w(0.0f64), "{} at {q}: {slope} {exact}", kernel.key());
                q += 0.0371;
            }
        }
    }

    #[test]
    fn value_and_slope_by_hand() {
        // Cubic spline at q = 1: w = 1/6, (1/q) dw/dq = -1/2; in one dimension sigma is 1, h = 2.
        let kernel = Kernel::CubicSpline;
        assert!((kernel.value(Dimension::One, 2.0, 2.0f64) - 1.0 / 12.0).abs() < 1e-15);
        assert!((kernel.slope(Dimension::One, 2.0, 2.0f64) - 1.0 / 16.0).abs() < 1e-15);
        // At q = 0.5 in space: w = 2/3 - 1/4 + 1/16 = 23/48, -2 + 0.75 = -1.25; sigma = 3/(2 pi), h = 0.5.
        let sigma = 1.5 / PI;
        assert!((kernel.value(Dimension::Three, 0.25, 0.5f64) - sigma * 8.0 * 23.0 / 48.0).abs() < 1e-14);
        assert!((kernel.slope(Dimension::Three, 0.25, 0.5f64) - sigma * 32.0 * 1.25).abs() < 1e-13);
    }

    #[test]
    fn gradient_is_finite_at_the_centre_and_zero_at_and_beyond_the_support() {
        for &kernel in Kernel::ALL {
            let centre = kernel.dw_over_q(0.0f64);
            assert!(centre.is_finite() && centre < 0.0);
            assert!((kernel.dw_over_q(1e-9f64) - centre).abs() < 1e-7 * centre.abs());
            for q in [kernel.support(), kernel.support() + 0.1, 10.0] {
                assert_eq!(kernel.w(q), 0.0);
                assert_eq!(kernel.dw_over_q(q), 0.0);
            }
        }
    }

    #[test]
    fn single_precision_follows_double() {
        for &kernel in Kernel::ALL {
            let scale = kernel.w(0.0f64);
            for k in 0..300 {
                let q = f64::from(k) * 0.01;
                assert!((f64::from(kernel.w(q as f32)) - kernel.w(q)).abs() < 2e-6 * scale);
                assert!((f64::from(kernel.dw_over_q(q as f32)) - kernel.dw_over_q(q)).abs() < 1e-5 * scale);
                let by = kernel.dw_over_q_by(q, 1.0 / q);
                assert!((by - kernel.dw_over_q(q)).abs() <= 1e-14 * scale, "{q}: {by}");
            }
        }
    }
}
