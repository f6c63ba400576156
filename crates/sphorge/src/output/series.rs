//! The ParaView collection `fields.pvd`: which frame is at which time.

use super::{
    RunDirectory,
    atomic::Durability,
    directory::SERIES,
    error::{AtPath, OutputError},
    regular_file::{self, most},
    sync::Pacing,
    vtp_read::FrameFile,
    xml,
};
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

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

/// Keeps the collection of a run: it is replaced as a whole, like the history, so that with many frames it is when fifty times the duration of the
/// last replacement has passed.
#[derive(Debug)]
pub(crate) struct SeriesWriter {
    written: usize,
    pacing: Pacing,
}

impl SeriesWriter {
    pub(crate) fn new() -> Self {
        Self { written: 0, pacing: Pacing::new() }
    }

    /// Frames have been added: this is a good moment to write, if it is time.
    pub(crate) fn grown(&mut self, directory: &RunDirectory, entries: &[SeriesEntry]) -> Result<(), OutputError> {
        if self.pacing.is_due() { self.write(directory, entries) } else { Ok(()) }
    }

    /// Brings all frames into the file.
    pub(crate) fn flush(&mut self, directory: &RunDirectory, entries: &[SeriesEntry]) -> Result<(), OutputError> {
        if self.written == entries.len() { Ok(()) } else { self.write(directory, entries) }
    }

    /// Writes it, whether it has changed or not.
    pub(crate) fn write(&mut self, directory: &RunDirectory, entries: &[SeriesEntry]) -> Result<(), OutputError> {
        self.pacing.run(|| write_series(directory, entries))?;
        self.written = entries.len();
        Ok(())
    }
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

/// The frames of a run in order of time, with their full paths: those that are listed, and of a run without a summary those that were written after
/// the list.
///
/// # Errors
/// [`OutputError::Read`] if the run has no collection, [`OutputError::Damaged`] if it cannot be understood or is empty.
pub fn read_series(run: &RunDirectory) -> Result<Vec<(f64, PathBuf)>, OutputError> {
    let path = run.series();
    let text = regular_file::read_to_string(&path, most::LIST).reading(&path)?;
    let document = xml::parse(&text).map_err(|reason| OutputError::damaged(&path, reason))?;
    let mut frames: Vec<_> = document
        .descendants()
        .filter(|n| n.has_tag_name("DataSet"))
        .map(|n| {
            let time = n.attribute("timestep").and_then(|t| t.parse().ok());
            time.zip(n.attribute("file").map(|file| run.path().join(file)))
        })
        .collect::<Option<_>>()
        .ok_or_else(|| OutputError::damaged(&path, "a frame without time or file"))?;
    let Some((last, file)) = frames.last() else { return Err(OutputError::damaged(&path, "it lists no frame")) };
    if !run.summary().exists() {
        frames.extend(not_listed(run, *last, file));
    }
    Ok(frames)
}

/// Frames after the last one of a list, which is replaced when its time has come: all that can be read, up to the first that cannot.
fn not_listed(run: &RunDirectory, time: f64, file: &Path) -> Vec<(f64, PathBuf)> {
    let listed = file.file_stem().and_then(|stem| stem.to_str()).and_then(|stem| stem.parse::<usize>().ok());
    let in_pieces = file.extension().is_some_and(|ending| ending == "pvtp");
    let mut found = Vec::new();
    let Some(listed) = listed else { return found };
    let mut before = time;
    for index in listed + 1.. {
        let file = run.path().join(RunDirectory::frame_name(index, in_pieces));
        // What is left of another state of the run is not later.
        match FrameFile::open(&file) {
            Ok(frame) if frame.header.time > before => {
                before = frame.header.time;
                found.push((before, file));
            }
            _ => break,
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Particles,
        output::{FrameHeader, write_frame_file},
    };
    use std::{fs, thread, time::Duration};

    #[test]
    fn frames_that_are_not_listed_yet_are_there_while_a_run_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let run = RunDirectory::create(&folder.path().join("run"), false).unwrap();
        let write = |k: usize, time: f64| {
            let file = RunDirectory::frame_name(k, false);
            let header = FrameHeader { time, step: k as u64, dimensions: 2, body_spacing: vec![1e-3] };
            write_frame_file(&run.path().join(&file), &header, &Particles::new(4), &["pressure".to_owned()]).unwrap();
            SeriesEntry { time, file }
        };
        let entries: Vec<_> = (0..5).map(|k| write(k, 0.1 * k as f64)).collect();
        write_series(&run, &entries[..2]).unwrap();
        let times = || read_series(&run).unwrap().into_iter().map(|(time, _)| time).collect::<Vec<_>>();
        let all: Vec<_> = entries.iter().map(|entry| entry.time).collect();
        assert_eq!(times(), all);
        // A damaged frame, and what follows it.
        let path = run.path().join(&entries[3].file);
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..100]).unwrap();
        assert_eq!(times(), all[..3]);
        // One of an earlier state, which was later.
        write(2, 0.05);
        assert_eq!(times(), all[..2]);
        // Of a run that has ended the list is whole.
        write(2, 0.2);
        fs::write(run.summary(), "{}").unwrap();
        assert_eq!(times(), all[..2]);
    }

    #[test]
    fn many_frames_are_not_each_a_replacement_of_the_list_and_none_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let run = RunDirectory::at(folder.path());
        let entry = |k: usize| SeriesEntry { time: 1e-6 * k as f64, file: RunDirectory::frame_name(k, false) };
        let mut entries = Vec::new();
        let mut series = SeriesWriter::new();
        // One that takes long.
        series.pacing.run(|| thread::sleep(Duration::from_millis(40)));
        let mut replaced = 0;
        for k in 0..500 {
            entries.push(entry(k));
            series.grown(&run, &entries).unwrap();
            replaced += usize::from(series.written == entries.len());
        }
        assert!(replaced < 250, "{replaced}");
        series.flush(&run, &entries).unwrap();
        assert_eq!(read_series(&run).unwrap().len(), 500);
        // With time to spare each frame is listed at once.
        series.pacing = Pacing::new();
        entries.push(entry(500));
        series.grown(&run, &entries).unwrap();
        assert_eq!(read_series(&run).unwrap().len(), 501);
    }
}
