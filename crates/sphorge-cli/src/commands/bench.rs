//! `sphorge bench`: the speed of this program on this machine.

use super::run::parse_threads;
use crate::{
    failure::{Ending, Failure, Outcome},
    readable, table, terminal,
};
use clap::Args;
use sphorge::bench::{BenchOptions, BenchReport, CASES, bench};

/// Arguments of `bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge bench
  sphorge bench block --threads 1
  sphorge bench --threads 1 --json > speed.json

Rates are per core: per thread in use. Pairs are ordered pairs inside the
kernel support, counted once a step.")]
pub(crate) struct BenchArguments {
    /// Cases to measure [default: all]
    #[arg(value_name = "CASE", value_parser = clap::builder::PossibleValuesParser::new(CASES.iter().map(|case| case.deck)))]
    cases: Vec<String>,
    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
    /// Number of threads [default: all of the machine]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
    /// Seconds of each measurement
    #[arg(long, value_name = "S", default_value = "4", value_parser = parse_seconds, allow_negative_numbers = true)]
    seconds: f64,
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.0..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("write a number of seconds from 0 to 3600".to_owned()),
    }
}

pub(crate) fn execute(arguments: BenchArguments) -> Ending {
    let options = BenchOptions { cases: arguments.cases, threads: arguments.threads, seconds: arguments.seconds };
    let report = bench(&options, &mut |what| terminal::note(&format!("measuring {what}")))
        .map_err(|error| Failure::Failed(error.into()))?;
    let text = if arguments.json { terminal::json(&report)? + "\n" } else { tables(&report) };
    terminal::print(&text)?;
    Ok(Outcome::Done)
}

fn tables(report: &BenchReport) -> String {
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
    text.push('\n');
    let million = |value: f64| format!("{:.3}", value / 1e6);
    let head = [
        "case",
        "precision",
        "strategy",
        "particles",
        "neighbours",
        "M particle-steps/s/core",
        "M pairs/s/core",
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
    text
}
