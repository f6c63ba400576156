//! When a run saves its state: arguments of the commands that run decks.

use crate::{failure::Failure, readable::quantity, signals};
use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use sphorge::{deck, run::CheckpointPlan};
use std::time::Duration;

/// When to write checkpoints.
#[derive(Debug, Args)]
pub(crate) struct CheckpointArguments {
    /// Real time between checkpoints, in minutes or with a unit, such as "90 s"; a run that is stopped writes one too; 0 for none
    #[arg(long, value_name = "MINUTES", default_value_t = 10.0, value_parser = parse_minutes, allow_hyphen_values = true)]
    checkpoint_minutes: f64,
    /// Simulated time between additional checkpoints, such as "5 us"; a plain number is in seconds
    #[arg(long, value_name = "TIME", value_parser = parse_interval, allow_hyphen_values = true)]
    checkpoint_interval: Option<f64>,
    /// Write a checkpoint at the end of the run, so that `sphorge resume` can continue beyond it
    #[arg(long)]
    checkpoint_at_end: bool,
}

/// Minutes: a number alone, or a time with its unit.
fn parse_minutes(text: &str) -> Result<f64, String> {
    let minutes = match text.trim().parse::<f64>() {
        Ok(minutes) => minutes,
        Err(_) => deck::read_quantity(text, "s")? / 60.0,
    };
    if (0.0..1e6).contains(&minutes) {
        Ok(minutes)
    } else {
        Err("write minutes up to a million, or a time with its unit: `10` or `\"90 s\"`; 0 for never".to_owned())
    }
}

fn parse_interval(text: &str) -> Result<f64, String> {
    match deck::read_quantity(text, "s")? {
        seconds if seconds > 0.0 => Ok(seconds),
        _ => Err("write a time above zero: `\"5 us\"`".to_owned()),
    }
}

impl CheckpointArguments {
    /// What is said of checkpoints that no run up to this time has, s.
    pub(crate) fn note(&self, end: f64) -> Option<String> {
        let interval = self.checkpoint_interval.filter(|interval| *interval > end)?;
        Some(format!(
            "note: `--checkpoint-interval` is {}, and the run ends at {}: no checkpoint is written for it; a plain number is in seconds",
            quantity(interval, "s"),
            quantity(end, "s")
        ))
    }

    /// The plan, with the signal that asks for one at once.
    pub(crate) fn plan(&self) -> Result<CheckpointPlan, Failure> {
        let is_periodic = self.checkpoint_minutes > 0.0;
        // Caught whatever the plan is: a signal that asks for a checkpoint is to end no run.
        let request = signals::checkpoint_request()
            .into_diagnostic()
            .wrap_err("cannot catch SIGUSR1")
            .map_err(Failure::Failed)?;
        Ok(CheckpointPlan {
            every: is_periodic.then(|| Duration::from_secs_f64(60.0 * self.checkpoint_minutes)),
            interval: self.checkpoint_interval,
            at_end: self.checkpoint_at_end,
            request,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_longer_than_the_run_is_told() {
        let of = |checkpoint_interval| CheckpointArguments {
            checkpoint_minutes: 10.0,
            checkpoint_interval,
            checkpoint_at_end: false,
        };
        let told = of(Some(5.0)).note(20e-6).unwrap();
        assert!(told.contains("`--checkpoint-interval` is 5 s, and the run ends at 20 us"), "{told}");
        assert_eq!((of(Some(20e-6)).note(20e-6), of(None).note(20e-6)), (None, None));
    }

    #[test]
    fn times_are_written_as_in_decks_and_numbers_alone_keep_their_meaning() {
        let minutes = ["10", "0", "10 min", "600 s", "0.5 h"].map(|text| parse_minutes(text).unwrap());
        assert_eq!(minutes, [10.0, 0.0, 10.0, 10.0, 30.0]);
        let seconds = ["5e-6", "5 us", "10 min", "600 s"].map(|text| parse_interval(text).unwrap());
        assert_eq!(seconds, [5e-6, 5e-6, 600.0, 600.0]);
        for (text, told) in
            [("-1", "0 for never"), ("nan", "0 for never"), ("ten", "expected a time"), ("5 mm", "found a length")]
        {
            let error = parse_minutes(text).unwrap_err();
            assert!(error.contains(told), "{text}: {error}");
        }
        for (text, told) in [("0", "above zero"), ("-5 us", "above zero"), ("5 mins", "min"), ("", "expected a time")] {
            let error = parse_interval(text).unwrap_err();
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
