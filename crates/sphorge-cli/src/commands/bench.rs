//! `sphorge bench`: the speed of this program on this machine.

use super::run::parse_threads;
use crate::{
    deck_arguments::parse_override,
    engine_arguments::{EngineArguments, KernelTimes},
    failure::{Ending, Failure, Outcome},
    readable, table, terminal,
};
use clap::Args;
use sphorge::bench::{BenchError, BenchOptions, BenchReport, CASES, bench};
use sphorge::deck::search_words;

/// Arguments of `bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge bench
  sphorge bench block --threads 1
  sphorge bench --threads 1 --json > speed.json
  sphorge bench block --engine gpu --strategy every-step --set 'particles.spacing=\"0.46 mm\"'

Rates are per core, that is per thread in use; for a graphics card they are
for the whole card. Pairs are ordered pairs inside the kernel support, counted
once per step. With `--engine gpu` each case goes on for as long again, waiting
for each kernel; shares of stages and kernel times come from these steps.")]
pub(crate) struct BenchArguments {
    /// Cases to measure [default: all]
    #[arg(value_name = "CASE", value_parser = clap::builder::PossibleValuesParser::new(CASES.iter().map(|case| case.deck)))]
    cases: Vec<String>,
    #[command(flatten)]
    engine: EngineArguments,
    /// Neighbour search to measure; can be repeated [default: all]
    #[arg(long = "strategy", value_name = "WORD", value_parser = clap::builder::PossibleValuesParser::new(search_words()))]
    strategies: Vec<String>,
    /// Set a key of the decks of the cases; can be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<(String, String)>,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
    /// Number of threads [default: all processors]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
    /// Duration of each measurement in seconds
    #[arg(long, value_name = "S", default_value = "4", value_parser = parse_seconds, allow_hyphen_values = true)]
    seconds: f64,
}

/// The report, with what the card can do.
#[derive(serde::Serialize)]
struct WithLimits<'a> {
    #[serde(flatten)]
    report: &'a BenchReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    card: Option<&'a crate::engine_arguments::CardLimits>,
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.0..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("write a number of seconds from 0 to 3600".to_owned()),
    }
}

/// What is measured for each case is not for `--set`.
fn refuse_what_is_measured(overrides: &[(String, String)]) -> Result<(), Failure> {
    let is_of = |key: &str, of: &str| key == of || key.strip_prefix(of).is_some_and(|rest| rest.starts_with('.'));
    for (key, _) in overrides {
        if is_of(key, "search") {
            return Err(Failure::bad_input(
                format!("`bench` does not accept `--set {key}`"),
                "choose the search with `--strategy`",
            ));
        }
        if key == "numerics.precision" {
            return Err(Failure::bad_input(
                format!("`bench` does not accept `--set {key}`"),
                "it always measures both precisions",
            ));
        }
    }
    Ok(())
}

pub(crate) fn execute(arguments: BenchArguments) -> Ending {
    refuse_what_is_measured(&arguments.overrides)?;
    let engine = arguments.engine.find()?;
    let times = arguments.engine.kernel_times()?;
    let options = BenchOptions {
        engine,
        kernels: times.as_ref().map(|times| times.clock.clone()),
        cases: arguments.cases,
        strategies: arguments.strategies,
        overrides: arguments.overrides,
        threads: arguments.threads,
        seconds: arguments.seconds,
    };
    let report =
        bench(&options, &mut |what| terminal::note(&format!("measuring {what}"))).map_err(|error| match error {
            BenchError::Deck(_) => Failure::BadInput(error.into()),
            BenchError::Threads(_) => Failure::Failed(error.into()),
        })?;
    let text = if arguments.json {
        let limits = times.as_ref().map(|times| &times.limits);
        terminal::json(&WithLimits { report: &report, card: limits })? + "\n"
    } else {
        tables(&report, times.as_ref())
    };
    terminal::print(&text)?;
    Ok(Outcome::Done)
}

