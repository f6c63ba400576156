//! Numbers for people: round steps, SI prefixes, no more digits than needed.

/// Positions of ticks between `low` and `high`: multiples of 1, 2, 2.5 or 5 times a power of ten, at most `most`.
pub(crate) fn ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    let step = round_step((high - low) / most.max(2) as f64);
    if !(step > 0.0 && step.is_finite()) {
        return Vec::new();
    }
    // Ends that miss a multiple by round-off still get their tick.
    let (first, last) = ((low / step - 1e-6).ceil(), (high / step + 1e-6).floor());
    (0..=(last - first).max(0.0) as usize).map(|k| (first + k as f64) * step).collect()
}

/// The smallest of 1, 2, 2.5, 5, 10 times a power of ten that is not below `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let mantissa = rough / power;
    let round = [1.0, 2.0, 2.5, 5.0].into_iter().find(|m| mantissa <= m * (1.0 + 1e-9)).unwrap_or(10.0);
    round * power
}

/// The numbers of an axis, all with the decimals the step needs.
pub(crate) fn tick_labels(ticks: &[f64], scale: f64) -> Vec<String> {
    if let [only] = ticks {
        // No step says how many decimals count: those the round number has.
        return vec![minus(format!("{}", format!("{:.9e}", only / scale).parse().unwrap_or(0.0)))];
    }
    let step = ticks.windows(2).map(|w| (w[1] - w[0]).abs()).fold(f64::INFINITY, f64::min) / scale;
    let decimals = (0..9).find(|&d| {
        let shifted = step * 10f64.powi(d);
        (shifted - shifted.round()).abs() < 1e-6 * shifted
    });
    let decimals = decimals.unwrap_or(9) as usize;
    ticks.iter().map(|t| minus(format!("{:.decimals$}", if *t == 0.0 { 0.0 } else { t / scale }))).collect()
}

/// A value with its unit, to four digits: `60 µs`, `1.234 GPa`, `123.4 × 10⁶ 1/s`.
pub(crate) fn quantity(value: f64, unit: &str) -> String {
    let scale = Scale::of(value.abs(), unit);
    let times = if matches!(scale, Scale::Power(_)) { "× " } else { "" };
    format!("{} {times}{}", four_digits(value / scale.divisor()), scale.unit(unit)).trim_end().to_owned()
}

/// The same for a terminal, in what a keyboard has: `60 us`, `-200 m/s`, `1.234e8 1/s`.
pub(crate) fn plain_quantity(value: f64, unit: &str) -> String {
    plain(match Scale::of(value.abs(), unit) {
        Scale::Power(_) => {
            let digits = format!("{value:.3e}");
            let (digits, exponent) = digits.split_once('e').unwrap_or((&digits, "0"));
            let digits = digits.trim_end_matches('0').trim_end_matches('.');
            format!("{digits}e{exponent} {}", pretty(unit)).trim_end().to_owned()
        }
        Scale::Prefix(..) => quantity(value, unit),
    })
}

/// A number in what a keyboard has.
pub(crate) fn plain(text: String) -> String {
    text.replace('\u{2212}', "-").replace('µ', "u")
}

/// Four significant digits without trailing zeros.
pub(crate) fn four_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..=6).contains(&exponent) {
        return minus(format!("{value:.3e}"));
    }
    let text = format!("{value:.*}", (3 - exponent).max(0) as usize);
    minus(if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text })
}

fn minus(text: String) -> String {
    text.replace('-', "\u{2212}")
}

/// Divisor and unit text for values up to `largest` in an SI `unit`: a prefix where the unit takes one, else a power of
/// ten where the numbers would be long.
pub(crate) fn scaled_unit(largest: f64, unit: &str) -> (f64, String) {
    let scale = Scale::of(largest, unit);
    (scale.divisor(), scale.unit(unit))
}

