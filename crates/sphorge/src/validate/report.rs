//! The outcome of a validation.

use super::{
    Case, Effort,
    finding::{Finding, Verdict},
    findings::{Findings, NumberTable},
    folder::Folder,
    runs::{Run, Runs},
    study::Study,
};
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
    fn new(run: &Run, folder: &Folder) -> Self {
        let summary = run.summary();
        Self {
            label: run.variant.label.clone(),
            overrides: run.variant.overrides.clone(),
            folder: folder.relative(&run.directory),
            failure: run.outcome.as_ref().err().cloned(),
            may_fail: run.variant.may_fail,
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
    /// Failed if a run failed or a number missed what is asked; shown if nothing is asked.
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
        let runs: Vec<_> = runs.0.iter().map(|run| RunEntry::new(run, folder)).collect();
        let Findings { findings, tables, studies, notes } = findings;
        let verdicts =
            || findings.iter().map(|f| f.verdict).chain(studies.iter().map(|s| s.verdict)).collect::<Vec<_>>();
        let broken = |run: &RunEntry| run.failure.is_some() && !run.may_fail;
        let verdict = if runs.iter().any(broken) || verdicts().contains(&Verdict::Failed) {
            Verdict::Failed
        } else if verdicts().contains(&Verdict::Passed) {
            Verdict::Passed
        } else {
            Verdict::Shown
        };
        let Case { name, title, about, deck, .. } = *case;
        Self { name, title, about, deck, verdict, runs, tables, findings, studies, notes, pictures }
    }

    /// Number of checks that passed and number of all.
    pub fn checks(&self) -> (usize, usize) {
        let verdicts = self.findings.iter().map(|f| f.verdict).chain(self.studies.iter().map(|s| s.verdict));
        let asked: Vec<_> = verdicts.filter(|verdict| *verdict != Verdict::Shown).collect();
        (asked.iter().filter(|verdict| **verdict == Verdict::Passed).count(), asked.len())
    }
}

/// Outcome of a validation. `Display` is for a terminal, [`Report::markdown`] for a browser.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Version of the program.
    pub version: &'static str,
    /// How much was computed.
    pub effort: Effort,
    /// Whether no case failed.
    pub passed: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// The cases.
    pub cases: Vec<CaseReport>,
}

impl Report {
    pub(super) fn new(effort: Effort, cases: Vec<CaseReport>, seconds: f64) -> Self {
        let passed = cases.iter().all(|case| case.verdict != Verdict::Failed);
        Self { version: env!("CARGO_PKG_VERSION"), effort, passed, seconds, cases }
    }
}
