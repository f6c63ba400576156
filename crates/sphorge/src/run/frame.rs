//! Frames that are written while steps go on.

use crate::{
    engine::FieldSource,
    output::{AtPath, Durability, FrameHeader, FrameWriter, OutputError, write_file},
};
use rayon::{ThreadPool, ThreadPoolBuilder};
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

/// The thread that writes frames while steps go on, which compresses them alone, since the threads of the run have their own work; none where it cannot
/// be had. One that panics has not written its frame, which is told when the frame is waited for.
pub(super) fn frame_thread() -> Option<ThreadPool> {
    let pool = ThreadPoolBuilder::new().num_threads(1).thread_name(|_| "frame".to_owned());
    pool.panic_handler(|_| {}).build().ok()
}

/// A frame that a thread of its own is writing.
#[derive(Debug)]
pub(super) struct FrameUnderWay {
    path: PathBuf,
    written: Receiver<Result<(), OutputError>>,
}

impl FrameUnderWay {
    /// Begins to write a frame of what was copied of an engine, on a thread of [`frame_thread`].
    pub(super) fn start(thread: &ThreadPool, frame: Frame, source: Box<dyn FieldSource + Send>, path: PathBuf) -> Self {
        let (sender, written) = channel();
        let target = path.clone();
        // Nobody waits any more where the run has ended otherwise.
        thread.spawn(move || drop(sender.send(frame.write(&*source, &target))));
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
