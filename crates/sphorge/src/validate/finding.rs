//! One of our numbers beside those of others.

use super::number::significant;
use serde::Serialize;

/// Unit a quantity is shown in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Unit {
    /// As written.
    pub symbol: &'static str,
    /// Its size in SI.
    pub size: f64,
}

impl Unit {
    /// Pure number.
    pub const NONE: Self = Self { symbol: "", size: 1.0 };
    /// Per cent of a pure number.
    pub const PERCENT: Self = Self { symbol: "%", size: 1e-2 };
    /// Metres per second.
    pub const METRE_PER_SECOND: Self = Self { symbol: "m/s", size: 1.0 };
    /// Gigapascals.
    pub const GIGAPASCAL: Self = Self { symbol: "GPa", size: 1e9 };
    /// Megapascals.
    pub const MEGAPASCAL: Self = Self { symbol: "MPa", size: 1e6 };
    /// Centimetres.
    pub const CENTIMETRE: Self = Self { symbol: "cm", size: 1e-2 };
    /// Millimetres.
    pub const MILLIMETRE: Self = Self { symbol: "mm", size: 1e-3 };
    /// Kelvins.
    pub const KELVIN: Self = Self { symbol: "K", size: 1.0 };
    /// Seconds.
    pub const SECOND: Self = Self { symbol: "s", size: 1.0 };
    /// Milliseconds.
    pub const MILLISECOND: Self = Self { symbol: "ms", size: 1e-3 };
    /// Microseconds.
    pub const MICROSECOND: Self = Self { symbol: "us", size: 1e-6 };
    /// Kilojoules per kilogram.
    pub const KILOJOULE_PER_KILOGRAM: Self = Self { symbol: "kJ/kg", size: 1e3 };
    /// Kilojoules per square metre.
    pub const KILOJOULE_PER_SQUARE_METRE: Self = Self { symbol: "kJ/m^2", size: 1e3 };
    /// Kilograms per cubic metre.
    pub const KILOGRAM_PER_CUBIC_METRE: Self = Self { symbol: "kg/m^3", size: 1.0 };

    /// An SI value in this unit, five digits.
    pub fn show(self, value: f64) -> String {
        format!("{} {}", significant(value / self.size), self.symbol).trim_end().to_owned()
    }
}

/// Where a reference comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReferenceKind {
    /// Theory.
    Exact,
    /// Another code.
    Published,
    /// The finite elements of `reference/finite-elements`, written for these checks alone.
    FiniteElements,
    /// The grid at rest of `reference/eulerian`, written for these checks alone.
    Eulerian,
    /// Measured.
    Experiment,
    /// Another run of ours.
    OtherRun,
}

impl ReferenceKind {
    /// Word for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Published => "published",
            Self::FiniteElements => "our elements",
            Self::Eulerian => "our grid",
            Self::Experiment => "experiment",
            Self::OtherRun => "ours",
        }
    }
}

/// A number of others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Whose.
    pub source: String,
    /// SI value.
    pub value: f64,
    /// Theory, code or experiment.
    pub kind: ReferenceKind,
}

/// What passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bounds {
    /// This share of the first reference, either way.
    Relative(f64),
    /// From the smallest to the largest reference.
    InRange,
    /// A size of at most this, SI.
    AtMost(f64),
    /// A value of at least this, SI.
    AtLeast(f64),
}

/// What passes, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tolerance {
    /// The bounds.
    pub bounds: Bounds,
    /// Why these.
    pub reason: String,
    /// Where they are known to be missed: wider ones, outside of which the miss has grown.
    pub kept: Option<Bounds>,
}

/// Outcome of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Inside the tolerance.
    Passed,
    /// Outside, as is known, and no farther than it was.
    Missed,
    /// Outside, or no value.
    Failed,
    /// Shown; nothing is asked of it.
    Shown,
}

impl Verdict {
    /// Word for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Missed => "missed",
            Self::Failed => "FAILED",
            Self::Shown => "shown",
        }
    }
}

/// A number of ours, what others say, and what is asked of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What it is.
    pub quantity: String,
    /// Label of the run it comes from.
    pub run: String,
    /// Unit it is shown in.
    pub unit: Unit,
    /// Our number, SI; none if the run did not yield it.
    pub value: Option<f64>,
    /// Others' numbers.
    pub references: Vec<Reference>,
    /// What passes; none if the number is only shown.
    pub tolerance: Option<Tolerance>,
    /// Outcome, set when the case is judged.
    pub verdict: Verdict,
}

impl Finding {
    /// A number that is shown; SI value.
    pub fn new(quantity: impl Into<String>, unit: Unit, run: &str, value: Option<f64>) -> Self {
        Self {
            quantity: quantity.into(),
            run: run.to_owned(),
            unit,
            value: value.filter(|v| v.is_finite()),
            references: Vec::new(),
            tolerance: None,
            verdict: Verdict::Shown,
        }
    }

    /// Adds a number of others, SI.
    pub fn beside(mut self, kind: ReferenceKind, source: &str, value: f64) -> Self {
        self.references.push(Reference { source: source.to_owned(), value, kind });
        self
    }

    /// Adds an exact value, SI.
    pub fn exact(self, source: &str, value: f64) -> Self {
        self.beside(ReferenceKind::Exact, source, value)
    }

    /// Asks for these bounds, for this reason.
    pub fn must(mut self, bounds: Bounds, reason: &str) -> Self {
        self.tolerance = Some(Tolerance { bounds, reason: reason.to_owned(), kept: None });
        self
    }

    /// Says of what is asked whether it is known to be missed, and outside of which bounds that is worse than it was.
    pub fn missed_within(mut self, kept: Option<Bounds>) -> Self {
        if let Some(tolerance) = &mut self.tolerance {
            tolerance.kept = kept;
        }
        self
    }

