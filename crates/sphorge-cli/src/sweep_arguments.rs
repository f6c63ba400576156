//! Several runs of a deck: arguments of the commands that make them, and what is said meanwhile.

use crate::{
    commands::run::parse_threads,
    engine_arguments::EngineArguments,
    failure::{Ending, Failure, Outcome, of_output},
    readable,
    signals::StopFlag,
    terminal,
};
use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use sphorge::sweep::{self, Planned, Process, Sweep, SweepError, SweepEvent, SweepTable};
use std::{
    ffi::OsString,
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
};

/// How the runs are made.
#[derive(Debug, Args)]
pub(crate) struct SweepRunArguments {
    /// Number of runs at the same time
    #[arg(short, long, value_name = "N", default_value_t = 1, value_parser = parse_threads)]
    jobs: usize,
    /// Number of threads of each run [default: all processors, divided by --jobs]
    #[arg(long, value_name = "N", value_parser = parse_threads)]
    threads: Option<usize>,
    #[command(flatten)]
    pub(crate) engine: EngineArguments,
    /// Make runs again that are in the output folder
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Write the table of the runs to a Parquet file, too
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
    /// List the runs that would be made, and make none
    #[arg(long)]
    dry_run: bool,
    /// Print no progress; errors are printed
    #[arg(short, long)]
    quiet: bool,
}

/// What is wrong with a sweep is bad input.
pub(crate) fn failure(error: SweepError) -> Failure {
    Failure::BadInput(error.into())
}

impl SweepRunArguments {
    /// Makes the runs and returns the table of all, or how the command ends without.
    pub(crate) fn execute(&self, sweep: &Sweep, program: &[OsString]) -> Result<(SweepTable, bool), Ending> {
        if self.dry_run {
            return Err(self.list(sweep));
        }
        let maker = self.maker(program)?;
        let table = maker.make(sweep)?;
        self.write_parquet(&table)?;
        Ok((table, maker.is_stopped()))
    }

    /// What makes runs, of one sweep or of several that follow each other.
    pub(crate) fn maker<'a>(&'a self, program: &'a [OsString]) -> Result<Maker<'a>, Ending> {
        let is_quiet = self.quiet;
        let asked = move || {
            if !is_quiet {
                terminal::note("stopping after these steps (a second signal quits at once)");
            }
        };
        let stop = StopFlag::new(Arc::new(AtomicBool::new(false)), asked)
            .into_diagnostic()
            .wrap_err("cannot catch Ctrl-C")
            .map_err(|error| Err(Failure::Failed(error)))?;
        Ok(Maker { arguments: self, program, stop })
    }

    /// Writes the table to a Parquet file, if one was asked for.
    pub(crate) fn write_parquet(&self, table: &SweepTable) -> Result<(), Ending> {
        match &self.parquet {
            Some(path) => table.write_parquet(path).map_err(|error| Err(of_output(error))),
            None => Ok(()),
        }
    }

    /// Runs at once.
    pub(crate) fn jobs(&self) -> usize {
        self.jobs
    }

    /// Whether no run is to be made.
    pub(crate) fn is_dry(&self) -> bool {
        self.dry_run
    }

    /// Lists what would be run.
    pub(crate) fn list(&self, sweep: &Sweep) -> Ending {
        let lines = sweep
            .runs
            .iter()
            .map(|run| format!("{:<9}  {}\n", planned(run.planned), terminal::path(&sweep.directory(run))));
        terminal::print(&lines.collect::<String>())?;
        Ok(Outcome::Done)
    }

    /// The same for programs.
    pub(crate) fn list_json(&self, sweep: &Sweep) -> Ending {
        let runs = sweep.runs.iter().map(|run| {
            serde_json::json!({ "run": run.name, "values": run.values, "planned": planned(run.planned), "notes": run.notes })
        });
        let listed = serde_json::json!({ "folder": sweep.folder.to_string_lossy(), "runs": runs.collect::<Vec<_>>() });
        terminal::print(&format!("{}\n", terminal::json(&listed)?))?;
        Ok(Outcome::Done)
    }
}

/// What there is to do for a run.
fn planned(planned: Planned) -> &'static str {
    match planned {
        Planned::New => "run",
        Planned::Again => "run again",
        Planned::Resume => "resume",
        Planned::Nothing => "there",
    }
}

/// Makes runs until it is stopped.
pub(crate) struct Maker<'a> {
    arguments: &'a SweepRunArguments,
    program: &'a [OsString],
    stop: StopFlag,
}

impl Maker<'_> {
    /// Whether somebody has asked to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.flag().load(std::sync::atomic::Ordering::Relaxed)
    }

    /// Makes the runs of a sweep that are not there, and returns the table of all.
    pub(crate) fn make(&self, sweep: &Sweep) -> Result<SweepTable, Ending> {
        let of = self.arguments;
        let count = sweep.runs.len();
        let due = sweep.runs.iter().filter(|run| run.planned != Planned::Nothing).count();
        let processors = std::thread::available_parallelism().map_or(1, |n| n.get());
        let at_once = of.jobs.min(due.max(1));
        let process = Process {
            program: self.program.to_vec(),
            at_once,
            threads: of.threads.unwrap_or((processors / at_once).max(1)),
            engine: of.engine.unusual().map(str::to_owned),
            device: of.engine.device().map(str::to_owned),
        };
        let say = |text: &str| {
            if !of.quiet {
                terminal::note(text);
            }
        };
        let there = if due < count { format!(", {} of them are there", count - due) } else { String::new() };
        say(&format!(
            "{count} runs in {}{there}; {at_once} at once, on {} each",
            terminal::path(&sweep.folder),
            readable::threads(process.threads)
        ));
        for (note, first, runs) in sweep.notes() {
            let others = if runs > 1 { format!(" and {} more", runs - 1) } else { String::new() };
            say(&format!("note: {}{others}: {note}", sweep.runs[first].name));
        }
        let tell = |event: SweepEvent<'_>| match event {
            SweepEvent::Begins(k) => {
                let what = if sweep.runs[k].planned == Planned::Resume { "goes on" } else { "begins" };
                say(&format!("run {} of {count} {what}: {}", k + 1, sweep.runs[k].name));
            }
            SweepEvent::Ended(k, row) => {
                let seconds = row.summary.as_ref().map_or(0.0, |summary| summary.wall_seconds);
                let status = row.status();
                say(&format!("run {} of {count} {status} after {}", k + 1, readable::duration(seconds)));
                if let Some(told) = &row.told {
                    terminal::note_lines(&format!("{}:\n{told}", row.run));
                }
            }
        };
        let table = sweep::execute(sweep, &process, self.stop.flag(), &tell);
        self.stop.finish();
        table.map_err(|error| match error {
            // The folder is another one's.
            SweepError::Locked { .. } | SweepError::Another { .. } => Err(failure(error)),
            SweepError::Output(error) => Err(of_output(error)),
            error => Err(Failure::Failed(error.into())),
        })
    }
}

/// How a command that has made runs ends.
pub(crate) fn conclude(table: &SweepTable, is_stopped: bool) -> Ending {
    let incomplete = table.rows.iter().filter(|row| !row.is_complete()).count();
    match incomplete {
        0 => Ok(Outcome::Done),
        _ if is_stopped => {
            terminal::note("stopped; the same command goes on where it was");
            Ok(Outcome::Stopped)
        }
        _ => {
            terminal::note(&format!(
                "{incomplete} of {} runs have not reached their end; one that failed is made again when its folder is removed, or all are with --overwrite",
                table.rows.len()
            ));
            Err(Failure::Told)
        }
    }
}
