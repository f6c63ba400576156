//! Artificial viscosity of pairs (Monaghan & Gingold), with Balsara's switch, and of single particles (von Neumann & Richtmyer).
//!
//! `Pi_ij = (-alpha c mu + beta mu^2)/rho` where particles approach, `v_ij . x_ij < 0`, else zero, with
//! `mu = h v_ij . x_ij / (r^2 + 0.01 h^2)` and pair means of `c`, `rho`, `h` (Monaghan & Gingold 1983; Monaghan 1992).
//! It enters the pair stress as `- Pi_ij I`, a pressure over density squared.
//!
//! Patiño et al. Eq 13 prints `mu^2` in the linear term; Fraser Eq 6 and 15 print `+ Pi_ij`.

use crate::tensor::dot;
use crate::{Real, Tensor};

/// Strength of the artificial viscosity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViscosityParameters<T> {
    /// Linear (bulk and shear) part.
    pub alpha: T,
    /// Quadratic (von Neumann–Richtmyer) part.
    pub beta: T,
}

/// `mu_ij`, m/s: never positive, zero where particles part. `v_dot_x = v_ij . x_ij` (m^2/s), `r2 = r^2` (m^2), pair mean of `h` (m).
#[inline(always)]
pub fn viscosity_mu<T: Real>(v_dot_x: T, r2: T, h: T) -> T {
    h * v_dot_x.min(T::zero()) / (T::of(0.01) * h).mul_add(h, r2)
}

/// `Pi_ij`, Pa m^6/kg^2 (m^5/(kg s^2)), never negative, from `mu_ij` and the pair means of sound speed (m/s) and of density, the
/// inverse of which (m^3/kg) is given.
#[inline(always)]
pub fn viscous_pressure<T: Real>(p: ViscosityParameters<T>, mu: T, sound_speed_mean: T, inverse_density_mean: T) -> T {
    mu * (p.beta * mu - p.alpha * sound_speed_mean) * inverse_density_mean
}

/// Balsara's switch, between 0 and 1: `|div v| / (|div v| + |curl v| + 1e-4 c/h)` (Balsara 1995) with the velocity gradient `l`
/// (1/s), sound speed (m/s) and smoothing length (m).
#[inline(always)]
pub fn balsara<T: Real>(l: &Tensor<T>, sound_speed: T, h: T) -> T {
    let compression = (l[0][0] + l[1][1] + l[2][2]).abs();
    let curl = [l[2][1] - l[1][2], l[0][2] - l[2][0], l[1][0] - l[0][1]];
    compression / (compression + dot(curl, curl).sqrt() + T::of(1e-4) * sound_speed / h)
}

/// `Pi_ij` times the mean of the two particles' switches ([`balsara`]), so that shear flow is not damped.
#[inline(always)]
pub fn switched<T: Real>(pi: T, switch_i: T, switch_j: T) -> T {
    pi * (switch_i + switch_j) * T::of(0.5)
}

/// Bulk viscosity, a pressure of the particle, Pa: `q = rho (alpha c h |tr L| + beta (h tr L)^2) / 2` in compression, zero in
/// expansion (von Neumann & Richtmyer 1950). `divergence = tr L` (1/s), density (kg/m^3), sound speed (m/s), `h` (m).
#[inline(always)]
pub fn bulk_viscosity<T: Real>(p: ViscosityParameters<T>, divergence: T, density: T, sound_speed: T, h: T) -> T {
    let rate = h * (-divergence).max(T::zero());
    T::of(0.5) * density * (p.alpha * sound_speed * rate + p.beta * rate * rate)
}

/// Power per mass of the bulk viscosity `q` (Pa), W/kg: `-q tr L/rho` with `divergence = tr L` (1/s) and density (kg/m^3), positive in
/// compression. It goes to the internal energy. Over a step it is that of the mean of the pressures before and after it.
#[inline(always)]
pub fn bulk_viscous_power<T: Real>(q: T, divergence: T, density: T) -> T {
    -(q * divergence) / density
}