/// What makes the numbers before a unit short.
#[derive(Clone, Copy, Debug)]
enum Scale {
    /// A divisor and what stands for it before the unit.
    Prefix(f64, &'static str),
    /// A power of ten.
    Power(i32),
}

impl Scale {
    /// For values up to `largest` in an SI unit.
    fn of(largest: f64, unit: &str) -> Self {
        const PREFIXES: [(f64, &str); 9] = [
            (1e12, "T"),
            (1e9, "G"),
            (1e6, "M"),
            (1e3, "k"),
            (1.0, ""),
            (1e-3, "m"),
            (1e-6, "µ"),
            (1e-9, "n"),
            (1e-12, "p"),
        ];
        if largest == 0.0 || !largest.is_finite() {
            return Self::Prefix(1.0, "");
        }
        // Per metre of thickness in plane strain, per square metre in one dimension.
        let takes_prefix = matches!(unit, "Pa" | "m" | "s" | "W/kg") || unit.starts_with(['J', 'N']);
        // Metres are not counted in thousands, nor speeds of hundreds in thousandths of a kilometre.
        let speed = unit == "m/s" && largest < 0.1;
        // Beyond the prefixes numbers would be long again.
        if (takes_prefix || speed) && (1e-14..1e16).contains(&largest) {
            let (scale, prefix) =
                PREFIXES.into_iter().find(|(scale, _)| largest >= 0.999 * scale).unwrap_or((1e-12, "p"));
            return if unit == "m" && scale > 1.0 { Self::Prefix(1.0, "") } else { Self::Prefix(scale, prefix) };
        }
        if (1e-3..1e5).contains(&largest) {
            return Self::Prefix(1.0, "");
        }
        Self::Power(3 * (largest.log10() / 3.0).floor() as i32)
    }

    fn divisor(self) -> f64 {
        match self {
            Self::Prefix(divisor, _) => divisor,
            Self::Power(exponent) => 10f64.powi(exponent),
        }
    }

    fn unit(self, unit: &str) -> String {
        match self {
            Self::Prefix(_, prefix) => format!("{prefix}{}", pretty(unit)),
            Self::Power(exponent) => format!("10{} {}", superscript(exponent), pretty(unit)).trim_end().to_owned(),
        }
    }
}

/// A unit in print.
fn pretty(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³")
}

fn superscript(number: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        other => char::from_u32('⁰' as u32 + other.to_digit(10).unwrap_or(0)).unwrap_or('?'),
    };
    number.to_string().chars().map(digit).collect()
}

/// A whole number with thin spaces between groups of three digits.
pub(crate) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(0.0, 1.0, 5), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(-3.1, 4.2, 4), [-2.0, 0.0, 2.0, 4.0]);
        assert_eq!(ticks(0.1, 0.3, 2), [0.1, 0.2, 0.30000000000000004]);
        assert!(ticks(1.0, 1.0, 5).len() <= 1 && ticks(0.0, f64::NAN, 5).is_empty());
    }

    #[test]
    fn labels_have_the_decimals_of_the_step() {
        assert_eq!(tick_labels(&[-0.25, 0.0, 0.25], 1.0), ["−0.25", "0.00", "0.25"]);
        assert_eq!(tick_labels(&[0.0, 5e8, 1e9], 1e9), ["0.0", "0.5", "1.0"]);
        assert_eq!(tick_labels(&ticks(0.0, 0.6, 3), 1.0), ["0.0", "0.2", "0.4", "0.6"]);
        assert_eq!(tick_labels(&[7890.0], 1.0), ["7890"]);
    }

    #[test]
    fn quantities_read_like_a_person_writes_them() {
        for (value, unit, text) in [
            (6e-5, "s", "60 µs"),
            (1.2345678e9, "Pa", "1.235 GPa"),
            (-200.0, "m/s", "−200 m/s"),
            (7890.0, "kg/m^3", "7890 kg/m³"),
            (0.02546, "m", "25.46 mm"),
            (1500.0, "m", "1500 m"),
            (0.0, "s", "0 s"),
            (1.234e8, "1/s", "123.4 × 10⁶ 1/s"),
            (0.9999e-3, "s", "0.9999 ms"),
            (30_436.0, "J/m", "30.44 kJ/m"),
            (0.0215, "m/s", "21.5 mm/s"),
        ] {
            assert_eq!(quantity(value, unit), text);
        }
        let typed = [(6e-5, "s"), (-200.0, "m/s"), (-1.5e-6, "m")].map(|(value, unit)| plain_quantity(value, unit));
        assert_eq!(typed, ["60 us", "-200 m/s", "-1.5 um"]);
        let long = [(6.187e-4, ""), (1e8, ""), (-1.234e8, "kg/m^3"), (f64::INFINITY, "")];
        assert_eq!(long.map(|(value, unit)| plain_quantity(value, unit)), ["6.187e-4", "1e8", "-1.234e8 kg/m³", "inf"]);
        assert_eq!(scaled_unit(2e6, ""), (1e6, "10⁶".into()));
        assert_eq!((grouped(2125), grouped(1234567)), ("2125".into(), "1\u{a0}234\u{a0}567".into()));
    }
}
