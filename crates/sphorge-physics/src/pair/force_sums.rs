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

impl EnergySplit {
    /// The part of the stress vector of a pair whose work is that of the particle itself, `own` being its own part.
    #[inline(always)]
    fn share<T: Real>(self, own: T, of_pair: T) -> T {
        match self {
            Self::OwnStress => own,
            Self::Symmetric => of_pair * T::of(0.5),
        }
    }
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
    /// [`closing_power`] of the pair, m^2/s times the unit of `weighted_f`.
    pub closing_power: T,
}

/// Power of a unit of `Pi_ij` on the pair: `v_ij . x_ij w'_j F`, positive where they approach, `v_dot_x = v_ij . x_ij` in m^2/s. `Pi_ij`
/// times this is the power of the viscosity; each particle takes its [`share_of_power`].
#[inline(always)]
pub fn closing_power<T: Real>(v_dot_x: T, weighted_f: T) -> T {
    v_dot_x * weighted_f
}

/// What a particle takes of the power that viscosity or artificial stress has on its pairs: half. Summed over the neighbours it is their
/// part of the energy rate ([`ForceSums::energy_rate`]), in W/kg for stresses and `Pi_ij` that are scaled
/// ([`scaled_pressure`](super::scaled_pressure)).
#[inline(always)]
pub fn share_of_power<T: Real>(power: T) -> T {
    T::of(0.5) * power
}

/// Sums of one particle over its neighbours, still without the factor of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceSums<T> {
    /// Acceleration, m/s^2.
    pub acceleration: Vector<T>,
    /// Power that the stress of the pairs leaves with the particle, W/kg.
    pub stress_power: T,
    /// Power of the viscosity on the pairs, W/kg. The particle takes its [`share_of_power`].
    pub viscous_power: T,
    /// Power of the artificial stress on the pairs, W/kg, positive where it resists. The particle takes its [`share_of_power`].
    pub repulsive_power: T,
}

impl<T: Real> ForceSums<T> {
    /// Nothing summed.
    #[inline(always)]
    pub fn zero() -> Self {
        let o = T::zero();
        Self { acceleration: [o; 3], stress_power: o, viscous_power: o, repulsive_power: o }
    }

    /// Rate of the specific internal energy, W/kg.
    #[inline(always)]
    pub fn energy_rate(&self) -> T {
        self.stress_power + share_of_power(self.viscous_power + self.repulsive_power)
    }

    /// Adds what the stress vectors of a particle and its neighbour bring along the `D` axes computed in, where nothing else acts: the same as
    /// [`Self::add`] without artificial stress and viscosity. `v` and `weighted_f` are those of [`PairForce`].
    #[inline(always)]
    pub fn add_stress<const D: usize>(
        &mut self,
        split: EnergySplit,
        (own_stress, other_stress): (&Vector<T>, &Vector<T>),
        v: &Vector<T>,
        weighted_f: T,
    ) {
        let mut of_stress = T::zero();
        for a in 0..D {
            let stress = own_stress[a] + other_stress[a];
            self.acceleration[a] = stress.mul_add(weighted_f, self.acceleration[a]);
            of_stress = split.share(own_stress[a], stress).mul_add(v[a], of_stress);
        }
        self.stress_power -= of_stress * weighted_f;
    }

