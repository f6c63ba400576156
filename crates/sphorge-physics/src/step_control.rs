//! Step control: the largest changes of a particle that a step may cause.
//!
//! Limits of the time step ([`crate::time_step`]) are computed from the state at the start of a step. Where the state
//! changes faster, for example where bodies meet, a step that was too long shows in the changes it has caused: it is
//! rejected and repeated with a smaller size.
//!
//! All numbers are the same in every uniformly moving frame, so a high speed alone does not matter.

use crate::stress::strain_rate;
use crate::tensor::dot;
use crate::{Real, SymmetricTensor, Tensor, Vector};

/// Quantities that a step can change too much.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changed {
    /// The density.
    Density,
    /// The shape.
    Stretch,
    /// The specific internal energy.
    Energy,
    /// The place.
    Jump,
}

/// Changes of a particle by a step, or their limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepChange<T = f64> {
    /// Change of the density over the density, `|tr L| dt`.
    pub density: T,
    /// Strain, the norm of the stretching: `sqrt(D:D) dt`.
    pub stretch: T,
    /// Change of the specific internal energy over its value plus the square of the sound speed at rest, `|de/dt| dt /
    /// (|e| + c0^2)`.
    pub energy: T,
    /// Distance that the acceleration of the step moves the particle, over its smoothing length, `|a| dt^2 / h`.
    pub jump: T,
}

impl<T: Real> StepChange<T> {
    /// Changes by a step of size `dt` (s): `l` is the velocity gradient, 1/s, `energy` in J/kg with its rate in W/kg,
    /// the sound speed at rest in m/s, `acceleration` in m/s², the smoothing length in m.
    #[inline(always)]
    pub fn of(
        l: &Tensor<T>,
        (energy, energy_rate): (T, T),
        sound_speed: T,
        acceleration: &Vector<T>,
        smoothing_length: T,
        dt: T,
    ) -> Self {
        let squared = dot(*acceleration, *acceleration);
        Self {
            density: SymmetricTensor::symmetric_part(l).trace().abs() * dt,
            stretch: strain_rate(l) * dt,
            energy: energy_rate.abs() * dt / (energy.abs() + sound_speed * sound_speed),
            jump: squared.sqrt() * dt * dt / smoothing_length,
        }
    }
}

impl StepChange {
    /// The hardest impacts of the decks reach a tenth of these at a Courant number of 0.3; impacts at 6 km/s reach
    /// half.
    pub const DEFAULT: Self = Self { density: 0.2, stretch: 0.25, energy: 0.1, jump: 0.1 };

    /// Each number with its quantity.
    #[inline(always)]
    fn numbers(&self) -> [(Changed, f64); 4] {
        [
            (Changed::Density, self.density),
            (Changed::Stretch, self.stretch),
            (Changed::Energy, self.energy),
            (Changed::Jump, self.jump),
        ]
    }

    /// Whether a number is above its limit, or not a number.
    #[inline(always)]
    pub fn is_beyond(&self, limits: &Self) -> bool {
        let is_above = |((_, number), (_, limit)): ((Changed, f64), (Changed, f64))| number > limit || number.is_nan();
        self.numbers().into_iter().zip(limits.numbers()).any(is_above)
    }

    /// The quantity with the largest change relative to its limit, the change, and the limit. A value that is not a
    /// number is larger than any other.
    pub fn worst(&self, limits: &Self) -> (Changed, f64, f64) {
        let pairs = self.numbers().into_iter().zip(limits.numbers());
        let of_pair = |((changed, number), (_, limit))| (changed, number, limit);
        let larger = |a: (Changed, f64, f64), b: (Changed, f64, f64)| {
            let is_more = b.1.is_nan() && !a.1.is_nan() || b.1 / b.2 > a.1 / a.2;
            if is_more { b } else { a }
        };
        pairs.map(of_pair).reduce(larger).unwrap_or((Changed::Density, self.density, limits.density))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of 2 s that stretches by 0.1, 0.2 and -0.3 and shears by 0.4, sideways by 3 and 4 m/s², with 50 W/kg.
    fn change(dt: f64) -> StepChange {
        let l = [[0.05, 0.4, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, -0.15]];
        StepChange::of(&l, (-2.5e3, -50.0), 50.0, &[3.0, -4.0, 0.0], 25.0, dt)
    }

    #[test]
    fn changes_by_hand() {
        let StepChange { density, stretch, energy, jump } = change(2.0);
        assert!(density < 1e-15, "{density}");
        // sqrt(0.1^2 + 0.2^2 + 0.3^2 + 2 0.4^2): the shear of 0.8 is shared by two components.
        assert!((stretch - 0.46f64.sqrt()).abs() < 1e-15, "{stretch}");
        // 100 J/kg of 2500 and 50^2.
        assert!((energy - 0.02).abs() < 1e-17, "{energy}");
        assert!((jump - 0.8).abs() < 1e-15, "{jump}");
        let compressed = StepChange::of(&[[-0.1, 0.0, 0.0], [0.0; 3], [0.0; 3]], (0.0, 0.0), 1.0, &[0.0; 3], 1.0, 0.5);
        assert_eq!((compressed.density, compressed.stretch), (0.05, 0.05));
    }

    #[test]
    fn rotation_changes_nothing() {
        let spin = [[0.0, 1e3, -2e3], [-1e3, 0.0, 3e3], [2e3, -3e3, 0.0]];
        let change = StepChange::of(&spin, (0.0, 0.0), 1.0, &[0.0; 3], 1.0, 1.0);
        assert_eq!((change.density, change.stretch), (0.0, 0.0));
    }

    #[test]
    fn what_changes_most_beside_its_limit_is_named() {
        let limits = StepChange { density: 1.0, stretch: 2.0, energy: 4.0, jump: 8.0 };
        let at = |density, stretch, energy, jump| StepChange { density, stretch, energy, jump };
        assert!(!limits.is_beyond(&limits));
        for (change, worst) in [
            (at(3.0, 2.0, 4.0, 8.0), (Changed::Density, 3.0, 1.0)),
            (at(0.5, 4.0, 4.0, 8.0), (Changed::Stretch, 4.0, 2.0)),
            (at(0.5, 2.5, 10.0, 8.0), (Changed::Energy, 10.0, 4.0)),
            (at(0.5, 2.0, 4.0, 16.0), (Changed::Jump, 16.0, 8.0)),
        ] {
            assert_eq!((change.worst(&limits), change.is_beyond(&limits)), (worst, true));
        }
        let broken = at(9.0, f64::NAN, 0.0, 0.0);
        assert!(broken.is_beyond(&limits) && broken.worst(&limits).0 == Changed::Stretch);
        assert!(at(0.0, f64::NAN, 0.0, 0.0).is_beyond(&limits));
    }
}