/// What stands for `|mu|` in the time-step limit where viscosity is that of single particles, m/s: `h |tr L|`.
#[inline(always)]
pub fn bulk_mu<T: Real>(l: &Tensor<T>, h: T) -> T {
    h * (l[0][0] + l[1][1] + l[2][2]).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `Pi_ij` and `mu_ij` of a pair.
    fn pair(p: ViscosityParameters<f64>, v_dot_x: f64, r2: f64, h: f64, c: f64, inverse_density: f64) -> (f64, f64) {
        let mu = viscosity_mu(v_dot_x, r2, h);
        (viscous_pressure(p, mu, c, inverse_density), mu)
    }

    #[test]
    fn approaching_pairs_by_hand() {
        // v.x = -0.12, r^2 = 1e-6, h = 1.2e-3: mu = -1.44e-4/1.0144e-6 = -141.9558;
        // (1 5000 141.9558 + 2 141.9558^2)/8000.
        let p = ViscosityParameters { alpha: 1.0, beta: 2.0 };
        let (pi, mu) = pair(p, -0.12, 1.0e-6, 1.2e-3, 5000.0, 1.0 / 8000.0);
        assert!((mu + 141.955_835_962_145).abs() < 1e-9);
        assert!((pi - 93.760_262_317_268_56).abs() < 1e-9, "{pi}");
        // alpha 0.2, beta 4, v.x = -0.003, r^2 = 4e-8, h = 3.6e-4, c = 3630, rho = 7890.
        let p = ViscosityParameters { alpha: 0.2, beta: 4.0 };
        let (pi, mu) = pair(p, -0.003, 4.0e-8, 3.6e-4, 3630.0, 1.0 / 7890.0);
        let size = 1.08e-6 / 4.1296e-8;
        assert!((mu + size).abs() < 1e-11);
        assert!((pi - (726.0 * size + 4.0 * size * size) / 7890.0).abs() < 1e-12);
    }

    #[test]
    fn parting_and_coincident_particles_have_none() {
        let p = ViscosityParameters { alpha: 1.0, beta: 2.0 };
        for (v_dot_x, r2) in [(0.3f64, 1e-6), (0.0, 1e-6), (0.0, 0.0)] {
            assert_eq!(pair(p, v_dot_x, r2, 1e-3, 5000.0, 1.0 / 8000.0), (0.0, 0.0));
        }
    }

    #[test]
    fn balsara_lets_compression_through_and_holds_shear_back() {
        // |tr L| = 3, curl (2, 0, -sqrt(12)) of length 4: 3/(3 + 4 + 1e-4 5000/0.5).
        let l = [[-4.0, 1.0 + 12.0f64.sqrt(), 1.0], [1.0, 1.5, 5.0], [1.0, 7.0, -0.5]];
        assert!((balsara(&l, 5000.0, 0.5) - 0.375).abs() < 1e-15);
        let shear = [[1.0, 9.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]];
        assert_eq!(balsara(&shear, 5000.0f64, 0.5), 0.0);
        assert_eq!(balsara(&[[9.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], 5000.0f64, 0.5), 0.9);
        // 8 times the mean of 0.5 and 0.75; 3 times that of 1 and 0.
        assert_eq!((switched(8.0, 0.5, 0.75), switched(3.0, 1.0, 0.0)), (5.0, 1.5));
    }

    #[test]
    fn bulk_viscosity_by_hand_and_none_in_expansion() {
        let p = ViscosityParameters { alpha: 0.5, beta: 2.0 };
        // 0.5 8000 (0.5 4000 0.01 100 + 2 (0.01 100)^2) = 4000 (2000 + 2).
        assert!((bulk_viscosity(p, -100.0, 8000.0f64, 4000.0, 0.01) - 8.008e6).abs() < 1e-6);
        assert_eq!(bulk_viscosity(p, 100.0f64, 8000.0, 4000.0, 0.01), 0.0);
        // 0.5 2000 (0.3 1000 2 0.5 + (2 0.5)^2).
        let p = ViscosityParameters { alpha: 0.3, beta: 1.0 };
        assert_eq!(bulk_viscosity(p, -0.5f64, 2000.0, 1000.0, 2.0), 301e3);
        // 8.008 MPa of 8000 kg/m^3 that close at 100/s; what expands has no pressure to work against.
        assert!((bulk_viscous_power(8.008e6, -100.0f64, 8000.0) - 1.001e5).abs() < 1e-9);
        assert_eq!(bulk_viscous_power(301e3, -0.5f64, 2000.0), 75.25);
        assert_eq!(bulk_viscous_power(0.0f64, 100.0, 8000.0), 0.0);
        assert_eq!(bulk_mu(&[[-4.0, 9.0, 9.0], [9.0, 1.0, 9.0], [9.0, 9.0, 1.0f64]], 3.0), 6.0);
    }
}
