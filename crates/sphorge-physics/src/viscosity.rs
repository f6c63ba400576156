//! Artificial viscosity of Monaghan & Gingold, with Balsara's switch.
//!
//! `Pi_ij = (-alpha c mu + beta mu^2)/rho` where particles approach, `v_ij . x_ij < 0`, else zero, with
//! `mu = h v_ij . x_ij / (r^2 + 0.01 h^2)` and pair means of `c`, `rho`, `h` (Monaghan & Gingold 1983; Monaghan 1992).
//! It enters the pair stress as `- Pi_ij I`, a pressure over density squared.
//!
//! Patiño et al. Eq 13 prints `mu^2` in the linear term; Fraser Eq 6 and 15 print `+ Pi_ij`.

use crate::{Real, Scalar};

/// Strength of the artificial viscosity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViscosityParameters<T> {
    /// Linear (bulk and shear) part.
    pub alpha: T,
    /// Quadratic (von Neumann–Richtmyer) part.
    pub beta: T,
}

/// Artificial viscosity of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairViscosity<T> {
    /// `Pi_ij`, Pa m^6/kg^2 (m^5/(kg s^2)); never negative.
    pub pi: T,
    /// `mu_ij`, m/s; never positive, zero where particles part.
    pub mu: T,
}

/// Artificial viscosity of a pair: `v_dot_x = v_ij . x_ij` (m^2/s), `r2 = r^2` (m^2), pair means of `h` (m), sound speed (m/s)
/// and the inverse of that of density (m^3/kg).
#[inline(always)]
pub fn monaghan_gingold<T: Real>(
    p: ViscosityParameters<T>,
    v_dot_x: T,
    r2: T,
    h: T,
    sound_speed_mean: T,
    inverse_density_mean: T,
) -> PairViscosity<T> {
    let mu = viscosity_mu(v_dot_x, r2, h);
    PairViscosity { pi: viscous_pressure(p, mu, sound_speed_mean, inverse_density_mean), mu }
}

/// `mu_ij` alone, m/s; arguments as for [`monaghan_gingold`].
#[inline(always)]
pub fn viscosity_mu<T: Real>(v_dot_x: T, r2: T, h: T) -> T {
    h * v_dot_x.min(T::zero()) / (T::of(0.01) * h).mul_add(h, r2)
}

/// `Pi_ij` of a known `mu_ij`, Pa m^6/kg^2; arguments as for [`monaghan_gingold`].
#[inline(always)]
pub fn viscous_pressure<T: Real>(p: ViscosityParameters<T>, mu: T, sound_speed_mean: T, inverse_density_mean: T) -> T {
    mu * (p.beta * mu - p.alpha * sound_speed_mean) * inverse_density_mean
}

/// Balsara's switch, between 0 and 1: `|div v| / (|div v| + |curl v| + 1e-4 c/h)` (Balsara 1995). `Pi_ij` is multiplied by
/// the mean of the two particles' switches, so that shear flow is not damped.
#[inline]
pub fn balsara<T: Scalar>(divergence: T, curl_norm: T, sound_speed: T, h: T) -> T {
    let compression = divergence.abs();
    compression / (compression + curl_norm + T::of(1e-4) * sound_speed / h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn approaching_pairs_by_hand() {
        // v.x = -0.12, r^2 = 1e-6, h = 1.2e-3: mu = -1.44e-4/1.0144e-6 = -141.9558;
        // (1 5000 141.9558 + 2 141.9558^2)/8000.
        let p = ViscosityParameters { alpha: 1.0, beta: 2.0 };
        let pair = monaghan_gingold(p, -0.12f64, 1.0e-6, 1.2e-3, 5000.0, 1.0 / 8000.0);
        let mu = 1.44e-4 / 1.0144e-6;
        assert!((pair.mu + 141.955_835_962_145).abs() < 1e-9);
        assert!((pair.pi - (5000.0 * mu + 2.0 * mu * mu) / 8000.0).abs() < 1e-10);
        assert!((pair.pi - 93.760_262_317_268_56).abs() < 1e-9, "{}", pair.pi);
        // alpha 0.2, beta 4, v.x = -0.003, r^2 = 4e-8, h = 3.6e-4, c = 3630, rho = 7890.
        let p = ViscosityParameters { alpha: 0.2, beta: 4.0 };
        let pair = monaghan_gingold(p, -0.003f64, 4.0e-8, 3.6e-4, 3630.0, 1.0 / 7890.0);
        let mu = 1.08e-6 / 4.1296e-8;
        assert!((pair.mu + mu).abs() < 1e-11);
        assert!((pair.pi - (726.0 * mu + 4.0 * mu * mu) / 7890.0).abs() < 1e-12);
    }

    #[test]
    fn parting_and_coincident_particles_have_none() {
        let p = ViscosityParameters { alpha: 1.0, beta: 2.0 };
        for (v_dot_x, r2) in [(0.3f64, 1e-6), (0.0, 1e-6), (0.0, 0.0)] {
            let pair = monaghan_gingold(p, v_dot_x, r2, 1e-3, 5000.0, 1.0 / 8000.0);
            assert_eq!((pair.pi, pair.mu), (0.0, 0.0));
        }
    }

    #[test]
    fn balsara_lets_compression_through_and_holds_shear_back() {
        // 3/(3 + 4 + 1e-4 5000/0.5).
        assert_eq!(balsara(-3.0f64, 4.0, 5000.0, 0.5), 0.375);
        assert_eq!(balsara(0.0f64, 4.0, 5000.0, 0.5), 0.0);
        assert_eq!(balsara(9.0f64, 0.0, 5000.0, 0.5), 0.9);
    }
}
