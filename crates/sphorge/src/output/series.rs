//! The ParaView collection `fields.pvd`: which frame is at which time.

use super::{
    RunDirectory,
    atomic::Durability,
    directory::SERIES,
    error::{AtPath, OutputError},
    regular_file, xml,
};
use std::{fmt::Write, path::PathBuf};

/// A frame of a series.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesEntry {
    /// Time, s.
    pub time: f64,
    /// File, relative to the collection.
    pub file: String,
}

/// Writes the collection.
pub(crate) fn write_series(directory: &RunDirectory, entries: &[SeriesEntry]) -> Result<(), OutputError> {
    directory.write(SERIES, Durability::Process, |out| {
        out.write_all(series_text(entries).as_bytes())?;
        out.write_all(b"  </Collection>\n</VTKFile>\n")
    })
}

/// The collection up to the last of some entries.
pub(crate) fn series_text(entries: &[SeriesEntry]) -> String {
    let mut text = r#"<?xml version="1.0"?>
<VTKFile type="Collection" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <Collection>
"#
    .to_owned();
    for SeriesEntry { time, file } in entries {
        // A text does not fail to grow.
        let _ = writeln!(text, r#"    <DataSet timestep="{time:e}" part="0" file="{file}"/>"#);
    }
    text
}

/// The frames of a run in order of time, with their full paths.
///
/// # Errors
/// [`OutputError::Read`] if the run has no collection, [`OutputError::Damaged`] if it cannot be understood or is empty.
pub fn read_series(run: &RunDirectory) -> Result<Vec<(f64, PathBuf)>, OutputError> {
    let path = run.series();
    let text = regular_file::read_to_string(&path).reading(&path)?;
    let document = xml::parse(&text).map_err(|reason| OutputError::damaged(&path, reason))?;
    let frames: Vec<_> = document
        .descendants()
        .filter(|n| n.has_tag_name("DataSet"))
        .map(|n| {
            let time = n.attribute("timestep").and_then(|t| t.parse().ok());
            time.zip(n.attribute("file").map(|file| run.path().join(file)))
        })
        .collect::<Option<_>>()
        .ok_or_else(|| OutputError::damaged(&path, "a frame without time or file"))?;
    if frames.is_empty() { Err(OutputError::damaged(&path, "it lists no frame")) } else { Ok(frames) }
}
