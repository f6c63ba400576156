//! Bodies of one layer of particles in the total Lagrangian form: membranes, and wires of one particle across.
//!
//! Neighbours that lie in a plane or on a line say nothing of the deformation across it: the moment matrix of the gradient correction is
//! singular. Its pseudo-inverse `B` gives the columns of `F` along the directions `T` that there are. The others follow from what a
//! thin body is: its normals stay normals, `F N = lambda n` with `n` across `F T`, and no stress acts on its free faces,
//! `sigma n = 0`. With the projections `P_N` on the directions without neighbours and `P_n` on those across the deformed body,
//!
//! ```text
//! L = L_t - (P_n L_t)^T + d P_n - P_t sigma P_n/(G dt),   L_t = F' P_T F^-1,   d = -(l tr(L_t) + s/dt)/(k l + 2 G),   l = K - 2 G/3
//! ```
//!
//! `k` is the number of directions across, `s` the mean stress across at the start of the step; an elastic step takes it and the shear
//! stress `P_t sigma P_n` to zero. The
//! sums do no work with the stress across, because `B N = 0`. A body of this kind has tension, shear in its plane and inertia; it
//! resists bending by its hourglass springs alone.

use crate::gradient_correction::correction_or;
use crate::tensor::{determinant, identity, inverse, multiply, transpose};
use crate::{Dimension, Elementary, Real, SymmetricTensor, Tensor};

/// Ratios of the invariants of a tensor below which it is one without some direction.
const DEFICIENT: f64 = 1e-4;

/// The gradient correction of a configuration that the sums keep: [`gradient_correction`](crate::gradient_correction), and where a moment
/// has no inverse the pseudo-inverse of [`thin_correction`].
pub fn reference_correction<T: Elementary>(moment: &Tensor<T>, dimension: Dimension, largest: T) -> Tensor<T> {
    correction_or(moment, dimension, largest, || thin_correction(moment, dimension, largest))
}

/// Largest component of the gradient correction in a body that has come apart, twice that at a flat free surface.
/// Particles with few neighbours on one side are common there, and rates of ten times the plain gradient are noise that
/// takes energy: with the usual bound the internal energy of the disc of `penetration` becomes negative.
const LARGEST_COMPONENT_APART: f64 = 4.0;

/// The gradient correction of a body that has come apart: [`gradient_correction`](crate::gradient_correction) within a smaller bound and
/// never [thin](is_thin). Where a moment cannot be inverted there is no correction, but a moment larger than that of a full neighbourhood
/// is taken back to that size. The plain gradient counts each neighbour with its volume: two particles that fly apart would expand each
/// other faster the more they have expanded, to no density at all in a time that ends, and press each other harder than a step resolves.
pub fn correction_of_pieces<T: Elementary>(moment: &Tensor<T>, dimension: Dimension) -> Tensor<T> {
    let count = dimension.count();
    let full = T::of(count as f64);
    let mut squared = T::zero();
    for row in &moment[..count] {
        for c in &row[..count] {
            squared += *c * *c;
        }
    }
    // Asked this way, a moment that is not a number corrects nothing.
    let scale = T::select_lt(full, squared, (full / squared.max(full)).sqrt(), T::one());
    let plain = || scaled(&identity(), scale);
    let mut b = correction_or(moment, dimension, T::of(LARGEST_COMPONENT_APART), plain);
    // Axes not computed in are like the others, so that volumes that are all large make no direction stand out.
    let mut mean = T::zero();
    for (a, row) in b.iter().enumerate().take(count) {
        mean += row[a] * T::of(1.0 / count as f64);
    }
    for (a, row) in b.iter_mut().enumerate().skip(count) {
        row[a] = mean;
    }
    T::if_lt(T::zero(), is_thin(&b), plain, || b)
}

