//! The sums of momentum and energy, pair by pair.
//!
//! Each pair brings the stress vector `t = a_i sigma_i . x_ij + a_j sigma_j . x_ij + t*` times `w'_j F`, where
//! `grad_i W_ij = F x_ij` and `t* = R_ij f^n . x_ij - Pi_ij x_ij` holds artificial stress and viscosity (Patiño et al. Eq 9; Fraser
//! Eq 15 with the sign of the viscosity corrected). Energy is the work of exactly these forces:
//!
//! `de_i/dt = - f_i sum_j w'_j F s . v_ij`,  `s = a_i sigma_i . x_ij + t*/2` or `s = t/2`.
//!
//! Both add up to the power of the whole pair with the opposite sign, so total energy is conserved. The second is Patiño et al.
//! Eq 10; as printed there, with a symmetrised product, it is twice too large.

use crate::{Real, SymmetricTensor, Tensor, Vector};

/// How the pair work is shared between the two particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EnergySplit {
    /// Each particle takes the work of its own stress; artificial terms are halved.
    #[default]
    OwnStress,
    /// Everything halved (Patiño et al. Eq 10).
    Symmetric,
}

/// What a neighbour brings to the sums. Stress vectors are those of scaled stresses, in Pa m or Pa m^7/kg^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairForce<T> {
    /// `x_ij = x_i - x_j`, m.
    pub x: Vector<T>,
    /// `v_ij = v_i - v_j`, m/s.
    pub v: Vector<T>,
    /// `a_i sigma_i . x_ij`, of the particle itself.
    pub own_stress: Vector<T>,
    /// `a_j sigma_j . x_ij`, of the neighbour.
    pub other_stress: Vector<T>,
    /// `R_ij f^n . x_ij`.
    pub artificial_stress: Vector<T>,
    /// `Pi_ij` as [`scaled_pressure`](super::scaled_pressure) gives it, never negative.
    pub pi: T,
    /// `w'_j F` with `grad_i W_ij = F x_ij`, negative.
    pub weighted_f: T,
}

impl<T: Real> PairForce<T> {
    /// What the artificial stress adds to the energy rate of the particle, half of its work, along the `D` axes computed in.
    #[inline(always)]
    pub fn artificial_power<const D: usize>(&self) -> T {
        let mut work = T::zero();
        for a in 0..D {
            work = self.artificial_stress[a].mul_add(self.v[a], work);
        }
        -(T::of(0.5) * work * self.weighted_f)
    }
}

/// Sums of one particle over its neighbours, still without the factor of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceSums<T> {
    /// Acceleration, m/s^2.
    pub acceleration: Vector<T>,
    /// Rate of the specific internal energy, W/kg.
    pub energy_rate: T,
}

impl<T: Real> ForceSums<T> {
    /// Nothing summed.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { acceleration: [T::zero(); 3], energy_rate: T::zero() }
    }

    /// Adds a neighbour along the `D` axes computed in.
    #[inline(always)]
    pub fn add<const D: usize>(&mut self, split: EnergySplit, pair: &PairForce<T>) {
        let half = T::of(0.5);
        let mut work = T::zero();
        for a in 0..D {
            let artificial = pair.artificial_stress[a] - pair.pi * pair.x[a];
            let total = pair.own_stress[a] + pair.other_stress[a] + artificial;
            self.acceleration[a] = total.mul_add(pair.weighted_f, self.acceleration[a]);
            let share = match split {
                EnergySplit::OwnStress => artificial.mul_add(half, pair.own_stress[a]),
                EnergySplit::Symmetric => total * half,
            };
            work = share.mul_add(pair.v[a], work);
        }
        // The work is that of v_j - v_i: the sign of v_ij is turned.
        self.energy_rate -= work * pair.weighted_f;
    }
}

/// `s . x` along the `D` axes computed in, the other components zero.
#[inline(always)]
pub fn stress_vector<T: Real, const D: usize>(s: &SymmetricTensor<T>, x: &Vector<T>) -> Vector<T> {
    let o = T::zero();
    if D == 1 {
        [s.xx * x[0], o, o]
    } else if D == 2 {
        [s.xx.mul_add(x[0], s.xy * x[1]), s.xy.mul_add(x[0], s.yy * x[1]), o]
    } else {
        [
            s.xx.mul_add(x[0], s.xy.mul_add(x[1], s.xz * x[2])),
            s.xy.mul_add(x[0], s.yy.mul_add(x[1], s.yz * x[2])),
            s.xz.mul_add(x[0], s.yz.mul_add(x[1], s.zz * x[2])),
        ]
    }
}

/// `g . x` of a general tensor, such as a stress times a gradient correction, along the `D` axes computed in.
#[inline(always)]
pub fn corrected_stress_vector<T: Real, const D: usize>(g: &Tensor<T>, x: &Vector<T>) -> Vector<T> {
    let mut t = [T::zero(); 3];
    for a in 0..D {
        for b in 0..D {
            t[a] = g[a][b].mul_add(x[b], t[a]);
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> PairForce<f64> {
        PairForce {
            x: [1.0, 2.0, -1.0],
            v: [3.0, -1.0, 2.0],
            own_stress: [4.0, 6.0, 8.0],
            other_stress: [1.0, -2.0, 3.0],
            artificial_stress: [-3.0, 5.0, 1.0],
            pi: 2.0,
            weighted_f: -0.5,
        }
    }

    #[test]
    fn forces_and_shares_by_hand() {
        // t* = (-3, 5, 1) - 2 (1, 2, -1) = (-5, 1, 3); t = (0, 5, 14).
        let mut sums = ForceSums { acceleration: [1.0, 0.0, 0.0], energy_rate: 2.0 };
        sums.add::<3>(EnergySplit::OwnStress, &pair());
        assert_eq!(sums.acceleration, [1.0, -2.5, -7.0]);
        // s = (1.5, 6.5, 9.5), s . v = 4.5 - 6.5 + 19 = 17.
        assert_eq!(sums.energy_rate, 2.0 + 8.5);
        let mut sums = ForceSums::zero();
        sums.add::<3>(EnergySplit::Symmetric, &pair());
        // t . v / 2 = (-5 + 28)/2 = 11.5.
        assert_eq!(sums.energy_rate, 5.75);
        // Of the artificial stress alone: (-9 - 5 + 2)/2, in the plane (-9 - 5)/2, times 0.5.
        assert_eq!((pair().artificial_power::<3>(), pair().artificial_power::<2>()), (-3.0, -3.5));
        // In the plane: s . v = 4.5 - 6.5.
        let mut sums = ForceSums::zero();
        sums.add::<2>(EnergySplit::OwnStress, &pair());
        assert_eq!(sums, ForceSums { acceleration: [0.0, -2.5, 0.0], energy_rate: -1.0 });
    }

    #[test]
    fn stress_vectors_by_hand() {
        let s = SymmetricTensor { xx: 1.0, yy: 2.0, zz: 3.0, xy: 4.0, yz: 5.0, xz: 6.0 };
        let x = [1.0, 10.0, 100.0];
        assert_eq!(stress_vector::<f64, 1>(&s, &x), [1.0, 0.0, 0.0]);
        assert_eq!(stress_vector::<f64, 2>(&s, &x), [41.0, 24.0, 0.0]);
        assert_eq!(stress_vector::<f64, 3>(&s, &x), [641.0, 524.0, 356.0]);
        let g = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]];
        assert_eq!(corrected_stress_vector::<f64, 3>(&g, &x), [321.0, 654.0, 987.0]);
        assert_eq!(corrected_stress_vector::<f64, 2>(&g, &x), [21.0, 54.0, 0.0]);
    }
}
