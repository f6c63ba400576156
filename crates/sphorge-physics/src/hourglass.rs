//! Hourglass control of the total Lagrangian form: springs against motion that the deformation gradient does not see.
//!
//! A deformation gradient sees only the linear part of the motion around a particle; the rest costs no energy and can
//! grow without bound. Ganzenmüller (2015, Eq 21 to 24) resists it with springs. If the linear motion places neighbour
//! `j` of `i` farther away than it is by `delta_i = (F_i X_ij - x_ij) . x_ij/|x_ij|`,
//!
//! `f_ij = V_i V_j W(X_ij)/|X_ij| s_ij x_ij/|x_ij|`,  `s_ij = alpha E (delta_i + delta_j)/(2 |X_ij|)`
//!
//! pushes `i` there, with `x_ij = x_i - x_j`. The work goes to the internal energy of both, half each.
//!
//! `s_ij` is a stress, and a metal bears no more than its flow stress `Y`. Springs as stiff as the metal at rest would
//! resist plastic flow, whose motion is never linear; springs weak enough for plastic flow leave hourglass modes in
//! elastic bodies. They therefore soften with the flow: instead of Young's modulus they have the secant modulus of a
//! metal with the plastic strain `eps_p`,
//!
//! `E_s = Y/(eps_p + Y/E)`,
//!
//! which is `E` until it yields, and a thousandth of it after a strain of one. A particle pressed flat to `lambda_min`
//! of its height is wider by `lambda_min^-1/2`. The strain of a spring in its plane, relative to the length at rest, is
//! too large by this factor, and its force is too large by the strain of the plane. If the stiffness is not multiplied
//! by `lambda_min`, springs resist the flow of the foot of a bar at high speed (copper at 300 m/s, 12 particles across:
//! the flare above the foot is 4.7 % too thick instead of 2.9 %). And they yield,
//!
//! `s_ij -> s_ij/(1 + |s_ij|/(Y/2))`,
//!
//! so that they never exceed half the flow stress. Stiffness and bound are the means of the two particles, so momentum is conserved.

use crate::kernel::PairScale;
use crate::pair::mean;
use crate::{Real, Tensor, Vector};

/// Largest stress of springs as a share of the flow stress.
const SHARE: f64 = 0.5;

/// Bound for metal without strength, such as a melt, as a share of Young's modulus.
const LEAST: f64 = 1e-4;

/// Shortest distance the springs are divided by, squared, in `h^2`.
const SHORTEST: f64 = 1e-6;

/// Springs of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring<T> {
    /// `alpha lambda_min E_s`, Pa.
    pub stiffness: T,
    /// Largest stress, Pa, positive.
    pub bound: T,
}

impl<T: Real> Spring<T> {
    /// Springs of strength `alpha` in a material of that Young's modulus, flow stress (Pa) and plastic strain, with the
    /// smallest principal stretch `smallest_stretch`.
    #[inline(always)]
    pub fn new(strength: T, young: T, yield_stress: T, plastic_strain: T, smallest_stretch: T) -> Self {
        // A fluid has no springs, but its bound must not be zero.
        let bound = (T::of(SHARE) * yield_stress).max(T::of(LEAST) * young).max(T::one());
        let secant = young / (T::one() + young * plastic_strain * T::of(SHARE) / bound);
        Self { stiffness: strength * secant * smallest_stretch.min(T::one()), bound }
    }

    /// The spring between two particles.
    #[inline(always)]
    pub fn between(self, other: Self) -> Self {
        Self { stiffness: mean(self.stiffness, other.stiffness), bound: mean(self.bound, other.bound) }
    }

    /// Stress of a spring, Pa: the stiffness times its strain where that is small, never beyond the bound.
    #[inline(always)]
    pub fn stress(self, strain: T) -> T {
        let stress = self.stiffness * strain;
        stress / (T::one() + stress.max(-stress) / self.bound)
    }
}

/// Deviation of a pair from the linear motion of both particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit<T> {
    /// `|X_ij|^2`, m^2.
    pub initial2: T,
    /// `|x_ij|^2`, m^2.
    pub r2: T,
    /// `((F_i + F_j) X_ij - 2 x_ij) . x_ij = (delta_i + delta_j) |x_ij|`, m^2; positive where the pair is too close.
    pub error: T,
    /// `v_ij . x_ij`, m^2/s.
    pub v_dot_x: T,
}

