//! Elasticity with a stored energy of the deformation gradient: what is deformed and brought back has gained and lost
//! nothing, however far and by whichever way.
//!
//! The compressible neo-Hookean solid stores `G/2 (tr C* - 3)` per initial volume in shear, with `C* = J^(-2/3) F^T F`
//! and `J = det F` (Simo & Pister 1984; Bonet & Wood 2008, Eq 6.52), and what the equation of state stores in volume.
//! Its Cauchy stress is the deviator
//!
//! `S = G J^(-5/3) dev(F F^T)`
//!
//! and the pressure. For small strains this is Hooke's law, `S = 2 G dev(eps)`.
//!
//! All functions have the displacement gradient `H = F - 1` as argument: `F F^T - 1 = H + H^T + H H^T` keeps all digits of
//! small strains, which `F` in single precision has not.

use crate::tensor::multiply;
use crate::{Elementary, Real, SymmetricTensor, Tensor};

/// `F F^T - 1` from `H = F - 1`.
#[inline(always)]
fn finger_strain<T: Real>(h: &Tensor<T>) -> SymmetricTensor<T> {
    let product = |a: usize, b: usize| h[a][0] * h[b][0] + h[a][1] * h[b][1] + h[a][2] * h[b][2];
    let of = |a: usize, b: usize| h[a][b] + h[b][a] + product(a, b);
    SymmetricTensor { xx: of(0, 0), yy: of(1, 1), zz: of(2, 2), xy: of(0, 1), yz: of(1, 2), xz: of(0, 2) }
}

/// `det F - 1` from `H = F - 1`.
#[inline(always)]
fn relative_dilatation<T: Real>(h: &Tensor<T>) -> T {
    let minor = |a: usize, b: usize| h[a][a] * h[b][b] - h[a][b] * h[b][a];
    let determinant = h[0][0] * (h[1][1] * h[2][2] - h[1][2] * h[2][1])
        - h[0][1] * (h[1][0] * h[2][2] - h[1][2] * h[2][0])
        + h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
    (h[0][0] + h[1][1] + h[2][2]) + (minor(0, 1) + minor(1, 2) + minor(0, 2)) + determinant
}

/// `H = F F_e - 1` of the displacement gradient `F - 1` since a renewal of the reference configuration and `F_e - 1`, that
/// before it.
#[inline(always)]
pub fn composed<T: Real>(since: &Tensor<T>, earlier: &Tensor<T>) -> Tensor<T> {
    let mut h = multiply(since, earlier);
    for a in 0..3 {
        for b in 0..3 {
            h[a][b] += since[a][b] + earlier[a][b];
        }
    }
    h
}

/// `F - 1`.
#[inline(always)]
pub fn minus_identity<T: Real>(f: &Tensor<T>) -> Tensor<T> {
    let mut h = *f;
    for a in 0..3 {
        h[a][a] -= T::one();
    }
    h
}

/// Deviatoric Cauchy stress, Pa, of the displacement gradient `H = F - 1` and the shear modulus, Pa.
#[inline(always)]
pub fn neo_hookean_deviator<T: Elementary>(h: &Tensor<T>, shear_modulus: T) -> SymmetricTensor<T> {
    let j = T::one() + relative_dilatation(h);
    finger_strain(h).deviator() * (shear_modulus * j.powf(T::of(-5.0 / 3.0)))
}

/// Newton steps of [`neo_hookean_energy_of_stress`]: from above, where the cubic is convex, each halves the distance at
/// least, and near the root it squares it.
const NEWTON_STEPS: usize = 16;

