//! The tensile part of a symmetric tensor: its positive principal values with their directions.
//!
//! Of the principal values of a deviator `s` the one whose sign is that of its determinant `J3` stands apart from the other two. It
//! is a simple root `x` of the characteristic polynomial, found by Newton's method from outside all roots, where it converges
//! without overshooting; the projection on its direction is, by the Cayley–Hamilton theorem,
//! `P = (s^2 + x s + (x^2 - J2) I)/(3 x^2 - J2)`. What is left is a plane problem. Values that coincide do no harm.

use crate::{Dimension, Real, SymmetricTensor};

/// Newton steps; convergence is quadratic, five reach round-off.
const STEPS: u32 = 5;

/// `J2` of a deviator that counts as none, Pa^2: cubes of its components are still numbers.
const NO_SHEAR: f64 = 1e-24;

/// Keeps zero over zero a number, Pa.
const LEAST: f64 = 1e-30;

/// `sum max(lambda_k, 0) n_k n_k^T` over the principal directions a case computes in: in plane strain those in the plane, in
/// one dimension the axis. Without branches, so that it runs on SIMD lanes.
#[inline(always)]
pub fn tensile_part<T: Real>(sigma: SymmetricTensor<T>, dimension: Dimension) -> SymmetricTensor<T> {
    match dimension {
        Dimension::One => SymmetricTensor { xx: sigma.xx.max(T::zero()), ..SymmetricTensor::zero() },
        Dimension::Two => in_plane(sigma),
        Dimension::Three => in_space(sigma),
    }
}

#[inline(always)]
fn in_plane<T: Real>(sigma: SymmetricTensor<T>) -> SymmetricTensor<T> {
    let half = T::of(0.5);
    let middle = half * (sigma.xx + sigma.yy);
    let difference = half * (sigma.xx - sigma.yy);
    let radius = (difference * difference + sigma.xy * sigma.xy).sqrt();
    // high n n^T + low m m^T = (high + low)/2 I + (high - low)/2 (sigma - middle I)/radius.
    let high = (middle + radius).max(T::zero());
    let low = (middle - radius).max(T::zero());
    let mean = half * (high + low);
    let scale = half * (high - low) / radius.max(T::of(LEAST));
    SymmetricTensor {
        xx: mean + difference * scale,
        yy: mean - difference * scale,
        xy: sigma.xy * scale,
        ..SymmetricTensor::zero()
    }
}

/// A symmetric tensor taken apart: the principal value that stands apart and the two others, each as an excess over the mean.
struct Principal<T> {
    mean: T,
    /// Half the square of the deviator as it is, and at least what counts as none.
    j2_here: T,
    /// All principal values lie within `mean +- reach`.
    reach: T,
    /// The one that stands apart, and the projection on its direction.
    x: T,
    apart: SymmetricTensor<T>,
    /// The other two are `middle +- radius`, in the plane across; `difference` is the deviator there without its mean.
    middle: T,
    radius: T,
    across: SymmetricTensor<T>,
    difference: SymmetricTensor<T>,
}

impl<T: Real> Principal<T> {
    #[inline(always)]
    fn of(sigma: SymmetricTensor<T>) -> Self {
        let zero = T::zero();
        let half = T::of(0.5);
        let mean = (sigma.xx + sigma.yy + sigma.zz) * T::of(1.0 / 3.0);
        let s = sigma - SymmetricTensor::isotropic(mean);
        let j2_here = half * s.double_dot(s);
        let j2 = j2_here.max(T::of(NO_SHEAR));
        let reach = T::of(2.0) * (j2 * T::of(1.0 / 3.0)).sqrt();

        // The principal value that stands apart, from outside all of them.
        let j3 = determinant(s);
        let mut x = T::select_lt(j3, zero, -reach, reach);
        for _ in 0..STEPS {
            x -= ((x * x - j2) * x - j3) / (T::of(3.0) * x * x - j2);
        }
        let apart =
            (square(s) + s * x + SymmetricTensor::isotropic(x * x - j2)) * (T::one() / (T::of(3.0) * x * x - j2));
        let across = SymmetricTensor::isotropic(T::one()) - apart;
        let middle = T::of(-0.5) * x;
        let difference = s - apart * x - across * middle;
        let radius = (half * difference.double_dot(difference)).sqrt();
        Self { mean, j2_here, reach, x, apart, middle, radius, across, difference }
    }
}