impl<T: Real> Misfit<T> {
    /// For a pair that was at `X_ij` (`initial`, m), is at `x_ij` (m) and moves with `v_ij` (m/s), along the `D` axes
    /// computed in.
    #[inline(always)]
    pub fn of<const D: usize>(
        initial: &Vector<T>,
        x: &Vector<T>,
        v: &Vector<T>,
        f_i: &Tensor<T>,
        f_j: &Tensor<T>,
    ) -> Self {
        let o = T::zero();
        let mut misfit = Self { initial2: o, r2: o, error: o, v_dot_x: o };
        for a in 0..D {
            misfit.initial2 = initial[a].mul_add(initial[a], misfit.initial2);
        }
        for a in 0..D {
            let mut linear = x[a] * T::of(-2.0);
            for b in 0..D {
                linear = (f_i[a][b] + f_j[a][b]).mul_add(initial[b], linear);
            }
            misfit.r2 = x[a].mul_add(x[a], misfit.r2);
            misfit.error = linear.mul_add(x[a], misfit.error);
            misfit.v_dot_x = x[a].mul_add(v[a], misfit.v_dot_x);
        }
        misfit
    }

    /// `f_ij / V_i` over `x_ij`, N/m^(d+1): the force on `i` is `V_i` times this times `x_ij`. `scale` is that of the pair at its
    /// initial distance, `w` the shape of the kernel there, `volume_j` the initial volume of the neighbour (m^d).
    #[inline(always)]
    pub fn strength(&self, spring: Spring<T>, scale: PairScale<T>, w: T, volume_j: T) -> T {
        // For padding, the pair of a particle with itself, the result is zero, but the division must be valid.
        let shortest = scale.h * scale.h * T::of(SHORTEST);
        let inverse = (self.initial2.max(shortest) * self.r2.max(shortest)).inverse_sqrt();
        scale.value(w) * volume_j * spring.stress(self.error * inverse * T::of(0.5)) * inverse
    }
}

/// Sums of one particle over its springs, still without the factor `V_i / m_i`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringSums<T> {
    /// Force per initial volume, N/m^d.
    pub acceleration: Vector<T>,
    /// Power that goes to the internal energy, per initial volume, W/m^d.
    pub energy_rate: T,
}

