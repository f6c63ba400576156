//! Energy balance of a kick of an integrator.
//!
//! Pair sums compute the work of the pair forces with the velocity of their evaluation, `v^`; a kick moves with the
//! mean of the velocities before and after it, `v_m`. The difference, `a_p . (v_m - v^) dt` with the acceleration `a_p`
//! of the pair forces, is booked to the internal energy, so that kinetic plus internal energy minus external work is
//! constant to rounding (in the spirit of Owen's 2014 compatible energy, per particle instead of per pair). The
//! velocity gained beyond `a_p dt` is due to external forces: for a mass `m` their impulse is `m (dv - a_p dt)` and
//! their work `m v_m . (dv - a_p dt)`.

use crate::{Real, Vector};

/// Contribution of a kick of a particle to the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KickAccount<T> {
    /// Booked to the specific internal energy, J/kg.
    pub energy: T,
    /// Work of all forces that are not pair forces, J.
    pub work: T,
    /// Their impulse, N s.
    pub impulse: Vector<T>,
}

/// A kick along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KickAxis<T> {
    /// Acceleration by pair forces, m/s^2.
    pub pair: T,
    /// Mean of the velocities before and after, m/s.
    pub mean: T,
    /// The mean minus the velocity at which pair forces were evaluated, m/s.
    pub ahead: T,
    /// Velocity gained beyond that of the pair forces, m/s.
    pub beyond: T,
}

impl<T: Real> KickAccount<T> {
    /// Nothing yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { energy: T::zero(), work: T::zero(), impulse: [T::zero(); 3] }
    }

    /// Adds axis `k` of a kick over a time `dt` (s) of a particle of that mass (kg).
    #[inline(always)]
    pub fn add(&mut self, k: usize, axis: &KickAxis<T>, mass: T, dt: T) {
        self.energy -= axis.pair * axis.ahead * dt;
        self.work += mass * axis.mean * axis.beyond;
        self.impulse[k] = mass * axis.beyond;
    }
}

/// Position a time `back` (s) ago, m, of a particle that has drifted to `x` (m) with a velocity (m/s); for a pair from
/// the differences of both.
#[inline(always)]
pub fn earlier<T: Real>(x: T, velocity: T, back: T) -> T {
    x - back * velocity
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_axes_by_hand() {
        let mut account = KickAccount::<f64>::zero();
        // 3 (5 - 1) 0.5 leaves the particle; 2 kg gain 0.25 m/s beyond the pair forces at a mean of 5 m/s.
        account.add(0, &KickAxis { pair: 3.0, mean: 5.0, ahead: 4.0, beyond: 0.25 }, 2.0, 0.5);
        assert_eq!(account, KickAccount { energy: -6.0, work: 2.5, impulse: [0.5, 0.0, 0.0] });
        account.add(2, &KickAxis { pair: -8.0, mean: -1.0, ahead: 0.5, beyond: 2.0 }, 2.0, 0.5);
        assert_eq!(account, KickAccount { energy: -4.0, work: -1.5, impulse: [0.5, 0.0, 4.0] });
    }

    #[test]
    fn a_drift_is_followed_back_by_hand() {
        assert_eq!((earlier(7.0, 4.0, 0.5), earlier(-1.0, -6.0, 0.25)), (5.0, 0.5));
    }
}
