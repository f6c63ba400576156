//! Elastic trial stress over a step: rotation, shear, change of density.
//!
//! The Jaumann rate `dS/dt = 2 G dev(D) + W S - S W`, `D = sym L`, `W = skew L` (Patiño et al. Eq 20 prints
//! `- w S - S w`, which is antisymmetric; Fraser Eq 9; both print the deviator without its third, `eps - tr(eps) I`) is
//! integrated as Hughes & Winget 1980 do: the stress is turned by a proper rotation and sheared, both with the velocity
//! gradient at the middle of the step. Plain Euler steps of the rate inflate the stress in rotation.

use crate::tensor;
use crate::{Elementary, Real, SymmetricTensor, Tensor};

/// Rotation of a step, `Q = (I - dt/2 W)^-1 (I + dt/2 W)`, `W = skew L`: proper and orthogonal to round-off for any step.
///
/// With `b` the axial vector of `dt/2 W` and `B` its matrix, `Q = I + 2/(1 + b.b) (B + B B)`.
#[inline(always)]
pub fn rotation<T: Real>(l: &Tensor<T>, dt: T) -> Tensor<T> {
    let quarter = T::of(0.25) * dt;
    let b = [quarter * (l[2][1] - l[1][2]), quarter * (l[0][2] - l[2][0]), quarter * (l[1][0] - l[0][1])];
    let b_b = tensor::dot(b, b);
    let k = T::of(2.0) / (T::one() + b_b);
    let diagonal = T::one() - k * b_b;
    // `B B = b b^T - b.b I`.
    [
        [diagonal + k * b[0] * b[0], k * (b[0] * b[1] - b[2]), k * (b[0] * b[2] + b[1])],
        [k * (b[1] * b[0] + b[2]), diagonal + k * b[1] * b[1], k * (b[1] * b[2] - b[0])],
        [k * (b[2] * b[0] - b[1]), k * (b[2] * b[1] + b[0]), diagonal + k * b[2] * b[2]],
    ]
}

/// Deviatoric stress (Pa) after an elastic step, with the mid-step velocity gradient `l`:
/// `Q (S + G dev(D) dt) Q^T + G dev(D) dt`.
///
/// Half of the shear comes before the turn and half after it: the shear of a step turns half as far as the stress it is
/// added to. All of it after the turn (as Hughes & Winget print it) is first order only, and gains energy in a body that
/// spins and swings.
#[inline(always)]
pub fn trial_deviator<T: Real>(s: SymmetricTensor<T>, l: &Tensor<T>, shear_modulus: T, dt: T) -> SymmetricTensor<T> {
    let half_shear = SymmetricTensor::symmetric_part(l).deviator() * (shear_modulus * dt);
    (s + half_shear).congruence(&rotation(l, dt)) + half_shear
}

/// Fastest that a line of a particle with the velocity gradient `l` (1/s) can shorten, 1/s, or a little more: the norm of the stretching.
#[inline(always)]
pub fn strain_rate<T: Real>(l: &Tensor<T>) -> T {
    let d = SymmetricTensor::symmetric_part(l);
    d.double_dot(d).sqrt()
}

/// Density (kg/m^3) after a step: `rho exp(-tr(L) dt)`, the solution of `drho/dt = -rho div v` at constant `div v`.
#[inline]
pub fn density_after<T: Elementary>(rho: T, l: &Tensor<T>, dt: T) -> T {
    rho * exponential(-(l[0][0] + l[1][1] + l[2][2]) * dt)
}

/// What [`density_after`] adds to a density, over that density: to the last digit of its own, where the density has no room for them.
#[inline]
pub fn relative_density_change<T: Elementary>(l: &Tensor<T>, dt: T) -> T {
    let x = -(l[0][0] + l[1][1] + l[2][2]) * dt;
    T::if_lt(x.abs(), T::of(SERIES_BELOW), || exponential_series(x) * x, || x.exp() - T::one())
}

