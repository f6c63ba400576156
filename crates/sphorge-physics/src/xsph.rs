//! XSPH: particles move with a velocity smoothed over their neighbours.
//!
//! `dx_i/dt = v_i + eps sum_j (m_j/rho_ij) (v_j - v_i) W_ij` with the pair mean `rho_ij` (Monaghan 1989, 1992). The pair
//! weight times `m_i` is symmetric, so the momentum of the moved mass is that of the velocities.

use crate::{Real, Vector};

/// `m_j W_ij / rho_ij`: the weight of `v_j - v_i` in the smoothed velocity, before `eps`; dimensionless. `weighted_w` is `W_ij` times
/// the weight the neighbour has in the momentum sum, a mass or a volume, which may be that of another moment; `mass_per_weight` is `m_j`
/// over that weight, 1 or kg/m^3. The mean density by its inverse, m^3/kg.
#[inline(always)]
pub fn xsph_weight<T: Real>(weighted_w: T, mass_per_weight: T, inverse_density_mean: T) -> T {
    weighted_w * inverse_density_mean * mass_per_weight
}

/// Adds a neighbour to the smoothing of a velocity (m/s) along the `D` axes computed in; `v_ij = v_i - v_j`.
#[inline(always)]
pub fn add_xsph<T: Real, const D: usize>(smoothing: &mut Vector<T>, v_ij: &Vector<T>, weight: T) {
    for a in 0..D {
        smoothing[a] -= v_ij[a] * weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::{inverse_density_mean, momentum_weight};
    use crate::test_cloud::FORMS;

    #[test]
    fn the_weight_is_that_of_the_mass_in_every_form() {
        // m_j W/rho_ij: 3 0.5/6, 0.7 9/3.5.
        for form in FORMS {
            for (mass, rho_i, rho_j, w, want) in [(3.0, 4.0, 8.0, 0.5, 0.25), (0.7, 2.0, 5.0, 9.0, 1.8f64)] {
                let weighted_w = w * momentum_weight(form, mass, rho_j);
                let per_weight = mass / momentum_weight(form, mass, rho_j);
                let got = xsph_weight(weighted_w, per_weight, inverse_density_mean(rho_i, rho_j));
                assert!((got - want).abs() < 1e-15, "{form:?}: {got}");
            }
        }
    }

    #[test]
    fn weights_of_another_moment_are_no_less_symmetric() {
        // Volumes 1 and 2 when the densities were 3 and 0.5, which are 4 and 1 by now: W m_j/2.5 with masses 3 and 1.
        let of = |volume: f64, mass: f64| xsph_weight(0.5 * volume, mass / volume, inverse_density_mean(4.0, 1.0));
        let (of_i, of_j) = (of(1.0, 3.0), of(2.0, 1.0));
        assert!((of_i - 0.6).abs() < 1e-15 && (of_j - 0.2).abs() < 1e-15, "{of_i} {of_j}");
        assert!((3.0 * of_j - of_i).abs() < 1e-15);
    }

    #[test]
    fn velocities_are_drawn_to_those_of_neighbours() {
        let mut smoothing = [1.0, 0.0, 0.0];
        add_xsph::<f64, 2>(&mut smoothing, &[4.0, -8.0, 9.0], 0.25);
        assert_eq!(smoothing, [0.0, 2.0, 0.0]);
    }
}
