//! `sphorge validate`: the cases with known answers.

use super::run::parse_threads;
use crate::{
    failure::{Ending, Failure, Outcome},
    signals::StopFlag,
    table, terminal,
};
use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use sphorge::run::Observer;
use sphorge::validate::{CASES, Case, CaseReport, Effort, ValidateError, ValidateOptions, Variant, Watcher, validate};
use std::path::PathBuf;

/// Arguments of `validate`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge validate --quick
  sphorge validate taylor-plate plate-impact
  sphorge validate --resume
  sphorge validate --list

Every computed number is printed with the published or exact one, with the
deviation, the tolerance and a verdict: passed, failed, missed (known to be
outside its tolerance, and no worse than known) or shown (no tolerance). The
folder holds report.html (a single page), report.md, report.json and every
run. The exit code is 1 if a check failed.")]
pub(crate) struct ValidateArguments {
    /// Cases to run [default: all]
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Only list the cases
    #[arg(long)]
    list: bool,
    /// Low resolution: about four minutes on two cores; full resolution takes hours
    #[arg(long)]
    quick: bool,
    /// Folder for the report and the runs
    #[arg(short, long, value_name = "DIR", default_value = "out/validate")]
    output: PathBuf,
    /// Continue a validation that was stopped, and keep its finished runs
    #[arg(long)]
    resume: bool,
    /// Number of threads [default: all processors]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
}

pub(crate) fn execute(arguments: ValidateArguments) -> Ending {
    if arguments.list {
        let rows = CASES.iter().map(|case| vec![case.name.to_owned(), case.title.to_owned()]);
        terminal::print(&table::columns(&["case", "what"], &[], rows.collect()))?;
        return Ok(Outcome::Done);
    }
    let options = ValidateOptions {
        directory: arguments.output,
        resume: arguments.resume,
        cases: arguments.cases,
        effort: if arguments.quick { Effort::Quick } else { Effort::Full },
        threads: arguments.threads,
    };
    let stop = StopFlag::new(std::sync::Arc::default(), || {
        terminal::note("stopping after this step (a second signal quits at once)")
    })
    .into_diagnostic()
    .wrap_err("cannot catch Ctrl-C")
    .map_err(Failure::Failed)?;
    let result = validate(&options, stop.flag(), &mut Lines);
    stop.finish();
    match result {
        Ok(report) => {
            terminal::print(&format!(
                "{report}report      {}\n",
                terminal::path(&options.directory.join("report.html"))
            ))?;
            if report.passed { Ok(Outcome::Done) } else { Err(Failure::Told) }
        }
        Err(ValidateError::Stopped { directory }) => {
            terminal::note(&format!(
                "stopped; runs and report of the finished cases are in {}; `--resume` continues from them",
                directory.display()
            ));
            Ok(Outcome::Stopped)
        }
        Err(error @ (ValidateError::Run(_) | ValidateError::Report(_) | ValidateError::Lost { .. })) => {
            Err(Failure::Failed(error.into()))
        }
        Err(error) => Err(Failure::BadInput(error.into())),
    }
}

/// A line for every run and every judged case.
struct Lines;

impl Observer for Lines {}

impl Watcher for Lines {
    fn case_started(&mut self, case: &Case, number: usize, count: usize) {
        terminal::note(&format!("[{number}/{count}] {}: {}", case.name, case.title));
    }

    fn variant_started(&mut self, variant: &Variant, number: usize, count: usize) {
        terminal::note(&format!("      run {number} of {count}: {}", variant.label));
    }

    fn case_judged(&mut self, report: &CaseReport) {
        let ((passed, asked), missed) = (report.checks(), report.missed_in_words());
        terminal::note(&format!("      {}: {passed} of {asked} checks{missed}", report.verdict.name()));
    }
}
