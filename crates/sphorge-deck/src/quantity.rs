//! Quantities: a number with a unit, checked against what the deck asks for there.

use super::unit::{Dimension, Unit, parse_unit};
use sphorge_physics::parameter::PhysicalQuantity;
use std::ops::Range;

/// A kind of quantity a key can ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuantityKind {
    /// Name for people.
    pub(crate) name: &'static str,
    /// SI unit, empty for a pure number.
    pub(crate) si_unit: &'static str,
    /// Dimension.
    pub(crate) dimension: Dimension,
    /// How a value can be written.
    pub(crate) examples: &'static str,
}

macro_rules! kinds {
    ($( $name:ident, $text:literal, $unit:literal, ($l:literal, $m:literal, $t:literal, $k:literal), $examples:literal; )+) => {
        impl QuantityKind {
            $(
                #[doc = concat!("A ", $text, " in ", $unit, ".")]
                pub(crate) const $name: Self = Self {
                    name: $text, si_unit: $unit, dimension: Dimension::new($l, $m, $t, $k), examples: $examples,
                };
            )+
            /// Every kind.
            #[cfg(test)]
            const ALL: &'static [Self] = &[$(Self::$name,)+];
        }
    };
}

kinds! {
    NUMBER, "number", "", (0, 0, 0, 0), r#"0.3 or "30 %""#;
    LENGTH, "length", "m", (1, 0, 0, 0), r#""0.3 mm" or "2 cm""#;
    TIME, "time", "s", (0, 0, 1, 0), r#""60 us" or "2 ms""#;
    VELOCITY, "velocity", "m/s", (1, 0, -1, 0), r#""200 m/s" or "6.18 km/s""#;
    ACCELERATION, "acceleration", "m/s^2", (1, 0, -2, 0), r#""9.81 m/s^2""#;
    ANGLE, "angle", "rad", (0, 0, 0, 0), r#""30 deg" or "0.5 rad""#;
    ANGULAR_VELOCITY, "angular velocity", "rad/s", (0, 0, -1, 0), r#""1200 rpm" or "100 rad/s""#;
    RATE, "rate", "1/s", (0, 0, -1, 0), r#""1 /s""#;
    DENSITY, "density", "kg/m^3", (-3, 1, 0, 0), r#""7890 kg/m^3" or "7.89 g/cm^3""#;
    PRESSURE, "stress", "Pa", (-1, 1, -2, 0), r#""175 MPa" or "80 GPa""#;
    TEMPERATURE, "temperature", "K", (0, 0, 0, 1), r#""293.15 K" or "20 degC""#;
    SPECIFIC_HEAT, "specific heat", "J/(kg K)", (2, 0, -2, -1), r#""452 J/(kg K)""#;
    CONDUCTIVITY, "thermal conductivity", "W/(m K)", (1, 1, -3, -1), r#""80.2 W/(m K)""#;
    HEAT_FLUX, "heat flux", "W/m^2", (0, 1, -3, 0), r#""5 kW/m^2""#;
    HEAT_TRANSFER, "heat transfer coefficient", "W/(m^2 K)", (0, 1, -3, -1), r#""500 W/(m^2 K)""#;
    SPECIFIC_ENERGY, "specific energy", "J/kg", (2, 0, -2, 0), r#""250 kJ/kg""#;
    FRACTURE_ENERGY, "energy per area", "J/m^2", (0, 1, -2, 0), r#""20 kJ/m^2""#;
    MASS, "mass", "kg", (0, 1, 0, 0), r#""12 g""#;
}

impl QuantityKind {
    /// The article of the name.
    pub(crate) fn article(self) -> &'static str {
        if self.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" }
    }
}

impl From<PhysicalQuantity> for QuantityKind {
    fn from(quantity: PhysicalQuantity) -> Self {
        match quantity {
            PhysicalQuantity::Dimensionless => Self::NUMBER,
            PhysicalQuantity::Pressure => Self::PRESSURE,
            PhysicalQuantity::Density => Self::DENSITY,
            PhysicalQuantity::Velocity => Self::VELOCITY,
            PhysicalQuantity::Temperature => Self::TEMPERATURE,
            PhysicalQuantity::SpecificHeat => Self::SPECIFIC_HEAT,
            PhysicalQuantity::Conductivity => Self::CONDUCTIVITY,
            PhysicalQuantity::StrainRate => Self::RATE,
            PhysicalQuantity::SpecificEnergy => Self::SPECIFIC_ENERGY,
            PhysicalQuantity::Unit(si_unit) => Self {
                name: "quantity",
                si_unit,
                dimension: parse_unit(si_unit).map_or(Self::NUMBER.dimension, |unit| unit.dimension),
                examples: "",
            },
        }
    }
}

