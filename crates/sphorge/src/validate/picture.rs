//! A picture of a case.

use super::runs::{Run, Runs};
use crate::{
    output::RunDirectory,
    plot::{
        FieldPicture, FrameChoice, Paper, PlotError, Section, View, plot_columns, plot_field, plot_field_of_runs,
        plot_overlay,
    },
};
use std::path::Path;

/// Points of others: what they are, times in s and values in SI.
pub(super) type Beside = Vec<(String, Vec<(f64, f64)>)>;

/// What a picture shows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subject {
    /// The last frame by a field.
    Last(&'static str),
    /// The first and the last frame by a field.
    BeforeAfter(&'static str),
    /// Columns of the history.
    History(&'static [&'static str]),
    /// A field in runs of these labels, those that there are, at these times, s.
    Inside { runs: &'static [&'static str], field: &'static str, times: &'static [f64], settings: ViewSettings },
    /// A column of the history of every run of the series and of another, with points of others.
    Overlay { column: &'static str, and: &'static str, beside: fn() -> Beside },
}

/// How bodies are shown.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewSettings {
    /// Direction of view.
    pub(super) view: View,
    /// Cut in the middle, seen from the side that is gone.
    pub(super) section: bool,
    /// Part to show, right then up, m.
    pub(super) window: [(f64, f64); 2],
    /// Ends of the colour bar, SI; to fit if none.
    pub(super) range: Option<(f64, f64)>,
}

/// A picture, of the finest run of a series unless its subject says otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Picture {
    pub(super) series: &'static str,
    pub(super) subject: Subject,
    pub(super) caption: &'static str,
}

impl Picture {
    /// The runs it shows.
    pub(super) fn runs<'a>(&'a self, runs: &'a Runs) -> Vec<&'a Run> {
        match self.subject {
            Subject::Inside { runs: labels, .. } => {
                labels.iter().filter_map(|label| runs.0.iter().find(|run| run.label() == *label)).collect()
            }
            Subject::Overlay { and, .. } => runs.series(self.series).chain(runs.series(and)).collect(),
            _ => runs.finest(self.series).into_iter().collect(),
        }
    }

    /// Draws it to a file.
    pub(super) fn draw(&self, runs: &[&Run], file: &Path) -> Result<(), PlotError> {
        let open = |run: &&Run| Ok((run.label().to_owned(), RunDirectory::open(&run.directory)?));
        let runs = runs.iter().map(open).collect::<Result<Vec<_>, PlotError>>()?;
        let Some((_, finest)) = runs.last() else {
            return Err(PlotError::Empty { reason: "there is no such run".to_owned() });
        };
        match self.subject {
            Subject::Last(field) => plot_field(finest, &FieldPicture::new(field), file),
            Subject::BeforeAfter(field) => {
                let frames = vec![FrameChoice::First, FrameChoice::Last];
                plot_field(finest, &FieldPicture { frames, ..FieldPicture::new(field) }, file)
            }
            Subject::History(columns) => {
                let columns: Vec<String> = columns.iter().map(|&column| column.to_owned()).collect();
                plot_columns(finest, &columns, Paper::default(), file)
            }
            Subject::Inside { field, times, settings, .. } => {
                let picture = FieldPicture {
                    frames: times.iter().map(|&time| FrameChoice::Time(time)).collect(),
                    view: Some(settings.view),
                    section: settings.section.then_some(Section::Middle),
                    window: Some(settings.window),
                    range: settings.range,
                    ..FieldPicture::new(field)
                };
                match &runs[..] {
                    [_] => plot_field(finest, &picture, file),
                    several => plot_field_of_runs(several, &picture, file),
                }
            }
            Subject::Overlay { column, beside, .. } => plot_overlay(&runs, column, &beside(), Paper::default(), file),
        }
    }
}
