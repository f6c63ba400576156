//! The standard pictures of a run.

use super::{FieldPicture, FrameChoice, HistoryPicture, Paper, PictureFormat, PlotError, plot_field, plot_history};
use crate::deck::load_model;
use crate::model::Model;
use crate::output::{FrameFile, RunDirectory, read_series};
use std::path::{Path, PathBuf};

/// Fields pictured when none is named, where a run wrote them. The last two are those of materials that break: one of them says it.
const DEFAULT_FIELDS: [&str; 7] =
    ["plastic_strain", "von_mises_stress", "pressure", "temperature", "velocity", DAMAGE, INTEGRITY];
const DAMAGE: &str = "damage";
/// What is left of materials that spall and have no law of damage.
const INTEGRITY: &str = "integrity";

/// Those that a run of this deck, if it can be read, has: where bodies do not move the temperature alone is not zero.
pub(crate) fn default_fields(model: Option<&Model>, has: impl Fn(&str) -> bool) -> Vec<&'static str> {
    let is_at_rest = model.is_some_and(|model| !model.thermal.mechanics);
    let usual = if is_at_rest { &["temperature"][..] } else { &DEFAULT_FIELDS };
    let is_told = |name: &str| name == INTEGRITY && has(DAMAGE);
    usual.iter().copied().filter(|name| has(name) && !is_told(name)).collect()
}

/// Draws the standard pictures of a run in a folder: the last frame by body, where there are several, and by several fields, of materials that break by
/// their damage, too, or else their integrity; plastic strain before and after, and the history. Returns their files.
///
/// # Errors
/// [`PlotError`] if the run has no readable frame or history.
pub fn plot_run(
    run: &RunDirectory,
    paper: Paper,
    format: PictureFormat,
    folder: &Path,
) -> Result<Vec<PathBuf>, PlotError> {
    let ending = format.extension();
    let mut files = Vec::new();
    let series = read_series(run)?;
    let Some((_, last)) = series.last() else { return Ok(files) };
    let frame = FrameFile::open(last)?;
    let present = |name: &str| frame.arrays().iter().any(|array| array.name == name);
    // Which body is which: a curve of their numbers over x does not say it.
    let bodies = (frame.bodies.len() > 1 && frame.header.dimensions > 1 && present("body")).then_some("body");
    let model = load_model(&run.deck()).ok();
    let usual = default_fields(model.as_ref(), present);
    for field in bodies.into_iter().chain(usual.iter().copied()) {
        let file = folder.join(format!("{field}-last.{ending}"));
        plot_field(run, &FieldPicture { paper, ..FieldPicture::new(field) }, &file)?;
        files.push(file);
    }
    if let Some(field) = usual.first().filter(|_| series.len() > 1) {
        let file = folder.join(format!("{field}-before-after.{ending}"));
        let frames = vec![FrameChoice::First, FrameChoice::Last];
        plot_field(run, &FieldPicture { frames, paper, ..FieldPicture::new(*field) }, &file)?;
        files.push(file);
    }
    for picture in HistoryPicture::ALL {
        let file = folder.join(format!("history-{}.{ending}", picture.name()));
        if plot_history(run, picture, paper, &file)? {
            files.push(file);
        }
    }
    Ok(files)
}
