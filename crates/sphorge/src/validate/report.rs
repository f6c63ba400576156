//! The outcome of a validation.

use super::{
    Case, Effort,
    finding::{Finding, Verdict},
    findings::{Findings, NumberTable},
    folder::Folder,
    runs::{Run, Runs},
    study::Study,
};
use crate::machine::Machine;
use serde::Serialize;

/// A run of a case, for the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunEntry {
    /// Label of the variant.
    pub label: String,
    /// What it changes in the deck.
    pub overrides: Vec<(String, String)>,
    /// Folder, relative to the report.
    pub folder: String,
    /// Why it failed, if it did.
    pub failure: Option<String>,
    /// Whether a failure is a result like any other.
    pub may_fail: bool,
    /// What its checks found broken, by name.
    pub warnings: Vec<String>,
    /// Of these, what the case does not expect, with numbers and places.
    pub unexpected_warnings: Vec<String>,
    /// Number of particles.
    pub particles: Option<u64>,
    /// Steps done.
    pub steps: Option<u64>,
    /// Wall-clock seconds.
    pub seconds: Option<f64>,
    /// Largest relative drift of the energy ledger.
    pub energy_drift: Option<f64>,
    /// Largest relative drift of the linear momentum.
    pub momentum_drift: Option<f64>,
}

impl RunEntry {
    fn new(case: &Case, run: &Run, folder: &Folder) -> Self {
        let summary = run.summary();
        let warnings = summary.map_or(&[][..], |summary| &summary.warnings);
        let label = &run.variant.label;
        let is_expected = |name: &str| case.expected_warnings.iter().any(|expected| expected.covers(name, label));
        Self {
            label: run.variant.label.clone(),
            overrides: run.variant.overrides.clone(),
            folder: folder.relative(&run.directory),
            failure: run.outcome.as_ref().err().cloned(),
            may_fail: run.variant.may_fail,
            warnings: warnings.iter().map(|warning| warning.name.clone()).collect(),
            unexpected_warnings: warnings
                .iter()
                .filter(|warning| !is_expected(&warning.name))
                .map(ToString::to_string)
                .collect(),
            particles: summary.map(|s| s.particles),
            steps: summary.map(|s| s.steps),
            seconds: summary.map(|s| s.wall_seconds),
            energy_drift: summary.map(|s| s.energy.largest_relative_drift),
            momentum_drift: summary.map(|s| s.largest_momentum_drift),
        }
    }
}

/// A picture of the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureRecord {
    /// What it shows.
    pub caption: String,
    /// File, relative to the report; none if it could not be drawn.
    pub file: Option<String>,
    /// Why it could not be drawn.
    pub trouble: Option<String>,
}

/// Outcome of a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseReport {
    /// Name.
    pub name: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// Its deck.
    pub deck: &'static str,
    /// Failed if a run failed or warned of something the case does not expect, or a number missed what is asked; shown if nothing is asked.
    pub verdict: Verdict,
    /// The runs.
    pub runs: Vec<RunEntry>,
    /// Runs beside each other.
    pub tables: Vec<NumberTable>,
    /// Numbers.
    pub findings: Vec<Finding>,
    /// Numbers against spacing.
    pub studies: Vec<Study>,
    /// What to know when reading them.
    pub notes: Vec<String>,
    /// Warnings that the case expects and that came, with the reasons for living with them.
    pub expected_warnings: Vec<(&'static str, &'static str)>,
    /// Pictures.
    pub pictures: Vec<PictureRecord>,
}

