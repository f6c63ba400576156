//! The total Lagrangian form: the deformation gradient of a particle, and the stress whose sum at the reference
//! positions is its force.
//!
//! With the kernel gradient `grad_0 W` of the initial positions, corrected by `B_i` so that it is exact for linear fields, and
//! initial volumes `V` (Bonet & Kulasegaram 2000; Ganzenmüller 2015):
//!
//! `dF_i/dt = sum_j V_j (v_j - v_i) ⊗ B_i grad_0 W_ij`,  `L = dF/dt F^-1`,  `rho = rho_0 / det F`,
//! `m_i dv_i/dt = sum_j V_i V_j (P_i B_i + P_j B_j) grad_0 W_ij`,  `P = det F sigma F^-T`.
//!
//! Both sums are adjoint, so energy is conserved.
//!
//! Waves on the initial lattice are shortened in the current configuration by the compression of the material: the
//! shortest length is the smoothing length times the smallest principal stretch. It replaces `h` in the time step
//! limits and in the bulk viscosity.

use crate::tensile_part::smallest_principal_value;
use crate::tensor::{apply, determinant, dot, inverse, multiply, plus, transpose};
use crate::{Elementary, Real, SymmetricTensor, Tensor, Vector};

/// Advances a deformation gradient by a step `dt` (s) with the rate `dF/dt` (1/s) and returns the velocity gradient
/// (1/s) of its middle, `dF/dt (F + dt/2 dF/dt)^-1`.
#[inline(always)]
pub fn deform<T: Real>(f: &mut Tensor<T>, rate: &Tensor<T>, dt: T) -> Tensor<T> {
    let l = velocity_gradient(f, rate, dt);
    *f = plus(f, dt, rate);
    l
}

/// The velocity gradient (1/s) at the middle of a step `dt` (s) of a deformation gradient with the rate `dF/dt` (1/s):
/// that of [`deform`].
#[inline(always)]
pub fn velocity_gradient<T: Real>(f: &Tensor<T>, rate: &Tensor<T>, dt: T) -> Tensor<T> {
    multiply(rate, &inverse(&plus(f, T::of(0.5) * dt, rate)))
}

/// Density, kg/m^3: mass (kg) over the deformed initial volume (m^d).
#[inline(always)]
pub fn density<T: Real>(mass: T, initial_volume: T, f: &Tensor<T>) -> T {
    mass / (initial_volume * determinant(f))
}

/// Smallest principal stretch: the square root of the smallest principal value of `C = F^T F`.
#[inline(always)]
pub fn smallest_stretch<T: Real>(f: &Tensor<T>) -> T {
    let c = SymmetricTensor::symmetric_part(&multiply(&transpose(f), f));
    smallest_principal_value(c).max(T::zero()).sqrt()
}

/// Principal stretch at which a body comes apart where it is liquid, if its bound is not smaller, because liquid has no
/// reason to keep its initial neighbours. With 16, the bound of a solid, the sheets of liquid metal in `penetration`
/// throw the material at their joint outwards.
pub const LARGEST_STRETCH_OF_A_LIQUID: f64 = 4.0;

/// Principal stretch, or one over it, at which the reference configuration of a body that has come apart is renewed.
/// The crater of `penetration` at 0.4 mm is 31.4, 31.1, 29.6 mm wide with 1.5, 2, 3 (linear viscosity 1); below, noise
/// due to the reset of the springs takes energy.
const AGAIN: f64 = 2.0;

/// Whether a particle of a body that has come apart is deformed so far, given its smallest principal stretch, that the
/// reference configuration is to be renewed.
#[inline(always)]
pub fn is_deformed_again(f: &Tensor<f64>, smallest_stretch: f64) -> bool {
    deformed_again(f, smallest_stretch) > 0.0
}

/// One if it is, else zero.
#[inline(always)]
pub fn deformed_again<T: Elementary>(f: &Tensor<T>, smallest_stretch: T) -> T {
    let again = T::of(AGAIN);
    let stretched = stretched(f, again);
    T::select_lt(smallest_stretch * again, T::one(), T::one(), stretched)
}

