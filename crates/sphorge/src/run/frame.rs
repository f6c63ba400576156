//! Frames that are written while steps go on.

use crate::{
    engine::FieldSource,
    output::{AtPath, Durability, FrameHeader, FrameWriter, OutputError, write_file},
};
use std::{
    io,
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, channel},
};

/// A frame that is to be written.
pub(super) struct Frame {
    pub(super) writer: FrameWriter,
    pub(super) header: FrameHeader,
    pub(super) fields: Vec<String>,
}

impl Frame {
    /// Writes it.
    pub(super) fn write(&self, source: &dyn FieldSource, path: &Path) -> Result<(), OutputError> {
        write_file(path, Durability::Process, |mut out| self.writer.write(&mut out, &self.header, source, &self.fields))
    }
}

/// A frame that a thread of its own is writing.
#[derive(Debug)]
pub(super) struct FrameUnderWay {
    path: PathBuf,
    written: Receiver<Result<(), OutputError>>,
}

impl FrameUnderWay {
    /// Begins to write a frame of what was copied of an engine.
    pub(super) fn start(frame: Frame, source: Box<dyn FieldSource + Send>, path: PathBuf) -> Self {
        let (sender, written) = channel();
        let target = path.clone();
        let write = move || {
            // The threads of the run have their own work: a frame is compressed by this one, a pool of its own.
            let _pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
            // Nobody waits any more where the run has ended otherwise.
            let _ = sender.send(frame.write(&*source, &target));
        };
        // Where there is no thread there is no sender, which is told when the frame is waited for.
        let _ = std::thread::Builder::new().name("frame".to_owned()).spawn(write);
        Self { path, written }
    }

    /// The file, when it is there.
    pub(super) fn wait(self) -> Result<PathBuf, OutputError> {
        match self.written.recv() {
            Ok(done) => done.map(|()| self.path),
            Err(_) => Err(io::Error::other("the thread that writes the frame has ended")).writing(&self.path),
        }
    }
}