/// Why a text is not the quantity that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct QuantityError {
    /// Bytes of the text at fault.
    pub(crate) at: Range<usize>,
    /// What is wrong.
    pub(crate) message: String,
    /// What to write instead.
    pub(crate) help: Option<String>,
}

/// The length of the number `text` starts with, and of its part before the exponent.
pub(crate) fn number_length(text: &str) -> Option<(usize, usize)> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut fraction = 0;
    if bytes.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return None;
    }
    let mantissa = end;
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits((end + 1 + sign).min(bytes.len()));
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    Some((mantissa, end))
}

fn scaled(number: &str, mantissa: usize, unit: Unit) -> Option<f64> {
    let own = match number.get(mantissa + 1..) {
        Some(exponent) if !exponent.is_empty() => exponent.parse::<i32>().ok()?,
        _ => 0,
    };
    // Moving the decimal point in the text rounds once: "25.46 mm" is the same double as 0.02546.
    let moved = format!("{}e{}", &number[..mantissa], own.checked_add(unit.exponent)?);
    Some(moved.parse::<f64>().ok()? * unit.factor + unit.offset)
}

#[cfg_attr(test, track_caller)]
fn refused(at: Range<usize>, message: String, help: Option<String>) -> Result<f64, QuantityError> {
    #[cfg(test)]
    crate::fault::sites::note();
    Err(QuantityError { at, message, help })
}

/// Reads `text` as a quantity of the given kind; SI value.
pub(crate) fn parse_quantity(text: &str, kind: QuantityKind) -> Result<f64, QuantityError> {
    let lead = text.len() - text.trim_start().len();
    let body = text.trim();
    let asked = match kind.examples {
        "" => format!("write {}: a number and a unit", with_article(kind)),
        examples => format!("write {}, for example {examples}", with_article(kind)),
    };
    let Some((mantissa, end)) = number_length(body) else {
        return refused(0..text.len(), format!("expected {}", with_article(kind)), Some(asked));
    };
    let (number, unit_text) = body.split_at(end);
    let unit_at = lead + end;
    if unit_text.starts_with(',') && unit_text[1..].starts_with(|c: char| c.is_ascii_digit()) {
        let message = "a number has a decimal point, not a comma".to_owned();
        return refused(unit_at..unit_at + 1, message, Some(asked));
    }
    let unit = if unit_text.trim().is_empty() {
        // A number without unit is in SI, quoted or not.
        Unit { factor: 1.0, exponent: 0, offset: 0.0, dimension: kind.dimension }
    } else {
        match parse_unit(unit_text) {
            Ok(unit) => unit,
            Err(error) => {
                let help = error
                    .help
                    .map_or(asked.clone(), |h| format!("{h}{} {asked}", if h.ends_with('?') { " Or" } else { ";" }));
                return refused(unit_at + error.start..unit_at + error.end, error.message, Some(help));
            }
        }
    };
    if unit.dimension != kind.dimension {
        let message =
            format!("expected {}, found {} in `{}`", with_article(kind), described(unit.dimension), unit_text.trim());
        let start = unit_at + unit_text.len() - unit_text.trim_start().len();
        return refused(start..lead + body.len(), message, Some(asked));
    }
    match scaled(number, mantissa, unit) {
        Some(value) if value.is_finite() => Ok(value),
        _ => refused(lead..lead + body.len(), "the number is out of range".to_owned(), Some(asked)),
    }
}

fn with_article(kind: QuantityKind) -> String {
    let article = kind.article();
    if kind.si_unit.is_empty() {
        format!("{article} {}", kind.name)
    } else {
        format!("{article} {} ({})", kind.name, kind.si_unit)
    }
}

/// Kinds by their dimension; of those that share one the most common.
const KNOWN: [QuantityKind; 15] = [
    QuantityKind::NUMBER,
    QuantityKind::LENGTH,
    QuantityKind::TIME,
    QuantityKind::VELOCITY,
    QuantityKind::ACCELERATION,
    QuantityKind::RATE,
    QuantityKind::DENSITY,
    QuantityKind::PRESSURE,
    QuantityKind::TEMPERATURE,
    QuantityKind::SPECIFIC_HEAT,
    QuantityKind::CONDUCTIVITY,
    QuantityKind::HEAT_FLUX,
    QuantityKind::HEAT_TRANSFER,
    QuantityKind::SPECIFIC_ENERGY,
    QuantityKind::MASS,
];

