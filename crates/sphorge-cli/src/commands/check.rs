//! `sphorge check`: what a deck would do.

use super::run::parse_threads;
use crate::{
    deck_arguments::DeckArguments,
    engine_arguments::EngineArguments,
    failure::{Ending, Failure, Outcome},
    readable, table, terminal,
};
use clap::Args;
use sphorge::deck::{Advice, advice};
use sphorge::forecast::{Forecast, ForecastOptions, forecast};

/// Wall-clock seconds spent on steps.
const SECONDS: f64 = 1.0;
/// A run that takes longer is not meant: a year, s.
const LONGEST: f64 = 365.0 * 86_400.0;

/// Arguments of `check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge check my.toml
  sphorge check taylor-bar --set particles.spacing=\"0.1 mm\"
  sphorge check taylor-plate --engine gpu

Computes a few steps to time them, and writes nothing. The exit code is 2 if
the deck cannot be run.")]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    deck: DeckArguments,
    #[command(flatten)]
    engine: EngineArguments,
    /// Number of threads [default: all processors]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
}

pub(crate) fn execute(arguments: CheckArguments) -> Ending {
    let engine = arguments.engine.find()?;
    let setup = arguments.deck.find()?.load()?;
    let advice = advice(&setup.model, &setup.particles);
    let own = setup.all_notes();
    let notes = setup.catalogue_notes.iter().chain(&own).chain(&advice.notes);
    notes.for_each(|note| terminal::note(&format!("note: {note}")));
    let options = ForecastOptions { engine, threads: arguments.threads, seconds: SECONDS };
    let forecast = forecast(setup, &options).map_err(|error| Failure::BadInput(error.into()))?;
    terminal::print(&report(&forecast, &advice))?;
    if forecast.run_seconds > LONGEST {
        terminal::note(
            "note: the run would take more than a year; lower `time.end` or `time.max-steps`, or make the first time step longer",
        );
    }
    Ok(Outcome::Done)
}

/// A number of steps, however large.
fn steps(count: f64) -> String {
    match count {
        _ if count < 1e15 => readable::count(count as u64),
        _ if count.is_finite() => readable::digits(count),
        _ => "more than 1e308".to_owned(),
    }
}

fn report(forecast: &Forecast, advice: &Advice) -> String {
    let about = match advice.step_shrinks {
        _ if !forecast.run_seconds.is_finite() => "",
        true => "at least ",
        false => "about ",
    };
    let unit = forecast.mass_unit();
    let rows = forecast.bodies.iter().map(|body| {
        let filled = &body.filled;
        vec![
            body.name.clone(),
            body.material.clone(),
            readable::count(filled.particles as u64),
            readable::quantity(body.spacing, "m"),
            readable::quantity(filled.mass, unit),
            format!(
                "{}{}",
                if filled.is_estimate { "about " } else { "" },
                readable::quantity(filled.shape_mass, unit)
            ),
            readable::percent(filled.excess()),
        ]
    });
    let head = ["body", "material", "particles", "spacing", "mass", "mass of the shape", "difference"];
    let bodies = table::columns(&head, &[2, 3, 4, 5, 6], rows.collect());
    let particles = forecast.particles();
    let facts = [
        ("method", advice.method.clone()),
        ("particles", format!("{}, {:.1} neighbours each", readable::count(particles as u64), forecast.mean_neighbors)),
        (
            "first time step",
            format!("{}, limited by {}", readable::quantity(forecast.first_step, "s"), forecast.first_reason.name()),
        ),
        (
            "expected steps",
            match forecast.most_steps {
                Some(most) if most as f64 <= forecast.expected_steps => {
                    format!("{}, the most the deck allows", readable::count(most))
                }
                _ => format!("{about}{} to {}", steps(forecast.expected_steps), readable::quantity(forecast.end, "s")),
            },
        ),
        (
            "run time",
            format!(
                "{about}{} on {} ({} per step)",
                if forecast.run_seconds.is_finite() {
                    readable::duration(forecast.run_seconds)
                } else {
                    "endless".to_owned()
                },
                readable::computer(forecast.device.as_deref(), 1, forecast.threads),
                readable::duration(forecast.seconds_per_step),
            ),
        ),
        (
            "memory",
            format!(
                "about {} ({:.0} bytes per particle)",
                readable::bytes(forecast.memory_bytes as f64),
                forecast.memory_bytes as f64 / particles.max(1) as f64,
            ),
        ),
        (
            "output",
            format!(
                "at most {} in {} frames",
                readable::bytes(forecast.output_bytes as f64),
                readable::count(forecast.frames)
            ),
        ),
    ];
    let title = if forecast.title.is_empty() { String::new() } else { format!("{}\n\n", forecast.title) };
    format!("{title}{bodies}\n{}", table::facts(&facts))
}