/// Whether a principal stretch is above a bound.
#[inline(always)]
pub fn is_stretched(f: &Tensor<f64>, bound: f64) -> bool {
    stretched(f, bound) > 0.0
}

/// One if a principal stretch is above a bound, else zero.
#[inline(always)]
pub fn stretched<T: Elementary>(f: &Tensor<T>, bound: T) -> T {
    // The squares of the stretches add up to the sum of the squares of all components: few particles need the principal
    // values.
    let sum = f.as_flattened().iter().fold(T::zero(), |sum, c| sum + *c * *c);
    let beyond = || {
        let c = SymmetricTensor::symmetric_part(&multiply(&transpose(f), f));
        // The largest principal value of C is minus the smallest of -C.
        let largest = -smallest_principal_value(c * T::of(-1.0));
        T::select_lt(bound * bound, largest, T::one(), T::zero())
    };
    T::if_lt(bound * bound, sum, beyond, T::zero)
}

/// The length in the time step limits of a particle with that smoothing length (m) and smallest principal stretch, m.
///
/// Limits of the form `courant h/c` have a margin: a copper bar of 12 particles across at 190 m/s, its foot at a fifth
/// of its height, is the same to three digits at Courant numbers of 0.3, 0.6 and 0.9 of `h stretch/c`. At the usual 0.3
/// this margin is used for compression down to one half before the step decreases.
#[inline(always)]
pub fn limiting_length<T: Real>(h: T, smallest_stretch: T) -> T {
    h * (T::of(2.0) * smallest_stretch).min(T::one())
}

/// Position in the initial configuration, relative to the centre (m), of the point of a particle that is farthest along
/// a unit normal now.
///
/// The deformation gradient turns the ball of half a spacing (m) that the particle is at rest into an ellipsoid, whose
/// extreme point is `F xi`, `xi = spacing/2 F^T n/|F^T n|`, at the distance `n . F xi = spacing/2 |F^T n|`. A wall acts
/// on the particle at the opposite point, `x - F xi`. The moment of its force `f` about the centre enters the sums of
/// the form as the stress `P = f ⊗ xi/V_0`: the power of the force minus that of this stress is `f . (v - dF/dt xi)`,
/// that at the face.
#[inline(always)]
pub fn extreme_point<T: Real>(spacing: T, f: &Tensor<T>, normal: Vector<T>) -> Vector<T> {
    let along = [0, 1, 2].map(|a| f[0][a] * normal[0] + f[1][a] * normal[1] + f[2][a] * normal[2]);
    let length = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt();
    along.map(|c| T::of(0.5) * spacing * c / length)
}

/// The point of a particle at which a wall acts ([`extreme_point`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeetingPoint<T> {
    /// Its distance from the centre against the normal of the wall, m.
    pub radius: T,
    /// Its position in the initial configuration relative to the centre, with the sign reversed, m.
    pub place: Vector<T>,
    /// Its velocity, m/s.
    pub velocity: Vector<T>,
}

impl<T: Real> MeetingPoint<T> {
    /// For a particle of this spacing (m), with its deformation gradient since the start, velocity gradient (1/s) and
    /// velocity (m/s), and a wall with this unit normal.
    #[inline(always)]
    pub fn new(spacing: T, f: &Tensor<T>, l: &Tensor<T>, velocity: Vector<T>, normal: Vector<T>) -> Self {
        let place = extreme_point(spacing, f, normal);
        let arm = apply(f, place);
        let spin = apply(l, arm);
        Self { radius: dot(normal, arm), place, velocity: [0, 1, 2].map(|a| velocity[a] - spin[a]) }
    }
}

