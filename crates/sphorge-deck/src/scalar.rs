//! A single value as written: what it is as a quantity, and what is said of it where it is none.

use super::declare::Read;
use super::expected::Expected;
use super::fault::{Fault, Problems};
use super::material::shown;
use super::quantity::{QuantityKind, parse_quantity};
use super::written::{Content, Literal, Written};
use sphorge_physics::parameter::Bound;
use std::{f64::consts::TAU, ops::Range};

/// Largest magnitude of a quantity in SI units: what follows from it within a step must be a number of single precision, of which frames are made.
const LARGEST: f64 = 1e30;

/// Temperature below which nobody begins with metal, K: one below it, without a unit, is in degrees Celsius.
const COLDEST: f64 = 150.0;

/// Spacing from which on one without a unit may be in millimetres, m.
const LARGE_SPACING: f64 = 0.05;

/// A single value and its place.
pub(crate) struct Scalar {
    pub(crate) literal: Literal,
    pub(crate) span: Range<usize>,
}

/// A quantity of a kind that follows from something else: a constant of a law, a level of a field.
impl Read for Scalar {
    const EXPECTED: &'static Expected = &Expected::Level;
    fn read(written: Written<'_>) -> Option<Self> {
        match written.content() {
            Content::Scalar(literal) => Some(Self { literal, span: written.span() }),
            _ => None,
        }
    }
}

impl Scalar {
    /// A fault at this value: what was expected is the message, what was found the label.
    #[cfg_attr(test, track_caller)]
    pub(crate) fn fault(&self, code: &'static str, expected: impl Into<String>) -> Fault {
        Fault::new(code, expected, self.span.clone(), described(&self.literal))
    }

    /// The value as a quantity, in SI units.
    pub(crate) fn quantity(&self, kind: QuantityKind, problems: &mut Problems) -> Option<f64> {
        let value = match &self.literal {
            Literal::Integer(i) => *i as f64,
            Literal::Number(x) => *x,
            Literal::Text(text) => match parse_quantity(text, kind) {
                Ok(value) => value,
                Err(error) => {
                    // A plain string starts one byte after its quote; anything fancier is marked as a whole.
                    let start = self.span.start + 1;
                    let plain = problems.text().get(start..start + text.len()) == Some(text.as_str());
                    let at = if plain { start + error.at.start..start + error.at.end } else { self.span.clone() };
                    let fault = Fault::new("wrong-quantity", error.message, at, "this");
                    problems.push(match error.help {
                        Some(help) => fault.help(help),
                        None => fault,
                    });
                    return None;
                }
            },
            _ => {
                let fault = self.fault("wrong-type", format!("expected {} {}", kind.article(), kind.name));
                problems.push(fault.help(format!("write it as {}", kind.examples)));
                return None;
            }
        };
        if !value.is_finite() {
            let fault = self.fault("not-finite", format!("expected a finite {}", kind.name));
            problems.push(fault.help(format!("write it as {}", kind.examples)));
            return None;
        }
        if value.abs() > LARGEST {
            let unit = if kind.si_unit.is_empty() { String::new() } else { format!(" {}", kind.si_unit) };
            let fault = self.fault("out-of-range", format!("the {} is too large to compute with", kind.name));
            problems.push(fault.help(format!("the largest magnitude is {LARGEST:e}{unit}")));
            return None;
        }
        if kind == QuantityKind::TEMPERATURE && (0.0..COLDEST).contains(&value) && self.has_no_unit() {
            let note = format!(
                "`{}` is {value} K, since a number without a unit is in SI: write \"{value} degC\" or \"{value} K\"",
                self.with_its_key(problems.text())
            );
            problems.doubt(&self.span, note);
        }
        if kind == QuantityKind::ANGLE && value.abs() > TAU && self.has_no_unit() {
            let note = format!(
                "`{}` is {value} rad, more than a turn, since a number without a unit is in SI: write \"{value} deg\" or \"{value} rad\"",
                self.with_its_key(problems.text())
            );
            problems.doubt(&self.span, note);
        }
        Some(value)
    }

    /// Whether it is a number alone, quoted or not.
    fn has_no_unit(&self) -> bool {
        match &self.literal {
            Literal::Integer(_) | Literal::Number(_) => true,
            Literal::Text(text) => text.trim().parse::<f64>().is_ok(),
            Literal::Boolean(_) | Literal::Date => false,
        }
    }

    /// The value as it stands in the text, with its key where that stands before it.
    fn with_its_key<'t>(&self, text: &'t str) -> &'t str {
        let end = self.span.end.min(text.len());
        let before = text.get(..self.span.start).unwrap_or_default().trim_end();
        let key = before.strip_suffix('=').map(str::trim_end).map(|before| {
            let is_of_key = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
            before.trim_end_matches(is_of_key).len()
        });
        text.get(key.unwrap_or(self.span.start)..end).unwrap_or_default()
    }

    /// The value as a quantity within a bound.
    pub(crate) fn bounded(&self, kind: QuantityKind, bound: Bound, problems: &mut Problems) -> Option<f64> {
        let value = self.quantity(kind, problems)?;
        if bound.allows(value) {
            return Some(value);
        }
        let fault = self.out_of(bound, kind);
        let is_share = bound == Bound::Between(0.0, 1.0) && kind == QuantityKind::NUMBER;
        problems.push(match is_share && value > 1.0 && value <= 100.0 {
            true => fault.help(format!("it is a share, not a percentage: {value} % is {}", shown(value / 100.0, ""))),
            false => fault,
        });
        None
    }

    /// The fault of a value that is out of a bound.
    pub(crate) fn out_of(&self, bound: Bound, kind: QuantityKind) -> Fault {
        let wanted = match bound {
            Bound::Any => "finite".to_owned(),
            Bound::Positive => "above zero".to_owned(),
            Bound::NonNegative if kind == QuantityKind::TEMPERATURE => "absolute zero or above".to_owned(),
            Bound::NonNegative => "zero or above".to_owned(),
            Bound::Between(low, high) => format!("between {low} and {high}"),
        };
        self.fault("out-of-range", format!("the {} must be {wanted}", kind.name))
    }

    /// Notes that a length in metres may be one in millimetres of which the unit was left out.
    pub(crate) fn doubt_metres(&self, length: f64, problems: &mut Problems) {
        if length < LARGE_SPACING || !self.has_no_unit() {
            return;
        }
        let note = format!(
            "`{}` is {length} m, since a number without a unit is in SI, as are those of shapes: write \"{length} mm\" or \"{length} m\"",
            self.with_its_key(problems.text())
        );
        problems.doubt(&self.span, note);
    }
}

fn described(literal: &Literal) -> String {
    match literal {
        Literal::Integer(i) => format!("found the number {i}"),
        Literal::Number(x) => format!("found the number {x}"),
        Literal::Text(text) => format!("found the text \"{text}\""),
        Literal::Boolean(b) => format!("found {b}"),
        Literal::Date => "found a date".to_owned(),
    }
}
