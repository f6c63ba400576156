//! Quantities of the command line, read as in decks.

use super::{
    quantity::{QuantityKind, parse_quantity},
    unit::parse_unit,
};

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_have_units_as_decks_do() {
        assert_eq!(read_quantity("12 us", "s"), Ok(12e-6));
        assert_eq!(read_quantity("1.5 GPa", "Pa"), Ok(1.5e9));
        assert_eq!(read_quantity("3 kW/kg", "W/kg"), Ok(3000.0));
        let error = read_quantity("12 mm", "s").unwrap_err();
        assert!(error.contains("found a length") && error.contains("60 us"), "{error}");
        assert!(read_quantity("soon", "s").is_err());
    }
}
