//! Lists of quantities in the arguments of `plot`.

use sphorge::deck::read_quantity;

/// Reads `N` values between commas as quantities of the dimension of an SI `unit`. A unit behind the last is that of all that
/// have none. SI values.
pub(crate) fn read_quantities<const N: usize>(text: &str, unit: &str) -> Result<[f64; N], String> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let shared = parts.last().map_or("", |last| unit_of(last));
    let read = |part: &&str| {
        let own = if unit_of(part).is_empty() { format!("{part} {shared}") } else { (*part).to_owned() };
        read_quantity(own.trim(), unit)
    };
    let values = parts.iter().map(read).collect::<Result<Vec<f64>, String>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("expected {N} values, found {count}"))
}

/// What follows the number of a quantity.
fn unit_of(text: &str) -> &str {
    let number = (0..=text.len()).rev().filter(|&end| text.is_char_boundary(end));
    let number = number.map(|end| text.split_at(end)).find(|(number, _)| number.parse::<f64>().is_ok());
    number.map_or(text, |(_, unit)| unit)
}

/// A width as a length, or as pixels at so many to the inch, m.
pub(crate) fn read_width(text: &str, dpi: u32) -> Result<f64, String> {
    let width = match text.trim().strip_suffix("px") {
        Some(number) => number.trim().parse::<f64>().map(|pixels| pixels / f64::from(dpi) * 0.0254).ok(),
        None => return read_quantity(text, "m").and_then(sensible),
    };
    width.ok_or_else(|| "this is not a number of pixels".to_owned()).and_then(sensible)
}

fn sensible(width: f64) -> Result<f64, String> {
    if (0.04..=2.0).contains(&width) { Ok(width) } else { Err("a picture can be 40 mm to 2 m wide".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_unit_is_that_of_all_that_have_none() {
        assert_eq!(read_quantities("-60,60,-100,20 mm", "m"), Ok([-0.06, 0.06, -0.1, 0.02]));
        assert_eq!(read_quantities("0,1.5e3", "Pa"), Ok([0.0, 1500.0]));
        assert_eq!(read_quantities("-1,1GPa", "Pa"), Ok([-1e9, 1e9]));
        assert_eq!(read_quantities("100 kPa, 1 MPa", "Pa"), Ok([1e5, 1e6]));
        assert!(read_quantities::<2>("1 GPa", "Pa").unwrap_err().contains("expected 2 values"));
        assert!(read_quantities::<2>("1,2 mm", "Pa").unwrap_err().contains("a length"));
        assert!(read_quantities::<2>(",", "Pa").is_err() && read_quantities::<1>("é", "Pa").is_err());
    }

    #[test]
    fn widths_are_lengths_or_pixels() {
        assert_eq!(read_width("85 mm", 300), Ok(0.085));
        assert!((read_width("390 px", 100).unwrap() - 0.09906).abs() < 1e-9);
        for bad in ["1 um", "x px", "-85 mm", "nan px", "85 kg", "1e9 px"] {
            assert!(read_width(bad, 100).is_err(), "{bad}");
        }
    }
}
