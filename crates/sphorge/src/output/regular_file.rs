//! Reading of files that end: devices and pipes in the place of a file of a run may not.

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

/// The bytes of a regular file.
///
/// # Errors
/// See [`open`].
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a regular file.
///
/// # Errors
/// See [`open`]; or it is no UTF-8.
pub(crate) fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_file_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("history.csv");
        fs::write(&file, "time\n").unwrap();
        assert_eq!(read_to_string(&file).unwrap(), "time\n");
        assert_eq!(read(folder.path()).unwrap_err().to_string(), "is not a regular file");
        assert_eq!(read(&folder.path().join("none")).unwrap_err().kind(), io::ErrorKind::NotFound);
        #[cfg(unix)]
        {
            let device = folder.path().join("summary.json");
            std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
            assert_eq!(read(&device).unwrap_err().to_string(), "is not a regular file");
        }
    }
}
