//! Pages become files.

use super::{
    PlotError,
    page::Page,
    paper::PictureFormat,
    pixels::{Pixels, encoder},
    svg::svg,
};
use crate::output::{Durability, OutputError, RunDirectory, write_file};
use std::path::Path;

impl Page {
    /// Writes the page in the form the name asks for, complete or not at all. Missing folders are made.
    pub(super) fn save(&self, path: &Path) -> Result<(), PlotError> {
        match PictureFormat::of(path)? {
            PictureFormat::Png => write(path, &Pixels::of(self)?.png(self.paper.dpi)?),
            PictureFormat::Svg => write(path, svg(self)?.as_bytes()),
        }
    }
}

pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), PlotError> {
    if let Some(parent) = path.parent() {
        note_in_run(path, parent)?;
        std::fs::create_dir_all(parent)
            .map_err(|source| PlotError::Output(OutputError::Write { path: path.into(), source }))?;
    }
    Ok(write_file(path, Durability::Process, |out| out.write_all(bytes))?)
}

/// Notes a picture that goes to the folder of pictures of a run, which must not be a link.
fn note_in_run(path: &Path, folder: &Path) -> Result<(), PlotError> {
    let Some(run) = folder.parent().filter(|run| RunDirectory::is_run(run) && run.join("plots") == folder) else {
        return Ok(());
    };
    match path.file_name().and_then(|name| name.to_str()) {
        Some(name) => Ok(RunDirectory::open(run)?.note_picture(name)?),
        None => Ok(()),
    }
}

/// Writes pages of one size as an animated PNG that runs forever, each shown for `seconds`, the last one three times as long.
pub(super) fn save_animation(
    pages: impl ExactSizeIterator<Item = Result<Page, PlotError>>,
    seconds: f64,
    path: &Path,
) -> Result<(), PlotError> {
    let count = pages.len();
    let drawn = |page: Result<Page, PlotError>| -> Result<(u32, Pixels), PlotError> {
        let page = page?;
        Ok((page.paper.dpi, Pixels::of(&page)?))
    };
    let mut pages = pages.map(drawn);
    let Some(first) = pages.next() else {
        return Err(PlotError::Empty { reason: "the run has no frame".to_owned() });
    };
    let (dpi, mut shown) = first?;
    let mut bytes = Vec::new();
    let mut encoder = encoder(&mut bytes, shown.width, shown.height, dpi);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_animated(count as u32, 0)?;
    let mut writer = encoder.write_header()?;
    // Thousandths of a second, or whole seconds where these would not fit.
    let parts: u16 = if 3.0 * seconds < 60.0 { 1000 } else { 1 };
    let delay = |k: usize| {
        let time = if k + 1 == count { 3.0 * seconds } else { seconds };
        (f64::from(parts) * time).round().clamp(1.0, f64::from(u16::MAX)) as u16
    };
    writer.set_frame_delay(delay(0), parts)?;
    writer.write_image_data(shown.rgb.as_flattened())?;
    for (page, k) in pages.zip(1..) {
        let (_, pixels) = page?;
        let Changed { left, top, width, height, rgb } = changed(&shown, &pixels)?;
        writer.set_frame_delay(delay(k), parts)?;
        writer.reset_frame_dimension()?;
        writer.reset_frame_position()?;
        writer.set_frame_dimension(width, height)?;
        writer.set_frame_position(left, top)?;
        writer.write_image_data(rgb.as_flattened())?;
        shown = pixels;
    }
    writer.finish()?;
    write(path, &bytes)
}

/// A part of a picture.
struct Changed {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    rgb: Vec<[u8; 3]>,
}

/// The smallest rectangle outside of which two pictures agree: only what differs from the frame before is written. One pixel
/// where they are the same.
fn changed(before: &Pixels, now: &Pixels) -> Result<Changed, PlotError> {
    if (before.width, before.height) != (now.width, now.height) {
        return Err(PlotError::Encode { reason: "frames of an animation have different sizes".to_owned() });
    }
    let differ = (0u32..).zip(before.rgb.iter().zip(&now.rgb)).filter(|(_, (a, b))| a != b);
    let places = differ.map(|(k, _)| (k % now.width, k / now.width));
    let around = places.fold(None, |found: Option<(u32, u32, u32, u32)>, (x, y)| {
        let (left, top, right, bottom) = found.unwrap_or((x, y, x, y));
        Some((left.min(x), top.min(y), right.max(x), bottom.max(y)))
    });
    let (left, top, right, bottom) = around.unwrap_or((0, 0, 0, 0));
    let rows = (top..=bottom).map(|y| (y * now.width) as usize);
    let rgb = rows.flat_map(|row| &now.rgb[row + left as usize..=row + right as usize]).copied().collect();
    Ok(Changed { left, top, width: right - left + 1, height: bottom - top + 1, rgb })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{
        page::{Area, INK},
        paper::Paper,
    };

    #[test]
    fn an_animation_shows_every_page() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b.png");
        let page = |k: usize| {
            let mut page = Page::new(40.0, 30.0, Paper::default()).unwrap();
            page.fill(Area { x: 5.0 * k as f64, y: 3.0, width: 4.0, height: 4.0 }, INK);
            page
        };
        // The last two pages are the same.
        save_animation([0, 1, 2, 2].into_iter().map(|k| Ok(page(k))), 0.2, &path).unwrap();
        let mut reader =
            png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
        assert_eq!(reader.info().animation_control.unwrap().num_frames, 4);
        let mut shown = vec![[255u8; 3]; 40 * 30];
        for k in [0, 1, 2, 2] {
            let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut buffer).unwrap();
            let part = *reader.info().frame_control().unwrap();
            for (at, pixel) in buffer.as_chunks::<3>().0.iter().take((part.width * part.height) as usize).enumerate() {
                let (x, y) = (at as u32 % part.width + part.x_offset, at as u32 / part.width + part.y_offset);
                shown[(40 * y + x) as usize] = *pixel;
            }
            assert_eq!(shown, Pixels::of(&page(k)).unwrap().rgb, "page {k}");
        }
        let nothing = save_animation(std::iter::empty(), 0.2, &path);
        assert!(matches!(nothing, Err(PlotError::Empty { .. })));
    }
}
