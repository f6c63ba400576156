//! Pictures of a report.

use super::{Case, PictureRecord, folder::Folder, runs::Runs};
use crate::{
    analysis::plot::{FieldPicture, FrameChoice, PlotError, plot_columns, plot_field},
    output::RunDirectory,
};
use std::path::Path;

/// What a picture shows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subject {
    /// The last frame by a field.
    Last(&'static str),
    /// The first and the last frame by a field.
    BeforeAfter(&'static str),
    /// Columns of the history.
    History(&'static [&'static str]),
}

/// A picture of the finest run of a series.
#[derive(Clone, Copy, Debug)]
pub(super) struct Picture {
    pub(super) series: &'static str,
    pub(super) subject: Subject,
    pub(super) caption: &'static str,
}

/// Draws the pictures of a case; one that cannot be drawn says why.
pub(super) fn draw(case: &Case, runs: &Runs, folder: &Folder) -> Vec<PictureRecord> {
    let draw_one = |(k, picture): (usize, &Picture)| {
        let file = folder.pictures(case.name).join(format!("{}.png", k + 1));
        let run = runs.finest(picture.series);
        let label = run.map_or("", |run| run.label());
        let caption = format!("{} ({label})", picture.caption);
        let drawn = match run {
            Some(run) => RunDirectory::open(&run.directory)
                .map_err(PlotError::from)
                .and_then(|run| subject(&run, picture.subject, &file))
                .map_err(|error| error.to_string()),
            None => Err("there is no such run".to_owned()),
        };
        match drawn {
            Ok(()) => PictureRecord { caption, file: Some(folder.relative(&file)), trouble: None },
            Err(trouble) => PictureRecord { caption, file: None, trouble: Some(trouble) },
        }
    };
    case.pictures.iter().enumerate().map(draw_one).collect()
}

fn subject(run: &RunDirectory, subject: Subject, file: &Path) -> Result<(), PlotError> {
    match subject {
        Subject::Last(field) => plot_field(run, &FieldPicture::new(field), file),
        Subject::BeforeAfter(field) => {
            let frames = vec![FrameChoice::First, FrameChoice::Last];
            plot_field(run, &FieldPicture { frames, ..FieldPicture::new(field) }, file)
        }
        Subject::History(columns) => {
            let columns: Vec<String> = columns.iter().map(|&column| column.to_owned()).collect();
            plot_columns(run, &columns, file)
        }
    }
}