/// The correction of particles whose neighbours lie in a plane or on a line, to well within the size of the kernel: the pseudo-inverse of
/// the moment, in which the directions count that need no more than `largest` in it, with a unit on the axes not computed in. The unit
/// tensor where that is not all.
pub fn thin_correction<T: Elementary>(moment: &Tensor<T>, dimension: Dimension, largest: T) -> Tensor<T> {
    let mut m = identity();
    for a in 0..dimension.count() {
        for b in 0..dimension.count() {
            m[a][b] = moment[a][b];
        }
    }
    let missing = missing_directions(&m, dimension);
    let there = minus(&identity(), &missing);
    let m = multiply(&multiply(&there, &m), &there);
    let b = minus(&inverse(&plus(&m, &missing)), &missing);
    let mut bounded = T::one();
    for c in b.as_flattened() {
        // Asked this way, a component that is not a number fails.
        bounded = T::select_lt(c.abs(), largest, bounded, T::zero());
    }
    T::if_lt(T::zero(), bounded, || b, identity)
}

/// The projection on the direction, or the two, in which a symmetric tensor that is nearly singular is least.
fn missing_directions<T: Elementary>(m: &Tensor<T>, dimension: Dimension) -> Tensor<T> {
    let adjugate = cofactors(m);
    let one_missing = sharpened(&adjugate);
    if dimension != Dimension::Three {
        return one_missing;
    }
    let trace = trace(m);
    let is_line = || minus(&identity(), &sharpened(m));
    T::if_lt(self::trace(&adjugate), T::of(DEFICIENT) * trace * trace, is_line, || one_missing)
}

/// A symmetric tensor with one large principal value, over it, without the others.
fn sharpened<T: Real>(m: &Tensor<T>) -> Tensor<T> {
    let mut p = scaled(m, T::one() / trace(m));
    for _ in 0..3 {
        p = multiply(&p, &p);
        p = scaled(&p, T::one() / trace(&p));
    }
    p
}

/// One for a correction of [`thin_correction`] that lacks a direction, else zero.
pub fn is_thin<T: Real>(correction: &Tensor<T>) -> T {
    let mean = trace(correction) * T::of(1.0 / 3.0);
    T::select_lt(determinant(correction), T::of(DEFICIENT) * mean * mean * mean, T::one(), T::zero())
}

/// Passes to the configuration of mid-step.
const PASSES: u32 = 3;

/// What the material of a thin body is like across it.
#[derive(Clone, Copy, Debug)]
pub struct Across<T> {
    /// Bulk and shear modulus, Pa.
    pub bulk_modulus: T,
    /// Pa.
    pub shear_modulus: T,
    /// Cauchy stress, Pa.
    pub stress: SymmetricTensor<T>,
}

/// The rate of a deformation gradient, 1/s, of which the sums with a correction that [is thin](is_thin) give `rate`.
pub fn completed_rate<T: Elementary>(
    f: &Tensor<T>,
    rate: &Tensor<T>,
    correction: &Tensor<T>,
    across: &Across<T>,
    dt: T,
) -> Tensor<T> {
    let adjugate = cofactors(correction);
    let trace_squared = trace(correction) * trace(correction);
    let line = minus(&identity(), &scaled(correction, T::one() / trace(correction)));
    let is_line = T::select_lt(trace(&adjugate), T::of(DEFICIENT) * trace_squared, T::one(), T::zero());
    let missing = T::if_lt(T::zero(), is_line, || line, || scaled(&adjugate, T::one() / trace(&adjugate)));
    let count = T::one() + is_line;

    // What the missing columns lose or gain by it in a configuration.
    let missing_rate = |f: &Tensor<T>| {
        let inverse = inverse(f);
        let normal = T::if_lt(
            T::zero(),
            is_line,
            || {
                let along = multiply(&multiply(f, &minus(&identity(), &missing)), &transpose(f));
                // The tangent is that of the line alone where the correction has no other direction.
                minus(&identity(), &scaled(&along, T::one() / trace(&along)))
            },
            || {
                let covector = multiply(&multiply(&transpose(&inverse), &missing), &inverse);
                scaled(&covector, T::one() / trace(&covector))
            },
        );
        let along = multiply(rate, &inverse);
        let lame = across.bulk_modulus - T::of(2.0 / 3.0) * across.shear_modulus;
        // A pascal where nothing is known yet.
        let stiffness = (count * lame + T::of(2.0) * across.shear_modulus).max(T::one());
        // An evaluation that takes no time relaxes nothing.
        let frequency = T::select_lt(T::zero(), dt, T::one() / dt.max(T::of(1e-30)), T::zero());
        let traction = multiply(&across.stress.to_tensor(), &normal);
        let stress = trace(&traction) / count;
        let thinning = -(lame * trace(&along) + frequency * stress) / stiffness;
        let shear = minus(&traction, &multiply(&normal, &traction));
        let sheared = scaled(&shear, frequency / across.shear_modulus.max(T::one()));
        let turned = transpose(&multiply(&normal, &along));
        let l = minus(&minus(&scaled(&normal, thinning), &turned), &sheared);
        multiply(&l, &multiply(f, &missing))
    };
    // The configuration of mid-step depends on what is sought. Every pass takes the error by the square of the angle of a step.
    let half = T::of(0.5) * dt;
    let mut completed = plus(rate, &missing_rate(f));
    for _ in 0..PASSES {
        completed = plus(rate, &missing_rate(&plus(f, &scaled(&completed, half))));
    }
    completed
}

