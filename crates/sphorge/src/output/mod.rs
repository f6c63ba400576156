//! Sinks: the folder of a run, frames for ParaView, the history, the summary; and reading them back.

mod atomic;
mod checkpoint;
mod checkpoint_parts;
mod claim;
mod directory;
mod error;
mod folder;
mod history;
mod history_read;
mod lock;
mod mark;
mod no_run;
mod numbered;
mod pieces;
pub(crate) mod regular_file;
mod series;
mod sum;
mod summary;
mod sync;
#[cfg(test)]
pub(crate) mod testing;
mod vtp;
mod vtp_data;
mod vtp_read;
mod xml;

pub use directory::RunDirectory;
pub use error::OutputError;
pub use history::{HistoryColumn, measure_unit};
pub(crate) use history::{field_unit, mass_unit};
pub use history_read::HistoryTable;
pub use no_run::NoRun;
pub use series::{SeriesEntry, read_series};
pub use summary::{
    AuditRecord, BodyRecord, DrivenRecord, EndReason, EnergyRecord, FailureRecord, MemoryOf, StageSecondsRecord,
    Status, Summary, WarningRecord,
};
pub use vtp::{FrameBody, FrameHeader, FrameWriter, write_frame};
pub use vtp_read::{FrameArray, FrameColumn, FrameFile};

pub(crate) use atomic::{Durability, Sink, write_file};
pub(crate) use checkpoint::{About, Checkpoint, checkpoints, remove_former_checkpoints, write_checkpoint};
pub(crate) use checkpoint_parts::PartSet;
pub(crate) use claim::Claim;
pub(crate) use directory::{DECK, HISTORY, SERIES, is_empty, remove_unfinished};
pub(crate) use error::AtPath;
pub(crate) use folder::Folder;
pub(crate) use history::{History, HistorySample, MEASURE_MEANING};
pub(crate) use history_read::last_step;
pub(crate) use mark::MARK;
pub(crate) use pieces::{PieceRequest, write_pieces};
pub(crate) use regular_file::{most, read as read_regular_file};
#[cfg(test)]
pub(crate) use series::write_series;
pub(crate) use series::{SeriesWriter, series_text};
pub(crate) use sum::Sum;
pub(crate) use sync::DiskSync;
pub(crate) use vtp::uncompressed_bytes;

#[cfg(test)]
use std::path::Path;

/// Writes a frame of nameless bodies to a file.
#[cfg(test)]
pub(crate) fn write_frame_file(
    path: &Path,
    header: &FrameHeader,
    particles: &dyn crate::engine::FieldSource,
    fields: &[String],
) -> Result<(), OutputError> {
    write_file(path, Durability::Process, |mut out| write_frame(&mut out, header, particles, fields))
}