/// The smallest principal value in space, to round-off of the largest, also where principal values coincide.
#[inline(always)]
pub(crate) fn smallest_principal_value<T: Real>(sigma: SymmetricTensor<T>) -> T {
    let p = Principal::of(sigma);
    let smallest = p.mean + p.x.min(p.middle - p.radius);
    T::select_lt(p.j2_here, T::of(NO_SHEAR), p.mean, smallest)
}

/// The largest principal value in space, as exact.
#[inline(always)]
pub(crate) fn largest_principal_value<T: Real>(sigma: SymmetricTensor<T>) -> T {
    -smallest_principal_value(sigma * T::of(-1.0))
}

#[inline(always)]
fn in_space<T: Real>(sigma: SymmetricTensor<T>) -> SymmetricTensor<T> {
    let zero = T::zero();
    let half = T::of(0.5);
    let Principal { mean, j2_here, reach, x, apart, middle, radius, across, difference } = Principal::of(sigma);
    let high = (mean + middle + radius).max(zero);
    let low = (mean + middle - radius).max(zero);
    let mixed = apart * (mean + x).max(zero)
        + across * (half * (high + low))
        + difference * (half * (high - low) / radius.max(T::of(LEAST)));

    // Far ahead of a wave numbers fall until their products vanish.
    let isotropic = SymmetricTensor::isotropic(mean.max(zero));
    let part = choose(mean, reach, mixed, sigma);
    let part = choose(-reach, mean, part, SymmetricTensor::zero());
    choose(j2_here, T::of(NO_SHEAR), isotropic, part)
}

/// `then` where `a < b`, else `otherwise`.
#[inline(always)]
fn choose<T: Real>(a: T, b: T, then: SymmetricTensor<T>, otherwise: SymmetricTensor<T>) -> SymmetricTensor<T> {
    SymmetricTensor {
        xx: T::select_lt(a, b, then.xx, otherwise.xx),
        yy: T::select_lt(a, b, then.yy, otherwise.yy),
        zz: T::select_lt(a, b, then.zz, otherwise.zz),
        xy: T::select_lt(a, b, then.xy, otherwise.xy),
        yz: T::select_lt(a, b, then.yz, otherwise.yz),
        xz: T::select_lt(a, b, then.xz, otherwise.xz),
    }
}

#[inline(always)]
fn determinant<T: Real>(s: SymmetricTensor<T>) -> T {
    s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.xz) + s.xz * (s.xy * s.yz - s.yy * s.xz)
}

