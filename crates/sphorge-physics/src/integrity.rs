//! Integrity of a particle: what share of tension and of shear it still bears where its material breaks.
//!
//! A crack is smeared over the particles that see both of its faces, those within one support of the kernel. A particle of integrity
//! `w` bears tension up to `w p_s`, its shear stress is `w` times that of whole material, and it bears pressure as whole material
//! does: what closes again is pressed again. The expansion `v` that the pressure law would answer with a tension, `-p = rho c_0^2 v`,
//! is that of the solid, `w v_s` with `rho c_0^2 v_s = p_s`, and an opening, `v - w v_s`. Integrity falls in proportion to the largest
//! opening so far and is gone where the opening times the size of the particle is the length `delta`:
//!
//! ```text
//! w = min(w_before, (rho c_0^2 v_c + p)/(rho c_0^2 v_c - p_s)),   v_c = max(delta/size, 2 p_s/(rho_0 c_0^2))
//! ```
//!
//! The size is the width over which a face of the crack is smeared, the diameter of the kernel's support. All particles across a
//! crack together then take about the energy `p_s delta/2` per area, whatever their spacing: a softening strain that were the same for all
//! spacings would take less on every finer lattice (Hillerborg, Modéer & Petersson 1976; Bažant & Oh 1983). The second term of `v_c`
//! keeps the softening slower than the material unloads.
//!
//! Strain that opens a crack does not shear the solid beside it: while a particle opens, the deviator of its whole material does not grow. In
//! uniaxial strain it would grow by `4/3 G` of each opening, a hundred times what the pressure loses, and the particle would harden instead of letting go.

use crate::history::HistoryVariable;
use crate::parameter::Bound;
use crate::{Real, SymmetricTensor};

/// Integrity as a number kept from step to step.
pub static INTEGRITY: HistoryVariable = HistoryVariable {
    name: "integrity",
    unit: "",
    initial: 1.0,
    bound: Bound::Between(0.0, 1.0),
    meaning: "share of tension and shear a particle still bears: 1 whole, 0 severed",
};

/// Opening at which a crack bears no more tension where the deck gives none, m.
pub const DEFAULT_OPENING: f64 = 1e-4;

/// Strains of opening to elastic strains at the spall pressure, at least.
const LEAST_SOFTENING: f64 = 2.0;

/// How a material spalls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spall<T> {
    /// Tension `p_s` it bears, Pa, above zero.
    pub pressure: T,
    /// Opening `delta` of a crack at which it bears none any more, m.
    pub opening: T,
    /// Density and sound speed at rest.
    pub density: T,
    /// m/s.
    pub sound_speed: T,
}

/// What a particle bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Borne<T> {
    /// Pressure, Pa.
    pub pressure: T,
    /// Integrity, not above that before.
    pub integrity: T,
    /// Share of viscous pressure it bears: all where the particle is closed, else its integrity.
    pub share: T,
}

/// Width over which the faces of a crack are smeared, m, of a particle with a smoothing length, m, and a kernel of a support.
#[inline(always)]
pub fn smeared_width<T: Real>(support: f64, smoothing_length: T) -> T {
    T::of(2.0 * support) * smoothing_length
}

impl Spall<f64> {
    /// With other numbers.
    pub fn cast<T: Real>(&self) -> Spall<T> {
        Spall {
            pressure: T::of(self.pressure),
            opening: T::of(self.opening),
            density: T::of(self.density),
            sound_speed: T::of(self.sound_speed),
        }
    }
}