    /// Relative deviation from a reference; none without a value or from zero.
    pub fn deviation(&self, reference: &Reference) -> Option<f64> {
        self.value.filter(|_| reference.value != 0.0).map(|value| (value - reference.value) / reference.value.abs())
    }

    /// Compares the value with the tolerance.
    pub(super) fn judge(&mut self) {
        let Some(tolerance) = &self.tolerance else { return };
        let values = || self.references.iter().map(|r| r.value);
        let inside = |bounds: Bounds| {
            self.value.is_some_and(|value| match bounds {
                Bounds::Relative(share) => {
                    values().next().is_some_and(|reference| (value - reference).abs() <= share * reference.abs())
                }
                Bounds::InRange => values().any(|r| r <= value) && values().any(|r| value <= r),
                Bounds::AtMost(limit) => value.abs() <= limit,
                Bounds::AtLeast(limit) => value >= limit,
            })
        };
        self.verdict = match tolerance.kept {
            _ if inside(tolerance.bounds) => Verdict::Passed,
            Some(kept) if inside(kept) => Verdict::Missed,
            _ => Verdict::Failed,
        };
    }

    /// The tolerance in words; empty if there is none.
    pub fn demand(&self) -> String {
        let Some(tolerance) = &self.tolerance else { return String::new() };
        let asked = self.bounds_in_words(tolerance.bounds);
        match tolerance.kept {
            Some(kept) => format!("{asked}, if missed {}", self.bounds_in_words(kept)),
            None => asked,
        }
    }

    fn bounds_in_words(&self, bounds: Bounds) -> String {
        let values = || self.references.iter().map(|r| r.value);
        match bounds {
            Bounds::Relative(share) => format!("within {} %", significant(100.0 * share)),
            Bounds::InRange => format!(
                "within {} to {}",
                significant(values().fold(f64::INFINITY, f64::min) / self.unit.size),
                self.unit.show(values().fold(f64::NEG_INFINITY, f64::max)),
            ),
            Bounds::AtMost(limit) => format!("at most {}", self.unit.show(limit)),
            Bounds::AtLeast(limit) => format!("at least {}", self.unit.show(limit)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(finding: Finding) -> Verdict {
        let mut finding = finding;
        finding.judge();
        finding.verdict
    }

    fn of(value: f64) -> Finding {
        Finding::new("height", Unit::CENTIMETRE, "run", Some(value))
    }

    #[test]
    fn a_relative_bound_holds_against_the_first_reference_on_both_sides() {
        for (value, verdict) in
            [(101.0, Verdict::Passed), (99.0, Verdict::Passed), (101.1, Verdict::Failed), (98.9, Verdict::Failed)]
        {
            let finding = of(value).exact("theory", 100.0).beside(ReferenceKind::Published, "code", 5.0);
            assert_eq!(judged(finding.must(Bounds::Relative(0.01), "")), verdict, "{value}");
        }
        assert_eq!(judged(of(-99.5).exact("theory", -100.0).must(Bounds::Relative(0.01), "")), Verdict::Passed);
    }

    #[test]
    fn a_range_is_that_of_all_references() {
        let finding = |value| {
            let beside = |f: Finding, v| f.beside(ReferenceKind::Published, "code", v);
            beside(beside(beside(of(value), 0.0209), 0.0202), 0.0218).must(Bounds::InRange, "")
        };
        assert_eq!(judged(finding(0.0202)), Verdict::Passed);
        assert_eq!(judged(finding(0.0215)), Verdict::Passed);
        assert_eq!(judged(finding(0.0219)), Verdict::Failed);
        assert_eq!(judged(finding(0.0201)), Verdict::Failed);
        assert_eq!(finding(0.0).demand(), "within 2.02 to 2.18 cm");
    }

    #[test]
    fn no_value_fails_what_is_asked_and_a_free_number_is_shown() {
        let none = Finding::new("height", Unit::NONE, "run", None).must(Bounds::AtMost(1.0), "");
        assert_eq!(judged(none), Verdict::Failed);
        let nonsense = Finding::new("height", Unit::NONE, "run", Some(f64::NAN)).must(Bounds::AtMost(1.0), "");
        assert_eq!(judged(nonsense), Verdict::Failed);
        assert_eq!(judged(of(-2.0).must(Bounds::AtMost(1.0), "")), Verdict::Failed);
        assert_eq!(judged(of(2.0).must(Bounds::AtLeast(1.0), "")), Verdict::Passed);
        assert_eq!(judged(of(-2.0).must(Bounds::AtLeast(1.0), "")), Verdict::Failed);
        assert_eq!(judged(of(1.0)), Verdict::Shown);
        // What is known to be missed passes once it is not, and fails once it is missed by more.
        let known = |value: f64| of(value).must(Bounds::AtMost(1.0), "").missed_within(Some(Bounds::AtMost(2.0)));
        let verdicts = [(0.5, Verdict::Passed), (-1.5, Verdict::Missed), (2.5, Verdict::Failed)];
        verdicts.into_iter().for_each(|(value, verdict)| assert_eq!(judged(known(value)), verdict, "{value}"));
        assert_eq!(judged(known(f64::NAN)), Verdict::Failed);
        assert!(known(1.5).demand().contains(", if missed at most 2"), "{}", known(1.5).demand());
    }

    #[test]
    fn deviations_are_signed_shares_of_the_size_of_the_reference() {
        let finding = of(-198.0).exact("theory", -200.0);
        assert!((finding.deviation(&finding.references[0]).unwrap() - 0.01).abs() < 1e-15);
    }
}
