//! `sphorge ballistic-limit`: a deck at several impact speeds.

use crate::{
    commands::picture_arguments::FormatArgument,
    deck_arguments::DeckArguments,
    failure::{Ending, Failure, Outcome},
    sweep_arguments::{SweepRunArguments, failure},
    terminal,
};
use clap::Args;
use serde_json::{Value, json};
use sphorge::{
    plot::Paper,
    sweep::{
        Planning, SweepError,
        ballistic::{Asked, BallisticLimit, Flight, Searched, read_speed},
    },
};
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

/// Arguments of `ballistic-limit`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge ballistic-limit perforation --from \"200 m/s\" --to \"303.5 m/s\"
  sphorge ballistic-limit my.toml --body jacket,core --within \"5 m/s\" -j 2
  sphorge ballistic-limit my.toml --at \"250 m/s,300 m/s,400 m/s\" --exponent 2

A projectile has got through if it flies ahead of the median of the particles
of all other bodies at the end of its run, along the direction it came in, and
hardly slows down any more; a run that is too short to tell is listed as open. The
bounds and the speeds of --at are run first, then speeds between the fastest
that was stopped and the slowest that got through. Without a bound the search
widens from the speed of the deck. Through what got through goes the curve of
Recht and Ipson, v_r = a (v_i^p - v_bl^p)^(1/p), by least squares.

As with `sphorge sweep`, the same command makes only the runs that are
missing. The table is also written to ballistic-limit.csv, that of the runs to
sweep.csv, and the curve is drawn in the folder plots. Exit code 1: the
bracket is not as narrow as --within, and why is said.")]
pub(crate) struct BallisticLimitArguments {
    #[command(flatten)]
    deck: DeckArguments,
    /// What flies: bodies whose velocity is varied, with commas between them [default: all that move]
    #[arg(long, value_name = "BODIES", value_delimiter = ',')]
    body: Vec<String>,
    /// Measure of the deck that is the residual velocity: a velocity along the flight [default: the only one]
    #[arg(long, value_name = "MEASURE")]
    residual: Option<String>,
    /// Lower bound of the limit; nothing slower is run [default: none]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    from: Option<String>,
    /// Upper bound of the limit; nothing faster is run [default: none]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    to: Option<String>,
    /// Width of the bracket to end with [default: a hundredth of the speed in the deck]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    within: Option<String>,
    /// Further speeds to run, with commas between them: for the curve
    #[arg(long, value_name = "SPEEDS", value_delimiter = ',', allow_hyphen_values = true)]
    at: Vec<String>,
    /// Most runs
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..=1000))]
    runs: u16,
    /// Hold the exponent p of the curve instead of fitting it
    #[arg(long, value_name = "P", allow_hyphen_values = true)]
    exponent: Option<f64>,
    /// Velocity ahead of what it has struck above which a projectile is through [default: 2 % of its impact velocity]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    through: Option<String>,
    /// Output folder [default: out/<deck name>-ballistic-limit]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    making: SweepRunArguments,
    /// Picture format
    #[arg(long, value_name = "FORMAT", default_value = "png")]
    format: FormatArgument,
    /// Print JSON instead of tables, SI
    #[arg(long)]
    json: bool,
}