impl<T: Real> Spall<T> {
    /// What a particle of a density (kg/m³), of an integrity before, and of a size (m; [`smeared_width`]) bears where its pressure law
    /// says `pressure`, Pa.
    #[inline(always)]
    pub fn borne(&self, density: T, pressure: T, before: T, size: T) -> Borne<T> {
        let squared = self.sound_speed * self.sound_speed;
        let severed = (self.opening / size).max(T::of(LEAST_SOFTENING) * self.pressure / (self.density * squared));
        let stiffness = density * squared * severed;
        // What is not a number stays so, and takes nothing from the integrity.
        let left = T::select_lt(stiffness + pressure, T::zero(), T::zero(), stiffness + pressure);
        // Where nothing is left, the density may be so low that the other is no more above zero.
        let all = T::select_lt(T::zero(), left, stiffness - self.pressure, T::one());
        let integrity = T::select_lt(left / all, before, left / all, before);
        let least = -integrity * self.pressure;
        Borne {
            pressure: T::select_lt(pressure, least, least, pressure),
            integrity,
            share: T::select_lt(pressure, least, integrity, T::one()),
        }
    }
}

/// Share of the stiffness of hourglass springs that material has which breaks without ever yielding. What opens a crack is a misfit of the springs beside it, and without a flow
/// stress they would not soften by it: at nine tenths of the integrity they have a hundredth, before the crack has opened by more than metal is strained.
#[inline(always)]
pub fn share_of_springs<T: Real>(integrity: T) -> T {
    let mut share = integrity;
    for _ in 0..5 {
        share = share * share;
    }
    share
}

