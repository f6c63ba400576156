//! Quantities by which neighbour lists are compared with an exact search: the density rate and the acceleration by
//! stress alone.

use crate::tensor::dot;
use crate::{Real, SymmetricTensor, Vector};

/// Data of a pair for the comparison.
#[derive(Clone, Copy, Debug)]
pub struct AuditPair<T> {
    /// `x_i - x_j`, m.
    pub x: Vector<T>,
    /// `v_j - v_i`, m/s.
    pub v: Vector<T>,
    /// `(1/r) dW/dr`, m^-(d+2).
    pub f: T,
    /// `m_j/rho_j`, m^d.
    pub volume: T,
    /// `rho_i`, kg/m^3.
    pub density: T,
    /// Sum of both stresses, Pa.
    pub stress: SymmetricTensor<T>,
}

/// Sums of one particle.
#[derive(Clone, Copy, Debug)]
pub struct AuditSums<T> {
    /// Rate of `ln rho`, 1/s.
    pub divergence: T,
    /// Acceleration, m/s^2.
    pub acceleration: Vector<T>,
}

impl<T: Real> AuditSums<T> {
    /// Nothing summed.
    pub fn zero() -> Self {
        Self { divergence: T::zero(), acceleration: [T::zero(); 3] }
    }

    /// Adds a pair; returns its contribution to the acceleration, m/s^2.
    pub fn add(&mut self, pair: &AuditPair<T>) -> Vector<T> {
        self.divergence += pair.volume * pair.f * dot(pair.v, pair.x);
        let traction = pair.stress.dot(pair.x);
        let acceleration = traction.map(|traction| pair.volume / pair.density * pair.f * traction);
        (0..3).for_each(|a| self.acceleration[a] += acceleration[a]);
        acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_by_hand() {
        let mut sums = AuditSums::<f64> { divergence: 1.0, acceleration: [0.0, 1.0, 0.0] };
        let stress = SymmetricTensor { xx: 8.0, xy: 3.0, yy: -2.0, ..SymmetricTensor::zero() };
        let (x, v) = ([2.0, 1.0, 0.0], [5.0, -7.0, 9.0]);
        let part = sums.add(&AuditPair { x, v, f: 4.0, volume: 3.0, density: 6.0, stress });
        // 3 4 (10 - 7); 3/6 4 (16 + 3, 6 - 2).
        assert_eq!((sums.divergence, part, sums.acceleration), (37.0, [38.0, 8.0, 0.0], [38.0, 9.0, 0.0]));
    }
}
