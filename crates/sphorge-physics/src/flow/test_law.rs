//! A law for tests alone that uses all a law may use: pressure, compression, a shear modulus that varies, damage.

use super::perfectly_plastic::YIELD_STRESS;
use super::{FlowState, FlowStep, YieldLaw, YieldStress};
use crate::history::HistoryVariable;
use crate::parameter::{Bound, Parameter, PhysicalQuantity};
use crate::{Elementary, Scalar};

/// `Y = (sigma_y + H eps_p + k p) (1 - D)`, `G = G_0 (1 + A p/eta^(1/3))` with the compression `eta`, and the damage of plastic
/// work per volume, `dD = sigma deps_p/W`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureAndDamage<T> {
    /// `sigma_y`, Pa.
    yield_stress: T,
    /// `H`, Pa.
    hardening_modulus: T,
    /// `k`.
    friction: T,
    /// `A`, 1/Pa.
    stiffening: T,
    /// `W`, J/m^3.
    work: T,
}

impl<T: Elementary> PressureAndDamage<T> {
    /// The same law in another precision.
    pub(super) fn cast<U: Elementary>(&self) -> PressureAndDamage<U>
    where
        T: Scalar,
    {
        PressureAndDamage {
            yield_stress: U::of(self.yield_stress.to_f64()),
            hardening_modulus: U::of(self.hardening_modulus.to_f64()),
            friction: U::of(self.friction.to_f64()),
            stiffening: U::of(self.stiffening.to_f64()),
            work: U::of(self.work.to_f64()),
        }
    }
}

impl<T: Elementary> YieldLaw<T> for PressureAndDamage<T> {
    const KEY: &'static str = "pressure-and-damage";
    const NAME: &'static str = "pressure and damage";
    const REFERENCE: &'static str = "none";
    const PARAMETERS: &'static [Parameter] = &[
        YIELD_STRESS,
        Parameter::required("H", "H", PhysicalQuantity::Pressure, Bound::NonNegative, "hardening"),
        Parameter::required("k", "k", PhysicalQuantity::Dimensionless, Bound::NonNegative, "friction"),
        Parameter::required("A", "A", PhysicalQuantity::Unit("1/Pa"), Bound::NonNegative, "stiffening"),
        Parameter::required("W", "W", PhysicalQuantity::Pressure, Bound::Positive, "work to failure"),
    ];
    const HAS_SHEAR: bool = true;
    const YIELDS: bool = true;
    const SHEAR_MODULUS_VARIES: bool = true;
    const CHANGES_WITHOUT_FLOW: bool = true;
    const HISTORY: &'static [HistoryVariable] = &[HistoryVariable {
        name: "damage",
        unit: "",
        initial: 0.0,
        bound: Bound::Between(0.0, 1.0),
        meaning: "share of the strength that is lost",
    }];

    fn check(_values: &[f64]) -> Option<&'static str> {
        None
    }

    fn new(values: &[f64]) -> Self {
        let [yield_stress, hardening_modulus, friction, stiffening, work] = [0, 1, 2, 3, 4].map(|k| T::of(values[k]));
        Self { yield_stress, hardening_modulus, friction, stiffening, work }
    }

    fn yield_stress(&self, state: FlowState<T>, history: &[T]) -> YieldStress<T> {
        let whole = T::one() - history[0];
        let hardened = self.yield_stress + self.hardening_modulus * state.plastic_strain;
        YieldStress {
            value: (hardened + self.friction * state.pressure).max(T::zero()) * whole,
            by_strain: self.hardening_modulus * whole,
            by_rate: T::zero(),
        }
    }

    fn held(&self, state: FlowState<T>) -> Self {
        Self { yield_stress: self.yield_stress + self.friction * state.pressure, friction: T::zero(), ..*self }
    }

    fn shear_modulus(&self, at_rest: T, state: FlowState<T>) -> T {
        let relative = self.stiffening * state.pressure / state.compression.powf(T::of(1.0 / 3.0));
        at_rest * (T::one() + relative)
    }

    fn evolve(&self, step: &FlowStep<T>, history: &mut [T]) {
        let work = step.deviator.von_mises() * step.plastic_strain_increment;
        history[0] = (history[0] + work / self.work).min(T::one());
    }

    fn melting_temperature(&self) -> Option<T> {
        None
    }
}