/// `s s`.
#[inline(always)]
fn square<T: Real>(s: SymmetricTensor<T>) -> SymmetricTensor<T> {
    SymmetricTensor {
        xx: s.xx * s.xx + s.xy * s.xy + s.xz * s.xz,
        yy: s.xy * s.xy + s.yy * s.yy + s.yz * s.yz,
        zz: s.xz * s.xz + s.yz * s.yz + s.zz * s.zz,
        xy: s.xx * s.xy + s.xy * s.yy + s.xz * s.yz,
        yz: s.xy * s.xz + s.yy * s.yz + s.yz * s.zz,
        xz: s.xx * s.xz + s.xy * s.yz + s.xz * s.zz,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tensor;
    use crate::stress::rotation;

    fn near(a: SymmetricTensor<f64>, b: SymmetricTensor<f64>, tolerance: f64) -> bool {
        let d = a - b;
        d.double_dot(d).sqrt() <= tolerance
    }

    /// A rotation far from any axis.
    fn turn(k: u32) -> Tensor<f64> {
        let t = f64::from(k);
        rotation(&[[0.0, 1.3 + t, -0.4], [-1.3 - t, 0.0, 2.1 * t], [0.4, -2.1 * t, 0.0]], 1.0)
    }

    #[test]
    fn principal_values_in_any_frame_keep_their_positive_part() {
        let values: [[f64; 3]; 14] = [
            [3.0, 2.0, 1.0],
            [3.0, 2.0, -1.0],
            [3.0, -2.0, -1.0],
            [-3.0, -2.0, -1.0],
            [5.0, 5.0, -4.0],
            [-5.0, -5.0, 4.0],
            [2.0, 2.0, 2.0],
            [1e9, -1.0, -1e9],
            [1.0, 1.0, -1e-9],
            [1.0, 1e-9, -1.0],
            [1e-9, -1.0, -1.0],
            [1e-3, -1e-3, 1e-3],
            [0.0, 0.0, -1.0],
            [7.0, 0.0, 0.0],
        ];
        for (case, v) in values.iter().enumerate() {
            let size = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            for k in 0..7 {
                let q = turn(k);
                let sigma = SymmetricTensor::diagonal(v[0], v[1], v[2]).congruence(&q);
                let [a, b, c] = v.map(|x| x.max(0.0));
                let want = SymmetricTensor::diagonal(a, b, c).congruence(&q);
                let got = tensile_part(sigma, Dimension::Three);
                assert!(near(got, want, 1e-14 * size), "case {case}, turn {k}: {got:?} {want:?}");
            }
        }
    }

    #[test]
    fn vanishing_stress_stays_a_number() {
        for exponent in 0..320 {
            let size = 10.0f64.powi(-exponent);
            let sigma = SymmetricTensor { xx: 1.0, yy: -2.0, zz: 0.5, xy: 0.7, yz: -1.1, xz: 0.3 } * size;
            for dimension in [Dimension::Two, Dimension::Three] {
                let part = tensile_part(sigma, dimension);
                assert!(part.to_array().iter().all(|c| c.abs() <= 3.0 * size), "{exponent}: {part:?}");
            }
        }
    }

    #[test]
    fn nothing_is_left_of_nothing_and_single_precision_follows() {
        assert_eq!(tensile_part(SymmetricTensor::<f64>::zero(), Dimension::Three), SymmetricTensor::zero());
        let sigma = SymmetricTensor { xx: 1.0f32, yy: -2.0, zz: 0.5, xy: 0.7, yz: -1.1, xz: 0.3 };
        let single = tensile_part(sigma, Dimension::Three).to_array();
        let double = tensile_part(SymmetricTensor::from_array(sigma.to_array().map(f64::from)), Dimension::Three);
        for (a, b) in single.iter().zip(double.to_array()) {
            assert!((f64::from(*a) - b).abs() < 1e-5);
        }
    }

    #[test]
    fn the_plane_takes_part_alone() {
        // Principal values 3 and -1 at 45 degrees.
        let sigma = SymmetricTensor { xx: 1.0f64, yy: 1.0, zz: 9.0, xy: 2.0, yz: 4.0, xz: 4.0 };
        let want = SymmetricTensor { xx: 1.5, yy: 1.5, xy: 1.5, ..SymmetricTensor::zero() };
        assert!(near(tensile_part(sigma, Dimension::Two), want, 1e-15));
        let both = SymmetricTensor { xx: 3.0, yy: 2.0, xy: 1.0, ..SymmetricTensor::zero() };
        assert_eq!(tensile_part(both, Dimension::Two), both);
        assert_eq!(tensile_part(both, Dimension::One), SymmetricTensor { xx: 3.0, ..SymmetricTensor::zero() });
    }
}