/// The tensor whose sum is the force on a particle, Pa: the first Piola–Kirchhoff stress of its Cauchy stress (Pa) plus
/// that of the forces on its faces (Pa), times its gradient correction.
#[inline(always)]
pub fn force_tensor<T: Real>(
    stress: SymmetricTensor<T>,
    f: &Tensor<T>,
    face_stress: &Tensor<T>,
    correction: &Tensor<T>,
) -> Tensor<T> {
    multiply(&total_first_piola(stress, f, face_stress), correction)
}

/// The first Piola–Kirchhoff stress of a Cauchy stress plus that of the forces on the faces of a particle, Pa.
#[inline(always)]
pub fn total_first_piola<T: Real>(stress: SymmetricTensor<T>, f: &Tensor<T>, face_stress: &Tensor<T>) -> Tensor<T> {
    let mut piola = first_piola(stress, f);
    for (own, face) in piola.as_flattened_mut().iter_mut().zip(face_stress.as_flattened()) {
        *own += *face;
    }
    piola
}

/// `P = det F sigma F^-T`, the first Piola–Kirchhoff stress of a Cauchy stress: force per initial area, Pa.
#[inline(always)]
pub fn first_piola<T: Real>(stress: SymmetricTensor<T>, f: &Tensor<T>) -> Tensor<T> {
    let j = determinant(f);
    let mut p = multiply(&stress.to_tensor(), &transpose(&inverse(f)));
    for row in &mut p {
        for c in row {
            *c = j * *c;
        }
    }
    p
}