/// Density (kg/m^3) a time `dt` (s) ahead by the velocity gradient of the last step (1/s), `rho (1 - dt tr L)`: its volume is the
/// weight of both pair sums. The density of the step's start instead would lag by one step, and a body that swings about a strained
/// state would lose energy at first order.
#[inline(always)]
pub fn predicted_density<T: Real>(density: T, last_gradient: &Tensor<T>, dt: T) -> T {
    let divergence = last_gradient[0][0] + last_gradient[1][1] + last_gradient[2][2];
    // The bound matters only to a run about to fail.
    density * (T::one() - dt * divergence).max(T::of(0.1))
}

/// `exp(x)`: near zero, where a step keeps it, by its series, whose first omitted term is beyond double precision.
#[inline]
fn exponential<T: Elementary>(x: T) -> T {
    let series = || (exponential_series(x) * x).mul_add(T::one(), T::one());
    T::if_lt(x.abs(), T::of(SERIES_BELOW), series, || x.exp())
}

/// Exponents that are near zero.
const SERIES_BELOW: f64 = 1.0 / 64.0;

/// `(exp(x) - 1)/x` near zero.
#[inline(always)]
fn exponential_series<T: Real>(x: T) -> T {
    let mut sum = T::one();
    for k in (2..=7).rev() {
        sum = (sum * x).mul_add(T::of(1.0 / f64::from(k)), T::one());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::{determinant, inverse, multiply, transpose};

    fn assert_near(a: &Tensor<f64>, b: &Tensor<f64>, tolerance: f64) {
        for i in 0..3 {
            for j in 0..3 {
                assert!((a[i][j] - b[i][j]).abs() <= tolerance, "{a:?} {b:?}");
            }
        }
    }

    /// `A + s B`.
    fn plus(a: &Tensor<f64>, s: f64, b: &Tensor<f64>) -> Tensor<f64> {
        core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] + s * b[i][j]))
    }

    #[test]
    fn rotation_is_the_cayley_transform_and_proper_for_any_step() {
        let l = [[5.0, -7.0, 2.0], [3.0, 1.0, 8.0], [-4.0, 6.0, -2.0]];
        for dt in [1e-3, 0.3, 50.0] {
            let q = rotation(&l, dt);
            let w = plus(&l, -1.0, &transpose(&l));
            let (forward, backward) =
                (plus(&tensor::identity(), 0.25 * dt, &w), plus(&tensor::identity(), -0.25 * dt, &w));
            assert_near(&q, &multiply(&inverse(&backward), &forward), 1e-11);
            assert_near(&multiply(&q, &transpose(&q)), &tensor::identity(), 1e-14);
            assert!((determinant(&q) - 1.0).abs() < 1e-14);
        }
        // A quarter turn about z: tan(45 degrees) = dt/2 w.
        let spin = [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0; 3]];
        assert_near(&rotation(&spin, 1.0), &[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], 1e-15);
    }

    #[test]
    fn rigid_rotation_through_ten_turns_carries_the_stress_exactly() {
        let s0 = SymmetricTensor { xx: 3.0e8, yy: -1.0e8, zz: -2.0e8, xy: 0.5e8, yz: -0.7e8, xz: 1.1e8 };
        // Per step the body turns by one degree about a skew axis; the mid-step gradient has tan of half the angle.
        let axis = [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0];
        let (steps, dt) = (3600, 1e-6);
        let theta = core::f64::consts::PI / 180.0;
        let w = 2.0 * (0.5 * theta).tan() / dt;
        let l = [[0.0, -w * axis[2], w * axis[1]], [w * axis[2], 0.0, -w * axis[0]], [-w * axis[1], w * axis[0], 0.0]];
        let mut s = s0;
        for step in 1..=steps {
            s = trial_deviator(s, &l, 80.0e9, dt);
            if step == 90 {
                // Rodrigues' formula for the quarter turn: n n^T + N.
                let n: Tensor<f64> =
                    core::array::from_fn(|i| core::array::from_fn(|j| axis[i] * axis[j] + l[i][j] / w));
                assert_near(&s.to_tensor(), &s0.congruence(&n).to_tensor(), 1e-12 * 3.0e8);
            }
        }
        assert_near(&s.to_tensor(), &s0.to_tensor(), 1e-11 * 3.0e8);
        assert!((s.von_mises() / s0.von_mises() - 1.0).abs() < 1e-12);
        assert!((determinant(&s.to_tensor()) / determinant(&s0.to_tensor()) - 1.0).abs() < 1e-11);
        assert!(s.trace().abs() < 1e-3);
    }

    #[test]
    fn elastic_shear_and_stretch_by_hand() {
        // D_xy = 50/s, G = 80 GPa, 1 us: 2 G D dt = 8 MPa. Symmetric gradient, so no rotation.
        let shear = [[0.0, 50.0f64, 0.0], [50.0, 0.0, 0.0], [0.0; 3]];
        let s = trial_deviator(SymmetricTensor::zero(), &shear, 80.0e9, 1e-6);
        assert!((s.xy - 8.0e6).abs() < 1e-6 && s.xx == 0.0);
        // Stretch along x at 300/s: dev(D) = (200, -100, -100), 2 G dt = 45 kPa s per 1/s.
        let stretch = [[300.0f64, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        let s = trial_deviator(SymmetricTensor::diagonal(1.0e6, -1.0e6, 0.0), &stretch, 45.0e9, 5e-7);
        assert!((s.xx - 10.0e6).abs() < 1e-6 && (s.yy + 5.5e6).abs() < 1e-6 && (s.zz + 4.5e6).abs() < 1e-6);
    }

    #[test]
    fn simple_shear_follows_the_jaumann_solution_to_second_order() {
        // Truesdell 1956: under dv_x/dy = k the Jaumann rate gives S_xy = G sin(kt), S_xx = -S_yy = G (1 - cos(kt)).
        let error = |steps: u32| {
            let (g, total) = (80.0e9f64, 2.0);
            let l = [[0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]];
            let mut s = SymmetricTensor::zero();
            for _ in 0..steps {
                s = trial_deviator(s, &l, g, total / f64::from(steps));
            }
            let (xy, xx) = (g * total.sin(), g * (1.0 - total.cos()));
            ((s.xy - xy).powi(2) + (s.xx - xx).powi(2) + (s.yy + xx).powi(2)).sqrt() / g
        };
        let (coarse, fine) = (error(20), error(40));
        assert!(fine < 1e-3 && coarse / fine > 3.9 && coarse / fine < 4.1, "{coarse} {fine}");
    }

    #[test]
    fn the_series_of_the_exponential_is_exact_and_meets_the_function() {
        for x in [0.0f64, 1e-9, -3e-4, 0.0156, -0.0156, 1.0 / 64.0, 0.7, -2.0] {
            let relative = exponential(x) / x.exp() - 1.0;
            assert!(relative.abs() <= 2.0 * f64::EPSILON, "{x}: {relative}");
        }
        assert!(exponential(f64::NAN).is_nan());
    }

    #[test]
    fn small_changes_of_a_density_are_those_of_double_precision() {
        for trace in [3e-9f32, -2.5e-8, 7e-5, -0.01, 0.3] {
            let l = |trace: f32| [[trace, 9.0, 9.0], [9.0, 0.0, 9.0], [9.0, 9.0, 0.0]];
            let (found, expected) = (relative_density_change(&l(trace), 1.0), (-f64::from(trace)).exp_m1());
            assert!((f64::from(found) / expected - 1.0).abs() < 4e-7, "{trace}: {found} {expected}");
        }
    }

    #[test]
    fn predicted_density_by_hand_and_bounded() {
        let l = [[-400.0f64, 9.0, 9.0], [9.0, -350.0, 9.0], [9.0, 9.0, -250.0]];
        assert!((predicted_density(8930.0, &l, 1e-4) - 8930.0 * 1.1).abs() < 1e-9);
        assert!((predicted_density(2710.0, &l, -2e-4) - 2710.0 * 0.8).abs() < 1e-9);
        assert!((predicted_density(2710.0, &l, -1e-2) - 271.0).abs() < 1e-12);
    }

    #[test]
    fn density_follows_the_divergence() {
        // tr L = -1000/s over 0.1 ms: rho exp(0.1).
        let l = [[-400.0f64, 9.0, 9.0], [9.0, -350.0, 9.0], [9.0, 9.0, -250.0]];
        assert!((density_after(8930.0, &l, 1e-4) - 8930.0 * 1.105_170_918_075_648).abs() < 1e-8);
        assert!((density_after(2710.0, &l, -1e-4) - 2710.0 / 1.105_170_918_075_648).abs() < 1e-8);
    }
}