impl CaseReport {
    pub(super) fn new(
        case: &Case,
        runs: &Runs,
        findings: Findings,
        pictures: Vec<PictureRecord>,
        folder: &Folder,
    ) -> Self {
        let runs: Vec<_> = runs.0.iter().map(|run| RunEntry::new(case, run, folder)).collect();
        let Findings { findings, tables, studies, notes } = findings;
        let verdicts =
            || findings.iter().map(|f| f.verdict).chain(studies.iter().map(|s| s.verdict)).collect::<Vec<_>>();
        let broken = |run: &RunEntry| !run.may_fail && (run.failure.is_some() || !run.unexpected_warnings.is_empty());
        let verdict = if runs.iter().any(broken) || verdicts().contains(&Verdict::Failed) {
            Verdict::Failed
        } else if verdicts().iter().any(|verdict| *verdict != Verdict::Shown) {
            Verdict::Passed
        } else {
            Verdict::Shown
        };
        let Case { name, title, about, deck, .. } = *case;
        let came = |name: &str| runs.iter().any(|run| run.warnings.iter().any(|warning| warning == name));
        let expected_warnings =
            case.expected_warnings.iter().filter(|w| came(w.name)).map(|w| (w.name, w.reason)).collect();
        Self { name, title, about, deck, verdict, runs, tables, findings, studies, notes, expected_warnings, pictures }
    }

    /// Number of checks that passed and number of all.
    pub fn checks(&self) -> (usize, usize) {
        let of = |verdict: Verdict| self.verdicts().filter(|of| *of == verdict).count();
        (of(Verdict::Passed), self.verdicts().count() - of(Verdict::Shown))
    }

    /// Number of checks that are known to miss their tolerance and do.
    pub fn missed(&self) -> usize {
        self.verdicts().filter(|verdict| *verdict == Verdict::Missed).count()
    }

    /// The same in words, to follow those of [`Self::checks`]; empty if there are none.
    pub fn missed_in_words(&self) -> String {
        match self.missed() {
            0 => String::new(),
            missed => format!(", {missed} missed"),
        }
    }

    fn verdicts(&self) -> impl Iterator<Item = Verdict> {
        self.findings.iter().map(|f| f.verdict).chain(self.studies.iter().map(|s| s.verdict))
    }
}

/// Outcome of a validation. `Display` is for a terminal, [`Report::markdown`] for an editor, [`Report::html`] for a browser.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Version of the program.
    pub version: &'static str,
    /// How much was computed.
    pub effort: Effort,
    /// Number of cases requested; more than there are here while others are computed, or if the user stopped the validation.
    pub asked: usize,
    /// Whether all were computed and no case failed.
    pub passed: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// The machine it was computed on.
    pub machine: Machine,
    /// The cases.
    pub cases: Vec<CaseReport>,
}

impl Report {
    /// For so many cases, none of which is computed yet.
    pub(super) fn new(effort: Effort, asked: usize) -> Self {
        let (version, machine) = (env!("CARGO_PKG_VERSION"), Machine::here());
        Self { version, effort, asked, passed: false, seconds: 0.0, machine, cases: Vec::with_capacity(asked) }
    }

    /// Seconds of all runs, also of those that an earlier program of this validation did.
    pub(super) fn seconds_of_runs(&self) -> f64 {
        self.cases.iter().flat_map(|case| &case.runs).filter_map(|run| run.seconds).sum()
    }

    /// A sentence on the checks that are known to miss their tolerance; empty if there are none.
    pub(super) fn known_misses(&self) -> String {
        match self.cases.iter().map(CaseReport::missed).sum() {
            0 => String::new(),
            1 => "; one check is known to miss its tolerance and has not got worse".to_owned(),
            missed => format!("; {missed} checks are known to miss their tolerances and have not got worse"),
        }
    }

    /// Adds a case; `seconds` have gone since the start.
    pub(super) fn add(&mut self, case: CaseReport, seconds: f64) {
        self.cases.push(case);
        self.seconds = seconds;
        self.passed = self.cases.len() == self.asked && self.cases.iter().all(|case| case.verdict != Verdict::Failed);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bounds, CASES, ExpectedWarning, Unit, Variant, runs::Finished};
    use super::*;
    use crate::output::{HistoryTable, Summary, testing};

    /// The report of a case whose one run has warned of two things.
    fn report(expected_warnings: &'static [ExpectedWarning], may_fail: bool) -> CaseReport {
        report_of(expected_warnings, may_fail, Findings::default())
    }