    /// Adds a neighbour along the `D` axes computed in.
    #[inline(always)]
    pub fn add<const D: usize>(&mut self, split: EnergySplit, pair: &PairForce<T>) {
        let (mut of_stress, mut of_repulsion) = (T::zero(), T::zero());
        for a in 0..D {
            let artificial = pair.artificial_stress[a] - pair.pi * pair.x[a];
            let stress = pair.own_stress[a] + pair.other_stress[a];
            self.acceleration[a] = (stress + artificial).mul_add(pair.weighted_f, self.acceleration[a]);
            of_stress = split.share(pair.own_stress[a], stress).mul_add(pair.v[a], of_stress);
            of_repulsion = pair.artificial_stress[a].mul_add(pair.v[a], of_repulsion);
        }
        // The work is that of v_j - v_i: the sign of v_ij is turned.
        self.stress_power -= of_stress * pair.weighted_f;
        self.viscous_power = pair.pi.mul_add(pair.closing_power, self.viscous_power);
        self.repulsive_power -= of_repulsion * pair.weighted_f;
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
            // v . x = 3 - 2 - 2.
            closing_power: closing_power(-1.0, -0.5),
        }
    }

    #[test]
    fn forces_and_shares_by_hand() {
        // t* = (-3, 5, 1) - 2 (1, 2, -1) = (-5, 1, 3); t = (0, 5, 14).
        let mut sums =
            ForceSums { acceleration: [1.0, 0.0, 0.0], stress_power: 2.0, viscous_power: 4.0, repulsive_power: 8.0 };
        sums.add::<3>(EnergySplit::OwnStress, &pair());
        assert_eq!(sums.acceleration, [1.0, -2.5, -7.0]);
        // (4, 6, 8) . v = 12 - 6 + 16 = 22 and (-3, 5, 1) . v = -9 - 5 + 2 = -12, times 0.5; 2 v . x = -2, times -0.5.
        assert_eq!((sums.stress_power, sums.viscous_power, sums.repulsive_power), (2.0 + 11.0, 4.0 + 1.0, 8.0 - 6.0));
        assert_eq!(sums.energy_rate(), 13.0 + 0.5 * (5.0 + 2.0));
        let mut sums = ForceSums::zero();
        sums.add::<3>(EnergySplit::Symmetric, &pair());
        // t . v / 2 = (-5 + 28)/2 = 11.5.
        assert_eq!(sums.energy_rate(), 5.75);
        for split in [EnergySplit::OwnStress, EnergySplit::Symmetric] {
            let sums = |pair: &PairForce<f64>| {
                let mut sums = ForceSums::zero();
                sums.add::<3>(split, pair);
                sums
            };
            // Half of it is what the rate lacks without it, with the force that the viscosity has: 2 x . v.
            let all = sums(&pair());
            let without = sums(&PairForce { pi: 0.0, ..pair() });
            assert_eq!((all.energy_rate() - without.energy_rate(), without.viscous_power), (0.5, 0.0), "{split:?}");
            let of_force =
                |sums: ForceSums<f64>| sums.acceleration.iter().zip(pair().v).map(|(a, v)| a * v).sum::<f64>();
            assert_eq!(of_force(without) - of_force(all), 1.0);
            let without = sums(&PairForce { artificial_stress: [0.0; 3], ..pair() });
            assert_eq!((all.energy_rate() - without.energy_rate(), without.repulsive_power), (-3.0, 0.0), "{split:?}");
        }
        // In the plane: (4, 6) . v = 12 - 6, (-3, 5) . v = -9 - 5; v . x is that of space.
        let mut sums = ForceSums::zero();
        sums.add::<2>(EnergySplit::OwnStress, &pair());
        let acceleration = [0.0, -2.5, 0.0];
        assert_eq!(sums, ForceSums { acceleration, stress_power: 3.0, viscous_power: 1.0, repulsive_power: -7.0 });
    }

    #[test]
    fn stresses_alone_bring_what_they_bring_with_nothing_else() {
        for split in [EnergySplit::OwnStress, EnergySplit::Symmetric] {
            let alone = PairForce { artificial_stress: [0.0; 3], pi: 0.0, ..pair() };
            let (mut sums, mut expected) = (ForceSums::zero(), ForceSums::zero());
            expected.add::<3>(split, &alone);
            sums.add_stress::<3>(split, (&alone.own_stress, &alone.other_stress), &alone.v, alone.weighted_f);
            // (5, 4, 11) times -0.5.
            assert_eq!(sums.acceleration, [-2.5, -2.0, -5.5]);
            assert_eq!(sums, expected, "{split:?}");
        }
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
