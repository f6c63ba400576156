//! What a kick of an integrator does to the energy balance, and where a drift came from.
//!
//! Pair sums take the work of the pair forces at the velocity they were evaluated with, `v^`; a kick moves through the mean of the velocities
//! before and after it, `v_m`. The difference, `a_p . (v_m - v^) dt` with the acceleration `a_p` of the pair forces, is booked to the internal
//! energy, so that kinetic plus internal energy less external work is constant to round-off (in the spirit of Owen's 2014 compatible
//! energy, per particle instead of per pair). What a velocity gains beyond `a_p dt` is external: of mass `m` the impulse `m (dv - a_p dt)` and the work
//! `m v_m . (dv - a_p dt)`.

use crate::{Real, Vector};

/// What a kick of a particle adds to the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KickAccount<T> {
    /// Booked to the specific internal energy, J/kg.
    pub energy: T,
    /// Work of everything that is not a pair force, J.
    pub work: T,
    /// Its impulse, N s.
    pub impulse: Vector<T>,
}

/// A kick along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KickAxis<T> {
    /// Acceleration by pair forces, m/s^2.
    pub pair: T,
    /// Mean of the velocities before and after, m/s.
    pub mean: T,
    /// The mean less the velocity pair forces were evaluated with, m/s.
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

/// Where something was a time `back` (s) ago, m, that has drifted to `x` (m) with a velocity (m/s); of a pair with the difference of both.
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
