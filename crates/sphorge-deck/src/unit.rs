//! Units of mechanics: a closed table, and products, quotients and powers of its entries.

use std::fmt;

/// Exponents of metre, kilogram, second and kelvin. Angles are pure numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Dimension {
    /// Exponent of the metre.
    pub(crate) length: i8,
    /// Exponent of the kilogram.
    pub(crate) mass: i8,
    /// Exponent of the second.
    pub(crate) time: i8,
    /// Exponent of the kelvin.
    pub(crate) temperature: i8,
}

impl Dimension {
    /// Exponents in the order metre, kilogram, second, kelvin.
    pub(crate) const fn new(length: i8, mass: i8, time: i8, temperature: i8) -> Self {
        Self { length, mass, time, temperature }
    }

    fn combine(self, other: Self, power: i8) -> Option<Self> {
        let add = |a: i8, b: i8| b.checked_mul(power).and_then(|b| a.checked_add(b));
        Some(Self {
            length: add(self.length, other.length)?,
            mass: add(self.mass, other.mass)?,
            time: add(self.time, other.time)?,
            temperature: add(self.temperature, other.temperature)?,
        })
    }
}

/// What one unit is in SI: `factor * 10^exponent`, kept apart so that decimal prefixes do not cost a rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    /// Factor to SI without its decimal prefix.
    pub(crate) factor: f64,
    /// Power of ten.
    pub(crate) exponent: i32,
    /// Added after scaling (degrees Celsius only).
    pub(crate) offset: f64,
    /// What it measures.
    pub(crate) dimension: Dimension,
}

impl Unit {
    const ONE: Self = Self { factor: 1.0, exponent: 0, offset: 0.0, dimension: Dimension::new(0, 0, 0, 0) };
}

/// Why a unit cannot be read; `start..end` are bytes of the unit text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct UnitError {
    /// First byte at fault.
    pub(crate) start: usize,
    /// Byte after the fault.
    pub(crate) end: usize,
    /// What is wrong.
    pub(crate) message: String,
    /// What to write instead.
    pub(crate) help: Option<String>,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// One entry of the table: symbol, factor, power of ten, dimension, and whether it takes decimal prefixes.
