//! XSPH: particles move with a velocity smoothed over their neighbours.
//!
//! `dx_i/dt = v_i + eps sum_j (m_j/rho_ij) (v_j - v_i) W_ij` with the pair mean `rho_ij` (Monaghan 1989, 1992). The pair
//! weight times `m_i` is symmetric, so the momentum of the moved mass is that of the velocities.

use crate::Real;

/// `m_j W_ij / rho_ij`: the weight of `v_j - v_i` in the smoothed velocity, before `eps`; dimensionless.
#[inline(always)]
pub fn xsph_weight<T: Real>(m_j: T, rho_i: T, rho_j: T, w_ij: T) -> T {
    T::of(2.0) * m_j * w_ij / (rho_i + rho_j)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weight_by_hand() {
        // 2 3 0.5/(4 + 8); 2 0.7 9/(2 + 5).
        assert_eq!(xsph_weight(3.0f64, 4.0, 8.0, 0.5), 0.25);
        assert!((xsph_weight(0.7f64, 2.0, 5.0, 9.0) - 1.8).abs() < 1e-15);
    }
}
