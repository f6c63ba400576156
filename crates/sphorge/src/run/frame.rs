//! Frames that are written while steps go on.

use crate::{
    engine::FieldSource,
    output::{AtPath, Durability, FrameHeader, FrameWriter, OutputError, RunDirectory, Sink, Sum},
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::{
    io,
    sync::mpsc::{Receiver, channel},
};

/// A frame that is to be written.
pub(super) struct Frame {
    pub(super) writer: FrameWriter,
    pub(super) header: FrameHeader,
    pub(super) fields: Vec<String>,
}

impl Frame {
    /// Writes it; returns the sum of its file.
    pub(super) fn write(
        &self,
        source: &dyn FieldSource,
        directory: &RunDirectory,
        name: &str,
    ) -> Result<Sum, OutputError> {
        let content = |mut out: &mut dyn Sink| self.writer.write(&mut out, &self.header, source, &self.fields);
        directory.write_summed(name, Durability::Process, content)
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
    directory: RunDirectory,
    name: String,
    written: Receiver<Result<Sum, OutputError>>,
}

impl FrameUnderWay {
    /// Begins to write a frame of what was copied of an engine, on a thread of [`frame_thread`].
    pub(super) fn start(
        thread: &ThreadPool,
        frame: Frame,
        source: Box<dyn FieldSource + Send>,
        directory: &RunDirectory,
        name: String,
    ) -> Self {
        let (sender, written) = channel();
        let (target, file) = (directory.clone(), name.clone());
        // Nobody waits any more where the run has ended otherwise.
        thread.spawn(move || {
            let done = frame.write(&*source, &target, &file);
            // The lock of the folder is given back when the last who has it ends, which is not this thread.
            drop(target);
            drop(sender.send(done));
        });
        Self { directory: directory.clone(), name, written }
    }

    /// The file, in the folder of the run, and its sum, when it is there.
    pub(super) fn wait(self) -> Result<(String, Sum), OutputError> {
        let path = self.directory.path().join(&self.name);
        match self.written.recv() {
            Ok(done) => done.map(|sum| (self.name, sum)),
            Err(_) => Err(io::Error::other("the thread that writes the frame has ended")).writing(&path),
        }
    }
}
