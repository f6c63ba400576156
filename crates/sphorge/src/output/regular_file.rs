//! Reading of files that end: devices and pipes in the place of a file of a run may not, and a file that says that it is long may hold nothing.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Opens a regular file.
///
/// # Errors
/// There is none, it is something else, or the system refuses.
pub(crate) fn open(path: &Path) -> io::Result<File> {
    // Asked before it is opened: to open a pipe waits for who writes to it.
    if fs::metadata(path)?.is_file() { File::open(path) } else { Err(io::Error::other("is not a regular file")) }
}

/// Longest file of each kind, bytes: far more than any run writes, and what a machine can hold.
pub(crate) mod most {
    /// A deck: the limit of what is read as one.
    pub(crate) const DECK: u64 = 8 << 20;
    /// Summary, meaning of columns, mark of a validation.
    pub(crate) const TEXT: u64 = 64 << 20;
    /// List of frames or of pieces: a million of them.
    pub(crate) const LIST: u64 = 256 << 20;
    /// A frame of so many particles: a thousand values of each, and what names the pieces of a thousand ranks.
    pub(crate) fn frame(particles: usize) -> u64 {
        (16 << 20) + 4096 * particles as u64
    }
    /// History: a million rows of two hundred numbers.
    pub(crate) const HISTORY: u64 = 4 << 30;
    /// A picture in a report.
    pub(crate) const PICTURE: u64 = 64 << 20;
}

/// The bytes of a regular file of at most so many; none of a longer one is read.
///
/// # Errors
/// See [`open`]; or it is longer.
pub(crate) fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_all(open(path)?, most)
}

/// The same of one that is open.
pub(super) fn read_all(file: File, most: u64) -> io::Result<Vec<u8>> {
    let length = file.metadata()?.len();
    let too_long = |length: u64| {
        let reason = format!("has {length} bytes, more than the {most} that such a file can have");
        io::Error::new(io::ErrorKind::FileTooLarge, reason)
    };
    if length > most {
        return Err(too_long(length));
    }
    let mut bytes = Vec::new();
    // It may grow meanwhile.
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_long(bytes.len() as u64)) } else { Ok(bytes) }
}

/// The text of a regular file of at most so many bytes.
///
/// # Errors
/// See [`read`]; or it is no UTF-8.
pub(crate) fn read_to_string(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_of_a_file_that_is_too_long_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        // It takes no room, and would take all memory.
        File::create(&path).unwrap().set_len(1 << 42).unwrap();
        let refused = read(&path, most::HISTORY).unwrap_err();
        assert_eq!(refused.to_string(), "has 4398046511104 bytes, more than the 4294967296 that such a file can have");
        fs::write(&path, "12345").unwrap();
        assert_eq!(
            (read(&path, 5).unwrap().len(), read(&path, 4).unwrap_err().kind()),
            (5, io::ErrorKind::FileTooLarge)
        );
    }

    #[test]
    fn what_is_no_file_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("history.csv");
        fs::write(&file, "time\n").unwrap();
        assert_eq!(read_to_string(&file, 5).unwrap(), "time\n");
        assert_eq!(read(folder.path(), 5).unwrap_err().to_string(), "is not a regular file");
        assert_eq!(read(&folder.path().join("none"), 5).unwrap_err().kind(), io::ErrorKind::NotFound);
        #[cfg(unix)]
        {
            let device = folder.path().join("summary.json");
            std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
            assert_eq!(read(&device, 5).unwrap_err().to_string(), "is not a regular file");
        }
    }
}
