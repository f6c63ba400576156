//! Breaking: how damage grows in a step, and what integrity is lost once it is one.

use super::{DamageLaw, DamageState};
use crate::flow::FlowStep;
use crate::{Elementary, Real};

/// Share of the failure strain over which integrity is lost where the deck says nothing else.
pub const DEFAULT_SOFTENING: f64 = 0.1;

/// Failure strain at least, where the deck says nothing else.
pub const DEFAULT_SMALLEST_STRAIN: f64 = 1e-3;

/// Strains over which integrity is lost to elastic strains at the start of breaking, at least: slower than material unloads.
const LEAST_SOFTENING: f64 = 2.0;

/// Over what a material loses its integrity once its damage is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Softening<T> {
    /// A share of the failure strain: it depends on the spacing what a crack takes.
    Share(T),
    /// The plastic work of a crack per area, J/m².
    Energy(T),
    /// The plastic opening of a crack, m.
    Displacement(T),
}

/// What a material bears that has lost its integrity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AfterFailure {
    /// Pressure alone.
    #[default]
    NoTension,
    /// Pressure and, up to a spall pressure, tension; no shear.
    Fluid,
    /// Nothing: it keeps its mass and its velocity.
    Delete,
}

/// How a material breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damage<T> {
    /// How damage grows.
    pub law: DamageLaw<T>,
    /// Failure strain at least.
    pub smallest_strain: T,
    /// Over what integrity is lost.
    pub softening: Softening<T>,
    /// What is borne without integrity.
    pub after: AfterFailure,
}

/// Elastic moduli of whole material, Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli<T> {
    /// Young's modulus.
    pub young: T,
    /// Shear modulus.
    pub shear: T,
}

/// A particle before a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Before<T> {
    /// Its damage.
    pub damage: T,
    /// Its integrity.
    pub integrity: T,
}

/// What a step has made of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breaking<T> {
    /// Damage, not below that before.
    pub damage: T,
    /// Integrity, not above that before.
    pub integrity: T,
    /// Share of the plastic strain of the step that came after a damage of one.
    pub share: T,
}

impl Softening<f64> {
    /// Size of a particle up to which a crack takes what is stated where the stress at the start of breaking is one (Pa); of a larger one it takes so
    /// many times as much. `None` where nothing is stated.
    pub fn largest_size(self, stress: f64, moduli: Moduli<f64>) -> Option<f64> {
        let elastic = stress / moduli.young;
        match self {
            Self::Share(_) => None,
            Self::Energy(energy) => Some(2.0 * energy / (stress * LEAST_SOFTENING * elastic)),
            Self::Displacement(displacement) => Some(displacement / (LEAST_SOFTENING * elastic)),
        }
    }
}

impl AfterFailure {
    /// Pressure, Pa, and share of viscous pressure that material of an integrity bears of the pressure of whole material.
    #[inline(always)]
    pub fn bears<T: Real>(self, pressure: T, integrity: T) -> [T; 2] {
        let (zero, one) = (T::zero(), T::one());
        let pulls = |of: T, or: T| T::select_lt(pressure, zero, of, or);
        match self {
            Self::Fluid => [pressure, one],
            Self::NoTension => [pulls(integrity * pressure, pressure), pulls(integrity, one)],
            Self::Delete => {
                let whole = [pulls(integrity * pressure, pressure), pulls(integrity, one)];
                whole.map(|value| T::select_lt(zero, integrity, value, zero))
            }
        }
    }
}

impl Damage<f64> {
    /// With other numbers.
    pub fn cast<U: Elementary>(&self) -> Damage<U> {
        Damage {
            law: self.law.cast(),
            smallest_strain: U::of(self.smallest_strain),
            softening: match self.softening {
                Softening::Share(share) => Softening::Share(U::of(share)),
                Softening::Energy(energy) => Softening::Energy(U::of(energy)),
                Softening::Displacement(displacement) => Softening::Displacement(U::of(displacement)),
            },
            after: self.after,
        }
    }
}

impl<T: Elementary> Damage<T> {
    /// A particle of a size (m; [`smeared_width`](crate::integrity::smeared_width)) after a step of whole material.
    #[inline(always)]
    pub fn after_step(&self, step: &FlowStep<T>, moduli: Moduli<T>, size: T, before: Before<T>) -> Breaking<T> {
        let state = DamageState::after(step);
        let growth = self.law.growth(&state);
        match self.law.strength() {
            Some(strength) => self.with_stress(growth, strength, moduli, size, before),
            None => self.with_flow(growth, step.plastic_strain_increment, state.von_mises, moduli, size, before),
        }
    }

    /// Where damage grows with plastic strain.
    ///
    /// The plastic work per volume while integrity falls by `dw = -q size/(2 G_f) deps_p` from one to zero is `w q deps_p = -2 w dw G_f/size`, in
    /// all `G_f/size`, whatever the stress `q` on the way; over the width that a crack is smeared over it is `G_f` per area.
    #[inline(always)]
    fn with_flow(
        &self,
        growth: T,
        strain: T,
        von_mises: T,
        moduli: Moduli<T>,
        size: T,
        before: Before<T>,
    ) -> Breaking<T> {
        let (zero, one) = (T::zero(), T::one());
        let growth = growth.min(one / self.smallest_strain);
        let grown = before.damage + growth * strain;
        let excess = (grown - one).max(zero);
        let softened = T::select_lt(zero, excess, excess / growth, zero);
        let loss = match self.softening {
            Softening::Share(share) => growth / share,
            Softening::Energy(energy) => T::of(0.5) * von_mises * size / energy,
            Softening::Displacement(displacement) => size / displacement,
        };
        // Of uniaxial tension, 3 G for E.
        let fastest = T::of(3.0 / LEAST_SOFTENING) * moduli.shear / von_mises.max(one);
        Breaking {
            damage: grown.min(one).max(before.damage),
            integrity: (before.integrity - loss.min(fastest) * softened).max(zero),
            share: T::select_lt(zero, strain, (softened / strain).min(one), zero),
        }
    }

    /// Where damage is the largest stress so far over a strength: the stress that is borne, `w D s_f`, falls along a straight line of the strain
    /// `D s_f/E`.
    #[inline(always)]
    fn with_stress(&self, ratio: T, strength: T, moduli: Moduli<T>, size: T, before: Before<T>) -> Breaking<T> {
        let one = T::one();
        let damage = before.damage.max(ratio);
        let last = match self.softening {
            Softening::Share(share) => one + share,
            Softening::Energy(energy) => T::of(2.0) * energy * moduli.young / (size * strength * strength),
            Softening::Displacement(displacement) => displacement * moduli.young / (size * strength),
        };
        let last = last.max(T::of(LEAST_SOFTENING));
        let left = ((last - damage) / (damage.max(one) * (last - one))).max(T::zero());
        Breaking { damage, integrity: before.integrity.min(left), share: T::zero() }
    }
}
