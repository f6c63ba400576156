//! What a step may change of a particle at most.
//!
//! Limits of the time step ([`crate::time_step`]) are taken of the state that a step begins in. Where the state changes faster than they know, as
//! where bodies meet, a step that was too long shows in what it has changed: it is taken back and repeated smaller.
//!
//! All numbers are the same in every uniformly moving frame: what flies fast is not changed by it.

use crate::{SymmetricTensor, Tensor, Vector};

/// What a step has changed of a particle, or may change at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepChange {
    /// Change of the density over the density, `|tr L| dt`.
    pub density: f64,
    /// Strain, the norm of the stretching: `sqrt(D:D) dt`.
    pub stretch: f64,
    /// Change of the specific internal energy over itself and the square of the sound speed at rest, `|de/dt| dt / (|e| + c0^2)`.
    pub energy: f64,
    /// Distance that the acceleration of the step moves the particle over its smoothing length, `|a| dt^2 / h`.
    pub jump: f64,
}

impl StepChange {
    /// A tenth of these is what the hardest strikes of the decks change at a Courant number of 0.3, impacts at 6 km/s apart, which come to half.
    pub const DEFAULT: Self = Self { density: 0.2, stretch: 0.25, energy: 0.1, jump: 0.1 };

    /// What a step of size `dt` (s) has changed: `l` is the velocity gradient, 1/s, `energy` in J/kg with its rate in W/kg, the sound speed at rest
    /// in m/s, `acceleration` in m/s², the smoothing length in m.
    #[inline(always)]
    pub fn of(
        l: &Tensor<f64>,
        (energy, energy_rate): (f64, f64),
        sound_speed: f64,
        acceleration: &Vector<f64>,
        smoothing_length: f64,
        dt: f64,
    ) -> Self {
        let d = SymmetricTensor::symmetric_part(l);
        let squared = acceleration.iter().map(|a| a * a).sum::<f64>();
        Self {
            density: d.trace().abs() * dt,
            stretch: d.double_dot(d).sqrt() * dt,
            energy: energy_rate.abs() * dt / (energy.abs() + sound_speed * sound_speed),
            jump: squared.sqrt() * dt * dt / smoothing_length,
        }
    }

    /// The first number that is above its limit: its place in the order of the fields, the number and the limit.
    #[inline(always)]
    pub fn beyond(&self, limits: &Self) -> Option<(usize, f64, f64)> {
        let numbers = [self.density, self.stretch, self.energy, self.jump];
        let limits = [limits.density, limits.stretch, limits.energy, limits.jump];
        let first = numbers.iter().zip(&limits).position(|(number, limit)| number > limit)?;
        Some((first, numbers[first], limits[first]))
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
    fn the_first_number_beyond_its_limit_is_named() {
        let limits = StepChange { density: 1.0, stretch: 1.0, energy: 1.0, jump: 1.0 };
        assert_eq!(change(2.0).beyond(&limits), None);
        assert_eq!(change(4.0).beyond(&StepChange { stretch: 9.0, ..limits }), Some((3, 3.2, 1.0)));
        for (k, broken) in [
            StepChange { density: 0.5, ..limits },
            StepChange { stretch: 0.5, ..limits },
            StepChange { energy: 0.5, ..limits },
            StepChange { jump: 0.5, ..limits },
        ]
        .iter()
        .enumerate()
        {
            assert_eq!(limits.beyond(broken), Some((k, 1.0, 0.5)));
        }
    }
}