fn tables(report: &BenchReport, times: Option<&KernelTimes>) -> String {
    let mut text =
        format!("sphorge {} on {}, {} in use\n", report.version, report.machine, readable::threads(report.threads));
    for case in CASES {
        text += &format!("{}: {}\n", case.deck, case.meaning);
    }
    if let Some(bare) = &report.bare_loop {
        text += &format!(
            "bare loop of two pair sums and a search, one core: {:.3} M particle-steps/s ({:.0} + {:.0} + {:.0} ns)\n",
            bare.particle_steps_per_second() / 1e6,
            bare.search,
            bare.gradient,
            bare.forces,
        );
    }
    if let Some(KernelTimes { limits, .. }) = times {
        text += &format!(
            "{}: copies {:.0} GB/s, {:.2} tera-operations/s in multiply-adds; a launch with synchronisation takes {}\n",
            limits.name,
            limits.bytes_per_second / 1e9,
            limits.operations_per_second / 1e12,
            readable::quantity(limits.launch_seconds, "s"),
        );
    }
    text.push('\n');
    let million = |value: f64| format!("{:.3}", value / 1e6);
    let (rate, pair_rate) = match times {
        Some(_) => ("M particle-steps/s", "M pairs/s"),
        None => ("M particle-steps/s/core", "M pairs/s/core"),
    };
    let head = [
        "case",
        "precision",
        "strategy",
        "particles",
        "neighbours",
        rate,
        pair_rate,
        "of the bare loop",
        "bytes/particle",
    ];
    let rows = report.rows.iter().map(|row| {
        vec![
            row.case.clone(),
            row.precision.clone(),
            row.search.clone(),
            readable::count(row.particles as u64),
            format!("{:.1}", row.mean_neighbors),
            million(row.particle_steps_per_second_per_core),
            format!("{:.1}", row.pairs_per_second_per_core / 1e6),
            row.share_of_bare_loop.map_or("-".to_owned(), |share| format!("{:.0} %", 100.0 * share)),
            format!("{:.0}", row.bytes_per_particle),
        ]
    });
    text += &table::columns(&head, &[3, 4, 5, 6, 7, 8], rows.collect());
    text += "\nShare of time by stage, per cent\n\n";
    let head = [
        "case",
        "precision",
        "strategy",
        "search",
        "kinematics",
        "stress",
        "forces",
        "integrate",
        "particles searched",
    ];
    let rows = report.rows.iter().map(|row| {
        let shares = &row.stage_shares;
        let stages = [shares.search, shares.kinematics, shares.stress, shares.forces, shares.integrate];
        let names = [row.case.clone(), row.precision.clone(), row.search.clone()];
        let numbers = stages.into_iter().chain([row.searched_fraction]).map(|share| format!("{:.1}", 100.0 * share));
        names.into_iter().chain(numbers).collect()
    });
    text += &table::columns(&head, &[3, 4, 5, 6, 7, 8], rows.collect());
    for row in report.rows.iter().filter(|row| !row.kernels.is_empty()) {
        text += &format!("\nKernels of {}, {}\n\n", row.case, row.search);
        let of = |share: Option<f64>| share.map_or("-".to_owned(), |share| format!("{:.1}", 100.0 * share));
        let kernels = row.kernels.iter().map(|kernel| {
            vec![
                kernel.kernel.clone(),
                format!("{:.2}", kernel.launches_per_step),
                format!("{:.1}", 1e6 * kernel.seconds),
                format!("{:.1}", 100.0 * kernel.share),
                of(kernel.share_of_bandwidth),
                of(kernel.share_of_arithmetic),
            ]
        });
        let head = ["kernel", "launches/step", "us", "% of time", "% of bandwidth", "% of arithmetic"];
        text += &table::columns(&head, &[1, 2, 3, 4, 5], kernels.collect());
    }
    if times.is_some() {
        text += "\nBandwidth counts all reads and writes of threads, including those from caches, relative to a copy; arithmetic is relative to multiply-adds.\n";
    }
    if !report.skipped.is_empty() {
        text += "\nNot measured\n\n";
        let rows = report
            .skipped
            .iter()
            .map(|of| vec![of.case.clone(), of.precision.clone(), of.search.clone(), of.why.clone()]);
        text += &table::columns(&["case", "precision", "strategy", "why"], &[], rows.collect());
    }
    text
}