struct Symbol(&'static str, f64, i32, Dimension, bool);

const NUMBER: Dimension = Dimension::new(0, 0, 0, 0);
const LENGTH: Dimension = Dimension::new(1, 0, 0, 0);
const MASS: Dimension = Dimension::new(0, 1, 0, 0);
const TIME: Dimension = Dimension::new(0, 0, 1, 0);
const TEMPERATURE: Dimension = Dimension::new(0, 0, 0, 1);
const RATE: Dimension = Dimension::new(0, 0, -1, 0);
const FORCE: Dimension = Dimension::new(1, 1, -2, 0);
const PRESSURE: Dimension = Dimension::new(-1, 1, -2, 0);
const ENERGY: Dimension = Dimension::new(2, 1, -2, 0);
const POWER: Dimension = Dimension::new(2, 1, -3, 0);

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const TURN: f64 = std::f64::consts::TAU;

/// Hertz is left out on purpose: `20 Hz` of spin could mean 20 turns or 20 radians per second.
const SYMBOLS: &[Symbol] = &[
    Symbol("m", 1.0, 0, LENGTH, true),
    Symbol("in", 254.0, -4, LENGTH, false),
    Symbol("ft", 3048.0, -4, LENGTH, false),
    Symbol("g", 1.0, -3, MASS, true),
    Symbol("t", 1.0, 3, MASS, false),
    Symbol("lb", 0.453_592_37, 0, MASS, false),
    Symbol("s", 1.0, 0, TIME, true),
    Symbol("min", 60.0, 0, TIME, false),
    Symbol("h", 3600.0, 0, TIME, false),
    Symbol("K", 1.0, 0, TEMPERATURE, false),
    Symbol("N", 1.0, 0, FORCE, true),
    Symbol("Pa", 1.0, 0, PRESSURE, true),
    Symbol("bar", 1.0, 5, PRESSURE, true),
    Symbol("psi", 6_894.757_293_168, 0, PRESSURE, false),
    Symbol("ksi", 6_894.757_293_168, 3, PRESSURE, false),
    Symbol("J", 1.0, 0, ENERGY, true),
    Symbol("W", 1.0, 0, POWER, true),
    Symbol("rad", 1.0, 0, NUMBER, true),
    Symbol("deg", DEGREE, 0, NUMBER, false),
    Symbol("°", DEGREE, 0, NUMBER, false),
    Symbol("rev", TURN, 0, NUMBER, false),
    Symbol("rpm", TURN / 60.0, 0, RATE, false),
    Symbol("%", 1.0, -2, NUMBER, false),
];

const PREFIXES: &[(&str, i32)] =
    &[("n", -9), ("u", -6), ("µ", -6), ("μ", -6), ("m", -3), ("c", -2), ("d", -1), ("k", 3), ("M", 6), ("G", 9)];

/// Degrees Celsius stand alone: they have an offset.
const CELSIUS: &[&str] = &["degC", "°C"];

fn symbol(name: &str) -> Option<Unit> {
    let unit = |s: &Symbol, prefix: i32| Unit { factor: s.1, exponent: s.2 + prefix, offset: 0.0, dimension: s.3 };
    if let Some(entry) = SYMBOLS.iter().find(|s| s.0 == name) {
        return Some(unit(entry, 0));
    }
    PREFIXES.iter().find_map(|(prefix, power)| {
        let rest = name.strip_prefix(prefix)?;
        SYMBOLS.iter().find(|s| s.4 && s.0 == rest).map(|s| unit(s, *power))
    })
}

/// The table for people: symbol, what it is in SI units, whether it takes prefixes.
#[cfg(test)]
pub(super) fn table() -> Vec<(&'static str, String, bool)> {
    let mut rows = Vec::new();
    for Symbol(name, factor, exponent, dimension, prefixes) in SYMBOLS {
        let value = format!("{factor}e{exponent}").parse::<f64>().unwrap();
        let base =
            [("m", dimension.length), ("kg", dimension.mass), ("s", dimension.time), ("K", dimension.temperature)];
        let powers: Vec<String> = base
            .iter()
            .filter(|(_, power)| *power != 0)
            .map(|(unit, power)| if *power == 1 { (*unit).to_owned() } else { format!("{unit}^{power}") })
            .collect();
        rows.push((*name, format!("{value} {}", powers.join(" ")).trim().to_owned(), *prefixes));
    }
    rows.extend(CELSIUS.iter().map(|&symbol| (symbol, "K, less 273.15; only on its own".to_owned(), false)));
    rows
}

/// Symbols of units without prefixes, except those of degrees Celsius.
pub fn unit_symbols() -> impl Iterator<Item = &'static str> {
    SYMBOLS.iter().map(|symbol| symbol.0)
}

/// Every symbol a user can write, for suggestions.
fn spellings() -> Vec<String> {
    let prefixed = SYMBOLS.iter().filter(|s| s.4).flat_map(|s| PREFIXES.iter().map(|p| format!("{}{}", p.0, s.0)));
    SYMBOLS.iter().map(|s| s.0.to_owned()).chain(prefixed).chain(CELSIUS.iter().map(|&c| c.to_owned())).collect()
}

fn suggestion(name: &str) -> Option<String> {
    let folded = name.to_lowercase();
    let spelled_out = match folded.trim_end_matches('s') {
        "meter" | "metre" => Some("m"),
        "second" | "sec" => Some("s"),
        "kelvin" => Some("K"),
        "celsiu" | "c" => Some("degC"),
        "degree" => Some("deg"),
        "newton" => Some("N"),
        "pascal" => Some("Pa"),
        "joule" => Some("J"),
        "watt" => Some("W"),
        "hz" | "khz" => Some("rpm` or `rad/s"),
        "inch" => Some("in"),
        "cc" | "ccm" | "ml" => Some("cm^3"),
        "l" | "liter" | "litre" => Some("dm^3"),
        "tonne" | "to" => Some("t"),
        "micron" => Some("um"),
        // As in W/mK and J/kgK.
        "mk" => Some("(m K)"),
        "kgk" => Some("(kg K)"),
        // What is near to them is something else.
        "kgf" | "lbf" | "degf" => return None,
        _ => None,
    };
    if let Some(unit) = spelled_out {
        return Some(unit.to_owned());
    }
    if let Some(prefix @ ("n" | "u" | "m")) = folded.strip_suffix("sec") {
        return Some(format!("{prefix}s"));
    }
    // Mega and milli differ in case alone: offer the common one of the spellings that agree when case is ignored.
    let agree: Vec<String> = spellings().into_iter().filter(|s| s.to_lowercase() == folded).collect();
    let is_common = |s: &&String| s.starts_with(['M', 'G', 'k']) && !["Mm", "Ms", "Mg"].contains(&s.as_str());
    if let Some(best) = agree.iter().find(is_common).or(agree.iter().find(|s| **s == folded)).or(agree.first()) {
        return Some(best.clone());
    }
    // Prefixes that there are not: the next one.
    let others = [("p", "n"), ("f", "n"), ("T", "G")];
    let near = others.iter().find_map(|(prefix, near)| Some(format!("{near}{}", name.strip_prefix(prefix)?)));
    if let Some(near) = near.filter(|near| symbol(near).is_some()) {
        return Some(near);
    }
    // Nobody measures in gigaseconds or megametres.
    let is_odd =
        |s: &str| s.len() > 1 && s.starts_with(['k', 'M', 'G', 'c', 'd']) && (s.ends_with('s') || &s[1..] == "m");
    spellings()
        .into_iter()
        .map(|s| (strsim::damerau_levenshtein(&s, name), is_odd(&s) && !["km", "cm", "dm"].contains(&s.as_str()), s))
        .filter(|(distance, ..)| *distance <= 1)
        .min()
        .map(|(.., s)| s)
}

