//! Pictures of a report.

use super::{Case, PictureRecord, folder::Folder, picture::Picture, runs::Runs};

/// Draws the pictures of a case; one that cannot be drawn says why.
pub(super) fn draw(case: &Case, runs: &Runs, folder: &Folder) -> Vec<PictureRecord> {
    let draw_one = |(k, picture): (usize, &Picture)| {
        let file = folder.pictures(case.name).join(format!("{}.png", k + 1));
        let chosen = picture.runs(runs);
        let caption = match &chosen[..] {
            [run] => format!("{} ({})", picture.caption, run.label()),
            _ => picture.caption.to_owned(),
        };
        match picture.draw(&chosen, &file) {
            Ok(()) => PictureRecord { caption, file: Some(folder.relative(&file)), trouble: None },
            Err(trouble) => PictureRecord { caption, file: None, trouble: Some(trouble.to_string()) },
        }
    };
    case.pictures.iter().enumerate().map(draw_one).collect()
}
