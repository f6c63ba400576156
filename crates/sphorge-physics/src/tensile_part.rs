//! The tensile part of a symmetric tensor: its positive principal values with their directions.
//!
//! Of the principal values of a deviator `s` the one whose sign is that of its determinant `J3` stands apart from the other two. It
//! is a simple root `x` of the characteristic polynomial, found by Newton's method from outside all roots, where it converges
//! without overshooting; the projection on its direction is, by the Cayley–Hamilton theorem,
//! `P = (s^2 + x s + (x^2 - J2) I)/(3 x^2 - J2)`. What is left is a plane problem. Values that coincide do no harm.

use crate::{Dimension, Scalar, SymmetricTensor};

/// Newton steps; convergence is quadratic, five reach round-off.
const MAXIMUM_STEPS: u32 = 12;

/// `J2` of a deviator that counts as none, Pa^2: cubes of its components are still numbers.
const NO_SHEAR: f64 = 1e-24;

/// `sum max(lambda_k, 0) n_k n_k^T` over the principal directions a case computes in: in plane strain those in the plane, in
/// one dimension the axis.
#[inline]
pub fn tensile_part<T: Scalar>(sigma: SymmetricTensor<T>, dimension: Dimension) -> SymmetricTensor<T> {
    match dimension {
        Dimension::One => SymmetricTensor { xx: sigma.xx.max(T::zero()), ..SymmetricTensor::zero() },
        Dimension::Two => in_plane(sigma),
        Dimension::Three => in_space(sigma),
    }
}

fn in_plane<T: Scalar>(sigma: SymmetricTensor<T>) -> SymmetricTensor<T> {
    let zero = T::zero();
    let half = T::of(0.5);
    let middle = half * (sigma.xx + sigma.yy);
    let difference = half * (sigma.xx - sigma.yy);
    let radius = (difference * difference + sigma.xy * sigma.xy).sqrt();
    let (high, low) = (middle + radius, middle - radius);
    let plane = SymmetricTensor { xx: sigma.xx, yy: sigma.yy, xy: sigma.xy, ..SymmetricTensor::zero() };
    let mut part = SymmetricTensor::zero();
    if low >= zero {
        part = plane;
    } else if high > zero {
        // n n^T = (sigma - low I)/(high - low).
        let scale = high / (radius + radius);
        part.xx = (difference + radius) * scale;
        part.yy = (radius - difference) * scale;
        part.xy = sigma.xy * scale;
    }
    part
}

fn in_space<T: Scalar>(sigma: SymmetricTensor<T>) -> SymmetricTensor<T> {
    let zero = T::zero();
    let mean = (sigma.xx + sigma.yy + sigma.zz) * T::of(1.0 / 3.0);
    let s = sigma - SymmetricTensor::isotropic(mean);
    let j2 = T::of(0.5) * s.double_dot(s);
    // All principal values lie within mean +- 2 sqrt(J2/3).
    let reach = T::of(2.0) * (j2 * T::of(1.0 / 3.0)).sqrt();
    let mut part = SymmetricTensor::zero();
    if j2 < T::of(NO_SHEAR) {
        // Far ahead of a wave numbers fall until their products vanish.
        part = SymmetricTensor::isotropic(mean.max(zero));
    } else if mean >= reach {
        part = sigma;
    } else if mean > -reach {
        let j3 = determinant(s);
        let x = root_apart(if j3 < zero { -reach } else { reach }, j2, j3);
        let apart =
            (square(s) + s * x + SymmetricTensor::isotropic(x * x - j2)) * (T::one() / (T::of(3.0) * x * x - j2));
        // The other two: `middle +- radius`, in the plane across.
        let across = SymmetricTensor::isotropic(T::one()) - apart;
        let middle = T::of(-0.5) * x;
        let difference = s - apart * x - across * middle;
        let radius = (T::of(0.5) * difference.double_dot(difference)).sqrt();
        let high = (mean + middle + radius).max(zero);
        let low = (mean + middle - radius).max(zero);
        part = apart * (mean + x).max(zero) + across * (T::of(0.5) * (high + low));
        if radius > zero {
            part = part + difference * (T::of(0.5) * (high - low) / radius);
        }
    }
    part
}

/// The principal value that stands apart, from outside all of them.
#[inline(always)]
fn root_apart<T: Scalar>(from: T, j2: T, j3: T) -> T {
    let mut x = from;
    let mut steps = 0;
    let mut searching = true;
    while searching {
        let step = ((x * x - j2) * x - j3) / (T::of(3.0) * x * x - j2);
        x -= step;
        steps += 1;
        searching = step.abs() > T::epsilon() * from.abs() && steps < MAXIMUM_STEPS;
    }
    x
}

#[inline(always)]
fn determinant<T: Scalar>(s: SymmetricTensor<T>) -> T {
    s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.xz) + s.xz * (s.xy * s.yz - s.yy * s.xz)
}

/// `s s`.
#[inline(always)]
fn square<T: Scalar>(s: SymmetricTensor<T>) -> SymmetricTensor<T> {
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
