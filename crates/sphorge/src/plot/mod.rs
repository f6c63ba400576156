//! Pictures of a run: particles coloured by a field, and curves of the history.
//!
//! Everything is read back from the files of the run, so that a run can be pictured while it goes on, and later.

mod canvas;
mod chart;
mod color;
mod error;
mod field;
mod history;
mod light;
mod scene;
mod spans;
mod splat;
mod view;

pub use color::ColorMap;
pub use error::PlotError;
pub use field::{plot_field, plot_field_of_runs};
pub use history::{HistoryPicture, plot_columns, plot_history, plot_overlay};
pub use view::View;

use crate::output::{FrameFile, RunDirectory, read_series};
use std::path::PathBuf;

/// Which frame of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FrameChoice {
    /// The first.
    First,
    /// The last.
    #[default]
    Last,
    /// By its number, counted from zero.
    Index(usize),
    /// The one nearest to a time, s.
    Time(f64),
}

impl std::str::FromStr for FrameChoice {
    type Err = String;

    /// `first`, `last`, a whole number (the frame), or a number with a point or an exponent (the time in seconds).
    fn from_str(text: &str) -> Result<Self, String> {
        let time = || text.parse().ok().filter(|time: &f64| time.is_finite()).map(Self::Time);
        match text {
            "first" => Ok(Self::First),
            "last" => Ok(Self::Last),
            _ => text.parse().ok().map(Self::Index).or_else(time).ok_or_else(|| {
                format!("`{text}` is no frame; write first, last, a number such as 12, or a time such as 6e-5")
            }),
        }
    }
}

/// A picture of particles; of a problem in one dimension, a curve over x for each frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    /// Field, or a component as in `stress.xy`. A vector or tensor without component is shown by its norm.
    pub field: String,
    /// Frames, side by side at one scale: the first and the last make a before and after.
    pub frames: Vec<FrameChoice>,
    /// Direction of view; the plane of a plane problem, a corner of a solid one if not given.
    pub view: Option<View>,
    /// Leave out what is before the middle, to look inside.
    pub section: bool,
    /// Show the crater and cloud measures of the deck as lines on the particles, in views along an axis.
    pub measures: bool,
    /// Values of the ends of the colour bar (or the upright axis). If not given: the extremes shown, or where a few outliers stretch them by half
    /// or more, the range of 99 % of the particles; arrows at the bar then give the extremes.
    pub range: Option<(f64, f64)>,
    /// Colours; viridis, or diverging where values of both signs matter, if not given.
    pub color_map: Option<ColorMap>,
    /// Part of the plane of view to show, right then up, m; all if not given.
    pub window: Option<[(f64, f64); 2]>,
    /// Pixels across and down; to fit if not given.
    pub size: Option<(u32, u32)>,
    /// Title; that of the deck if not given.
    pub title: Option<String>,
}

impl FieldPicture {
    /// The last frame, everything else as it fits.
    pub fn new(field: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            frames: vec![FrameChoice::Last],
            view: None,
            section: false,
            measures: false,
            range: None,
            color_map: None,
            window: None,
            size: None,
            title: None,
        }
    }
}

/// Fields pictured when none is named, where a run wrote them.
const USUAL_FIELDS: [&str; 5] = ["plastic_strain", "von_mises_stress", "pressure", "temperature", "velocity"];

/// Makes the usual pictures of a run in its `plots` folder: the last frame by several fields, plastic strain before and
/// after, and the history. Returns their files.
///
/// # Errors
/// [`PlotError`] if the run has no readable frame or history.
pub fn plot_run(run: &RunDirectory) -> Result<Vec<PathBuf>, PlotError> {
    let mut files = Vec::new();
    let series = read_series(run)?;
    let Some((_, last)) = series.last() else { return Ok(files) };
    let frame = FrameFile::open(last)?;
    let present = |name: &&&str| frame.arrays().iter().any(|array| array.name == **name);
    for &field in USUAL_FIELDS.iter().filter(present) {
        let file = run.plots().join(format!("{field}-last.png"));
        plot_field(run, &FieldPicture::new(field), &file)?;
        files.push(file);
    }
    if let Some(field) = USUAL_FIELDS.iter().find(|name| present(name)).filter(|_| series.len() > 1) {
        let file = run.plots().join(format!("{field}-before-after.png"));
        let frames = vec![FrameChoice::First, FrameChoice::Last];
        plot_field(run, &FieldPicture { frames, ..FieldPicture::new(*field) }, &file)?;
        files.push(file);
    }
    for picture in HistoryPicture::ALL {
        let file = run.plots().join(format!("history-{}.png", picture.name()));
        if plot_history(run, picture, &file)? {
            files.push(file);
        }
    }
    Ok(files)
}

/// Title of a run, or the name of its folder while there is no summary.
fn run_title(run: &RunDirectory) -> String {
    let folder = || run.path().file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    crate::output::Summary::read(run).map_or_else(|_| folder(), |summary| summary.title)
}

#[cfg(test)]
mod tests;
