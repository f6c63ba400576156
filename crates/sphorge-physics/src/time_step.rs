//! Votes on the time step: each the longest step, in s, that one process bears. The smallest wins.

use crate::Real;

/// Speed of longitudinal waves, m/s: `c_l^2 = c^2 + 4 G/(3 rho)` from the bulk sound speed (m/s), `G` (Pa) and density (kg/m^3).
#[inline(always)]
pub fn longitudinal_speed<T: Real>(c_bulk: T, shear_modulus: T, rho: T) -> T {
    (c_bulk * c_bulk + T::of(4.0 / 3.0) * shear_modulus / rho).sqrt()
}

/// Sound and artificial viscosity: `courant h / (c_l + |mu|)`, with the largest `|mu|` (m/s) among the particle's pairs.
#[inline(always)]
pub fn sound_vote<T: Real>(h: T, longitudinal_speed: T, mu_max: T, courant: T) -> T {
    courant * h / (longitudinal_speed + mu_max.abs())
}

/// Acceleration: `factor sqrt(h / |a|)` (Monaghan 1992 uses 0.25); infinite where there is none.
#[inline(always)]
pub fn acceleration_vote<T: Real>(h: T, acceleration: T, factor: T) -> T {
    factor * (h / acceleration.abs()).sqrt()
}

/// A penalty contact of that stiffness (1/s^2): `factor 2/sqrt(k)`, a fraction of the stability limit; infinite where there is
/// none.
#[inline(always)]
pub fn contact_vote<T: Real>(stiffness: T, factor: T) -> T {
    factor * T::of(2.0) / stiffness.sqrt()
}

/// Conduction: `courant m c_p / G` with the sum `G` (W/K) of a particle's conductances; at `m c_p / G` an explicit step would bring
/// it to the temperature of its neighbours. Infinite where there is none.
#[inline(always)]
pub fn conduction_vote<T: Real>(heat_capacity: T, conductance: T, courant: T) -> T {
    courant * heat_capacity / conductance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn votes_by_hand() {
        // Copper: sqrt(3940^2 + 60e9/8930) = 4716.20.
        assert!((longitudinal_speed(3940.0f64, 45.0e9, 8930.0) - 4716.198).abs() < 1e-3);
        assert!((longitudinal_speed(5300.0f64, 0.0, 2710.0) - 5300.0).abs() < 1e-12);
        // 0.3 1.2e-3/(5000 + 1000); the sign of mu does not matter.
        assert!((sound_vote(1.2e-3f64, 5000.0, -1000.0, 0.3) - 6.0e-8).abs() < 1e-20);
        // 0.25 sqrt(1e-3/1e9) and 0.5 sqrt(4/1).
        assert!((acceleration_vote(1.0e-3f64, -1.0e9, 0.25) - 2.5e-7).abs() < 1e-19);
        assert_eq!(acceleration_vote(4.0f64, 1.0, 0.5), 1.0);
        assert!(acceleration_vote(1.0f64, 0.0, 0.25).is_infinite());
        assert!((contact_vote(1.0e14f64, 0.2) - 4.0e-8).abs() < 1e-20);
        assert!(contact_vote(0.0f64, 0.2).is_infinite());
        assert_eq!(conduction_vote(8.0f64, 2.0, 0.25), 1.0);
        assert!(conduction_vote(8.0f64, 0.0, 0.25).is_infinite());
    }
}