impl QuantityKind {
    /// How a quantity of a dimension can be written; empty if that is not known.
    pub(crate) fn examples_of(dimension: Dimension) -> &'static str {
        KNOWN.iter().find(|kind| kind.dimension == dimension).map_or("", |kind| kind.examples)
    }
}

fn described(dimension: Dimension) -> String {
    match KNOWN.iter().find(|kind| kind.dimension == dimension) {
        Some(kind) => format!("{} {}", kind.article(), kind.name),
        None => "another dimension".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quantities_of_the_shipped_decks_are_exact() {
        let cases = [
            ("400 m/s", QuantityKind::VELOCITY, 400.0),
            ("25.46 mm", QuantityKind::LENGTH, 0.02546),
            ("175 MPa", QuantityKind::PRESSURE, 175e6),
            ("60 us", QuantityKind::TIME, 60e-6),
            ("80 GPa", QuantityKind::PRESSURE, 80e9),
            ("293.15 K", QuantityKind::TEMPERATURE, 293.15),
            ("20 degC", QuantityKind::TEMPERATURE, 293.15),
            ("7890 kg/m^3", QuantityKind::DENSITY, 7890.0),
            ("452 J/(kg K)", QuantityKind::SPECIFIC_HEAT, 452.0),
            ("1200 rpm", QuantityKind::ANGULAR_VELOCITY, 40.0 * std::f64::consts::PI),
            ("-1.5e-1 km/s", QuantityKind::VELOCITY, -150.0),
            ("30mm", QuantityKind::LENGTH, 0.03),
            ("1 /s", QuantityKind::RATE, 1.0),
            ("12 %", QuantityKind::NUMBER, 0.12),
            ("0.5", QuantityKind::LENGTH, 0.5),
        ];
        for (text, kind, expected) in cases {
            let value = parse_quantity(text, kind).unwrap();
            assert!((value - expected).abs() <= f64::EPSILON * expected.abs(), "{text}: {value}");
        }
        assert_eq!(parse_quantity("25.46 mm", QuantityKind::LENGTH).unwrap(), 0.02546);
    }

    #[test]
    fn a_wrong_unit_names_what_was_expected_and_what_was_found() {
        let error = parse_quantity("200 mm", QuantityKind::VELOCITY).unwrap_err();
        assert_eq!(error.message, "expected a velocity (m/s), found a length in `mm`");
        assert_eq!(error.at, 4..6);
        assert!(error.help.unwrap().contains("200 m/s"));
    }

    #[test]
    fn a_law_may_ask_for_any_unit() {
        let kind = QuantityKind::from(PhysicalQuantity::Unit("1/Pa"));
        assert!((parse_quantity("20 /GPa", kind).unwrap() / 2e-8 - 1.0).abs() < 1e-15);
        let error = parse_quantity("20 GPa", kind).unwrap_err();
        assert_eq!(error.message, "expected a quantity (1/Pa), found a stress in `GPa`");
        let kind = QuantityKind::from(PhysicalQuantity::Unit("Pa/K"));
        assert_eq!(parse_quantity("-23 MPa/K", kind).unwrap(), -23e6);
    }

    #[test]
    fn every_constant_of_a_law_has_a_unit_that_can_be_read() {
        use sphorge_physics::{eos::EQUATIONS_OF_STATE, flow::FLOW_LAWS};
        let flow = FLOW_LAWS.iter().flat_map(|law| law.parameters);
        for parameter in flow.chain(EQUATIONS_OF_STATE.iter().flat_map(|law| law.parameters)) {
            let unit = parameter.quantity.si_unit();
            assert!(unit.is_empty() || parse_unit(unit).is_ok(), "{}: {unit}", parameter.key);
        }
    }

    #[test]
    fn what_is_not_a_finite_number_is_refused() {
        for text in
            ["", "mm", "nan", "inf m", "1e999 m", "--1 m", "1..2 m", "e5", ".", "1 m m", "1e99999999999 m", "é", "1 é"]
        {
            assert!(parse_quantity(text, QuantityKind::LENGTH).is_err(), "{text}");
        }
    }

    #[test]
    fn every_si_unit_has_the_dimension_of_its_kind() {
        for kind in QuantityKind::ALL.iter().filter(|k| !k.si_unit.is_empty()) {
            assert_eq!(
                parse_unit(kind.si_unit).unwrap(),
                Unit { factor: 1.0, exponent: 0, offset: 0.0, dimension: kind.dimension }
            );
        }
    }
}
