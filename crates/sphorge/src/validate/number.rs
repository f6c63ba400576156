//! Numbers for people.

/// A number with up to five significant digits.
pub(super) fn significant(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    let order = if size == 0.0 { 0 } else { size.log10().floor() as i32 };
    let text = format!("{value:.*}", (4 - order).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A signed share in per cent: two digits behind the point, more where it is small.
pub(super) fn deviation(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        0.0 => "0 %".to_owned(),
        p if p < 1e-4 => format!("{percent:+.0e} %"),
        p if p < 0.095 => format!("{percent:+.4} %"),
        p if p < 9.95 => format!("{percent:+.2} %"),
        _ => format!("{percent:+.1} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_digits_are_shown_and_trailing_zeros_are_not() {
        let cases = [
            (4312.52, "4312.5"),
            (0.0201843, "0.020184"),
            (9.62800, "9.628"),
            (12.0, "12"),
            (0.0, "0"),
            (-741.592, "-741.59"),
            (3.2e-14, "3.200e-14"),
            (100.0, "100"),
        ];
        for (value, text) in cases {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn deviations_keep_what_matters() {
        let cases = [(0.021, "+2.10 %"), (-0.00022, "-0.0220 %"), (0.123, "+12.3 %"), (0.0, "0 %"), (-2e-9, "-2e-7 %")];
        for (value, text) in cases {
            assert_eq!(deviation(value), text);
        }
    }
}
