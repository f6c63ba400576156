//! Frames in pieces: each process that shares a run writes its particles to a file of its own, and a `.pvtp` file (VTK XML parallel PolyData) names
//! them all, so that readers open it as one.
//!
//! The particles of a piece come in the order its process has them in, so every piece has their `id`. The file that names the pieces is written
//! when all of them are there.

use super::{
    FrameHeader, FrameWriter, RunDirectory,
    atomic::Durability,
    directory::Shared,
    error::{AtPath, OutputError},
    folder::Folder,
    numbered::{numbered, remove_numbered},
    sum::Sum,
    vtp::{array_element, unit_label, written_fields},
};
use crate::engine::{FieldSource, InPieces};
use crate::model::Model;
use serde::{Deserialize, Serialize};
use std::io;

/// Readers of a frame in pieces put its particles in order by this field.
pub(super) const ORDER: &str = "id";

/// What one process asks the others to write.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PieceRequest {
    /// Folder of the run.
    run: Shared,
    /// Folder of the pieces in it.
    folder: String,
    time: f64,
    step: u64,
}

impl PieceRequest {
    /// Understands a request.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    /// Writes the particles of the process of this number; returns where to, in the folder of the run.
    pub(crate) fn write(
        &self,
        model: &Model,
        number: usize,
        particles: &dyn FieldSource,
    ) -> Result<(Folder, String), OutputError> {
        let run = self.run.open()?;
        let name = format!("{}/{}", self.folder, numbered(number, EXTENSION));
        let path = run.path().join(&name);
        // Other processes may not see yet that it was made.
        run.make_inside(&self.folder).writing(&path)?;
        let header = FrameHeader::new(model, self.time, self.step);
        let written = run.write(&name, Durability::Process, |mut out| {
            FrameWriter::new(model).write(&mut out, &header, particles, &with_order(&model.output.fields))
        });
        written.writing(&path)?;
        Ok((run, name))
    }
}

/// How files of pieces end.
const EXTENSION: &str = "vtp";

fn with_order(fields: &[String]) -> Vec<String> {
    let has_order = fields.iter().any(|field| field == ORDER);
    let order = (!has_order).then(|| ORDER.to_owned());
    order.into_iter().chain(fields.iter().cloned()).collect()
}

/// Has all processes write their pieces of frame `index`, then names them in its file. Returns the files that this process has written, in the folder
/// of the run, and the sum of the one that names the pieces.
///
/// # Errors
/// The inner one: a file cannot be written.
pub(crate) fn write_pieces(
    directory: &RunDirectory,
    index: usize,
    model: &Model,
    (time, step): (f64, u64),
    processes: &dyn InPieces,
) -> Result<Result<([String; 2], Sum), OutputError>, crate::engine::RunFailure> {
    let file = RunDirectory::frame_name(index, true);
    let name = RunDirectory::piece_folder(index);
    let path = directory.path().join(&name);
    let (folder, request) = match request(directory, &name, time, step) {
        Ok(request) => request,
        Err(error) => return Ok(Err(error)),
    };
    let text = match serde_json::to_string(&request) {
        Ok(text) => text,
        Err(error) => return Ok(Err(io::Error::other(error)).writing(&path)),
    };
    let mut own = Err(String::new());
    let mut write = |particles: &dyn FieldSource| {
        own = request.write(model, 0, particles).map(|(_, name)| name).map_err(|error| error.chain());
        own.clone().map(drop)
    };
    let written = processes.write(&text, &mut write)?;
    let named = written.and(own).map_err(io::Error::other).writing(&path).and_then(|piece| {
        let header = FrameHeader::new(model, time, step);
        let text = FrameWriter::new(model).named_pieces(&header, &model.output.fields, index, processes.pieces());
        let text = text.writing(&path)?;
        let sum = directory.write_summed(&file, Durability::Process, |out| out.write_all(text.as_bytes()))?;
        Ok(([piece, file], sum))
    });
    if named.is_err() {
        // All processes have ended what they wrote; a frame that is not named is of no use.
        let _ = remove_pieces(&folder, &name);
    }
    Ok(named)
}

/// The request, with a folder that has no pieces of another number of processes, and the folder of the run.
fn request(directory: &RunDirectory, name: &str, time: f64, step: u64) -> Result<(Folder, PieceRequest), OutputError> {
    let (folder, run) = directory.share(name)?;
    let path = directory.path().join(name);
    remove_pieces(&folder, name).writing(&path)?;
    folder.make_inside(name).writing(&path)?;
    Ok((folder, PieceRequest { run, folder: name.to_owned(), time, step }))
}

/// Removes a folder of pieces with the pieces that are in it.
pub(super) fn remove_pieces(run: &Folder, name: &str) -> io::Result<()> {
    remove_numbered(run, name, EXTENSION)
}

impl FrameWriter {
    /// The text of the file that names so many pieces in a folder beside it.
    fn named_pieces(&self, header: &FrameHeader, fields: &[String], index: usize, pieces: usize) -> io::Result<String> {
        let fields = written_fields(&with_order(fields))?;
        let arrays: String = fields
            .iter()
            .map(|field| format!("      {}", array_element("PDataArray", field, header.dimensions, "")))
            .collect();
        let pieces: String = (0..pieces)
            .map(|piece| format!("    <Piece Source=\"{index:06}/{}\"/>\n", numbered(piece, EXTENSION)))
            .collect();
        Ok(format!(
            r#"<?xml version="1.0"?>
<VTKFile type="PPolyData" {attributes}>
  <PPolyData GhostLevel="0">
{field_data}    <PPoints>
      <PDataArray type="Float64" Name="Points" NumberOfComponents="3">
        {metre}
      </PDataArray>
    </PPoints>
    <PPointData>
{arrays}    </PPointData>
{pieces}  </PPolyData>
</VTKFile>
"#,
            attributes = self.attributes(),
            field_data = self.field_data(header, &fields),
            metre = unit_label("m"),
        ))
    }
}