impl<T: Real> SpringSums<T> {
    /// Nothing summed.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { acceleration: [T::zero(); 3], energy_rate: T::zero() }
    }

    /// Adds a spring of that strength ([`Misfit::strength`]) along the `D` axes computed in.
    #[inline(always)]
    pub fn add<const D: usize>(&mut self, x: &Vector<T>, v_dot_x: T, strength: T) {
        for a in 0..D {
            self.acceleration[a] = strength.mul_add(x[a], self.acceleration[a]);
        }
        self.energy_rate -= T::of(0.5) * strength * v_dot_x;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tensor::identity;

    #[test]
    fn springs_are_those_of_the_metal_at_rest_and_yield_with_it() {
        // E 200 GPa, strength 10, flow stress 800 MPa: 400 MPa at most.
        let spring = Spring::new(10.0, 200e9, 800e6, 0.0, 1.0);
        assert_eq!(spring, Spring { stiffness: 2e12, bound: 400e6 });
        assert!((spring.stress(1e-8) / 2e4 - 1.0).abs() < 1e-4);
        // As much again as the bound: half of it. Ten times: 10/11.
        assert!((spring.stress(2e-4) / 200e6 - 1.0).abs() < 1e-12);
        assert!((spring.stress(-2e-3) / -363.636_363_6e6 - 1.0).abs() < 1e-9);
        // The tangent, k/(1 + r)^2: a quarter at the bound, 1/121 at ten times.
        let tangent = |strain: f64| (spring.stress(strain + 1e-9) - spring.stress(strain - 1e-9)) / 2e-9;
        assert!((tangent(2e-4) / 5e11 - 1.0).abs() < 1e-4 && (tangent(2e-3) / (2e12 / 121.0) - 1.0).abs() < 1e-4);
        // Between two: the means.
        let other = Spring { stiffness: 1e12, bound: 200e6 };
        assert_eq!(spring.between(other), Spring { stiffness: 1.5e12, bound: 300e6 });
    }

    #[test]
    fn springs_soften_to_the_secant_modulus() {
        // E 200 GPa, Y 800 MPa at a plastic strain of 0.016: 800 MPa/(0.016 + 0.004) = 40 GPa.
        let spring = Spring::new(10.0, 200e9, 800e6, 0.016f64, 1.0);
        assert!((spring.stiffness / 400e9 - 1.0).abs() < 1e-12 && spring.bound == 400e6);
        // Pressed to a quarter of its height, a quarter; wider on all sides, no more.
        let of = |stretch| Spring::new(10.0, 200e9, 800e6, 0.016f64, stretch);
        assert_eq!(of(0.25), Spring { stiffness: 0.25 * spring.stiffness, ..spring });
        assert_eq!(of(1.2), spring);
        // A melt: its flow stress is taken as twice the least bound, 2e-4 E, which after a strain of one is about the secant modulus.
        let melt = Spring::new(1.0, 200e9, 0.0f64, 1.0, 1.0);
        assert!((melt.stiffness / (40e6 / (1.0 + 2e-4)) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn springs_of_what_never_yields_are_linear_and_a_melt_keeps_a_little() {
        let spring = Spring::new(10.0, 2e6, f64::INFINITY, 0.0, 1.0);
        assert_eq!(spring.stress(0.3), 6e6);
        assert_eq!(Spring::new(10.0, 200e9, 0.0f64, 0.0, 1.0).bound, 20e6);
        assert_eq!(Spring::new(10.0, 0.0, 0.0f64, 0.0, 1.0).stress(0.3), 0.0);
    }

    #[test]
    fn linear_motion_has_no_misfit_and_what_is_left_over_does() {
        let f = [[1.2, 0.5, 0.0], [0.0, 0.9, -0.3], [0.1, 0.0, 1.0]];
        let initial = [2.0, -1.0, 0.5];
        let x: Vector<f64> = core::array::from_fn(|a| (0..3).map(|b| f[a][b] * initial[b]).sum());
        assert!(Misfit::of::<3>(&initial, &x, &[0.0; 3], &f, &f).error.abs() < 1e-15);
        // Undeformed, moved from (2, 0) to (1.5, 0): (4 - 3) 1.5.
        let near = Misfit::of::<2>(&[2.0, 0.0, 9.0], &[1.5, 0.0, 9.0], &[-4.0, 5.0, 9.0], &identity(), &identity());
        assert_eq!(near, Misfit { initial2: 4.0, r2: 2.25, error: 1.5, v_dot_x: -6.0 });
        // F_i stretches x by 2, F_j by 1; from (1, 1) to (1, 2): (3 - 2, 2 - 4) . (1, 2).
        let f_i = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3]];
        let apart = Misfit::of::<2>(&[1.0, 1.0, 0.0], &[1.0, 2.0, 0.0], &[0.0; 3], &f_i, &identity());
        assert_eq!((apart.initial2, apart.r2, apart.error), (2.0, 5.0, -3.0));
    }

    #[test]
    fn a_pair_that_is_too_close_is_pushed_apart_by_hand() {
        // |X| = 2, |x| = 1.5, error 1.5: strain 1.5/(2 3) = 0.25, stress 400 (1/4)/(1 + 100/100) = 50;
        // W = 0.5 4 0.125 = 0.25 and V_j = 6: 0.25 6 50/3 = 25.
        let misfit = Misfit { initial2: 4.0, r2: 2.25, error: 1.5, v_dot_x: -6.0 };
        let scale = PairScale { h: 2.0, inverse_h: 0.5, gradient: 0.125 };
        let spring = Spring { stiffness: 400.0f64, bound: 100.0 };
        let strength = misfit.strength(spring, scale, 0.5, 6.0);
        assert!((strength - 25.0).abs() < 1e-12, "{strength}");
        // It closes: the push takes its kinetic energy, 25 6, half of which is the particle's.
        let mut sums = SpringSums { acceleration: [1.0, 0.0, 0.0], energy_rate: 0.0 };
        sums.add::<2>(&[1.5, 0.0, 9.0], misfit.v_dot_x, 25.0);
        assert_eq!(sums, SpringSums { acceleration: [38.5, 0.0, 0.0], energy_rate: 75.0 });
        // Too far apart, it is drawn together.
        assert!(Misfit { error: -1.5, ..misfit }.strength(spring, scale, 0.5, 6.0) < 0.0);
        // The same in micrometres.
        let small = Misfit { initial2: 4e-12, r2: 2.25e-12, error: 1.5e-12, ..misfit };
        let scale = PairScale { h: 2e-6, inverse_h: 0.5e6, gradient: 0.125e12 };
        assert!((small.strength(spring, scale, 0.5, 6.0) / 25e12 - 1.0).abs() < 1e-12);
        // A particle and itself.
        let none = Misfit { initial2: 0.0, r2: 0.0, error: 0.0, v_dot_x: 0.0 };
        assert_eq!(none.strength(spring, scale, 0.5, 6.0), 0.0);
    }
}