/// Reads a unit such as `mm`, `kg/m^3` or `J/(kg K)`.
pub(crate) fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let trimmed = text.trim();
    if CELSIUS.contains(&trimmed) {
        return Ok(Unit { offset: 273.15, dimension: TEMPERATURE, ..Unit::ONE });
    }
    let mut parser = Parser { text, at: 0, depth: 0 };
    let unit = parser.product()?;
    parser.space();
    // Only a bracket ends a product before the text does.
    if parser.at < text.len() {
        return Err(parser.error(parser.at, parser.at + 1, "a closing bracket has no opening one", None));
    }
    Ok(unit)
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: u8,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn space(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn take(&mut self, accepted: impl Fn(char) -> bool) -> String {
        let taken: String = self.rest().chars().take_while(|&c| accepted(c)).collect();
        self.at += taken.len();
        taken
    }

    #[cfg_attr(test, track_caller)]
    fn error(&self, start: usize, end: usize, message: impl Into<String>, help: Option<String>) -> UnitError {
        #[cfg(test)]
        crate::fault::sites::note();
        UnitError { start, end: end.max(start), message: message.into(), help }
    }

    fn product(&mut self) -> Result<Unit, UnitError> {
        self.space();
        let start = self.at;
        let mut total = if self.peek() == Some('/') { Unit::ONE } else { self.power()? };
        let mut divided = false;
        loop {
            self.space();
            let divide = match self.peek() {
                None | Some(')') => return Ok(total),
                Some('/') => true,
                Some('*' | '·' | '⋅') => false,
                Some(_) if divided => {
                    let help = "put the denominator in brackets: J/(kg K)".to_owned();
                    return Err(self.error(start, self.text.len(), "a product after `/` is ambiguous", Some(help)));
                }
                Some(_) => {
                    let factor = self.power()?;
                    total = self.joined(total, factor, 1, start)?;
                    continue;
                }
            };
            self.at += self.peek().map_or(0, char::len_utf8);
            self.space();
            let factor = self.power()?;
            total = self.joined(total, factor, if divide { -1 } else { 1 }, start)?;
            divided = divide;
        }
    }

    fn joined(&self, a: Unit, b: Unit, power: i8, start: usize) -> Result<Unit, UnitError> {
        let dimension = a.dimension.combine(b.dimension, power);
        match dimension {
            Some(dimension) => Ok(Unit {
                factor: a.factor * b.factor.powi(i32::from(power)),
                exponent: a.exponent.saturating_add(b.exponent.saturating_mul(i32::from(power))),
                offset: 0.0,
                dimension,
            }),
            None => Err(self.error(start, self.at, "powers too large for a unit", None)),
        }
    }

    fn power(&mut self) -> Result<Unit, UnitError> {
        let start = self.at;
        let base = self.atom()?;
        let exponent_start = self.at;
        let digits = match self.peek() {
            Some(raised @ ('²' | '³')) => {
                self.at += raised.len_utf8();
                if raised == '²' { "2".to_owned() } else { "3".to_owned() }
            }
            Some('^') => {
                self.at += 1;
                let sign = self.take(|c| matches!(c, '-' | '+'));
                sign + &self.take(|c| c.is_ascii_digit())
            }
            Some('0'..='9') => self.take(|c| c.is_ascii_digit()),
            _ => return Ok(base),
        };
        match digits.parse::<i8>() {
            Ok(power) if (-9..=9).contains(&power) => self.joined(Unit::ONE, base, power, start),
            _ => Err(self.error(exponent_start, self.at, "the power of a unit is a whole number from -9 to 9", None)),
        }
    }

    fn atom(&mut self) -> Result<Unit, UnitError> {
        let start = self.at;
        if self.peek() == Some('(') {
            if self.depth >= 8 {
                return Err(self.error(start, start + 1, "too many brackets in a unit", None));
            }
            self.depth += 1;
            self.at += 1;
            let inner = self.product()?;
            self.depth -= 1;
            if self.peek() != Some(')') {
                return Err(self.error(start, self.text.len(), "the bracket is not closed", None));
            }
            self.at += 1;
            return Ok(inner);
        }
        if self.peek() == Some('1') && !self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()) {
            self.at += 1;
            return Ok(Unit::ONE);
        }
        let name = self.take(|c| c.is_alphabetic() || matches!(c, '°' | '%' | 'µ'));
        if let Some(unit) = symbol(&name) {
            return Ok(unit);
        }
        let (message, help) = if CELSIUS.contains(&name.as_str()) {
            ("degrees Celsius cannot be part of a product".to_owned(), Some("write K".to_owned()))
        } else if name.is_empty() {
            ("a unit is missing here".to_owned(), None)
        } else {
            (format!("unknown unit `{name}`"), suggestion(&name).map(|s| format!("did you mean `{s}`?")))
        };
        let end = if name.is_empty() { self.text.len() } else { self.at };
        Err(self.error(start, end, message, help))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn si(text: &str) -> (f64, Dimension) {
        let unit = parse_unit(text).unwrap();
        (unit.factor * 10f64.powi(unit.exponent), unit.dimension)
    }

    #[test]
    fn products_quotients_and_powers_have_the_dimension_of_the_formula() {
        assert_eq!(si("kg/m^3"), (1.0, Dimension::new(-3, 1, 0, 0)));
        assert_eq!(si("g/cm³").1, Dimension::new(-3, 1, 0, 0));
        assert!((si("g/cm3").0 - 1000.0).abs() < 1e-9);
        assert_eq!(si("J/(kg K)"), (1.0, Dimension::new(2, 0, -2, -1)));
        assert_eq!(si("J/kg/K"), si("J/(kg*K)"));
        assert_eq!(si("m s^-1"), si("m/s"));
        assert_eq!(si("/s"), si("1/s"));
        assert_eq!(si("N/mm^2").0, 1e6);
        assert_eq!(si("W/(m K)").1, Dimension::new(1, 1, -3, -1));
    }

    #[test]
    fn symbols_that_look_like_a_prefix_and_a_unit_keep_their_own_meaning() {
        assert_eq!(si("min"), (60.0, TIME));
        assert_eq!(si("ft").0, 0.3048);
        assert_eq!(si("mm").0, 1e-3);
        assert_eq!(si("mrad"), (1e-3, NUMBER));
        assert_eq!(si("um"), si("µm"));
        assert!((si("rpm").0 - 0.104_719_755_1).abs() < 1e-9);
    }

    #[test]
    fn faults_are_located_and_helped() {
        let error = parse_unit("kg/mmm^3").unwrap_err();
        assert_eq!((error.start, error.end, error.message.as_str()), (3, 6, "unknown unit `mmm`"));
        assert_eq!(parse_unit("mpa").unwrap_err().help.unwrap(), "did you mean `MPa`?");
        let meant = |unit: &str| parse_unit(unit).unwrap_err().help.unwrap();
        for (unit, words) in [("ps", "`ns`"), ("fs", "`ns`"), ("TPa", "`GPa`"), ("pm", "`nm`"), ("xs", "`ms`")] {
            assert_eq!(meant(unit), format!("did you mean {words}?"), "{unit}");
        }
        assert_eq!(parse_unit("MM").unwrap_err().help.unwrap(), "did you mean `mm`?");
        assert_eq!(parse_unit("g/cc").unwrap_err().help.unwrap(), "did you mean `cm^3`?");
        assert_eq!(parse_unit("tonnes/mm^3").unwrap_err().help.unwrap(), "did you mean `t`?");
        assert!(parse_unit("J/kg K").unwrap_err().help.unwrap().contains("J/(kg K)"));
        assert!(parse_unit("J/(kg degC)").unwrap_err().help.unwrap().contains('K'));
        for bad in [
            "m^99",
            "m^",
            "(m",
            "m)",
            "m//s",
            "5m",
            "",
            "^",
            "((((((((((m",
            "m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9 m^9",
        ] {
            assert!(parse_unit(bad).is_err(), "{bad}");
        }
    }
}