fn trace<T: Real>(m: &Tensor<T>) -> T {
    m[0][0] + m[1][1] + m[2][2]
}

/// Transposed cofactors: the adjugate, `det(M) M^-1`.
fn cofactors<T: Real>(m: &Tensor<T>) -> Tensor<T> {
    let minor = |a: usize, b: usize, c: usize, d: usize| m[a][b] * m[c][d] - m[a][d] * m[c][b];
    [
        [minor(1, 1, 2, 2), minor(0, 2, 2, 1), minor(0, 1, 1, 2)],
        [minor(1, 2, 2, 0), minor(0, 0, 2, 2), minor(0, 2, 1, 0)],
        [minor(1, 0, 2, 1), minor(0, 1, 2, 0), minor(0, 0, 1, 1)],
    ]
}

fn scaled<T: Real>(m: &Tensor<T>, s: T) -> Tensor<T> {
    m.map(|row| row.map(|c| s * c))
}

fn plus<T: Real>(a: &Tensor<T>, b: &Tensor<T>) -> Tensor<T> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[i][j] + b[i][j]))
}

fn minus<T: Real>(a: &Tensor<T>, b: &Tensor<T>) -> Tensor<T> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[i][j] - b[i][j]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gradient_correction::LARGEST_COMPONENT;
    use crate::tensor::zero;
    use crate::total_lagrangian::velocity_gradient;

    fn assert_near(a: &Tensor<f64>, b: &Tensor<f64>, tolerance: f64) {
        for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
            assert!((a - b).abs() <= tolerance, "{a} {b}");
        }
    }

    /// A turn about a skew axis.
    fn turn(angle: f64) -> Tensor<f64> {
        let n = [1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0];
        let (s, c) = angle.sin_cos();
        let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
        [0, 1, 2]
            .map(|i| [0, 1, 2].map(|j| c * f64::from(u8::from(i == j)) + (1.0 - c) * n[i] * n[j] + s * cross[i][j]))
    }

    fn turned(m: &Tensor<f64>, q: &Tensor<f64>) -> Tensor<f64> {
        multiply(&multiply(q, m), &transpose(q))
    }

    #[test]
    fn the_cofactors_are_the_inverse_times_the_determinant() {
        let m = [[2.0, -0.3, 0.5], [0.1, 1.5, -0.7], [0.4, 0.2, 0.9]];
        assert_near(&cofactors(&m), &scaled(&inverse(&m), determinant(&m)), 1e-14);
    }

    #[test]
    fn moments_of_planes_and_lines_have_their_pseudo_inverse() {
        let (sheet, wire) = ([[0.5, 0.1, 0.0], [0.1, 0.8, 0.0], [0.0; 3]], [[0.4, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
        let of_sheet = [[0.8 / 0.39, -0.1 / 0.39, 0.0], [-0.1 / 0.39, 0.5 / 0.39, 0.0], [0.0; 3]];
        let of_wire = [[2.5, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        for (moment, expected) in [(sheet, of_sheet), (wire, of_wire)] {
            let q = turn(0.7);
            let b = thin_correction(&turned(&moment, &q), Dimension::Three, LARGEST_COMPONENT);
            assert_near(&b, &turned(&expected, &q), 1e-12);
            assert_eq!(is_thin(&b), 1.0);
        }
        // A row in the plane, slightly curved; the other axis is not computed in.
        let b = thin_correction(&[[0.5, 0.0, 9.0], [0.0, 0.002, 9.0], [9.0; 3]], Dimension::Two, LARGEST_COMPONENT);
        assert_near(&b, &[[2.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0]], 1e-7);
        for whole in [identity(), [[2.0, 0.0, 0.0], [0.0, 16.0, 0.0], [0.0, 0.0, 1.0]]] {
            assert_eq!(is_thin(&whole), 0.0);
        }
        for broken in [crate::tensor::zero(), [[f64::NAN; 3]; 3]] {
            assert_eq!(thin_correction(&broken, Dimension::Three, LARGEST_COMPONENT), identity());
        }
    }

    #[test]
    fn expanded_pieces_do_not_expand_each_other_without_bound() {
        // A pair along a skew axis: the plain gradient of a large moment is taken back to the size of a unit tensor.
        let n = [0.6, 0.8, 0.0];
        for (size, largest) in [(0.01, 0.01), (0.9, 0.9), (7.0, f64::INFINITY), (2.5e5, f64::INFINITY)] {
            let moment = [0, 1, 2].map(|a| [0, 1, 2].map(|b| size * n[a] * n[b]));
            for dimension in [Dimension::Two, Dimension::Three] {
                let b = correction_of_pieces(&moment, dimension);
                let along = crate::gradient_correction::corrected(&moment, &b);
                let rate = largest.min((dimension.count() as f64).sqrt());
                assert!((trace(&along) - rate).abs() < 1e-12 * rate, "{size} {along:?}");
                assert_eq!(is_thin(&b), 0.0);
            }
        }
        // A full neighbourhood is inverted however far it has expanded.
        for size in [0.5, 1.0, 1e4] {
            let moment = [[size, 0.1 * size, 0.0], [0.1 * size, 0.8 * size, 0.0], [0.0; 3]];
            let b = correction_of_pieces(&moment, Dimension::Two);
            assert_eq!(is_thin(&b), 0.0);
            let one = multiply(&moment, &b);
            for a in 0..2 {
                for c in 0..2 {
                    assert!((one[a][c] - identity::<f64>()[a][c]).abs() < 1e-12);
                }
            }
        }
        // Bounded as before, and broken ones.
        assert_eq!(correction_of_pieces(&[[0.2, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]], Dimension::Two), identity());
        for broken in [zero(), [[f64::NAN; 3]; 3]] {
            assert_eq!(correction_of_pieces::<f64>(&broken, Dimension::Three), identity());
        }
    }

    /// Deforms a sheet or a wire whose columns along it have the exact motion `f(t)`; deformation gradient and stress at the end, of an
    /// elastic material with the moduli 70 and 30 GPa.
    fn follow(
        correction: &Tensor<f64>,
        there: &Tensor<f64>,
        motion: impl Fn(f64) -> Tensor<f64>,
    ) -> (Tensor<f64>, Tensor<f64>) {
        let (steps, mut f, mut s, mut volume) = (20_000, identity(), SymmetricTensor::zero(), 0.0);
        let dt = 1.0 / f64::from(steps);
        for k in 0..steps {
            let (before, after) = (motion(f64::from(k) * dt), motion(f64::from(k + 1) * dt));
            let rate = multiply(&scaled(&minus(&after, &before), 1.0 / dt), there);
            let stress = s + SymmetricTensor::isotropic(70e9 * volume);
            let across = Across { bulk_modulus: 70e9, shear_modulus: 30e9, stress };
            let rate = completed_rate(&f, &rate, correction, &across, dt);
            let l = velocity_gradient(&f, &rate, dt);
            f = plus(&f, &scaled(&rate, dt));
            s = crate::stress::trial_deviator(s, &l, 30e9, dt);
            volume += dt * trace(&l);
        }
        (f, (s + SymmetricTensor::isotropic(70e9 * volume)).to_tensor())
    }

    #[test]
    fn what_turns_does_not_strain() {
        let sheet = [[2.0, 0.0, 0.0], [0.0, 1.8, 0.0], [0.0; 3]];
        let wire = [[2.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        let (f, stress) = follow(&sheet, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]], |t| turn(5.0 * t));
        assert_near(&f, &turn(5.0), 1e-6);
        assert_near(&stress, &crate::tensor::zero(), 10.0);
        let (f, stress) = follow(&wire, &[[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], |t| turn(5.0 * t));
        // A wire does not know its twist: its axis, and no strain.
        for a in 0..3 {
            assert!((f[a][0] - turn(5.0)[a][0]).abs() < 1e-6);
        }
        assert_near(&multiply(&transpose(&f), &f), &identity(), 1e-6);
        assert_near(&stress, &crate::tensor::zero(), 10.0);
    }

    #[test]
    fn an_elastic_step_takes_the_stress_across_to_zero() {
        let q = turn(1.1);
        let tensor = |diagonal: [f64; 3]| {
            turned(&[[diagonal[0], 0.0, 0.0], [0.0, diagonal[1], 0.0], [0.0, 0.0, diagonal[2]]], &q)
        };
        // A wire and a sheet under stress across, stretched by 1e-5.
        for (b, there, across) in
            [([2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1e6, 1e6]), ([2.0, 1.8, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, -1e6])]
        {
            let stress = SymmetricTensor::symmetric_part(&tensor(across));
            let rate = multiply(&tensor([10.0, -4.0, 7.0]), &tensor(there));
            let of = Across { bulk_modulus: 70e9, shear_modulus: 30e9, stress };
            let rate = completed_rate(&identity(), &rate, &tensor(b), &of, 1e-6);
            let l = velocity_gradient(&identity(), &rate, 1e-6);
            let after = crate::stress::trial_deviator(stress.deviator(), &l, 30e9, 1e-6)
                + SymmetricTensor::isotropic(stress.trace() / 3.0 + 70e9 * 1e-6 * trace(&l));
            let back = turned(&after.to_tensor(), &transpose(&q));
            for a in (0..3).filter(|&a| there[a] == 0.0) {
                assert!(back[a][a].abs() < 100.0, "{back:?}");
            }
            // E 1e-5 - nu 2 MPa along the wire.
            if there[1] == 0.0 {
                assert!((back[0][0] / 162.5e3 - 1.0).abs() < 1e-3, "{back:?}");
            }
        }
    }

    #[test]
    fn what_is_pulled_has_the_modulus_of_a_free_face() {
        // E = 9 K G/(3 K + G) = 78.75 GPa, nu = (3 K - 2 G)/(6 K + 2 G) = 0.3125; 1 % along x.
        let (young, nu) = (78.75e9, 0.3125);
        let stretch = |t: f64| [[1.0 + 0.001 * t, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let q = turn(0.4);
        let whole = |t: f64| turned(&stretch(t), &q);
        let wire = turned(&[[2.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], &q);
        let (f, stress) = follow(&wire, &turned(&[[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], &q), whole);
        let back = turned(&stress, &transpose(&q));
        assert!((back[0][0] / (young * 0.001) - 1.0).abs() < 1e-3 && back[1][1].abs() < 1e4, "{back:?}");
        assert!((turned(&f, &transpose(&q))[1][1] - 1.0 + nu * 0.001).abs() < 1e-6);
        // A sheet whose other direction is held: E/(1 - nu^2), and nu times it across.
        let sheet = turned(&[[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]], &q);
        let (f, stress) = follow(&sheet, &turned(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]], &q), whole);
        let back = turned(&stress, &transpose(&q));
        let expected = young * 0.001 / (1.0 - nu * nu);
        assert!((back[0][0] / expected - 1.0).abs() < 1e-3 && (back[1][1] / (nu * expected) - 1.0).abs() < 1e-3);
        assert!(
            back[2][2].abs() < 1e4 && (turned(&f, &transpose(&q))[2][2] - 1.0 + nu / (1.0 - nu) * 0.001).abs() < 1e-6
        );
    }
}
