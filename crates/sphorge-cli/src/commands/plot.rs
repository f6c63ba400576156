//! `sphorge plot`: pictures of a run.

use crate::{
    failure::{Ending, Failure, Outcome},
    terminal,
};
use clap::{Args, ValueEnum};
use sphorge::{
    output::{OutputError, RunDirectory},
    plot::{ColorMap, FieldPicture, FrameChoice, PlotError, View, plot_columns, plot_field, plot_run},
};
use std::path::PathBuf;

/// Arguments of `plot`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  sphorge plot out/iron-plate
  sphorge plot out/iron-plate --field temperature --frames first,20,last
  sphorge plot out/taylor-bar --field plastic_strain --view xz --section --range 0,1.5
  sphorge plot out/penetration --field plastic_strain --measures
  sphorge plot out/iron-plate --column height --column width

Without --field and --column the usual pictures are drawn; the other options
go with --field. Pictures go to the folder `plots` of the run.")]
pub(crate) struct PlotArguments {
    /// Folder of a run, finished or not
    #[arg(value_name = "DIR")]
    directory: PathBuf,
    /// Draw this field, or a component such as `stress.xy`; repeatable
    #[arg(long = "field", value_name = "FIELD")]
    fields: Vec<String>,
    /// Frames side by side: `first`, `last`, numbers, or times in s with a point or exponent
    #[arg(long, value_name = "FRAMES", value_delimiter = ',', default_value = "last", requires = "fields")]
    frames: Vec<FrameChoice>,
    /// Direction of view: xy, xz, yz or corner [default: the plane of a plane problem, else a corner]
    #[arg(long, value_name = "VIEW", requires = "fields")]
    view: Option<View>,
    /// Cut at the middle and look inside
    #[arg(long, requires = "fields")]
    section: bool,
    /// Show the deck's measures of craters and clouds on the particles
    #[arg(long, requires = "fields")]
    measures: bool,
    /// Values at the ends of the colour bar, SI [default: to fit]
    #[arg(long, value_name = "LOW,HIGH", value_parser = parse_range, allow_hyphen_values = true, requires = "fields")]
    range: Option<(f64, f64)>,
    /// Part of the plane of view to show, m: left, right, bottom, top [default: all]
    #[arg(long, value_name = "L,R,B,T", value_parser = parse_window, allow_hyphen_values = true, requires = "fields")]
    window: Option<[(f64, f64); 2]>,
    /// Colours [default: to fit]
    #[arg(long, value_name = "COLOURS", requires = "fields")]
    colors: Option<ColorArgument>,
    /// Draw this column of history.csv over time; repeatable, those of one unit share a chart
    #[arg(long = "column", value_name = "COLUMN")]
    columns: Vec<String>,
}

/// Colours.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ColorArgument {
    /// Dark blue to yellow
    Viridis,
    /// Black through red to yellow
    Inferno,
    /// Blue over grey to red
    Diverging,
}

fn parse_range(text: &str) -> Result<(f64, f64), String> {
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    match text.split_once(',').map(|(low, high)| (number(low), number(high))) {
        Some((Some(low), Some(high))) if low < high => Ok((low, high)),
        _ => Err("write two numbers, the smaller first: `0,1.5`".to_owned()),
    }
}

fn parse_window(text: &str) -> Result<[(f64, f64); 2], String> {
    let sides: Option<Vec<f64>> =
        text.split(',').map(|side| side.trim().parse().ok().filter(|side: &f64| side.is_finite())).collect();
    match sides.as_deref() {
        Some([left, right, bottom, top]) if left < right && bottom < top => Ok([(*left, *right), (*bottom, *top)]),
        _ => Err("write four numbers in m, left before right, bottom before top: `-0.06,0.06,-0.1,0.02`".to_owned()),
    }
}

pub(crate) fn execute(arguments: PlotArguments) -> Ending {
    let run = RunDirectory::open(&arguments.directory).map_err(|error| Failure::BadInput(error.into()))?;
    let files = draw(&run, &arguments).map_err(failure)?;
    let list: String = files.iter().map(|file| format!("{}\n", file.display())).collect();
    terminal::print(&list)?;
    Ok(Outcome::Done)
}

fn draw(run: &RunDirectory, arguments: &PlotArguments) -> Result<Vec<PathBuf>, PlotError> {
    if arguments.fields.is_empty() && arguments.columns.is_empty() {
        return plot_run(run);
    }
    let mut files = Vec::new();
    for field in &arguments.fields {
        let picture = FieldPicture {
            frames: arguments.frames.clone(),
            view: arguments.view,
            section: arguments.section,
            measures: arguments.measures,
            range: arguments.range,
            window: arguments.window,
            color_map: arguments.colors.map(|colors| match colors {
                ColorArgument::Viridis => ColorMap::Viridis,
                ColorArgument::Inferno => ColorMap::Inferno,
                ColorArgument::Diverging => ColorMap::Diverging,
            }),
            ..FieldPicture::new(field)
        };
        let frames: Vec<_> = arguments.frames.iter().map(frame_word).collect();
        let measures = if arguments.measures { "-measures" } else { "" };
        files.push(file(run, &format!("{field}-{}{measures}", frames.join("-"))));
        plot_field(run, &picture, &files[files.len() - 1])?;
    }
    if !arguments.columns.is_empty() {
        files.push(file(run, &format!("history-{}", arguments.columns.join("-"))));
        plot_columns(run, &arguments.columns, &files[files.len() - 1])?;
    }
    Ok(files)
}

/// A picture in the folder of the run.
fn file(run: &RunDirectory, name: &str) -> PathBuf {
    run.plots().join(format!("{name}.png"))
}

/// How a frame is called in the name of a picture.
fn frame_word(frame: &FrameChoice) -> String {
    match frame {
        FrameChoice::First => "first".to_owned(),
        FrameChoice::Last => "last".to_owned(),
        FrameChoice::Index(index) => index.to_string(),
        FrameChoice::Time(time) => format!("{time:e}s"),
    }
}

/// A disk that takes no more is a failure, everything else a wrong folder, field or column.
fn failure(error: PlotError) -> Failure {
    match error {
        PlotError::Output(OutputError::Write { .. }) | PlotError::Encode { .. } => Failure::Failed(error.into()),
        _ => Failure::BadInput(error.into()),
    }
}
