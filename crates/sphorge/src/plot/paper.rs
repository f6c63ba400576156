//! How large a picture is and in which form it is written.

use super::PlotError;
use std::path::Path;

/// Units of a page to the inch: at 100 dots per inch a unit is a pixel.
const UNITS_PER_INCH: f64 = 100.0;
const INCH: f64 = 0.0254;

/// Size and fineness of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// Pixels to the inch, 50 to 1200. Texts and lines keep their printed size.
    pub dpi: u32,
    /// Width in m; to fit if not given.
    pub width: Option<f64>,
}

impl Default for Paper {
    /// 100 pixels to the inch, as wide as fits.
    fn default() -> Self {
        Self { dpi: 100, width: None }
    }
}

impl Paper {
    /// Pixels to a unit of the page.
    pub(super) fn scale(&self) -> f64 {
        f64::from(self.dpi) / UNITS_PER_INCH
    }

    /// Width in units of the page.
    pub(super) fn units(&self) -> Option<f64> {
        self.width.map(|width| width / INCH * UNITS_PER_INCH)
    }
}

/// In which form a picture is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureFormat {
    /// Pixels.
    #[default]
    Png,
    /// Lines, shapes and texts that scale; particles are an image within.
    Svg,
}

impl PictureFormat {
    /// The ending of file names.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }

    /// The format a file name asks for.
    ///
    /// # Errors
    /// [`PlotError::Format`] for another ending than `.png` and `.svg`.
    pub fn of(path: &Path) -> Result<Self, PlotError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        [Self::Png, Self::Svg]
            .into_iter()
            .find(|format| format.extension() == ending)
            .ok_or_else(|| PlotError::Format { path: path.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_a_journal_has_the_pixels_of_its_width() {
        let paper = Paper { dpi: 300, width: Some(0.085) };
        assert!((paper.units().unwrap() * paper.scale() - 1003.9).abs() < 0.1);
        assert_eq!(Paper::default().scale(), 1.0);
    }

    #[test]
    fn the_ending_says_the_form() {
        assert_eq!(PictureFormat::of(Path::new("a/b.SVG")).unwrap(), PictureFormat::Svg);
        for name in ["a.pdf", "a"] {
            assert!(matches!(PictureFormat::of(Path::new(name)), Err(PlotError::Format { .. })));
        }
    }
}
