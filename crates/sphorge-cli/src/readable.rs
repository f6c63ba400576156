//! Numbers for people: five digits at most, a prefix on the unit, counts with thin groups.

/// A quantity with its SI unit, such as `20.18 mm`; units that take no prefix are left alone.
pub(crate) fn quantity(value: f64, unit: &str) -> String {
    if unit == "kg" && value.abs() < 1.0 {
        return quantity(1e3 * value, "g");
    }
    const PREFIXES: [(f64, &str); 8] =
        [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"), (1e-12, "p")];
    let size = value.abs();
    // Lengths above a metre and times above a second are not said in kilo.
    let largest = if matches!(unit, "m" | "s" | "g") { 1.0 } else { 1e9 };
    let prefixed = matches!(unit, "m" | "s" | "g" | "Pa" | "J" | "N" | "W") && (1e-12..1e13).contains(&size);
    // Engineers say 0.3 mm.
    let share = if unit == "m" { 0.01 } else { 1.0 };
    let fits = |scale: f64| if scale == 1e-3 { size >= 0.99999 * share * scale } else { size >= 0.99999 * scale };
    match PREFIXES.iter().find(|(scale, _)| *scale <= largest && fits(*scale)) {
        Some((scale, prefix)) if prefixed => format!("{} {prefix}{unit}", digits(value / scale)),
        _ => format!("{} {}", digits(value), unit.strip_prefix('1').unwrap_or(unit)).trim_end().to_owned(),
    }
}

/// A number with up to five significant digits.
pub(crate) fn digits(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    let order = if size == 0.0 { 0 } else { size.log10().floor() as i32 };
    let text = format!("{value:.*}", (4 - order).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A whole number in groups of three.
pub(crate) fn count(value: u64) -> String {
    let text = value.to_string();
    let mut grouped = String::with_capacity(text.len() + text.len() / 3);
    for (k, digit) in text.chars().enumerate() {
        if k > 0 && (text.len() - k).is_multiple_of(3) {
            grouped.push(' ');
        }
        grouped.push(digit);
    }
    grouped
}

/// Bytes with a decimal prefix.
pub(crate) fn bytes(value: f64) -> String {
    match value {
        v if v >= 1e9 => format!("{:.1} GB", v / 1e9),
        v if v >= 1e6 => format!("{:.0} MB", v / 1e6),
        v if v >= 1e3 => format!("{:.0} kB", v / 1e3),
        v => format!("{v:.0} bytes"),
    }
}

/// A rate of large numbers, such as `2.13 million`.
pub(crate) fn large(value: f64) -> String {
    match value {
        v if v >= 1e9 => format!("{:.2} billion", v / 1e9),
        v if v >= 1e6 => format!("{:.2} million", v / 1e6),
        v if v >= 1e4 => format!("{:.0} thousand", v / 1e3),
        v => format!("{v:.0}"),
    }
}

/// Wall-clock time, such as `48 s` or `1 h 12 min`.
pub(crate) fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "unknown".to_owned();
    }
    // Minutes of a day fit any float that is worth showing.
    let minutes = (seconds / 60.0).round() as u64;
    match seconds {
        s if s < 0.01 => quantity((s * 1e7).round() / 1e7, "s"),
        s if s < 0.1 => format!("{:.0} ms", s * 1e3),
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 3570.0 => format!("{minutes} min"),
        s if s < 172_800.0 => format!("{} h {} min", minutes / 60, minutes % 60),
        s => format!("{} days", digits((s / 8_640.0).round() / 10.0)),
    }
}

/// `1 thread` or `2 threads`.
pub(crate) fn threads(count: usize) -> String {
    format!("{count} thread{}", if count == 1 { "" } else { "s" })
}

/// `2 threads`, or `3 ranks of 1 thread`.
fn ranks(count: usize, threads_of_each: usize) -> String {
    if count == 1 { threads(threads_of_each) } else { format!("{count} ranks of {}", threads(threads_of_each)) }
}

/// What computes: the device of that name, or the processor's threads.
pub(crate) fn computer(device: Option<&str>, ranks_in_use: usize, threads_of_each: usize) -> String {
    device.map_or_else(|| ranks(ranks_in_use, threads_of_each), str::to_owned)
}

/// A share in per cent.
pub(crate) fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if value == 0.0 {
        "0 %".to_owned()
    } else if value.abs() < 0.01 {
        format!("{value:.1e} %")
    } else {
        format!("{} %", digits((value * 1e3).round() / 1e3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_take_the_prefix_that_leaves_a_handy_number() {
        let cases = [
            (0.020_184_3, "m", "20.184 mm"),
            (60e-6, "s", "60 us"),
            (4.5e-9, "s", "4.5 ns"),
            (9.628e9, "Pa", "9.628 GPa"),
            (4312.52, "m/s", "4312.5 m/s"),
            (-0.0038, "m", "-3.8 mm"),
            (1500.0, "m", "1500 m"),
            (0.0, "m", "0 m"),
            (0.286, "", "0.286"),
            (1e-3, "m", "1 mm"),
            (0.999_999_9e-3, "m", "1 mm"),
            (f64::NAN, "m", "NaN m"),
            (1.0, "m", "1 m"),
            (0.3e-3, "m", "0.3 mm"),
            (5e-6, "m", "5 um"),
            (1.0, "1/s", "1 /s"),
            (0.009_162_34, "kg", "9.1623 g"),
            (12.0, "kg", "12 kg"),
            (0.009_162_34, "kg/m", "0.0091623 kg/m"),
            (870.123_45, "K", "870.12 K"),
            (3e-20, "J", "3.000e-20 J"),
        ];
        for (value, unit, expected) in cases {
            assert_eq!(quantity(value, unit), expected);
        }
    }

    #[test]
    fn counts_bytes_rates_and_times() {
        assert_eq!([0, 999, 1000, 195_112, 12_345_678].map(count), ["0", "999", "1 000", "195 112", "12 345 678"]);
        assert_eq!([512.0, 2e3, 3.4e8, 1.25e10].map(bytes), ["512 bytes", "2 kB", "340 MB", "12.5 GB"]);
        assert_eq!([950.0, 1.5e4, 2.131e6, 3e9].map(large), ["950", "15 thousand", "2.13 million", "3.00 billion"]);
        let times = [3.1e-3, 0.02, 4.21, 48.3, 600.0, 4300.0, 1e6, f64::INFINITY].map(duration);
        assert_eq!(times, ["3.1 ms", "20 ms", "4.2 s", "48 s", "10 min", "1 h 12 min", "11.6 days", "unknown"]);
        assert_eq!([0.0, 0.5, 1.2344e-2, 1e-9].map(percent), ["0 %", "50 %", "1.234 %", "1.0e-7 %"]);
    }
}
