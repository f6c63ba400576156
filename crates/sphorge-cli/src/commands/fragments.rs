//! `sphorge fragments`: what has broken off in a run.

use crate::{
    failure::{Ending, Failure, Outcome, of_output},
    terminal,
};
use clap::Args;
use sphorge::{
    fragments::{FragmentOptions, FragmentTable, fragments},
    output::RunDirectory,
    plot::FrameChoice,
};
use std::path::PathBuf;

/// Arguments of `fragments`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge fragments out/perforation
  sphorge fragments out/perforation --body plate --frame \"60 us\" --least 20
  sphorge fragments out/perforation --frame all --csv fragments.csv
  sphorge fragments out/perforation --json

A fragment is what hangs together of the particles of a body that have some
integrity; without a law of fracture all particles have it. Distances are
those before the deformation where the frames have the field
`deformation_gradient`. Sizes are the edges of the box with the same second
moments. Beside planes of symmetry masses are those of the modelled part.")]
pub(crate) struct FragmentsArguments {
    /// Run folder, of a finished or unfinished run
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// Fragments of this body alone; can be repeated [default: all bodies]
    #[arg(long = "body", value_name = "BODY")]
    bodies: Vec<String>,
    /// Frame: `first`, `last`, a number, a time such as "12 us", or `all`
    #[arg(long, value_name = "FRAME", default_value = "last", allow_hyphen_values = true)]
    frame: String,
    /// Particles hang together up to this distance, in spacings of their body
    #[arg(long, value_name = "SPACINGS", allow_hyphen_values = true, default_value_t = FragmentOptions::default().link)]
    link: f64,
    /// Particles that a fragment has at least
    #[arg(long, value_name = "N", default_value_t = FragmentOptions::default().least)]
    least: u64,
    /// Most fragments to print one by one
    #[arg(long, value_name = "N", default_value_t = 20)]
    most: usize,
    /// Write all fragments to this file, in SI
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print JSON instead of tables
    #[arg(long)]
    json: bool,
}

pub(crate) fn execute(arguments: FragmentsArguments) -> Ending {
    let FragmentsArguments { directory, bodies, frame, link, least, most, csv, json } = arguments;
    let frame = match frame.as_str() {
        "all" => None,
        text => Some(text.parse::<FrameChoice>().map_err(|reason| {
            Failure::bad_input(
                format!("--frame: {}", reason.replace("first, last", "first, last, all")),
                "the default is the last frame",
            )
        })?),
    };
    let run = RunDirectory::open(&directory).map_err(|error| Failure::BadInput(error.into()))?;
    let options = FragmentOptions { bodies, link, least };
    let tables = fragments(&run, frame, &options).map_err(|error| Failure::BadInput(error.into()))?;
    let mut told: Vec<&str> = Vec::new();
    for note in tables.iter().flat_map(|table| &table.notes) {
        if !told.contains(&note.as_str()) {
            told.push(note);
            terminal::note(&format!("note: {note}"));
        }
    }
    if let Some(file) = &csv {
        FragmentTable::write_csv(&tables, file).map_err(of_output)?;
    }
    if json {
        terminal::print(&format!("{}\n", terminal::json(&tables)?))?;
    } else {
        let texts: Vec<String> = tables.iter().map(|table| table.text(most)).collect();
        terminal::print(&texts.join("\n"))?;
        if let Some(file) = &csv {
            terminal::print(&format!("table: {}\n", terminal::path(file)))?;
        }
    }
    Ok(Outcome::Done)
}
