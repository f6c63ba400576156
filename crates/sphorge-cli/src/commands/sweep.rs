//! `sphorge sweep`: a deck with every combination of some values of some keys.

use crate::{
    commands::picture_arguments::FormatArgument,
    deck_arguments::DeckArguments,
    failure::{Ending, Failure},
    sweep_arguments::{SweepRunArguments, conclude, failure},
    terminal,
};
use clap::Args;
use sphorge::{
    deck::{did_you_mean, names_like},
    plot::{CurvesPicture, Paper},
    sweep::{Planning, Sweep, SweepColumn, SweepError, SweepTable, Varied},
};
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    sync::atomic::AtomicBool,
};

/// Arguments of `sweep`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge sweep iron-plate --vary body.bar.velocity.1=\"-150 m/s,-200 m/s\"
  sphorge sweep my.toml --vary particles.spacing=\"0.6 mm,0.3 mm\" --vary search=skin,adaptive -j 4
  sphorge sweep my.toml --vary wall.anvil.friction=0,0.1,0.2 --plot height

Each run is a process that writes to its own folder in the output folder,
named by what was varied. The same command, with more values or after Ctrl-C,
makes only what is missing: runs that have ended are kept, those that were
begun go on from their last checkpoint. Wrong keys and values are reported
before the first run begins. The table is printed and written to sweep.csv
whenever a run ends.

Commas in brackets or quotation marks are parts of a value:
  --vary 'body.bar.velocity=[\"0 m/s\",\"-150 m/s\"],[\"0 m/s\",\"-200 m/s\"]'")]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    deck: DeckArguments,
    /// Key and the values it takes, such as `particles.spacing="0.6 mm,0.3 mm"`; can be repeated, for every combination
    #[arg(long = "vary", value_name = "KEY=VALUES", value_parser = Varied::read, required = true)]
    varied: Vec<Varied>,
    /// Output folder [default: out/<deck name>-sweep]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    runs: SweepRunArguments,
    /// Draw a measure over a varied key, in the folder `plots` of the output folder; can be repeated
    #[arg(long = "plot", value_name = "MEASURE")]
    plots: Vec<String>,
    /// Varied key along the pictures [default: the first whose values are numbers]
    #[arg(long, value_name = "KEY", requires = "plots")]
    over: Option<String>,
    /// Picture format
    #[arg(long, value_name = "FORMAT", default_value = "png", requires = "plots")]
    format: FormatArgument,
}

pub(crate) fn execute(arguments: SweepArguments, program: &[OsString]) -> Ending {
    let SweepArguments { deck, varied, output, runs, plots, over, format } = arguments;
    let engine = runs.engine.find()?;
    let deck = deck.find()?;
    deck.refuse_set_keys(varied.iter().map(|of| of.key.as_str()))?;
    let folder = output.unwrap_or_else(|| Path::new("out").join(format!("{}-sweep", deck.name())));
    let along = match &plots[..] {
        [] => None,
        _ => Some(along(&varied, over.as_deref()).map_err(failure)?),
    };
    // Nothing is written meanwhile: Ctrl-C ends the program.
    let planning = Planning { folder: &folder, engine: &*engine, again: runs.overwrite, stop: &AtomicBool::new(false) };
    let sweep = Sweep::plan(|set| deck.load_with(set), varied, &planning).map_err(failure)?;
    if let Some(unknown) = plots.iter().find(|measure| !sweep.measures.contains(measure)) {
        let near = did_you_mean(names_like(unknown, sweep.measures.iter().map(String::as_str)));
        return Err(Failure::bad_input(
            format!("the deck has no measure `{unknown}`"),
            format!("{near}it has: {}", sweep.measures.join(", ")),
        ));
    }
    let (table, is_stopped) = match runs.execute(&sweep, program) {
        Ok(table) => table,
        Err(ending) => return ending,
    };
    terminal::print(&format!("{table}\ntable: {}\n", terminal::path(&folder.join("sweep.csv"))))?;
    if let Some(along) = along {
        for measure in &plots {
            draw(&table, measure, along, &folder, format, deck.name())?;
        }
    }
    conclude(&table, is_stopped)
}

/// Which of the varied keys pictures go along.
fn along(varied: &[Varied], asked: Option<&str>) -> Result<usize, SweepError> {
    let keys = || varied.iter().map(|of| format!("`{}`", of.key)).collect::<Vec<_>>().join(", ");
    let found = match asked {
        Some(key) => match varied.iter().position(|of| of.key == key) {
            None => {
                return Err(SweepError::Unknown {
                    what: format!("`{key}` is not varied"),
                    help: format!("choose from {}", keys()),
                });
            }
            Some(k) => Some(k).filter(|&k| varied[k].numbers().is_some()),
        },
        None => varied.iter().position(|of| of.numbers().is_some()),
    };
    found.ok_or_else(|| SweepError::Unknown {
        what: format!("the values of {} are not numbers", asked.map_or_else(keys, |key| format!("`{key}`"))),
        help: "a measure is drawn over a key whose values are quantities of one kind".to_owned(),
    })
}

/// Draws a measure over a key.
fn draw(
    table: &SweepTable,
    measure: &str,
    along: usize,
    folder: &Path,
    format: FormatArgument,
    title: &str,
) -> Result<(), Failure> {
    // There is none before a run has ended.
    let Some(column) = table.measures.iter().find(|column| column.name == measure) else { return Ok(()) };
    let curves = table.curves(measure, along);
    if curves.is_empty() {
        terminal::note(&format!("note: no run has a value of `{measure}` to draw"));
        return Ok(());
    }
    let key = &table.keys[along];
    let named = |column: &SweepColumn| (column.name.replace('_', " "), column.unit.clone());
    let picture = CurvesPicture {
        title: title.to_owned(),
        along: named(key),
        quantity: named(column),
        curves,
        points: Vec::new(),
        paper: Paper::default(),
    };
    let letters = |name: &str| name.replace(['/', '\\'], "_");
    let name = format!("{}-over-{}.{}", letters(measure), letters(&key.name), format.format().extension());
    let to = folder.join("plots").join(name);
    picture.save(&to).map_err(|error| Failure::Failed(error.into()))?;
    terminal::print(&format!("{}\n", terminal::path(&to)))
}
