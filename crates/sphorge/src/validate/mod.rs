//! Runs cases with known answers and sets our numbers beside them.
//!
//! A [`Case`] is a shipped deck, the variants of it to run (spacings, settings), and a judgement: comparisons with exact,
//! published and measured numbers, each with a tolerance and its reason where there is one, and convergence studies. Cases
//! are listed in [`CASES`]; a new one is a file in `cases/` and a line of that table.
//!
//! [`validate`] writes into its folder `report.html` (one page, pictures inside), `report.md` and `report.json`, after every case, and
//! every run in `<case>/<variant>/`.

mod case;
mod cases;
mod earlier;
mod effort;
mod error;
mod execute;
mod finding;
mod findings;
mod folder;
mod html;
mod markdown;
mod number;
mod options;
mod picture;
mod pictures;
mod report;
mod runs;
mod study;
mod text;
mod variant;
mod watcher;

pub use case::{Case, ExpectedWarning};
pub use cases::CASES;
pub use effort::Effort;
pub use error::ValidateError;
pub use finding::{Bounds, Finding, Reference, ReferenceKind, Tolerance, Unit, Verdict};
pub use findings::NumberTable;
pub use options::ValidateOptions;
pub use report::{CaseReport, PictureRecord, Report, RunEntry};
pub use study::{Demand, Study, StudyPoint};
pub use variant::Variant;
pub use watcher::Watcher;

use execute::run_variants;
use findings::Findings;
use folder::Folder;
use std::{sync::atomic::AtomicBool, time::Instant};

/// Runs the cases and judges them. A case that misses a tolerance, or a run that fails, is no error: the report says so.
///
/// # Errors
/// [`ValidateError`]: an unknown case, a folder that cannot be used, no threads, a stop by the user.
pub fn validate(
    options: &ValidateOptions,
    stop: &AtomicBool,
    watcher: &mut dyn Watcher,
) -> Result<Report, ValidateError> {
    let cases = select(&options.cases)?;
    let folder = Folder::claim(&options.directory, options.resume)?;
    let start = Instant::now();
    let mut report = Report::new(options.effort, cases.len());
    for (k, case) in cases.iter().enumerate() {
        watcher.case_started(case, k + 1, cases.len());
        let runs = run_variants(case, options, &folder, stop, watcher)?;
        let mut findings = Findings::default();
        (case.judge)(&runs, &mut findings);
        let pictures = pictures::draw(case, &runs, &folder);
        let of_case = CaseReport::new(case, &runs, findings, pictures, &folder);
        watcher.case_judged(&of_case);
        report.add(of_case, start.elapsed().as_secs_f64());
        if options.resume {
            report.seconds = report.seconds_of_runs();
        }
        // What is known so far outlives a stop.
        folder.write(&report)?;
    }
    Ok(report)
}

/// The cases of these names, in the order of the table; all if none is named.
fn select(names: &[String]) -> Result<Vec<&'static Case>, ValidateError> {
    let known: Vec<_> = CASES.iter().map(|case| case.name).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(ValidateError::unknown(name, &known));
    }
    Ok(CASES.iter().filter(|case| names.is_empty() || names.iter().any(|name| name == case.name)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn cases_are_chosen_by_name_and_an_unknown_one_names_the_nearest() {
        let names = |names: &[&str]| select(&names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>());
        assert_eq!(names(&[]).unwrap().len(), CASES.len());
        let chosen: Vec<_> = names(&["rotating-rod", "plate-impact"]).unwrap().iter().map(|c| c.name).collect();
        assert_eq!(chosen, ["plate-impact", "rotating-rod"]);
        let ValidateError::UnknownCase { nearest, .. } = names(&["plate-inpact"]).unwrap_err() else { panic!() };
        assert_eq!(nearest.as_deref(), Some("plate-impact"));
    }

    #[test]
    fn every_case_has_a_deck_that_reads_with_every_variant() {
        let mut seen = BTreeSet::new();
        for case in CASES {
            assert!(seen.insert(case.name), "{} twice", case.name);
            let deck = crate::decks::find(case.deck).unwrap_or_else(|| panic!("{}: no deck {}", case.name, case.deck));
            for effort in [Effort::Quick, Effort::Full] {
                let variants = (case.variants)(effort);
                let labels: BTreeSet<_> = variants.iter().map(|v| folder::slug(&v.label)).collect();
                assert_eq!(labels.len(), variants.len(), "{}: labels collide", case.name);
                for variant in &variants {
                    let setup = crate::deck::load_text(deck.name, deck.text, &variant.overrides);
                    assert!(setup.is_ok(), "{} {}: {}", case.name, variant.label, setup.unwrap_err());
                }
            }
        }
    }
}