/// Share of a deviator that is left after a step in which the integrity of a particle has fallen to `integrity`: its size does not grow while the
/// particle opens. Deviators of whole material before and after the step, Pa; the same times a number may be given.
#[inline(always)]
pub fn share_while_opening<T: Real>(
    (before, integrity_before): (SymmetricTensor<T>, T),
    (after, integrity): (SymmetricTensor<T>, T),
) -> T {
    let (was, is) = (before.double_dot(before), after.double_dot(after));
    let share = (was / is.max(T::of(f64::from(f32::MIN_POSITIVE)))).min(T::one()).sqrt();
    T::select_lt(integrity, integrity_before, share, T::one())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn springs_of_what_opens_let_go_early() {
        assert_eq!((share_of_springs(1.0), share_of_springs(0.0)), (1.0, 0.0));
        assert!((share_of_springs(0.9f64) - 0.9f64.powi(32)).abs() < 1e-15);
    }

    #[test]
    fn a_deviator_does_not_grow_while_a_particle_opens() {
        let uniaxial = |s: f64| SymmetricTensor { xx: 2.0 * s, yy: -s, zz: -s, xy: 0.0, yz: 0.0, xz: 0.0 };
        let share =
            |was: f64, is: f64, integrity: f64| share_while_opening((uniaxial(was), 0.5), (uniaxial(is), integrity));
        assert_eq!(share(3.0, 4.0, 0.25), 0.75);
        // What has not opened grows as it may, and what unloads is as small as it is.
        assert_eq!((share(3.0, 4.0, 0.5), share(3.0, 2.0, 0.25), share(0.0, 0.0, 0.25)), (1.0, 1.0, 0.0));
        // In another direction as large.
        let sheared = SymmetricTensor { xy: 18.0f64.sqrt(), ..uniaxial(0.0) };
        assert!((share_while_opening((uniaxial(3.0), 1.0), (sheared, 0.9)) - (54.0f64 / 36.0).min(1.0)).abs() < 1e-15);
    }

    const SIZE: f64 = 1e-3;

    /// `rho_0 c_0^2` is 128 GPa, the elastic strain at the spall pressure 1/64.
    fn steel(opening: f64) -> Spall<f64> {
        Spall { pressure: 2e9, opening, density: 8000.0, sound_speed: 4000.0 }
    }

    /// The pressure of whole material at a density, and what a particle bears of it.
    fn borne(spall: &Spall<f64>, density: f64, before: f64) -> Borne<f64> {
        spall.borne(density, 16e6 * (density - 8000.0), before, SIZE)
    }

    #[test]
    fn whole_material_bears_what_the_law_says_up_to_the_spall_pressure() {
        let spall = steel(1e-4);
        for density in [9000.0, 8000.0, 7900.0, 7875.0] {
            let expected = Borne { pressure: 16e6 * (density - 8000.0), integrity: 1.0, share: 1.0 };
            assert_eq!(borne(&spall, density, 1.0), expected);
        }
        let beyond = borne(&spall, 7874.0, 1.0);
        assert!(beyond.integrity < 1.0 && beyond.integrity > 0.99 && beyond.pressure == -2e9 * beyond.integrity);
    }

    #[test]
    fn tension_falls_to_zero_with_the_opening() {
        // 0.1 mm over 1 mm. At a density of 7600 kg/m^3 the expansion is 1/19: w = (0.1 - 1/19)/(0.1 - 2/121.6), by hand 0.56674...
        let half = borne(&steel(1e-4), 7600.0, 1.0);
        let expected = (0.1 - 1.0 / 19.0) / (0.1 - 2e9 / (7600.0 * 16e6));
        assert!((half.integrity - expected).abs() < 1e-12 && (half.integrity - 0.566_929).abs() < 1e-6, "{half:?}");
        // The opening is what the solid is not strained by: (1 - w) of the largest.
        let opening = SIZE * (1.0 / 19.0 - half.integrity * 2e9 / (7600.0 * 16e6));
        assert!((opening / 1e-4 - (1.0 - half.integrity)).abs() < 1e-12);
        for density in [7272.0, 4000.0, 50.0] {
            assert_eq!(borne(&steel(1e-4), density, 1.0), Borne { pressure: -0.0, integrity: 0.0, share: 0.0 });
        }
    }

    #[test]
    fn what_was_lost_does_not_come_back_but_pressure_does() {
        let spall = steel(1e-4);
        let closed = borne(&spall, 8080.0, 0.3);
        assert_eq!(closed, Borne { pressure: 1.28e9, integrity: 0.3, share: 1.0 });
        assert_eq!(borne(&spall, 7900.0, 0.3), Borne { pressure: -0.6e9, integrity: 0.3, share: 0.3 });
        assert_eq!(borne(&spall, 7999.0, 0.3), Borne { pressure: -16e6, integrity: 0.3, share: 1.0 });
        assert_eq!(borne(&spall, 7999.0, 0.0).pressure, 0.0);
    }

    #[test]
    fn the_energy_of_an_opening_is_half_the_length_times_the_pressure() {
        // All of the width opens: per area the work is that per volume times the size.
        for opening in [5e-5, 1e-4, 4e-4] {
            let spall = steel(opening);
            let (mut work, mut integrity, steps) = (0.0, 1.0, 400_000);
            let volume = |k: u32| 1.0 + 0.5 * f64::from(k) / f64::from(steps);
            for k in 0..steps {
                let middle = 0.5 * (volume(k) + volume(k + 1));
                let here = borne(&spall, 8000.0 / middle, integrity);
                integrity = here.integrity;
                work -= here.pressure * (volume(k + 1) - volume(k)) * SIZE;
            }
            assert_eq!(integrity, 0.0);
            let expected = 0.5 * 2e9 * opening;
            // The strain of the solid counts against the volume of now, which is not that at rest.
            assert!((work / expected - 1.0).abs() < 0.5 * opening / SIZE + 0.01, "{opening}: {work} {expected}");
        }
    }

    #[test]
    fn a_coarse_particle_softens_more_slowly_than_it_unloads() {
        // An opening of 1 um over 1 mm is less than the elastic strain: twice that counts, 1/32.
        let spall = steel(1e-6);
        let just_beyond = borne(&spall, 7870.0, 1.0);
        assert!(just_beyond.integrity > 0.9, "{just_beyond:?}");
        assert!(borne(&spall, 8000.0 / (1.0 + 1.01 / 32.0), 1.0).integrity == 0.0);
    }

    #[test]
    fn the_size_is_the_diameter_of_the_support() {
        assert_eq!(smeared_width(2.0, 1.5e-3), 6e-3);
    }
}
