//! When a run saves its state: arguments of the commands that run decks.

use crate::{failure::Failure, signals};
use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use sphorge::run::CheckpointPlan;
use std::time::Duration;

/// When to write checkpoints.
#[derive(Debug, Args)]
pub(crate) struct CheckpointArguments {
    /// Save the state of the run every so many minutes, and when it is stopped; 0 for never
    #[arg(long, value_name = "MINUTES", default_value_t = 10.0, value_parser = parse_minutes)]
    checkpoint_minutes: f64,
    /// Save it also every so many seconds of simulated time
    #[arg(long, value_name = "SECONDS", value_parser = parse_interval)]
    checkpoint_interval: Option<f64>,
    /// Save it also when the run has reached its end, so that it can go on beyond
    #[arg(long)]
    checkpoint_at_end: bool,
}

fn parse_minutes(text: &str) -> Result<f64, String> {
    let minutes = text.parse().ok().filter(|minutes| (0.0..1e6).contains(minutes));
    minutes.ok_or_else(|| "write a number of minutes, 0 for never".to_owned())
}

fn parse_interval(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite() && *seconds > 0.0);
    seconds.ok_or_else(|| "write a number of seconds above zero: `5e-6`".to_owned())
}

impl CheckpointArguments {
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