    fn report_of(expected_warnings: &'static [ExpectedWarning], may_fail: bool, findings: Findings) -> CaseReport {
        let summary =
            Summary { warnings: vec![testing::warning("pairing"), testing::warning("hot")], ..testing::summary(1.0) };
        let history = HistoryTable { columns: Vec::new(), values: Vec::new(), words: Default::default() };
        let variant = Variant { may_fail, ..Variant::new("run") };
        let outcome = Ok(Finished { summary, history });
        let runs = Runs(vec![Run { variant, spacing: 1.0, directory: "x/case/run".into(), outcome }]);
        let case = Case { expected_warnings, ..CASES[0] };
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::claim(&place.path().join("report"), false).unwrap();
        CaseReport::new(&case, &runs, findings, Vec::new(), &folder)
    }

    #[test]
    fn a_warning_that_is_not_expected_fails_the_case() {
        const EXPECTED: &[ExpectedWarning] = &[ExpectedWarning::new("pairing", "known")];
        let found = report(EXPECTED, false);
        assert_eq!(found.verdict, Verdict::Failed);
        assert_eq!(found.runs[0].warnings, ["pairing", "hot"]);
        assert!(
            found.runs[0].unexpected_warnings.len() == 1 && found.runs[0].unexpected_warnings[0].starts_with("hot: ")
        );
        assert_eq!(found.expected_warnings, [("pairing", "known")]);
        let mut whole = Report::new(Effort::Quick, 1);
        whole.add(found.clone(), 1.0);
        for text in [found.to_string(), whole.markdown()] {
            assert!(text.contains("hot: a number is 2, limit 1") && text.contains("known"), "{text}");
        }
        // Unless the run may break down altogether.
        assert_eq!(report(EXPECTED, true).verdict, Verdict::Shown);
        // Of another run it is not.
        const OF_ANOTHER: &[ExpectedWarning] = &[
            ExpectedWarning { runs: &["walk", "runs"], ..ExpectedWarning::new("pairing", "known") },
            ExpectedWarning { runs: &["ru"], ..ExpectedWarning::new("hot", "known") },
        ];
        let found = report(OF_ANOTHER, false);
        assert!(found.verdict == Verdict::Failed && found.runs[0].unexpected_warnings[0].starts_with("pairing: "));
        assert_eq!(found.runs[0].unexpected_warnings.len(), 1);
    }

    #[test]
    fn a_warning_that_is_expected_is_no_failure() {
        const EXPECTED: &[ExpectedWarning] = &[
            ExpectedWarning::new("pairing", "known"),
            ExpectedWarning::new("hot", "known, too"),
            ExpectedWarning::new("cold", "at other resolutions"),
        ];
        let found = report(EXPECTED, false);
        assert_eq!((found.verdict, found.runs[0].unexpected_warnings.len()), (Verdict::Shown, 0));
        assert_eq!(found.expected_warnings.len(), 2);

        // A validation has not passed before all its cases are computed.
        let mut whole = Report::new(Effort::Quick, 2);
        whole.add(found.clone(), 1.0);
        assert!(!whole.passed && whole.markdown().contains("Not finished: 1 of 2 cases"));
        whole.add(found, 2.0);
        assert!(whole.passed && whole.markdown().contains("All cases passed.**"));
    }

    #[test]
    fn what_is_known_to_miss_is_told_and_fails_nothing() {
        let of = |values: &[f64]| {
            let mut findings = Findings::default();
            for value in values {
                let asked = Finding::new("length", Unit::NONE, "run", Some(*value)).must(Bounds::AtMost(1.0), "");
                findings.add(asked.missed_within(Some(Bounds::AtMost(2.0))));
            }
            report_of(&[], true, findings)
        };
        assert_eq!(of(&[1.5, 2.5]).verdict, Verdict::Failed);
        let case = of(&[0.5, 1.5]);
        assert_eq!((case.verdict, case.checks(), case.missed()), (Verdict::Passed, (1, 2), 1));
        let mut whole = Report::new(Effort::Quick, 1);
        whole.add(case, 1.0);
        assert!(whole.passed);
        for text in [whole.to_string(), whole.markdown()] {
            for words in ["1 of 2", ", 1 missed", "at most 1, if missed at most 2", "one check is known to miss"] {
                assert!(text.contains(words), "{words}: {text}");
            }
        }
    }
}
