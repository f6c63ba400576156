//! How a law describes the constants it needs, so that a deck reader can ask for them by name, unit and bound.

use crate::history::HistoryVariable;

/// What a constant measures; the deck reader maps it to units. Values reach the laws in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PhysicalQuantity {
    /// A pure number.
    Dimensionless,
    /// Pressure, stress or modulus.
    Pressure,
    /// Mass per volume.
    Density,
    /// Length per time.
    Velocity,
    /// Absolute temperature.
    Temperature,
    /// Energy per mass and temperature.
    SpecificHeat,
    /// Heat conductivity.
    Conductivity,
    /// Strain per time.
    StrainRate,
    /// Energy per mass.
    SpecificEnergy,
    /// What this SI unit measures, such as `1/Pa`.
    Unit(&'static str),
}

impl PhysicalQuantity {
    /// The SI unit, empty for a pure number.
    pub const fn si_unit(self) -> &'static str {
        match self {
            Self::Dimensionless => "",
            Self::Pressure => "Pa",
            Self::Density => "kg/m^3",
            Self::Velocity => "m/s",
            Self::Temperature => "K",
            Self::SpecificHeat => "J/(kg K)",
            Self::Conductivity => "W/(m K)",
            Self::StrainRate => "1/s",
            Self::SpecificEnergy => "J/kg",
            Self::Unit(unit) => unit,
        }
    }
}

/// Values a constant may take; always finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Any finite number.
    Any,
    /// Above zero.
    Positive,
    /// Zero or above.
    NonNegative,
    /// Between two numbers, both allowed.
    Between(f64, f64),
}

impl Bound {
    /// Whether a value is finite and within the bound.
    pub fn allows(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => value > 0.0,
                Self::NonNegative => value >= 0.0,
                Self::Between(low, high) => (low..=high).contains(&value),
            }
    }
}

/// One constant of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in a deck.
    pub key: &'static str,
    /// Letter in the formula.
    pub symbol: &'static str,
    /// What it measures.
    pub quantity: PhysicalQuantity,
    /// Values it may take.
    pub bound: Bound,
    /// Value where a deck says nothing, in SI units; `None` if it must be given.
    pub default: Option<f64>,
    /// One line for the user.
    pub meaning: &'static str,
}

impl Parameter {
    /// A constant that must be given.
    pub const fn required(
        key: &'static str,
        symbol: &'static str,
        quantity: PhysicalQuantity,
        bound: Bound,
        meaning: &'static str,
    ) -> Self {
        Self { key, symbol, quantity, bound, default: None, meaning }
    }
}

/// A law in a table of laws.
#[derive(Clone, Copy, Debug)]
pub struct LawEntry<L: 'static> {
    /// Name in a deck.
    pub key: &'static str,
    /// Name in a text.
    pub name: &'static str,
    /// Where it is published.
    pub reference: &'static str,
    /// The constants, in the order `check` and `build` take them.
    pub parameters: &'static [Parameter],
    /// What the law keeps of the past of a particle, in the order it takes the values; nothing for most laws.
    pub history: &'static [HistoryVariable],
    /// What is wrong with constants that are each within their bound but do not fit together, or `None`.
    pub check: fn(&[f64]) -> Option<&'static str>,
    /// Makes the law from one value per parameter, in their order and in SI units. Panics on a shorter slice.
    pub build: fn(&[f64]) -> L,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_refuse_what_is_outside_and_what_is_not_a_number() {
        assert!(Bound::Any.allows(-1.0) && !Bound::Any.allows(f64::NAN) && !Bound::Any.allows(f64::INFINITY));
        assert!(Bound::Positive.allows(1e-300) && !Bound::Positive.allows(0.0));
        assert!(Bound::NonNegative.allows(0.0) && !Bound::NonNegative.allows(-1e-300));
        assert!(Bound::Between(0.0, 0.5).allows(0.5) && !Bound::Between(0.0, 0.5).allows(0.51));
    }
}
