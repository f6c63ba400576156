//! Forces of rigid walls, and of one body on another, that push and never pull.

use crate::tensor::dot;
use crate::{Scalar, Vector};

/// Smallest relative distance the repulsion is evaluated at: it is finite for particles on or behind the wall.
const CLOSEST: f64 = 0.01;

/// Repulsion of a wall (Monaghan & Kos 1999): acceleration along the wall's normal, m/s^2, never negative.
///
/// `R(q) = A (1 - q)/sqrt(q)`, `q = distance/range`, zero from `q = 1` on, `A = (0.01 c^2 + c max(u, 0))/h`, where `u` is the
/// speed of approach (positive towards the wall). `distance` and `range` in m; below a hundredth of the range, and behind the
/// wall, the value at a hundredth is kept.
#[inline]
pub fn monaghan_kos<T: Scalar>(distance: T, range: T, approach_speed: T, sound_speed: T, h: T) -> T {
    let q = (distance / range).max(T::of(CLOSEST)).min(T::one());
    let strength = (T::of(0.01) * sound_speed + approach_speed.max(T::zero())) * sound_speed / h;
    strength * (T::one() - q) / q.sqrt()
}

/// Stiffness, damping and friction of a penalty contact, per mass of the particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PenaltyParameters<T> {
    /// Acceleration per depth of penetration, 1/s^2: the square of the frequency of a particle on the wall.
    pub stiffness: T,
    /// Acceleration per speed of approach, 1/s.
    pub damping: T,
    /// Coulomb's coefficient.
    pub friction: T,
}

impl<T: Scalar> PenaltyParameters<T> {
    /// Stiffness `scale (c/h)^2`, the frequency of sound across a smoothing length, and damping as a fraction of the critical,
    /// `2 ratio sqrt(stiffness)`.
    pub fn from_sound_speed(sound_speed: T, h: T, scale: T, damping_ratio: T, friction: T) -> Self {
        let frequency = scale.sqrt() * sound_speed / h;
        Self { stiffness: frequency * frequency, damping: T::of(2.0) * damping_ratio * frequency, friction }
    }
}

/// Acceleration of a particle by a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactAcceleration<T> {
    /// Along the outward normal of the wall, m/s^2; never negative.
    pub normal: T,
    /// Friction, in the tangential plane and against the sliding, m/s^2.
    pub tangential: Vector<T>,
}

/// Penalty contact with Coulomb friction.
///
/// Normal: `a_n = max(k d + b u, 0)` at a penetration `d > 0` (m) with speed of approach `u` (m/s), else zero: damping alone
/// never pulls. Friction: `min(mu a_n, |v_t|/dt)` against the sliding velocity `v_t` of the particle relative to the wall
/// (tangential, m/s): within the step `dt` (s) it can stop the sliding but not turn it round.
#[inline]
pub fn penalty_contact<T: Scalar>(
    p: PenaltyParameters<T>,
    penetration: T,
    approach_speed: T,
    sliding: Vector<T>,
    dt: T,
) -> ContactAcceleration<T> {
    let zero = T::zero();
    let mut normal = zero;
    let mut drag = zero;
    if penetration > zero {
        normal = (p.stiffness * penetration + p.damping * approach_speed).max(zero);
        let speed = dot(sliding, sliding).sqrt();
        if speed > zero && dt > zero {
            drag = (p.friction * normal / speed).min(T::one() / dt);
        }
    }
    ContactAcceleration { normal, tangential: [-drag * sliding[0], -drag * sliding[1], -drag * sliding[2]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repulsion_by_hand() {
        // A = (0.01 3630^2 + 3630 200)/3.6e-4 = 857769/3.6e-4; q = 0.25: 0.75/0.5.
        let a = 857_769.0 / 3.6e-4;
        let got = monaghan_kos(1.5e-4f64, 6.0e-4, 200.0, 3630.0, 3.6e-4);
        assert!((got - 1.5 * a).abs() < 1e-9 * a);
        // Leaving at 50 m/s: only 0.01 c^2/h = 0.01 1e6/0.5; q = 0.64: 0.36/0.8.
        assert!((monaghan_kos(0.32f64, 0.5, -50.0, 1000.0, 0.5) - 9000.0).abs() < 1e-9);
    }

    #[test]
    fn repulsion_ends_at_its_range_and_stays_finite_behind_the_wall() {
        assert_eq!(monaghan_kos(1.0f64, 1.0, 100.0, 1000.0, 1.0), 0.0);
        assert_eq!(monaghan_kos(7.0f64, 1.0, 100.0, 1000.0, 1.0), 0.0);
        // A = 1e4; (1 - 0.01)/0.1.
        for distance in [0.01f64, 1e-9, 0.0, -3.0] {
            assert!((monaghan_kos(distance, 1.0, 0.0, 1000.0, 1.0) - 9.9e4).abs() < 1e-8);
        }
    }

    #[test]
    fn penalty_by_hand() {
        // k d + b u = 1e6 0.002 + 100 3 = 2300; mu 0.2: 460 along -(3, 0, 4)/5.
        let p = PenaltyParameters { stiffness: 1.0e6, damping: 100.0, friction: 0.2 };
        let a = penalty_contact(p, 0.002f64, 3.0, [3.0, 0.0, 4.0], 1e-5);
        assert!((a.normal - 2300.0).abs() < 1e-9);
        for (got, want) in a.tangential.iter().zip([-276.0, 0.0, -368.0]) {
            assert!((got - want).abs() < 1e-9);
        }
        // From c/h: (0.5 (1000/0.1)^2, 2 0.25 sqrt(that)).
        let p = PenaltyParameters::from_sound_speed(1000.0f64, 0.1, 0.5, 0.25, 0.1);
        assert!((p.stiffness - 5.0e7).abs() < 1e-6 && (p.damping - 3_535.533_905_932_738).abs() < 1e-9);
    }

    #[test]
    fn contact_never_pulls_and_friction_at_most_stops() {
        let p = PenaltyParameters { stiffness: 1.0e6, damping: 1.0e4, friction: 0.5 };
        // Leaving fast: damping would pull.
        let leaving = penalty_contact(p, 0.002f64, -10.0, [1.0, 0.0, 0.0], 1e-5);
        assert_eq!((leaving.normal, leaving.tangential[0].abs()), (0.0, 0.0));
        // Not touching.
        let apart = penalty_contact(p, -0.002f64, 50.0, [1.0, 0.0, 0.0], 1e-5);
        assert_eq!((apart.normal, apart.tangential[0].abs()), (0.0, 0.0));
        // Slow sliding: just stopped within the step.
        let slow = penalty_contact(p, 0.002f64, 0.0, [0.0, -1e-4, 0.0], 1e-5);
        assert!((slow.tangential[1] * 1e-5 - 1e-4).abs() < 1e-18);
        // No sliding, no friction, nothing undefined.
        assert_eq!(penalty_contact(p, 0.002f64, 0.0, [0.0; 3], 0.0).tangential.map(f64::abs), [0.0; 3]);
    }
}
