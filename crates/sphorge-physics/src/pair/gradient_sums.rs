//! The sum of the velocity gradient, pair by pair.

use crate::{Real, Tensor, Vector};

/// Sums of one particle over its neighbours, still without the factor of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradientSums<T> {
    /// `sum_j w_j (v_j - v_i) ⊗ grad_i W_ij`, row: velocity component.
    pub gradient: Tensor<T>,
    /// `sum_j w_j (x_j - x_i) ⊗ grad_i W_ij`: the moment the gradient correction inverts.
    pub moment: Tensor<T>,
}

impl<T: Real> GradientSums<T> {
    /// Nothing summed.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { gradient: [[T::zero(); 3]; 3], moment: [[T::zero(); 3]; 3] }
    }

    /// Adds a neighbour along the `D` axes computed in; the moment only if `CORRECTED`. `x_ij = x_i - x_j` (m), `v_ji = v_j - v_i`
    /// (m/s), and `weighted_f = w_j F` with the `F` (m^-(d+2)) of `grad_i W_ij = F x_ij`.
    #[inline(always)]
    pub fn add<const D: usize, const CORRECTED: bool>(&mut self, x_ij: &Vector<T>, v_ji: &Vector<T>, weighted_f: T) {
        for a in 0..D {
            let v = v_ji[a] * weighted_f;
            let y = x_ij[a] * weighted_f;
            for b in 0..D {
                self.gradient[a][b] = v.mul_add(x_ij[b], self.gradient[a][b]);
                if CORRECTED {
                    self.moment[a][b] -= y * x_ij[b];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_neighbours_by_hand() {
        let mut sums = GradientSums::<f64>::zero();
        // (v_j - v_i) ⊗ (w F x_ij) with w F = -2: (3, 4) ⊗ (-2, 4) and -(1, -2) ⊗ (-2, 4).
        sums.add::<2, true>(&[1.0, -2.0, 9.0], &[3.0, 4.0, 9.0], -2.0);
        assert_eq!(sums.gradient, [[-6.0, 12.0, 0.0], [-8.0, 16.0, 0.0], [0.0; 3]]);
        assert_eq!(sums.moment, [[2.0, -4.0, 0.0], [-4.0, 8.0, 0.0], [0.0; 3]]);
        // A second one, along z too, without a moment: (0, 1, 2) ⊗ 0.5 (0, 0, 2).
        sums.add::<3, false>(&[0.0, 0.0, 2.0], &[0.0, 1.0, 2.0], 0.5);
        assert_eq!(sums.gradient, [[-6.0, 12.0, 0.0], [-8.0, 16.0, 1.0], [0.0, 0.0, 2.0]]);
        assert_eq!(sums.moment, [[2.0, -4.0, 0.0], [-4.0, 8.0, 0.0], [0.0; 3]]);
    }
}
