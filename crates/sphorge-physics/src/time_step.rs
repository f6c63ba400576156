//! Time step limits: each is the longest step, in s, for one process. The smallest of them is used.

use crate::Real;

/// Speed of longitudinal waves, m/s: `c_l^2 = c^2 + 4 G/(3 rho)` from the bulk sound speed (m/s), `G` (Pa) and density (kg/m^3).
#[inline(always)]
pub fn longitudinal_speed<T: Real>(c_bulk: T, shear_modulus: T, rho: T) -> T {
    (c_bulk * c_bulk + T::of(4.0 / 3.0) * shear_modulus / rho).sqrt()
}

/// Sound and artificial viscosity: `courant h / (c_l + |mu|)`, with the largest `|mu|` (m/s) among the particle's pairs.
#[inline(always)]
pub fn sound_limit<T: Real>(h: T, longitudinal_speed: T, mu_max: T, courant: T) -> T {
    courant * h / (longitudinal_speed + mu_max.abs())
}

/// Acceleration: `factor sqrt(h / |a|)` (Monaghan 1992 uses 0.25); infinite without acceleration.
#[inline(always)]
pub fn acceleration_limit<T: Real>(h: T, acceleration: T, factor: T) -> T {
    factor * (h / acceleration.abs()).sqrt()
}

/// A penalty wall of stiffness `scale (c/l)^2` per mass: `courant 2/omega`, a share of the stability limit of its frequency
/// `omega = sqrt(scale) c/l`. `rate = c/l`, 1/s.
#[inline(always)]
pub fn penalty_limit<T: Real>(scale: T, rate: T, courant: T) -> T {
    courant * T::of(2.0) / (scale.sqrt() * rate)
}

/// An oscillator of that stiffness (1/s^2) and damping (1/s) per mass: `2/omega (sqrt(1 + z^2) - z)` with its frequency `omega` and
/// damping ratio `z`, the stability limit of a leapfrog step whose damping lags; infinite without stiffness.
#[inline(always)]
pub fn oscillator_limit<T: Real>(stiffness: T, damping: T) -> T {
    let half = T::of(0.5) * damping;
    let limit = T::of(2.0) * ((stiffness + half * half).sqrt() - half) / stiffness;
    T::select_lt(T::zero(), stiffness, limit, T::of(f64::INFINITY))
}

/// Conduction: `m c_p / G` with the heat capacity `m c_p` (J/K) and the sum `G` (W/K) of a particle's conductances; an
/// explicit step of that length would bring it to the temperature of its neighbours. Infinite without conduction.
#[inline(always)]
pub fn conduction_limit<T: Real>(heat_capacity: T, conductance: T) -> T {
    heat_capacity / conductance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_by_hand() {
        // Copper: sqrt(3940^2 + 60e9/8930) = 4716.20.
        assert!((longitudinal_speed(3940.0f64, 45.0e9, 8930.0) - 4716.198).abs() < 1e-3);
        assert!((longitudinal_speed(5300.0f64, 0.0, 2710.0) - 5300.0).abs() < 1e-12);
        // 0.3 1.2e-3/(5000 + 1000); the sign of mu does not matter.
        assert!((sound_limit(1.2e-3f64, 5000.0, -1000.0, 0.3) - 6.0e-8).abs() < 1e-20);
        // 0.25 sqrt(1e-3/1e9) and 0.5 sqrt(4/1).
        assert!((acceleration_limit(1.0e-3f64, -1.0e9, 0.25) - 2.5e-7).abs() < 1e-19);
        assert_eq!(acceleration_limit(4.0f64, 1.0, 0.5), 1.0);
        assert!(acceleration_limit(1.0f64, 0.0, 0.25).is_infinite());
        // 0.3 2/(sqrt(4) 1e6); 0.2 2/(5 100).
        assert!((penalty_limit(4.0f64, 1.0e6, 0.3) - 3.0e-7).abs() < 1e-20);
        assert!((penalty_limit(25.0f64, 100.0, 0.2) - 8.0e-4).abs() < 1e-17);
        assert_eq!(oscillator_limit(4.0f64, 0.0), 1.0);
        // omega = 2, z = 3/(2 2) = 0.75: sqrt(1.5625) - 0.75 = 0.5.
        assert_eq!(oscillator_limit(4.0f64, 3.0), 0.5);
        assert!(oscillator_limit(0.0f64, 3.0).is_infinite());
        assert_eq!(conduction_limit(8.0f64, 2.0), 4.0);
        assert!(conduction_limit(8.0f64, 0.0).is_infinite());
    }
}
