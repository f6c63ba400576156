//! Which frame of a series a picture shows.

use super::PlotError;
use crate::deck::read_quantity;
use std::path::{Path, PathBuf};

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

    /// `first`, `last`, a whole number (the frame), a time with its unit as in decks (`12 us`), or a number with a point or an
    /// exponent (the time in seconds).
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "first" => Ok(Self::First),
            "last" => Ok(Self::Last),
            _ => text.trim().parse().map(Self::Index).or_else(|_| {
                let time = read_quantity(text, "s").and_then(|time| match time >= 0.0 {
                    true => Ok(time),
                    false => Err("frames and times count from zero".to_owned()),
                });
                time.map(Self::Time).map_err(|reason| {
                    format!("`{text}` is not a frame ({reason}); write first, last, a number such as 12, or a time such as \"60 us\"")
                })
            }),
        }
    }
}

/// There is no frame of that number among so many.
pub(crate) fn no_frame(number: usize, count: usize) -> PlotError {
    let there = match count {
        0 => "the run has none yet".to_owned(),
        1 => "the run has frame 0 alone".to_owned(),
        _ => format!("the run has frames 0 to {}", count - 1),
    };
    PlotError::Frame { number, there }
}

impl FrameChoice {
    /// The frame in a series of times and files; none if there are not so many.
    pub fn find(self, series: &[(f64, PathBuf)]) -> Option<&(f64, PathBuf)> {
        match self {
            Self::First => series.first(),
            Self::Last => series.last(),
            Self::Index(index) => series.get(index),
            Self::Time(time) => series.iter().min_by(|a, b| (a.0 - time).abs().total_cmp(&(b.0 - time).abs())),
        }
    }

    /// The file of the frame.
    pub(crate) fn pick(self, series: &[(f64, PathBuf)]) -> Result<&Path, PlotError> {
        self.find(series).map(|(_, path)| path.as_path()).ok_or_else(|| match self {
            Self::Index(number) if !series.is_empty() => no_frame(number, series.len()),
            _ => PlotError::Empty { reason: "the run has no frame".to_owned() },
        })
    }
}