/// Energy stored in shear per initial volume, J/m^3, of the deviatoric Cauchy stress (Pa) and `J` instead of the
/// deformation. With `D = S J/G`, the deviator of `b = J^(-2/3) F F^T`, the trace `3 (1 + n)` of `b` follows from
/// `det b = 1`, that is `n^3 + 3 n^2 + (3 - I) n + det D - I = 0` with `I = D : D/2`.
#[inline(always)]
pub fn neo_hookean_energy_of_stress<T: Real>(deviator: SymmetricTensor<T>, j: T, shear_modulus: T) -> T {
    let d = deviator * (j / shear_modulus);
    let square = T::of(0.5) * d.double_dot(d);
    let determinant =
        d.xx * (d.yy * d.zz - d.yz * d.yz) - d.xy * (d.xy * d.zz - d.yz * d.xz) + d.xz * (d.xy * d.yz - d.yy * d.xz);
    let (three, linear) = (T::of(3.0), T::of(3.0) - square);
    let mut n = T::of(1.2) * square.sqrt();
    for _ in 0..NEWTON_STEPS {
        let value = ((n + three) * n + linear) * n + (determinant - square);
        let slope = (three * n + T::of(6.0)) * n + linear;
        n -= value / slope;
    }
    T::of(1.5) * shear_modulus * n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::{determinant, identity};
    use crate::total_lagrangian::first_piola;

    const G: f64 = 6.5;

    /// Energy stored in shear per initial volume, J/m^3, of the displacement gradient `H = F - 1` and the shear modulus, Pa, as
    /// the law has it: the digits of small strains are lost.
    fn neo_hookean_shear_energy(h: &Tensor<f64>, shear_modulus: f64) -> f64 {
        let trace = (3.0 + finger_strain(h).trace()) * (1.0 + relative_dilatation(h)).powf(-2.0 / 3.0);
        0.5 * shear_modulus * (trace - 3.0)
    }

    fn deviator(f: &Tensor<f64>) -> SymmetricTensor<f64> {
        neo_hookean_deviator(&minus_identity(f), G)
    }

    fn assert_near(found: SymmetricTensor<f64>, expected: SymmetricTensor<f64>, tolerance: f64) {
        for (a, b) in found.to_array().into_iter().zip(expected.to_array()) {
            assert!((a - b).abs() <= tolerance, "{found:?}, {expected:?}");
        }
    }

    /// Far from anything symmetric.
    const ANY: Tensor<f64> = [[1.3, 0.4, -0.2], [-0.1, 0.8, 0.3], [0.25, -0.35, 1.1]];

    #[test]
    fn uniaxial_stretch_at_constant_volume_by_hand() {
        // b = diag(4, 1/2, 1/2), trace 5: G (4 - 5/3), G (1/2 - 5/3); sigma_xx - sigma_yy = G (lambda^2 - 1/lambda).
        let f = [[2.0, 0.0, 0.0], [0.0, 0.5f64.sqrt(), 0.0], [0.0, 0.0, 0.5f64.sqrt()]];
        let s = deviator(&f);
        assert_near(s, SymmetricTensor::diagonal(G * 7.0 / 3.0, -G * 7.0 / 6.0, -G * 7.0 / 6.0), 1e-13);
        assert!((s.xx - s.yy - G * 3.5).abs() < 1e-13);
        // G/2 (5 - 3).
        assert!((neo_hookean_shear_energy(&minus_identity(&f), G) - G).abs() < 1e-13);
    }

    #[test]
    fn simple_shear_has_the_normal_stresses_of_poynting() {
        // b = [[1 + g^2, g, 0], [g, 1, 0], [0, 0, 1]] with g = 3/2.
        let s = deviator(&[[1.0, 1.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(
            (s.xy - 1.5 * G).abs() < 1e-13 && (s.xx - s.yy - 2.25 * G).abs() < 1e-13 && (s.yy - s.zz).abs() < 1e-13
        );
        assert!(s.trace().abs() < 1e-13);
    }

    #[test]
    fn a_change_of_volume_alone_stores_nothing_in_shear_and_softens_what_is_sheared() {
        for scale in [0.7, 1.0, 1.6] {
            let f = identity::<f64>().map(|row| row.map(|c| scale * c));
            assert_near(deviator(&f), SymmetricTensor::zero(), 1e-14);
            assert!(neo_hookean_shear_energy(&minus_identity(&f), G).abs() < 1e-14);
            // The same shape with a volume of `scale^3`: J^(-5/3) scale^2 = scale^-3.
            let sheared = ANY.map(|row| row.map(|c| scale * c));
            assert_near(deviator(&sheared) * scale.powi(3), deviator(&ANY), 1e-13);
        }
    }

    #[test]
    fn a_turn_turns_the_stress_and_a_turn_before_changes_nothing() {
        let (s, c) = (2.5f64.sin(), 2.5f64.cos());
        let turn = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        assert_near(deviator(&multiply(&turn, &ANY)), deviator(&ANY).congruence(&turn), 1e-13);
        assert_near(deviator(&multiply(&ANY, &turn)), deviator(&ANY), 1e-13);
        assert_near(deviator(&turn), SymmetricTensor::zero(), 1e-14);
    }

    #[test]
    fn the_stress_is_the_gradient_of_the_stored_energy() {
        let energy = |f: &Tensor<f64>| neo_hookean_shear_energy(&minus_identity(f), G);
        let p = first_piola(deviator(&ANY), &ANY);
        for a in 0..3 {
            for b in 0..3 {
                let at = |step: f64| {
                    let mut f = ANY;
                    f[a][b] += step;
                    energy(&f)
                };
                let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((slope - p[a][b]).abs() < 1e-8, "{a}{b}: {slope} {}", p[a][b]);
            }
        }
        assert!(determinant(&ANY) > 0.0);
    }

    #[test]
    fn what_is_deformed_and_brought_back_another_way_has_gained_nothing() {
        // Sheared, stretched, turned, sheared back, pressed back, turned back: the corners of a path of deformations.
        let turned = [[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
        let corners = [
            identity(),
            [[1.0, 1.2, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[1.7, 1.2, 0.0], [0.0, 1.0, 0.3], [0.0, 0.0, 0.8]],
            multiply(&turned, &[[1.7, 0.4, 0.0], [0.0, 1.0, 0.3], [0.0, 0.0, 0.8]]),
            multiply(&turned, &[[0.9, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.0, 1.0]]),
            identity(),
        ];
        let (mut work, mut way) = (0.0, 0.0);
        let steps = 2000;
        for ends in corners.windows(2) {
            for k in 0..steps {
                let at = |s: f64| {
                    let mix = |a: usize, b: usize| ends[0][a][b] + s * (ends[1][a][b] - ends[0][a][b]);
                    [0, 1, 2].map(|a| [0, 1, 2].map(|b| mix(a, b)))
                };
                let f = at((f64::from(k) + 0.5) / f64::from(steps));
                let p = first_piola(deviator(&f), &f);
                for a in 0..3 {
                    for b in 0..3 {
                        let done = p[a][b] * (ends[1][a][b] - ends[0][a][b]) / f64::from(steps);
                        (work, way) = (work + done, way + done.abs());
                    }
                }
            }
        }
        assert!(way > 5.0 * G && work.abs() < 1e-6 * way, "{work:e} of {way}");
    }

    #[test]
    fn small_strains_are_hooke_in_single_precision_too() {
        // A strain of 3e-9 and a turn of 1e-9, of which `F` in single precision knows nothing.
        let h = [[3e-9f32, 2e-9, 0.0], [0.0, -1e-9, 0.0], [0.0, 0.0, 0.0]];
        let s = neo_hookean_deviator(&h, 2.0f32);
        let eps = SymmetricTensor::symmetric_part(&h).deviator() * 4.0f32;
        for (a, b) in s.to_array().into_iter().zip(eps.to_array()) {
            assert!((a - b).abs() < 1e-15, "{s:?} {eps:?}");
        }
    }

    #[test]
    fn the_whole_deformation_is_that_since_the_renewal_after_the_one_before() {
        let earlier = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let whole = |f: &Tensor<f64>, e: &Tensor<f64>| composed(&minus_identity(f), &minus_identity(e));
        let h = whole(&ANY, &earlier);
        // ANY's first row: 1.3, 1.3/2 + 0.4, -0.2.
        assert!((h[0][0] - 0.3).abs() < 1e-15 && (h[0][1] - 1.05).abs() < 1e-15 && (h[0][2] + 0.2).abs() < 1e-15);
        assert!((whole(&earlier, &ANY)[0][1] - 0.8).abs() < 1e-15);
    }

    #[test]
    fn the_energy_of_a_stress_is_that_of_the_deformation_which_has_it() {
        let stretched = |x: f64| [[x, 0.0, 0.0], [0.0, 1.0 / x.sqrt(), 0.0], [0.0, 0.0, 1.0 / x.sqrt()]];
        let larger = ANY.map(|row| row.map(|c| 1.3 * c));
        let sheared = [[1.0, 8.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for f in [ANY, larger, stretched(4.0), stretched(0.2), sheared, identity()] {
            let expected = neo_hookean_shear_energy(&minus_identity(&f), G);
            let found = neo_hookean_energy_of_stress(deviator(&f), determinant(&f), G);
            assert!((found - expected).abs() < 1e-12 * (G + expected), "{f:?}: {found} {expected}");
        }
        // Small stresses are those of Hooke, `S:S/(4 G)`, to all digits.
        let s = SymmetricTensor { xx: 2e-9, yy: -1e-9, zz: -1e-9, xy: 3e-9, yz: 0.0, xz: 1e-9 };
        let found = neo_hookean_energy_of_stress(s, 1.0, G);
        assert!((found / (s.double_dot(s) / (4.0 * G)) - 1.0).abs() < 1e-8, "{found}");
    }
}
