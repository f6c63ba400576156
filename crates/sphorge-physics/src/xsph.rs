//! XSPH: particles move with a velocity smoothed over their neighbours.
//!
//! `dx_i/dt = v_i + eps sum_j (m_j/rho_ij) (v_j - v_i) W_ij` with the pair mean `rho_ij` (Monaghan 1989, 1992). The pair
//! weight times `m_i` is symmetric, so the momentum of the moved mass is that of the velocities.

use crate::pair::PairForm;
use crate::{Real, Vector};

/// `m_j W_ij / rho_ij`: the weight of `v_j - v_i` in the smoothed velocity, before `eps`; dimensionless. `weighted_w` is `W_ij` times
/// the weight the neighbour has in the momentum sum, `m_j` or `m_j/rho_j`; densities in kg/m^3, the mean by its inverse.
#[inline(always)]
pub fn xsph_weight<T: Real>(form: PairForm, weighted_w: T, inverse_density_mean: T, rho_j: T) -> T {
    let weight = weighted_w * inverse_density_mean;
    match form {
        PairForm::VolumeWeighted => weight * rho_j,
        PairForm::DensityWeighted | PairForm::Mixed => weight,
    }
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
                let got = xsph_weight(form, weighted_w, inverse_density_mean(rho_i, rho_j), rho_j);
                assert!((got - want).abs() < 1e-15, "{form:?}: {got}");
            }
        }
    }

    #[test]
    fn velocities_are_drawn_to_those_of_neighbours() {
        let mut smoothing = [1.0, 0.0, 0.0];
        add_xsph::<f64, 2>(&mut smoothing, &[4.0, -8.0, 9.0], 0.25);
        assert_eq!(smoothing, [0.0, 2.0, 0.0]);
    }
}