/// Young's modulus `9 K G/(3 K + G)`, Pa, from bulk and shear modulus, Pa.
#[inline(always)]
pub fn young_modulus<T: Real>(bulk: T, shear: T) -> T {
    T::of(9.0) * bulk * shear / (T::of(3.0) * bulk + shear)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_stretch_is_the_smallest_singular_value() {
        let diagonal = |a: f64, b: f64, c: f64| [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]];
        // A rotation by 0.7 about z, then one by -0.4 about x.
        let (s, c, t, d) = (0.7f64.sin(), 0.7f64.cos(), (-0.4f64).sin(), 0.4f64.cos());
        let q = multiply(&[[1.0, 0.0, 0.0], [0.0, d, -t], [0.0, t, d]], &[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]);
        let cases =
            [(1.0, 1.0, 1.0), (0.2, 2.1, 2.4), (0.1, 1.0, 9.0), (0.5, 0.5, 4.0), (3.0, 3.0, 2.0), (1.0, 1.0, 1.000001)];
        for (a, b, c) in cases {
            let smallest = a.min(b).min(c);
            for f in [
                diagonal(a, b, c),
                diagonal(c, a, b),
                multiply(&q, &diagonal(b, c, a)),
                multiply(&diagonal(a, b, c), &q),
            ] {
                let found = smallest_stretch(&f);
                assert!((found - smallest).abs() < 1e-12 * c.max(b) * c.max(b) / smallest, "{a} {b} {c}: {found}");
            }
        }
        // Round-off about no deformation at all must not matter.
        for k in 0..1000 {
            let noise = |l: i32| 1e-15 * f64::from((k * 7919 + l * 104_729) % 17 - 8);
            let f =
                [[1.0 + noise(0), noise(1), noise(2)], [noise(3), 1.0 + noise(4), noise(5)], [noise(6), noise(7), 1.0]];
            assert!((smallest_stretch(&f) - 1.0).abs() < 1e-13);
        }
        // Simple shear by 2: 1/(1 + sqrt 2).
        let shear = [[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!((smallest_stretch(&shear) - (2.0f64.sqrt() - 1.0)).abs() < 1e-9);
        assert_eq!(smallest_stretch(&diagonal(0.0, 1.0, 1.0)), 0.0);
        assert_eq!(
            (limiting_length(3.0, 0.25), limiting_length(3.0, 0.75), limiting_length(3.0, 1.5)),
            (1.5, 3.0, 3.0)
        );
    }
    use crate::tensor::identity;

    #[test]
    fn stretched_is_long_whatever_the_frame() {
        let diagonal = |a: f64, b: f64, c: f64| [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]];
        let (s, c) = (0.7f64.sin(), 0.7f64.cos());
        let turn = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        for turned in [multiply(&turn, &diagonal(1.0, 3.0, 0.5)), multiply(&diagonal(3.0, 0.5, 1.0), &turn)] {
            assert!(is_stretched(&turned, 2.99) && !is_stretched(&turned, 3.01));
        }
        // The sum of the squares alone, 3 1.9^2, would be above 2^2; flat is not long.
        assert!(!is_stretched(&diagonal(1.9, 1.9, 1.9), 2.0) && !is_stretched(&diagonal(0.1, 1.1, 1.1), 2.0));
        // Alone: the squares add up to little more than that of the bound.
        assert!(is_stretched(&diagonal(1.6, 0.1, 0.1), 1.5) && !is_stretched(&diagonal(1.4, 0.1, 0.1), 1.5));
        // Simple shear by 2: 1 + sqrt 2.
        let shear = [[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(is_stretched(&shear, 2.41) && !is_stretched(&shear, 2.42));
    }

    #[test]
    fn what_has_come_apart_is_renewed_where_it_is_twice_as_long_or_half_as_thick() {
        let diagonal = |x: f64, y: f64| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, 1.0]];
        for (x, y, expected) in [(2.01, 1.0, true), (1.99, 0.51, false), (1.0, 0.49, true)] {
            let f = diagonal(x, y);
            assert_eq!(is_deformed_again(&f, smallest_stretch(&f)), expected, "{x} {y}");
        }
    }

    #[test]
    fn a_particle_is_as_thick_as_it_was_pressed() {
        // Pressed to a quarter along z, in a frame turned by 30 degrees about x before.
        let (s, c) = (0.5f64, 0.75f64.sqrt());
        let pressed = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.25]];
        let turned = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]];
        let f = multiply(&pressed, &turned);
        let half_extent = |spacing: f64, f: &Tensor<f64>, n: Vector<f64>| {
            let xi = extreme_point(spacing, f, n);
            (0..3).map(|a| n[a] * (0..3).map(|b| f[a][b] * xi[b]).sum::<f64>()).sum::<f64>()
        };
        assert!((half_extent(0.8, &f, [0.0, 0.0, 1.0]) - 0.1).abs() < 1e-15);
        assert!((half_extent(0.8, &f, [0.0, -1.0, 0.0]) - 0.8).abs() < 1e-15);
        let xi = extreme_point(0.8, &f, [0.0, 0.0, 1.0]);
        assert!(xi[0] == 0.0 && (xi[1] - 0.2).abs() < 1e-15 && (xi[2] - 0.4 * c).abs() < 1e-15, "{xi:?}");
        // Sheared by one, sqrt(2)/2 times the spacing along the direction of shear, half of it across.
        let f = [[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!((half_extent(1.0, &f, [1.0, 0.0, 0.0]) - 0.5f64.sqrt()).abs() < 1e-15);
        assert!((half_extent(1.0, &f, [0.0, 1.0, 0.0]) - 0.5).abs() < 1e-15);
        // No point of the sphere is farther along the normal.
        let (n, farthest) = ([0.6, 0.0, 0.8], half_extent(1.0, &f, [0.6, 0.0, 0.8]));
        for k in 0..100 {
            let (u, w) = (0.7 * f64::from(k), 0.31 * f64::from(k));
            let point = [0.5 * u.cos() * w.sin(), 0.5 * u.sin() * w.sin(), 0.5 * w.cos()];
            let along: f64 = (0..3).map(|a| n[a] * (0..3).map(|b| f[a][b] * point[b]).sum::<f64>()).sum();
            assert!(along <= farthest);
        }
    }

    #[test]
    fn a_point_that_meets_a_wall_turns_with_its_particle() {
        // Twice as thick along z, which turns about y at 3/s and closes at 5/s: the point is 1 m below the centre.
        let f = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]];
        let l = [[0.0, 0.0, 3.0], [0.0; 3], [0.0, 0.0, -5.0f64]];
        let point = MeetingPoint::new(1.0, &f, &l, [7.0, 0.0, 11.0], [0.0, 0.0, 1.0]);
        assert_eq!(point, MeetingPoint { radius: 1.0, place: [0.0, 0.0, 0.5], velocity: [4.0, 0.0, 16.0] });
        let point = MeetingPoint::new(0.5, &f, &l, [0.0; 3], [-1.0, 0.0, 0.0]);
        assert_eq!(point, MeetingPoint { radius: 0.25, place: [-0.25, 0.0, 0.0], velocity: [0.0; 3] });
    }

    #[test]
    fn the_tensor_of_the_forces_by_hand() {
        // P = J sigma F^-T = 2 (6, 10)/(2, 1), with a moment of faces, twice corrected along y.
        let f = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0f64]];
        let stress = SymmetricTensor { xx: 6.0, yy: 10.0, ..SymmetricTensor::zero() };
        let face = [[1.0, 3.0, 0.0], [0.0, -4.0, 0.0], [0.0; 3]];
        let correction = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
        let tensor = force_tensor(stress, &f, &face, &correction);
        assert_eq!(tensor, [[7.0, 6.0, 0.0], [0.0, 32.0, 0.0], [0.0; 3]]);
    }

    #[test]
    fn a_step_by_hand() {
        // Stretch at 2/s from F = 1 over 0.5 s: F = 2, and 2/1.5 in the middle; shear is half as much of the stretched line.
        let mut f = identity();
        let l = deform(&mut f, &[[2.0, 1.0, 0.0], [0.0; 3], [0.0; 3]], 0.5);
        assert_eq!(f, [[2.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        // (F + dF/2)^-1 = [[1/1.5, -0.25/1.5], [0, 1]].
        assert!((l[0][0] - 4.0 / 3.0).abs() < 1e-15 && (l[0][1] - 2.0 / 3.0).abs() < 1e-15 && l[1] == [0.0; 3]);
        assert_eq!(density(12.0, 1.5, &f), 4.0);
        // On from there: turning it all by the same rate gives that rate back.
        let l = deform(&mut f, &[[0.0, 0.0, 0.0], [4.0, 1.0, 0.0], [0.0; 3]], 0.0);
        assert_eq!((l[1], f[0][0]), ([2.0, 0.0, 0.0], 2.0));
        assert_eq!(density(12.0, 1.0, &f), 6.0);
    }

    #[test]
    fn the_first_piola_stress_of_uniaxial_tension_is_force_over_initial_area() {
        // Stretched by 1.2 along x, thinned to 0.9 and 0.8 across: the area is 0.72 of the initial one.
        let f = [[1.2, 0.0, 0.0], [0.0, 0.9, 0.0], [0.0, 0.0, 0.8f64]];
        let p = first_piola(SymmetricTensor { xx: 500.0, ..SymmetricTensor::zero() }, &f);
        assert!((p[0][0] - 360.0).abs() < 1e-9, "{p:?}");
        // A simple shear moves no normal force but tilts the face it acts on: P = J sigma F^-T.
        let f = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0f64]];
        let p = first_piola(SymmetricTensor { xy: 100.0, ..SymmetricTensor::zero() }, &f);
        assert!((p[0][0] + 50.0).abs() < 1e-9 && (p[0][1] - 100.0).abs() < 1e-9 && (p[1][0] - 100.0).abs() < 1e-9);
    }

    #[test]
    fn young_modulus_by_hand() {
        // Steel: K 160 GPa, G 80 GPa: 9 160 80/560. Copper: K 140, G 45.
        assert!((young_modulus(160.0f64, 80.0) - 205.714_285_714_285_7).abs() < 1e-12);
        assert!((young_modulus(140.0f64, 45.0) - 9.0 * 6300.0 / 465.0).abs() < 1e-12);
        assert_eq!(young_modulus(2.0f64, 0.0), 0.0);
    }
}
