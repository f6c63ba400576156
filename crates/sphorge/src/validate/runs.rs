//! The runs of a case.

use super::Variant;
use crate::output::{FrameFile, HistoryTable, RunDirectory, Summary, read_series};
use std::path::PathBuf;

/// What a run left behind.
#[derive(Clone, Debug)]
pub(super) struct Finished {
    pub(super) summary: Summary,
    pub(super) history: HistoryTable,
}

/// A run of a case.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) variant: Variant,
    /// Particle spacing of the deck as run, m.
    pub(super) spacing: f64,
    pub(super) directory: PathBuf,
    /// What it left, or why it failed.
    pub(super) outcome: Result<Finished, String>,
}

/// All runs of a case.
#[derive(Clone, Debug)]
pub(super) struct Runs(pub(super) Vec<Run>);

impl Runs {
    /// Runs of a series, coarse to fine.
    pub(super) fn series<'a>(&'a self, series: &'a str) -> impl Iterator<Item = &'a Run> {
        self.0.iter().filter(move |run| run.variant.series == Some(series))
    }

    /// The finest run of a series.
    pub(super) fn finest<'a>(&'a self, series: &'a str) -> Option<&'a Run> {
        self.series(series).last()
    }
}

impl Run {
    pub(super) fn label(&self) -> &str {
        &self.variant.label
    }

    fn finished(&self) -> Option<&Finished> {
        self.outcome.as_ref().ok()
    }

    pub(super) fn summary(&self) -> Option<&Summary> {
        Some(&self.finished()?.summary)
    }

    /// A measure of the deck at the end, SI.
    pub(super) fn measure(&self, name: &str) -> Option<f64> {
        *self.summary()?.measures.get(name)?
    }

    /// Positions of all particles in the first and in the last frame, in one order, m.
    pub(super) fn first_and_last_positions(&self) -> Option<[Vec<[f64; 3]>; 2]> {
        self.finished()?;
        let frames = read_series(&RunDirectory::open(&self.directory).ok()?).ok()?;
        let positions = |(_, file): &(f64, PathBuf)| FrameFile::open(file).ok()?.positions().ok();
        Some([positions(frames.first()?)?, positions(frames.last()?)?])
    }

    /// A column of the history.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        Some(self.finished()?.history.column(name)?.1)
    }

    /// Largest change of the sum of some columns from its first value, as a share of the first value of `scale`.
    pub(super) fn largest_drift(&self, columns: &[&str], scale: &str) -> Option<f64> {
        let columns: Vec<&[f64]> = columns.iter().map(|name| self.column(name)).collect::<Option<_>>()?;
        let scale = self.column(scale)?.first()?.abs();
        let sum = |row: usize| columns.iter().map(|column| column[row]).sum::<f64>();
        let first = sum(0);
        let rows = columns.first()?.len();
        Some((0..rows).map(|row| (sum(row) - first).abs()).fold(0.0, f64::max) / scale)
    }
}
