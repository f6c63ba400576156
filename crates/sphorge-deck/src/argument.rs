//! Quantities of the command line, read as in decks, and values of keys that are varied.

use super::{
    expected::Expected,
    keys::DECK,
    overrides::parse_value,
    quantity::{QuantityKind, number_length, parse_quantity},
    unit::parse_unit,
};
use toml_edit::{Key, Value};

/// Kinds that have a name for people.
const KINDS: [QuantityKind; 10] = [
    QuantityKind::NUMBER,
    QuantityKind::LENGTH,
    QuantityKind::TIME,
    QuantityKind::VELOCITY,
    QuantityKind::RATE,
    QuantityKind::DENSITY,
    QuantityKind::PRESSURE,
    QuantityKind::TEMPERATURE,
    QuantityKind::SPECIFIC_ENERGY,
    QuantityKind::MASS,
];

/// Reads a text such as `12 us` as a quantity of the dimension of an SI `unit`, by the rules of decks. SI value.
///
/// # Errors
/// What is wrong with the text, and what to write instead.
pub fn read_quantity(text: &str, unit: &str) -> Result<f64, String> {
    let known = KINDS.into_iter().find(|kind| kind.si_unit == unit);
    let dimension = parse_unit(unit).map_or(QuantityKind::NUMBER.dimension, |unit| unit.dimension);
    let kind = known.unwrap_or(QuantityKind { name: "quantity", si_unit: "", dimension, examples: "" });
    parse_quantity(text, kind).map_err(|error| match error.help {
        Some(help) => format!("{}; {help}", error.message),
        None => error.message,
    })
}

/// The same of the difference of two quantities: `5 degC` is 5 K.
///
/// # Errors
/// As above.
pub fn read_difference(text: &str, unit: &str) -> Result<f64, String> {
    let value = read_quantity(text, unit)?;
    let body = text.trim();
    let own = number_length(body).and_then(|(_, end)| parse_unit(&body[end..]).ok());
    match own.filter(|own| own.offset != 0.0) {
        // Not the value less the offset, which would round it.
        Some(own) => {
            read_quantity(body[..number_length(body).map_or(0, |(_, end)| end)].trim(), unit).map(|x| x * own.factor)
        }
        None => Ok(value),
    }
}

/// What a key of a deck asks for: a quantity.
fn quantity_at(path: &str) -> Option<QuantityKind> {
    fn kind(expected: &Expected) -> Option<QuantityKind> {
        match expected {
            Expected::Quantity(_, kind) | Expected::Constant(kind) => Some(*kind),
            Expected::Either(one, other) => kind(one).or_else(|| kind(other)),
            _ => None,
        }
    }
    let mut at = DECK;
    for key in Key::parse(path).ok()? {
        // A name or a number where there is no such key chooses an entry of a list.
        at = match at.key(key.get()) {
            Some((inner, _)) => inner,
            None => at.item(key.get().parse().unwrap_or(0))?,
        };
    }
    kind(at)
}

/// A value for the key at a path, as [`crate::load`] takes it in overrides, as a number: its SI value and unit, which is empty for pure numbers. A
/// number without a unit has that of the key. `None` if it is no quantity, or one that the key does not take.
pub fn quantity_of_key(path: &str, value: &str) -> Option<(f64, &'static str)> {
    let asked = quantity_at(path);
    let text = match parse_value(value) {
        Value::String(text) => text.into_value(),
        Value::Integer(number) => return Some((number.into_value() as f64, asked.map_or("", |kind| kind.si_unit))),
        Value::Float(number) => return Some((number.into_value(), asked.map_or("", |kind| kind.si_unit))),
        _ => return None,
    };
    let kind = match asked {
        Some(kind) => kind,
        // A number all the same, such as the constant of a law whose name the path does not say.
        None => {
            let (_, end) = number_length(text.trim())?;
            let dimension = parse_unit(&text.trim()[end..]).ok()?.dimension;
            KINDS.into_iter().find(|kind| kind.dimension == dimension)?
        }
    };
    Some((parse_quantity(&text, kind).ok()?, kind.si_unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_keys_are_numbers_in_the_unit_of_the_key() {
        let cases = [
            ("particles.spacing", "0.6 mm", Some((0.6e-3, "m"))),
            ("particles.spacing", "\"0.6 mm\"", Some((0.6e-3, "m"))),
            ("particles.spacing", "6e-4", Some((6e-4, "m"))),
            ("body.bar.velocity.1", "-150 m/s", Some((-150.0, "m/s"))),
            ("body.0.velocity.1", "-150", Some((-150.0, "m/s"))),
            ("material.any.strength.johnson-cook.A", "175 MPa", Some((175e6, "Pa"))),
            ("material.any.density", "7.8 g/cm^3", Some((7800.0, "kg/m^3"))),
            ("time.max-steps", "40", Some((40.0, ""))),
            ("numerics.viscosity.alpha", "2", Some((2.0, ""))),
            ("body.bar.spin.rate", "60 rpm", Some((std::f64::consts::TAU, "rad/s"))),
            ("particles.spacing", "0.6 s", None),
            ("search", "skin", None),
            ("body.bar.velocity", "[0, 1]", None),
            ("no.such.key", "fast", None),
        ];
        for (path, value, expected) in cases {
            let found = quantity_of_key(path, value);
            match (found, expected) {
                (Some((x, unit)), Some((y, asked))) => {
                    assert!((x - y).abs() <= 1e-15 * y.abs() && unit == asked, "{path}={value}: {x} {unit}");
                }
                _ => assert_eq!(found, expected, "{path}={value}"),
            }
        }
    }

    #[test]
    fn arguments_have_units_as_decks_do() {
        assert_eq!(read_quantity("12 us", "s"), Ok(12e-6));
        assert_eq!(read_quantity("1.5 GPa", "Pa"), Ok(1.5e9));
        assert_eq!(read_quantity("3 kW/kg", "W/kg"), Ok(3000.0));
        let error = read_quantity("12 mm", "s").unwrap_err();
        assert!(error.contains("found a length") && error.contains("60 us"), "{error}");
        assert!(read_quantity("soon", "s").is_err());
    }

    #[test]
    fn differences_have_no_offset() {
        assert_eq!(read_quantity("20 degC", "K"), Ok(293.15));
        assert_eq!(read_difference("5 degC", "K"), Ok(5.0));
        assert_eq!(read_difference("-0.5 degC", "K"), Ok(-0.5));
        assert_eq!((read_difference("5 K", "K"), read_difference("0.1 mm", "m")), (Ok(5.0), Ok(1e-4)));
        assert_eq!(read_difference("0.1", "m"), Ok(0.1));
        assert!(read_difference("5 degC", "m").is_err());
    }
}