pub(crate) fn execute(arguments: BallisticLimitArguments, program: &[OsString]) -> Ending {
    let engine = arguments.making.engine.find()?;
    let (asked, through) = asked(&arguments).map_err(failure)?;
    let BallisticLimitArguments { deck, body, residual, output, making, format, json, .. } = arguments;
    let deck = deck.find()?;
    let flight = Flight::of(&deck.load()?, &body, residual.as_deref()).map_err(failure)?;
    let flight = Flight { through, ..flight };
    deck.refuse_set_keys(flight.keys().iter().map(String::as_str))?;
    let search = asked.search(&flight);
    let folder = output.unwrap_or_else(|| Path::new("out").join(format!("{}-ballistic-limit", deck.name())));
    // Nothing is written while runs are planned: Ctrl-C ends the program.
    let stop = AtomicBool::new(false);
    let planning = Planning { folder: &folder, engine: &*engine, again: making.overwrite, stop: &stop };
    let plan = |speeds: &[f64]| flight.sweep(|set| deck.load_with(set), speeds, &planning).map_err(failure);
    let first = plan(&search.first())?;
    if making.is_dry() {
        return if json { making.list_json(&first) } else { making.list(&first) };
    }
    let known = flight.known(|set| deck.load_with(set), &planning).map_err(failure)?;
    let maker = match making.maker(program) {
        Ok(maker) => maker,
        Err(ending) => return ending,
    };
    let mut made = 0;
    let searched = search.execute(&known, |speeds| {
        let mut sweep = plan(speeds).map_err(Err)?;
        sweep.keep_first(made);
        made = speeds.len();
        let table = maker.make(&sweep)?;
        if maker.is_stopped() && table.rows.iter().any(|row| !row.is_complete()) {
            terminal::note("stopped; the same command goes on where it was");
            return Err(Ok(Outcome::Stopped));
        }
        let shots = flight.shots(&table, &sweep.folder, speeds);
        Ok((table, shots))
    });
    let searched = match searched {
        Ok(Some(searched)) => searched,
        // There is always a first run.
        Ok(None) => return Ok(Outcome::Done),
        Err(ending) => return ending,
    };
    if let Err(ending) = making.write_parquet(&searched.table) {
        return ending;
    }
    let limit = BallisticLimit::of(&search, &flight, &searched);
    limit.write(&folder).map_err(|error| Failure::Failed(error.into()))?;
    let picture = folder.join("plots").join(format!("ballistic-limit.{}", format.format().extension()));
    let is_drawn =
        limit.draw(deck.name(), Paper::default(), &picture).map_err(|error| Failure::Failed(error.into()))?;
    if json {
        terminal::print(&format!("{}\n", terminal::json(&json_of(&limit, &flight))?))?;
    } else {
        let drawn = if is_drawn { format!("{}\n", terminal::path(&picture)) } else { String::new() };
        terminal::print(&format!(
            "{limit}tables: {}: ballistic-limit.csv, sweep.csv\n{drawn}",
            terminal::path(&folder)
        ))?;
    }
    conclude(&limit, &searched)
}

/// How the command ends that has searched.
fn conclude(limit: &BallisticLimit, searched: &Searched) -> Ending {
    let all_complete = searched.table.rows.iter().all(|row| row.is_complete());
    if limit.is_found() && all_complete { Ok(Outcome::Done) } else { Err(Failure::Told) }
}

/// What was given, before the deck is read; and the velocity above which something is through.
fn asked(arguments: &BallisticLimitArguments) -> Result<(Asked, Option<f64>), SweepError> {
    let speed = |text: &Option<String>, option: &str| text.as_deref().map(|text| read_speed(text, option)).transpose();
    let asked = Asked {
        from: speed(&arguments.from, "--from")?,
        to: speed(&arguments.to, "--to")?,
        at: arguments.at.iter().map(|text| read_speed(text, "--at")).collect::<Result<_, _>>()?,
        within: speed(&arguments.within, "--within")?,
        runs: usize::from(arguments.runs),
        at_once: arguments.making.jobs(),
        exponent: arguments.exponent,
    };
    Ok((asked.checked()?, speed(&arguments.through, "--through")?))
}

/// What was found, for programs.
fn json_of(limit: &BallisticLimit, flight: &Flight) -> Value {
    let shots: Vec<Value> = limit
        .shots
        .iter()
        .map(|(shot, row)| {
            let measures: serde_json::Map<String, Value> =
                limit.measures.iter().map(|of| (of.name.clone(), json!(row.measure(&of.name)))).collect();
            json!({
                "impact_velocity": shot.speed,
                "residual_velocity": shot.residual,
                "target_velocity": shot.residual.map(|_| shot.target),
                "outcome": shot.outcome.name(),
                "status": row.status(),
                "run": row.run,
                "measures": measures,
            })
        })
        .collect();
    json!({
        "bodies": flight.bodies,
        "residual": limit.residual,
        "is_found": limit.is_found(),
        "limit": limit.limit(),
        "bracket": limit.bracket.map(|of| json!({ "stopped": of.stopped, "through": of.through })),
        "curve": limit.curve.as_ref().ok().map(|of| json!({
            "a": of.a, "p": of.p, "limit": of.limit, "off_by": of.off_by, "runs": of.runs, "is_exponent_held": of.constants == 2,
        })),
        "why_no_curve": limit.curve.as_ref().err(),
        "notes": limit.notes(),
        "runs": shots,
    })
}
