//! Pictures of a report.

use super::{Case, PictureRecord, folder::Folder, picture::Picture, runs::Runs};
use crate::plot::PlotError;

/// Draws the pictures of a case; one that cannot be drawn says why.
pub(super) fn draw(case: &Case, runs: &Runs, folder: &Folder) -> Vec<PictureRecord> {
    let draw_one = |(k, picture): (usize, &Picture)| {
        let chosen = picture.runs(runs);
        let caption = match &chosen[..] {
            [run] => format!("{} ({})", picture.caption, run.label()),
            _ => picture.caption.to_owned(),
        };
        let drawn = folder.pictures(case.name).map_err(PlotError::Output).and_then(|pictures| {
            let file = pictures.join(format!("{}.png", k + 1));
            picture.draw(&chosen, &file).map(|()| file)
        });
        match drawn {
            Ok(file) => PictureRecord { caption, file: Some(folder.relative(&file)), trouble: None },
            Err(trouble) => PictureRecord { caption, file: None, trouble: Some(trouble.to_string()) },
        }
    };
    case.pictures.iter().enumerate().map(draw_one).collect()
}
